//! Tangents of the limit at all vertices of a level, and the values of 1-forms along them.

use std::collections::HashMap;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::neighbourhood::{Configuration, around_corner, fan_cells};
use super::vertex::{self, VertexTable};
use crate::cochain::{Cochain, Value};
use crate::field;
use crate::hierarchy::HierarchyError;
use crate::osd::{Rules, Tags};
use crate::scheme::modified_loop::eps;
use crate::scheme::{Scheme, Variant};
use crate::sparse::{Csr, Row, assemble, dot, row_of};
use crate::topology::{HalfEdge, Mesh, SplitKind};

/// Pairs of limit tangents `T_1, T_2`, turning counter-clockwise: one pair for each smooth vertex, one for each
/// sector at a vertex on creases, none at isolated vertices and at sharp vertices without sharp edges.
///
/// A pair is two rows `phi_i` on edges: `T_i = phi_i d0 x` from positions `x`, and `omega(T_i) = phi_i c` from a
/// 1-cochain `c`. Their length is arbitrary; the tangent plane, and the vector of a form, are not.
#[derive(Clone, Debug)]
pub struct LimitTangents {
    /// For each corner the number of its pair, or [`NONE`].
    corner: Vec<u32>,
    /// `(2 pairs, |E|)`.
    phi: Csr,
}

/// No pair.
const NONE: u32 = u32::MAX;

impl LimitTangents {
    /// The number of pairs.
    pub fn len(&self) -> usize {
        self.phi.rows() / 2
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The pair in whose sector a corner of the mesh lies, if there is one.
    pub fn pair_of_corner(&self, corner: u32) -> Option<usize> {
        Some(self.corner[corner as usize]).filter(|&pair| pair != NONE).map(|pair| pair as usize)
    }

    /// The rows `phi_1, phi_2` of each pair, `(2 pairs, |E|)`.
    pub fn rows(&self) -> &Csr {
        &self.phi
    }

    /// The limit tangents of each pair.
    ///
    /// # Panics
    /// If the positions are not on the level's mesh.
    pub fn tangents(&self, mesh: &Mesh, positions: &Cochain<0, Vector3<f64>>) -> Vec<[Vector3<f64>; 2]> {
        self.along(&positions.exterior_derivative(mesh))
    }

    /// The values of the limit of a 1-form along the two tangents of each pair.
    ///
    /// # Panics
    /// If the cochain is not on the level's mesh.
    pub fn along<T: Value>(&self, form: &Cochain<1, T>) -> Vec<[T; 2]> {
        assert_eq!(form.len(), self.phi.cols(), "a 1-cochain of another mesh");
        let c = form.values();
        let value = |row: usize| dot(row_of(&self.phi, row), c).unwrap_or_else(|| c[0] * 0.0);
        (0..self.len()).into_par_iter().map(|pair| [value(2 * pair), value(2 * pair + 1)]).collect()
    }
}

/// Normals and tangent vectors of pairs, and where they go.
impl LimitTangents {
    /// The unit normal of the limit surface for each pair; 0 where the tangents are parallel.
    ///
    /// # Panics
    /// If the positions are not on the level's mesh.
    pub fn normals(&self, mesh: &Mesh, positions: &Cochain<0, Vector3<f64>>) -> Vec<Vector3<f64>> {
        let normal = |[a, b]: [Vector3<f64>; 2]| a.cross(&b).try_normalize(0.0).unwrap_or_default();
        self.tangents(mesh, positions).into_iter().map(normal).collect()
    }

    /// The tangent vector of the limit of a 1-form for each pair, see [`field::sharp`].
    ///
    /// # Panics
    /// If the cochains are not on the level's mesh.
    pub fn vectors(
        &self,
        mesh: &Mesh,
        positions: &Cochain<0, Vector3<f64>>,
        form: &Cochain<1>,
    ) -> Vec<Vector3<f64>> {
        let pairs = self.tangents(mesh, positions).into_iter().zip(self.along(form));
        pairs.map(|(tangents, covector)| field::sharp(tangents, covector)).collect()
    }

    /// The mean at each vertex of what its pairs have; `None` where there is no pair.
    ///
    /// # Panics
    /// If there is not one vector for each pair.
    pub fn at_vertices(&self, mesh: &Mesh, of_pairs: &[Vector3<f64>]) -> Vec<Option<Vector3<f64>>> {
        assert_eq!(of_pairs.len(), self.len(), "vectors of other pairs");
        let mean = |v: u32| {
            let pairs = mesh.fans(v).flat_map(|fan| fan.corners).map(|&c| self.corner[c as usize]);
            let mut pairs: Vec<u32> = pairs.filter(|&pair| pair != NONE).collect();
            pairs.sort_unstable();
            pairs.dedup();
            let sum: Vector3<f64> = pairs.iter().map(|&pair| of_pairs[pair as usize]).sum();
            (!pairs.is_empty()).then(|| sum / pairs.len() as f64)
        };
        (0..mesh.num_vertices() as u32).into_par_iter().map(mean).collect()
    }
}

/// Where the rows of a pair come from.
enum Source<'a> {
    /// A table, on these edges.
    Table(&'a VertexTable, Vec<HalfEdge>),
    /// The two edges of a corner, where the limit is no smoother than its faces.
    Corner(u32),
    /// A pair of another mesh whose edges are these of ours.
    Pulled(&'a LimitTangents, usize, &'a [HalfEdge]),
}

/// A level whose tangents are collected.
pub(super) struct Collection<'a> {
    /// How faces split.
    pub kind: SplitKind,
    /// The scheme.
    pub scheme: Scheme,
    /// The complex.
    pub mesh: &'a Mesh,
    /// Its tags.
    pub tags: &'a Tags,
    /// The rules of its settled vertices.
    pub rules: &'a Rules,
}

