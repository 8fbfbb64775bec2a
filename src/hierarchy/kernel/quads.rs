//! 1-forms on quads. The regular rows are products of two rows, one along the child edge and one across it,
//!
//! ```text
//! even   (3, 1)/8 along e and the edge it continues   x   (1, 6, 1)/8 across
//! odd    (1, 1)/4 on the two edges of a face          x   (3, 1)/4 across the edge
//! ```
//!
//! so the sums over one factor are taken once, for each face and each edge, and shared.

use rayon::prelude::*;

use super::{BLOCK, Workspace, patch};
use crate::cochain::{Quantity, along};
use crate::hierarchy::refinement::{NONE, Refinement};
use crate::memory;
use crate::scheme::regular::turn;
use crate::topology::{HalfEdge, Mesh};

pub fn form1<T: Quantity>(
    r: &Refinement,
    parent: &Mesh,
    c: &[T],
    out: &mut [T],
    workspace: &mut Workspace<T>,
) {
    let (corners, lefts) = (parent.corner_half_edges(), parent.left_corners());
    let (num_faces, num_edges) = (parent.num_faces(), parent.num_edges());

    // For each face the sums of its two pairs of edges: from side 0 to side 2, and from side 1 to side 3.
    let pairs = &mut workspace.faces;
    memory::reuse(pairs, 2 * num_faces, T::zero());
    pairs.par_chunks_mut(2 * BLOCK).zip(corners.par_chunks(4 * BLOCK)).for_each(|(pairs, corners)| {
        for (pair, h) in pairs.chunks_exact_mut(2).zip(corners.chunks_exact(4)) {
            pair[0] = along(c, h[1]) - along(c, h[3]);
            pair[1] = along(c, h[2]) - along(c, h[0]);
        }
    });

    // For each edge the sum across: six times itself, and its parallels.
    let across = &mut workspace.edges;
    memory::reuse(across, num_edges, T::zero());
    across.par_chunks_mut(BLOCK).zip(lefts.par_chunks(2 * BLOCK)).enumerate().for_each(
        |(i, (across, lefts))| {
            for ((sum, sides), &own) in across.iter_mut().zip(lefts.chunks_exact(2)).zip(&c[i * BLOCK..]) {
                if sides[0] != NONE.0 && sides[1] != NONE.0 {
                    let left = along(c, corners[turn(sides[0], 2) as usize]);
                    let right = along(c, corners[turn(sides[1], 2) as usize]);
                    *sum = own.scale(6.0) + (right - left);
                }
            }
        },
    );

    let (odd, even) = out.split_at_mut(4 * num_faces);
    odd.par_chunks_mut(4 * BLOCK).enumerate().for_each(|(i, out)| {
        let first = 4 * BLOCK * i;
        let faces = out.chunks_exact_mut(4).zip(corners[first..].chunks_exact(4));
        for ((out, h), pair) in faces.zip(pairs[2 * BLOCK * i..].chunks_exact(2)) {
            let own = [pair[0], pair[1], T::zero() - pair[0], T::zero() - pair[1]];
            for side in 0..4 {
                let across = lefts[h[side].twin().index()];
                if across != NONE.0 {
                    let other = pairs[(across / 4 * 2 + across % 2) as usize].negate_if(across & 2 == 2);
                    out[side] = other.scale(1.0 / 16.0) - own[side].scale(3.0 / 16.0);
                }
            }
        }
        patch(r, c, first, out);
    });

    let sum_along = |h: HalfEdge| along(across, h);
    even.par_chunks_mut(2 * BLOCK).enumerate().for_each(|(i, out)| {
        let first = 2 * BLOCK * i;
        let edges = out.chunks_exact_mut(2).zip(r.continued[first..].chunks_exact(2));
        for ((out, continued), &own) in edges.zip(&across[BLOCK * i..]) {
            // Both halves are directed away from the midpoint.
            for (half, weight) in [-3.0 / 64.0, 3.0 / 64.0].into_iter().enumerate() {
                if continued[half] != NONE {
                    out[half] = own.scale(weight) - sum_along(continued[half]).scale(1.0 / 64.0);
                }
            }
        }
        patch(r, c, 4 * num_faces + first, out);
    });
}
