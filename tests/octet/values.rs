//! Weights entry by entry, and what the linear schemes do inside a tetrahedron.

use std::collections::BTreeMap;

use formwork::cochain::Cochain;
use formwork::nalgebra::Vector3;
use formwork::octet::{Complex, Hierarchy, Linear, OCT_FACES, Scheme, TET_FACES, WhitneyTet};
use formwork::sparse::row_of;

use super::common::random;
use super::volumes::{PARAMETERS, affine_oct, oct, tet};

const OCT: [u32; 6] = [0, 1, 2, 3, 4, 5];

fn octahedron() -> Complex {
    Complex::new(6, vec![], vec![OCT]).unwrap()
}

/// The edge from `a` to `b`, and its sign.
fn edge(complex: &Complex, a: u32, b: u32) -> (u32, f64) {
    let found = (0..).zip(complex.edges()).find_map(|(e, &ends)| match ends {
        ends if ends == [a, b] => Some((e, 1.0)),
        ends if ends == [b, a] => Some((e, -1.0)),
        _ => None,
    });
    found.unwrap()
}

/// The triangle with these vertices, and the sign of their order.
fn triangle(complex: &Complex, [a, b, c]: [u32; 3]) -> (u32, f64) {
    for t in 0..complex.num_cells(2) as u32 {
        let own = complex.triangle_vertices(t);
        if [a, b, c].iter().all(|v| own.contains(v)) {
            let even = [[a, b, c], [b, c, a], [c, a, b]].contains(&own);
            return (t, if even { 1.0 } else { -1.0 });
        }
    }
    panic!("no triangle {a} {b} {c}")
}

fn outward(v: [u32; 3]) -> [u32; 3] {
    let face = OCT_FACES.iter().map(|face| face.map(|i| i as u32));
    face.into_iter().find(|face| v.iter().all(|x| face.contains(x))).unwrap()
}

/// Row `(fine, sign)` of `S_r` must have these signed terms and no others.
fn assert_row(scheme: Linear, coarse: &Complex, r: usize, fine: (u32, f64), terms: &[((u32, f64), f64)]) {
    let operator = scheme.operator(coarse, r);
    let (columns, weights) = row_of(&operator, fine.0 as usize);
    let found: BTreeMap<u32, f64> =
        columns.iter().zip(weights).map(|(&column, &weight)| (column, weight * fine.1)).collect();
    let nonzero = terms.iter().filter(|term| term.1.abs() > 1e-15);
    let expected: BTreeMap<u32, f64> =
        nonzero.map(|&((column, sign), weight)| (column, sign * weight)).collect();
    assert_eq!(found.len(), expected.len(), "{found:?} for {expected:?}");
    for (column, weight) in expected {
        assert!((found[&column] - weight).abs() < 1e-16, "{found:?}");
    }
}

/// (6.2) to (6.4) of the thesis: the weights inside an octahedron, here at c = 0 and c = -5 as numbers.
#[test]
fn weights_in_an_octahedron() {
    let (coarse, numbers) = (octahedron(), |n: [f64; 6]| n.map(|n| n / 96.0));
    let fine = coarse.split().unwrap();
    let ne = coarse.num_cells(1) as u32;
    let middle = |a, b| 6 + edge(&coarse, a, b).0;
    let g = 6 + ne;
    for (c, [a1, a3, a4], f) in [
        (-5.0, [8.0, 12.0, 4.0], numbers([7.0, -5.0, -9.0, 7.0, 3.0, -1.0])),
        (0.0, [-2.0, 17.0, 9.0], numbers([7.0, 0.0, -19.0, -3.0, 8.0, -1.0])),
    ] {
        let scheme = Linear { c };
        let [a1, a3, a4] = [a1, a3, a4].map(|n| n / 96.0);
        let e = |a, b| edge(&coarse, a, b);
        // From the midpoint of (0, 1) to the centroid; 2 and 5 are beside it, 3 and 4 opposite.
        let terms = [
            (e(0, 2), a3),
            (e(1, 2), a3),
            (e(0, 5), a3),
            (e(1, 5), a3),
            (e(2, 3), a4),
            (e(2, 4), a4),
            (e(5, 3), a4),
            (e(5, 4), a4),
            (e(0, 4), a1),
            (e(1, 3), a1),
        ];
        assert_row(scheme, &coarse, 1, edge(&fine, middle(0, 1), g), &terms);
        // At face (0, 1, 2) and its corner 0, into the tetrahedron there.
        let t = |v: [u32; 3]| triangle(&coarse, outward(v));
        let terms = [
            (t([0, 1, 2]), f[0]),
            (t([0, 1, 5]), f[1]),
            (t([0, 4, 2]), f[1]),
            (t([0, 4, 5]), f[2]),
            (t([3, 1, 2]), f[3]),
            (t([3, 1, 5]), f[4]),
            (t([3, 4, 2]), f[4]),
            (t([3, 4, 5]), f[5]),
        ];
        assert_row(scheme, &coarse, 2, triangle(&fine, [g, middle(0, 2), middle(0, 1)]), &terms);
    }
}

