//! Limits: what cochains become when they are refined for ever.
//!
//! The limit of a 0-cochain has a value at every vertex, that of a 1-cochain a circulation along every
//! limit edge, that of a 2-cochain an integral over every limit face. With `R` summing children into their
//! parents (restriction to old vertices, the two halves of an edge, the children of a face) these are the
//! fixed points `R L' S = L`, and they have the form of the schemes themselves:
//!
//! ```text
//! L0 = I + K0 d0        L1 = I + d0 K0 + K1 d1        L2 = I + d1 K1                     (B)
//! K0 = R0 (H0 + K0' S1)         K1 = R1 (H1 + K1' S2)
//! ```
//!
//! so that `L1 d0 = d0 L0` and `L2 d1 = d1 L1` whatever the tables: the circulations of an exact form are the
//! differences of limit positions. On a settled level (faces as the split leaves them, every sharpness 0 or
//! infinite) `K0` and `K1` have closed forms, at every valence, crease, corner and dart. Where a level is not
//! settled yet, round its polygons and semi-sharp features, a piece of it is refined until it is, and pulled
//! back by the recursion (B).

mod crossing;
mod frame;
mod model;
mod neighbourhood;
mod patch;
mod quad;
mod settled;
mod surface;
mod tables;
mod tangents;
mod taylor;
mod triangle;
mod unsettled;
mod vertex;

pub(crate) use model::{block, dense};
pub use patch::Jet;
pub use surface::{
    BasisJets, BasisPoint, FaceCells, LimitSurface, PiecePoint, Pieces, PointError, QuadratureRule,
    SurfaceError, SurfacePoint, SurfaceVector,
};
pub use tangents::LimitTangents;
pub use taylor::Taylor;

use crate::cochain::{Cochain, Value, d1};
use crate::hierarchy::{Hierarchy, HierarchyError};
use crate::sparse::{Csr, apply, assemble, dot, row_of};
use crate::topology::Mesh;

/// The sharpness that OpenSubdiv treats as infinite.
pub(crate) const INFINITE: f32 = 10.0;

/// The limit of one level of a hierarchy.
#[derive(Clone, Debug)]
pub struct Limit {
    /// `(|V|, |E|)` and `(|E|, |F|)`.
    tables: unsettled::Tables,
}

/// The limit operators of one level, from the level to itself.
#[derive(Clone, Debug)]
pub struct LimitOperators {
    /// `(|V|, |V|)`: values of the limit at the vertices.
    pub l0: Csr,
    /// `(|E|, |E|)`: circulations of the limit along the limits of the edges, each in its own direction.
    /// `L1 d0 = d0 L0`.
    pub l1: Csr,
    /// `(|F|, |F|)`: integrals of the limit over the limits of the faces. `L2 d1 = d1 L1`.
    pub l2: Csr,
}

