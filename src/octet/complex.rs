use rayon::prelude::*;

use super::lookup::Lookup;
use crate::cochain::{Differential, d0};
use crate::sparse::{Csr, Quantity, assemble};
use crate::topology::HalfEdge;

/// The faces of a positive tetrahedron, outward; face `i` lies opposite vertex `i`.
pub const TET_FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// The edges of a tetrahedron.
pub const TET_EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// The faces of a positive octahedron, outward. Bit `k` of a face's number says which vertex of axis `k` it has:
/// vertex `k` where it is clear, the opposite one, `k + 3`, where it is set.
pub const OCT_FACES: [[usize; 3]; 8] =
    [[0, 1, 2], [3, 2, 1], [0, 2, 4], [3, 4, 2], [0, 5, 1], [3, 1, 5], [0, 4, 5], [3, 5, 4]];

/// The edges of an octahedron.
pub const OCT_EDGES: [[usize; 2]; 12] =
    [[0, 1], [0, 2], [0, 4], [0, 5], [1, 2], [1, 3], [1, 5], [2, 3], [2, 4], [3, 4], [3, 5], [4, 5]];

/// A triangle together with a side.
///
/// `2t` is the side from which triangle `t` runs counter-clockwise, `2t + 1` the other. A cell names its boundary
/// by half-faces, which carry the signs of `d2`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct HalfFace(pub u32);

impl HalfFace {
    /// Triangle `t` as it is oriented, or the other way round.
    #[inline]
    pub fn new(triangle: u32, along: bool) -> Self {
        HalfFace(2 * triangle + u32::from(!along))
    }

    /// The triangle.
    #[inline]
    pub fn triangle(self) -> u32 {
        self.0 >> 1
    }

    /// `+1` as the triangle is oriented, else `-1`.
    #[inline]
    pub fn sign(self) -> f64 {
        if self.0 & 1 == 0 { 1.0 } else { -1.0 }
    }
}

/// A complex of tetrahedra and octahedra with oriented edges, triangles and cells.
///
/// Cells are tetrahedra, then octahedra. A tetrahedron `(v0, .., v3)` is positive if `det(v1 - v0, v2 - v0, v3 - v0) > 0`;
/// an octahedron `(v0, .., v5)`, with the opposite pairs (0,3), (1,4), (2,5), if `det(v0 - v3, v1 - v4, v2 - v5) > 0`.
/// A cell may be stored either way round: its 3-cochain refers to the order that is stored. Edges and triangles
/// may be oriented and numbered in any way.
///
/// Invariants: no two edges have the same vertices, nor two triangles; all faces of a cell are triangles of the
/// complex, and all sides of a triangle edges; a triangle has at most two cells.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Complex {
    pub(super) num_vertices: usize,
    pub(super) edges: Vec<[u32; 2]>,
    /// The boundary of each triangle: from its first vertex to its second, and so on.
    pub(super) triangles: Vec<[HalfEdge; 3]>,
    pub(super) tets: Vec<[u32; 4]>,
    pub(super) octs: Vec<[u32; 6]>,
    pub(super) tet_faces: Vec<[HalfFace; 4]>,
    pub(super) oct_faces: Vec<[HalfFace; 8]>,
}

