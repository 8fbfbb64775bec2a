//! Points of the surface.

use crate::topology::{Mesh, SplitKind};

/// A point of a face of the control cage.
///
/// On a quad (every face, for a bilinear or Catmull-Clark scheme, that has four corners) with corners `v, a, q,
/// b`, counter-clockwise from `corner`, it is at `s` from `v` towards `a` and `t` from `v` towards `b`, both from
/// 0 to 1. On a triangle of Loop's schemes it has barycentric coordinates `1 - s - t`, `s`, `t` at `v, a, b`. A
/// polygon that is split into quads has a unit square at each of its corners: `s` runs along the edge that
/// leaves the corner up to its midpoint, `t` along the edge that reaches it, and (1, 1) is the centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The face.
    pub face: u32,
    /// The corner of the face, from 0, that `s` and `t` start from.
    pub corner: u32,
    /// The first parameter.
    pub s: f64,
    /// The second parameter.
    pub t: f64,
}

/// What is wrong with a point.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum PointError {
    #[error("there is no face {face}: faces are numbered from 0 to {}, correct the point", .count - 1)]
    NoFace { face: u32, count: usize },
    #[error("face {face} has no corner {corner}: it has {size}, numbered from 0: correct the point")]
    NoCorner { face: u32, corner: u32, size: usize },
    #[error("(s, t) = ({s}, {t}) is outside face {face}: {domain}, correct the point")]
    Outside { face: u32, s: f64, t: f64, domain: &'static str },
}

impl SurfacePoint {
    /// Whether the point is on the surface of a cage.
    pub(super) fn check(&self, kind: SplitKind, cage: &Mesh) -> Result<(), PointError> {
        let SurfacePoint { face, corner, s, t } = *self;
        if face as usize >= cage.num_faces() {
            return Err(PointError::NoFace { face, count: cage.num_faces() });
        }
        let size = cage.face_size(face);
        if corner as usize >= size {
            return Err(PointError::NoCorner { face, corner, size });
        }
        let (domain, inside) = match kind {
            SplitKind::Quad => ("both run from 0 to 1", s <= 1.0 && t <= 1.0),
            SplitKind::Triangle => {
                ("neither is below 0 and their sum is at most 1", s + t <= 1.0 + 4.0 * f64::EPSILON)
            }
        };
        match inside && s >= 0.0 && t >= 0.0 {
            true => Ok(()),
            false => Err(PointError::Outside { face, s, t, domain }),
        }
    }
}
