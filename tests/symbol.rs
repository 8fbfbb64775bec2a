//! The regular schemes as symbols: their rows against the known stencils, and their laws, all exactly.

use std::collections::BTreeMap;

use formwork::symbol::{
    Lattice, Laurent, Position, Rational, Symbol, exterior_derivative, smooth, smoothing, whitney,
};

use Lattice::{Quads, Triangles};

type Row = BTreeMap<(usize, Position), Rational>;

fn ratio(numerator: i64, denominator: i64) -> Rational {
    Rational::new(numerator, denominator)
}

fn add(a: Position, b: Position) -> Position {
    (a.0 + b.0, a.1 + b.1)
}

fn row(symbol: &Symbol, i: usize, position: Position) -> Row {
    let terms = symbol.stencil(i, position);
    let row: Row = terms.iter().map(|&(j, q, weight)| ((j, q), weight)).collect();
    assert_eq!(row.len(), terms.len(), "a cell is listed twice");
    row
}

/// The row of the child edge `a -> b`, directed so.
fn edge_row(symbol: &Symbol, lattice: Lattice, a: Position, b: Position) -> Row {
    let (i, position, sign) = lattice.edge(a, b);
    row(symbol, i, position).into_iter().map(|(cell, weight)| (cell, weight * sign)).collect()
}

/// A row given as weights `n / denominator` on directed coarse edges; zeros are left out.
fn chain(lattice: Lattice, denominator: i64, edges: &[(Position, Position, i64)]) -> Row {
    let nonzero = edges.iter().filter(|edge| edge.2 != 0);
    let row = nonzero.map(|&(a, b, n)| {
        let (j, q, sign) = lattice.edge(a, b);
        ((j, q), ratio(n * sign, denominator))
    });
    row.collect()
}

fn cells(denominator: i64, weights: &[(usize, Position, i64)]) -> Row {
    weights.iter().map(|&(j, q, n)| ((j, q), ratio(n, denominator))).collect()
}

/// The neighbours of `v` on the triangle lattice, counter-clockwise from the `i`-th.
fn fan(v: Position, i: usize) -> [Position; 6] {
    const HEXAGON: [Position; 6] = [(1, 0), (0, 1), (-1, 1), (-1, 0), (0, -1), (1, -1)];
    std::array::from_fn(|j| add(v, HEXAGON[(i + j) % 6]))
}

/// Type and position of the triangle with these vertices.
fn triangle(vertices: [Position; 3]) -> (usize, Position) {
    let x = vertices.map(|v| v.0).into_iter().min().unwrap();
    let y = vertices.map(|v| v.1).into_iter().min().unwrap();
    (usize::from(!vertices.contains(&(x, y))), (x, y))
}

fn all_ones(entry: &Laurent) -> Rational {
    entry.terms().map(|(_, value)| value).sum()
}

/// `1/8 (1+z1)(1+z2)(1+z1 z2)`, centred: the triangle kernel as Ke Wang's thesis prints it.
fn printed_kernel() -> Laurent {
    let factor = |e| Laurent::sum(&[(0, 0), e], ratio(1, 2));
    let product = &(&factor((1, 0)) * &factor((0, 1))) * &factor((1, 1));
    &product * &Laurent::monomial((-1, -1), ratio(1, 1))
}

/// The polynomial turned by 60 degrees, `e1 -> e2 -> e3`.
fn turned(polynomial: &Laurent) -> Laurent {
    polynomial
        .terms()
        .fold(Laurent::zero(), |sum, ((x, y), value)| &sum + &Laurent::monomial((-y, x + y), value))
}

#[test]
fn laurent_polynomials_are_a_ring() {
    let a = &Laurent::monomial((1, 0), ratio(1, 2)) + &Laurent::constant(ratio(1, 3));
    let b = &Laurent::monomial((-1, 2), ratio(3, 1)) + &Laurent::constant(ratio(-1, 1));
    let product = &a * &b;
    let terms: Vec<_> = product.terms().collect();
    assert_eq!(
        terms,
        [((-1, 2), ratio(1, 1)), ((0, 0), ratio(-1, 3)), ((0, 2), ratio(3, 2)), ((1, 0), ratio(-1, 2))]
    );
    assert_eq!(product, &b * &a);
    assert_eq!(&(&a + &b) * &b, &product + &(&b * &b));
    assert_eq!(product.coefficient(0, 2), ratio(3, 2));
    assert_eq!(product.coefficient(5, 5), ratio(0, 1));
    assert_eq!(&a + &a.scale(ratio(-1, 1)), Laurent::zero());
    assert_eq!(Laurent::sum(&[(0, 0), (0, 0)], ratio(1, 2)), Laurent::constant(ratio(1, 1)));
    assert_eq!(Laurent::constant(ratio(0, 1)), Laurent::<Position>::zero());
}

