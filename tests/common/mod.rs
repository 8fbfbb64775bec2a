//! What the tests share: the tolerance of exact laws, meshes, and the folder of OpenSubdiv's shapes.
#![allow(dead_code)] // each test binary uses its own part

pub mod clients;
pub mod meshes;
pub mod run;
pub mod shapes;
pub mod solids;
pub mod step;

use formwork::hierarchy::Hierarchy;
use formwork::laws::{Report, measure};
use formwork::osd::Refiner;
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::sparse::row_of;
use formwork::topology::Cage;

/// What holds algebraically is tested to this, relative to weights of order 1.
pub const EXACT: f64 = 1e-12;

/// What limits are held to: their tables are solutions of small linear systems.
pub const LIMIT: f64 = 1e-13;

/// Our S0 against OpenSubdiv's own weights.
pub const SAME_WEIGHTS: f64 = 1e-14;

/// Numbers in `[-1, 1)` that look random and are the same every time.
pub fn random(len: usize, seed: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    std::iter::repeat_with(next).take(len).collect()
}

/// The rows of one step as evaluators take them, whole and in short runs, against the matrix: the same to the last digit.
#[track_caller]
pub fn assert_stencils(hierarchy: &Hierarchy, level: usize) {
    for degree in 0..3 {
        let (matrix, stencils) = (hierarchy.operator(degree, level), hierarchy.step_stencils(degree, level));
        assert_eq!((stencils.shape(), stencils.num_terms(0..matrix.rows())), (matrix.shape(), matrix.nnz()));
        for run in [matrix.rows().max(1), 13] {
            for first in (0..matrix.rows()).step_by(run) {
                let rows = first..matrix.rows().min(first + run);
                let terms = stencils.num_terms(rows.clone());
                let (mut lengths, mut columns) = (vec![0; rows.len()], vec![0; terms]);
                let (mut double, mut single) = (vec![0.0; terms], vec![0.0f32; terms]);
                stencils.write(rows.clone(), &mut lengths, &mut columns, &mut single);
                stencils.write(rows.clone(), &mut lengths, &mut columns, &mut double);
                let mut start = 0;
                for (row, &length) in rows.zip(&lengths) {
                    let of = start..start + length as usize;
                    start = of.end;
                    let mut terms: Vec<_> = of.map(|i| (columns[i], double[i], single[i])).collect();
                    terms.sort_by_key(|term| term.0);
                    let (columns, weights) = row_of(&matrix, row);
                    let expected =
                        columns.iter().zip(weights).map(|(&c, &weight)| (c, weight, weight as f32));
                    assert_eq!(
                        terms,
                        expected.collect::<Vec<_>>(),
                        "degree {degree}, level {level}, row {row}"
                    );
                }
            }
        }
    }
}

/// Every scheme that takes triangles only, the default of each family first.
pub fn triangle_schemes() -> Vec<Scheme> {
    let mut schemes = vec![Scheme::Whitney];
    for variant in [Variant::Loop, Variant::ModifiedLoop] {
        for boundary in [BoundaryRule::Reflect, BoundaryRule::Thesis, BoundaryRule::Dct] {
            schemes.push(Scheme::Loop(variant, boundary));
        }
    }
    schemes
}

/// Measures every law and asserts the exact ones.
pub fn assert_laws(name: &str, cage: &Cage, scheme: Scheme, levels: usize) -> Report {
    let report = measure(cage, scheme, levels, |_| ()).unwrap_or_else(|error| panic!("{name}: {error}"));
    for row in &report.levels {
        assert!(row.worst() <= EXACT, "{name}: {row:?}");
        assert!(row.s0_minus_opensubdiv.is_none_or(|x| x <= SAME_WEIGHTS), "{name}: {row:?}");
    }
    for row in &report.limit_laws {
        assert!(row.worst() <= LIMIT, "{name}: {row:?}");
    }
    for row in &report.limit {
        assert!(row.telescoped_minus_refined <= EXACT, "{name}: {row:?}");
    }
    assert_same_tables(name, cage, scheme, levels);
    report
}

/// The tables of a level do not depend on what was known of it from the level above.
fn assert_same_tables(name: &str, cage: &Cage, scheme: Scheme, levels: usize) {
    let hierarchy = Hierarchy::new(cage, scheme, levels).unwrap();
    let mut refiner = Refiner::new(cage, scheme.opensubdiv(hierarchy.split_kind())).unwrap();
    refiner.refine_uniform(levels).unwrap();
    for level in 1..=levels {
        let (mesh, masks) = (hierarchy.level(level - 1).mesh(), refiner.masks(level - 1).unwrap());
        let asked = scheme.homotopy(hierarchy.split_kind(), mesh, &masks, &[]);
        let told = hierarchy.refinement(level).homotopy();
        for (asked, told) in [(&asked.h0, &told.h0), (&asked.h1, &told.h1)] {
            assert_eq!(asked.members(), told.members(), "{name}, level {level}: other exceptions");
            for position in 0..asked.members().len() {
                assert_eq!(asked.stored(position), told.stored(position), "{name}, level {level}");
            }
        }
    }
}
