//! What the tests share: the tolerance of exact laws, meshes, and the folder of OpenSubdiv's shapes.
#![allow(dead_code)] // each test binary uses its own part

pub mod clients;
pub mod meshes;
pub mod run;
pub mod shapes;
pub mod solids;
pub mod step;

use formwork::laws::{Report, measure};
use formwork::scheme::{BoundaryRule, Scheme, Variant};
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
    report
}
