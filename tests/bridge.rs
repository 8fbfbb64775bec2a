//! Every call of the bridge, on meshes that reach its special cases. `scripts/memcheck` runs this binary
//! under valgrind, so it stays small.

mod common;

use common::meshes::{fan, grid, polygons};
use formwork::osd::{OsdScheme, Refiner};
use formwork::topology::{
    BoundaryInterpolation, Cage, Corner, Crease, CreasingMethod, Descriptor, TriangleSubdivision,
};

fn zoo() -> Vec<(&'static str, Descriptor)> {
    let creased = |creasing| Descriptor {
        creases: [(0, 1, 0.4), (1, 2, 2.5), (7, 8, 10.0), (8, 9, 1.0)]
            .map(|(a, b, sharpness)| Crease { vertices: [a, b], sharpness })
            .into(),
        corners: vec![Corner { vertex: 13, sharpness: 1.5 }],
        holes: vec![3],
        creasing,
        ..grid(4, 4, false)
    };
    // A crease vertex on two non-manifold edges with four faces each: more faces than edges.
    let star = |k: u32| {
        let page = |i: u32| vec![vec![0, 1, 4 + 3 * i, 3 + 3 * i], vec![1, 2, 5 + 3 * i, 4 + 3 * i]];
        polygons((3 + 3 * k) as usize, &(0..k).flat_map(page).collect::<Vec<_>>())
    };
    vec![
        ("torus", grid(4, 4, true)),
        ("uniform creases", creased(CreasingMethod::Uniform)),
        ("chaikin creases", creased(CreasingMethod::Chaikin)),
        ("no boundary", Descriptor { boundary: BoundaryInterpolation::None, ..grid(3, 3, false) }),
        ("corners", Descriptor { boundary: BoundaryInterpolation::EdgeAndCorner, ..grid(3, 3, false) }),
        ("polygons", Descriptor { triangles: TriangleSubdivision::Smooth, ..fan(&[3, 4, 5, 6, 3]) }),
        ("left-handed", Descriptor { left_handed: true, ..fan(&[4; 7]) }),
        ("book", star(3)),
        ("thick book", star(6)),
        ("bow tie", polygons(7, &[vec![0, 1, 2], vec![0, 3, 4], vec![0, 5, 6]])),
        ("pillow", polygons(3, &[vec![0, 1, 2], vec![2, 1, 0]])),
        ("isolated vertices", Descriptor { num_vertices: 9, ..polygons(4, &[vec![0, 1, 2, 3]]) }),
    ]
}

#[test]
fn every_call_answers_on_every_mesh() {
    for (name, descriptor) in zoo() {
        let cage = Cage::new(descriptor).unwrap();
        let mut refiner = Refiner::new(&cage, OsdScheme::Catmark).unwrap();
        assert!(refiner.masks(0).is_err(), "{name}: not refined yet");
        refiner.refine_uniform(2).unwrap();
        for level in 0..=2 {
            let mesh = refiner.mesh(level).unwrap();
            let tags = refiner.tags(level).unwrap();
            assert_eq!(tags.vertex_rule.len(), mesh.num_vertices(), "{name}");
            if level == 2 {
                continue;
            }
            let masks = refiner.masks(level).unwrap();
            assert_eq!(masks.vertex_edge.len(), 2 * mesh.num_edges(), "{name}");
            assert_eq!(refiner.children(level).unwrap().face_faces.len(), mesh.num_corners(), "{name}");
            // OpenSubdiv's table and its refiner agree on a refined cochain.
            let values: Vec<f64> = (0..mesh.num_vertices()).map(|v| (v as f64).sin()).collect();
            let by_table = formwork::sparse::apply(&refiner.stencils(level + 1).unwrap(), &values);
            let by_refiner = refiner.interpolate(level + 1, &values).unwrap();
            for (a, b) in by_table.iter().zip(&by_refiner) {
                assert!((a - b).abs() < common::SAME_WEIGHTS, "{name}: {a} {b}");
            }
        }
        let limits = refiner.limit_stencils().unwrap();
        for (matrix, sum) in [(&limits.position, 1.0), (&limits.tangent1, 0.0), (&limits.tangent2, 0.0)] {
            for row in 0..matrix.rows() {
                let total: f64 = formwork::sparse::row_of(matrix, row).1.iter().sum();
                assert!((total - sum).abs() < 1e-6, "{name}: limit row {row} sums to {total}");
            }
        }
        let table = refiner.float_stencil_table().unwrap();
        let mut out = vec![0.0; table.num_stencils()];
        table.evaluate(&vec![1.0; cage.descriptor().num_vertices], 1, &mut out).unwrap();
        assert!(out.iter().all(|x| (x - 1.0).abs() < 1e-5), "{name}: constants are kept");
    }
}

#[test]
fn wrong_calls_are_errors() {
    let cage = Cage::new(grid(3, 3, false)).unwrap();
    let mut refiner = Refiner::new(&cage, OsdScheme::Catmark).unwrap();
    assert!(refiner.refine_uniform(0).is_err());
    assert!(refiner.refine_uniform(16).is_err());
    refiner.refine_uniform(1).unwrap();
    assert!(refiner.refine_uniform(1).is_err(), "refined twice");
    assert!(refiner.mesh(2).is_err());
    assert!(refiner.tags(usize::MAX).is_err());
    assert!(refiner.masks(1).is_err());
    assert!(refiner.children(1).is_err());
    assert!(refiner.stencils(0).is_err());
    assert!(refiner.stencils(2).is_err());
    assert!(refiner.interpolate(0, &[]).is_err());
    assert!(refiner.interpolate(1, &[1.0]).is_err());
    let table = refiner.float_stencil_table().unwrap();
    assert!(table.evaluate(&[1.0; 3], 1, &mut [0.0; 3]).is_err());
}
