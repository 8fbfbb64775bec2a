//! Forms at points of space.

use std::sync::OnceLock;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::complex::{Complex, OCT_EDGES, OCT_FACES, TET_EDGES};
use super::linear::Linear;
use super::whitney::WhitneyTet;
use crate::cochain::{Cochain, Quantity};
use crate::sparse::{Csr, dot, row_of};

type Vec3 = Vector3<f64>;
type Positions = Cochain<0, Vec3>;

/// How far, in barycentric coordinates, a point may lie outside a cell that it is taken to be in.
const INSIDE: f64 = 1e-9;
/// How often an octahedron is split at most. Three quarters of it are in octahedra again, so one point in 100 000 gets
/// here, and those on the planes through four of its vertices.
const DEPTH: usize = 40;

/// Evaluates cochains at points: Whitney forms in tetrahedra, and in octahedra what the linear scheme refines them to.
///
/// On the control mesh this is the limit of the linear scheme. On a finer level it is one inside the tetrahedra of that
/// level; so for smooth schemes it tends to their limit. In an octahedron the limit of a 2-form is bounded but jumps at
/// the vertices; where splitting again and again leads to no tetrahedron, as on the planes through four vertices, it is
/// that of one beside.
///
/// The curl of a 1-form is the flux field of its `d1`, the divergence of a 2-form the density of its `d2`:
///
/// ```
/// use formwork::cochain::Cochain;
/// use formwork::octet::{Complex, Sampler};
/// use formwork::nalgebra::Vector3;
///
/// let tet = Complex::new(4, vec![[0, 1, 2, 3]], vec![])?;
/// let x = Cochain::<0, _>::new(vec![Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()]);
/// // The rotation (-y, x, 0) about the third axis: circulations along the edges, by the midpoint rule.
/// let form = Cochain::<1>::new(
///     tet.edges().iter().map(|&[a, b]| x[a as usize].x * x[b as usize].y - x[a as usize].y * x[b as usize].x).collect(),
/// );
/// let sampler = Sampler::new(&tet, &x);
/// let point = Vector3::new(0.2, 0.1, 0.3);
/// let curl = form.exterior_derivative(&tet);
/// assert!((sampler.vector(&form, point).unwrap() - Vector3::new(-0.1, 0.2, 0.0)).norm() < 1e-15);
/// assert!((sampler.flux(&curl, point).unwrap() - Vector3::new(0.0, 0.0, 2.0)).norm() < 1e-14);
/// assert_eq!(sampler.density(&curl.exterior_derivative(&tet), point), Some(0.0));
/// # Ok::<(), formwork::octet::ComplexError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Sampler<'a> {
    complex: &'a Complex,
    positions: &'a Positions,
    low: Vec3,
    size: Vec3,
    shape: [usize; 3],
    /// The cells that may meet box `i` are `cells[offsets[i]..offsets[i + 1]]`.
    offsets: Vec<usize>,
    cells: Vec<u32>,
}

/// What a cell or a part of it is evaluated from: positions of its vertices and the values of its own sides.
#[derive(Clone, Copy)]
struct Piece<const V: usize, const E: usize, const F: usize> {
    vertices: [Vec3; V],
    values: [f64; V],
    circulations: [f64; E],
    fluxes: [f64; F],
    integral: f64,
}

type Tet = Piece<4, 6, 4>;
type Oct = Piece<6, 12, 8>;