/// Arrays that are not a complex. Numbers start at 0; octahedra are counted after the tetrahedra.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum ComplexError {
    #[error("{kind} {index} names vertex {vertex}, but there are {num_vertices}: vertices count from 0")]
    VertexRange { kind: &'static str, index: usize, vertex: u32, num_vertices: usize },
    #[error("{kind} {index} names vertex {vertex} twice: remove it or give it distinct vertices")]
    RepeatedVertex { kind: &'static str, index: usize, vertex: u32 },
    #[error("{kind} {index} has the vertices of {kind} {other}: remove one of them")]
    Duplicate { kind: &'static str, index: usize, other: usize },
    #[error("the triangle ({}, {}, {}) has more than two cells: a solid has at most two there", .vertices[0], .vertices[1], .vertices[2])]
    CrowdedTriangle { vertices: [u32; 3] },
    #[error("{kind} {index} has the side {side:?}, which is not listed: list every {missing} of every cell")]
    Missing { kind: &'static str, index: usize, side: Vec<u32>, missing: &'static str },
    #[error("{count} {kind} are more than 31-bit numbers can index: use a smaller mesh or fewer levels")]
    TooLarge { kind: &'static str, count: u128 },
    #[error(
        "{levels} levels ({cells} cells) need about {needed_mib} MiB of memory and {available_mib} MiB are free: ask for fewer levels"
    )]
    TooMuchMemory { levels: usize, cells: u128, needed_mib: u128, available_mib: u128 },
}

impl Complex {
    /// The complex of these cells. Edges run from lower to higher vertex, triangles ascend, both are numbered
    /// in lexicographic order.
    ///
    /// # Errors
    /// [`ComplexError`] if the cells are not those of a solid.
    pub fn new(num_vertices: usize, tets: Vec<[u32; 4]>, octs: Vec<[u32; 6]>) -> Result<Self, ComplexError> {
        check_vertices(num_vertices, "cell", 0, &tets)?;
        check_vertices(num_vertices, "cell", tets.len(), &octs)?;
        let sides =
            |faces: &'static [[usize; 3]]| move |v: &[u32]| faces.iter().map(|f| f.map(|i| v[i])).collect();
        let of_tets = tets.iter().flat_map(|v| -> Vec<[u32; 3]> { sides(&TET_FACES)(v) });
        let of_octs = octs.iter().flat_map(|v| -> Vec<[u32; 3]> { sides(&OCT_FACES)(v) });
        let triangles = Lookup::distinct(num_vertices, of_tets.chain(of_octs));
        let edges = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [a, c], [b, c]]);
        let edges = Lookup::distinct(num_vertices, edges);
        Self::with_sides(num_vertices, edges, &triangles, tets, octs)
    }

    /// The complex of these cells, with edges and triangles numbered and oriented as listed; an edge or a triangle
    /// need not belong to a cell.
    ///
    /// # Errors
    /// [`ComplexError`] if the arrays are not those of a solid.
    pub fn with_sides(
        num_vertices: usize,
        edges: Vec<[u32; 2]>,
        triangles: &[[u32; 3]],
        tets: Vec<[u32; 4]>,
        octs: Vec<[u32; 6]>,
    ) -> Result<Self, ComplexError> {
        check_vertices(num_vertices, "edge", 0, &edges)?;
        check_vertices(num_vertices, "triangle", 0, triangles)?;
        check_vertices(num_vertices, "cell", 0, &tets)?;
        check_vertices(num_vertices, "cell", tets.len(), &octs)?;
        let found = |kind| move |[other, index]: [usize; 2]| ComplexError::Duplicate { kind, index, other };
        let edge_lookup = Lookup::new(num_vertices, &edges).map_err(found("edge"))?;
        let triangle_lookup = Lookup::new(num_vertices, triangles).map_err(found("triangle"))?;
        Lookup::new(num_vertices, &tets).map_err(found("cell"))?;
        Lookup::new(num_vertices, &octs)
            .map_err(|pair| found("cell")(pair.map(|index| index + tets.len())))?;

        let half_edge = |t: usize, [a, b]: [u32; 2]| match edge_lookup.find([a, b]) {
            Some(e) => Ok(HalfEdge::new(e, edges[e as usize] == [a, b])),
            None => Err(missing("triangle", t, &[a, b], "edge")),
        };
        let boundary = |(t, &[a, b, c]): (usize, &[u32; 3])| {
            Ok([half_edge(t, [a, b])?, half_edge(t, [b, c])?, half_edge(t, [c, a])?])
        };
        let boundaries = triangles.iter().enumerate().map(boundary).collect::<Result<_, _>>()?;
        let half_face = |cell: usize, side: [u32; 3]| match triangle_lookup.find(side) {
            Some(t) => Ok(HalfFace::new(t, is_even(triangles[t as usize], side))),
            None => Err(missing("cell", cell, &side, "triangle")),
        };
        let mut complex =
            Complex { num_vertices, edges: Vec::new(), triangles: boundaries, ..Default::default() };
        for (t, v) in tets.iter().enumerate() {
            let mut faces = [HalfFace(0); 4];
            for (face, corners) in faces.iter_mut().zip(TET_FACES) {
                *face = half_face(t, corners.map(|i| v[i]))?;
            }
            complex.tet_faces.push(faces);
        }
        for (o, v) in octs.iter().enumerate() {
            let mut faces = [HalfFace(0); 8];
            for (face, corners) in faces.iter_mut().zip(OCT_FACES) {
                *face = half_face(tets.len() + o, corners.map(|i| v[i]))?;
            }
            complex.oct_faces.push(faces);
        }
        (complex.edges, complex.tets, complex.octs) = (edges, tets, octs);
        complex.check_sizes()?;
        match complex.cells_of_triangles() {
            Ok(_) => Ok(complex),
            Err(t) => Err(ComplexError::CrowdedTriangle { vertices: triangles[t as usize] }),
        }
    }

    /// Whether half-edges and half-faces fit 32 bits.
    pub(super) fn check_sizes(&self) -> Result<(), ComplexError> {
        for (kind, r) in [("vertices", 0), ("edges", 1), ("triangles", 2), ("cells", 3)] {
            check_size(kind, self.num_cells(r) as u128)?;
        }
        Ok(())
    }

    /// The number of `r`-cells: vertices, edges, triangles or (`r = 3`) tetrahedra and octahedra.
    ///
    /// # Panics
    /// If `r > 3`.
    pub fn num_cells(&self, r: usize) -> usize {
        [self.num_vertices, self.edges.len(), self.triangles.len(), self.tets.len() + self.octs.len()][r]
    }

    /// The two vertices of each edge, in the order of its orientation.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The boundary of each triangle: from its first vertex to its second, to its third, and back.
    pub fn triangles(&self) -> &[[HalfEdge; 3]] {
        &self.triangles
    }

    /// The vertices of triangle `t`, in the order of its orientation.
    #[inline]
    pub fn triangle_vertices(&self, t: u32) -> [u32; 3] {
        self.triangles[t as usize].map(|h| self.tail(h))
    }

    /// The tetrahedra.
    pub fn tets(&self) -> &[[u32; 4]] {
        &self.tets
    }

    /// The octahedra.
    pub fn octs(&self) -> &[[u32; 6]] {
        &self.octs
    }

    /// The vertices of a cell: four or six.
    #[inline]
    pub fn cell_vertices(&self, cell: u32) -> &[u32] {
        match (cell as usize).checked_sub(self.tets.len()) {
            None => &self.tets[cell as usize],
            Some(o) => &self.octs[o],
        }
    }

    /// The boundary of a cell: the sides that face outwards if it is positive, ordered as [`TET_FACES`] or
    /// [`OCT_FACES`].
    #[inline]
    pub fn cell_faces(&self, cell: u32) -> &[HalfFace] {
        match (cell as usize).checked_sub(self.tets.len()) {
            None => &self.tet_faces[cell as usize],
            Some(o) => &self.oct_faces[o],
        }
    }

    /// The vertex that a half-edge leaves.
    #[inline]
    pub fn tail(&self, h: HalfEdge) -> u32 {
        self.edges[h.edge() as usize][h.index() & 1]
    }

    /// The side of triangle `t` from `a` to `b`, which are two of its vertices.
    #[inline]
    pub(super) fn side(&self, t: u32, a: u32, b: u32) -> HalfEdge {
        let [x, y, z] = self.triangles[t as usize];
        for h in [x, y, z] {
            if self.tail(h) == a && self.tail(h.twin()) == b {
                return h;
            }
            if self.tail(h) == b && self.tail(h.twin()) == a {
                return h.twin();
            }
        }
        unreachable!("a triangle without the side that it was asked for")
    }

    /// The edge of a tetrahedron from its vertex `i` to its vertex `j`.
    #[inline]
    pub(super) fn tet_edge(&self, t: usize, i: usize, j: usize) -> HalfEdge {
        let face = (0..4).find(|&k| k != i && k != j).expect("a tetrahedron has four vertices");
        let v = &self.tets[t];
        self.side(self.tet_faces[t][face].triangle(), v[i], v[j])
    }

    /// The edge of an octahedron from its vertex `i` to its vertex `j`, not opposite each other.
    #[inline]
    pub(super) fn oct_edge(&self, o: usize, i: usize, j: usize) -> HalfEdge {
        let bit = |i: usize| usize::from(i >= 3) << (i % 3);
        let v = &self.octs[o];
        self.side(self.oct_faces[o][bit(i) | bit(j)].triangle(), v[i], v[j])
    }

    /// For each triangle its cells; the second is [`NONE`](super::NONE) on the boundary, both are for a triangle
    /// of no cell. The error is a triangle with more than two.
    pub(super) fn cells_of_triangles(&self) -> Result<Vec<[u32; 2]>, u32> {
        let mut cells = vec![[super::NONE; 2]; self.triangles.len()];
        let of_tets = self.tet_faces.iter().map(|faces| &faces[..]);
        let of_octs = self.oct_faces.iter().map(|faces| &faces[..]);
        for (cell, faces) in (0..).zip(of_tets.chain(of_octs)) {
            for face in faces {
                let pair = &mut cells[face.triangle() as usize];
                match pair.iter_mut().find(|slot| **slot == super::NONE) {
                    Some(slot) => *slot = cell,
                    None => return Err(face.triangle()),
                }
            }
        }
        Ok(cells)
    }

    /// The exterior derivative of `r`-cochains as a matrix, one row for each (r+1)-cell.
    ///
    /// # Panics
    /// If `r > 2`.
    pub fn exterior_derivative(&self, r: usize) -> Csr {
        assemble((self.num_cells(r + 1), self.num_cells(r)), |i, row| match r {
            0 => {
                let [a, b] = self.edges[i];
                row.add(a, -1.0);
                row.add(b, 1.0);
            }
            1 => self.triangles[i].iter().for_each(|h| row.add(h.edge(), h.sign())),
            _ => self.cell_faces(i as u32).iter().for_each(|f| row.add(f.triangle(), f.sign())),
        })
    }
}

