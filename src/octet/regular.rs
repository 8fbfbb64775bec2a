//! The schemes on the regular lattice, as symbols: exact rational Laurent polynomials in `z1, z2, z3`.
//!
//! Vertices are the points of Z^3 with an even sum, every odd point is the centre of an octahedron, every unit cube
//! holds a tetrahedron. Up to translation there are one vertex, six edges, eight triangles (one for each face of an
//! octahedron) and three cells (two tetrahedra and the octahedron). Conventions are those of [`crate::symbol`]: a
//! scheme `P` and the derivative `d` commute when
//!
//! ```text
//! d(z) P_r(z) = P_{r+1}(z) d(z^2)
//! ```
//!
//! (7.1) of Ke Wang's thesis has `d(z)` on both sides, which does not hold. The smooth schemes are `C P_r` with
//! one scalar kernel `C`, [`kernel`]: they commute because the linear ones do.
//!
//! The symbols are read off the scheme's own rows for meshes, on a piece of the lattice; so what is shown of them is
//! shown of what is applied.

use std::collections::BTreeMap;

use super::complex::Complex;
use super::lattice::{Cell, Point, det, minus, plus, points, steps, units};
use super::linear::Linear;
use crate::symbol::{Laurent, Position3, Rational, Symbol};

/// A piece of the lattice as a complex.
pub(super) struct Block {
    pub complex: Complex,
    pub positions: Vec<Point>,
}

impl Block {
    /// The complex of these cells.
    pub fn new(cells: impl IntoIterator<Item = Cell>) -> Self {
        let (mut numbers, mut positions) = (BTreeMap::new(), Vec::new());
        let (mut tets, mut octs) = (Vec::new(), Vec::new());
        for cell in cells {
            let vertices: Vec<u32> = cell
                .vertices()
                .into_iter()
                .map(|p| {
                    *numbers.entry(p).or_insert_with(|| {
                        positions.push(p);
                        positions.len() as u32 - 1
                    })
                })
                .collect();
            match cell {
                Cell::Tet(_) => tets.push([vertices[0], vertices[1], vertices[2], vertices[3]]),
                Cell::Oct(_) => octs.push(std::array::from_fn(|i| vertices[i])),
            }
        }
        let complex = Complex::new(positions.len(), tets, octs).expect("cells of the lattice are a complex");
        Block { complex, positions }
    }

    /// All cells of the cube `[-size, size]^3`.
    fn cube(size: i32) -> Self {
        let cells = points(-size, size).flat_map(|n| {
            let odd = (n[0] + n[1] + n[2]) % 2 != 0;
            [Some(Cell::Tet(n)), odd.then_some(Cell::Oct(n))].into_iter().flatten()
        });
        let inside = |cell: &Cell| cell.vertices().iter().flatten().all(|x| x.abs() <= size);
        Block::new(cells.filter(inside))
    }

    /// The next level, in coordinates of twice the size.
    pub fn split(&self) -> Block {
        let complex = self.complex.split().expect("a small complex");
        let middle = |vertices: &[u32], share: i32| -> Point {
            let sum = vertices.iter().fold([0; 3], |sum, &v| plus(sum, self.positions[v as usize]));
            sum.map(|x| x / share)
        };
        let old = (0..self.positions.len() as u32).map(|v| middle(&[v, v], 1));
        let edges = self.complex.edges().iter().map(|ends| middle(ends, 1));
        let octs = self.complex.octs().iter().map(|vertices| middle(vertices, 3));
        let positions = old.chain(edges).chain(octs).collect();
        Block { complex, positions }
    }

    /// The points of an `r`-cell, in the order of its orientation.
    pub fn points(&self, r: usize, i: usize) -> Vec<Point> {
        let vertices: Vec<u32> = match r {
            0 => vec![i as u32],
            1 => self.complex.edges()[i].to_vec(),
            2 => self.complex.triangle_vertices(i as u32).to_vec(),
            _ => self.complex.cell_vertices(i as u32).to_vec(),
        };
        vertices.into_iter().map(|v| self.positions[v as usize]).collect()
    }
}

/// What a cell is up to translation, where, and whether it is turned as the first of its type is (1) or not (-1).
fn identify(points: &[Point]) -> (usize, Point, i64) {
    let first = points[0];
    let sign = |positive: bool| if positive { 1 } else { -1 };
    match points.len() {
        1 => (0, first, 1),
        2 => {
            let positive = first < points[1];
            let [a, b] = if positive { [first, points[1]] } else { [points[1], first] };
            let types = steps().filter(|&step| step > [0, 0, 0]);
            let direction = minus(b, a);
            (
                types.into_iter().position(|step| step == direction).expect("an edge of the lattice"),
                a,
                sign(positive),
            )
        }
        3 => {
            let near = |centre: &Point| points.iter().all(|&p| units().any(|u| plus(*centre, u) == p));
            let centre = units().map(|u| plus(first, u)).find(near).expect("a triangle of the lattice");
            let beyond: Vec<Point> = points.iter().map(|&p| minus(p, centre)).collect();
            let corner = beyond.iter().fold([0; 3], |sum, &p| plus(sum, p));
            let bits: Vec<usize> = (0..3).map(|k| usize::from(corner[k] < 0) << k).collect();
            let outward = det(beyond[0], beyond[1], beyond[2]) > 0;
            (bits.iter().sum(), minus(centre, [1, 0, 0]), sign(outward))
        }
        4 => {
            let low: Point = [0, 1, 2].map(|k| points.iter().map(|p| p[k]).min().unwrap_or(0));
            let positive = det(minus(points[1], first), minus(points[2], first), minus(points[3], first)) > 0;
            match (low[0] + low[1] + low[2]) % 2 == 0 {
                true => (0, low, sign(positive)),
                false => (1, minus(low, [1, 0, 0]), sign(positive)),
            }
        }
        _ => {
            let across: Vec<Point> = (0..3).map(|k| minus(points[k], points[k + 3])).collect();
            let centre = std::array::from_fn(|k| (first[k] + points[3][k]) / 2);
            (2, minus(centre, [1, 0, 0]), sign(det(across[0], across[1], across[2]) > 0))
        }
    }
}

