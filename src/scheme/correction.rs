//! The even rows of `H1`: how a scheme's face weights round a vertex are reached, sector by sector.
//!
//! Along the half of edge `e = v -> w` at `v`, with `f` the face left of it and `g` the face right of it,
//!
//! ```text
//! H1(v -> m_e) = B_v(e) - tau_{e,f} u_f D_f / 2 + tau_{e,g} u_g D_g / 2
//! ```
//!
//! where `D_f` is the value of the 2-cochain on `f`, `tau` the weight of the face in the mask of `m_e`
//! and `u_f` the unit of the scheme: `1/n_f` for Catmull-Clark, whose weights are those of densities, 1 for
//! Loop. Without `B_v` the children already keep the flux; `B_v` turns the weights `alpha'_j` that they
//! then have round a smooth vertex into the wanted `alpha_j`. With `delta = alpha - alpha'`,
//!
//! ```text
//! b_0 = delta_0 / 2,   b_j = b_{j-1} + delta_j   (so b_{-1-j} = -b_j),   B_v(e_i) = sum_l b_{(l-i) mod k} u_l D_l
//! ```
//!
//! At crease, corner and boundary vertices the sharp spokes cut the fan into **sectors**. A sector of
//! `n` faces is reflected evenly into a fan of valence `2n`: with `q` the position of the spoke and `r` of
//! the face in the sector, `B(q, r) = b_{(r-q) mod 2n} + b_{(-1-r-q) mod 2n}`, `b` that of valence `2n`. It
//! vanishes on the sharp spokes: nothing crosses them. A scheme may give its sectors other rows instead.
//! Where OpenSubdiv blends the rules of parent and child, so do we; `super::sector` finds the places.

use std::sync::OnceLock;

use super::Scheme;
use super::catmark::Densities;
use super::half_box::HalfBox;
use super::sector::for_each_rule;
use crate::osd::Rules;
use crate::sparse::Row;
use crate::topology::{HalfEdge, Mesh, SplitKind};

/// What a scheme wants of its faces round a vertex.
pub trait FaceWeights: Send + Sync {
    /// `delta_0 .. delta_{k-1}` of a smooth vertex of valence `k`, summing to 0.
    fn delta(&self, k: usize) -> Vec<f64>;

    /// `u_f`.
    fn unit(&self, mesh: &Mesh, face: u32) -> f64;

    /// The rows `B(q, r)` of a sector of `n` faces, row after row for `q = 0 .. n-1`; `None` to reflect it
    /// evenly.
    fn sector(&self, _n: usize) -> Option<Vec<f64>> {
        None
    }
}

/// The even rows of `H1` round a vertex of a mesh of quads, or triangles, by number of faces: what limits are
/// computed from.
pub struct FaceRows {
    kind: SplitKind,
    /// The weight of a face in the mask of a smooth edge.
    tau: f64,
    /// `u_f`.
    unit: f64,
    weights: Box<dyn FaceWeights>,
}

impl FaceRows {
    /// The rows of a scheme; `None` for the Whitney schemes, which have none.
    pub fn of(scheme: Scheme) -> Option<Self> {
        match scheme {
            Scheme::Catmark(weights) => Some(FaceRows {
                kind: SplitKind::Quad,
                tau: 0.25,
                unit: 0.25,
                weights: Box::new(Densities(weights)),
            }),
            Scheme::Loop(_, boundary) => Some(FaceRows {
                kind: SplitKind::Triangle,
                tau: 0.125,
                unit: 1.0,
                weights: Box::new(HalfBox(boundary)),
            }),
            Scheme::Whitney | Scheme::Bilinear => None,
        }
    }

    /// How faces split.
    pub fn kind(&self) -> SplitKind {
        self.kind
    }

    /// `tau u_f` of a smooth edge.
    pub fn tau(&self) -> f64 {
        self.tau * self.unit
    }

    /// `b_0 .. b_{k-1}` of a smooth vertex, times `u_f`.
    pub fn smooth(&self, k: usize) -> Vec<f64> {
        accumulate(&self.weights.delta(k)).into_iter().map(|b| b * self.unit).collect()
    }