impl Differential<0> for Complex {
    fn derive<T: Quantity>(&self, x: &[T]) -> Vec<T> {
        assert_eq!(x.len(), self.num_vertices, "a 0-cochain of another complex");
        d0(&self.edges, x)
    }
}

impl Differential<1> for Complex {
    fn derive<T: Quantity>(&self, c: &[T]) -> Vec<T> {
        assert_eq!(c.len(), self.edges.len(), "a 1-cochain of another complex");
        let along = |h: HalfEdge| c[h.edge() as usize].scale(h.sign());
        self.triangles.par_iter().map(|&[x, y, z]| along(x) + along(y) + along(z)).collect()
    }
}

impl Differential<2> for Complex {
    fn derive<T: Quantity>(&self, c: &[T]) -> Vec<T> {
        assert_eq!(c.len(), self.triangles.len(), "a 2-cochain of another complex");
        let through = |f: &HalfFace| c[f.triangle() as usize].scale(f.sign());
        let flux = |cell: u32| self.cell_faces(cell).iter().fold(T::zero(), |sum, face| sum + through(face));
        (0..self.num_cells(3) as u32).into_par_iter().map(flux).collect()
    }
}

pub(super) fn check_size(kind: &'static str, count: u128) -> Result<(), ComplexError> {
    if count >= 1 << 31 { Err(ComplexError::TooLarge { kind, count }) } else { Ok(()) }
}

fn check_vertices<const N: usize>(
    num_vertices: usize,
    kind: &'static str,
    first: usize,
    cells: &[[u32; N]],
) -> Result<(), ComplexError> {
    check_size("vertices", num_vertices as u128)?;
    for (index, cell) in (first..).zip(cells) {
        for (i, &vertex) in cell.iter().enumerate() {
            if vertex as usize >= num_vertices {
                return Err(ComplexError::VertexRange { kind, index, vertex, num_vertices });
            }
            if cell[..i].contains(&vertex) {
                return Err(ComplexError::RepeatedVertex { kind, index, vertex });
            }
        }
    }
    Ok(())
}

fn missing(kind: &'static str, index: usize, side: &[u32], missing: &'static str) -> ComplexError {
    ComplexError::Missing { kind, index, side: side.to_vec(), missing }
}

/// Whether two orders of the same three vertices run the same way round.
#[inline]
pub(super) fn is_even([a, b, c]: [u32; 3], other: [u32; 3]) -> bool {
    other == [a, b, c] || other == [b, c, a] || other == [c, a, b]
}
