//! The polynomials of regular triangles: Appendix A.1 of Ke Wang's thesis, found rather than copied.
//!
//! On a face whose surroundings are regular the limit forms are polynomials with integer coefficients over 24:
//! quartic for 0-forms (the box spline) and the components of 1-forms (the thesis' Bezier matrices), cubic for
//! 2-forms (the half-box spline). A polynomial that has the exact limit values on a refinement fine enough to
//! tell polynomials apart is the limit itself, so each is solved for from the limit operators of a model, three
//! levels down, and rounded to its integers.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock};

use nalgebra::DMatrix;

use super::Limit;
use super::frame::child_corner;
use super::model::{LEVELS, Model, block, dense};
use super::neighbourhood::Configuration;
use crate::hierarchy::HierarchyError;
use crate::scheme::{BoundaryRule, Scheme, Variant};
use crate::sparse::{Csr, assemble, multiply};
use crate::topology::SplitKind;

/// The exponents `(i, j, k)` of the monomials `u^i v^j w^k` of a degree, in the order of coefficients: `u = 1 - s - t`,
/// `v = s`, `w = t`.
pub fn exponents(degree: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..=degree).flat_map(move |k| (0..=degree - k).map(move |j| [degree - k - j, j, k]))
}

/// How far below the model's face its limits are taken: quartic 1-forms differ on 64 triangles, not on 16.
const DEPTH: usize = 3;

/// The Bernstein coefficients of a face in a configuration, over its cells: 15, 30 and 10 rows.
///
/// # Errors
/// If OpenSubdiv fails on the model.
pub fn polynomials(configuration: Configuration) -> Result<Arc<[Csr; 3]>, HierarchyError> {
    type Known = HashMap<Configuration, Arc<[Csr; 3]>>;
    static KNOWN: OnceLock<Mutex<Known>> = OnceLock::new();
    let mut known = KNOWN.get_or_init(Mutex::default).lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    if let Some(found) = known.get(&configuration) {
        return Ok(found.clone());
    }
    let found = Arc::new(solve(configuration)?);
    known.insert(configuration, found.clone());
    Ok(found)
}

/// The polynomials of a triangle of the Whitney scheme, over its vertices, its edges and itself: barycentric
/// coordinates, (3.33) of the thesis and a constant, all raised to the degree of the others.
pub fn whitney() -> [Csr; 3] {
    let quartic: Vec<_> = exponents(4).collect();
    let coordinate = |m: usize, c: usize| quartic[m][c] as f64 / 4.0;
    let slope = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]; // of the coordinates, by s and t
    let vertices = assemble((15, 3), |m, row| (0..3).for_each(|c| row.add(c as u32, coordinate(m, c))));
    let edges = assemble((30, 3), |row_number, row| {
        let (m, k) = (row_number % 15, row_number / 15);
        for a in 0..3 {
            let b = (a + 1) % 3;
            row.add(a as u32, coordinate(m, a) * slope[b][k] - coordinate(m, b) * slope[a][k]);
        }
    });
    // The whole over the triangle's area of one half.
    [vertices, edges, assemble((10, 1), |_, row| row.add(0, 2.0))]
}

/// A triangle of a refinement, in the parameters of the face: where its corner lies, and its size, negative if it
/// is upside down.
#[derive(Clone, Copy)]
struct Piece {
    corner: u32,
    origin: [f64; 2],
    size: f64,
}