    /// The rows `B(q, r)` of a sector, row after row, times `u_f`; `None` if it is reflected evenly.
    pub fn sector(&self, n: usize) -> Option<Vec<f64>> {
        Some(self.weights.sector(n)?.into_iter().map(|b| b * self.unit).collect())
    }
}

/// The even rows of `H1` for one level.
pub struct Correction<'a, W> {
    mesh: &'a Mesh,
    edge_face: &'a [f64],
    rules: &'a Rules,
    weights: W,
    /// For each valence the `b` that it needs, and for each sector its rows, once they are needed.
    b: Vec<OnceLock<Vec<f64>>>,
    sectors: Vec<OnceLock<Option<Vec<f64>>>>,
}

impl<'a, W: FaceWeights> Correction<'a, W> {
    /// Prepares the rows of one level; `edge_face` is `tau`, for each corner, as in
    /// [`crate::osd::Masks::edge_face`].
    pub fn new(mesh: &'a Mesh, edge_face: &'a [f64], rules: &'a Rules, weights: W) -> Self {
        let fans = (0..mesh.num_vertices() as u32).flat_map(|v| mesh.fans(v));
        let most = fans.map(|fan| fan.corners.len()).max().unwrap_or(0);
        let b = (0..=2 * most).map(|_| OnceLock::new()).collect();
        let sectors = (0..=most).map(|_| OnceLock::new()).collect();
        Correction { mesh, edge_face, rules, weights, b, sectors }
    }

    /// Adds `scale` times `H1(v -> m_e)`, `h` being `e` seen from its tail `v`.
    pub fn add_row(&self, h: HalfEdge, scale: f64, out: &mut Row) {
        let mesh = self.mesh;
        for (side, sign) in [(h, -0.5), (h.twin(), 0.5)] {
            if let Some(corner) = mesh.left_corner(side) {
                let tau = self.edge_face[corner as usize];
                if tau != 0.0 {
                    let face = mesh.corner_face(corner);
                    out.add(face, scale * sign * tau * self.weights.unit(mesh, face));
                }
            }
        }
        for_each_rule(mesh, self.rules, h, |weight, _, fan, place| {
            let add = |position: usize, b: f64| {
                let face = mesh.corner_face(fan.corners[position]);
                out.add(face, scale * weight * b * self.weights.unit(mesh, face));
            };
            place.for_each_entry(fan.corners.len(), |k| self.b(k), |n| self.sector(n), add);
        });
    }

    fn b(&self, k: usize) -> &[f64] {
        self.b[k].get_or_init(|| accumulate(&self.weights.delta(k)))
    }

    fn sector(&self, n: usize) -> Option<&[f64]> {
        self.sectors[n].get_or_init(|| self.weights.sector(n)).as_deref()
    }
}

/// `b_0 = delta_0 / 2`, `b_j = b_{j-1} + delta_j`.
pub(super) fn accumulate(delta: &[f64]) -> Vec<f64> {
    let mut b = Vec::with_capacity(delta.len());
    b.push(delta[0] / 2.0);
    for j in 1..delta.len() {
        b.push(b[j - 1] + delta[j]);
    }
    b
}

/// `here [j = 0] + beside ([j = 1] + [j = -1]) + rest(j)` for `j = 0 .. k-1`, indices modulo `k`.
pub(super) fn circulant(k: usize, here: f64, beside: f64, rest: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut row: Vec<f64> = (0..k).map(rest).collect();
    row[0] += here;
    row[1 % k] += beside;
    row[k - 1] += beside;
    row
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scheme::DooSabin;
    use crate::scheme::half_box::BoundaryRule;

    fn assert_antisymmetric(weights: &impl FaceWeights) {
        for k in 1..20 {
            let b = accumulate(&weights.delta(k));
            for j in 0..k {
                assert!((b[j] + b[k - 1 - j]).abs() < 1e-14, "valence {k}");
            }
        }
    }

    #[test]
    fn b_is_antisymmetric() {
        assert_antisymmetric(&Densities(DooSabin::Thesis));
        assert_antisymmetric(&Densities(DooSabin::Original));
        assert_antisymmetric(&HalfBox(BoundaryRule::Reflect));
    }
}
