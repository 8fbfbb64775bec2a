use serde::Serialize;

use super::worse;
use crate::hierarchy::{Hierarchy, HierarchyError, Level};
use crate::limit::{Limit, LimitOperators};
use crate::osd::{Refiner, Rule};
use crate::sparse::{Csr, assemble, max_difference, multiply};
use crate::topology::{HalfEdge, Parent, SplitKind};

/// The laws of the limit of one level.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimitLaws {
    /// The level.
    pub level: usize,
    /// The largest entry of `L1 d0 - d0 L0`.
    pub l1_d0_minus_d0_l0: f64,
    /// The largest entry of `L2 d1 - d1 L1`.
    pub l2_d1_minus_d1_l1: f64,
    /// The largest entry of `R L' S - L` for the three degrees, `L'` and `S` those of the next level. None on the
    /// finest level.
    pub restricted: Option<f64>,
    /// On the finest level, the largest difference of a weight of `L0` to OpenSubdiv's limit mask, at the vertices
    /// where that is the exact limit: not at darts, next to features that are still semi-sharp, at valence 2, or at
    /// vertices of polygons. None if OpenSubdiv has no such scheme.
    pub l0_minus_opensubdiv: Option<f64>,
}

impl LimitLaws {
    /// The worst of the four.
    pub fn worst(&self) -> f64 {
        let all = [self.l1_d0_minus_d0_l0, self.l2_d1_minus_d1_l1];
        all.into_iter().chain(self.restricted).chain(self.l0_minus_opensubdiv).fold(0.0, worse)
    }
}

/// The laws of all levels.
pub fn laws(
    hierarchy: &Hierarchy,
    opensubdiv: Option<&Refiner>,
    limits: &[Limit],
) -> Result<Vec<LimitLaws>, HierarchyError> {
    let operators: Vec<LimitOperators> =
        limits.iter().enumerate().map(|(l, limit)| limit.operators(hierarchy.level(l).mesh())).collect();
    let mut rows = Vec::with_capacity(limits.len());
    for (level, l) in operators.iter().enumerate() {
        let mesh = hierarchy.level(level).mesh();
        let (d0, d1) = (mesh.d0(), mesh.d1());
        let finer = operators.get(level + 1).map(|finer| restricted(hierarchy, level, l, finer));
        let masks = opensubdiv.filter(|_| finer.is_none()).map(Refiner::limit_stencils).transpose()?;
        rows.push(LimitLaws {
            level,
            l1_d0_minus_d0_l0: max_difference(&multiply(&l.l1, &d0), &multiply(&d0, &l.l0)),
            l2_d1_minus_d1_l1: max_difference(&multiply(&l.l2, &d1), &multiply(&d1, &l.l1)),
            restricted: finer,
            l0_minus_opensubdiv: masks.map(|masks| {
                let exact = exact_vertices(hierarchy.level(level), hierarchy.split_kind());
                max_difference(&selected(&l.l0, &exact), &selected(&masks.position, &exact))
            }),
        });
    }
    Ok(rows)
}

/// The largest entry of `R L' S - L`, over the three degrees.
fn restricted(hierarchy: &Hierarchy, level: usize, coarse: &LimitOperators, finer: &LimitOperators) -> f64 {
    let (parent, child) = (hierarchy.level(level).mesh(), hierarchy.level(level + 1).mesh());
    let split = hierarchy.refinement(level + 1).split();
    let steps = hierarchy.operators(level + 1);
    let r0 = assemble((parent.num_vertices(), child.num_vertices()), |v, row| {
        row.add(split.vertex_of(Parent::Vertex(v as u32)), 1.0);
    });
    let r1 = assemble((parent.num_edges(), child.num_edges()), |e, row| {
        let h = HalfEdge::new(e as u32, true);
        row.add(split.even_edge(h), -1.0);
        row.add(split.even_edge(h.twin()), 1.0);
    });
    let mut children = vec![Vec::new(); parent.num_faces()];
    for f in 0..child.num_faces() {
        children[split.face_parent(parent, f) as usize].push(f as u32);
    }
    let r2 = assemble((parent.num_faces(), child.num_faces()), |f, row| {
        children[f].iter().for_each(|&child| row.add(child, 1.0));
    });
    let deviation = |r: &Csr, finer: &Csr, step: &Csr, coarse: &Csr| {
        max_difference(&multiply(r, &multiply(finer, step)), coarse)
    };
    let all = [
        deviation(&r0, &finer.l0, &steps.s0, &coarse.l0),
        deviation(&r1, &finer.l1, &steps.s1, &coarse.l1),
        deviation(&r2, &finer.l2, &steps.s2, &coarse.l2),
    ];
    all.into_iter().fold(0.0, worse)
}

/// The vertices where OpenSubdiv's limit masks are the limits of its refinement.
fn exact_vertices(level: &Level, kind: SplitKind) -> Vec<bool> {
    let (mesh, tags) = (level.mesh(), level.tags());
    let lasts = |sharpness: f32| sharpness <= 0.0 || sharpness >= 10.0;
    let is_exact = |v: u32| {
        let spokes = mesh.vertex_half_edges(v);
        let mut faces = mesh.fans(v).flat_map(|fan| fan.corners).map(|&c| mesh.corner_face(c));
        tags.vertex_rule[v as usize] != Rule::Dart
            && lasts(tags.vertex_sharpness[v as usize])
            && spokes.iter().all(|h| lasts(tags.edge_sharpness[h.edge() as usize]))
            && (spokes.len() > 2 || tags.vertex_rule[v as usize] != Rule::Smooth)
            && faces.all(|f| kind == SplitKind::Triangle || mesh.face_size(f) == 4)
    };
    (0..mesh.num_vertices() as u32).map(is_exact).collect()
}

fn selected(matrix: &Csr, rows: &[bool]) -> Csr {
    assemble(matrix.shape(), |i, row| {
        if rows[i] {
            row.add_row(matrix, i, 1.0);
        }
    })
}