/// Which cochain is asked for.
#[derive(Clone, Copy)]
enum Forms<'a> {
    Zero(&'a [f64]),
    One(&'a [f64]),
    Two(&'a [f64]),
    Three(&'a [f64]),
}

impl<'a> Sampler<'a> {
    /// Sorts the cells into boxes, about one a cell.
    ///
    /// # Panics
    /// If the positions belong to another complex.
    pub fn new(complex: &'a Complex, positions: &'a Positions) -> Self {
        assert_eq!(positions.len(), complex.num_cells(0), "positions of another complex");
        let points = positions.values().iter().copied();
        let low = points.clone().reduce(|a, b| a.inf(&b)).unwrap_or_default();
        let high = points.reduce(|a, b| a.sup(&b)).unwrap_or_default();
        let cells = complex.num_cells(3);
        let extent = (high - low).map(|x| x.max(1e-300));
        let edge = (extent.product() / cells.max(1) as f64).cbrt();
        let shape: [usize; 3] = std::array::from_fn(|k| ((extent[k] / edge) as usize).clamp(1, 1024));
        let size = Vec3::from_fn(|k, _| extent[k] / shape[k] as f64);
        let mut sampler =
            Sampler { complex, positions, low, size, shape, offsets: Vec::new(), cells: Vec::new() };

        let boxes: Vec<[[usize; 3]; 2]> =
            (0..cells as u32).into_par_iter().map(|cell| sampler.boxes_of(cell)).collect();
        let mut offsets = vec![0usize; shape.iter().product::<usize>() + 1];
        for &range in &boxes {
            sampler.each_box(range, |i| offsets[i + 1] += 1);
        }
        for i in 1..offsets.len() {
            offsets[i] += offsets[i - 1];
        }
        let mut next = offsets.clone();
        let mut filed = vec![0; offsets[offsets.len() - 1]];
        for (cell, &range) in (0..).zip(&boxes) {
            sampler.each_box(range, |i| {
                filed[next[i]] = cell;
                next[i] += 1;
            });
        }
        (sampler.offsets, sampler.cells) = (offsets, filed);
        sampler
    }

    fn box_of(&self, x: Vec3) -> [usize; 3] {
        std::array::from_fn(|k| {
            (((x[k] - self.low[k]) / self.size[k]).max(0.0) as usize).min(self.shape[k] - 1)
        })
    }

    fn boxes_of(&self, cell: u32) -> [[usize; 3]; 2] {
        let points = self.complex.cell_vertices(cell).iter().map(|&v| self.positions[v as usize]);
        let low = points.clone().reduce(|a, b| a.inf(&b)).unwrap_or_default();
        let high = points.reduce(|a, b| a.sup(&b)).unwrap_or_default();
        let slack = self.size * INSIDE;
        [self.box_of(low - slack), self.box_of(high + slack)]
    }

    fn each_box(&self, [low, high]: [[usize; 3]; 2], mut visit: impl FnMut(usize)) {
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    visit((x * self.shape[1] + y) * self.shape[2] + z);
                }
            }
        }
    }

    /// The cell that a point lies in; on a common side, the first.
    pub fn locate(&self, x: Vec3) -> Option<u32> {
        if !x.iter().all(|x| x.is_finite()) {
            return None;
        }
        let [i, j, k] = self.box_of(x);
        let index = (i * self.shape[1] + j) * self.shape[2] + k;
        let near = &self.cells[self.offsets[index]..self.offsets[index + 1]];
        near.iter().copied().find(|&cell| {
            let vertices = self.complex.cell_vertices(cell);
            match vertices.len() {
                4 => depth(std::array::from_fn(|i| self.positions[vertices[i] as usize]), x) >= -INSIDE,
                _ => {
                    depth_in_oct(&std::array::from_fn(|i| self.positions[vertices[i] as usize]), x) >= -INSIDE
                }
            }
        })
    }

    /// A 0-form at a point; `None` outside the solid.
    ///
    /// # Panics
    /// Here and below, if the cochain belongs to another complex.
    pub fn value(&self, form: &Cochain<0>, x: Vec3) -> Option<f64> {
        assert_eq!(form.len(), self.complex.num_cells(0), "a 0-cochain of another complex");
        self.at(Forms::Zero(form.values()), x, |forms, tet, x| forms.value(tet.values, x))
    }

    /// A 1-form as the vector whose dot products it is.
    pub fn vector(&self, form: &Cochain<1>, x: Vec3) -> Option<Vec3> {
        assert_eq!(form.len(), self.complex.num_cells(1), "a 1-cochain of another complex");
        self.at(Forms::One(form.values()), x, |forms, tet, x| forms.vector(tet.circulations, x))
    }

    /// A 2-form as the vector whose flux it is.
    pub fn flux(&self, form: &Cochain<2>, x: Vec3) -> Option<Vec3> {
        assert_eq!(form.len(), self.complex.num_cells(2), "a 2-cochain of another complex");
        self.at(Forms::Two(form.values()), x, |forms, tet, x| forms.flux(tet.fluxes, x))
    }

    /// A 3-form as its density.
    pub fn density(&self, form: &Cochain<3>, x: Vec3) -> Option<f64> {
        assert_eq!(form.len(), self.complex.num_cells(3), "a 3-cochain of another complex");
        self.at(Forms::Three(form.values()), x, |forms, tet, _| forms.density(tet.integral))
    }

    fn at<T>(&self, form: Forms, x: Vec3, evaluate: impl Fn(&WhitneyTet, &Tet, Vec3) -> T) -> Option<T> {
        let (cell, positions) = (self.locate(x)?, self.positions.values());
        let (tet, x) = match (cell as usize).checked_sub(self.complex.tets().len()) {
            None => (tet_of(self.complex, positions, form, cell as usize), x),
            Some(o) => descend(oct_of(self.complex, positions, form, o), x),
        };
        WhitneyTet::new(tet.vertices).map(|forms| evaluate(&forms, &tet, x))
    }
}

