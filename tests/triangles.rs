//! The weights of the triangle schemes, entry by entry.
//!
//! Regular rows are those of the symbols (box-spline convolution, exact rationals). Rows round irregular
//! and boundary vertices are (4.4) to (4.13) and Appendix B of Ke Wang's thesis, written as sums of face
//! weights: with `beta` those of (4.2), `gamma_j` the weight of rim `w_j -> w_{j+1}` and `sigma_j` that of
//! spoke `v -> w_j` in the even child edge `v -> m(v, w_0)`. As printed, (4.5) must start at `j = 1` and (4.10)
//! must read `sigma_j = sigma_{n-j}`.

mod common;

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use approx::assert_abs_diff_eq;
use common::meshes::{bipyramid, hexagonal_torus, polygons, triangle_fan};
use common::step::{Step, WEIGHT, assert_blended, assert_row};
use common::{assert_laws, triangle_schemes};
use formwork::scheme::half_box::{corner_matrix, weights};
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::symbol::{Lattice, Symbol, smooth, whitney};
use formwork::topology::{Cage, Crease, Descriptor, Parent};

const RULES: [BoundaryRule; 3] = [BoundaryRule::Reflect, BoundaryRule::Thesis, BoundaryRule::Dct];

fn loop_(variant: Variant) -> Scheme {
    Scheme::Loop(variant, BoundaryRule::default())
}

/// A row as a sum of directed edges: opposite directions cancel.
#[derive(Default)]
struct Chain(BTreeMap<(u32, u32), f64>);

impl Chain {
    fn add(&mut self, a: u32, b: u32, weight: f64) {
        let (key, sign) = if a < b { ((a, b), 1.0) } else { ((b, a), -1.0) };
        *self.0.entry(key).or_insert(0.0) += sign * weight;
    }

    fn assert_is(&self, row: &BTreeMap<(u32, u32), f64>) {
        let mut actual = Chain::default();
        row.iter().for_each(|(&(a, b), &weight)| actual.add(a, b, weight));
        for key in self.0.keys().chain(actual.0.keys()) {
            let at = |chain: &Chain| chain.0.get(key).copied().unwrap_or(0.0);
            assert_abs_diff_eq!(at(self), at(&actual), epsilon = WEIGHT);
        }
    }
}

// The torus: vertex (i, j) is i + 8 j; cells are cut from (i + 1, j) to (i, j + 1), so that the edges run
// along (1, 0), (0, 1) and (-1, 1), as those of the symbols.

fn at((i, j): (i32, i32)) -> u32 {
    (i.rem_euclid(8) + 8 * j.rem_euclid(8)) as u32
}

const DIRECTIONS: [(i32, i32); 3] = [(1, 0), (0, 1), (-1, 1)];

fn plus(p: (i32, i32), q: (i32, i32)) -> (i32, i32) {
    (p.0 + q.0, p.1 + q.1)
}

/// The cell of the torus whose child lies at a position of the fine lattice.
fn fine_vertex(step: &Step, (i, j): (i32, i32)) -> Parent {
    let floor = (i.div_euclid(2), j.div_euclid(2));
    let other = match (i.rem_euclid(2), j.rem_euclid(2)) {
        (0, 0) => return Parent::Vertex(at(floor)),
        (1, 0) => (floor, plus(floor, (1, 0))),
        (0, 1) => (floor, plus(floor, (0, 1))),
        _ => (plus(floor, (1, 0)), plus(floor, (0, 1))),
    };
    Parent::Edge(step.edge(at(other.0), at(other.1)).edge())
}

fn as_f64(weight: formwork::symbol::Rational) -> f64 {
    *weight.numer() as f64 / *weight.denom() as f64
}

fn assert_rows_are_the_symbols(step: &Step, symbols: [Symbol; 3]) {
    // All classes of fine positions modulo 2.
    for p in [(0, 0), (1, 0), (0, 1), (1, 1)].map(|p| plus(p, (6, 6))) {
        let terms = symbols[0].stencil(0, p).into_iter().map(|(_, q, w)| (at(q), as_f64(w)));
        assert_row(&step.s0(fine_vertex(step, p)), &terms.collect::<Vec<_>>());

        for (i, &direction) in DIRECTIONS.iter().enumerate() {
            let row = step.s1(fine_vertex(step, p), fine_vertex(step, plus(p, direction)));
            let mut chain = Chain::default();
            for (j, q, w) in symbols[1].stencil(i, p) {
                chain.add(at(q), at(plus(q, DIRECTIONS[j])), as_f64(w));
            }
            chain.assert_is(&row);
        }

        for up in [true, false] {
            let corners = |p, up| {
                if up {
                    [p, plus(p, (1, 0)), plus(p, (0, 1))]
                } else {
                    [plus(p, (1, 0)), plus(p, (1, 1)), plus(p, (0, 1))]
                }
            };
            let split = step.hierarchy.refinement(1).split();
            let vertices = corners(p, up).map(|q| split.vertex_of(fine_vertex(step, q)));
            let child = step.hierarchy.level(1).mesh();
            let h = child.find_half_edge(vertices[0], vertices[1]).unwrap();
            let fine = child.corner_face(child.left_corner(h).unwrap());
            // Coarse face (i, j): the torus lists the upward one of each cell, then the downward one.
            let face = |(j, q): (usize, (i32, i32))| 2 * at(q) + j as u32;
            let terms = symbols[2]
                .stencil(usize::from(!up), p)
                .into_iter()
                .map(|(j, q, w)| (face((j, q)), as_f64(w)));
            assert_row(&step.s2_row(fine), &terms.collect::<Vec<_>>());
        }
    }
}