#[test]
fn every_scheme_commutes_with_the_derivative() {
    for lattice in [Triangles, Quads] {
        let (d0, d1) = (exterior_derivative(lattice, 0), exterior_derivative(lattice, 1));
        let dd = &d1 * &d0;
        assert!((0..dd.shape().0).all(|i| *dd.entry(i, 0) == Laurent::zero()));
        for scheme in [whitney, smooth] {
            let [s0, s1, s2] = [0, 1, 2].map(|r| scheme(lattice, r));
            assert_eq!(&d0 * &s0, &s1 * &d0.at_square());
            assert_eq!(&d1 * &s1, &s2 * &d1.at_square());
            // Not with the derivative at z on both sides, as (3.58) is printed.
            assert_ne!(&d0 * &s0, &s1 * &d0);
        }
    }
}

#[test]
fn constants_and_fluxes_are_kept() {
    for lattice in [Triangles, Quads] {
        assert_eq!(all_ones(&smoothing(lattice)), ratio(1, 1));
        for scheme in [whitney, smooth] {
            for p in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                assert_eq!(row(&scheme(lattice, 0), 0, p).values().sum::<Rational>(), ratio(1, 1));
            }
            let s2 = scheme(lattice, 2);
            for j in 0..s2.shape().1 {
                let column: Rational = (0..s2.shape().0).map(|i| all_ones(s2.entry(i, j))).sum();
                assert_eq!(column, ratio(1, 1));
            }
        }
    }
}

#[test]
fn whitney_rows() {
    for i in 0..6 {
        let w = fan((0, 0), i);
        let s1 = whitney(Triangles, 1);
        assert_eq!(edge_row(&s1, Triangles, (0, 0), w[0]), chain(Triangles, 2, &[((0, 0), w[0], 1)]));
        let odd = [(w[0], w[1], 1), ((0, 0), w[1], 1), ((0, 0), w[0], -1)];
        assert_eq!(edge_row(&s1, Triangles, w[0], w[1]), chain(Triangles, 4, &odd));
        let corner = triangle([(0, 0), w[0], w[1]]);
        let centre = triangle([w[0], w[1], add(w[0], w[1])]);
        for (child, p) in [corner, centre] {
            assert_eq!(row(&whitney(Triangles, 2), child, p), Row::from([(corner, ratio(1, 4))]));
        }
    }
}

#[test]
fn triangle_vertices_are_loop() {
    let s0 = smooth(Triangles, 0);
    // Away from the origin too, and at a negative position.
    for v in [(0, 0), (3, -2)] {
        let mut even = cells(16, &fan(v, 0).map(|w| (0, w, 1)));
        even.insert((0, v), ratio(5, 8));
        assert_eq!(row(&s0, 0, add(v, v)), even);
        for i in 0..6 {
            let w = fan(v, i);
            let odd = [(0, v, 3), (0, w[0], 3), (0, w[1], 1), (0, w[5], 1)];
            assert_eq!(row(&s0, 0, add(v, w[0])), cells(8, &odd));
        }
    }
}

#[test]
fn triangle_edges() {
    let s1 = smooth(Triangles, 1);
    let v = (2, -1);
    for i in 0..6 {
        let w = fan(v, i);
        let (spokes, rims) = ([8, 2, -1, -2, -1, 2], [-1, -1, 0, 0, 1, 1]);
        let even: Vec<_> =
            (0..6).flat_map(|j| [(v, w[j], spokes[j]), (w[j], w[(j + 1) % 6], rims[j])]).collect();
        assert_eq!(edge_row(&s1, Triangles, add(v, v), add(v, w[0])), chain(Triangles, 32, &even));

        let odd = [
            (w[0], w[1], 6),
            (v, w[1], 3),
            (v, w[0], -3),
            (v, w[2], 3),
            (v, w[5], -3),
            (w[1], w[2], 1),
            (w[5], w[0], 1),
        ];
        assert_eq!(edge_row(&s1, Triangles, add(v, w[0]), add(v, w[1])), chain(Triangles, 32, &odd));
    }
}