fn tet_of(complex: &Complex, positions: &[Vec3], form: Forms, t: usize) -> Tet {
    let v = complex.tets[t];
    let mut piece = Piece {
        vertices: v.map(|v| positions[v as usize]),
        values: [0.0; 4],
        circulations: [0.0; 6],
        fluxes: [0.0; 4],
        integral: 0.0,
    };
    match form {
        Forms::Zero(f) => piece.values = v.map(|v| f[v as usize]),
        Forms::One(w) => {
            piece.circulations = TET_EDGES.map(|[i, j]| {
                let h = complex.tet_edge(t, i, j);
                w[h.edge() as usize] * h.sign()
            });
        }
        Forms::Two(f) => piece.fluxes = complex.tet_faces[t].map(|s| f[s.triangle() as usize] * s.sign()),
        Forms::Three(m) => piece.integral = m[t],
    }
    piece
}

fn oct_of(complex: &Complex, positions: &[Vec3], form: Forms, o: usize) -> Oct {
    let v = complex.octs[o];
    let mut piece = Piece {
        vertices: v.map(|v| positions[v as usize]),
        values: [0.0; 6],
        circulations: [0.0; 12],
        fluxes: [0.0; 8],
        integral: 0.0,
    };
    match form {
        Forms::Zero(f) => piece.values = v.map(|v| f[v as usize]),
        Forms::One(w) => {
            piece.circulations = OCT_EDGES.map(|[i, j]| {
                let h = complex.oct_edge(o, i, j);
                w[h.edge() as usize] * h.sign()
            });
        }
        Forms::Two(f) => piece.fluxes = complex.oct_faces[o].map(|s| f[s.triangle() as usize] * s.sign()),
        Forms::Three(m) => piece.integral = m[complex.tets.len() + o],
    }
    piece
}

