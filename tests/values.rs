//! The weights themselves, entry by entry, from sources other than the code.
//!
//! Commutation holds for any homotopy, so a wrong weight is a defect of smoothness that no commutation
//! test sees. The numbers here are those of tensor-product B-splines (regular, boundary and crease rows)
//! and of Appendix C of Ke Wang's thesis (extraordinary vertices).

mod common;

use approx::assert_abs_diff_eq;
use common::meshes::{fan, grid, polygons};
use common::step::{Step, WEIGHT, assert_blended, assert_row};
use formwork::scheme::{DooSabin, Scheme};
use formwork::symbol::{Lattice, Rational, smooth};
use formwork::topology::{BoundaryInterpolation, Crease, Descriptor, Parent, TriangleSubdivision};

fn catmark(descriptor: Descriptor, weights: DooSabin) -> Step {
    Step::new(descriptor, Scheme::Catmark(weights))
}

/// Both choices of face weights are regular where the mesh is.
fn both(descriptor: &Descriptor) -> [Step; 2] {
    [DooSabin::Thesis, DooSabin::Original].map(|weights| catmark(descriptor.clone(), weights))
}

/// The vertex of a 8 x 8 torus at `(3 + i, 3 + j)`.
fn v(i: i32, j: i32) -> u32 {
    ((3 + i) + 8 * (3 + j)) as u32
}

/// The face of that torus whose lower left vertex is `v(i, j)`.
fn f(i: i32, j: i32) -> u32 {
    v(i, j)
}

#[test]
fn regular_rows_are_those_of_cubic_and_quadratic_splines() {
    for step in both(&grid(8, 8, true)) {
        let row = step.even(v(0, 0), v(1, 0));
        let x = |i, j| (v(i, j), v(i + 1, j));
        let expected =
            [(x(0, 0), 18.), (x(-1, 0), 6.), (x(0, 1), 3.), (x(0, -1), 3.), (x(-1, 1), 1.), (x(-1, -1), 1.)];
        assert_row(&row, &expected.map(|(e, w)| (e, w / 64.0)));

        let row = step.odd(v(0, 0), v(1, 0));
        let y = |i, j| (v(i, j), v(i, j + 1));
        let expected = [(y(0, 0), 12.), (y(1, 0), 12.), (y(0, -1), 4.), (y(1, -1), 4.)];
        assert_row(&row, &expected.map(|(e, w)| (e, w / 64.0)));

        let row = step.s2(f(0, 0), v(0, 0));
        let expected = [(f(0, 0), 9.), (f(-1, 0), 3.), (f(0, -1), 3.), (f(-1, -1), 1.)];
        assert_row(&row, &expected.map(|(e, w)| (e, w / 64.0)));
    }
}

