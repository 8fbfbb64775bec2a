//! Fans, orientation and invariants of the complex.

mod common;

use common::meshes::{fan, grid, polygons, random_cage};
use formwork::osd::{OsdScheme, Refiner};
use formwork::sparse::multiply;
use formwork::topology::{Cage, Descriptor, HalfEdge, Mesh, Survey};
use proptest::prelude::*;

fn mesh(descriptor: Descriptor) -> Mesh {
    Refiner::new(&Cage::new(descriptor).unwrap(), OsdScheme::Catmark).unwrap().mesh(0).unwrap()
}

fn survey(descriptor: Descriptor) -> Survey {
    Survey::of(&mesh(descriptor))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Every corner lies in one fan; neighbours in a fan share the spoke between them.
    #[test]
    fn fans_hang_together(cage in random_cage()) {
        let mesh = Refiner::new(&cage, OsdScheme::Catmark).unwrap().mesh(0).unwrap();
        let mut seen = vec![0; mesh.num_corners()];
        for v in 0..mesh.num_vertices() as u32 {
            for fan in mesh.fans(v) {
                let k = fan.corners.len();
                for (i, &c) in fan.corners.iter().enumerate() {
                    seen[c as usize] += 1;
                    prop_assert_eq!(mesh.corner_vertex(c), v);
                    prop_assert_eq!(mesh.fan_of_corner(c), (fan, i));
                    let leaving = mesh.corner_half_edge(mesh.previous_corner(c)).twin();
                    let next = mesh.left_corner(leaving);
                    if i + 1 < k || fan.cyclic {
                        prop_assert_eq!(next, Some(fan.corners[(i + 1) % k]));
                    } else {
                        prop_assert_eq!(next, None);
                    }
                }
            }
            for &h in mesh.vertex_half_edges(v) {
                prop_assert_eq!(mesh.tail(h), v);
                prop_assert_eq!(mesh.find_half_edge(v, mesh.head(h)), Some(h));
            }
        }
        prop_assert!(seen.iter().all(|&n| n == 1));
    }

    #[test]
    fn the_boundary_of_a_boundary_is_empty(cage in random_cage()) {
        let mut refiner = Refiner::new(&cage, OsdScheme::Catmark).unwrap();
        refiner.refine_uniform(1).unwrap();
        for level in 0..2 {
            let mesh = refiner.mesh(level).unwrap();
            prop_assert_eq!(multiply(&mesh.d1(), &mesh.d0()).nnz(), 0);
        }
    }
}

#[test]
fn arrays_that_are_no_complex_are_refused() {
    let quad = |edges: &[u32], ends: Vec<[u32; 2]>| Mesh::from_arrays(3, &[3], &[0, 1, 2], edges, ends);
    let ends = vec![[0, 1], [2, 1], [2, 0]];
    assert!(quad(&[0, 1, 2], ends.clone()).is_ok());
    assert!(quad(&[0, 2, 1], ends.clone()).is_err());
    assert!(quad(&[0, 1], ends.clone()).is_err());
    assert!(quad(&[0, 1, 9], ends).is_err());
}

#[test]
fn surfaces_are_recognised() {
    let torus = survey(grid(4, 5, true));
    assert_eq!((torus.euler_characteristic, torus.genus, torus.boundary_loops), (0, Some(1), 0));
    assert_eq!(torus.valences, [(4, 20)]);

    let disk = survey(grid(3, 2, false));
    assert_eq!(
        (disk.euler_characteristic, disk.genus, disk.boundary_loops, disk.boundary_edges),
        (1, Some(0), 1, 10)
    );
    assert_eq!(disk.valences, [(2, 4), (3, 6), (4, 2)]);

    // An annulus: a 3 x 3 grid without its middle.
    let mut annulus = grid(3, 3, false);
    annulus.face_vertices.drain(16..20);
    annulus.face_sizes.pop();
    let annulus = survey(annulus);
    assert_eq!((annulus.euler_characteristic, annulus.genus, annulus.boundary_loops), (0, Some(0), 2));

    let mixed = survey(fan(&[3, 4, 5]));
    assert_eq!(mixed.face_sizes, [(3, 1), (4, 1), (5, 1)]);

    let book = survey(polygons(9, &[vec![0, 1, 3, 2], vec![0, 1, 5, 4], vec![1, 0, 6, 7]]));
    assert_eq!((book.non_manifold_edges, book.non_manifold_vertices, book.genus), (1, 2, None));
    assert_eq!((book.isolated_vertices, book.components), (1, 1));

    let bow_tie = survey(polygons(5, &[vec![0, 1, 2], vec![0, 3, 4]]));
    assert_eq!((bow_tie.non_manifold_edges, bow_tie.non_manifold_vertices, bow_tie.genus), (0, 1, None));

    // A Moebius band of five quads: one edge is run along twice in the same direction.
    let at = |i: u32, side: u32| if i == 5 { 1 - side } else { 2 * i + side };
    let band: Vec<Vec<u32>> = (0..5)
        .map(|i| {
            vec![
                at(i, 0),
                if i == 4 { 1 } else { at(i + 1, 0) },
                if i == 4 { 0 } else { at(i + 1, 1) },
                at(i, 1),
            ]
        })
        .collect();
    assert_eq!(survey(polygons(10, &band)).non_manifold_edges, 1);
}

#[test]
fn edges_follow_opensubdivs_numbering() {
    let mesh = mesh(grid(2, 1, false));
    assert_eq!(mesh.edges(), [[0, 1], [1, 4], [4, 3], [3, 0], [1, 2], [2, 5], [5, 4]]);
    assert_eq!(
        mesh.face_half_edges(1),
        [4, 5, 6]
            .map(|e| HalfEdge::new(e, true))
            .into_iter()
            .chain([HalfEdge::new(1, false)])
            .collect::<Vec<_>>()
    );
}
