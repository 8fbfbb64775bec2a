//! What the linear schemes do to forms again and again: their eigenvalues, and for which `c` they stay bounded.
//!
//! The schemes are local to a cell, so round a vertex they are six matrices, one for each corner of an octahedron, and
//! their products; a tetrahedron only hands on. `S2` loses a factor 1/4 a level on constant forms: it is bounded where
//! no product of corner matrices shrinks by less. One corner alone gives `c <= 1`, two opposite ones in turn
//! `c >= -7`, and no product found asks for more ([`growth`]). The thesis asks for `-7 < c <= -5`, (6.12): sufficient,
//! and the sign of (6.11) besides.

use nalgebra::{Complex as Number, DMatrix, Schur};

use super::complex::{Complex, OCT_EDGES};
use super::lattice::{Cell, Point, units};
use super::linear::Linear;
use super::regular::{Block, linear, mean};
use crate::topology::HalfEdge;

/// Eigenvalues, largest magnitude first.
///
/// # Panics
/// If the matrix is not square or not finite.
pub fn eigenvalues(matrix: &DMatrix<f64>) -> Vec<Number<f64>> {
    // Where eigenvectors are missing the iteration does not settle to the last digit: then to one fewer.
    let schur = (0..8).find_map(|digit| Schur::try_new(matrix.clone(), 1e-15 * 10f64.powi(digit), 1000));
    let schur = schur.expect("a finite matrix has eigenvalues");
    let mut values: Vec<_> = schur.complex_eigenvalues().iter().copied().collect();
    values.sort_by(|a, b| b.norm().total_cmp(&a.norm()).then(b.re.total_cmp(&a.re)));
    values
}

/// The matrix `1/8 sum P` of `r`-forms on the lattice.
///
/// # Panics
/// If `r > 3`.
pub fn regular(c: i32, r: usize) -> DMatrix<f64> {
    mean(&linear(c, r))
}

/// The scheme of `r`-forms on the cells round an interior vertex of the lattice, from one level to the next: 19
/// vertices, 60 edges, 56 triangles or 14 cells.
///
/// # Panics
/// If `r > 3`.
pub fn star(scheme: Linear, r: usize) -> DMatrix<f64> {
    let octs = units().map(Cell::Oct);
    let tets = super::lattice::points(-1, 0).map(Cell::Tet);
    let coarse = Block::new(octs.chain(tets));
    let fine = coarse.split();
    let sorted = |points: &[Point]| {
        let mut sorted = points.to_vec();
        sorted.sort_unstable();
        sorted
    };
    let n = coarse.complex.num_cells(r);
    let places: Vec<Vec<Point>> = (0..n).map(|j| sorted(&coarse.points(r, j))).collect();
    let mut matrix = DMatrix::zeros(n, n);
    for i in 0..fine.complex.num_cells(r) {
        let points = fine.points(r, i);
        if let Some(row) = places.iter().position(|place| *place == sorted(&points)) {
            let sign = if is_even_permutation(&points, &coarse.points(r, row), r) { 1.0 } else { -1.0 };
            scheme.row(&coarse.complex, r, i, |j, weight| matrix[(row, j as usize)] += sign * weight);
        }
    }
    matrix
}

/// Whether two orders of the vertices of a cell run the same way round.
fn is_even_permutation(a: &[Point], b: &[Point], r: usize) -> bool {
    match r {
        0 => true,
        1 => a == b,
        2 => (0..3).any(|k| (0..3).all(|i| a[(i + k) % 3] == b[i])),
        _ => super::regular::is_positive(a) == super::regular::is_positive(b),
    }
}

/// The scheme of 1-forms (12 x 12) or 2-forms (8 x 8) from an octahedron to its child at vertex `corner`.
///
/// # Panics
/// If `r` is not 1 or 2, or `corner > 5`.
pub fn corner(scheme: Linear, r: usize, corner: usize) -> DMatrix<f64> {
    let coarse = Complex::new(6, vec![], vec![[0, 1, 2, 3, 4, 5]]).expect("an octahedron");
    let fine = coarse.split().expect("its children");
    // Signed numbers of the edges or triangles of an octahedron, in one order for both levels.
    let signed = |complex: &Complex, o: usize| -> Vec<(u32, f64)> {
        let edge = |[i, j]: [usize; 2]| complex.oct_edge(o, i, j);
        match r {
            1 => OCT_EDGES.map(edge).iter().map(|&h: &HalfEdge| (h.edge(), h.sign())).collect(),
            2 => complex.oct_faces[o].iter().map(|face| (face.triangle(), face.sign())).collect(),
            _ => panic!("{r}-forms at a corner: 1 or 2"),
        }
    };
    let (columns, rows) = (signed(&coarse, 0), signed(&fine, corner));
    let mut matrix = DMatrix::zeros(rows.len(), columns.len());
    for (row, &(i, sign)) in rows.iter().enumerate() {
        scheme.row(&coarse, r, i as usize, |j, weight| {
            let column = columns.iter().position(|&(column, _)| column == j).unwrap_or(0);
            matrix[(row, column)] += sign * weight * columns[column].1;
        });
    }
    matrix
}

/// The largest spectral radius of a product of corner matrices of `S2`, to the power 1/length, over all products of at
/// most `length` of them. At most 1/4 for a scheme that is bounded.
pub fn growth(scheme: Linear, length: u32) -> f64 {
    let corners: Vec<_> = (0..6).map(|i| corner(scheme, 2, i)).collect();
    let radius = |word: &DMatrix<f64>| eigenvalues(word).first().map_or(0.0, |value| value.norm());
    let mut words = vec![DMatrix::identity(8, 8)];
    let mut worst = 0.0f64;
    for letters in 1..=length {
        words = words.iter().flat_map(|word| corners.iter().map(move |corner| word * corner)).collect();
        // A defective eigenvalue is found to the root of the rounding.
        let longest = words.iter().map(radius).fold(0.0, f64::max);
        worst = worst.max(longest.powf(1.0 / f64::from(letters)));
    }
    worst
}

/// The parameters for which no product of at most `length` corner matrices of `S2` shrinks by less than constant forms
/// do: the two ends, by bisection from the default outwards.
pub fn bounded_range(length: u32) -> [f64; 2] {
    let bounded = |c: f64| growth(Linear { c }, length) <= 0.25 + 1e-6;
    [-20.0, 20.0].map(|outside| {
        let (mut inside, mut outside) = (Linear::default().c, outside);
        while f64::abs(outside - inside) > 1e-4 {
            let middle = (inside + outside) / 2.0;
            if bounded(middle) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        inside
    })
}