/// Appendix C, all quads: `sigma_m` on spoke `m`, `xi_m` on `w_m -> q_m`, `eta_m` on `w_{m+1} -> q_m`.
#[test]
fn extraordinary_vertices_follow_appendix_c() {
    for k in 3..=12usize {
        let n = k as f64;
        let (beta, gamma) = (3.0 / (2.0 * n), 1.0 / (4.0 * n));
        let (alpha0, alpha1, alpha2) = (0.5 + gamma, 0.125 + gamma, gamma);
        let mut xi = vec![-1.0 / 16.0 - gamma / (2.0 * n) + alpha0 / 8.0];
        for m in 1..k {
            xi.push(match m {
                1 => xi[0] - 1.0 / 16.0 + alpha1 / 4.0,
                m if m == k - 1 => xi[m - 1] + alpha1 / 4.0,
                m => xi[m - 1] + alpha2 / 4.0,
            });
        }
        let sigma = |m: usize| {
            -beta / n
                + match m {
                    0 => 3.0 / 8.0 + 2.0 * xi[0],
                    m if m == 1 || m == k - 1 => 1.0 / 16.0 + xi[1] + xi[k - 1],
                    m => xi[m] + xi[k - m],
                }
        };
        let step = catmark(fan(&vec![4; k]), DooSabin::Thesis);
        let w = |m: usize| 1 + (m % k) as u32;
        let q = |m: usize| (1 + k + m % k) as u32;
        for spoke in 0..k {
            let row = step.even(0, w(spoke));
            let at = |a: u32, b: u32| {
                row.get(&(a, b)).copied().unwrap_or(0.0) - row.get(&(b, a)).copied().unwrap_or(0.0)
            };
            for m in 0..k {
                assert_abs_diff_eq!(at(0, w(spoke + m)), sigma(m), epsilon = WEIGHT);
                assert_abs_diff_eq!(at(w(spoke + m), q(spoke + m)), xi[m], epsilon = WEIGHT);
                assert_abs_diff_eq!(at(w(spoke + m + 1), q(spoke + m)), xi[k - 1 - m], epsilon = WEIGHT);
            }
            assert!(row.len() <= 3 * k);
            let row = step.s2(spoke as u32, 0);
            let alpha = |m: usize| match m {
                0 => alpha0,
                m if m == 1 || m == k - 1 => alpha1,
                _ => alpha2,
            };
            assert_row(&row, &(0..k).map(|m| (((spoke + m) % k) as u32, alpha(m) / 4.0)).collect::<Vec<_>>());
        }
    }
}

#[test]
fn doo_and_sabins_own_weights_are_an_option() {
    for k in 3..=12usize {
        let step = catmark(fan(&vec![4; k]), DooSabin::Original);
        let alpha = |j: usize| {
            let turn = std::f64::consts::TAU * j as f64 / k as f64;
            if j == 0 {
                (k as f64 + 5.0) / (4.0 * k as f64)
            } else {
                (3.0 + 2.0 * turn.cos()) / (4.0 * k as f64)
            }
        };
        let row = step.s2(2, 0);
        assert_row(&row, &(0..k).map(|j| (((2 + j) % k) as u32, alpha(j) / 4.0)).collect::<Vec<_>>());
    }
}

/// Densities, not totals, are averaged: face `j` of `n_j` vertices counts by `alpha_j / n_j`.
#[test]
fn polygons_share_by_their_number_of_corners() {
    let sizes = [3, 4, 5, 6, 4];
    let step = catmark(fan(&sizes), DooSabin::Thesis);
    let gamma = 1.0 / 20.0;
    let alpha = [0.5 + gamma, 0.125 + gamma, gamma, gamma, 0.125 + gamma];
    let row = step.s2(2, 0);
    let expected: Vec<_> =
        (0..5).map(|j| (2 + j) % 5).map(|i| (i as u32, alpha[(i + 3) % 5] / f64::from(sizes[i]))).collect();
    assert_row(&row, &expected);

    // A lone pentagon: no face beyond its edges, so the odd child is the Whitney lift, (n - 2t)/(2n).
    let step = catmark(polygons(5, &[vec![0, 1, 2, 3, 4]]), DooSabin::Thesis);
    assert_row(&step.odd(0, 1), &[((1, 2), 0.3), ((2, 3), 0.1), ((4, 3), 0.1), ((0, 4), 0.3)]);
}

