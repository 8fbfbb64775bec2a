//! The rows of the tables where a mesh is regular, which is nearly everywhere after a level or two: they are a
//! formula, and are not stored.
//!
//! A vertex is regular if four quads or six triangles lie round it, its ring does not meet itself, and
//! OpenSubdiv's weights for it are those of the regular mask; an edge if two quads or triangles lie beside it and
//! its weights are the regular ones. So creases, corners, boundaries and everything that decays are exceptions,
//! and so is each vertex to which OpenSubdiv, of whatever version, gives other weights.
//!
//! With `f_0` the face left of a spoke `e = v -> w` and `f_j` the others counter-clockwise, the formulas of
//! [`super::catmark`], [`super::loop_`] and [`super::correction`] become
//!
//! ```text
//!                 quads, times 128                       triangles, times 32
//! H1(v -> m_e)    -7 D_0 -   D_1 +   D_2 + 7 D_3         -3 D_0 - D_1 + D_4 + 3 D_5
//! ```
//!
//! and for `S1` itself, with `t` the edge that `e` continues, and counting the parallels of an edge on the
//! two faces beside it,
//!
//! ```text
//! quads, times 64        v -> m_e   18 e + 6 t + 3 (parallels of e) + 1 (parallels of t)
//!                        m_e -> p_f 12 (the two edges of f beside e), 4 (those of the face across e)
//! triangles, times 32    v -> m_e   (8,2,-1,-2,-1,2) on the spokes, (-1,-1,0,0,1,1) on the ring
//! ```

use rayon::prelude::*;

use super::triangle_rows::{CORNER, EVEN, ODD, sides_and_across, spokes_and_rims};
use super::whitney;
use crate::memory;
use crate::osd::{Masks, Rule};
use crate::topology::{ChildEdge, HalfEdge, Mesh, Parent, Split, SplitKind, wrap};

/// The formula that all rows follow but the exceptions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regular {
    /// No displacement: the Whitney scheme.
    Whitney,
    /// Catmull-Clark with Doo-Sabin, on quads.
    Catmark,
    /// Loop with half-box splines, on triangles.
    Loop,
}

/// Which vertices and edges of a level are regular.
pub(super) struct RegularCells {
    pub vertices: Vec<bool>,
    pub edges: Vec<bool>,
}

/// Weights of a mask are regular if they differ from the regular ones by rounding only.
const ROUNDING: f64 = 1e-15;

fn is(weight: f64, regular: f64) -> bool {
    (weight - regular).abs() <= ROUNDING
}

impl RegularCells {
    /// Vertices that are `known` to be regular are not looked at; see [`super::Scheme::regular_children`].
    pub(super) fn of(kind: SplitKind, mesh: &Mesh, masks: &Masks, known: &[bool]) -> Self {
        let (sides, valence) = match kind {
            SplitKind::Quad => (4, 4),
            SplitKind::Triangle => (3, 6),
        };
        if mesh.uniform_face_size() != Some(sides) {
            return RegularCells {
                vertices: vec![false; mesh.num_vertices()],
                edges: vec![false; mesh.num_edges()],
            };
        }
        let all_vertices = (0..mesh.num_vertices() as u32).into_par_iter();
        let all_edges = (0..mesh.num_edges() as u32).into_par_iter();
        let edge = |e: u32| is_regular_edge(kind, mesh, masks, e);
        let vertex =
            |v: u32, edge: &dyn Fn(u32) -> bool| is_regular_vertex(kind, mesh, masks, v, valence, edge);
        if known.is_empty() {
            let edges = memory::collect(all_edges.map(edge));
            let regular = |e: u32| edges[e as usize];
            let vertices = memory::collect(all_vertices.map(|v| vertex(v, &regular)));
            return RegularCells { vertices, edges };
        }
        let vertices = memory::collect(all_vertices.map(|v| known[v as usize] || vertex(v, &edge)));
        // Between two faces of a regular vertex lies a regular edge.
        let edges = memory::collect(all_edges.map(|e| {
            let [tail, head] = mesh.edges()[e as usize].map(|v| known[v as usize]);
            tail || head || edge(e)
        }));
        RegularCells { vertices, edges }
    }