fn solve(configuration: Configuration) -> Result<[Csr; 3], HierarchyError> {
    // Regular vertices and creases are the same in both variants; this one is in double precision.
    let scheme = Scheme::Loop(Variant::ModifiedLoop, BoundaryRule::Reflect);
    let top = LEVELS - 1;
    let model = Model::new(SplitKind::Triangle, scheme, configuration, top + DEPTH)?;
    let (corner, cells) = model.patch(top, configuration);
    let hierarchy = model.hierarchy();

    let mut pieces = vec![Piece { corner, origin: [0.0, 0.0], size: 1.0 }];
    for level in top + 1..=top + DEPTH {
        let (parent, child) = (hierarchy.level(level - 1).mesh(), hierarchy.level(level).mesh());
        let split = hierarchy.refinement(level).split();
        let children = |piece: Piece| {
            let ([s, t], h) = (piece.origin, piece.size / 2.0);
            [([s, t], h), ([s + h, t], h), ([s, t + h], h), ([s + h, t + h], -h)].into_iter().enumerate().map(
                move |(i, (origin, size))| Piece {
                    corner: child_corner(split, parent, child, piece.corner, i),
                    origin,
                    size,
                },
            )
        };
        pieces = pieces.into_iter().flat_map(children).collect();
    }

    let finest = hierarchy.finest().mesh();
    let limit = Limit::new(hierarchy, top + DEPTH)?.operators(finest);
    let values = |k: usize, matrix: Csr, rows: &[(u32, f64)]| {
        let down = (top + 1..=top + DEPTH).rev().fold(block_rows(&matrix, rows), |product, level| {
            let operators = hierarchy.operators(level);
            multiply(&product, [&operators.s0, &operators.s1, &operators.s2][k])
        });
        let all: Vec<(u32, f64)> = (0..rows.len() as u32).map(|row| (row, 1.0)).collect();
        dense(&block(&down, &cells.signed()[k], &all))
    };

    let points: Vec<_> = pieces.iter().map(|piece| (finest.corner_vertex(piece.corner), 1.0)).collect();
    let at = pieces.iter().flat_map(|piece| monomials(4, piece.origin)).collect::<Vec<_>>();
    let form0 = bernstein(4, &DMatrix::from_row_slice(pieces.len(), 15, &at), &values(0, limit.l0, &points));

    let (mut edges, mut along) = (Vec::new(), Vec::new());
    for piece in &pieces {
        let ([s, t], h) = (piece.origin, piece.size);
        let corners = [[s, t], [s + h, t], [s, t + h]];
        let mut c = piece.corner;
        for i in 0..3 {
            let half_edge = finest.corner_half_edge(c);
            edges.push((half_edge.edge(), half_edge.sign()));
            along.extend(circulation(corners[i], corners[(i + 1) % 3]));
            c = finest.next_corner(c);
        }
    }
    let form1 = bernstein(4, &DMatrix::from_row_slice(edges.len(), 30, &along), &values(1, limit.l1, &edges));

    let faces: Vec<_> = pieces.iter().map(|piece| (finest.corner_face(piece.corner), 1.0)).collect();
    let over = pieces.iter().flat_map(|piece| integral(piece.origin, piece.size)).collect::<Vec<_>>();
    let form2 = bernstein(3, &DMatrix::from_row_slice(pieces.len(), 10, &over), &values(2, limit.l2, &faces));
    Ok([form0, form1, form2])
}

fn block_rows(matrix: &Csr, rows: &[(u32, f64)]) -> Csr {
    assemble((rows.len(), matrix.cols()), |i, row| row.add_row(matrix, rows[i].0 as usize, rows[i].1))
}

fn monomials(degree: usize, [s, t]: [f64; 2]) -> Vec<f64> {
    let power = |x: f64, i: usize| x.powi(i as i32);
    exponents(degree).map(|[i, j, k]| power(1.0 - s - t, i) * power(s, j) * power(t, k)).collect()
}

/// Gauss' rule of three points on `[0, 1]`, exact to degree 5.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// The integrals along a segment of the quartic monomials times `ds`, then times `dt`.
fn circulation(from: [f64; 2], to: [f64; 2]) -> Vec<f64> {
    let d = [to[0] - from[0], to[1] - from[1]];
    let mut sums = vec![0.0; 30];
    for (x, weight) in GAUSS {
        for (m, value) in monomials(4, [from[0] + x * d[0], from[1] + x * d[1]]).into_iter().enumerate() {
            sums[m] += weight * value * d[0];
            sums[15 + m] += weight * value * d[1];
        }
    }
    sums
}

/// The integrals over a small triangle of the cubic monomials times `ds^dt`.
fn integral(origin: [f64; 2], size: f64) -> Vec<f64> {
    let mut sums = vec![0.0; 10];
    for (x, wx) in GAUSS {
        for (y, wy) in GAUSS {
            // The square folded onto the triangle.
            let at = [origin[0] + size * x * (1.0 - y), origin[1] + size * y];
            for (m, value) in monomials(3, at).into_iter().enumerate() {
                sums[m] += wx * wy * (1.0 - y) * size * size * value;
            }
        }
    }
    sums
}

/// The Bernstein coefficients of polynomials with these values. Those of monomials are integers over 24.
fn bernstein(degree: usize, at: &DMatrix<f64>, values: &DMatrix<f64>) -> Csr {
    let inverse = at.clone().pseudo_inverse(1e-10).expect("a tolerance is positive");
    let found = inverse * values * 24.0;
    let factorial = |n: usize| (1..=n).product::<usize>() as f64;
    let multiplicity = |e: [usize; 3]| factorial(degree) / e.map(factorial).iter().product::<f64>();
    let multiplicities: Vec<f64> = exponents(degree).map(multiplicity).collect();
    assemble(found.shape(), |i, row| {
        let multiplicity = multiplicities[i % multiplicities.len()];
        for (j, &x) in found.row(i).iter().enumerate() {
            assert!((x - x.round()).abs() < 1e-6, "a coefficient of a regular patch is {x}/24");
            row.add(j as u32, x.round() / (24.0 * multiplicity));
        }
    })
}
