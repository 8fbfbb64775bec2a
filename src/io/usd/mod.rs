//! Universal Scene Description: stages as text (`.usda`), binary (`.usdc`) or packed (`.usdz`) in, text out.
//!
//! # Read
//!
//! One mesh of the stage ([`LoadOptions::prim`](super::LoadOptions) says which if there are several) with
//! everything that its subdivision depends on: topology, `orientation`, `subdivisionScheme`,
//! `interpolateBoundary`, `triangleSubdivisionRule`, creases, corners, holes; its transforms and those above
//! it; time samples of its points. Only the file itself is read: what it composes from others is named in
//! the notes, and `usdcat --flatten` makes one file of it.
//!
//! Forms travel as primvars:
//!
//! | primvar | type | interpolation | |
//! |---|---|---|---|
//! | `form0` | `float[]` | `vertex` | the 0-form |
//! | `form1` | `float[]` | `faceVarying` | the circulation of the 1-form from each corner to the next one of its face; the faces of an edge say the same with opposite signs, which is checked |
//! | `form2` | `float[]` | `uniform` | the 2-form |
//! | `form1Vector` | `vector3f[]` | `vertex`; `faceVarying` if an edge is sharp | the tangent field, written and not read |
//!
//! `double[]` is read too, and kept.
//!
//! # Written
//!
//! The stage that the mesh came from, the mesh refined in its place: points, topology, normals, extent,
//! `subdivisionScheme` none; its creases and the like go. Other primvars follow: those of vertices are refined
//! as points are, those of corners (texture coordinates) are interpolated linearly within each face, those of
//! faces and subsets of faces are handed down.
//! Everything else on the stage stays as it is. A mesh from another format gets a stage of its own,
//! `/Root/surface`. On level 0 a mesh keeps its tags and stays a subdivision surface.
//!
//! Binary stages are not written: no crate writes one that Pixar's library opens.

mod build;
mod container;
mod crate_check;
mod follow;
mod layer;
mod primvars;
mod read;
mod text;
mod write;
mod xform;

pub use container::READER_THREAD;
pub use read::parse;
pub use write::write;

use std::fmt;

use nalgebra::Matrix4;
use openusd::sdf::{Data, Path, Value};

use crate::topology::Descriptor;
use layer::Prim;

/// A stage, and the mesh on it that was read.
pub struct Stage {
    data: Data,
    prim: Path,
    /// The cage as it was read.
    descriptor: Descriptor,
    /// How many files the package had beside the stage.
    packed: usize,
}

impl fmt::Debug for Stage {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "Stage {{ {} specs, {} }}", self.data.len(), self.prim)
    }
}

impl Stage {
    /// What of the mesh and its stage another format does not get.
    pub(super) fn left_behind(&self) -> Option<String> {
        let prim = Prim { data: &self.data, path: self.prim.clone() };
        let names = match prim.field("propertyChildren") {
            Some(Value::TokenVec(names)) => names.as_slice(),
            _ => &[],
        };
        let is_read = |name: &str| {
            read::ATTRIBUTES.contains(&name)
                || write::TAGS.contains(&name)
                || name.starts_with("xformOp")
                || name.strip_prefix("primvars:").is_some_and(|rest| rest.starts_with("form"))
        };
        let mut list: Vec<String> =
            names.iter().map(|name| name.as_str()).filter(|name| !is_read(name)).map(str::to_owned).collect();
        list.extend(prim.children().iter().map(|child| child.path.to_string()));
        let others = Prim::root(&self.data).descendants().into_iter().filter(|other| {
            let above_or_below = other.path.has_prefix(&self.prim) || self.prim.has_prefix(&other.path);
            !above_or_below
        });
        match others.count() {
            0 => {}
            1 => list.push("another prim".to_owned()),
            count => list.push(format!("{count} other prims")),
        }
        (!list.is_empty()).then(|| list.join(", "))
    }

    /// From the space of the stage to that of glTF: metres, Y up.
    pub(super) fn to_gltf(&self) -> Matrix4<f64> {
        let root = Prim::root(&self.data);
        let unit = match root.field("metersPerUnit") {
            Some(Value::Double(unit)) if unit.is_finite() && *unit > 0.0 => *unit,
            _ => 0.01, // what USD falls back to
        };
        let turn = match root.field("upAxis") {
            Some(Value::Token(axis)) if axis.as_str() == "Z" => {
                #[rustfmt::skip]
                let turn = Matrix4::new(
                    1.0, 0.0, 0.0, 0.0,
                    0.0, 0.0, 1.0, 0.0,
                    0.0, -1.0, 0.0, 0.0,
                    0.0, 0.0, 0.0, 1.0,
                );
                turn
            }
            _ => Matrix4::identity(),
        };
        Matrix4::new_scaling(unit) * turn
    }
}

/// The custom attribute that says `chaikin`, for which USD has no word.
const CREASING: &str = "formwork:creasingMethod";
