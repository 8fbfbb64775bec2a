//! Files in and out, one format a module.
//!
//! | module | reads | writes |
//! |---|---|---|
//! | [`obj`] | meshes with OpenSubdiv's tags | the same, their forms beside them |
//! | [`json`] | a mesh with its forms and tags | the same |
//! | [`glb`] | meshes, forms in their extras, as glTF | the same, with its tangent field and arrows |
//! | [`usd`] | meshes on a stage, with their forms, still or moving | the same, the rest of the stage kept |
//! | [`fields`] | forms on a mesh | forms on a mesh |
//! | [`points`] | points on faces | |
//! | [`volume`] | solids: Gmsh and VTK, with their forms | VTK |
//! | [`npz`] | | the operators of a hierarchy, surfaces, matrices and other arrays, for NumPy and SciPy |
//! | [`petsc`] | | matrices and vectors, for PETSc |
//!
//! [`load`] and [`save`] choose the format of a mesh by the extension of its file. A reader of meshes hands
//! back an [`Asset`], a writer of meshes takes a [`Surface`]. Every file is
//! written beside its final name and moved there when complete ([`atomic`]), so that no run leaves half a
//! file. Every error names the file, the place in it and what to do.

mod ancestry;
mod asset;
pub mod atomic;
mod error;
pub mod fields;
mod format;
mod forms;
pub mod glb;
pub mod json;
pub mod npz;
pub mod obj;
pub mod petsc;
pub mod points;
mod surface;
pub mod usd;
pub mod volume;

pub use ancestry::Ancestry;
pub use asset::{Asset, Frame, SourceLines};
pub use error::IoError;
pub use format::{Format, Frames, LoadOptions, SaveOptions, Saved, companion, load, save, writer};
pub use forms::{Form1, Forms, SAME_EDGE};
pub use surface::{AtVertices, Pose, Surface};

use nalgebra::Vector3;

use crate::cochain::Cochain;

/// Vertex positions: a 0-cochain with values in R^3.
pub type Positions = Cochain<0, Vector3<f64>>;
