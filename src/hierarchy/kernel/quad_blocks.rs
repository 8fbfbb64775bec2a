//! 1-forms on quads that are the children of quads: four at a time.
//!
//! The children of a quad are numbered by rule, so the incidence of the level above, four times smaller, tells where
//! everything is; and what four quads need of their surroundings is fetched once for all of them. In a quad of the
//! level above, whose corners are `v_i`, midpoints `m_i` (of `v_i -> v_{i+1}`) and centre `p`, write
//!
//! ```text
//! a_i = c(v_i -> m_i)        b_i = c(m_i -> v_{i+1})        o_i = c(p -> m_i)
//! ```
//!
//! and let a prime mark the quad across side `i`, in which that side has number `t`. Then with the sums across an
//! edge (six times itself, and its parallels) and those over the pair of parallel edges of a child
//!
//! ```text
//! U_i = 6 o_i + b_{i-1} - a_{i+1}        X_i = o_i + b_{i-1}        Y_i = o_{i-1} - a_i
//! ```
//!
//! the rows of [`super::quads`] are, for the child at `v_i` towards its four sides, and along the halves of `o_i`,
//!
//! ```text
//! 16 x  (3 X_i - Y'_{t+1},  X_{i+1} - 3 Y_i,  Y_{i-1} - 3 X_i,  3 Y_i - X'_t)
//! 64 x  (U_{i+2} - 3 U_i,  3 U_i - U'_t)
//! ```

use rayon::prelude::*;

use super::{BLOCK, Workspace, patch};
use crate::cochain::Quantity;
use crate::hierarchy::refinement::{NONE, Refinement};
use crate::memory::{self, Stores};
use crate::scheme::regular::turn;
use crate::topology::{HalfEdge, Mesh};

/// How many quads are computed before they are stored: a call for each would take as long as its stores.
const TOGETHER: usize = 8;

/// `above` is the level above the parent; both are all quads.
pub fn form1<T: Quantity>(
    r: &Refinement,
    above: &Mesh,
    c: &[T],
    out: &mut [T],
    workspace: &mut Workspace<T>,
) {
    let (corners, lefts) = (above.corner_half_edges(), above.left_corners());
    let num_corners = above.num_corners();
    let (centres, halves) = c.split_at(num_corners);

    // For each half-edge of the level above the sum across its half at its tail, directed to that tail.
    let across = &mut workspace.edges;
    memory::reuse(across, halves.len(), T::zero());
    let chunks = across.par_chunks_mut(2 * BLOCK).zip(lefts.par_chunks(2 * BLOCK));
    chunks.zip(halves.par_chunks(2 * BLOCK)).for_each(|((across, lefts), halves)| {
        let edges = across.chunks_exact_mut(2).zip(lefts.chunks_exact(2)).zip(halves.chunks_exact(2));
        for ((across, sides), own) in edges {
            let (left, right) = (sides[0], sides[1]);
            if left != NONE.0 && right != NONE.0 {
                // From the centres to the neighbouring sides, at either end.
                let tail = centres[turn(left, 3) as usize] + centres[turn(right, 1) as usize];
                let head = centres[turn(left, 1) as usize] + centres[turn(right, 3) as usize];
                across[0] = own[0].scale(6.0) + tail;
                across[1] = own[1].scale(6.0) + head;
            }
        }
    });

    let bytes = size_of_val(out);
    let (odd, even) = out.split_at_mut(4 * num_corners);
    let (inner, outer) = even.split_at_mut(2 * num_corners);
    let chunks = odd.par_chunks_mut(16 * BLOCK).zip(inner.par_chunks_mut(8 * BLOCK));
    chunks.enumerate().for_each(|(i, (odd, inner))| {
        let first = 4 * BLOCK * i;
        let across = |side: HalfEdge| {
            let corner = lefts[side.twin().index()];
            (corner != NONE.0).then(|| {
                let next = corners[turn(corner, 1) as usize];
                let previous = corners[turn(corner, 3) as usize];
                let a = T::zero() - halves[next.index()];
                [a, halves[previous.twin().index()], centres[corner as usize]]
            })
        };
        Stores::to_array_of(bytes, |stores| {
            let mut quads = corners[first..].as_chunks().0.iter().zip(centres[first..].as_chunks().0);
            let mut compute = |odd: &mut [[T; 16]], inner: &mut [[T; 8]]| {
                for ((odd, inner), (sides, o)) in odd.iter_mut().zip(inner).zip(&mut quads) {
                    inside(halves, sides, o, odd, inner, across);
                }
            };
            let (odd, inner) = (odd.as_chunks_mut().0, inner.as_chunks_mut().0);
            let Some(stores) = stores else { return compute(odd, inner) };
            let (odd_here, inner_here) = (&mut [[T::zero(); 16]; TOGETHER], &mut [[T::zero(); 8]; TOGETHER]);
            for (odd, inner) in odd.chunks_mut(TOGETHER).zip(inner.chunks_mut(TOGETHER)) {
                compute(&mut odd_here[..odd.len()], &mut inner_here[..odd.len()]);
                stores.copy(odd, &odd_here[..odd.len()]);
                stores.copy(inner, &inner_here[..inner.len()]);
            }
        });
        patch(r, c, 4 * first, odd);
        patch(r, c, 4 * num_corners + 2 * first, inner);
    });

    outer.par_chunks_mut(4 * BLOCK).enumerate().for_each(|(i, out)| {
        let first = 2 * BLOCK * i;
        let edges = out.chunks_exact_mut(4).zip(r.continued[first..].chunks_exact(2));
        for ((out, continued), own) in edges.zip(across[first..].chunks_exact(2)) {
            for end in 0..2 {
                let (here, there) = (own[end].scale(3.0), own[1 - end]);
                out[2 * end] = (there - here).scale(1.0 / 64.0);
                if continued[end] != NONE {
                    let beyond = across[continued[end].twin().index()];
                    out[2 * end + 1] = (here - beyond).scale(1.0 / 64.0);
                }
            }
        }
        patch(r, c, 6 * num_corners + 2 * first, out);
    });
}

