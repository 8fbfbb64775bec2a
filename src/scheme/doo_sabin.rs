//! The face weights that Catmull-Clark's 2-forms take round a vertex: Doo-Sabin, in two versions.

use std::f64::consts::TAU;

use super::correction::circulant;

/// The weights `alpha_j` with which the child of face `f_0` at a smooth vertex of valence `k` takes
/// the densities of the faces `f_j` round it. They sum to 1 and agree at the regular valence 4
/// (9, 3, 1, 3 sixteenths).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DooSabin {
    /// `1/2 [j = 0] + 1/8 [j = +-1] + 1/(4k)`: Catmull and Clark 1978, Ke Wang's thesis, Appendix C.
    #[default]
    Thesis,
    /// `1/4 [j = 0] + (3 + 2 cos(2 pi j / k)) / (4k)`: Doo and Sabin 1978.
    Original,
}

impl DooSabin {
    /// `alpha_0 .. alpha_{k-1}`. For `k` = 1 and 2 the indices `+1` and `-1` coincide and their terms add.
    ///
    /// # Panics
    /// If `k` is 0.
    pub fn weights(self, k: usize) -> Vec<f64> {
        let n = k as f64;
        match self {
            DooSabin::Thesis => circulant(k, 0.5, 0.125, |_| 0.25 / n),
            DooSabin::Original if k == 1 => vec![1.0], // the cosines sum to 0 from k = 2 on only
            DooSabin::Original => {
                circulant(k, 0.25, 0.0, |j| (3.0 + 2.0 * (TAU * j as f64 / n).cos()) / (4.0 * n))
            }
        }
    }
}
