//! (A) applied to a cochain, nothing stored but the exceptions.
//!
//! A displacement for each child vertex and a value for each face, then the child edges:
//!
//! ```text
//! h = H0 c      D = d1 c      S1 c = W1 c + d0' h + H1 D
//! ```
//!
//! Where the mesh is regular the sums are arranged so that each number is fetched as few times as possible:
//! [`quad_blocks`] from the second level on, [`triangle_blocks`] from the third, [`quads`] and [`triangles`] before. The
//! rest, vertices of other valences and features, are exceptions, whose rows are stored. Each child is computed by one
//! thread, in a fixed order of additions, so that results are
//! bitwise the same for any number of threads.

mod family;
mod quad_blocks;
mod quads;
mod triangle_blocks;
mod triangles;
mod vectors;

use rayon::prelude::*;

use super::refinement::Refinement;
use crate::cochain::{Quantity, along};
use crate::scheme::{Regular, whitney};
use crate::sparse::dot;
use crate::topology::Mesh;

/// How many parents are done at once by one thread.
const BLOCK: usize = 2048;

/// What a kernel keeps between its passes. Handing the same one to each call saves the time that the system
/// takes to find fresh memory, which is as long as the kernels' own.
#[derive(Clone, Debug, Default)]
pub struct Workspace<T = f64> {
    vertices: Vec<T>,
    edges: Vec<T>,
    faces: Vec<T>,
}

impl<T: Quantity> Workspace<T> {
    /// An empty one, which grows as needed.
    pub fn new() -> Self {
        Workspace { vertices: Vec::new(), edges: Vec::new(), faces: Vec::new() }
    }
}

/// `S0 x`.
pub(super) fn form0<T: Quantity>(r: &Refinement, parent: &Mesh, x: &[T], out: &mut [T]) {
    out.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(vertex, out)| {
        let (child, mut sum) = (r.split.vertex_parent(vertex), T::zero());
        match r.homotopy.h0.get(vertex) {
            None => r.homotopy.regular.s0(parent, child, |v, weight| sum = sum + x[v as usize].scale(weight)),
            Some((edges, weights)) => {
                for (&e, &weight) in edges.iter().zip(weights) {
                    let [a, b] = parent.edges()[e as usize];
                    sum = sum + (x[b as usize] - x[a as usize]).scale(weight);
                }
                whitney::w0(parent, child, |v, weight| sum = sum + x[v as usize].scale(weight));
            }
        }
        *out = sum;
    });
}

/// `S1 c`.
pub(super) fn form1<T: Quantity>(
    r: &Refinement,
    parent: &Mesh,
    c: &[T],
    out: &mut [T],
    workspace: &mut Workspace<T>,
) {
    match (r.homotopy.regular, &r.blocks) {
        (Regular::Catmark, Some(above)) => quad_blocks::form1(r, above, c, out, workspace),
        // A mesh with other faces is exceptional throughout.
        (Regular::Catmark, None) if parent.uniform_face_size() == Some(4) => {
            quads::form1(r, parent, c, out, workspace)
        }
        (Regular::Loop, None) => triangles::form1(r, parent, c, out, workspace),
        (Regular::Loop, Some(top)) => triangle_blocks::form1(r, top, c, out, workspace),
        (Regular::Catmark, None) => {
            let chunks = out.par_chunks_mut(BLOCK).enumerate();
            chunks.for_each(|(i, out)| patch(r, c, BLOCK * i, out));
        }
        (Regular::Whitney, _) => {
            out.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(edge, out)| {
                let mut sum = T::zero();
                whitney::w1(parent, r.split.kind(), r.split.edge_parent(edge), |h, weight| {
                    sum = sum + along(c, h).scale(weight);
                });
                *out = sum;
            })
        }
    }
}

/// Writes the exceptions among the child edges that begin with number `first`.
#[inline]
fn patch<T: Quantity>(r: &Refinement, c: &[T], first: usize, out: &mut [T]) {
    for position in r.s1_exceptions.among(first..first + out.len()) {
        let edge = r.s1_exceptions.members()[position] as usize;
        out[edge - first] = dot(r.s1_exceptions.stored(position), c).unwrap_or(T::zero());
    }
}

/// `S2 D`.
pub(super) fn form2<T: Quantity>(r: &Refinement, parent: &Mesh, density: &[T], out: &mut [T]) {
    out.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(face, out)| {
        let mut sum = T::zero();
        let mut add = |f: u32, weight: f64| sum = sum + density[f as usize].scale(weight);
        if r.is_regular_face(parent, face) {
            r.homotopy.regular.s2(parent, &r.split, face, add);
        } else {
            let of = r.split.face_parent(parent, face);
            add(of, whitney::w2(parent, r.split.kind(), of));
            r.split.face_boundary(parent, face, |edge, sign| {
                r.homotopy.for_each_h1(parent, &r.split, edge, |f, weight| add(f, sign * weight));
            });
        }
        *out = sum;
    });
}
