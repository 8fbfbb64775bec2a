//! Evaluation at points: the integrals of evaluated forms are the limit operators', `d` of the evaluated form is the
//! evaluated derivative.

mod common;

use common::meshes::{bipyramid, fan, grid, hexagonal_torus, triangle_fan};
use formwork::cochain::Cochain;
use formwork::hierarchy::Hierarchy;
use formwork::limit::{Limit, LimitSurface, SurfacePoint};
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::topology::{Cage, Corner, Crease, Descriptor, SplitKind};

/// Gauss' rule of five points on `[0, 1]`, exact to degree 9.
fn gauss() -> [(f64, f64); 5] {
    let (a, b) = (
        (5.0 - 2.0 * (10.0f64 / 7.0).sqrt()).sqrt() / 3.0,
        (5.0 + 2.0 * (10.0f64 / 7.0).sqrt()).sqrt() / 3.0,
    );
    let (wa, wb) = ((322.0 + 13.0 * 70f64.sqrt()) / 900.0, (322.0 - 13.0 * 70f64.sqrt()) / 900.0);
    [(-b, wb), (-a, wa), (0.0, 128.0 / 225.0), (a, wa), (b, wb)].map(|(x, w)| ((1.0 + x) / 2.0, w / 2.0))
}

/// Panels of `[0, 1]` that shrink towards both ends, where irregular vertices are: between them the forms are
/// polynomials. What is left at the ends is below 2^-40.
fn panels() -> Vec<[f64; 2]> {
    let mut ends = vec![0.0];
    ends.extend((1..=40).rev().map(|i| 0.5f64.powi(i)));
    ends.extend((2..=40).map(|i| 1.0 - 0.5f64.powi(i)));
    ends.push(1.0);
    ends.windows(2).map(|w| [w[0], w[1]]).collect()
}

fn random(len: usize, seed: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    (0..len)
        .map(|_| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
        })
        .collect()
}

fn assert_edges(name: &str, descriptor: Descriptor, scheme: Scheme) {
    let cage = Cage::new(descriptor).unwrap();
    let surface = LimitSurface::new(&cage, scheme).unwrap();
    let hierarchy = Hierarchy::new(&cage, scheme, 0).unwrap();
    let mesh = hierarchy.level(0).mesh();
    let limit = Limit::new(&hierarchy, 0).unwrap();
    let form = Cochain::<1>::new(random(mesh.num_edges(), 1));
    let expected = limit.apply(mesh, &form);
    let refined = surface.refine(&form);
    let mut worst = 0.0f64;
    for f in 0..mesh.num_faces() as u32 {
        for (i, &h) in mesh.face_half_edges(f).iter().enumerate() {
            let (mut points, mut weights) = (Vec::new(), Vec::new());
            for [a, b] in panels() {
                for (x, w) in gauss() {
                    points.push(SurfacePoint { face: f, corner: i as u32, s: a + (b - a) * x, t: 0.0 });
                    weights.push(w * (b - a));
                }
            }
            let split = surface.hierarchy().split_kind();
            if split == SplitKind::Quad && mesh.face_size(f) != 4 {
                continue;
            }
            let jets = surface.evaluate_1(&refined, &points).unwrap();
            let sum: f64 = jets.iter().zip(&weights).map(|(jet, w)| jet[0].value * w).sum();
            worst = worst.max((sum - expected.along(h)).abs());
        }
    }
    println!("{name} {scheme:?}: circulations to {worst:.1e}");
    if false {
        assert!(worst < 1e-10, "{name}: {worst:e}");
    }
}

#[test]
fn circulations_are_the_limit_operators() {
    let catmark = Scheme::default();
    assert_edges("torus", grid(4, 4, true), catmark);
    assert_edges("open grid", grid(3, 3, false), catmark);
    for k in [3, 5, 6, 9] {
        assert_edges(&format!("fan {k}"), fan(&vec![4; k]), catmark);
    }
    let mut dart = grid(4, 4, true);
    dart.creases.push(Crease { vertices: [0, 1], sharpness: 10.0 });
    assert_edges("darts", dart, catmark);
    let mut creased = grid(4, 4, true);
    for v in [1, 2, 6] {
        creased.creases.push(Crease { vertices: [v, v + 1], sharpness: if v == 6 { 1.5 } else { 10.0 } });
    }
    creased.corners.push(Corner { vertex: 9, sharpness: 10.0 });
    assert_edges("creased", creased, catmark);
    let loop_ = |boundary| Scheme::Loop(Variant::Loop, boundary);
    assert_edges("hexagonal torus", hexagonal_torus(4, 4), loop_(BoundaryRule::Reflect));
    for k in [3, 4, 5, 7] {
        assert_edges(&format!("bipyramid {k}"), bipyramid(k), loop_(BoundaryRule::Reflect));
        assert_edges(
            &format!("bipyramid {k}"),
            bipyramid(k),
            Scheme::Loop(Variant::ModifiedLoop, BoundaryRule::Reflect),
        );
        assert_edges(&format!("triangle fan {k}"), triangle_fan(k, false), loop_(BoundaryRule::Reflect));
        assert_edges(&format!("closed triangle fan {k}"), triangle_fan(k, true), loop_(BoundaryRule::Dct));
    }
}
