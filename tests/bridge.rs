//! Every call of the bridge, on meshes that reach its special cases. `scripts/memcheck` runs this binary
//! under valgrind, so it stays small.

mod common;

use common::meshes::{fan, grid, polygons};
use formwork::osd::{BFR_SHARP_LEVEL, BFR_SMOOTH_LEVEL, OsdScheme, Refiner};
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

#[test]
fn bfr_meets_the_limit_stencils_at_vertices() {
    for (name, descriptor) in zoo() {
        let cage = Cage::new(descriptor).unwrap();
        let refiner = Refiner::new(&cage, OsdScheme::Catmark).unwrap();
        let (mesh, tags) = (refiner.mesh(0).unwrap(), refiner.tags(0).unwrap());
        // Where Bfr and the limit masks differ: see `LimitStencils`. A hole has no surface.
        let plain = mesh.num_faces() > 2
            && (0..mesh.num_faces() as u32).all(|f| mesh.face_size(f) == 4)
            && tags.edge_sharpness.iter().all(|&s| s == 0.0 || s == 10.0);
        let positions: Vec<f64> = (0..3 * mesh.num_vertices()).map(|i| (i as f64).sin()).collect();
        let limit = refiner.limit_stencils().unwrap().position;
        let bfr = refiner.bfr(BFR_SMOOTH_LEVEL, BFR_SHARP_LEVEL).unwrap();
        for f in 0..mesh.num_faces() as u32 {
            let uv = [[0.0, 0.0], [0.25, 0.5]];
            let found = bfr.evaluate(&positions, &[f; 2], &uv);
            if tags.face_hole[f as usize] {
                assert!(found.unwrap_err().to_string().contains(&format!("face {f} ")), "{name}");
                continue;
            }
            let found = found.unwrap();
            assert_eq!(bfr.evaluate_positions(&positions, &[f; 2], &uv).unwrap(), [found[0][0], found[1][0]]);
            let (columns, weights) = formwork::sparse::row_of(&limit, mesh.face_vertices(f)[0] as usize);
            for axis in 0..3 {
                let at = |&v: &u32| positions[3 * v as usize + axis];
                let expected: f64 = columns.iter().zip(weights).map(|(v, w)| w * at(v)).sum();
                // In the tables of irregular patches weights are in single precision.
                assert!(!plain || (found[0][0][axis] - expected).abs() < 1e-6, "{name}, face {f}");
            }
        }
        assert!(bfr.evaluate(&positions, &[mesh.num_faces() as u32], &[[0.0; 2]]).is_err(), "{name}");
    }
}

#[test]
fn wrong_calls_of_bfr_are_errors() {
    let cage = Cage::new(fan(&[3, 4, 5])).unwrap();
    let refiner = Refiner::new(&cage, OsdScheme::Catmark).unwrap();
    assert!(refiner.bfr(0, 2).is_err());
    assert!(refiner.bfr(2, 16).is_err());
    let bfr = refiner.bfr(2, 6).unwrap();
    let positions = vec![1.0; 3 * cage.descriptor().num_vertices];
    let evaluate = |face: u32, u, v| bfr.evaluate(&positions, &[face], &[[u, v]]);
    assert!(evaluate(1, 1.0, 1.0).is_ok());
    assert!(evaluate(1, 1.1, 0.0).is_err());
    assert!(evaluate(1, f64::NAN, 0.0).is_err());
    assert!(evaluate(0, 1.5, 0.5).is_ok(), "the second corner of a triangle");
    assert!(evaluate(0, 1.5, 1.5).is_err(), "a fourth corner of a triangle");
    assert!(evaluate(2, 1e300, -1.0).is_err());
    assert!(evaluate(u32::MAX, 0.0, 0.0).is_err());
    assert!(bfr.evaluate(&positions[1..], &[0], &[[0.0; 2]]).is_err());
    assert!(bfr.evaluate(&positions, &[0, 0], &[[0.0; 2]]).is_err());
}