    /// The child edges whose rows of `H1` and `S1` do not follow the formula, some of them several times: they are where
    /// edges and vertices are not regular.
    pub(super) fn other_child_edges(&self, split: &Split, mesh: &Mesh) -> impl Iterator<Item = usize> {
        let edges = (0..mesh.num_edges() as u32).filter(|&e| !self.edges[e as usize]);
        let vertices = (0..mesh.num_vertices() as u32).filter(|&v| !self.vertices[v as usize]);
        // Beside an edge that is not manifold there are more corners than those that are known by it.
        let corners = match mesh.uniform_face_size() {
            Some(_) if !edges.clone().any(|e| mesh.is_non_manifold_edge(e)) => 0..0,
            _ => 0..mesh.num_corners() as u32,
        };
        let beside = |h: HalfEdge| {
            let corner = mesh.left_corner(h);
            [corner, corner.map(|corner| mesh.next_corner(corner))].into_iter().flatten().map(ChildEdge::Odd)
        };
        let of_edge = move |e| {
            let sides = [HalfEdge::new(e, true), HalfEdge::new(e, false)];
            sides.into_iter().flat_map(move |h| beside(h).chain([ChildEdge::Even(h)]))
        };
        let of_vertex = |v| {
            let corners = mesh.fans(v).flat_map(|fan| fan.corners);
            let even = mesh.vertex_half_edges(v).iter().map(|&h| ChildEdge::Even(h));
            corners.map(|&corner| ChildEdge::Odd(corner)).chain(even)
        };
        let places = edges.flat_map(of_edge).chain(vertices.flat_map(of_vertex)).chain(corners.map(ChildEdge::Odd));
        places.filter(|&place| !self.child_edge(split.kind(), mesh, place)).map(|place| split.edge_of(place) as usize)
    }

    /// Whether the row of `H1` of a child edge, and its row of `S1`, follow the formula.
    fn child_edge(&self, kind: SplitKind, mesh: &Mesh, child: ChildEdge) -> bool {
        let edge = |h: HalfEdge| self.edges[h.edge() as usize];
        match (child, kind) {
            (ChildEdge::Even(h), _) => self.vertices[mesh.tail(h) as usize] && edge(h),
            (ChildEdge::Odd(c), SplitKind::Quad) => edge(mesh.corner_half_edge(c)),
            (ChildEdge::Odd(c), SplitKind::Triangle) => {
                let sides = [c, mesh.previous_corner(c)].map(|c| mesh.corner_half_edge(c));
                let across = |h: HalfEdge| mesh.left_corner(h.twin()).expect("a regular edge has two faces");
                // Round a regular vertex nothing meets itself.
                let apart = || {
                    let [a, b] = sides.map(across);
                    mesh.corner_face(a) != mesh.corner_face(b)
                        && mesh.corner_vertex(mesh.previous_corner(a))
                            != mesh.corner_vertex(mesh.previous_corner(b))
                };
                let regular = self.vertices[mesh.corner_vertex(c) as usize];
                sides.iter().all(|&h| edge(h)) && (regular || apart())
            }
        }
    }
}

fn is_regular_edge(kind: SplitKind, mesh: &Mesh, masks: &Masks, e: u32) -> bool {
    let h = HalfEdge::new(e, true);
    let (Some(left), Some(right)) = (mesh.left_corner(h), mesh.left_corner(h.twin())) else { return false };
    let (end, face) = match kind {
        SplitKind::Quad => (0.25, 0.25),
        SplitKind::Triangle => (0.375, 0.125),
    };
    let far = |corner| mesh.corner_vertex(mesh.previous_corner(corner));
    let other = |corner| mesh.corner_vertex(mesh.next_corner(mesh.next_corner(corner)));
    is(masks.edge_end[h.index()], end)
        && is(masks.edge_end[h.twin().index()], end)
        && is(masks.edge_face[left as usize], face)
        && is(masks.edge_face[right as usize], face)
        // The faces have nothing in common but the edge.
        && match kind {
            SplitKind::Quad => all_differ([far(left), other(left), far(right), other(right)]),
            SplitKind::Triangle => far(left) != far(right),
        }
}

