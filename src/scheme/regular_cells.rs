//! Which cells are regular: what [`super::regular`] calls so, as OpenSubdiv's weights tell it.

use rayon::prelude::*;

use crate::memory;
use crate::osd::{Masks, Rule};
use crate::topology::{ChildEdge, HalfEdge, Mesh, Split, SplitKind};

/// Which vertices and edges of a level are regular.
pub struct RegularCells {
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
    pub fn of(kind: SplitKind, mesh: &Mesh, masks: &Masks, known: &[bool]) -> Self {
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
    pub fn other_child_edges(&self, split: &Split, mesh: &Mesh) -> impl Iterator<Item = usize> {
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
        let places =
            edges.flat_map(of_edge).chain(vertices.flat_map(of_vertex)).chain(corners.map(ChildEdge::Odd));
        places
            .filter(|&place| !self.child_edge(split.kind(), mesh, place))
            .map(|place| split.edge_of(place) as usize)
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
