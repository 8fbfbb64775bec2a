//! Laws on random polygon meshes with random creases, corners, boundaries, holes and options.

mod common;

use approx::assert_relative_eq;
use common::meshes::{random_cage, random_triangles};
use common::{EXACT, assert_laws, assert_stencils, triangle_schemes};
use formwork::cochain::Cochain;
use formwork::hierarchy::Hierarchy;
use formwork::osd::Refiner;
use formwork::scheme::{DooSabin, Scheme};
use formwork::sparse::apply;
use formwork::topology::ChildEdge;
use nalgebra::{SVector, Vector3};
use proptest::prelude::*;

fn values(len: usize, seed: u64) -> Vec<f64> {
    (0..len).map(|i| ((i as u64 * 2_654_435_761 + seed * 40_503) % 10_007) as f64 / 5_003.5 - 1.0).collect()
}

fn assert_close(a: &[f64], b: &[f64]) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        assert_relative_eq!(*a, *b, epsilon = EXACT, max_relative = EXACT);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn laws_hold(cage in random_cage(), original in any::<bool>()) {
        let weights = if original { DooSabin::Original } else { DooSabin::Thesis };
        assert_laws("random", &cage, Scheme::Catmark(weights), 3);
    }

    #[test]
    fn laws_hold_on_triangles(cage in random_triangles(), scheme in 0usize..7) {
        let scheme = triangle_schemes()[scheme];
        assert_laws("random triangles", &cage, scheme, 3);
    }

    #[test]
    fn laws_hold_for_bilinear(cage in random_cage()) {
        assert_laws("random", &cage, Scheme::Bilinear, 2);
    }

    /// Applying form (A) is applying the matrices, for every degree, and commutes.
    #[test]
    fn refining_without_matrices_is_refining_with_them(
        polygons in random_cage(), triangles in random_triangles(), scheme in 0usize..7, seed in 0u64..1000
    ) {
        let catmark = Hierarchy::new(&polygons, Scheme::default(), 2).unwrap();
        // The kernel of 1-forms has its blocks from the second level on, on triangles from the third.
        let triangles = Hierarchy::new(&triangles, triangle_schemes()[scheme], 4).unwrap();
        let levels = (1..=2).map(|level| (&catmark, level)).chain((1..=4).map(|level| (&triangles, level)));
        for (hierarchy, level) in levels {
            let (parent, child) = (hierarchy.level(level - 1).mesh(), hierarchy.level(level).mesh());
            let operators = hierarchy.operators(level);
            assert_stencils(hierarchy, level);
            let x = Cochain::<0>::new(values(parent.num_vertices(), seed));
            let c = Cochain::<1>::new(values(parent.num_edges(), seed));
            let density = Cochain::<2>::new(values(parent.num_faces(), seed));
            assert_close(hierarchy.refine(level, &x).values(), &apply(&operators.s0, x.values()));
            assert_close(hierarchy.refine(level, &c).values(), &apply(&operators.s1, c.values()));
            assert_close(hierarchy.refine(level, &density).values(), &apply(&operators.s2, density.values()));

            let refined = hierarchy.refine(level, &c).exterior_derivative(child);
            assert_close(refined.values(), hierarchy.refine(level, &c.exterior_derivative(parent)).values());
            let refined = hierarchy.refine(level, &x).exterior_derivative(child);
            assert_close(refined.values(), hierarchy.refine(level, &x.exterior_derivative(parent)).values());
            // Flux is kept.
            let total = |density: &Cochain<2>| density.values().iter().sum::<f64>();
            prop_assert!((total(&hierarchy.refine(level, &density)) - total(&density)).abs() < EXACT * density.len() as f64);
        }
    }

    /// The faces beside a child edge are those whose boundaries it is on.
    #[test]
    fn faces_are_beside_their_edges(polygons in random_cage(), triangles in random_triangles()) {
        for (cage, scheme) in [(polygons, Scheme::default()), (triangles, triangle_schemes()[1])] {
            let hierarchy = Hierarchy::new(&cage, scheme, 1).unwrap();
            let (parent, split) = (hierarchy.level(0).mesh(), hierarchy.refinement(1).split());
            let mut on_boundary = vec![Vec::new(); split.num_children(1)];
            for face in 0..split.num_children(2) {
                split.face_boundary(parent, face, |edge, _| on_boundary[split.edge_of(edge) as usize].push(face as u32));
            }
            for (edge, faces) in on_boundary.into_iter().enumerate() {
                let place = split.edge_parent(edge);
                if !matches!(place, ChildEdge::Even(h) if parent.is_non_manifold_edge(h.edge())) {
                    let mut beside: Vec<u32> = split.faces_beside(parent, place).collect();
                    beside.sort_unstable();
                    prop_assert_eq!(beside, faces);
                }
            }
        }
    }

    /// What is refined by rule is what OpenSubdiv's arrays make, with every fan walked.
    #[test]
    fn complexes_are_opensubdivs(polygons in random_cage(), triangles in random_triangles()) {
        for (cage, scheme) in [(&polygons, Scheme::default()), (&triangles, triangle_schemes()[1])] {
            let hierarchy = Hierarchy::new(cage, scheme, 3).unwrap();
            let mut refiner = Refiner::new(cage, scheme.opensubdiv(hierarchy.split_kind())).unwrap();
            refiner.refine_uniform(3).unwrap();
            for level in 0..=3 {
                prop_assert!(*hierarchy.level(level).mesh() == refiner.mesh(level).unwrap(), "level {level}");
            }
        }
    }

    /// A vector-valued cochain is three numbers side by side.
    #[test]
    fn positions_refine_like_their_coordinates(cage in random_cage()) {
        let hierarchy = Hierarchy::new(&cage, Scheme::default(), 2).unwrap();
        let coordinates: Vec<Cochain<0>> =
            (0..3).map(|seed| Cochain::new(values(cage.descriptor().num_vertices, seed))).collect();
        let positions: Cochain<0, Vector3<f64>> = Cochain::new(
            (0..coordinates[0].len()).map(|v| Vector3::from_fn(|i, _| coordinates[i][v])).collect(),
        );
        let refined = hierarchy.subdivide(&positions);
        for (i, coordinate) in coordinates.iter().enumerate() {
            let column: Vec<f64> = refined.values().iter().map(|p| p[i]).collect();
            prop_assert_eq!(column, hierarchy.subdivide(coordinate).into_values());
        }
    }
}

