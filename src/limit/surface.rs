//! Evaluation at points of the limit surface.

use rayon::prelude::*;

use super::frame::{Frame, child_corner};
use super::neighbourhood::{Configuration, around_face, origin, patch_cells};
use super::patch::{self, Jet};
use super::tables::{Key, Table, Tables, plain_vertices};
use super::unsettled;
use super::vertex::VertexTable;
use crate::cochain::{Cochain, Value};
use crate::hierarchy::{Hierarchy, HierarchyError, Level};
use crate::osd::Rule;
use crate::scheme::Scheme;
use crate::sparse::{Csr, row_of};
use crate::topology::{Cage, Mesh, SplitKind};

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
pub struct LimitSurface {
    hierarchy: Hierarchy,
    tables: Tables,
    patches: Vec<Patch>,
    /// The cells of each face: its vertices, its half-edges, its faces.
    cells: Vec<u32>,
}

/// What the limit is at a point.
enum Found<'a> {
    /// A polynomial, the point in its frame.
    Patch(Frame),
    /// An irregular vertex.
    Vertex(&'a VertexTable),
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

/// Where evaluation gives up approaching an irregular vertex: within 1e-13 of it in the parameters.
const MAX_DEPTH: usize = 44;

impl LimitSurface {
    /// Refines `cage` as far as evaluation needs: once where irregular vertices or features share a face, and
    /// until semi-sharp creases have decayed.
    ///
    /// # Errors
    /// If the cage cannot be refined that far, see [`Hierarchy::new`], or has a vertex that evaluation does not
    /// know.
    pub fn new(cage: &Cage, scheme: Scheme) -> Result<Self, SurfaceError> {
        let mut levels = unsettled::levels_to_settle(cage, scheme)?;
        // One level parts the features of a face, but for those of a triangle with three sharp edges.
        loop {
            let hierarchy = Hierarchy::new(cage, scheme, levels)?;
            if matches!(scheme, Scheme::Whitney | Scheme::Bilinear) {
                return Self::whitney(hierarchy);
            }
            let Some(origins) = origins(hierarchy.finest(), hierarchy.split_kind()) else {
                levels += 1;
                continue;
            };
            let tables = Tables::new(hierarchy.split_kind(), scheme);
            let (mesh, tags) = (hierarchy.finest().mesh(), hierarchy.finest().tags());
            let pulled = origins.iter().any(|&corner| tables.pulls(around_face(mesh, tags, corner).0));
            return match pulled {
                false => Self::prepare(hierarchy, tables, |_| None),
                true => {
                    let hierarchy = Hierarchy::new(cage, scheme, levels + 1)?;
                    let beside = beside(&hierarchy, &tables, &origins);
                    Self::prepare(hierarchy, tables, |face| beside[face])
                }
            };
        }
    }

    fn whitney(hierarchy: Hierarchy) -> Result<Self, SurfaceError> {
        let mut tables = Tables::new(hierarchy.split_kind(), hierarchy.scheme());
        let table = tables.number(Key::Whitney)? as u32;
        let (mut patches, mut cells) = (Vec::new(), Vec::new());
        let mesh = hierarchy.finest().mesh();
        for face in 0..mesh.num_faces() as u32 {
            patches.push(Patch { origin: 0, table, cells: cells.len() as u32 });
            cells.extend(mesh.face_vertices(face));
            cells.extend(mesh.face_half_edges(face).iter().map(|h| h.0));
            cells.push(face);
        }
        Ok(LimitSurface { hierarchy, tables, patches, cells })
    }

    /// `beside` says which faces are pulled at from beside them.
    fn prepare(
        hierarchy: Hierarchy,
        mut tables: Tables,
        beside: impl Fn(usize) -> Option<(Key, u32)>,
    ) -> Result<Self, SurfaceError> {
        let finest = hierarchy.finest();
        let (mesh, tags) = (finest.mesh(), finest.tags());
        let origins = origins(finest, hierarchy.split_kind()).expect("features stay apart");
        let mut patches = Vec::with_capacity(mesh.num_faces());
        let mut cells = Vec::new();
        for (face, &corner) in origins.iter().enumerate() {
            let beside = beside(face);
            let corner = beside.map_or(corner, |(_, start)| start);
            let (configuration, fan) = around_face(mesh, tags, corner);
            check(mesh, configuration, &fan)?;
            let key = beside.map_or(Key::Face(configuration), |(key, _)| key);
            let table = tables.number(key)? as u32;
            let first = mesh.corners(face as u32).start;
            patches.push(Patch { origin: (corner - first) as u8, table, cells: cells.len() as u32 });
            let around = patch_cells(mesh, configuration, &fan);
            cells.extend(around.vertices);
            cells.extend(around.edges.iter().map(|h| h.0));
            cells.extend(around.faces);
        }
        Ok(LimitSurface { hierarchy, tables, patches, cells })
    }

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
        self.each(form.values(), 0, points, |kind, found, c| match found {
            Found::Patch(frame) => {
                let jet = patch::form0(kind, c, frame.point);
                Jet { value: jet.value, derivatives: frame.pull(jet.derivatives) }
            }
            Found::Vertex(table) => {
                let (value, derivatives) = table.limit(c);
                Jet { value, derivatives }
            }
        })
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
        self.each(form.values(), 1, points, |kind, found, c| {
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
        self.each(form.values(), 2, points, |kind, found, c| match found {
            Found::Patch(frame) => patch::form2(kind, c, frame.point) * frame.determinant(),
            Found::Vertex(_) => c[0] * f64::NAN,
        })
    }

    fn each<T: Value, R: Send>(
        &self,
        form: &[T],
        degree: usize,
        points: &[SurfacePoint],
        at: impl Fn(SplitKind, Found, &[T]) -> R + Sync,
    ) -> Result<Vec<R>, PointError> {
        let mesh = self.hierarchy.finest().mesh();
        assert_eq!(form.len(), mesh.num_cells(degree), "a cochain of another level");
        let kind = self.hierarchy.split_kind();
        let one = |scratch: &mut [Vec<T>; 2], point: &SurfacePoint| {
            let (face, frame) = self.locate(point)?;
            let found = self.coefficients(form, degree, face, frame, scratch);
            Ok(at(kind, found, &scratch[0]))
        };
        points.par_iter().map_init(|| [Vec::new(), Vec::new()], one).collect()
    }

    /// Whether a point is on the surface.
    ///
    /// # Errors
    /// If it is not, saying why.
    pub fn check(&self, point: &SurfacePoint) -> Result<(), PointError> {
        self.locate(point).map(|_| ())
    }

    /// The face of the finest level that holds a point, and the frame of its patch there.
    fn locate(&self, point: &SurfacePoint) -> Result<(u32, Frame), PointError> {
        let SurfacePoint { face, corner, s, t } = *point;
        let (kind, cage) = (self.hierarchy.split_kind(), self.hierarchy.level(0).mesh());
        if face as usize >= cage.num_faces() {
            return Err(PointError::NoFace { face, count: cage.num_faces() });
        }
        let size = cage.face_size(face);
        if corner as usize >= size {
            return Err(PointError::NoCorner { face, corner, size });
        }
        let domain = match kind {
            SplitKind::Quad => "both run from 0 to 1",
            SplitKind::Triangle => "neither is below 0 and their sum is at most 1",
        };
        let inside = s >= 0.0
            && t >= 0.0
            && match kind {
                SplitKind::Quad => s <= 1.0 && t <= 1.0,
                SplitKind::Triangle => s + t <= 1.0 + 4.0 * f64::EPSILON,
            };
        if !inside {
            return Err(PointError::Outside { face, s, t, domain });
        }
        let mut frame = Frame::new(s, t);
        let mut corner = cage.corners(face).start + corner;
        for level in 1..=self.hierarchy.num_levels() {
            let (parent, child) =
                (self.hierarchy.level(level - 1).mesh(), self.hierarchy.level(level).mesh());
            let split = self.hierarchy.refinement(level).split();
            if kind == SplitKind::Quad && parent.face_size(parent.corner_face(corner)) != 4 {
                corner = split.corner_at(parent, corner);
            } else {
                let (number, below) = frame.descend(kind);
                corner = child_corner(split, parent, child, corner, number);
                frame = below;
            }
        }
        let mesh = self.hierarchy.finest().mesh();
        let face = mesh.corner_face(corner);
        let size = mesh.face_size(face);
        let place = (corner - mesh.corners(face).start) as usize;
        let steps = (self.patches[face as usize].origin as usize + size - place) % size;
        Ok((face, frame.turned(kind, steps)))
    }

    /// Finds what the limit is at a point, and leaves its coefficients in `scratch[0]`.
    fn coefficients<T: Value>(
        &self,
        form: &[T],
        degree: usize,
        face: u32,
        mut frame: Frame,
        scratch: &mut [Vec<T>; 2],
    ) -> Found<'_> {
        let kind = self.hierarchy.split_kind();
        let patch = self.patches[face as usize];
        let mut table = self.tables.get(patch.table as usize);
        self.gather(form, degree, &patch, table, &mut scratch[0]);
        for step in 0.. {
            if table.children.is_empty() || step >= MAX_DEPTH {
                break;
            }
            let (number, below) = frame.descend(kind);
            let child = &table.children[number];
            frame = below.turned(kind, child.turn);
            replace(&child.maps[degree], scratch);
            match child.table {
                Some(number) => table = self.tables.get(number),
                None => return Found::Patch(frame),
            }
        }
        if let Some(rows) = &table.polynomial {
            replace(&rows[degree], scratch);
            return Found::Patch(frame);
        }
        Found::Vertex(table.vertex.as_ref().expect("a table without a polynomial has one of its vertex"))
    }

    fn gather<T: Value>(&self, form: &[T], degree: usize, patch: &Patch, table: &Table, out: &mut Vec<T>) {
        let before: usize = table.sizes[..degree].iter().sum();
        let start = patch.cells as usize + before;
        let cells = &self.cells[start..start + table.sizes[degree]];
        out.clear();
        match degree {
            1 => out.extend(cells.iter().map(|&h| {
                let x = form[(h >> 1) as usize];
                if h & 1 == 0 { x } else { x * -1.0 }
            })),
            _ => out.extend(cells.iter().map(|&cell| form[cell as usize])),
        }
    }
}

/// `scratch[0] = matrix scratch[0]`.
fn replace<T: Value>(matrix: &Csr, scratch: &mut [Vec<T>; 2]) {
    let [x, y] = scratch;
    y.clear();
    let zero = x[0] * 0.0;
    for i in 0..matrix.rows() {
        let (columns, weights) = row_of(matrix, i);
        let terms = std::iter::zip(columns, weights);
        y.push(terms.fold(zero, |sum, (&j, &weight)| sum + x[j as usize] * weight));
    }
    std::mem::swap(x, y);
}

/// The corner of each face from which its surroundings are told; `None` if features share a face that it cannot
/// be told from.
fn origins(level: &Level, kind: SplitKind) -> Option<Vec<u32>> {
    let (mesh, tags) = (level.mesh(), level.tags());
    if kind == SplitKind::Quad && (0..mesh.num_faces() as u32).any(|f| mesh.face_size(f) != 4) {
        return None;
    }
    let plain = plain_vertices(kind, mesh, tags);
    let find = |face| origin(mesh, tags, |v| plain[v as usize], mesh.corners(face).start);
    (0..mesh.num_faces() as u32).into_par_iter().map(find).collect()
}

/// For each face of the finest level, whether an irregular vertex pulls at it from beside it, and the corner that
/// its surroundings are then told from; `origins` are those of the level above.
fn beside(hierarchy: &Hierarchy, tables: &Tables, origins: &[u32]) -> Vec<Option<(Key, u32)>> {
    let level = hierarchy.num_levels();
    let (above, mesh) = (hierarchy.level(level - 1), hierarchy.finest().mesh());
    let tags = hierarchy.finest().tags();
    let plain = plain_vertices(hierarchy.split_kind(), mesh, tags);
    let split = hierarchy.refinement(level).split();
    let mut beside = vec![None; mesh.num_faces()];
    for &corner in origins {
        let (configuration, _) = around_face(above.mesh(), above.tags(), corner);
        for child in (1..4).filter(|_| tables.pulls(configuration)) {
            let corner = child_corner(split, above.mesh(), mesh, corner, child);
            let start = origin(mesh, tags, |v| plain[v as usize], corner).expect("features stay apart");
            beside[mesh.corner_face(corner) as usize] = Some((Key::Beside(configuration, child), start));
        }
    }
    beside
}

/// A crease vertex moves by its two sharp edges: they must be those that bound the faces in question.
fn check(mesh: &Mesh, c: Configuration, fan: &[u32]) -> Result<(), SurfaceError> {
    let first = mesh.corner_half_edge(fan[0]).edge();
    let last = mesh.corner_half_edge(mesh.previous_corner(fan[fan.len() - 1])).edge();
    match c.rule == Rule::Crease && (c.cyclic || first == last) {
        true => Err(SurfaceError::NonManifold { vertex: mesh.corner_vertex(fan[0]) }),
        false => Ok(()),
    }
}
