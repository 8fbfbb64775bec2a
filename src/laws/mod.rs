//! The laws of a hierarchy, measured against OpenSubdiv itself.
//!
//! Exact laws hold to rounding: `d0' S0 = S1 d0` with **OpenSubdiv's own** `S0` (its stencil table),
//! `d1' S1 = S2 d1`, columns of `S2` summing to 1, and our `S0` equal to OpenSubdiv's; in the limit
//! `L1 d0 = d0 L0`, `L2 d1 = d1 L1`, `R L' S = L`, and `L0` equal to OpenSubdiv's limit masks where those are
//! exact. The limit is approached by a rate: for a random 0-cochain `x` the level-`l` cochain `S1 .. S1 d0 x`,
//! summed along the descendants of each control edge, telescopes to the difference of OpenSubdiv's level-`l`
//! values at its ends, and tends to the limit circulation `L1 d0 x`.

mod limit;

pub use limit::LimitLaws;

use serde::Serialize;

use crate::cochain::Cochain;
use crate::hierarchy::{Hierarchy, HierarchyError, refiner};
use crate::limit::Limit;
use crate::osd::Refiner;
use crate::scheme::Scheme;
use crate::sparse::{max_difference, multiply};
use crate::topology::{Cage, HalfEdge};

/// What exact laws are held to: weights are of order 1 and rows have some dozens of entries.
pub const TOLERANCE: f64 = 1e-12;

/// The exact laws of one step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LevelLaws {
    /// The step leads from `level - 1` to `level`.
    pub level: usize,
    /// The largest entry of `d0' S0 - S1 d0`, `S0` being OpenSubdiv's, if the scheme is.
    pub d0_s0_minus_s1_d0: f64,
    /// The largest entry of `d1' S1 - S2 d1`.
    pub d1_s1_minus_s2_d1: f64,
    /// The largest deviation of a column sum of `S2` from 1.
    pub s2_column_sum_minus_1: f64,
    /// The largest difference between a weight of our `S0` and OpenSubdiv's; none if OpenSubdiv has no such
    /// scheme.
    pub s0_minus_opensubdiv: Option<f64>,
}

impl LevelLaws {
    /// The worst of the four.
    pub fn worst(&self) -> f64 {
        let all = [self.d0_s0_minus_s1_d0, self.d1_s1_minus_s2_d1, self.s2_column_sum_minus_1];
        all.into_iter().chain(self.s0_minus_opensubdiv).fold(0.0, worse)
    }
}

/// Telescoped circulations of a random exact 1-cochain, on one level.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimitRow {
    /// The level.
    pub level: usize,
    /// The largest difference, over the control edges, to the difference of OpenSubdiv's own values (of
    /// ours, if OpenSubdiv has no such scheme).
    pub telescoped_minus_refined: f64,
    /// The largest difference to the limit circulation, `L1 d0 x` on the cage.
    pub telescoped_minus_limit: f64,
    /// The base-2 logarithm of the last column's ratio to the level before; 2 on a regular mesh, where semi-sharp
    /// features have decayed. None on the first level and once the difference is rounding.
    pub rate: Option<f64>,
}

/// What [`measure`] found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The exact laws of each step.
    pub levels: Vec<LevelLaws>,
    /// The laws of the limit, from level 0 on.
    pub limit_laws: Vec<LimitLaws>,
    /// The approach to the limit, from level 0 on.
    pub limit: Vec<LimitRow>,
    /// What the exact laws are held to.
    pub tolerance: f64,
}

impl Report {
    /// The worst number of an exact law, telescoping included.
    pub fn worst(&self) -> f64 {
        let levels = self.levels.iter().map(LevelLaws::worst);
        let limit_laws = self.limit_laws.iter().map(LimitLaws::worst);
        let limit = self.limit.iter().map(|row| row.telescoped_minus_refined);
        levels.chain(limit_laws).chain(limit).fold(0.0, worse)
    }

    /// Whether all exact laws hold to [`TOLERANCE`].
    pub fn holds(&self) -> bool {
        self.worst() <= self.tolerance
    }
}