#[test]
fn results_are_bitwise_the_same_for_any_number_of_threads() {
    let quads = (common::meshes::grid(60, 60, false), Scheme::default(), 2);
    let triangles = (common::meshes::cut_grid(40, 40, false, &[1, 2].repeat(800)), triangle_schemes()[1], 3);
    for (descriptor, scheme, levels) in [quads, triangles] {
        let cage = formwork::topology::Cage::new(descriptor).unwrap();
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let hierarchy = Hierarchy::new(&cage, scheme, levels).unwrap();
                let form = Cochain::<1>::new(values(hierarchy.level(0).mesh().num_edges(), 7));
                let operators = hierarchy.operators(levels);
                let stencils = hierarchy.step_stencils(1, levels);
                let (rows, terms) = (stencils.shape().0, operators.s1.nnz());
                let (mut lengths, mut columns, mut weights) =
                    (vec![0; rows], vec![0; terms], vec![0.0; terms]);
                stencils.write(0..rows, &mut lengths, &mut columns, &mut weights);
                (hierarchy.subdivide(&form).into_values(), operators.s1, operators.s2, columns, weights)
            })
        };
        let one = run(1);
        for threads in [2, 5] {
            assert!(run(threads) == one, "{scheme:?}: {threads} threads differ from one");
        }
    }
}

/// Forms so large that they are written past the caches are, digit by digit, the small ones that are not.
#[test]
fn eight_forms_at_once_are_eight_forms() {
    let cuts: Vec<u8> = values(40 * 40, 3).into_iter().map(|x| 1 + u8::from(x > 0.0)).collect();
    // Of the quads some are left over when they are stored eight at a time.
    let quads = (common::meshes::grid(61, 67, false), Scheme::default());
    let triangles = (common::meshes::cut_grid(40, 40, false, &cuts), triangle_schemes()[1]);
    for (descriptor, scheme) in [quads, triangles] {
        let hierarchy =
            Hierarchy::new(&formwork::topology::Cage::new(descriptor).unwrap(), scheme, 3).unwrap();
        let edges = hierarchy.level(2).mesh().num_edges();
        let alone: Vec<Cochain<1>> = (0..8).map(|seed| Cochain::new(values(edges, seed))).collect();
        let together = (0..edges).map(|e| SVector::<f64, 8>::from_fn(|i, _| alone[i][e])).collect();
        let together = hierarchy.refine(3, &Cochain::<1, _>::new(together));
        assert!(size_of_val(together.values()) > 16 << 20);
        for (i, form) in alone.iter().enumerate() {
            let column: Vec<f64> = together.values().iter().map(|form| form[i]).collect();
            assert!(column == hierarchy.refine(3, form).into_values(), "{scheme:?}: form {i}");
        }
    }
}
