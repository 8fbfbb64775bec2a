//! The regular subdivision schemes as symbols: exact rational Laurent polynomials in `z1, z2` (those in space are
//! in [`crate::octet::regular`]).
//!
//! On the regular lattice a cochain with values `c_j(q)` on the cells of type `j` at position `q` has
//! the generating functions `c_j(z) = sum_q c_j(q) z^q`. A scheme `S` is a matrix of Laurent polynomials,
//! and so is the exterior derivative `d`:
//!
//! ```text
//! c'_i(z) = sum_j S_ij(z) c_j(z^2)        (d c)_i(z) = sum_j d_ij(z) c_j(z)
//! ```
//!
//! So the fine cell of type `i` at `p` takes the coefficient of `z^(p-2q)` in `S_ij` from the coarse
//! cell of type `j` at `q`; fine vertex `2q` is the child of coarse vertex `q`. A scheme commutes with
//! the derivative when `d(z) S_r(z) = S_{r+1}(z) d(z^2)`: the right-hand `d` acts before refinement, so
//! it stands at `z^2`; (3.58) of Ke Wang's thesis prints it at `z`.
//!
//! # Smooth from Whitney
//!
//! By (3.59) of the thesis the smooth schemes are convolutions of the Whitney schemes with one scalar
//! kernel, `S_r = C W_r`. They commute because the Whitney schemes do. This is another road to the
//! regular weights than the local rules for meshes, and an exact one: it checks those row by row.
//!
//! # The third factor of the triangle kernel
//!
//! `C` is a product over the three edge directions of the lattice. Faces here are cut along
//! `e3 = e2 - e1`, so its third factor is `1 + z^e3 = 1 + z1^-1 z2`. The thesis prints `1 + z1 z2`
//! (Theorem 3.34), which belongs to faces cut along `e1 + e2`, and not to its own (3.21). Any scalar
//! kernel commutes, so commutation cannot tell the two apart; but the printed one lacks the sixfold
//! symmetry of the lattice: an even vertex gets 1/2 of itself, not Loop's 5/8, and 1/8 each of only
//! four neighbours.
//!
//! ```
//! use formwork::symbol::{Lattice, Rational, smooth};
//!
//! // Loop's rule for the child of a vertex: 5/8 itself, 1/16 each of six neighbours.
//! let row = smooth(Lattice::Triangles, 0).stencil(0, (0, 0));
//! assert_eq!(row.len(), 7);
//! assert!(row.contains(&(0, (0, 0), Rational::new(5, 8))));
//! ```

use std::collections::BTreeMap;
use std::ops::{Add, Mul};

use num_rational::Ratio;

/// An exact weight. Those of all schemes here are dyadic, so they are exact in `f64` too.
pub type Rational = Ratio<i64>;

/// A point of the lattice, and the exponent of a monomial `z1^i z2^j`.
pub type Position = (i32, i32);

/// A point of a lattice in space, and the exponent of a monomial `z1^i z2^j z3^k`.
pub type Position3 = (i32, i32, i32);

/// What the exponent of a monomial may be: a point of a lattice in any dimension.
pub trait Exponent: Copy + Ord + std::fmt::Debug {
    /// The exponent of 1.
    const ORIGIN: Self;
    /// The exponent of a product.
    fn plus(self, other: Self) -> Self;
}

impl Exponent for Position {
    const ORIGIN: Self = (0, 0);
    fn plus(self, other: Self) -> Self {
        plus(self, other)
    }
}

impl Exponent for Position3 {
    const ORIGIN: Self = (0, 0, 0);
    fn plus(self, other: Self) -> Self {
        (self.0 + other.0, self.1 + other.1, self.2 + other.2)
    }
}

const HALF: Rational = Rational::new_raw(1, 2);
const QUARTER: Rational = Rational::new_raw(1, 4);

fn plus(a: Position, b: Position) -> Position {
    (a.0 + b.0, a.1 + b.1)
}

fn minus(a: Position, b: Position) -> Position {
    (a.0 - b.0, a.1 - b.1)
}

/// A Laurent polynomial with rational coefficients, in `z1, z2` unless `P` says otherwise. No zero coefficient is stored, so equal
/// polynomials compare equal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Laurent<P = Position>(BTreeMap<P, Rational>);

