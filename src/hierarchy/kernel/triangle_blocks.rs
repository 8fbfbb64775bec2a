//! 1-forms on triangles that are the children of triangles: four at a time, as [`super::quad_blocks`] does for quads.
//!
//! In a triangle of the level above, whose corners are `v_i` and midpoints `m_i` (of `v_i -> v_{i+1}`), write
//!
//! ```text
//! a_i = c(v_i -> m_i)        b_i = c(m_i -> v_{i+1})        o_i = c(m_i -> m_{i-1})
//! D_i = a_i + o_i + b_{i-1} on the child at v_i        D = -(o_0 + o_1 + o_2) on the one in the middle
//! ```
//!
//! and let a prime mark the triangle across side `i`, in which that side has number `t`. (A) then reads, for the
//! displacements `h`, times 16,
//!
//! ```text
//! midpoint of o_i         b_{i-1} - a_i + o_{i-1} - o_{i+1}
//! midpoint of a_i         o_i - b_{i-1} + a'_{t+1} - o'_{t+1}
//! midpoint of b_i         a_{i+1} - o_{i+1} + o'_t - b'_{t-1}
//! child of m_i            b_i - a_i + o_i - o_{i+1} + o'_t - o'_{t+1}
//! ```

use rayon::prelude::*;

use super::exceptions::Exceptional;
use super::triangles::{next, previous};
use super::{BLOCK, Workspace};
use crate::cochain::Quantity;
use crate::hierarchy::refinement::NONE;
use crate::topology::{HalfEdge, Mesh};

/// A 1-cochain on the children of the triangles of a level.
struct Children<'a, T> {
    corners: &'a [HalfEdge],
    lefts: &'a [u32],
    /// `o`, corner by corner.
    inside: &'a [T],
    /// The halves of the edges, directed away from the midpoints.
    halves: &'a [T],
}

impl<T: Quantity> Children<'_, T> {
    #[inline]
    fn a(&self, corner: u32) -> T {
        self.halves[self.corners[corner as usize].index()].negate_if(true)
    }

    #[inline]
    fn b(&self, corner: u32) -> T {
        self.halves[self.corners[corner as usize].twin().index()]
    }

    #[inline]
    fn o(&self, corner: u32) -> T {
        self.inside[corner as usize]
    }

    /// `a'_{t+1}`, `o'_{t+1}`, `o'_t`, `b'_{t-1}` of the triangle in which the side has corner `t`.
    #[inline]
    fn across(&self, t: u32) -> [T; 4] {
        [self.a(next(t)), self.o(next(t)), self.o(t), self.b(previous(t))]
    }
}

/// The child of the triangle of a corner at that corner.
#[inline]
fn child_at(corner: u32) -> usize {
    (corner + corner / 3) as usize
}

/// `above` is the level above the parent.
pub fn form1<T: Quantity>(
    above: &Mesh,
    parent: &Mesh,
    c: &[T],
    out: &mut [T],
    workspace: &mut Workspace<T>,
    exceptional: &Exceptional<T>,
) {
    let num_corners = above.num_corners();
    let (inside, halves) = c.split_at(num_corners);
    let k = Children { corners: above.corner_half_edges(), lefts: above.left_corners(), inside, halves };

    // h at the children of the vertices of the level above.
    let at_vertices = &mut workspace.vertices;
    at_vertices.resize(above.num_vertices(), T::zero());
    at_vertices.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(v, out)| {
        let spokes = above.vertex_half_edges(v as u32).iter();
        *out = spokes.fold(T::zero(), |sum, &h| sum + halves[h.index()]).scale(-1.0 / 16.0);
    });
    let curl = &mut workspace.faces;
    curl.resize(parent.num_faces(), T::zero());

    let (odd, even) = out.split_at_mut(4 * num_corners);
    let (inner, outer) = even.split_at_mut(2 * num_corners);
    let chunks = odd.par_chunks_mut(12 * BLOCK).zip(inner.par_chunks_mut(6 * BLOCK));
    chunks.zip(curl.par_chunks_mut(4 * BLOCK)).enumerate().for_each(|(i, ((odd, inner), curl))| {
        let first = 3 * BLOCK * i;
        let faces = odd.chunks_exact_mut(12).zip(inner.chunks_exact_mut(6)).zip(curl.chunks_exact_mut(4));
        for (f, ((odd, inner), curl)) in faces.enumerate() {
            within(&k, (first + 3 * f) as u32, odd, inner, curl);
        }
        exceptional.patch(4 * first, odd);
        exceptional.patch(4 * num_corners + 2 * first, inner);
    });

    let curl = &curl[..];
    outer.par_chunks_mut(4 * BLOCK).enumerate().for_each(|(i, out)| {
        let first = BLOCK * i;
        for (e, out) in out.chunks_exact_mut(4).enumerate() {
            let e = first + e;
            let (left, right) = (k.lefts[2 * e], k.lefts[2 * e + 1]);
            if left != NONE.0 && right != NONE.0 {
                let ends = above.edges()[e].map(|v| at_vertices[v as usize]);
                along_edge(&k, curl, e, [left, right], ends, out);
            }
        }
        exceptional.patch(6 * num_corners + 4 * first, out);
    });
}

