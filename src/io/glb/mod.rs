//! glTF 2.0, binary (`.glb`) or as text (`.gltf`): what viewers and game engines open.
//!
//! # Written
//!
//! - Node `surface`: the faces as triangles (polygons as fans) with `POSITION`, `NORMAL` and, where there
//!   are such forms, the vertex attributes `_FORM0` (SCALAR, the 0-form) and `_FORM1` (VEC3, the tangent
//!   vector of the 1-form, the mean over the faces round each vertex, or the exact one on a limit surface); `TANGENT`, its direction, when asked
//!   for. The node's extras have all that triangles cannot say, under the key `formwork`: the object of
//!   [`json`](super::json) without positions. So a file reads back to the same polygons, tags and forms;
//!   positions are 32-bit floats in glTF.
//! - Node `form1 arrows`, where the 1-form is not zero: lines, an arrow at the centre of each face, or at each
//!   vertex of a limit surface. The
//!   longest is 0.9 times the mean edge length, the others in proportion.
//!
//! Faces that are holes are not drawn.
//!
//! # Read
//!
//! One node with triangles; [`LoadOptions::prim`](super::LoadOptions) names it if there are several. Its
//! primitives become one mesh, vertices at exactly the same place become one, the transforms of the node
//! and those above it are its [`placement`](super::Asset::placement). Our extras are used if they fit the
//! triangles; without them, forms are read from `_FORM0` and `_FORM1`. What is passed over is named in
//! the notes.

mod arrows;
mod buffers;
mod container;
mod read;
mod weld;
mod write;

pub use read::parse;
pub use write::{buffer_path, write, write_text};

/// The key of our object in the extras of a node.
const EXTRAS: &str = "formwork";
/// The names of our nodes.
const SURFACE: &str = "surface";
const ARROWS: &str = "form1 arrows";
