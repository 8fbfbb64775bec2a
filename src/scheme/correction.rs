//! The even rows of `H1`: how a scheme's face weights round a vertex are reached, sector by sector.
//!
//! Along the half of edge `e = v -> w` at `v`, with `f` the face left of it and `g` the face right of it,
//!
//! ```text
//! H1(v -> m_e) = B_v(e) - tau_{e,f} u_f D_f / 2 + tau_{e,g} u_g D_g / 2
//! ```
//!
//! where `D_f` is the value of the 2-cochain on `f`, `tau` the weight of the face in the mask of `m_e`
//! and `u_f` the unit of the scheme (`1/n_f` for Catmull-Clark: densities of corner children). Without
//! `B_v` the children already keep the flux; `B_v` turns the weights `alpha'_j` that they then have round
//! a smooth vertex into the wanted `alpha_j`. With `delta = alpha - alpha'`,
//!
//! ```text
//! b_0 = delta_0 / 2,   b_j = b_{j-1} + delta_j   (so b_{-1-j} = -b_j),   B_v(e_i) = sum_l b_{(l-i) mod k} u_l D_l
//! ```
//!
//! At crease, corner and boundary vertices the sharp spokes cut the fan into **sectors**. A sector of
//! `n` faces is reflected evenly into a fan of valence `2n`: with `q` the position of the spoke and `r` of
//! the face in the sector, `B(q, r) = b_{(r-q) mod 2n} + b_{(-1-r-q) mod 2n}`, `b` that of valence `2n`. It
//! vanishes on the sharp spokes: nothing crosses them. A fan without a sharp spoke is treated as smooth
//! whatever the rule of its vertex. Where OpenSubdiv blends the rules of parent and child, so do we.

use std::sync::OnceLock;

use crate::osd::Masks;
use crate::sparse::Row;
use crate::topology::{Fan, HalfEdge, Mesh};

/// The even rows of `H1` for one level.
pub struct Correction<'a, D, U> {
    mesh: &'a Mesh,
    masks: &'a Masks,
    delta: D,
    unit: U,
    /// For each valence the `b` that it needs, once it is needed.
    b: Vec<OnceLock<Vec<f64>>>,
}

impl<'a, D, U> Correction<'a, D, U>
where
    D: Fn(usize) -> Vec<f64>,
    U: Fn(u32) -> f64,
{
    /// `delta(k)` are the `delta_0 .. delta_{k-1}` of a smooth vertex of valence `k`, summing to 0;
    /// `unit(f)` is `u_f`.
    pub fn new(mesh: &'a Mesh, masks: &'a Masks, delta: D, unit: U) -> Self {
        let fans = (0..mesh.num_vertices() as u32).flat_map(|v| mesh.fans(v));
        let most = fans.map(|fan| fan.corners.len()).max().unwrap_or(0);
        let b = (0..=2 * most).map(|_| OnceLock::new()).collect();
        Correction { mesh, masks, delta, unit, b }
    }

    /// Adds `scale` times `H1(v -> m_e)`, `h` being `e` seen from its tail `v`.
    pub fn add_row(&self, h: HalfEdge, scale: f64, out: &mut Row) {
        let (mesh, masks) = (self.mesh, self.masks);
        for (side, sign) in [(h, -0.5), (h.twin(), 0.5)] {
            if let Some(corner) = mesh.left_corner(side) {
                let tau = masks.edge_face[corner as usize];
                if tau != 0.0 {
                    let face = mesh.corner_face(corner);
                    out.add(face, scale * sign * tau * (self.unit)(face));
                }
            }
        }
        let v = mesh.tail(h) as usize;
        let parent_weight = masks.parent_weight[v];
        if parent_weight != 0.0 {
            let smooth = masks.parent_rule[v].is_smooth();
            let cut = |spoke: HalfEdge| !smooth && masks.parent_sharp[spoke.edge() as usize];
            self.add_b(h, cut, scale * parent_weight, out);
        }
        if parent_weight != 1.0 {
            let smooth = masks.child_rule[v].is_smooth();
            let cut = |spoke: HalfEdge| !smooth && masks.child_sharp[spoke.index()];
            self.add_b(h, cut, scale * (1.0 - parent_weight), out);
        }
    }

    /// Adds `scale` times `B_v(e)`, the fan being cut where `cut` says.
    fn add_b(&self, h: HalfEdge, cut: impl Fn(HalfEdge) -> bool, scale: f64, out: &mut Row) {
        let mesh = self.mesh;
        let Some(corner) = mesh.left_corner(h) else { return };
        let (fan, place) = mesh.fan_of_corner(corner);
        let k = fan.corners.len();
        let mut add = |position: usize, b: f64| {
            let face = mesh.corner_face(fan.corners[position % k]);
            out.add(face, scale * b * (self.unit)(face));
        };
        match sector(fan, place, |i| cut(mesh.corner_half_edge(fan.corners[i]))) {
            None => {
                let b = self.b(k);
                (0..k).for_each(|l| add(l, b[(l + k - place) % k]));
            }
            Some(Sector { start, faces: n, spoke: q }) if q > 0 => {
                let b = self.b(2 * n);
                (0..n).for_each(|r| add(start + r, b[(r + 2 * n - q) % (2 * n)] + b[(4 * n - 1 - r - q) % (2 * n)]));
            }
            Some(_) => {} // the spoke is sharp
        }
    }

    fn b(&self, k: usize) -> &[f64] {
        self.b[k].get_or_init(|| accumulate(&(self.delta)(k)))
    }
}