#[test]
fn regular_rows_are_those_of_the_symbols() {
    let torus = hexagonal_torus(8, 8);
    let lattice = Lattice::Triangles;
    for scheme in triangle_schemes() {
        let step = Step::new(torus.clone(), scheme);
        let symbol = |r| if scheme == Scheme::Whitney { whitney(lattice, r) } else { smooth(lattice, r) };
        assert_rows_are_the_symbols(&step, [symbol(0), symbol(1), symbol(2)]);
    }
}

fn eps(n: usize) -> f64 {
    0.125 - (TAU / n as f64).cos() / 4.0
}

/// The weight of each neighbour in the vertex rule, and `eps` of a smooth vertex of valence `n`.
fn vertex_rule(variant: Variant, n: usize) -> (f64, f64) {
    let m = n as f64;
    match variant {
        Variant::Loop => ((0.625 - (0.375 + (TAU / m).cos() / 4.0).powi(2)) / m, 0.0),
        Variant::ModifiedLoop => ((3.0 + 8.0 * eps(n)) / (8.0 * m), eps(n)),
    }
}

#[test]
fn irregular_vertices_follow_chapter_4() {
    for variant in [Variant::Loop, Variant::ModifiedLoop] {
        for n in 3..=12usize {
            let step = Step::new(triangle_fan(n as u32, true), loop_(variant));
            let (alpha, eps_v) = vertex_rule(variant, n);
            // The rim is a boundary of two triangles a vertex, where cos(pi / 2) = 0.
            let eps_w = if variant == Variant::Loop { 0.0 } else { 0.125 };
            let delta = eps_v - eps_w;
            let w = |j: usize| 1 + (j % n) as u32;

            let spokes: Vec<_> = (0..n).map(|j| (w(j), alpha)).collect();
            assert_row(&step.s0(Parent::Vertex(0)), &[spokes, vec![(0, 1.0 - n as f64 * alpha)]].concat());

            let beta = weights(n);
            let gamma: Vec<f64> = (0..n)
                .map(|j| {
                    let upper = |j: usize| match j {
                        0 => -3.0 / 32.0 + beta[0] / 8.0,
                        j => -1.0 / 8.0 + beta[0] / 8.0 + beta[1..=j].iter().sum::<f64>() / 4.0,
                    };
                    if j <= (n - 1) / 2 { upper(j) } else { -upper(n - 1 - j) }
                })
                .collect();
            for i in 0..n {
                let mut even = Chain::default();
                for j in 0..n {
                    let beside = if j == 1 || j == n - 1 { 0.125 } else { 0.0 };
                    let own = if j == 0 { 0.375 + delta } else { 0.0 };
                    let sigma = gamma[j] - gamma[(j + n - 1) % n] - alpha + own + beside;
                    even.add(0, w(i + j), sigma);
                    even.add(w(i + j), w(i + j + 1), gamma[j]);
                }
                even.assert_is(&step.even(0, w(i)));

                // (4.11) to (4.13): theta, eta and xi are these weights where the neighbours are regular.
                let (w0, w1, x1, x0) = (w(i), w(i + 1), w(i + 2), w(i + n - 1));
                let mut odd = Chain::default();
                odd.add(w0, w1, 3.0 / 16.0);
                odd.add(0, w1, 3.0 / 32.0 + delta);
                odd.add(0, w0, -3.0 / 32.0 - delta);
                odd.add(0, x1, 3.0 / 32.0);
                odd.add(0, x0, -3.0 / 32.0);
                odd.add(w1, x1, 1.0 / 32.0);
                odd.add(w0, x0, -1.0 / 32.0);
                odd.assert_is(&step.across(0, w0, w1));

                // Cutting off the corner at the rim: one edge there is a boundary.
                let mut odd = Chain::default();
                odd.add(w1, 0, 7.0 / 32.0);
                odd.add(w0, w1, -5.0 / 32.0);
                odd.add(w0, 0, 3.0 / 16.0 - delta);
                odd.add(w0, x0, 3.0 / 32.0);
                odd.add(0, x0, 1.0 / 32.0);
                odd.assert_is(&step.across(w0, w1, 0));

                let face = |j: usize| ((i + j) % n) as u32;
                assert_row(
                    &step.s2(i as u32, 0),
                    &(0..n).map(|j| (face(j), beta[j] / 4.0)).collect::<Vec<_>>(),
                );
                // The middle child: two smooth edges.
                let middle = [(face(0), 0.125), (face(1), 0.0625), (face(n - 1), 0.0625)];
                assert_row(&step.s2_row(4 * i as u32 + 3), &middle);
            }
        }
    }
}

