//! The split, and `d S = S d`.

use formwork::cochain::Cochain;
use formwork::octet::{Boundary, Complex, Hierarchy, Linear, Scheme};
use formwork::sparse::{max_difference, multiply};

use super::common::random;
use super::volumes::{PARAMETERS, delaunay, zoo};
use super::{EXACT, difference};

#[test]
fn d_d_is_zero() {
    for solid in zoo() {
        let mut complex = solid.complex;
        for level in 0..3 {
            for r in 0..2 {
                let dd = multiply(&complex.exterior_derivative(r + 1), &complex.exterior_derivative(r));
                assert_eq!(dd.nnz(), 0, "{} level {level}", solid.name);
            }
            if complex.num_cells(3) > 5000 {
                break;
            }
            complex = complex.split().unwrap();
        }
    }
}

/// The children written down by rule are the complex that searching finds from their vertices.
#[test]
fn the_split_by_rule_is_the_split_by_search() {
    for solid in zoo() {
        let mut complex = solid.complex;
        for _ in 0..2 {
            let fine = complex.split().unwrap();
            let triangles: Vec<_> =
                (0..fine.num_cells(2) as u32).map(|t| fine.triangle_vertices(t)).collect();
            let (edges, tets, octs) = (fine.edges().to_vec(), fine.tets().to_vec(), fine.octs().to_vec());
            let again = Complex::with_sides(fine.num_cells(0), edges, &triangles, tets, octs).unwrap();
            assert!(fine == again, "{}", solid.name);
            complex = fine;
        }
    }
}

/// `d S = S d` entry by entry.
#[test]
fn the_linear_schemes_commute() {
    let mut worst = 0.0f64;
    let mut solids = zoo();
    let random = delaunay(190, 11);
    assert!(random.complex.num_cells(3) >= 1000);
    solids.extend([random.scrambled(3), random]);
    for solid in solids {
        for c in PARAMETERS {
            let (scheme, mut coarse) = (Linear { c }, solid.complex.clone());
            for level in 1..=3 {
                if coarse.num_cells(3) > 3000 {
                    break;
                }
                let fine = coarse.split().unwrap();
                let s = [0, 1, 2, 3].map(|r| scheme.operator(&coarse, r));
                for r in 0..3 {
                    let left = multiply(&fine.exterior_derivative(r), &s[r]);
                    let right = multiply(&s[r + 1], &coarse.exterior_derivative(r));
                    let deviation = max_difference(&left, &right);
                    worst = worst.max(deviation);
                    assert!(deviation <= EXACT, "{}, c {c}, level {level}, r {r}: {deviation}", solid.name);
                }
                coarse = fine;
            }
        }
    }
    println!("worst deviation of an entry: {worst:.1e}");
}

/// `d S = S d` on three levels, applied to random cochains.
fn assert_commutes(name: &str, complex: &Complex, scheme: Scheme, levels: usize, worst: &mut f64) {
    let hierarchy = Hierarchy::new(complex.clone(), scheme, levels).unwrap();
    let values = |r: usize| random(complex.num_cells(r), 17 + r as u64);
    let mut chains =
        (Cochain::<0>::new(values(0)), Cochain::<1>::new(values(1)), Cochain::<2>::new(values(2)));
    let mut derived = (
        chains.0.exterior_derivative(complex),
        chains.1.exterior_derivative(complex),
        chains.2.exterior_derivative(complex),
    );
    for level in 1..=levels {
        let fine = hierarchy.level(level);
        chains = (
            hierarchy.refine(level, &chains.0),
            hierarchy.refine(level, &chains.1),
            hierarchy.refine(level, &chains.2),
        );
        derived = (
            hierarchy.refine(level, &derived.0),
            hierarchy.refine(level, &derived.1),
            hierarchy.refine(level, &derived.2),
        );
        let deviations = [
            difference(chains.0.exterior_derivative(fine).values(), derived.0.values()),
            difference(chains.1.exterior_derivative(fine).values(), derived.1.values()),
            difference(chains.2.exterior_derivative(fine).values(), derived.2.values()),
        ];
        for (r, deviation) in deviations.into_iter().enumerate() {
            *worst = worst.max(deviation);
            assert!(deviation <= EXACT, "{name}, {scheme:?}, level {level}, r {r}: {deviation:e}");
        }
    }
}

#[test]
fn refined_values_commute() {
    let mut worst = 0.0;
    for solid in zoo() {
        let levels = if solid.complex.num_cells(3) > 300 { 2 } else { 3 };
        for c in PARAMETERS {
            let scheme = Scheme { linear: Linear { c }, smoothing: None };
            assert_commutes(&solid.name, &solid.complex, scheme, levels, &mut worst);
        }
    }
    // A thousand tetrahedra of random points, three levels.
    let solid = delaunay(190, 11);
    for (solid, c) in [(solid.scrambled(3), -6.9), (solid, -5.0)] {
        assert!(solid.complex.num_cells(3) >= 1000);
        let scheme = Scheme { linear: Linear { c }, smoothing: None };
        assert_commutes(&solid.name, &solid.complex, scheme, 3, &mut worst);
    }
    println!("worst deviation: {worst:.1e}");
}

#[test]
fn smooth_schemes_commute() {
    let mut worst = 0.0;
    for solid in zoo() {
        let levels = if solid.complex.num_cells(3) > 50 { 2 } else { 3 };
        for boundary in [Boundary::Loop, Boundary::Fixed] {
            let scheme = Scheme { smoothing: Some(boundary), ..Scheme::default() };
            assert_commutes(&solid.name, &solid.complex, scheme, levels, &mut worst);
        }
    }
    let (solid, scheme) =
        (delaunay(190, 11), Scheme { smoothing: Some(Boundary::Loop), ..Scheme::default() });
    assert_commutes(&solid.name, &solid.complex, scheme, 1, &mut worst);
    println!("worst deviation: {worst:.1e}");
}