fn is_regular_vertex(
    kind: SplitKind,
    mesh: &Mesh,
    masks: &Masks,
    v: u32,
    valence: usize,
    edge: &dyn Fn(u32) -> bool,
) -> bool {
    let (i, spokes) = (v as usize, mesh.vertex_half_edges(v));
    let rules = &masks.rules;
    let smooth = rules.parent_rule[i] == Rule::Smooth && rules.child_rule[i] == Rule::Smooth;
    if spokes.len() != valence || !smooth {
        return false;
    }
    let mut fans = mesh.fans(v);
    let Some(fan) = fans.next().filter(|fan| fan.cyclic && fan.corners.len() == valence) else {
        return false;
    };
    let face = if kind == SplitKind::Quad { 0.0625 } else { 0.0 };
    // The ring: the heads of the spokes and, on quads, the vertices between them.
    let mut ring = [0; 8];
    for (j, &c) in fan.corners.iter().enumerate() {
        let next = mesh.next_corner(c);
        match kind {
            SplitKind::Quad => {
                ring[2 * j] = mesh.corner_vertex(next);
                ring[2 * j + 1] = mesh.corner_vertex(mesh.next_corner(next));
            }
            SplitKind::Triangle => ring[j] = mesh.corner_vertex(next),
        }
    }
    let all_differ = match kind {
        SplitKind::Quad => all_differ(ring),
        SplitKind::Triangle => all_differ([ring[0], ring[1], ring[2], ring[3], ring[4], ring[5]]),
    };
    all_differ
        && spokes.iter().all(|&h| {
            let regular = kind == SplitKind::Triangle || edge(h.edge());
            regular && is(masks.vertex_edge[h.index()], 0.0625)
        })
        && fan.corners.iter().all(|&c| is(masks.vertex_face[c as usize], face))
}

/// Whether no number is there twice. Each is compared with those up to half a turn on, without branches.
fn all_differ<const N: usize>(numbers: [u32; N]) -> bool {
    let mut alike = false;
    for by in 1..=N / 2 {
        for i in 0..N {
            alike |= numbers[i] == numbers[(i + by) % N];
        }
    }
    !alike
}

impl Regular {
    /// The row of `H0` of a child vertex.
    pub fn h0(self, mesh: &Mesh, child: Parent, mut visit: impl FnMut(HalfEdge, f64)) {
        match (self, child) {
            (Regular::Whitney, _) | (_, Parent::Face(_)) => {}
            (_, Parent::Vertex(v)) => {
                mesh.vertex_half_edges(v).iter().for_each(|&h| visit(h, 0.0625));
                if self == Regular::Catmark {
                    for &corner in mesh.fans(v).flat_map(|fan| fan.corners) {
                        whitney::vertex_to_centre(mesh, corner, |h, weight| visit(h, 0.0625 * weight));
                    }
                }
            }
            (_, Parent::Edge(e)) => {
                let h = HalfEdge::new(e, true);
                for corner in [h, h.twin()].into_iter().filter_map(|side| mesh.left_corner(side)) {
                    match self {
                        Regular::Catmark => {
                            whitney::midpoint_to_centre(mesh, corner, |h, weight| visit(h, 0.25 * weight));
                        }
                        _ => super::loop_::midpoint_to_opposite(mesh, corner, |h, weight| {
                            visit(h, 0.125 * weight)
                        }),
                    }
                }
            }
        }
    }