/// (4.2), (4.3): the weights of the faces are those whose circulant has the eigenvalues `2^-min(m, n-m)`.
#[test]
fn half_box_weights_have_their_eigenvalues() {
    assert_eq!(weights(6).iter().map(|b| (b * 8.0).round()).collect::<Vec<_>>(), [4., 1., 1., 0., 1., 1.]);
    for n in 1..=40usize {
        let beta = weights(n);
        for m in 0..n {
            let sum: f64 = (0..n).map(|j| beta[j] * (TAU * (m * j % n) as f64 / n as f64).cos()).sum();
            let expected = if (n, m) == (6, 3) { 0.5 } else { 0.5f64.powi(m.min(n - m) as i32) };
            assert_abs_diff_eq!(sum, expected, epsilon = 1e-14);
        }
    }
}

/// Appendix B: the matrices of the boundary rules.
#[test]
fn boundary_matrices_are_appendix_b() {
    let rows = |rule, k: usize| corner_matrix(rule, k).unwrap();
    let three: Vec<f64> = [4., 1., 1., 1., 4., 1., 1., 1., 4.].iter().map(|x| x / 6.0).collect();
    let five = [
        [2. / 3., 1. / 6., 1. / 6., 0., 0.],
        [5. / 24., 7. / 12., 1. / 12., 1. / 8., 0.],
        [1. / 8., 1. / 8., 1. / 2., 1. / 8., 1. / 8.],
        [0., 1. / 8., 1. / 12., 7. / 12., 5. / 24.],
        [0., 0., 1. / 6., 1. / 6., 2. / 3.],
    ];
    let close = |a: &[f64], b: &[f64]| {
        a.iter().zip(b).for_each(|(a, b)| assert_abs_diff_eq!(*a, *b, epsilon = WEIGHT))
    };
    close(&rows(BoundaryRule::Thesis, 5), &five.concat());
    for rule in [BoundaryRule::Thesis, BoundaryRule::Dct] {
        close(&rows(rule, 1), &[1.0]);
        close(&rows(rule, 2), &[0.75, 0.25, 0.25, 0.75]);
        close(&rows(rule, 3), &three);
        for k in 1..=12 {
            let matrix = rows(rule, k);
            for i in 0..k {
                assert_abs_diff_eq!(matrix[i * k..][..k].iter().sum::<f64>(), 1.0, epsilon = 1e-14);
                assert_abs_diff_eq!((0..k).map(|j| matrix[j * k + i]).sum::<f64>(), 1.0, epsilon = 1e-14);
            }
        }
    }
    // The cosines are eigenvectors.
    for k in 2..=12usize {
        let matrix = rows(BoundaryRule::Dct, k);
        let wave = |m: usize, i: usize| (PI * m as f64 * (i as f64 + 0.5) / k as f64).cos();
        for m in 0..k {
            let eigenvalue = [1.0, 0.5, 0.5].get(m).copied().unwrap_or(0.5f64.powi(m as i32 - 1));
            for i in 0..k {
                let product: f64 = (0..k).map(|j| matrix[i * k + j] * wave(m, j)).sum();
                assert_abs_diff_eq!(product, eigenvalue * wave(m, i), epsilon = 1e-14);
            }
        }
    }
}

/// What each rule wants of a boundary fan of `k` triangles, as a matrix.
fn boundary_matrix(rule: BoundaryRule, k: usize) -> Vec<f64> {
    corner_matrix(rule, k).unwrap_or_else(|| {
        let beta = weights(2 * k);
        (0..k * k)
            .map(|ij| (ij / k, ij % k))
            .map(|(i, j)| beta[(2 * k + i - j) % (2 * k)] + beta[(i + j + 1) % (2 * k)])
            .collect()
    })
}