#[test]
fn triangle_faces_are_half_box() {
    let s2 = smooth(Triangles, 2);
    let v = (-1, 4);
    for i in 0..6 {
        let w = fan(v, i);
        let faces: [_; 6] = std::array::from_fn(|j| triangle([v, w[j], w[(j + 1) % 6]]));
        let weights = [4, 1, 1, 0, 1, 1];
        let corner: Row =
            (0..6).filter(|&j| weights[j] != 0).map(|j| (faces[j], ratio(weights[j], 32))).collect();
        let (child, p) = triangle([add(v, v), add(v, w[0]), add(v, w[1])]);
        assert_eq!(row(&s2, child, p), corner);

        let beyond = (w[0].0 + w[1].0 - v.0, w[0].1 + w[1].1 - v.1);
        let across = triangle([w[0], beyond, w[1]]);
        let centre = [faces[0], faces[1], faces[5], across].map(|face| (face, ratio(2, 32)));
        let (child, p) = triangle([add(v, w[0]), add(w[0], w[1]), add(v, w[1])]);
        assert_eq!(row(&s2, child, p), Row::from(centre));
    }
}

#[test]
fn quad_vertices_are_bicubic() {
    let s0 = smooth(Quads, 0);
    let even: Vec<_> = (-1i32..=1)
        .flat_map(|x| (-1i32..=1).map(move |y| (0, (x, y), [36, 6, 1][(x.abs() + y.abs()) as usize])))
        .collect();
    assert_eq!(row(&s0, 0, (0, 0)), cells(64, &even));
    let odd =
        [(0, (0, 0), 6), (0, (1, 0), 6), (0, (0, 1), 1), (0, (1, 1), 1), (0, (0, -1), 1), (0, (1, -1), 1)];
    assert_eq!(row(&s0, 0, (1, 0)), cells(16, &odd));
    assert_eq!(row(&s0, 0, (0, 1)), cells(16, &odd.map(|(j, (x, y), n)| (j, (y, x), n))));
    let centre = [(0, (0, 0), 1), (0, (1, 0), 1), (0, (0, 1), 1), (0, (1, 1), 1)];
    assert_eq!(row(&s0, 0, (1, 1)), cells(4, &centre));
}

#[test]
fn quad_edges() {
    let s1 = smooth(Quads, 1);
    for i in 0..2 {
        let along = |x, y| if i == 0 { (x, y) } else { (y, x) };
        // Of the two halves of an edge the first also takes from the edge behind it, the second from
        // the edge ahead; the same for the two odd edges across a face.
        for (half, next) in [(0, -1), (1, 1)] {
            let even = [(0, 0, 18), (next, 0, 6), (0, 1, 3), (0, -1, 3), (next, 1, 1), (next, -1, 1)];
            let odd = [(0, 0, 12), (0, 1, 12), (next, 0, 4), (next, 1, 4)];
            assert_eq!(row(&s1, i, along(half, 0)), cells(64, &even.map(|(x, y, n)| (i, along(x, y), n))));
            assert_eq!(row(&s1, i, along(half, 1)), cells(64, &odd.map(|(x, y, n)| (i, along(x, y), n))));
        }
    }
}

#[test]
fn quad_faces_are_biquadratic() {
    let s2 = smooth(Quads, 2);
    for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let (a, b) = (2 * x - 1, 2 * y - 1);
        let weights = [(0, (0, 0), 9), (0, (a, 0), 3), (0, (0, b), 3), (0, (a, b), 1)];
        assert_eq!(row(&s2, 0, (x, y)), cells(64, &weights));
    }
}

#[test]
fn the_kernel_as_printed_is_not_hexagonal() {
    let (kernel, printed) = (smoothing(Triangles), printed_kernel());
    assert_eq!(turned(&kernel), kernel);
    assert_ne!(turned(&printed), printed);

    // It commutes all the same, as any kernel does: only the rows show the error.
    let [s0, s1, s2] = [0, 1, 2].map(|r| whitney(Triangles, r).convolve(&printed));
    let (d0, d1) = (exterior_derivative(Triangles, 0), exterior_derivative(Triangles, 1));
    assert_eq!(&d0 * &s0, &s1 * &d0.at_square());
    assert_eq!(&d1 * &s1, &s2 * &d1.at_square());
    // Two of the six neighbours drop out, and Loop's 5/8 is 1/2.
    let even = [(0, (0, 0), 4), (0, (1, 0), 1), (0, (0, 1), 1), (0, (-1, 0), 1), (0, (0, -1), 1)];
    assert_eq!(row(&s0, 0, (0, 0)), cells(8, &even));
}
