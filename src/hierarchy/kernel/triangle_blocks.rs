//! 1-forms on triangles that are the children of triangles: four at a time, as [`super::quad_blocks`] does for quads.
//!
//! In a triangle of the level above, whose corners are `v_i` and midpoints `m_i` (of `v_i -> v_{i+1}`), write
//!
//! ```text
//! a_i = c(v_i -> m_i)        b_i = c(m_i -> v_{i+1})        o_i = c(m_i -> m_{i-1})
//! D_i = a_i + o_i + b_{i-1} on the child at v_i        D = -(o_0 + o_1 + o_2) on the one in the middle
//! ```
//!
//! and let a prime mark the triangle across side `i`, in which that side has number `t`. Then the rows of
//! [`Regular::s1`](crate::scheme::Regular::s1) become sums over these. A child of a half of side `i` looks at both
//! triangles beside the side and, at its far end, at all round that vertex: it is the sum of what the two corners that
//! name the side give to it, each computed with its own triangle, and of
//!
//! ```text
//! at the midpoint     (c_0 + c_1)/16 - c/2      c the half of the side, c_0 and c_1 both, away from the midpoint
//! at the vertex v     h_v + c/2                 h_v = (sum of the spokes of v)/16, the displacement (A) of its child
//! ```

use rayon::prelude::*;

use super::triangles::{next, previous};
use super::{BLOCK, Workspace, patch};
use crate::cochain::Quantity;
use crate::hierarchy::refinement::{NONE, Refinement};
use crate::memory;
use crate::topology::{HalfEdge, Mesh};

/// A 1-cochain on the children of the triangles of a level; read divided by 32.
struct Children<'a, T> {
    corners: &'a [HalfEdge],
    lefts: &'a [u32],
    /// `o`, corner by corner.
    inside: &'a [T],
    /// The halves of the edges, directed away from the midpoints.
    halves: &'a [T],
}

impl<T: Quantity> Children<'_, T> {
    #[inline(always)]
    fn a(&self, corner: u32) -> T {
        self.halves[self.corners[corner as usize].index()].scale(-1.0 / 32.0)
    }

    #[inline(always)]
    fn b(&self, corner: u32) -> T {
        self.halves[self.corners[corner as usize].twin().index()].scale(1.0 / 32.0)
    }

    #[inline(always)]
    fn o(&self, corner: u32) -> T {
        self.inside[corner as usize].scale(1.0 / 32.0)
    }

    #[inline(always)]
    fn across(&self, corner: u32) -> [T; 4] {
        match self.lefts[self.corners[corner as usize].twin().index()] {
            t if t == NONE.0 => [T::zero(); 4],
            t => [self.a(next(t)), self.o(next(t)), self.o(t), self.b(previous(t))],
        }
    }
}

/// `above` is the level above the parent.
pub fn form1<T: Quantity>(
    r: &Refinement,
    above: &Mesh,
    c: &[T],
    out: &mut [T],
    workspace: &mut Workspace<T>,
) {
    let num_corners = above.num_corners();
    let (inside, halves) = c.split_at(num_corners);
    let k = Children { corners: above.corner_half_edges(), lefts: above.left_corners(), inside, halves };

    // h at the children of the vertices of the level above.
    let at_vertices = &mut workspace.vertices;
    memory::reuse(at_vertices, above.num_vertices(), T::zero());
    at_vertices.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(v, out)| {
        let spokes = above.vertex_half_edges(v as u32).iter();
        *out = spokes.fold(T::zero(), |sum, &h| sum + halves[h.index()]).scale(-1.0 / 16.0);
    });
    // What each corner gives to the four children of the side that it names.
    let sides = &mut workspace.faces;
    memory::reuse(sides, 4 * num_corners, T::zero());

    let (odd, even) = out.split_at_mut(4 * num_corners);
    let (inner, outer) = even.split_at_mut(2 * num_corners);
    let chunks = odd.par_chunks_mut(12 * BLOCK).zip(inner.par_chunks_mut(6 * BLOCK));
    chunks.zip(sides.par_chunks_mut(12 * BLOCK)).enumerate().for_each(|(i, ((odd, inner), sides))| {
        let first = 3 * BLOCK * i;
        let faces = odd.chunks_exact_mut(12).zip(inner.chunks_exact_mut(6)).zip(sides.chunks_exact_mut(12));
        for (f, ((odd, inner), sides)) in faces.enumerate() {
            within(&k, (first + 3 * f) as u32, odd, inner, sides);
        }
        patch(r, c, 4 * first, odd);
        patch(r, c, 4 * num_corners + 2 * first, inner);
    });

    let (sides, _) = sides.as_chunks::<4>();
    outer.par_chunks_mut(4 * BLOCK).enumerate().for_each(|(i, out)| {
        let first = BLOCK * i;
        let edges = above.edges()[first..].iter().zip(k.lefts[2 * first..].as_chunks::<2>().0);
        let edges = edges.zip(halves[2 * first..].as_chunks::<2>().0);
        for (out, ((ends, &[left, right]), own)) in out.as_chunks_mut::<4>().0.iter_mut().zip(edges) {
            if left != NONE.0 && right != NONE.0 {
                // Seen from either end, its own face is the one on the left of the half that leaves it.
                let (left, right) = (sides[left as usize], sides[right as usize]);
                let at_m = (own[0] + own[1]).scale(1.0 / 16.0);
                for (end, (l, r)) in [(left, right), (right, left)].into_iter().enumerate() {
                    let half = own[end].scale(0.5);
                    out[2 * end] = at_m - half + (l[0] + r[2]);
                    out[2 * end + 1] = at_vertices[ends[end] as usize] + half + (l[1] + r[3]);
                }
            }
        }
        patch(r, c, 6 * num_corners + 4 * first, out);
    });
}

