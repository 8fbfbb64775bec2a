//! Evaluation at points of the limit surface.

mod basis;
mod jets;
mod pieces;
mod point;
mod prepare;
mod walk;

pub use basis::{BasisPoint, FaceCells, QuadratureRule};
pub use jets::BasisJets;
pub use pieces::{PiecePoint, Pieces};
pub use point::{PointError, SurfacePoint};

use nalgebra::Vector3;
use rayon::prelude::*;
use walk::{Found, Walk};

use super::frame::Frame;
use super::patch::{self, Jet};
use super::tables::Tables;
use crate::cochain::{Cochain, Value};
use crate::field;
use crate::hierarchy::{Hierarchy, HierarchyError};
use crate::topology::SplitKind;

/// Why a surface cannot be evaluated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum SurfaceError {
    #[error(transparent)]
    Hierarchy(#[from] HierarchyError),
    #[error(
        "vertex {vertex} joins sheets along two non-manifold edges and has other faces beside them: points next to it cannot be evaluated, separate the sheets"
    )]
    NonManifold { vertex: u32 },
}

/// The limit surface of a cage, ready to be evaluated: the cage refined until the irregular vertices and sharp
/// features of each face lie at one corner, and for each face the cells that matter to it.
///
/// Cochains are refined once ([`LimitSurface::refine`]) and evaluated at any number of points. A point in a
/// regular face costs one polynomial, next to an irregular vertex or a feature a small matrix product more for
/// each halving of the distance.
///
/// With the boundary rules [`Thesis`](crate::scheme::BoundaryRule::Thesis) and
/// [`Dct`](crate::scheme::BoundaryRule::Dct) the limit is no polynomial along boundaries and creases: on them values
/// are right to about 1e-7, and derivatives of a form's components do not exist.
pub struct LimitSurface {
    hierarchy: Hierarchy,
    tables: Tables,
    patches: Vec<Patch>,
    /// The cells of each face: its vertices, its half-edges, its faces.
    cells: Vec<u32>,
}

/// A face of the finest level.
#[derive(Clone, Copy)]
struct Patch {
    /// The corner from which its surroundings are told, as steps from the first.
    origin: u8,
    /// The number of its table.
    table: u32,
    /// Where its cells start.
    cells: u32,
}

/// The fewest points that are worth a thread's while.
const RUN: usize = 256;

/// A surface with a 1-form at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceVector {
    /// The position and its derivatives `T_s` and `T_t`.
    pub position: Jet<Vector3<f64>>,
    /// The components of the form along `s` and `t`.
    pub components: [f64; 2],
    /// The tangent vector of the form: `V . T_s` and `V . T_t` are its components. 0 where the derivatives are
    /// parallel.
    pub vector: Vector3<f64>,
}

impl LimitSurface {
    /// The levels from the cage to the one that is evaluated on.
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// A cochain of the cage as evaluation wants it: on the finest level.
    ///
    /// # Panics
    /// If the cochain does not belong to the cage.
    pub fn refine<const K: usize, T: Value>(&self, cochain: &Cochain<K, T>) -> Cochain<K, T> {
        self.hierarchy.subdivide(cochain)
    }

    /// The limit of a 0-form, with its derivatives by `s` and `t`, at each point. `form` is a refined one, see
    /// [`LimitSurface::refine`]; positions are one.
    ///
    /// At an irregular vertex, where these derivatives do not exist, they are those along its two limit tangents,
    /// in one sector at a crease, so that tangent plane and tangent vectors come out right. NaN at a sharp vertex
    /// without sharp edges, which has no tangent plane.
    ///
    /// # Errors
    /// If a point is not on the surface.
    ///
    /// # Panics
    /// If the cochain is not one of the finest level.
    pub fn evaluate_0<T: Value>(
        &self,
        form: &Cochain<0, T>,
        points: &[SurfacePoint],
    ) -> Result<Vec<Jet<T>>, PointError> {
        let kind = self.hierarchy.split_kind();
        let walk = || Walk::new(self, 0, form.values());
        self.each(points, walk, |walk, face, frame| jet(kind, walk, face, frame))
    }

    /// The components of the limit of a 1-form along `s` and `t`, with their derivatives, at each point. At an
    /// irregular vertex the components are those along its two limit tangents, and their derivatives are NaN.
    ///
    /// # Errors
    /// If a point is not on the surface.
    ///
    /// # Panics
    /// If the cochain is not one of the finest level.
    pub fn evaluate_1<T: Value>(
        &self,
        form: &Cochain<1, T>,
        points: &[SurfacePoint],
    ) -> Result<Vec<[Jet<T>; 2]>, PointError> {
        let kind = self.hierarchy.split_kind();
        let walk = || Walk::new(self, 1, form.values());
        self.each(points, walk, |walk, face, frame| {
            let (found, c) = walk.find(face, frame);
            let frame = match found {
                Found::Patch(frame) => frame,
                Found::Vertex(table) => {
                    let none = c[0] * f64::NAN;
                    return table.along_tangents(c).map(|value| Jet { value, derivatives: [none; 2] });
                }
            };
            let [a, b] = patch::form1(kind, c, frame.point);
            let values = frame.pull([a.value, b.value]);
            let slopes = [frame.pull(a.derivatives), frame.pull(b.derivatives)];
            let by = [0, 1].map(|k| frame.pull([slopes[0][k], slopes[1][k]]));
            [0, 1].map(|i| Jet { value: values[i], derivatives: [by[0][i], by[1][i]] })
        })
    }

