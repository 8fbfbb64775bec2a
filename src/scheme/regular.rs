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

use super::triangle_rows::{CORNER, EVEN, ODD, sides_and_across, spokes_and_rims};
use super::whitney;
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