    /// The row of `H1` of a child edge, in its own direction.
    pub fn h1(self, mesh: &Mesh, child: ChildEdge, mut visit: impl FnMut(u32, f64)) {
        match (self, child) {
            (Regular::Whitney, _) | (Regular::Catmark, ChildEdge::Odd(_)) => {}
            (_, ChildEdge::Even(h)) => {
                let Some(corner) = mesh.left_corner(h) else { return };
                let (fan, place) = mesh.fan_of_corner(corner);
                // Directed m_e -> v.
                let terms: &[(usize, f64)] = match self {
                    Regular::Catmark => {
                        &[(0, 7.0 / 128.0), (1, 1.0 / 128.0), (2, -1.0 / 128.0), (3, -7.0 / 128.0)]
                    }
                    _ => &[(0, 3.0 / 32.0), (1, 1.0 / 32.0), (4, -1.0 / 32.0), (5, -3.0 / 32.0)],
                };
                for &(j, weight) in terms {
                    visit(mesh.corner_face(fan.corner(place + j)), weight);
                }
            }
            (Regular::Loop, ChildEdge::Odd(corner)) => {
                for side in [corner, mesh.previous_corner(corner)] {
                    if let Some(across) = mesh.left_corner(mesh.corner_half_edge(side).twin()) {
                        visit(mesh.corner_face(corner), 1.0 / 32.0);
                        visit(mesh.corner_face(across), -1.0 / 32.0);
                    }
                }
            }
        }
    }

    /// The row of `S0` of a child vertex: no vertex twice.
    pub fn s0(self, mesh: &Mesh, child: Parent, mut visit: impl FnMut(u32, f64)) {
        match (self, child) {
            (Regular::Whitney, _) | (_, Parent::Face(_)) => whitney::w0(mesh, child, visit),
            (Regular::Catmark, Parent::Vertex(v)) => {
                visit(v, 36.0 / 64.0);
                for &c in mesh.fans(v).flat_map(|fan| fan.corners) {
                    let next = mesh.next_corner(c);
                    visit(mesh.corner_vertex(next), 6.0 / 64.0);
                    visit(mesh.corner_vertex(mesh.next_corner(next)), 1.0 / 64.0);
                }
            }
            (Regular::Loop, Parent::Vertex(v)) => {
                visit(v, 0.625);
                mesh.vertex_half_edges(v).iter().for_each(|&h| visit(mesh.head(h), 0.0625));
            }
            (_, Parent::Edge(e)) => {
                let h = HalfEdge::new(e, true);
                mesh.edges()[e as usize].iter().for_each(|&v| visit(v, 0.375));
                for corner in [h, h.twin()].into_iter().filter_map(|side| mesh.left_corner(side)) {
                    let far = mesh.previous_corner(corner);
                    match self {
                        Regular::Catmark => {
                            visit(mesh.corner_vertex(far), 0.0625);
                            visit(mesh.corner_vertex(mesh.previous_corner(far)), 0.0625);
                        }
                        _ => visit(mesh.corner_vertex(far), 0.125),
                    }
                }
            }
        }
    }

