//! Files in and out, one format a module.
//!
//! | module | reads | writes |
//! |---|---|---|
//! | [`obj`] | control cages with OpenSubdiv's tags | refined meshes, their forms beside them |
//! | [`fields`] | forms on a mesh | forms on a mesh |
//! | [`json`] | | a refined mesh with its forms |
//! | [`glb`] | | a refined mesh, its tangent field and arrows, as binary glTF |
//! | [`points`] | points on faces | |
//! | [`npz`] | | the operators of a hierarchy, and other arrays, for NumPy and SciPy |
//!
//! A reader of meshes hands back an [`Asset`], a writer of meshes takes a [`Surface`]. Every file is
//! written beside its final name and moved there when complete ([`atomic`]), so that no run leaves half a
//! file. Every error names the file, the place in it and what to do.

mod asset;
pub mod atomic;
mod error;
pub mod fields;
pub mod glb;
pub mod json;
pub mod npz;
pub mod obj;
pub mod points;
mod surface;

pub use asset::{Asset, SourceLines};
pub use error::IoError;
pub use surface::{AtVertices, Surface};

use nalgebra::Vector3;

use crate::cochain::Cochain;

/// Vertex positions: a 0-cochain with values in R^3.
pub type Positions = Cochain<0, Vector3<f64>>;
