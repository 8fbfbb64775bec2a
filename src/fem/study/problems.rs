//! Studies that have names: those of section 5.3 of the thesis, and the L-shape.

use super::{Cells, Imposition, Method, Region, Study};

/// The names.
pub const NAMES: &[&str] = &[
    "I",
    "II",
    "I-F",
    "II-F",
    "I-Fsym",
    "II-Fsym",
    "I-thesis",
    "I-mixed",
    "I-F-mixed",
    "lshape-smooth",
    "lshape-singular",
    "lshape-one",
    "bilaplace",
];

/// (5.27).
const I: [&str; 2] = ["cos(2*pi*x) - sin(4*pi*y)", "cos(2*pi*x) + sin(4*pi*x)"];
/// (5.30), recovered: with this form all errors are those of an independent computation of the thesis' problem, in every
/// digit that has.
const II: [&str; 2] = ["sin(4*pi*x)", "cos(2*pi*y)"];
/// (5.32), recovered in the same way, and without its `+ y`: its determinant is between 0.6875 and 1.3125.
const F: [&str; 2] = ["x + y + sin(pi*y)/(4*pi)", "y + sin(pi*x)/(4*pi)"];
const F_SYMMETRIC: [&str; 2] = ["x + sin(pi*y)/(4*pi)", "y + sin(pi*x)/(4*pi)"];
/// (5.38).
const BI: [&str; 2] = ["sin(pi*x)*sin(pi*y)", "sin(2*pi*x)*sin(pi*y)"];
/// `r^(2/3) sin(2t/3)`, `t` from the positive x axis; the angle jumps in the quadrant that is missing.
const SINGULAR: &str = "(x^2 + y^2)^(1/3) * sin(2/3*(atan2(-x-y, y-x) + 3*pi/4))";

/// A study by name.
pub fn named(name: &str) -> Option<Study> {
    let owned = |texts: [&str; 2]| texts.map(str::to_owned);
    let plain = |solution: [&str; 2]| Study {
        name: name.to_owned(),
        domain: Region::Square,
        method: Method::HodgeLaplace,
        solution: owned(solution),
        load: None,
        boundary_data: None,
        map: None,
        metric: None,
        elements: vec![Cells::Quads, Cells::Triangles],
        boundary: Imposition::Nitsche,
        factor: None,
        rule: None,
        boundary_points: 5,
        cells: vec![4, 8, 16, 32, 64],
    };
    let mapped = |solution, map: [&str; 2]| Study { map: Some(owned(map).to_vec()), ..plain(solution) };
    let lshape = |solution| Study { domain: Region::Lshape, cells: vec![4, 8, 16, 32], ..plain(solution) };
    Some(match name {
        "I" => plain(I),
        "II" => plain(II),
        "I-F" => mapped(I, F),
        "II-F" => mapped(II, F),
        "I-Fsym" => mapped(I, F_SYMMETRIC),
        "II-Fsym" => mapped(II, F_SYMMETRIC),
        "I-thesis" => Study {
            boundary: Imposition::Penalty,
            factor: Some(100.0),
            rule: Some(3),
            boundary_points: 2,
            elements: vec![Cells::Triangles],
            ..plain(I)
        },
        "I-mixed" => Study { method: Method::Mixed, ..plain(I) },
        "I-F-mixed" => Study { method: Method::Mixed, ..mapped(I, F) },
        "lshape-smooth" => lshape(I),
        "lshape-singular" => lshape([SINGULAR, SINGULAR]),
        "lshape-one" => Study {
            load: Some(owned(["1", "1"])),
            boundary_data: Some(owned(["0", "0"])),
            ..lshape(["poisson-1", "poisson-1"])
        },
        "bilaplace" => Study { method: Method::BiLaplace, ..plain(BI) },
        _ => return None,
    })
}