    /// The row of `S1` of a child edge in its own direction: no edge twice. `continued(h)` is the half-edge
    /// that reaches the tail of `h` straight on; only quads ask for it.
    #[inline(always)]
    pub fn s1(
        self,
        mesh: &Mesh,
        kind: SplitKind,
        child: ChildEdge,
        continued: impl Fn(HalfEdge) -> HalfEdge,
        mut visit: impl FnMut(HalfEdge, f64),
    ) {
        match (self, child) {
            (Regular::Whitney, _) => whitney::w1(mesh, kind, child, visit),
            (Regular::Catmark, ChildEdge::Even(h)) => {
                for (h, weight) in [(h, -3.0 / 64.0), (continued(h), -1.0 / 64.0)] {
                    visit(h, 6.0 * weight);
                    for parallel in parallels(mesh, h) {
                        visit(parallel, weight);
                    }
                }
            }
            (Regular::Catmark, ChildEdge::Odd(corner)) => {
                let across = left(mesh, mesh.corner_half_edge(corner).twin());
                // Directed p_f -> m_e.
                for (corner, weight) in [(corner, -12.0 / 64.0), (across, 4.0 / 64.0)] {
                    visit(mesh.corner_half_edge(turn(corner, 1)), weight);
                    visit(mesh.corner_half_edge(turn(corner, 3)), -weight);
                }
            }
            (Regular::Loop, ChildEdge::Even(h)) => {
                let edges = spokes_and_rims(mesh, &fan_from(mesh, left(mesh, h)));
                for (h, weight) in edges.into_iter().zip(EVEN) {
                    if weight != 0.0 {
                        visit(h, weight);
                    }
                }
            }
            (Regular::Loop, ChildEdge::Odd(corner)) => {
                let corners = [corner, mesh.next_corner(corner), mesh.previous_corner(corner)];
                let edges = sides_and_across(mesh, corners);
                for (h, weight) in edges.into_iter().zip(ODD) {
                    if weight != 0.0 {
                        visit(h, weight);
                    }
                }
            }
        }
    }

    /// The row of `S2` of a child face: no face twice.
    #[inline(always)]
    pub fn s2(self, mesh: &Mesh, split: &Split, child: usize, mut visit: impl FnMut(u32, f64)) {
        let of = split.face_parent(mesh, child);
        match (self, split.kind()) {
            (Regular::Whitney, kind) => visit(of, whitney::w2(mesh, kind, of)),
            (_, SplitKind::Triangle) if child % 4 == 3 => {
                visit(of, 2.0 / 32.0);
                for &h in mesh.face_half_edges(of) {
                    visit(mesh.corner_face(left(mesh, h.twin())), 2.0 / 32.0);
                }
            }
            (_, SplitKind::Triangle) => {
                let corners: [u32; 6] = fan_from(mesh, split.parent_corner(mesh, child));
                for (corner, weight) in corners.into_iter().zip(CORNER) {
                    if weight != 0.0 {
                        visit(mesh.corner_face(corner), weight);
                    }
                }
            }
            (_, SplitKind::Quad) => {
                let corners: [u32; 4] = fan_from(mesh, split.parent_corner(mesh, child));
                let weights = [9.0 / 64.0, 3.0 / 64.0, 1.0 / 64.0, 3.0 / 64.0];
                for (corner, weight) in corners.into_iter().zip(weights) {
                    visit(mesh.corner_face(corner), weight);
                }
            }
        }
    }
}

/// The corners round a regular vertex, counter-clockwise from one of them on.
#[inline(always)]
fn fan_from<const N: usize>(mesh: &Mesh, corner: u32) -> [u32; N] {
    let (fan, place) = mesh.fan_of_corner(corner);
    let fan: &[u32; N] = fan.corners.try_into().expect("a regular vertex has its valence");
    let mut turned = [0; N];
    for (j, corner) in turned.iter_mut().enumerate() {
        *corner = fan[wrap(place + j, N)];
    }
    turned
}

/// The corner of a regular half-edge, which has faces on both sides.
#[inline]
fn left(mesh: &Mesh, h: HalfEdge) -> u32 {
    mesh.left_corner(h).expect("a regular edge has two faces")
}

/// The corner `by` further on in the same face of a mesh of quads.
#[inline]
pub fn turn(corner: u32, by: u32) -> u32 {
    (corner & !3) | ((corner + by) & 3)
}

/// The two edges parallel to `h` in the quads on its left and right, in its direction.
#[inline]
pub fn parallels(mesh: &Mesh, h: HalfEdge) -> [HalfEdge; 2] {
    let opposite = |corner| mesh.corner_half_edge(turn(corner, 2));
    [opposite(left(mesh, h)).twin(), opposite(left(mesh, h.twin()))]
}