/// A piece of a mesh with its tangents.
pub(super) struct Pulled<'a> {
    /// The tangents.
    pub tangents: &'a LimitTangents,
    /// For each corner of the whole its corner in the piece.
    pub corner: &'a [u32],
    /// For each edge of the piece that of the whole.
    pub edges: &'a [HalfEdge],
}

impl Collection<'_> {
    /// The pairs at the vertices that `wants` names: from the piece where `is_open`, from tables elsewhere.
    pub fn tangents(
        &self,
        wants: impl Fn(usize) -> bool,
        is_open: impl Fn(usize) -> bool,
        pulled: Option<Pulled>,
    ) -> Result<LimitTangents, HierarchyError> {
        let mesh = self.mesh;
        let smooth = !matches!(self.scheme, Scheme::Whitney | Scheme::Bilinear);
        let tables = if smooth { self.tables(&wants, &is_open)? } else { HashMap::new() };
        let mut corner = vec![NONE; mesh.num_corners()];
        let mut sources = Vec::new();
        for v in (0..mesh.num_vertices()).filter(|&v| wants(v)) {
            let corners = mesh.fans(v as u32).flat_map(|fan| fan.corners);
            match &pulled {
                Some(piece) if is_open(v) => {
                    let mut known: Vec<(usize, u32)> = Vec::new();
                    for &c in corners {
                        let there = piece.tangents.pair_of_corner(piece.corner[c as usize]);
                        let Some(pair) = there else { continue };
                        corner[c as usize] = match known.iter().find(|(other, _)| *other == pair) {
                            Some((_, number)) => *number,
                            None => {
                                known.push((pair, sources.len() as u32));
                                sources.push(Source::Pulled(piece.tangents, pair, piece.edges));
                                sources.len() as u32 - 1
                            }
                        };
                    }
                }
                _ if !smooth => {
                    for &c in corners {
                        corner[c as usize] = sources.len() as u32;
                        sources.push(Source::Corner(c));
                    }
                }
                _ => {
                    for &c in corners {
                        if corner[c as usize] != NONE {
                            continue;
                        }
                        let (found, sector) = around_corner(mesh, self.tags, c);
                        let table = &tables[&found.anywhere()];
                        if table.covectors().is_some() {
                            sector.iter().for_each(|&c| corner[c as usize] = sources.len() as u32);
                            sources.push(Source::Table(table, fan_cells(mesh, &sector, found.cyclic).edges));
                        }
                    }
                }
            }
        }
        let modified = matches!(self.scheme, Scheme::Loop(Variant::ModifiedLoop, _));
        let phi = assemble((2 * sources.len(), mesh.num_edges()), |row, out| match &sources[row / 2] {
            Source::Table(table, edges) => {
                let phi = &table.covectors().expect("only such are listed")[row % 2];
                for ((h, &weight), &pull) in edges.iter().zip(phi).zip(&table.pull()[row % 2]) {
                    let eps = if modified && pull != 0.0 { eps(mesh, self.rules, h.twin()) } else { 0.0 };
                    out.add(h.edge(), (weight - pull * eps) * h.sign());
                }
            }
            Source::Corner(c) => {
                let h = match row % 2 {
                    0 => mesh.corner_half_edge(*c),
                    _ => mesh.corner_half_edge(mesh.previous_corner(*c)).twin(),
                };
                out.add(h.edge(), h.sign());
            }
            Source::Pulled(tangents, pair, edges) => {
                let (columns, weights) = row_of(&tangents.phi, 2 * pair + row % 2);
                for (&e, &weight) in columns.iter().zip(weights) {
                    let h = edges[e as usize];
                    out.add(h.edge(), weight * h.sign());
                }
            }
        });
        Ok(LimitTangents { corner, phi })
    }

    /// The tables of all configurations that occur.
    fn tables(
        &self,
        wants: impl Fn(usize) -> bool,
        is_open: impl Fn(usize) -> bool,
    ) -> Result<HashMap<Configuration, VertexTable>, HierarchyError> {
        let mut tables = HashMap::new();
        for v in (0..self.mesh.num_vertices()).filter(|&v| wants(v) && !is_open(v)) {
            for &corner in self.mesh.fans(v as u32).flat_map(|fan| fan.corners) {
                let key = around_corner(self.mesh, self.tags, corner).0.anywhere();
                if let std::collections::hash_map::Entry::Vacant(entry) = tables.entry(key) {
                    entry.insert(vertex::table(self.kind, self.scheme, key)?);
                }
            }
        }
        Ok(tables)
    }
}

/// Tangents on the level above, `refine(e, weight, row)` adding `weight` times the row of `S1` of a child edge and
/// `child(c)` the corner below a corner.
pub(super) fn pull_back(
    finer: &LimitTangents,
    mesh: &Mesh,
    child: impl Fn(u32) -> u32,
    refine: impl Fn(usize, f64, &mut Row) + Sync,
) -> LimitTangents {
    let corner = (0..mesh.num_corners() as u32).map(|c| finer.corner[child(c) as usize]).collect();
    let phi = assemble((finer.phi.rows(), mesh.num_edges()), |row, out| {
        let (columns, weights) = row_of(&finer.phi, row);
        for (&e, &weight) in columns.iter().zip(weights) {
            refine(e as usize, weight, out);
        }
    });
    LimitTangents { corner, phi }
}