impl Limit {
    /// The limit of cochains on `level` of a hierarchy. The hierarchy need not be refined any further.
    ///
    /// # Errors
    /// If the surroundings of its polygons and semi-sharp features, refined until they are settled, do not fit
    /// memory, or OpenSubdiv fails.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn new(hierarchy: &Hierarchy, level: usize) -> Result<Self, HierarchyError> {
        let options = hierarchy.cage().descriptor();
        let known = unsettled::solve(hierarchy.scheme(), options, hierarchy.level(level), None, false)?;
        Ok(Limit { tables: known.tables })
    }

    /// [`Limit::new`], and the tangents at the vertices.
    ///
    /// # Errors
    /// As for [`Limit::new`].
    ///
    /// # Panics
    /// If there is no such level.
    pub fn with_tangents(
        hierarchy: &Hierarchy,
        level: usize,
    ) -> Result<(Self, LimitTangents), HierarchyError> {
        let options = hierarchy.cage().descriptor();
        let known = unsettled::solve(hierarchy.scheme(), options, hierarchy.level(level), None, true)?;
        Ok((Limit { tables: known.tables }, known.tangents.expect("asked for")))
    }

    /// `K0`, `(|V|, |E|)`: the way of each vertex to its limit, over oriented edges.
    pub fn k0(&self) -> &Csr {
        &self.tables.k0
    }

    /// `K1`, `(|E|, |F|)`: what each edge, in its own direction, takes of the faces near it.
    pub fn k1(&self) -> &Csr {
        &self.tables.k1
    }

    /// `L0`, `L1` and `L2` as matrices, by (B). `mesh` is the level's.
    ///
    /// # Panics
    /// If the mesh is another level's.
    pub fn operators(&self, mesh: &Mesh) -> LimitOperators {
        let (k0, k1) = (self.k0(), self.k1());
        assert_eq!((k0.shape().0, k1.shape().0), (mesh.num_vertices(), mesh.num_edges()), "another mesh");
        let square = |k| (mesh.num_cells(k), mesh.num_cells(k));
        let l0 = assemble(square(0), |vertex, row| {
            for (&e, &weight) in std::iter::zip(row_of(k0, vertex).0, row_of(k0, vertex).1) {
                let [a, b] = mesh.edges()[e as usize];
                row.add(a, -weight);
                row.add(b, weight);
            }
            row.add(vertex as u32, 1.0);
        });
        let l1 = assemble(square(1), |edge, row| {
            row.add(edge as u32, 1.0);
            let [tail, head] = mesh.edges()[edge];
            row.add_row(k0, head as usize, 1.0);
            row.add_row(k0, tail as usize, -1.0);
            for (&f, &weight) in std::iter::zip(row_of(k1, edge).0, row_of(k1, edge).1) {
                for h in mesh.face_half_edges(f) {
                    row.add(h.edge(), weight * h.sign());
                }
            }
        });
        let l2 = assemble(square(2), |face, row| {
            row.add(face as u32, 1.0);
            for h in mesh.face_half_edges(face as u32) {
                row.add_row(k1, h.edge() as usize, h.sign());
            }
        });
        LimitOperators { l0, l1, l2 }
    }

    /// The limit of a cochain: values at vertices, circulations along edges or integrals over faces. Nothing
    /// is formed but the tables.
    ///
    /// # Panics
    /// If the mesh is another level's, or the cochain another mesh's.
    pub fn apply<const K: usize, T: Value>(&self, mesh: &Mesh, cochain: &Cochain<K, T>) -> Cochain<K, T> {
        let (k0, k1, x) = (self.k0(), self.k1(), cochain.values());
        assert_eq!((k0.shape().0, k1.shape().0), (mesh.num_vertices(), mesh.num_edges()), "another mesh");
        assert_eq!(x.len(), mesh.num_cells(K), "a cochain of another mesh");
        let or = |x: T, more: Option<T>| more.map_or(x, |more| x + more);
        let values = match K {
            0 => {
                let edges = mesh.edges().iter().map(|&[a, b]| x[b as usize] - x[a as usize]);
                let difference: Vec<T> = edges.collect();
                let at = |v: usize| or(x[v], dot(row_of(k0, v), &difference));
                (0..x.len()).map(at).collect()
            }
            1 => {
                let way = apply(k0, x);
                let curl = d1(mesh, x);
                let along = |(e, &[a, b]): (usize, &[u32; 2])| {
                    or(x[e] + way[b as usize] - way[a as usize], dot(row_of(k1, e), &curl))
                };
                mesh.edges().iter().enumerate().map(along).collect()
            }
            2 => {
                let across = apply(k1, x);
                let over = |f: usize| {
                    let boundary = mesh.face_half_edges(f as u32).iter();
                    boundary.fold(x[f], |sum, h| sum + across[h.edge() as usize] * h.sign())
                };
                (0..x.len()).map(over).collect()
            }
            _ => unreachable!("a surface has cells of dimension 0, 1 and 2"),
        };
        Cochain::new(values)
    }
}