/// The child edges inside a quad of the level above: 16 in its four children, 8 halves of those that part them.
/// `across(side)` is `a'_{t+1}`, `b'_{t-1}` and `o'_t`, if there is a quad.
#[inline(always)]
fn inside<T: Quantity>(
    halves: &[T],
    sides: &[HalfEdge; 4],
    o: &[T; 4],
    odd: &mut [T; 16],
    inner: &mut [T; 8],
    across: impl Fn(HalfEdge) -> Option<[T; 3]>,
) {
    // Scaled once: X, Y by 1/16 and U by 1/64.
    let a = |i: usize| halves[sides[i].index()].scale(-1.0 / 16.0);
    let b = |i: usize| halves[sides[i].twin().index()].scale(1.0 / 16.0);
    let o = |i: usize| o[i].scale(1.0 / 16.0);
    let (a, b, o) = ([a(0), a(1), a(2), a(3)], [b(0), b(1), b(2), b(3)], [o(0), o(1), o(2), o(3)]);
    let u = |o: T, difference: T| o.scale(1.5) + difference.scale(0.25);
    let (mut sum, mut x, mut y) = (a, a, a);
    for i in 0..4 {
        let (next, previous) = ((i + 1) % 4, (i + 3) % 4);
        sum[i] = u(o[i], b[previous] - a[next]);
        x[i] = o[i] + b[previous];
        y[i] = o[previous] - a[i];
    }
    let three = |x: T| x.scale(3.0);
    for i in 0..4 {
        let (next, behind, previous) = ((i + 1) % 4, (i + 2) % 4, (i + 3) % 4);
        odd[4 * i + next] = x[next] - three(y[i]);
        odd[4 * i + behind] = y[previous] - three(x[i]);
        inner[2 * i] = sum[behind] - three(sum[i]);
        if let Some([a, b, o]) = across(sides[i]) {
            let (a, b, o) = (a.scale(1.0 / 16.0), b.scale(1.0 / 16.0), o.scale(1.0 / 16.0));
            odd[4 * i + i] = three(x[i]) + (a - o);
            odd[4 * next + i] = three(y[next]) - (o + b);
            inner[2 * i + 1] = three(sum[i]) - u(o, b - a);
        }
    }
}