/// `b_0 = delta_0 / 2`, `b_j = b_{j-1} + delta_j`.
fn accumulate(delta: &[f64]) -> Vec<f64> {
    let mut b = Vec::with_capacity(delta.len());
    b.push(delta[0] / 2.0);
    for j in 1..delta.len() {
        b.push(b[j - 1] + delta[j]);
    }
    b
}

/// The faces between two neighbouring cuts of a fan.
#[derive(Debug, PartialEq, Eq)]
struct Sector {
    /// The position of its first face in the fan.
    start: usize,
    /// The number of its faces; positions run on modulo the fan.
    faces: usize,
    /// The spoke that was asked for, counted from the first cut (0 is the cut itself).
    spoke: usize,
}

/// The sector that spoke `place` lies in, `cut(i)` saying whether spoke `i` is cut; `None` if nothing cuts
/// the fan. The ends of an open fan are cuts. A single cut in a cyclic fan bounds its sector on both sides.
fn sector(fan: Fan<'_>, place: usize, cut: impl Fn(usize) -> bool) -> Option<Sector> {
    let k = fan.corners.len();
    let is_cut = |i: usize| (!fan.cyclic && i.is_multiple_of(k)) || cut(i % k);
    let back = (0..k).find(|&back| is_cut(place + k - back))?;
    let on = (1..=k - back).find(|&on| is_cut(place + on)).unwrap_or(k - back);
    Some(Sector { start: (place + k - back) % k, faces: back + on, spoke: back })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(k: usize, cyclic: bool, cuts: &[usize], place: usize) -> Option<Sector> {
        let corners: Vec<u32> = (0..k as u32).collect();
        sector(Fan { corners: &corners, cyclic }, place, |i| cuts.contains(&i))
    }

    #[test]
    fn sectors_lie_between_cuts() {
        let sector = |start, faces, spoke| Some(Sector { start, faces, spoke });
        assert_eq!(at(5, true, &[], 3), None);
        assert_eq!(at(5, true, &[1], 0), sector(1, 5, 4), "one cut bounds both sides");
        assert_eq!(at(5, true, &[1], 1), sector(1, 5, 0));
        assert_eq!(at(6, true, &[1, 4], 2), sector(1, 3, 1));
        assert_eq!(at(6, true, &[1, 4], 0), sector(4, 3, 2), "sectors run on past the last face");
        assert_eq!(at(4, false, &[], 0), sector(0, 4, 0));
        assert_eq!(at(4, false, &[], 3), sector(0, 4, 3));
        assert_eq!(at(4, false, &[2], 3), sector(2, 2, 1));
        assert_eq!(at(4, false, &[2], 1), sector(0, 2, 1));
        assert_eq!(at(1, true, &[0], 0), sector(0, 1, 0));
    }

    #[test]
    fn b_is_antisymmetric() {
        for k in 1..20 {
            let alpha = crate::scheme::DooSabin::Original.weights(k);
            let plain = crate::scheme::doo_sabin::circulant(k, 0.75, 0.125, |_| 0.0);
            let b = accumulate(&alpha.iter().zip(plain).map(|(a, p)| a - p).collect::<Vec<_>>());
            for j in 0..k {
                assert!((b[j] + b[k - 1 - j]).abs() < 1e-14, "valence {k}");
            }
        }
    }
}