/// The tetrahedron round a point in an octahedron that is refined there again and again, and where the point is in
/// it. Each part is moved to the origin and drawn at twice its size, with the values of forms that have the same
/// vectors then: so no digits are lost on the way down.
fn descend(mut oct: Oct, mut x: Vec3) -> (Tet, Vec3) {
    // One octahedron and its children, and what refines its cochains: the same for all.
    static SPLIT: OnceLock<([Complex; 2], [Csr; 4])> = OnceLock::new();
    let ([whole, parts], operators) = SPLIT.get_or_init(|| {
        let whole = Complex::new(6, vec![], vec![[0, 1, 2, 3, 4, 5]]).expect("an octahedron");
        let parts = whole.split().expect("its children");
        let operators = [0, 1, 2, 3].map(|r| Linear::default().operator(&whole, r));
        ([whole, parts], operators)
    });
    let [s0, s1, s2, s3] = operators;
    for level in 0.. {
        // The cochains of the one octahedron, oriented as its complex is.
        let mut edges = [0.0; 12];
        for (value, [i, j]) in oct.circulations.iter().zip(OCT_EDGES) {
            let h = whole.oct_edge(0, i, j);
            edges[h.edge() as usize] = value * h.sign();
        }
        let mut triangles = [0.0; 8];
        for (value, side) in oct.fluxes.iter().zip(whole.oct_faces[0]) {
            triangles[side.triangle() as usize] = value * side.sign();
        }
        let positions = refine(s0, &oct.vertices);
        let values = refine(s0, &oct.values);
        let edges = refine(s1, &edges);
        let triangles = refine(s2, &triangles);
        let cells = refine(s3, &[oct.integral]);

        let at = |v: u32| positions[v as usize];
        let in_tet = |t: usize| depth(parts.tets[t].map(at), x);
        let in_oct = |o: usize| depth_in_oct(&parts.octs[o].map(at), x);
        let best = |depths: Vec<f64>| -> (usize, f64) {
            depths
                .into_iter()
                .enumerate()
                .fold((0, f64::MIN), |best, next| if next.1 > best.1 { next } else { best })
        };
        let (t, tet_depth) = best((0..8).map(in_tet).collect());
        let (o, oct_depth) = best((0..6).map(in_oct).collect());
        if tet_depth >= oct_depth.min(-INSIDE) || level == DEPTH {
            let mut tet = tet_of(parts, &positions, Forms::Zero(&values), t);
            tet.circulations = tet_of(parts, &positions, Forms::One(&edges), t).circulations;
            tet.fluxes = tet_of(parts, &positions, Forms::Two(&triangles), t).fluxes;
            tet.integral = cells[t];
            return (tet, x);
        }
        let part = oct_of(parts, &positions, Forms::Zero(&values), o);
        let origin = part.vertices.iter().sum::<Vec3>() / 6.0;
        x = (x - origin) * 2.0;
        oct = Oct {
            vertices: part.vertices.map(|p| (p - origin) * 2.0),
            values: part.values,
            circulations: oct_of(parts, &positions, Forms::One(&edges), o).circulations.map(|w| w * 2.0),
            fluxes: oct_of(parts, &positions, Forms::Two(&triangles), o).fluxes.map(|f| f * 4.0),
            integral: cells[8 + o] * 8.0,
        };
    }
    unreachable!("the loop ends at its depth")
}

/// A few values refined, by this thread alone.
fn refine<T: Quantity>(operator: &Csr, x: &[T]) -> Vec<T> {
    (0..operator.rows()).map(|i| dot(row_of(operator, i), x).unwrap_or(T::zero())).collect()
}

/// The least barycentric coordinate of a point: how deep in a tetrahedron it lies.
fn depth(vertices: [Vec3; 4], x: Vec3) -> f64 {
    WhitneyTet::new(vertices).map_or(f64::MIN, |tet| tet.barycentric(x).into_iter().fold(f64::MAX, f64::min))
}

/// How deep in an octahedron, as one of the tetrahedra from its centroid to its faces.
fn depth_in_oct(vertices: &[Vec3; 6], x: Vec3) -> f64 {
    let centroid = vertices.iter().sum::<Vec3>() / 6.0;
    let tet = |face: [usize; 3]| [centroid, vertices[face[0]], vertices[face[1]], vertices[face[2]]];
    OCT_FACES.into_iter().map(|face| depth(tet(face), x)).fold(f64::MIN, f64::max)
}
