//! One step of refinement, looked at row by row.

use std::collections::BTreeMap;

use approx::assert_abs_diff_eq;
use formwork::hierarchy::{Hierarchy, Operators};
use formwork::scheme::Scheme;
use formwork::sparse::{Csr, row_of};
use formwork::topology::{Cage, Descriptor, HalfEdge, Mesh, Parent};

/// Weights are compared to rounding.
pub const WEIGHT: f64 = 1e-15;

/// One step of refinement, with rows named by cells of the cage.
pub struct Step {
    pub hierarchy: Hierarchy,
    pub operators: Operators,
}

impl Step {
    pub fn new(descriptor: Descriptor, scheme: Scheme) -> Self {
        let cage = Cage::new(descriptor).unwrap();
        let hierarchy = Hierarchy::new(&cage, scheme, 1).unwrap();
        let operators = hierarchy.operators(1);
        Step { hierarchy, operators }
    }

    pub fn mesh(&self) -> &Mesh {
        self.hierarchy.level(0).mesh()
    }

    pub fn edge(&self, a: u32, b: u32) -> HalfEdge {
        self.mesh().find_half_edge(a, b).unwrap()
    }

    /// The row of S1 along the child edge between the children of two cells, as directed coarse edges.
    pub fn s1(&self, from: Parent, to: Parent) -> BTreeMap<(u32, u32), f64> {
        let split = self.hierarchy.refinement(1).split();
        let child = self.hierarchy.level(1).mesh();
        let h = child.find_half_edge(split.vertex_of(from), split.vertex_of(to)).unwrap();
        let (columns, weights) = row_of(&self.operators.s1, h.edge() as usize);
        let directed = |(&e, &w): (&u32, &f64)| {
            let [a, b] = self.mesh().edges()[e as usize];
            if w * h.sign() < 0.0 { ((b, a), w.abs()) } else { ((a, b), w.abs()) }
        };
        columns.iter().zip(weights).map(directed).collect()
    }

    /// `v -> m(v, w)`.
    pub fn even(&self, v: u32, w: u32) -> BTreeMap<(u32, u32), f64> {
        self.s1(Parent::Vertex(v), Parent::Edge(self.edge(v, w).edge()))
    }

    /// `m(v, w0) -> m(v, w1)` inside the triangle `(v, w0, w1)`.
    pub fn across(&self, v: u32, w0: u32, w1: u32) -> BTreeMap<(u32, u32), f64> {
        self.s1(Parent::Edge(self.edge(v, w0).edge()), Parent::Edge(self.edge(v, w1).edge()))
    }

    /// `m(a, b) -> p_f`, f being left of a -> b.
    pub fn odd(&self, a: u32, b: u32) -> BTreeMap<(u32, u32), f64> {
        let h = self.edge(a, b);
        let face = self.mesh().corner_face(self.mesh().left_corner(h).unwrap());
        self.s1(Parent::Edge(h.edge()), Parent::Face(face))
    }

    /// The row of S2 of the child of face `f` at vertex `v`, by coarse face.
    pub fn s2(&self, f: u32, v: u32) -> BTreeMap<u32, f64> {
        let mesh = self.mesh();
        let corner = mesh.corners(f).find(|&c| mesh.corner_vertex(c) == v).unwrap();
        self.s2_row(self.hierarchy.refinement(1).split().face_at(mesh, corner))
    }

    /// The row of S2 of a child face.
    pub fn s2_row(&self, child: u32) -> BTreeMap<u32, f64> {
        let (columns, weights) = row_of(&self.operators.s2, child as usize);
        columns.iter().copied().zip(weights.iter().copied()).collect()
    }

    /// The row of S0 of the child of a cell.
    pub fn s0(&self, of: Parent) -> BTreeMap<u32, f64> {
        let row = self.hierarchy.refinement(1).split().vertex_of(of) as usize;
        let (columns, weights) = row_of(&self.operators.s0, row);
        columns.iter().copied().zip(weights.iter().copied()).collect()
    }
}

/// The same entries, no more, to rounding.
pub fn assert_row<K: Ord + Copy + std::fmt::Debug>(row: &BTreeMap<K, f64>, expected: &[(K, f64)]) {
    let expected: BTreeMap<K, f64> = expected.iter().copied().filter(|(_, w)| *w != 0.0).collect();
    assert_eq!(row.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>(), "{row:?} {expected:?}");
    for (key, &weight) in &expected {
        assert_abs_diff_eq!(row[key], weight, epsilon = WEIGHT);
    }
}

/// Every entry of S0, S1 and S2 is `p` times the sharp one and `1 - p` times the smooth one. OpenSubdiv forms
/// `1 - p` in single precision.
pub fn assert_blended(blended: &Step, p: f64, sharp: &Step, smooth: &Step) {
    let all = |step: &Step| [&step.operators.s0, &step.operators.s1, &step.operators.s2].map(Csr::clone);
    for ((blended, sharp), smooth) in all(blended).iter().zip(all(sharp)).zip(all(smooth)) {
        for (row, column) in (0..blended.rows()).flat_map(|r| (0..blended.cols()).map(move |c| (r, c))) {
            let entry = |m: &Csr| m.get(row, column).copied().unwrap_or(0.0);
            assert_abs_diff_eq!(
                entry(blended),
                p * entry(&sharp) + (1.0 - p) * entry(&smooth),
                epsilon = 1e-8
            );
        }
    }
}
