//! Smoothing of cochains on one level, `C_r = I + d K_{r-1} + K_r d`.

use rayon::prelude::*;

use super::NONE;
use super::complex::{Complex, HalfFace};
use super::incidence::Incidence;
use super::patch::{Ground, Homotopy};
use crate::cochain::{Cochain, Differential};
use crate::sparse::Value;
use crate::topology::HalfEdge;

/// What smoothing does at the boundary of the solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Boundary {
    /// The boundary is smoothed by itself, as a surface: by Loop's scheme and half-box splines where it is regular.
    #[default]
    Loop,
    /// The boundary stays where it is: the linear schemes hold on it.
    Fixed,
}

/// The weights of a tetrahedron and an octahedron in the fallback for triangles: cells of one density are then left
/// alone.
const SHARES: [f64; 2] = [4.0, 1.0];
/// How far one step of the fallback moves an edge, and a triangle.
const MU: f64 = 4.0 / 9.0;
const NU: f64 = 1.0 / 24.0;
/// The steps of the fallback: together they spread as far as the kernel of the lattice.
const STEPS: usize = 6;

/// Smoothing of the cochains of one complex.
///
/// `C_r = I + d K_{r-1} + K_r d` commutes with `d` whatever the `K` are, as `d d = 0`. They are:
///
/// ```text
/// K0(v)  mean over the cells at v:  tetrahedron  17/48 sum (v -> w), w its other three vertices
///                                   octahedron   15/96 sum (v -> w) + 7/96 sum (w -> v'), w the four next to v,
///                                                v' the one opposite
/// K1, K2 where the complex is like the lattice round the edge or triangle: what smoothing there needs, 76 triangles
///        an edge and 26 cells a triangle; elsewhere k_r (I + T + .. + T^5) with T = I + d k + k d,
///        k1(e) = -4/9 mean [dt : e] t over the triangles at e,   k2(t) = -1/24 sum [dc : t] w c, w = 4 for
///        tetrahedra, 1 for octahedra
/// ```
///
/// `I + K0 d` is the vertex average of Schaefer, Hakenberg and Warren (2004). Where the complex is the lattice, every
/// `C_r` is the same convolution: 1/8 of a cell, 1/16 of each of its translates to the twelve neighbours, 1/48 of
/// each to the six vertices opposite in an octahedron. On boundaries, [`Boundary`].
#[derive(Clone, Debug)]
pub struct Smoothing {
    boundary: Boundary,
    cells_of_vertices: Incidence,
    triangles_of_edges: Incidence,
    cells_of_triangles: Vec<[u32; 2]>,
    /// A tetrahedron from which the lattice is laid; [`NONE`] where the complex is not like it.
    tet_of_edge: Vec<u32>,
    tet_of_triangle: Vec<u32>,
    on_boundary: [Vec<bool>; 2],
}