#[test]
fn boundary_rows_are_splines_reflected_evenly() {
    for boundary in
        [BoundaryInterpolation::EdgeOnly, BoundaryInterpolation::EdgeAndCorner, BoundaryInterpolation::None]
    {
        for step in both(&Descriptor { boundary, ..grid(5, 5, false) }) {
            // Columns of six vertices; the boundary runs along the bottom row.
            let (left, here, right, up) = (1, 2, 3, 8);
            assert_row(&step.even(here, right), &[((here, right), 3.0 / 8.0), ((left, here), 1.0 / 8.0)]);
            // Across the boundary the phantom row repeats the first: 18 + 6, 3 + 1, 3 + 1.
            let across = [((here, up), 24.0), ((left, up - 1), 4.0), ((right, up + 1), 4.0)];
            assert_row(&step.even(here, up), &across.map(|(e, w)| (e, w / 64.0)));
            assert_row(&step.odd(here, right), &[((here, up), 0.25), ((right, up + 1), 0.25)]);
            // Side children of the boundary faces, and the child in the corner.
            assert_row(&step.s2(2, here), &[(2, 3.0 / 16.0), (1, 1.0 / 16.0)]);
            assert_row(&step.s2(0, 0), &[(0, 0.25)]);
            assert_row(
                &step.s2(2, up),
                &[9., 3., 3., 1.].iter().zip([2, 1, 7, 6]).map(|(w, f)| (f, w / 64.0)).collect::<Vec<_>>(),
            );
        }
    }
}

/// At the boundary vertex of the corner face, `EdgeOnly` rounds and `EdgeAndCorner` keeps.
#[test]
fn corners_keep_half_of_their_edges() {
    let corner = |boundary| catmark(Descriptor { boundary, ..grid(3, 3, false) }, DooSabin::Thesis);
    assert_row(&corner(BoundaryInterpolation::EdgeAndCorner).even(0, 1), &[((0, 1), 0.5)]);
    assert_row(
        &corner(BoundaryInterpolation::EdgeOnly).even(0, 1),
        &[((0, 1), 3.0 / 8.0), ((4, 0), 1.0 / 8.0)],
    );
}

fn creased_torus(sharpness: f32) -> Descriptor {
    // A closed crease along the row of v(0, 0).
    let creases = (0..8).map(|i| Crease { vertices: [24 + i, 24 + (i + 1) % 8], sharpness }).collect();
    Descriptor { creases, ..grid(8, 8, true) }
}

#[test]
fn creases_are_boundaries_from_both_sides() {
    for step in both(&creased_torus(10.0)) {
        assert_row(
            &step.even(v(0, 0), v(1, 0)),
            &[((v(0, 0), v(1, 0)), 0.375), ((v(-1, 0), v(0, 0)), 0.125)],
        );
        for up in [1, -1] {
            let across = [(0, 24.0), (-1, 4.0), (1, 4.0)].map(|(i, w)| ((v(i, 0), v(i, up)), w / 64.0));
            assert_row(&step.even(v(0, 0), v(0, up)), &across);
        }
        assert_row(&step.s2(f(0, 0), v(0, 0)), &[(f(0, 0), 3.0 / 16.0), (f(-1, 0), 1.0 / 16.0)]);
        assert_row(&step.s2(f(0, -1), v(0, 0)), &[(f(0, -1), 3.0 / 16.0), (f(-1, -1), 1.0 / 16.0)]);
    }
}

/// OpenSubdiv blends the rules of a crease that decays within the step; so do S1 and S2, entry by entry.
#[test]
fn fractional_creases_blend_linearly() {
    let [blended, sharp, smooth] = [0.3, 10.0, 0.0].map(|s| catmark(creased_torus(s), DooSabin::Thesis));
    assert_blended(&blended, f64::from(0.3f32), &sharp, &smooth);
}

/// At a dart the vertex rule is smooth although one spoke is sharp: the child faces beside that spoke lose
/// what its midpoint no longer hands across, 2/64.
#[test]
fn darts_are_smooth_vertices_with_one_sharp_edge() {
    let mut descriptor = grid(8, 8, true);
    descriptor.creases.push(Crease { vertices: [v(0, 0), v(1, 0)], sharpness: 10.0 });
    for step in both(&descriptor) {
        let expected = [(f(0, 0), 11.), (f(0, -1), 1.), (f(-1, 0), 3.), (f(-1, -1), 1.)];
        assert_row(&step.s2(f(0, 0), v(0, 0)), &expected.map(|(e, w)| (e, w / 64.0)));
        let expected = [(f(-1, 0), 9.), (f(0, 0), 3.), (f(-1, -1), 3.), (f(0, -1), 1.)];
        assert_row(&step.s2(f(-1, 0), v(0, 0)), &expected.map(|(e, w)| (e, w / 64.0)));
    }
}

