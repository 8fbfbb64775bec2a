//! Catmull-Clark with Doo-Sabin: every mesh that OpenSubdiv's `SCHEME_CATMARK` takes.
//!
//! With OpenSubdiv's masks
//!
//! ```text
//! m_e = th_a a + th_b b + sum_g tau_{e,g} p_g          v' = w_v v + sum_i a_i w_i + sum_i b_i p_{f_i}
//! ```
//!
//! the tables are (`P`, `Pbar` the lifts of [`super::whitney`])
//!
//! ```text
//! H0(p_f) = 0
//! H0(m_e) = sum_g tau_{e,g} Pbar_{g,e} + (th_b - th_a)/2 c_ab
//! H0(v')  = sum_i a_i c_{v w_i} + sum_i b_i P_{f_i,v}
//! H1(v -> m_e): see super::correction, with u_f = 1/n_f and alpha' = (3/4, 1/8, 0, .., 0, 1/8)
//! H1(m_e -> p_f) = 0
//! ```
//!
//! In the regular interior this gives the tensor-product spline rules: S1 times 64 is 18 on the edge
//! itself, 6 on the one it continues, 3 and 1 on the parallels beside them (even) and 12, 12, 4, 4 (odd);
//! S2 times 16 is 9, 3, 3, 1 over the parent's value per child. Round an extraordinary vertex on quads it
//! is Appendix C of Ke Wang's thesis.

use super::correction::{FaceWeights, circulant};
use super::{DooSabin, Homotopy, tables, whitney};
use crate::osd::Masks;
use crate::topology::{Mesh, SplitKind};

/// The tables `H0` and `H1` for one split; see [`super::Scheme::homotopy`].
pub fn homotopy(mesh: &Mesh, masks: &Masks, known: &[bool], weights: DooSabin) -> Homotopy {
    let lift = |corner, visit: &mut dyn FnMut(_, f64)| whitney::midpoint_to_centre(mesh, corner, visit);
    tables::homotopy(SplitKind::Quad, mesh, masks, known, lift, Densities(weights), |_, _| ())
}

/// Doo-Sabin weights of densities: the value of face `f` counts by `1/n_f`.
pub(super) struct Densities(pub DooSabin);

impl FaceWeights for Densities {
    fn delta(&self, k: usize) -> Vec<f64> {
        let unmended = circulant(k, 0.75, 0.125, |_| 0.0);
        self.0.weights(k).iter().zip(unmended).map(|(alpha, plain)| alpha - plain).collect()
    }

    fn unit(&self, mesh: &Mesh, face: u32) -> f64 {
        whitney::w2(mesh, SplitKind::Quad, face)
    }
}
