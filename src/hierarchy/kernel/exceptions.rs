use rayon::prelude::*;

use super::BLOCK;
use crate::cochain::{Quantity, along, d1};
use crate::hierarchy::refinement::Refinement;
use crate::scheme::whitney;
use crate::sparse::dot;
use crate::topology::{Mesh, Parent};

/// The child edges whose rows of `S1` follow no formula, for one cochain.
pub struct Exceptional<'a, T> {
    r: &'a Refinement,
    parent: &'a Mesh,
    c: &'a [T],
    /// `H0 c` of the child vertices that are exceptions.
    displacement: Vec<T>,
    /// `d1 c`, where there are so many exceptions that most faces are asked for it.
    curl: Option<Vec<T>>,
}

impl<'a, T: Quantity> Exceptional<'a, T> {
    pub fn new(r: &'a Refinement, parent: &'a Mesh, c: &'a [T]) -> Self {
        let (h0, h1) = (&r.homotopy.h0, &r.homotopy.h1);
        let displace = |i| dot(h0.stored(i), c).unwrap_or(T::zero());
        let displacement = (0..h0.members().len()).into_par_iter().with_min_len(BLOCK).map(displace).collect();
        let curl = (h1.members().len() > parent.num_faces()).then(|| d1(parent, c));
        Exceptional { r, parent, c, displacement, curl }
    }

    /// Writes those among the child edges that begin with number `first`.
    #[inline]
    pub fn patch(&self, first: usize, out: &mut [T]) {
        let h1 = &self.r.homotopy.h1;
        for position in h1.among(first..first + out.len()) {
            let edge = h1.members()[position] as usize;
            out[edge - first] = self.value(edge, h1.stored(position));
        }
    }

    /// Writes all child edges from number `first` on, which must be exceptions.
    pub fn fill(&self, first: usize, out: &mut [T]) {
        let patch = |(i, out): (usize, &mut [T])| self.patch(first + i * BLOCK, out);
        out.par_chunks_mut(BLOCK).enumerate().for_each(patch);
    }

    fn value(&self, edge: usize, (faces, weights): (&[u32], &[f64])) -> T {
        let (split, parent) = (&self.r.split, self.parent);
        let place = split.edge_parent(edge);
        let [tail, head] = split.edge_ends(parent, place);
        let mut sum = self.displacement(head) - self.displacement(tail);
        whitney::w1(parent, split.kind(), place, |h, weight| sum = sum + along(self.c, h).scale(weight));
        for (&face, &weight) in faces.iter().zip(weights) {
            sum = sum + self.curl(face).scale(weight);
        }
        sum
    }

    fn displacement(&self, child: Parent) -> T {
        match self.r.homotopy.h0.position(self.r.split.vertex_of(child) as usize) {
            Some(position) => self.displacement[position],
            None => {
                let mut sum = T::zero();
                let add = |h, weight| sum = sum + along(self.c, h).scale(weight);
                self.r.homotopy.regular.h0(self.parent, child, add);
                sum
            }
        }
    }

    fn curl(&self, face: u32) -> T {
        match &self.curl {
            Some(curl) => curl[face as usize],
            None => {
                let round = self.parent.face_half_edges(face).iter();
                round.fold(T::zero(), |sum, &h| sum + along(self.c, h))
            }
        }
    }
}