impl Smoothing {
    /// Looks at the neighbourhood of every edge and triangle. Costs one pass over the complex.
    pub fn new(complex: &Complex, boundary: Boundary) -> Self {
        let tets = complex.tets().len();
        let vertices_of = |cell: usize| complex.cell_vertices(cell as u32).iter().copied();
        let cells_of_vertices = Incidence::new(complex.num_cells(0), complex.num_cells(3), vertices_of);
        let sides = |t: usize| complex.triangles()[t].into_iter().map(HalfEdge::edge);
        let triangles_of_edges = Incidence::new(complex.num_cells(1), complex.num_cells(2), sides);
        let cells_of_triangles =
            complex.cells_of_triangles().expect("a complex has two cells at most at a triangle");

        let is_boundary = |cells: &[u32; 2]| cells[0] != NONE && cells[1] == NONE;
        let mut on_boundary = [vec![false; complex.num_cells(0)], vec![false; complex.num_cells(1)]];
        for (sides, cells) in complex.triangles().iter().zip(&cells_of_triangles) {
            if is_boundary(cells) {
                for &h in sides {
                    on_boundary[0][complex.tail(h) as usize] = true;
                    on_boundary[1][h.edge() as usize] = true;
                }
            }
        }
        let mut smoothing = Smoothing {
            boundary,
            cells_of_vertices,
            triangles_of_edges,
            cells_of_triangles,
            tet_of_edge: vec![NONE; complex.num_cells(1)],
            tet_of_triangle: vec![NONE; complex.num_cells(2)],
            on_boundary,
        };
        let homotopy = Homotopy::get();
        // The star of a vertex in the lattice has fourteen cells, two of each kind at an edge.
        let regular =
            |v: u32| !smoothing.on_boundary[0][v as usize] && smoothing.cells_of_vertices.of(v).len() == 14;
        let ground = smoothing.ground(complex);
        let laid_edge = |e: usize| {
            let ends = complex.edges()[e];
            let tet = ends.iter().all(|&v| regular(v)).then(|| {
                let triangles = smoothing.triangles_of_edges.of(e as u32);
                let cells = triangles.iter().flat_map(|&t| smoothing.cells_of_triangles[t as usize]);
                cells.into_iter().find(|&cell| (cell as usize) < tets)
            });
            let fits = |&tet: &u32| homotopy.edge_row(&ground, tet, led_by(complex, tet, &ends), |_, _| ());
            tet.flatten().filter(fits).unwrap_or(NONE)
        };
        let laid_triangle = |t: usize| {
            let cells = smoothing.cells_of_triangles[t];
            let tet = cells.into_iter().find(|&cell| (cell as usize) < tets);
            let tet = tet.filter(|_| complex.triangle_vertices(t as u32).into_iter().all(regular));
            let fits = |&tet: &u32| homotopy.triangle_row(&ground, tet, opposed(complex, tet, t), |_, _| ());
            tet.filter(fits).unwrap_or(NONE)
        };
        let edges: Vec<u32> = (0..complex.num_cells(1)).into_par_iter().map(laid_edge).collect();
        let triangles: Vec<u32> = (0..complex.num_cells(2)).into_par_iter().map(laid_triangle).collect();
        (smoothing.tet_of_edge, smoothing.tet_of_triangle) = (edges, triangles);
        smoothing
    }

    fn ground<'a>(&'a self, complex: &'a Complex) -> Ground<'a> {
        Ground { complex, cells_of_triangles: &self.cells_of_triangles }
    }

    /// Whether smoothing at edge `e` is that of the lattice.
    pub fn is_regular_edge(&self, e: u32) -> bool {
        self.tet_of_edge[e as usize] != NONE
    }

    /// Whether smoothing at triangle `t` is that of the lattice.
    pub fn is_regular_triangle(&self, t: u32) -> bool {
        self.tet_of_triangle[t as usize] != NONE
    }

    /// `C_K c`. The complex is the one that this was made for.
    ///
    /// # Panics
    /// If the cochain belongs to another complex.
    pub fn apply<const K: usize, T: Value>(&self, complex: &Complex, c: &Cochain<K, T>) -> Cochain<K, T> {
        const { assert!(K <= 3, "no such forms in space") }
        assert_eq!(c.len(), complex.num_cells(K), "a {K}-cochain of another complex");
        let c = c.values();
        if c.is_empty() || complex.num_cells(1) == 0 {
            return Cochain::new(c.to_vec());
        }
        Cochain::new(match K {
            0 => sum(c, &self.k0(complex, &d::<0, T>(complex, c))),
            1 => {
                let below = d::<0, T>(complex, &self.k0(complex, c));
                sum(&sum(c, &below), &self.k1(complex, &d::<1, T>(complex, c)))
            }
            2 => {
                let below = d::<1, T>(complex, &self.k1(complex, c));
                sum(&sum(c, &below), &self.k2(complex, &d::<2, T>(complex, c)))
            }
            _ => sum(c, &d::<2, T>(complex, &self.k2(complex, c))),
        })
    }