    /// Positions with their derivatives, the components of a 1-form and its tangent vector at each point: what
    /// [`LimitSurface::evaluate_0`] and [`LimitSurface::evaluate_1`] say, in one go.
    ///
    /// # Errors
    /// If a point is not on the surface.
    ///
    /// # Panics
    /// If the cochains are not of the finest level.
    pub fn evaluate_vectors(
        &self,
        positions: &Cochain<0, Vector3<f64>>,
        form: &Cochain<1>,
        points: &[SurfacePoint],
    ) -> Result<Vec<SurfaceVector>, PointError> {
        let kind = self.hierarchy.split_kind();
        let walks = || (Walk::new(self, 0, positions.values()), Walk::new(self, 1, form.values()));
        self.each(points, walks, |(positions, form), face, frame| {
            let position = jet(kind, positions, face, frame);
            let (found, c) = form.find(face, frame);
            let components = match found {
                Found::Patch(frame) => {
                    let [a, b] = patch::form1(kind, c, frame.point);
                    frame.pull([a.value, b.value])
                }
                Found::Vertex(table) => table.along_tangents(c),
            };
            SurfaceVector { position, components, vector: field::sharp(position.derivatives, components) }
        })
    }

    /// The density of the limit of a 2-form, the factor of `ds^dt`, at each point; NaN at an irregular vertex, where
    /// it does not exist.
    ///
    /// # Errors
    /// If a point is not on the surface.
    ///
    /// # Panics
    /// If the cochain is not one of the finest level.
    pub fn evaluate_2<T: Value>(
        &self,
        form: &Cochain<2, T>,
        points: &[SurfacePoint],
    ) -> Result<Vec<T>, PointError> {
        let kind = self.hierarchy.split_kind();
        let walk = || Walk::new(self, 2, form.values());
        self.each(points, walk, |walk, face, frame| match walk.find(face, frame) {
            (Found::Patch(frame), c) => patch::form2(kind, c, frame.point) * frame.determinant(),
            (Found::Vertex(_), c) => c[0] * f64::NAN,
        })
    }

    /// Calls `at` with the place of each point on the finest level. Points are taken in runs, each with a `state`
    /// of its own.
    fn each<S, R: Send>(
        &self,
        points: &[SurfacePoint],
        state: impl Fn() -> S + Send + Sync,
        at: impl Fn(&mut S, u32, Frame) -> R + Send + Sync,
    ) -> Result<Vec<R>, PointError> {
        if let Some(error) = points.par_iter().find_map_first(|point| self.check(point).err()) {
            return Err(error);
        }
        let one = |state: &mut S, point: &SurfacePoint| {
            let (face, frame) = self.locate(point);
            at(state, face, frame)
        };
        Ok(points.par_iter().with_min_len(RUN).map_init(state, one).collect())
    }

    /// Whether a point is on the surface.
    ///
    /// # Errors
    /// If it is not, saying why.
    pub fn check(&self, point: &SurfacePoint) -> Result<(), PointError> {
        point.check(self.hierarchy.split_kind(), self.hierarchy.level(0).mesh())
    }

    /// The face of the finest level that holds a point, and the frame of its patch there.
    fn locate(&self, point: &SurfacePoint) -> (u32, Frame) {
        let (corner, frame) = pieces::finest_corner(&self.hierarchy, point);
        let mesh = self.hierarchy.finest().mesh();
        let face = mesh.corner_face(corner);
        let size = mesh.face_size(face);
        let place = (corner - mesh.corners(face).start) as usize;
        let steps = (self.patches[face as usize].origin as usize + size - place) % size;
        (face, frame.turned(self.hierarchy.split_kind(), steps))
    }
}

/// The limit of a 0-form at a point of a face.
fn jet<T: Value>(kind: SplitKind, walk: &mut Walk<T>, face: u32, frame: Frame) -> Jet<T> {
    let (found, c) = walk.find(face, frame);
    let mut jet = match found {
        Found::Patch(frame) => {
            let jet = patch::form0(kind, c, frame.point);
            Jet { value: jet.value, derivatives: frame.pull(jet.derivatives) }
        }
        Found::Vertex(table) => {
            let (value, derivatives) = table.limit(c);
            Jet { value, derivatives }
        }
    };
    if let Some(centre) = walk.centre(face) {
        jet.value = jet.value + centre;
    }
    jet
}