#[test]
fn the_weights_are_those_that_commute() {
    for c in PARAMETERS {
        let ([a1, a2, a3, a4], [f1, f2, f3, f4, f5, f6]) =
            (Linear { c }.edge_weights(), Linear { c }.face_weights());
        let laws = [
            (a2, 0.0),
            (2.0 * a3 + a1, 1.0 / 3.0),
            (a3 - a4, 1.0 / 12.0),
            (f1, 7.0 / 96.0),
            (f6, -1.0 / 96.0),
            (2.0 * f2 + f4, -1.0 / 32.0),
            (f3 + 2.0 * f5, -1.0 / 32.0),
            (f1 + 2.0 * f2 + f3, -1.0 / 8.0),
            (f4 + 2.0 * f5 + f6, 1.0 / 8.0),
        ];
        assert!(laws.iter().all(|(left, right)| (left - right).abs() < 1e-15), "{c}: {laws:?}");
    }
}

#[test]
fn weights_elsewhere() {
    let coarse = Complex::new(4, vec![[0, 1, 2, 3]], vec![]).unwrap();
    let fine = coarse.split().unwrap();
    let middle = |a, b| 4 + edge(&coarse, a, b).0;
    let scheme = Linear::default();
    let e = |a, b| edge(&coarse, a, b);
    assert_row(scheme, &coarse, 1, edge(&fine, 2, middle(1, 2)), &[(e(2, 1), 0.5)]);
    let terms = [(e(1, 2), 0.25), (e(1, 0), 0.25), (e(0, 2), 0.25)];
    assert_row(scheme, &coarse, 1, edge(&fine, middle(0, 1), middle(0, 2)), &terms);
    let t = |v| triangle(&coarse, v);
    // A quarter of a face to its parts; inside, out of the child at vertex 0.
    let part = triangle(&fine, [1, middle(1, 2), middle(1, 3)]);
    assert_row(scheme, &coarse, 2, part, &[(t([1, 2, 3]), 0.25)]);
    let [out, at0 @ ..] = TET_FACES.map(|face| t(face.map(|i| i as u32)));
    let terms: Vec<_> = [(out, 0.125)].into_iter().chain(at0.map(|face| (face, -0.125))).collect();
    let cut = triangle(&fine, [middle(0, 1), middle(0, 2), middle(0, 3)]);
    assert_row(scheme, &coarse, 2, cut, &terms);

    // Cells: a tetrahedron's children have 1/8 each and the octahedron 1/2, an octahedron's 1/8 and 1/32.
    for (coarse, shares) in [(coarse, [0.125, 0.5]), (octahedron(), [0.03125, 0.125])] {
        let fine = coarse.split().unwrap();
        let s3 = scheme.operator(&coarse, 3);
        for cell in 0..fine.num_cells(3) {
            let is_oct = cell >= fine.tets().len();
            assert_eq!(row_of(&s3, cell), (&[0][..], &[shares[usize::from(is_oct)]][..]));
        }
        let s0 = scheme.operator(&coarse, 0);
        let sums: Vec<f64> = (0..fine.num_cells(0)).map(|v| row_of(&s0, v).1.iter().sum()).collect();
        assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 1e-15));
    }
    let s0 = scheme.operator(&octahedron(), 0);
    assert_eq!(row_of(&s0, 18).1, [1.0 / 6.0; 6]);
}

/// `c` is a gauge: closed 1-forms do not see it, nor do 2-forms see more of it than a derivative.
#[test]
fn closed_forms_do_not_see_the_parameter() {
    let coarse = octahedron();
    let fine = coarse.split().unwrap();
    let closed = Cochain::<0>::new(random(6, 1)).exterior_derivative(&coarse);
    let any = Cochain::<2>::new(random(8, 2));
    let refined = PARAMETERS.map(|c| Linear { c }.refine(&coarse, &closed));
    assert!(refined.iter().all(|other| super::difference(refined[0].values(), other.values()) < 1e-15));
    let refined = PARAMETERS.map(|c| Linear { c }.refine(&coarse, &any));
    assert!(super::difference(refined[0].values(), refined[1].values()) > 1e-3);
    let derived = PARAMETERS.map(|c| Linear { c }.refine(&coarse, &any).exterior_derivative(&fine));
    for other in &derived[1..] {
        assert!(super::difference(derived[0].values(), other.values()) < 1e-15);
    }
}