impl<P: Exponent> Laurent<P> {
    /// The polynomial 0.
    pub fn zero() -> Self {
        Laurent(BTreeMap::new())
    }

    /// A constant polynomial.
    pub fn constant(value: Rational) -> Self {
        Laurent::monomial(P::ORIGIN, value)
    }

    /// `value z^exponent`.
    pub fn monomial(exponent: P, value: Rational) -> Self {
        Laurent::sum(&[exponent], value)
    }

    /// `value` times the sum of the monomials `z^exponent`; a repeated exponent counts repeatedly.
    pub fn sum(exponents: &[P], value: Rational) -> Self {
        let mut result = Laurent::zero();
        exponents.iter().for_each(|&exponent| result.add_term(exponent, value));
        result
    }

    /// The coefficient of `z^exponent`.
    pub fn at(&self, exponent: P) -> Rational {
        self.0.get(&exponent).copied().unwrap_or(Rational::ZERO)
    }

    /// The nonzero terms `(exponent, coefficient)`, exponents ascending.
    pub fn terms(&self) -> impl Iterator<Item = (P, Rational)> + '_ {
        self.0.iter().map(|(&exponent, &value)| (exponent, value))
    }

    /// The polynomial times a number.
    pub fn scale(&self, factor: Rational) -> Self {
        self * &Laurent::constant(factor)
    }

    pub(crate) fn add_term(&mut self, exponent: P, value: Rational) {
        let sum = self.at(exponent) + value;
        if sum == Rational::ZERO {
            self.0.remove(&exponent);
        } else {
            self.0.insert(exponent, sum);
        }
    }
}

impl Laurent {
    /// The coefficient of `z1^i z2^j`.
    pub fn coefficient(&self, i: i32, j: i32) -> Rational {
        self.at((i, j))
    }
}

impl<P: Exponent> Add for &Laurent<P> {
    type Output = Laurent<P>;

    fn add(self, other: &Laurent<P>) -> Laurent<P> {
        let mut result = self.clone();
        other.terms().for_each(|(exponent, value)| result.add_term(exponent, value));
        result
    }
}

impl<P: Exponent> Mul for &Laurent<P> {
    type Output = Laurent<P>;

    fn mul(self, other: &Laurent<P>) -> Laurent<P> {
        let mut result = Laurent::zero();
        for (p, a) in self.terms() {
            other.terms().for_each(|(q, b)| result.add_term(p.plus(q), a * b));
        }
        result
    }
}

/// A matrix of Laurent polynomials; row = type of the resulting cell, column = type of the given one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol<P = Position>(Vec<Vec<Laurent<P>>>);

impl<P: Exponent> Symbol<P> {
    pub(crate) fn zero(rows: usize, columns: usize) -> Self {
        Symbol(vec![vec![Laurent::zero(); columns]; rows])
    }

    /// Number of types of the resulting cells, number of types of the given cells.
    pub fn shape(&self) -> (usize, usize) {
        (self.0.len(), self.0[0].len())
    }

    /// The entry for resulting cells of type `i` and given cells of type `j`.
    ///
    /// # Panics
    /// If `i` or `j` is out of range.
    pub fn entry(&self, i: usize, j: usize) -> &Laurent<P> {
        &self.0[i][j]
    }

    /// Every entry at `z^2`.
    pub fn at_square(&self) -> Self {
        self.map(|entry| {
            Laurent(entry.terms().map(|(exponent, value)| (exponent.plus(exponent), value)).collect())
        })
    }

    /// Every entry times `kernel`: the convolution (3.59).
    pub fn convolve(&self, kernel: &Laurent<P>) -> Self {
        self.map(|entry| kernel * entry)
    }

    pub(crate) fn add_term(&mut self, i: usize, j: usize, exponent: P, value: Rational) {
        self.0[i][j].add_term(exponent, value);
    }

    fn map(&self, f: impl Fn(&Laurent<P>) -> Laurent<P>) -> Self {
        Symbol(self.0.iter().map(|row| row.iter().map(&f).collect()).collect())
    }
}