/// The larger of the two; a NaN is the worst of all, which `f64::max` would drop.
fn worse(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// Refines `cage` and measures every law on levels 1 to `levels`, calling `progress(level)` as each is
/// done.
///
/// # Errors
/// If the hierarchy cannot be built.
pub fn measure(
    cage: &Cage,
    scheme: Scheme,
    levels: usize,
    mut progress: impl FnMut(usize),
) -> Result<Report, HierarchyError> {
    let hierarchy = Hierarchy::new(cage, scheme, levels)?;
    let (refiner, split) = refiner(cage, scheme, levels, true)?;
    let refiner = scheme.is_opensubdivs(split).then_some(&refiner);
    let mut rows = Vec::with_capacity(levels);
    for level in 1..=levels {
        rows.push(exact_laws(&hierarchy, refiner, level)?);
        progress(level);
    }
    let limits: Vec<Limit> =
        (0..=levels).map(|level| Limit::new(&hierarchy, level)).collect::<Result<_, _>>()?;
    Ok(Report {
        levels: rows,
        limit_laws: limit::laws(&hierarchy, refiner, &limits)?,
        limit: limit_rows(&hierarchy, refiner, &limits[0])?,
        tolerance: TOLERANCE,
    })
}

fn exact_laws(
    hierarchy: &Hierarchy,
    opensubdiv: Option<&Refiner>,
    level: usize,
) -> Result<LevelLaws, HierarchyError> {
    let (parent, child) = (hierarchy.level(level - 1).mesh(), hierarchy.level(level).mesh());
    let ours = hierarchy.operators(level);
    let theirs = opensubdiv.map(|refiner| refiner.stencils(level)).transpose()?;
    let s0 = theirs.as_ref().unwrap_or(&ours.s0);
    let mut column_sums = vec![0.0; parent.num_faces()];
    for (&column, &weight) in ours.s2.indices().iter().zip(ours.s2.data()) {
        column_sums[column as usize] += weight;
    }
    Ok(LevelLaws {
        level,
        d0_s0_minus_s1_d0: max_difference(&multiply(&child.d0(), s0), &multiply(&ours.s1, &parent.d0())),
        d1_s1_minus_s2_d1: max_difference(
            &multiply(&child.d1(), &ours.s1),
            &multiply(&ours.s2, &parent.d1()),
        ),
        s2_column_sum_minus_1: column_sums.iter().map(|sum| (sum - 1.0).abs()).fold(0.0, worse),
        s0_minus_opensubdiv: theirs.as_ref().map(|theirs| max_difference(&ours.s0, theirs)),
    })
}

fn limit_rows(
    hierarchy: &Hierarchy,
    opensubdiv: Option<&Refiner>,
    limit: &Limit,
) -> Result<Vec<LimitRow>, HierarchyError> {
    let cage = hierarchy.level(0).mesh();
    let mut values = vec![Cochain::<0>::new(random_values(cage.num_vertices()))];
    for level in 1..=hierarchy.num_levels() {
        let coarse = &values[level - 1];
        values.push(match opensubdiv {
            Some(refiner) => Cochain::new(refiner.interpolate(level, coarse.values())?),
            None => hierarchy.refine(level, coarse),
        });
    }
    let mut rows: Vec<LimitRow> = Vec::with_capacity(values.len());
    let mut form = values[0].exterior_derivative(cage);
    let limit = limit.apply(cage, &form);
    for (level, x) in values.iter().map(|x| x.values()).enumerate() {
        if level > 0 {
            form = hierarchy.refine(level, &form);
        }
        // Control vertices keep their numbers on every level.
        let refined = |e: usize| {
            let [a, b] = cage.edges()[e].map(|v| x[v as usize]);
            b - a
        };
        let largest = |target: &dyn Fn(usize) -> f64| {
            let along = |e: usize| telescope(hierarchy, &form, level, HalfEdge::new(e as u32, true));
            (0..cage.num_edges()).map(|e| (along(e) - target(e)).abs()).fold(0.0, worse)
        };
        let telescoped_minus_limit = largest(&|e| limit[e]);
        let before = rows.last().map(|row| row.telescoped_minus_limit);
        let above_rounding = |x: &f64| *x >= TOLERANCE;
        let rate = before
            .filter(above_rounding)
            .zip(Some(telescoped_minus_limit).filter(above_rounding))
            .map(|(before, now)| (before / now).log2());
        rows.push(LimitRow {
            level,
            telescoped_minus_refined: largest(&refined),
            telescoped_minus_limit,
            rate,
        });
    }
    Ok(rows)
}

/// The sum of a level's 1-cochain along the descendants of a control half-edge.
fn telescope(hierarchy: &Hierarchy, form: &Cochain<1>, level: usize, control: HalfEdge) -> f64 {
    let mut chain = vec![control];
    for l in 1..=level {
        let split = hierarchy.refinement(l).split();
        // The halves are directed from the midpoint to the ends.
        let halves = |h: HalfEdge| {
            [HalfEdge::new(split.even_edge(h), false), HalfEdge::new(split.even_edge(h.twin()), true)]
        };
        chain = chain.into_iter().flat_map(halves).collect();
    }
    chain.into_iter().map(|h| form.along(h)).sum()
}

/// Values in `[-1, 1)` that look random and are the same every time (splitmix64).
fn random_values(len: usize) -> Vec<f64> {
    let mut state = 0u64;
    let next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    std::iter::repeat_with(next).take(len).collect()
}
