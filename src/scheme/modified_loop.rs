//! The vertex rule of the thesis' modified Loop scheme (Theorem 3.40 and chapter 4).
//!
//! At a smooth vertex of valence `n`, and next to it,
//!
//! ```text
//! eps_n = 1/8 - cos(2 pi / n)/4          a = (3 + 8 eps_n)/(8 n) for each neighbour
//! m_e   = (3/8 - (eps_a - eps_b)) a + (3/8 + (eps_a - eps_b)) b + 1/8 of the two opposite vertices
//! ```
//!
//! which puts the subdominant eigenvalue at 1/2 for every `n` (it is 0 for `n = 6`). At a boundary or crease
//! vertex with `k` triangles between its sharp edges `eps = 1/8 - cos(pi / k)/4` (Biermann, Levin and Zorin
//! 2000); at corners `eps = 0`. Sharp edges and the rules of crease and corner vertices are Loop's. Where
//! OpenSubdiv blends rules, the modified ones are blended with the same weights.

use std::f64::consts::{PI, TAU};

use super::sector::{Place, for_each_rule};
use crate::osd::{Masks, Rule, Rules};
use crate::topology::{HalfEdge, Mesh};

/// `masks` with Loop's smooth rules replaced.
pub(super) fn modified_masks(mesh: &Mesh, masks: &Masks) -> Masks {
    let mut modified = masks.clone();
    for v in 0..mesh.num_vertices() as u32 {
        modify_vertex(mesh, masks, v, &mut modified);
    }
    for e in 0..mesh.num_edges() as u32 {
        let h = HalfEdge::new(e, true);
        let Some(corner) = mesh.left_corner(h) else { continue };
        // Loop's own weight of the opposite vertex is 1/8; what is left of it is the smooth part.
        let smooth = 8.0 * masks.edge_face[corner as usize];
        if smooth == 0.0 {
            continue;
        }
        let shift = smooth * (eps(mesh, &masks.rules, h) - eps(mesh, &masks.rules, h.twin()));
        modified.edge_end[h.index()] -= shift;
        modified.edge_end[h.twin().index()] += shift;
    }
    modified
}

/// Exchanges the smooth part of a vertex mask.
fn modify_vertex(mesh: &Mesh, masks: &Masks, v: u32, modified: &mut Masks) {
    let i = v as usize;
    let (parent, child) = (masks.rules.parent_rule[i], masks.rules.child_rule[i]);
    let smooth = match (parent.is_smooth(), child.is_smooth()) {
        (true, _) => 1.0,
        (false, true) => 1.0 - masks.rules.parent_weight[i],
        (false, false) => 0.0,
    };
    if smooth == 0.0 {
        return;
    }
    let spokes = mesh.vertex_half_edges(v);
    let n = spokes.len() as f64;
    let a = (3.0 + 8.0 * smooth_eps(spokes.len())) / (8.0 * n);
    for h in spokes {
        let crease = parent == Rule::Crease && masks.rules.parent_sharp[h.edge() as usize];
        let sharp_part = if crease { (1.0 - smooth) / 8.0 } else { 0.0 };
        modified.vertex_edge[h.index()] = sharp_part + smooth * a;
    }
    let sum: f64 = spokes.iter().map(|h| modified.vertex_edge[h.index()]).sum();
    modified.vertex_self[i] = 1.0 - sum;
}

/// `eps` of the vertex that `h` leaves, in the sector that `h` lies in: the mean of the blended rules over
/// those that do not cut `h` itself, since only its smooth part asks for it.
pub fn eps(mesh: &Mesh, rules: &Rules, h: HalfEdge) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for_each_rule(mesh, rules, h, |weight, rule, fan, place| {
        let eps = match (rule, place) {
            (_, Place::Sector { spoke: 0, .. }) => return,
            (Rule::Corner, _) => 0.0,
            (_, Place::Smooth { .. }) => smooth_eps(fan.corners.len()),
            (_, Place::Sector { faces, .. }) => 0.125 - (PI / faces as f64).cos() / 4.0,
        };
        sum += weight * eps;
        total += weight;
    });
    if total > 0.0 { sum / total } else { 0.0 }
}

/// `eps_n` of a smooth vertex of valence `n`.
pub fn smooth_eps(n: usize) -> f64 {
    0.125 - (TAU / n as f64).cos() / 4.0
}
