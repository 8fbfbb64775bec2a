//! Schemes: what makes a subdivision of forms smooth, as two small tables over the Whitney scheme.
//!
//! For **any** local `H0: C1(K) -> C0(K')` and `H1: C2(K) -> C1(K')`, with `W0, W1, W2` the lowest-order
//! (Whitney) scheme of the split,
//!
//! ```text
//! S0 = W0 + H0 d0        S1 = W1 + d0' H0 + H1 d1        S2 = W2 + d1' H1            (A)
//! ```
//!
//! commutes with the exterior derivative identically, `d0' S0 = S1 d0` and `d1' S1 = S2 d1`, because
//! `d d = 0`; and the columns of `S2` sum to 1 because those of `W2` do. Conversely `S0` determines `H0`
//! (the displacement of each child vertex from its Whitney position, lifted to edges) and `H1` is the
//! freedom that shapes `S2`. So a scheme *is* the two tables of its [`Homotopy`]: nothing is solved, and
//! irregular vertices may lie side by side. Ke Wang's thesis states the commutative relations as (3.56).
//!
//! - [`whitney`]: `W0, W1, W2` and the lifts of a face.
//! - [`catmark`]: Catmull-Clark with Doo-Sabin.
//! - [`correction`]: the part of `H1` at a vertex, by sectors, for any wanted face weights.
//! - [`doo_sabin`]: the wanted face weights of Catmull-Clark.

pub mod catmark;
pub mod correction;
pub mod doo_sabin;
pub mod whitney;

pub use doo_sabin::DooSabin;

use crate::osd::Masks;
use crate::sparse::Csr;
use crate::topology::Mesh;

/// A subdivision scheme for 0-, 1- and 2-forms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Catmull-Clark on vertices (OpenSubdiv's `SCHEME_CATMARK`, every option), Doo-Sabin on faces.
    Catmark(DooSabin),
}

impl Default for Scheme {
    fn default() -> Self {
        Scheme::Catmark(DooSabin::default())
    }
}

/// The two tables of a scheme from one level to the next, over the Whitney scheme of the split.
#[derive(Clone, Debug)]
pub struct Homotopy {
    /// `(|V'|, |E|)`: the displacement of each child vertex from its Whitney position, as a combination of
    /// oriented edges.
    pub h0: Csr,
    /// `(|E'|, |F|)`: what each child edge (in its own direction) takes of the faces beside it.
    pub h1: Csr,
}

impl Scheme {
    /// The tables of this scheme for one split of `mesh`, with OpenSubdiv's weights `masks`.
    pub fn homotopy(self, mesh: &Mesh, masks: &Masks) -> Homotopy {
        match self {
            Scheme::Catmark(weights) => catmark::homotopy(mesh, masks, weights),
        }
    }
}