    /// From edges to vertices.
    fn k0<T: Value>(&self, complex: &Complex, w: &[T]) -> Vec<T> {
        let (zero, tets) = (T::zero(), complex.tets().len());
        let along = |h: HalfEdge| w[h.edge() as usize] * h.sign();
        let in_solid = |v: u32| {
            let cells = self.cells_of_vertices.of(v);
            let mut total = zero;
            for &cell in cells {
                let i = complex.cell_vertices(cell).iter().position(|&own| own == v).unwrap_or(0);
                match (cell as usize).checked_sub(tets) {
                    None => {
                        for j in (0..4).filter(|&j| j != i) {
                            total = total + along(complex.tet_edge(cell as usize, i, j)) * (17.0 / 48.0);
                        }
                    }
                    Some(o) => {
                        for j in (0..6).filter(|&j| j % 3 != i % 3) {
                            total = total + along(complex.oct_edge(o, i, j)) * (15.0 / 96.0);
                            total = total + along(complex.oct_edge(o, j, (i + 3) % 6)) * (7.0 / 96.0);
                        }
                    }
                }
            }
            total * (1.0 / cells.len().max(1) as f64)
        };
        // The mean over its boundary triangles of 3/8 of both spokes.
        let on_surface = |v: u32| {
            let (mut total, mut count) = (zero, 0.0);
            for &cell in self.cells_of_vertices.of(v) {
                for face in complex.cell_faces(cell) {
                    let t = face.triangle();
                    let [x, y, z] = complex.triangles()[t as usize];
                    let spokes = [x, y, z].into_iter().position(|h| complex.tail(h) == v);
                    if let Some(k) = spokes.filter(|_| self.is_boundary(t)) {
                        let (out, back) = ([x, y, z][k], [x, y, z][(k + 2) % 3].twin());
                        total = total + (along(out) + along(back)) * 0.375;
                        count += 1.0;
                    }
                }
            }
            total * (1.0 / count)
        };
        let value = |v: u32| match (self.on_boundary[0][v as usize], self.boundary) {
            (false, _) => in_solid(v),
            (true, Boundary::Loop) => on_surface(v),
            (true, Boundary::Fixed) => zero,
        };
        (0..complex.num_cells(0) as u32).into_par_iter().map(value).collect()
    }

    /// From triangles to edges.
    fn k1<T: Value>(&self, complex: &Complex, f: &[T]) -> Vec<T> {
        if f.is_empty() {
            return vec![];
        }
        let (zero, homotopy, ground) = (T::zero(), Homotopy::get(), self.ground(complex));
        let spread = self.needs_fallback(&self.tet_of_edge, &self.on_boundary[1]).then(|| {
            self.spread(f, |f| {
                let below = d::<1, T>(complex, &self.fallback_k1(complex, f));
                sum(&sum(f, &below), &self.fallback_k2(complex, &d::<2, T>(complex, f)))
            })
        });
        let spread = spread.map(|f| self.fallback_k1(complex, &f));
        let value = |e: usize| match (self.on_boundary[1][e], self.tet_of_edge[e]) {
            (true, _) => self.surface_k1(complex, f, e as u32),
            (_, NONE) => spread.as_ref().map_or(zero, |spread| spread[e]),
            (_, tet) => {
                let (mut total, corners) = (zero, led_by(complex, tet, &complex.edges()[e]));
                homotopy.edge_row(&ground, tet, corners, |t, weight| {
                    total = total + f[t as usize] * weight;
                });
                total
            }
        };
        (0..complex.num_cells(1)).into_par_iter().map(value).collect()
    }

    /// From cells to triangles.
    fn k2<T: Value>(&self, complex: &Complex, m: &[T]) -> Vec<T> {
        if m.is_empty() {
            return vec![];
        }
        let (zero, homotopy, ground) = (T::zero(), Homotopy::get(), self.ground(complex));
        let spread = self.tet_of_triangle.contains(&NONE).then(|| {
            let moved = |m: &[T]| sum(m, &d::<2, T>(complex, &self.fallback_k2(complex, m)));
            self.fallback_k2(complex, &self.spread(m, moved))
        });
        let value = |t: usize| match self.tet_of_triangle[t] {
            NONE => spread.as_ref().map_or(zero, |spread| spread[t]),
            tet => {
                let (mut total, corners) = (zero, opposed(complex, tet, t));
                homotopy.triangle_row(&ground, tet, corners, |cell, weight| {
                    total = total + m[cell as usize] * weight;
                });
                total
            }
        };
        (0..complex.num_cells(2)).into_par_iter().map(value).collect()
    }

    fn needs_fallback(&self, tets: &[u32], on_boundary: &[bool]) -> bool {
        tets.iter().zip(on_boundary).any(|(&tet, &on_boundary)| tet == NONE && !on_boundary)
    }

    /// `(I + T + .. + T^5) c`.
    fn spread<T: Value>(&self, c: &[T], step: impl Fn(&[T]) -> Vec<T>) -> Vec<T> {
        let (mut total, mut moved) = (c.to_vec(), c.to_vec());
        for _ in 1..STEPS {
            moved = step(&moved);
            total = sum(&total, &moved);
        }
        total
    }