#[test]
fn smooth_triangle_rule_changes_the_weight_of_faces() {
    let two = |triangles| {
        catmark(Descriptor { triangles, ..polygons(4, &[vec![0, 1, 2], vec![1, 0, 3]]) }, DooSabin::Thesis)
    };
    for (rule, tau) in [(TriangleSubdivision::Catmark, 0.25), (TriangleSubdivision::Smooth, 0.47)] {
        let (own, beyond) = ((1.0 - tau) / 6.0, tau / 6.0);
        assert_row(&two(rule).odd(0, 1), &[((1, 2), own), ((0, 2), own), ((3, 1), beyond), ((3, 0), beyond)]);
    }
}

/// Three pages of a book: nothing crosses the spine, whichever way its faces run along it.
#[test]
fn nothing_crosses_a_non_manifold_edge() {
    let pages = [vec![0, 1, 3, 2], vec![0, 1, 5, 4], vec![1, 0, 6, 7]];
    for step in both(&polygons(8, &pages)) {
        for page in 0..3 {
            for corner in [0, 1] {
                assert_row(&step.s2(page, corner), &[(page, 0.25)]);
            }
        }
        assert_row(&step.even(0, 1), &[((0, 1), 0.5)]);
    }
}

/// The whole of the regular interior, every class of cells, against the exact tensor-product convolution.
#[test]
fn regular_rows_are_those_of_the_symbols() {
    let symbols = [0, 1, 2].map(|r| smooth(Lattice::Quads, r));
    let weight = |w: Rational| *w.numer() as f64 / *w.denom() as f64;
    let at = |(i, j): (i32, i32)| v(i, j);
    for step in both(&grid(8, 8, true)) {
        // The cell of the torus whose child lies at a position of the fine lattice.
        let cell = |(i, j): (i32, i32)| {
            let here = (i.div_euclid(2), j.div_euclid(2));
            match (i.rem_euclid(2), j.rem_euclid(2)) {
                (0, 0) => Parent::Vertex(at(here)),
                (1, 0) => Parent::Edge(step.edge(at(here), v(here.0 + 1, here.1)).edge()),
                (0, 1) => Parent::Edge(step.edge(at(here), v(here.0, here.1 + 1)).edge()),
                _ => Parent::Face(f(here.0, here.1)),
            }
        };
        for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let terms = symbols[0].stencil(0, (i, j)).into_iter().map(|(_, q, w)| (at(q), weight(w)));
            assert_row(&step.s0(cell((i, j))), &terms.collect::<Vec<_>>());
            for (direction, (di, dj)) in [(1, 0), (0, 1)].into_iter().enumerate() {
                let terms = symbols[1].stencil(direction, (i, j)).into_iter().map(|(d, q, w)| {
                    let end = if d == 0 { (q.0 + 1, q.1) } else { (q.0, q.1 + 1) };
                    ((at(q), at(end)), weight(w))
                });
                assert_row(&step.s1(cell((i, j)), cell((i + di, j + dj))), &terms.collect::<Vec<_>>());
            }
            let split = step.hierarchy.refinement(1).split();
            let child = step.hierarchy.level(1).mesh();
            let h = child
                .find_half_edge(split.vertex_of(cell((i, j))), split.vertex_of(cell((i + 1, j))))
                .unwrap();
            let row = step.s2_row(child.corner_face(child.left_corner(h).unwrap()));
            let terms = symbols[2].stencil(0, (i, j)).into_iter().map(|(_, q, w)| (f(q.0, q.1), weight(w)));
            assert_row(&row, &terms.collect::<Vec<_>>());
        }
    }
}