#[test]
fn boundary_rows_follow_appendix_b() {
    for (variant, rule) in
        [Variant::Loop, Variant::ModifiedLoop].into_iter().flat_map(|v| RULES.map(|r| (v, r)))
    {
        for k in 1..=8usize {
            let step = Step::new(triangle_fan(k as u32, false), Scheme::Loop(variant, rule));
            let w = |j: usize| 1 + j as u32;
            let matrix = boundary_matrix(rule, k);
            for i in 0..k {
                let row: Vec<_> = (0..k)
                    .map(|j| (j as u32, matrix[i * k + j] / 4.0))
                    .filter(|(_, w)| w.abs() > WEIGHT)
                    .collect();
                assert_row(&step.s2(i as u32, 0), &row);
                let neighbours: Vec<u32> = [i.checked_sub(1), Some(i + 1).filter(|&j| j < k)]
                    .into_iter()
                    .flatten()
                    .map(|j| j as u32)
                    .collect();
                let own = (1.0 - neighbours.len() as f64 / 4.0) / 4.0;
                let middle: Vec<_> =
                    neighbours.iter().map(|&j| (j, 1.0 / 16.0)).chain([(i as u32, own)]).collect();
                assert_row(&step.s2_row(4 * i as u32 + 3), &middle);
            }

            assert_row(&step.even(0, w(0)), &[((0, w(0)), 0.375), ((w(k), 0), 0.125)]);
            assert_row(&step.even(0, w(k)), &[((0, w(k)), 0.375), ((w(0), 0), 0.125)]);
            for s in 1..k {
                let rho = |j: isize| {
                    if j < 0 || j >= k as isize {
                        return 0.0;
                    }
                    let j = j as usize;
                    let sum: f64 = (0..s).map(|i| f64::from(i == j) - matrix[i * k + j]).sum();
                    sum / 4.0 + (f64::from(j == s) - f64::from(j + 1 == s)) / 32.0
                };
                let biermann = |k: usize| 0.125 - (PI / k as f64).cos() / 4.0;
                let delta = if variant == Variant::Loop { 0.0 } else { biermann(k) - biermann(2) };
                let mut even = Chain::default();
                for j in 0..=k {
                    let end = if j == 0 || j == k { 0.125 } else { 0.0 };
                    let own = if j == s { 0.375 + delta } else { 0.0 };
                    let beside = if j + 1 == s || j == s + 1 { 0.125 } else { 0.0 };
                    even.add(0, w(j), rho(j as isize) - rho(j as isize - 1) - end + own + beside);
                    if j < k {
                        even.add(w(j), w(j + 1), rho(j as isize));
                    }
                }
                even.assert_is(&step.even(0, w(s)));
            }
        }
    }
}

/// A crease is a boundary from both sides, sector by sector, and OpenSubdiv's blending is followed.
#[test]
fn creases_are_boundaries_and_fractional_ones_blend() {
    let n = 6u32;
    let creased = |sharpness| {
        let creases = [1, 4].map(|w| Crease { vertices: [0, w], sharpness }).into();
        Descriptor { creases, ..triangle_fan(n, true) }
    };
    for (variant, rule) in
        [Variant::Loop, Variant::ModifiedLoop].into_iter().flat_map(|v| RULES.map(|r| (v, r)))
    {
        let [blended, sharp, smooth] =
            [0.3, 10.0, 0.0].map(|s| Step::new(creased(s), Scheme::Loop(variant, rule)));
        let matrix = boundary_matrix(rule, 3);
        for i in 0..3u32 {
            let row: Vec<_> = (0..3).map(|j| (j, matrix[(3 * i + j) as usize] / 4.0)).collect();
            assert_row(
                &sharp.s2(i, 0),
                &row.iter().copied().filter(|(_, w)| w.abs() > WEIGHT).collect::<Vec<_>>(),
            );
        }
        assert_row(&sharp.even(0, 1), &[((0, 1), 0.375), ((4, 0), 0.125)]);
        assert_blended(&blended, f64::from(0.3f32), &sharp, &smooth);
    }
}

#[test]
fn laws_hold_on_small_and_irregular_meshes() {
    let annulus: Vec<Vec<u32>> = (0..5u32)
        .flat_map(|i| [vec![i, (i + 1) % 5, 5 + i], vec![5 + i, (i + 1) % 5, 5 + (i + 1) % 5]])
        .collect();
    let mut meshes = vec![("triangle", polygons(3, &[vec![0, 1, 2]])), ("annulus", polygons(10, &annulus))];
    meshes.extend((1..=6).map(|k| ("open fan", triangle_fan(k, false))));
    meshes.extend((3..=12).flat_map(|k| [("fan", triangle_fan(k, true)), ("bipyramid", bipyramid(k))]));
    let creases = (2..7).map(|w| Crease { vertices: [0, w], sharpness: w as f32 / 2.0 }).collect();
    meshes.push(("creased bipyramid", Descriptor { creases, ..bipyramid(5) }));
    meshes.push(("torus", hexagonal_torus(4, 4)));
    for (name, descriptor) in meshes {
        let cage = Cage::new(descriptor).unwrap();
        for scheme in triangle_schemes() {
            assert_laws(name, &cage, scheme, 2);
        }
    }
}