    /// `k1`, zero on the boundary.
    fn fallback_k1<T: Value>(&self, complex: &Complex, f: &[T]) -> Vec<T> {
        let zero = T::zero();
        let value = |e: u32| {
            let triangles = self.triangles_of_edges.of(e);
            if self.on_boundary[1][e as usize] || triangles.is_empty() {
                return zero;
            }
            let coboundary =
                triangles.iter().fold(zero, |sum, &t| sum + f[t as usize] * sign_in(complex, t, e));
            coboundary * (-MU / triangles.len() as f64)
        };
        (0..complex.num_cells(1) as u32).into_par_iter().map(value).collect()
    }

    /// `k2`, zero on the boundary.
    fn fallback_k2<T: Value>(&self, complex: &Complex, m: &[T]) -> Vec<T> {
        let (zero, tets) = (T::zero(), complex.tets().len());
        let value = |t: usize| {
            let cells = self.cells_of_triangles[t];
            if cells.contains(&NONE) {
                return zero;
            }
            cells.into_iter().fold(zero, |sum, cell| {
                let side = complex.cell_faces(cell).iter().find(|face| face.triangle() == t as u32);
                let share = SHARES[usize::from(cell as usize >= tets)];
                sum + m[cell as usize] * (-NU * share * side.map_or(0.0, |face: &HalfFace| face.sign()))
            })
        };
        (0..complex.num_cells(2)).into_par_iter().map(value).collect()
    }

    /// `K1` of a boundary edge, of the surface that the boundary is: over both boundary triangles at the edge,
    /// `-1/4` of the triangle and `-1/8` of each of those across its other sides, as they are turned seen from the
    /// edge. Where the surface is regular, that is what moving the edge to its six neighbours sweeps.
    fn surface_k1<T: Value>(&self, complex: &Complex, f: &[T], e: u32) -> T {
        let zero = T::zero();
        if self.boundary == Boundary::Fixed {
            return zero;
        }
        let beside = |e: u32| self.triangles_of_edges.of(e).iter().copied().filter(|&t| self.is_boundary(t));
        let (mut total, count) = (zero, beside(e).count() as f64);
        for t in beside(e) {
            let sign = sign_in(complex, t, e);
            total = total - f[t as usize] * (0.25 * sign);
            for h in complex.triangles()[t as usize].into_iter().filter(|h| h.edge() != e) {
                let mut across = beside(h.edge()).filter(|&other| other != t);
                if let (Some(other), None) = (across.next(), across.next()) {
                    let turn = -h.sign() * sign_in(complex, other, h.edge());
                    total = total - f[other as usize] * (0.125 * sign * turn);
                }
            }
        }
        total * (2.0 / count)
    }

    fn is_boundary(&self, t: u32) -> bool {
        let [first, second] = self.cells_of_triangles[t as usize];
        first != NONE && second == NONE
    }
}

/// The sign of an edge in the boundary of a triangle.
fn sign_in(complex: &Complex, t: u32, e: u32) -> f64 {
    let side = complex.triangles()[t as usize].into_iter().find(|h| h.edge() == e);
    side.map_or(0.0, HalfEdge::sign)
}

/// The vertices of a tetrahedron, two of them first.
fn led_by(complex: &Complex, tet: u32, [a, b]: &[u32; 2]) -> [u32; 4] {
    let own = complex.tets()[tet as usize];
    let mut rest = own.into_iter().filter(|v| v != a && v != b);
    [*a, *b, rest.next().unwrap_or(NONE), rest.next().unwrap_or(NONE)]
}

/// The vertices of a tetrahedron: first the one opposite a triangle, then the triangle's in their order.
fn opposed(complex: &Complex, tet: u32, t: usize) -> [u32; 4] {
    let [a, b, c] = complex.triangle_vertices(t as u32);
    let own = complex.tets()[tet as usize];
    [own.into_iter().find(|v| ![a, b, c].contains(v)).unwrap_or(NONE), a, b, c]
}

fn d<const K: usize, T: Value>(complex: &Complex, c: &[T]) -> Vec<T>
where
    Complex: Differential<K>,
{
    Differential::<K>::derive(complex, c)
}

fn sum<T: Value>(a: &[T], b: &[T]) -> Vec<T> {
    if b.is_empty() {
        return a.to_vec();
    }
    a.par_iter().zip(b).map(|(&a, &b)| a + b).collect()
}
