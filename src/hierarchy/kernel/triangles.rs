//! 1-forms on triangles: (A) as it stands, in four passes over arrays.

use rayon::prelude::*;

use super::{BLOCK, Workspace, patch};
use crate::cochain::{Quantity, along};
use crate::hierarchy::refinement::{NONE, Refinement};
use crate::memory;
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
    let value = |corner: u32| along(c, corners[corner as usize]);
    let across = |corner: u32| lefts[corners[corner as usize].twin().index()];

    // D.
    let curl = &mut workspace.faces;
    memory::reuse(curl, num_faces, T::zero());
    curl.par_iter_mut().with_min_len(BLOCK).zip(corners.par_chunks_exact(3)).for_each(|(curl, h)| {
        *curl = along(c, h[0]) + along(c, h[1]) + along(c, h[2]);
    });

    // h at the children of vertices, and at midpoints.
    let at_vertices = &mut workspace.vertices;
    memory::reuse(at_vertices, parent.num_vertices(), T::zero());
    at_vertices.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(v, out)| {
        let spokes = parent.vertex_half_edges(v as u32).iter();
        *out = spokes.fold(T::zero(), |sum, &h| sum + along(c, h)).scale(1.0 / 16.0);
    });
    let at_midpoints = &mut workspace.edges;
    memory::reuse(at_midpoints, num_edges, T::zero());
    at_midpoints.par_iter_mut().with_min_len(BLOCK).zip(lefts.par_chunks_exact(2)).for_each(
        |(out, sides)| {
            if sides[0] != NONE.0 && sides[1] != NONE.0 {
                let to_opposite = |corner| value(next(corner)) - value(previous(corner));
                *out = (to_opposite(sides[0]) + to_opposite(sides[1])).scale(1.0 / 16.0);
            }
        },
    );

    let (odd, even) = out.split_at_mut(3 * num_faces);
    odd.par_chunks_mut(3 * BLOCK).enumerate().for_each(|(i, out)| {
        let faces = out.chunks_exact_mut(3).zip(corners[3 * BLOCK * i..].chunks_exact(3));
        for ((out, h), &own) in faces.zip(&curl[BLOCK * i..]) {
            let across = |h: HalfEdge| lefts[h.twin().index()];
            let beside = [across(h[0]), across(h[1]), across(h[2])];
            for j in 0..3 {
                let (next, previous) = ((j + 1) % 3, (j + 2) % 3);
                if beside[j] == NONE.0 || beside[previous] == NONE.0 {
                    continue;
                }
                let whitney = along(c, h[next]) - along(c, h[previous]) - along(c, h[j]);
                let way = at_midpoints[h[previous].edge() as usize] - at_midpoints[h[j].edge() as usize];
                let others = curl[beside[j] as usize / 3] + curl[beside[previous] as usize / 3];
                out[j] = whitney.scale(0.25) + way + (own.scale(2.0) - others).scale(1.0 / 32.0);
            }
        }
        patch(r, c, 3 * BLOCK * i, out);
    });

    even.par_chunks_mut(2 * BLOCK).enumerate().for_each(|(i, out)| {
        for (j, out) in out.chunks_exact_mut(2).enumerate() {
            let e = BLOCK * i + j;
            let (left, right) = (lefts[2 * e], lefts[2 * e + 1]);
            if left == NONE.0 || right == NONE.0 {
                continue;
            }
            let d = |corner: u32| curl[corner as usize / 3];
            let turn = (d(left) - d(right)).scale(3.0);
            let half = c[e].scale(0.5) - turn.scale(1.0 / 32.0);
            // Both halves are directed away from the midpoint; two more faces at either end.
            let ends = [(true, previous(left), next(right)), (false, previous(right), next(left))];
            for ((out, (negative, before, behind)), v) in out.iter_mut().zip(ends).zip(parent.edges()[e]) {
                let (before, behind) = (across(before), across(behind));
                if before != NONE.0 && behind != NONE.0 {
                    let turn = (d(before) - d(behind)).scale(1.0 / 32.0);
                    *out = at_vertices[v as usize] - at_midpoints[e] + half.negate_if(negative) + turn;
                }
            }
        }
        patch(r, c, 3 * num_faces + 2 * BLOCK * i, out);
    });
}

/// The next corner of the same triangle.
#[inline]
pub fn next(corner: u32) -> u32 {
    if corner % 3 == 2 { corner - 2 } else { corner + 1 }
}

/// The previous corner of the same triangle.
#[inline]
pub fn previous(corner: u32) -> u32 {
    if corner.is_multiple_of(3) { corner + 2 } else { corner - 1 }
}