/// The child edges inside a triangle of the level above, the first of whose corners is given: 12 in its four
/// children, 6 halves of those that part them; and the curl of the children.
#[inline(always)]
fn within<T: Quantity>(k: &Children<T>, first: u32, odd: &mut [T], inner: &mut [T], curl: &mut [T]) {
    let (odd, inner, curl) = (&mut odd[..12], &mut inner[..6], &mut curl[..4]);
    let at = |i: usize| first + i as u32;
    let a = [k.a(at(0)), k.a(at(1)), k.a(at(2))];
    let b = [k.b(at(0)), k.b(at(1)), k.b(at(2))];
    let o = [k.o(at(0)), k.o(at(1)), k.o(at(2))];
    let zero = T::zero();
    let (mut d, mut h_inner, mut h_a, mut h_b, mut at_m) = ([zero; 3], [zero; 3], [zero; 3], [zero; 3], [zero; 3]);
    let (mut beyond_a, mut beyond_b) = ([zero; 3], [zero; 3]);
    let mut open = [false; 3];
    for i in 0..3 {
        let (n, p) = ((i + 1) % 3, (i + 2) % 3);
        d[i] = a[i] + o[i] + b[p];
        h_inner[i] = (b[p] - a[i] + o[p] - o[n]).scale(1.0 / 16.0);
        let t = k.lefts[k.corners[at(i) as usize].twin().index()];
        open[i] = t == NONE.0;
        if t != NONE.0 {
            let [a1, o1, o0, b2] = k.across(t);
            h_a[i] = (o[i] - b[p] + a1 - o1).scale(1.0 / 16.0);
            h_b[i] = (a[n] - o[n] + o0 - b2).scale(1.0 / 16.0);
            at_m[i] = (b[i] - a[i] + o[i] - o[n] + o0 - o1).scale(1.0 / 16.0);
            beyond_a[i] = a1 + o1 - a[i];
            beyond_b[i] = o0 + b2 - b[i];
        }
    }
    let middle = zero - (o[0] + o[1] + o[2]);
    curl[..3].copy_from_slice(&d);
    curl[3] = middle;
    // m_before -> m_after of an odd child edge, from its sides, their displacements, its face and those across.
    let odd_edge = |[on, leave, reach]: [T; 3], h: T, own: T, others: T| {
        (on - leave - reach).scale(0.25) + h + (own.scale(2.0) - others).scale(1.0 / 32.0)
    };
    for i in 0..3 {
        let (n, p) = ((i + 1) % 3, (i + 2) % 3);
        // The child at v_i: sides a_i, o_i, b_{i-1}. At its corner i, leaving a_i and reached by b_{i-1}, ..
        if !open[i] && !open[p] {
            odd[3 * i + i] = odd_edge([o[i], a[i], b[p]], h_b[p] - h_a[i], d[i], beyond_a[i] + beyond_b[p]);
        }
        // .. at m_i, leaving o_i and reached by a_i, ..
        if !open[i] {
            odd[3 * i + n] = odd_edge([b[p], o[i], a[i]], h_a[i] - h_inner[i], d[i], middle + beyond_a[i]);
        }
        // .. at m_{i-1}, leaving b_{i-1} and reached by o_i.
        if !open[p] {
            odd[3 * i + p] = odd_edge([a[i], b[p], o[i]], h_inner[i] - h_b[p], d[i], beyond_b[p] + middle);
        }
        // The middle runs against o: its corner j lies at m_{j+1}, leaving o_{j+2} and reached by o_{j+1}.
        let (leave, reach, on) = (zero - o[p], zero - o[n], zero - o[i]);
        odd[9 + i] = odd_edge([on, leave, reach], h_inner[n] - h_inner[p], middle, d[n] + d[p]);

        // The halves of o_i: to m_i, and to m_{i-1}.
        let turn = (d[i] - middle).scale(3.0);
        let half = o[i].scale(0.5) - turn.scale(1.0 / 32.0);
        if !open[i] {
            inner[2 * i] = at_m[i] - h_inner[i] - half + (beyond_a[i] - d[n]).scale(1.0 / 32.0);
        }
        if !open[p] {
            inner[2 * i + 1] = at_m[p] - h_inner[i] + half + (d[p] - beyond_b[p]).scale(1.0 / 32.0);
        }
    }
}

/// The four children of the halves of edge `e` of the level above, `left` and `right` its corners and `ends` the
/// displacements of the children of its vertices.
#[inline(always)]
fn along_edge<T: Quantity>(
    k: &Children<T>,
    curl: &[T],
    e: usize,
    [left, right]: [u32; 2],
    ends: [T; 2],
    out: &mut [T],
) {
    let middle = |corner: u32| curl[4 * (corner as usize / 3) + 3];
    let own = [k.halves[2 * e], k.halves[2 * e + 1]];
    let (o_left, o_right) = ([k.o(left), k.o(next(left))], [k.o(right), k.o(next(right))]);
    let spokes = own[0] + own[1] + o_left[0] - o_left[1] + o_right[0] - o_right[1];
    let at_m = spokes.scale(1.0 / 16.0);
    // Seen from end 0, `l` is the corner there of the face on the left of e; from end 1 the faces change places.
    let both = [(left, right, o_left, o_right), (right, left, o_right, o_left)];
    for (end, (l, r, o_l, o_r)) in both.into_iter().enumerate() {
        let h = (o_l[0] - k.b(previous(l)) + k.a(next(r)) - o_r[1]).scale(1.0 / 16.0);
        // m -> v has the child of the right face on its left.
        let turn = (curl[child_at(next(r))] - curl[child_at(l)]).scale(3.0);
        let half = own[end].scale(0.5) - turn.scale(1.0 / 32.0);
        out[2 * end] = at_m - h - half + (middle(r) - middle(l)).scale(1.0 / 32.0);
        let across = |corner: u32| k.lefts[k.corners[corner as usize].twin().index()];
        let (before, behind) = (across(previous(l)), across(next(r)));
        if before != NONE.0 && behind != NONE.0 {
            // Round v, counter-clockwise beyond the left face, and clockwise beyond the right one.
            let turn = curl[child_at(before)] - curl[child_at(next(behind))];
            out[2 * end + 1] = ends[end] - h + half + turn.scale(1.0 / 32.0);
        }
    }
}