/// Four levels inside a tetrahedron are the de Rham map of its Whitney forms, for every `c`.
#[test]
fn inside_a_tetrahedron_whitney_forms_are_reproduced() {
    let mut worst = 0.0f64;
    for (solid, c) in
        [tet(), tet().scrambled(1), tet().scrambled(5)].iter().flat_map(|s| PARAMETERS.map(|c| (s, c)))
    {
        let scheme = Scheme { linear: Linear { c }, smoothing: None };
        let hierarchy = Hierarchy::new(solid.complex.clone(), scheme, 4).unwrap();
        let (coarse, fine) = (&solid.complex, hierarchy.finest());
        let (w, f) = (Cochain::<1>::new(random(6, 3)), Cochain::<2>::new(random(4, 4)));
        let (z, m) = (Cochain::<0>::new(random(4, 5)), Cochain::<3>::new(random(1, 6)));
        let v = coarse.tets()[0];
        let forms = WhitneyTet::new(v.map(|v| solid.positions[v as usize])).unwrap();
        let along = formwork::octet::TET_EDGES.map(|[i, j]| {
            let (e, sign) = edge(coarse, v[i], v[j]);
            w[e as usize] * sign
        });
        let through = TET_FACES.map(|face| {
            let (t, sign) = triangle(coarse, face.map(|i| v[i]));
            f[t as usize] * sign
        });
        let density = forms.density(m[0]);
        let x = hierarchy.subdivide(&solid.positions);
        let at = |v: u32| x[v as usize];
        let mut hold = |found: f64, expected: f64| {
            worst = worst.max((found - expected).abs());
            assert!((found - expected).abs() < 1e-14, "c {c}: {found} for {expected}");
        };
        for (value, &x) in hierarchy.subdivide(&z).values().iter().zip(x.values()) {
            hold(*value, forms.value(v.map(|v| z[v as usize]), x));
        }
        // Whitney forms are linear: the middle of an edge and the centroid of a triangle give the integral.
        for (value, ends) in hierarchy.subdivide(&w).values().iter().zip(fine.edges()) {
            let [a, b] = ends.map(at);
            hold(*value, forms.vector(along, (a + b) / 2.0).dot(&(b - a)));
        }
        for (t, value) in (0..).zip(hierarchy.subdivide(&f).values()) {
            let [a, b, c] = fine.triangle_vertices(t).map(at);
            hold(*value, forms.flux(through, (a + b + c) / 3.0).dot(&(b - a).cross(&(c - a))) / 2.0);
        }
        for (cell, value) in (0..).zip(hierarchy.subdivide(&m).values()) {
            let p: Vec<Vector3<f64>> = fine.cell_vertices(cell).iter().map(|&v| at(v)).collect();
            let volume = match p.len() {
                4 => (p[1] - p[0]).cross(&(p[2] - p[0])).dot(&(p[3] - p[0])) / 6.0,
                _ => (p[0] - p[3]).cross(&(p[1] - p[4])).dot(&(p[2] - p[5])) / 6.0,
            };
            hold(*value, density * volume);
        }
    }
    println!("worst deviation from the Whitney forms: {worst:.1e}");
}

/// An octahedron that is an affine image of the regular one reproduces `a + b x p` (1-forms) and `a + k p` (2-forms).
#[test]
fn affine_octahedra_reproduce_simple_fields() {
    let (a, b, k) = (Vector3::new(0.4, -1.0, 0.7), Vector3::new(-0.2, 0.9, 0.5), 1.3);
    let along = |p: Vector3<f64>, q: Vector3<f64>| (a + b.cross(&((p + q) / 2.0))).dot(&(q - p));
    let through = |p: Vector3<f64>, q: Vector3<f64>, r: Vector3<f64>| {
        (a + (p + q + r) * (k / 3.0)).dot(&(q - p).cross(&(r - p))) / 2.0
    };
    let deviation = |solid: &super::volumes::Solid, c: f64| {
        let scheme = Scheme { linear: Linear { c }, smoothing: None };
        let hierarchy = Hierarchy::new(solid.complex.clone(), scheme, 3).unwrap();
        let forms = |complex: &Complex, x: &Cochain<0, Vector3<f64>>| {
            let edges = complex.edges().iter().map(|&[p, q]| along(x[p as usize], x[q as usize]));
            let triangles = (0..complex.num_cells(2) as u32).map(|t| {
                let [p, q, r] = complex.triangle_vertices(t).map(|v| x[v as usize]);
                through(p, q, r)
            });
            (Cochain::<1>::new(edges.collect()), Cochain::<2>::new(triangles.collect()))
        };
        let (w, f) = forms(&solid.complex, &solid.positions);
        let (fine_w, fine_f) = forms(hierarchy.finest(), &hierarchy.subdivide(&solid.positions));
        let w = super::difference(hierarchy.subdivide(&w).values(), fine_w.values());
        w.max(super::difference(hierarchy.subdivide(&f).values(), fine_f.values()))
    };
    for c in PARAMETERS {
        assert!(deviation(&affine_oct(), c) < 1e-14);
    }
    assert!(deviation(&oct(), -5.0) > 1e-3, "an octahedron that is not affine does not");
}