impl Symbol {
    /// The row of the fine cell of type `i` at fine `position`: type `j` and position `q` of each coarse
    /// cell it takes from, with the nonzero coefficient of `z^(position - 2q)` in entry `(i, j)`.
    ///
    /// # Panics
    /// If `i` is out of range.
    pub fn stencil(&self, i: usize, position: Position) -> Vec<(usize, Position, Rational)> {
        let mut row = Vec::new();
        for (j, entry) in self.0[i].iter().enumerate() {
            for (exponent, weight) in entry.terms() {
                let (x, y) = minus(position, exponent);
                if x % 2 == 0 && y % 2 == 0 {
                    row.push((j, (x / 2, y / 2), weight));
                }
            }
        }
        row
    }
}

impl<P: Exponent> Mul for &Symbol<P> {
    type Output = Symbol<P>;

    /// The matrix product.
    ///
    /// # Panics
    /// If `other` does not have as many rows as `self` has columns.
    fn mul(self, other: &Symbol<P>) -> Symbol<P> {
        let ((rows, inner), (other_rows, columns)) = (self.shape(), other.shape());
        assert_eq!(inner, other_rows, "the types of cells between two symbols differ");
        let entry = |i: usize, j: usize| {
            (0..inner).fold(Laurent::zero(), |sum, k| &sum + &(&self.0[i][k] * &other.0[k][j]))
        };
        Symbol((0..rows).map(|i| (0..columns).map(|j| entry(i, j)).collect()).collect())
    }
}

/// A regular lattice with its types of cells. An edge at `p` with direction `e` runs from `p` to `p + e`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lattice {
    /// Edges along `e1 = (1,0)`, `e2 = (0,1)`, `e3 = (-1,1)`, which is `e2 - e1`; faces up `(0,0), (1,0),
    /// (0,1)` and down `(1,0), (1,1), (0,1)`.
    Triangles,
    /// Edges along `e1 = (1,0)`, `e2 = (0,1)`; one face `(0,0), (1,0), (1,1), (0,1)`.
    Quads,
}

impl Lattice {
    /// The edge directions, one for each type of edge.
    pub fn directions(self) -> &'static [Position] {
        match self {
            Lattice::Triangles => &[(1, 0), (0, 1), (-1, 1)],
            Lattice::Quads => &[(1, 0), (0, 1)],
        }
    }

    /// The vertices of the faces at the origin, counter-clockwise, one for each type of face.
    pub fn faces(self) -> &'static [&'static [Position]] {
        match self {
            Lattice::Triangles => &[&[(0, 0), (1, 0), (0, 1)], &[(1, 0), (1, 1), (0, 1)]],
            Lattice::Quads => &[&[(0, 0), (1, 0), (1, 1), (0, 1)]],
        }
    }

    /// Type, position and sign of the edge between `a` and `b`; -1 if the lattice directs it `b -> a`.
    ///
    /// # Panics
    /// If `a` and `b` are not neighbours.
    pub fn edge(self, a: Position, b: Position) -> (usize, Position, i64) {
        let find = |step| self.directions().iter().position(|&direction| direction == step);
        match (find(minus(b, a)), find(minus(a, b))) {
            (Some(i), _) => (i, a, 1),
            (_, Some(i)) => (i, b, -1),
            _ => panic!("no edge joins {a:?} and {b:?}"),
        }
    }
}

/// The symbol of `d0` (`r = 0`; one row for each edge direction) or `d1` (`r = 1`; one row for each face).
///
/// # Panics
/// If `r > 1`.
pub fn exterior_derivative(lattice: Lattice, r: usize) -> Symbol {
    assert!(r < 2, "no exterior derivative of {r}-forms on a surface");
    let (directions, faces) = (lattice.directions(), lattice.faces());
    if r == 0 {
        let minus_one = Laurent::constant(-Rational::ONE);
        let head = |&e| Laurent::monomial(minus((0, 0), e), Rational::ONE);
        return Symbol(directions.iter().map(|e| vec![&head(e) + &minus_one]).collect());
    }
    let mut d = Symbol::zero(faces.len(), directions.len());
    for (row, face) in d.0.iter_mut().zip(faces) {
        for k in 0..face.len() {
            let (j, q, sign) = lattice.edge(face[k], face[(k + 1) % face.len()]);
            row[j].add_term(minus((0, 0), q), sign.into());
        }
    }
    d
}

