//! Wavefront OBJ: control cages in, with OpenSubdiv's `t` tags; refined meshes out.
//!
//! Read: `v` (the first three coordinates), `f` (the position index of each corner) and the tags
//! `crease`, `corner`, `hole`, `interpolateboundary`, `creasemethod` and `smoothtriangles`. Polygons stay
//! polygons; vertices and faces keep the order of the file and are numbered from 0, vertices without a
//! face included. Groups, smoothing groups, materials, texture coordinates and normals are passed over;
//! anything else that is passed over is named in [`Asset::notes`](super::Asset::notes). Without an
//! `interpolateboundary` tag the boundary rule is `EdgeOnly`, as in OpenSubdiv's own reader.
//!
//! ```text
//! t crease 2/1/0 0 1 2.5       edge between vertices 0 and 1; several pairs share one sharpness or
//! t crease 4/2/0 0 1 1 2 2.5 3   have one each
//! t corner 1/1/0 7 10          vertex 7, infinitely sharp
//! t hole 2/0/0 3 4             faces 3 and 4
//! t interpolateboundary 1/0/0 1   0 none, 1 edge and corner, 2 edge only
//! t creasemethod 0/0/1 chaikin    or normal
//! t smoothtriangles 0/0/1 smooth  or catmark
//! ```
//!
//! Indices in tags start at 0, those in `f` lines at 1.

mod filter;
mod lines;
mod problem;
mod read;
mod tags;
mod write;

pub use problem::ObjProblem;
pub use read::{parse, read};
pub use write::{fields_path, write};