/// Around a triangle of the level above: what its three sides have on either side of them, all divided by 32.
struct Around<T> {
    a: [T; 3],
    b: [T; 3],
    o: [T; 3],
    /// `a'_{t+1}`, `o'_{t+1}`, `o'_t`, `b'_{t-1}` across each side; zero if there is nothing.
    across: [[T; 4]; 3],
    /// The curl of the child at each corner.
    d: [T; 3],
    /// That of the child in the middle.
    middle: T,
}

/// The child edges inside a triangle of the level above, the first of whose corners is given: 12 in its four
/// children, 6 halves of those that part them; and for each side what it gives to its children. Where the triangle
/// across is missing they are exceptions, and what is written here stands for nothing.
#[inline(always)]
fn within<T: Quantity>(k: &Children<T>, first: u32, odd: &mut [T], inner: &mut [T], sides: &mut [T]) {
    let [i, j, l] = [first, first + 1, first + 2];
    let (a, b, o) = ([k.a(i), k.a(j), k.a(l)], [k.b(i), k.b(j), k.b(l)], [k.o(i), k.o(j), k.o(l)]);
    let d = [a[0] + o[0] + b[2], a[1] + o[1] + b[0], a[2] + o[2] + b[1]];
    let middle = T::zero() - (o[0] + o[1] + o[2]);
    let t = Around { a, b, o, across: [k.across(i), k.across(j), k.across(l)], d, middle };
    let odd = odd.first_chunk_mut().expect("12 edges");
    let inner = inner.first_chunk_mut().expect("6 halves");
    let sides = sides.first_chunk_mut().expect("4 values for each side");
    t.third([0, 1, 2], odd, inner, sides);
    t.third([1, 2, 0], odd, inner, sides);
    t.third([2, 0, 1], odd, inner, sides);
}

impl<T: Quantity> Around<T> {
    /// What belongs to corner `i`, the next one `n` and the previous one `p`.
    ///
    /// The row of an odd child edge cuts the corner between the half-edges `e_j` and `e_{j-1}` of its face; with the
    /// curl `D` of the face, and `x`, `y` the half-edges after and before the twin of `e_j` in the face beyond, `z`, `w`
    /// those of `e_{j-1}`, it is `9 e_{j+1} - 3 D + (y - 3 x) + (z - 3 w)`.
    #[inline(always)]
    fn third(&self, [i, n, p]: [usize; 3], odd: &mut [T; 12], inner: &mut [T; 6], sides: &mut [T; 12]) {
        let Around { a, b, o, across, d, middle } = self;
        let three = |x: T| x.scale(3.0);
        let nine = |x: T| x.scale(9.0);
        let two = |x: T| x + x;
        // Across side i, and across side p.
        let ([a1, o1, o0, _], [_, _, o2, b2]) = (across[i], across[p]);
        let d3 = three(d[i]);

        // The child at v_i: a_i, o_i, b_p. At v_i, at m_i and at m_p.
        odd[3 * i + i] = nine(o[i]) - d3 + (o1 - three(a1)) + (o2 - three(b2));
        odd[3 * i + n] = nine(b[p]) - d3 + (three(o[n]) - o[p]) + (a1 - three(o1));
        odd[3 * i + p] = nine(a[i]) - d3 + (b2 - three(o2)) + (three(o[p]) - o[n]);
        // The middle runs against o: at m_n it leaves o_p and is reached by o_n.
        odd[9 + i] = (a[p] - three(b[n])) + (b[i] - three(a[n])) - nine(o[i]) - three(*middle);

        // The half of o_i at m_i, and that at m_p: spokes of the one and of the other, then their rims.
        let spokes = two(a[i] + o[n] + o0) + b[i] - o1 - o[i].scale(8.0);
        inner[2 * i] = spokes + (b[p] + a1) - (a[n] - o[p]);
        let [_, o1, o0, b2] = across[p];
        let spokes = o[i].scale(8.0) - two(o[p] + o1 + b[p]) - a[p] + o0;
        inner[2 * i + 1] = spokes + (b[n] - o[n]) - (b2 + a[i]);

        // Side i: at v_i the child next to its midpoint and the one next to v_i, then the two at v_n.
        let there = three(d[n]);
        let [a3, o3, ..] = across[n];
        sides[4 * i] = two(b[p] - o[n]) - d3 - *middle;
        sides[4 * i + 1] = two(b[p] - o[i]) + d3 + (o0 + b2 - b[p]);
        sides[4 * i + 2] = two(o[i] - a[n]) + there + *middle;
        sides[4 * i + 3] = two(o[n] - a[n]) - there - (a3 + o3 - a[n]);
    }
}
