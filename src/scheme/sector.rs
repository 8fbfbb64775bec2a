//! Where a spoke stands among the faces of its vertex, once sharp spokes have cut the fan.

use crate::osd::{Rule, Rules};
use crate::topology::{Fan, HalfEdge, Mesh, wrap};

/// The place of a spoke in its fan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Nothing cuts the fan: the spoke leads face `position` of a smooth vertex.
    Smooth { position: usize },
    /// The spoke lies between two neighbouring cuts.
    Sector {
        /// The position of the sector's first face in the fan.
        start: usize,
        /// The number of its faces; positions run on modulo the fan.
        faces: usize,
        /// The spoke, counted from the first cut (0 is the cut itself).
        spoke: usize,
    },
}

impl Place {
    /// Visits the faces of a fan of `k` with the entries of the spoke's row. Round a smooth vertex rows are those of
    /// a circulant, `circular(k)` its first one. Those of a sector of `n` faces are `sector(n)`, row after row, or, if
    /// that is `None`, the even reflection `x_{(r-q) mod 2n} + x_{(-1-r-q) mod 2n}` of `x = circular(2n)`; the spoke
    /// that cuts has none. Faces are positions in the fan.
    pub fn for_each_entry<'a>(
        self,
        k: usize,
        circular: impl Fn(usize) -> &'a [f64],
        sector: impl Fn(usize) -> Option<&'a [f64]>,
        mut visit: impl FnMut(usize, f64),
    ) {
        match self {
            Place::Smooth { position } => {
                let x = circular(k);
                (0..k).for_each(|l| visit(l, x[wrap(l + k - position, k)]));
            }
            Place::Sector { spoke: 0, .. } => {} // a sharp spoke
            Place::Sector { start, faces: n, spoke: q } => match sector(n) {
                Some(rows) => (0..n).for_each(|r| visit(wrap(start + r, k), rows[q * n + r])),
                None => {
                    let x = circular(2 * n);
                    let folded = |r| x[wrap(r + 2 * n - q, 2 * n)] + x[wrap(4 * n - 1 - r - q, 2 * n)];
                    (0..n).for_each(|r| visit(wrap(start + r, k), folded(r)));
                }
            },
        }
    }
}

/// Visits the rules that OpenSubdiv blends at the tail `v` of `h`, with their weights, and the place of
/// the spoke `h` under each; nothing where `h` has no face on its left.
///
/// At smooth vertices and darts nothing is cut. Else the sharp spokes cut, by their sharpness on this
/// level for the rule of the parent, on the next for the rule of the child. A fan without a sharp spoke is
/// treated as smooth whatever the rule of its vertex.
pub fn for_each_rule<'m>(
    mesh: &'m Mesh,
    rules: &Rules,
    h: HalfEdge,
    mut visit: impl FnMut(f64, Rule, Fan<'m>, Place),
) {
    let Some(corner) = mesh.left_corner(h) else { return };
    let (fan, position) = mesh.fan_of_corner(corner);
    let v = mesh.tail(h) as usize;
    let spoke = |i: usize| mesh.corner_half_edge(fan.corners[i]);
    let parent_weight = rules.parent_weight[v];
    if parent_weight != 0.0 {
        let rule = rules.parent_rule[v];
        let cut = |i| !rule.is_smooth() && rules.parent_sharp[spoke(i).edge() as usize];
        visit(parent_weight, rule, fan, place(fan, position, cut));
    }
    if parent_weight != 1.0 {
        let rule = rules.child_rule[v];
        let cut = |i| !rule.is_smooth() && rules.child_sharp[spoke(i).index()];
        visit(1.0 - parent_weight, rule, fan, place(fan, position, cut));
    }
}

/// The place of the spoke that leads face `position`, `cut(i)` saying whether the spoke of face `i` is cut.
/// The ends of an open fan are cuts. A single cut in a cyclic fan bounds its sector on both sides.
pub fn place(fan: Fan<'_>, position: usize, cut: impl Fn(usize) -> bool) -> Place {
    let k = fan.corners.len();
    let is_cut = |i: usize| {
        let i = wrap(i, k);
        (!fan.cyclic && i == 0) || cut(i)
    };
    match (0..k).find(|&back| is_cut(position + k - back)) {
        None => Place::Smooth { position },
        Some(back) => {
            let on = (1..=k - back).find(|&on| is_cut(position + on)).unwrap_or(k - back);
            Place::Sector { start: wrap(position + k - back, k), faces: back + on, spoke: back }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(k: usize, cyclic: bool, cuts: &[usize], position: usize) -> Place {
        let corners: Vec<u32> = (0..k as u32).collect();
        place(Fan { corners: &corners, cyclic }, position, |i| cuts.contains(&i))
    }

    #[test]
    fn sectors_lie_between_cuts() {
        let sector = |start, faces, spoke| Place::Sector { start, faces, spoke };
        assert_eq!(at(5, true, &[], 3), Place::Smooth { position: 3 });
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
}