/// Whether a cell with these vertices is positively oriented.
pub(super) fn is_positive(points: &[Point]) -> bool {
    identify(points).2 > 0
}

/// The number of types of `r`-cells.
const TYPES: [usize; 4] = [1, 6, 8, 3];

fn exponent(p: Point) -> Position3 {
    (p[0], p[1], p[2])
}

/// The symbol of the linear scheme for `r`-forms with parameter `c`, exactly.
///
/// # Panics
/// If `r > 3`.
pub fn linear(c: i32, r: usize) -> Symbol<Position3> {
    let coarse = Block::cube(3);
    let fine = coarse.split();
    let scheme = Linear { c: f64::from(c) };
    let mut symbol = Symbol::zero(TYPES[r], TYPES[r]);
    // One fine cell of each type from each of the eight classes of positions.
    let mut seen = BTreeMap::new();
    for i in 0..fine.complex.num_cells(r) {
        let points = fine.points(r, i);
        let (type_, position, sign) = identify(&points);
        let class = position.map(|x| x.rem_euclid(2));
        let far: i32 = position.iter().map(|x| x.abs()).sum();
        // The classes are those of fine positions modulo twice the lattice.
        let class = (type_, class, quarter(position));
        let best = seen.entry(class).or_insert((far, i, position, sign));
        if far < best.0 {
            *best = (far, i, position, sign);
        }
    }
    assert_eq!(seen.len(), 8 * TYPES[r], "every class has a fine cell");
    for ((type_, ..), (_, i, position, sign)) in seen {
        scheme.row(&coarse.complex, r, i, |j, weight| {
            let (column, q, turn) = identify(&coarse.points(r, j as usize));
            let weight = whole_96ths(weight) * (sign * turn);
            symbol.add_term(type_, column, exponent(minus(position, plus(q, q))), weight);
        });
    }
    symbol
}

/// Twice the lattice has index 8 in the lattice, its points are `2q` with `q` even: which coset of it, beside the
/// parities.
fn quarter(p: Point) -> i32 {
    (p.iter().map(|x| x - x.rem_euclid(2)).sum::<i32>() / 2).rem_euclid(2)
}

/// Weights are whole 96ths when `c` is whole.
fn whole_96ths(weight: f64) -> Rational {
    let whole = (96.0 * weight).round();
    assert!((96.0 * weight - whole).abs() < 1e-12, "a weight that is no 96th");
    Rational::new(whole as i64, 96)
}

/// The symbol of the exterior derivative of `r`-forms.
///
/// # Panics
/// If `r > 2`.
pub fn exterior_derivative(r: usize) -> Symbol<Position3> {
    let block = Block::cube(3);
    let d = block.complex.exterior_derivative(r);
    let mut symbol = Symbol::zero(TYPES[r + 1], TYPES[r]);
    for i in 0..block.complex.num_cells(r + 1) {
        let (type_, position, sign) = identify(&block.points(r + 1, i));
        if position == [0, 0, 0] {
            let (columns, values) = crate::sparse::row_of(&d, i);
            for (&j, &value) in columns.iter().zip(values) {
                let (column, q, turn) = identify(&block.points(r, j as usize));
                let value = Rational::from(value as i64 * sign * turn);
                symbol.add_term(type_, column, exponent(minus([0, 0, 0], q)), value);
            }
        }
    }
    symbol
}

/// The kernel `C` of the smooth schemes: 1/8 at 0, 1/16 at each of the twelve neighbours, 1/48 at each of the six
/// vertices opposite in an octahedron. The smooth scheme is `linear(c, r).convolve(&kernel())`.
pub fn kernel() -> Laurent<Position3> {
    let neighbours: Vec<Position3> = steps().map(exponent).collect();
    let opposite: Vec<Position3> = units().map(|u| exponent(plus(u, u))).collect();
    let sum = &Laurent::constant(Rational::new(1, 8)) + &Laurent::sum(&neighbours, Rational::new(1, 16));
    &sum + &Laurent::sum(&opposite, Rational::new(1, 48))
}

/// The sum of all matrices of a symbol, over 8: what it does to forms that are constant, type by type. Its
/// eigenvalues are those of the derivatives of the scheme's limits, (6.5) to (6.8) of the thesis.
pub fn mean(symbol: &Symbol<Position3>) -> nalgebra::DMatrix<f64> {
    let (rows, columns) = symbol.shape();
    nalgebra::DMatrix::from_fn(rows, columns, |i, j| {
        let sum: Rational = symbol.entry(i, j).terms().map(|(_, value)| value).sum();
        *sum.numer() as f64 / *sum.denom() as f64 / 8.0
    })
}