/// The Whitney scheme of `r`-forms, written down from its rules.
///
/// - `r = 0`: a vertex keeps its value, an edge's midpoint gets halves, a quad's centre quarters.
/// - `r = 1`: half an edge gets half its value. On triangles the child `m(v,w0) -> m(v,w1)` at corner
///   `v` of face `(v,w0,w1)` gets `1/4 (w0->w1) + 1/4 (v->w1) - 1/4 (v->w0)` (3.13); on quads the child
///   from the midpoint of a side to the centre gets half the mean of the two sides parallel to it.
/// - `r = 2`: each of the four children of a face gets a quarter.
///
/// # Panics
/// If `r > 2`.
pub fn whitney(lattice: Lattice, r: usize) -> Symbol {
    match (r, lattice) {
        (0, _) => {
            let mut w = Laurent::constant(Rational::ONE);
            for &(x, y) in lattice.directions() {
                w = &w + &Laurent::sum(&[(x, y), (-x, -y)], HALF);
            }
            if lattice == Lattice::Quads {
                w = &w + &Laurent::sum(&[(1, 1), (-1, 1), (-1, -1), (1, -1)], QUARTER);
            }
            Symbol(vec![vec![w]])
        }
        (1, _) => whitney_edges(lattice),
        (2, Lattice::Triangles) => {
            let quarters = |exponents: &[Position]| Laurent::sum(exponents, QUARTER);
            Symbol(vec![
                vec![quarters(&[(0, 0), (1, 0), (0, 1)]), quarters(&[(1, 1)])],
                vec![quarters(&[(0, 0)]), quarters(&[(1, 0), (0, 1), (1, 1)])],
            ])
        }
        (2, Lattice::Quads) => Symbol(vec![vec![Laurent::sum(lattice.faces()[0], QUARTER)]]),
        _ => panic!("no {r}-forms on a surface"),
    }
}

fn whitney_edges(lattice: Lattice) -> Symbol {
    let directions = lattice.directions();
    let mut w = Symbol::zero(directions.len(), directions.len());
    for (i, &direction) in directions.iter().enumerate() {
        w.0[i][i] = Laurent::sum(&[(0, 0), direction], HALF);
    }
    // Fine points are in fine coordinates, where the midpoint of a and b is a + b.
    let mut take = |fine: [Position; 2], coarse: [Position; 2], weight: Rational| {
        let (i, p, fine_sign) = lattice.edge(fine[0], fine[1]);
        let (j, q, coarse_sign) = lattice.edge(coarse[0], coarse[1]);
        w.0[i][j].add_term(minus(p, plus(q, q)), weight * (fine_sign * coarse_sign));
    };
    for face in lattice.faces() {
        for k in 0..face.len() {
            let [a, b, c, d] = [0, 1, 2, 3].map(|t| face[(k + t) % face.len()]);
            // a + c: the midpoint of a side of a triangle, of a diagonal (so the centre) of a quad.
            let child = [plus(a, b), plus(a, c)];
            if lattice == Lattice::Triangles {
                take(child, [b, c], QUARTER);
                take(child, [a, c], QUARTER);
                take(child, [a, b], -QUARTER);
            } else {
                take(child, [b, c], QUARTER);
                take(child, [a, d], QUARTER);
            }
        }
    }
    w
}

/// The kernel `C` that turns the Whitney schemes into smooth ones, centred at `z^0`, with `C(1,1) = 1`.
///
/// Triangles: `1/8 (1+z1)(1+z2)(1+z1^-1 z2) z2^-1`, which gives Loop vertices and half-box faces. Quads:
/// `1/16 (1+z1)^2 (1+z2)^2 z1^-1 z2^-1`, which gives bicubic vertices and biquadratic faces.
pub fn smoothing(lattice: Lattice) -> Laurent {
    let (factors, centring): (&[Position], _) = match lattice {
        Lattice::Triangles => (&[(1, 0), (0, 1), (-1, 1)], (0, -1)),
        Lattice::Quads => (&[(1, 0), (1, 0), (0, 1), (0, 1)], (-1, -1)),
    };
    let centred = Laurent::monomial(centring, Rational::ONE);
    factors.iter().fold(centred, |product, &e| &product * &Laurent::sum(&[(0, 0), e], HALF))
}

/// The smooth scheme of `r`-forms: [`smoothing`] times [`whitney`] (3.59).
///
/// # Panics
/// If `r > 2`.
pub fn smooth(lattice: Lattice, r: usize) -> Symbol {
    whitney(lattice, r).convolve(&smoothing(lattice))
}
