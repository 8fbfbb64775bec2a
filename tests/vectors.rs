//! Evaluation of many points in one call: what it says does not depend on the other points, and the vectors of a
//! 1-form belong to it.

mod common;

use common::meshes::{bipyramid, cut_grid, grid};
use formwork::cochain::Cochain;
use formwork::limit::{LimitSurface, SurfacePoint};
use formwork::nalgebra::Vector3;
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::topology::{Cage, Crease, Descriptor, SplitKind};

fn assert_consistent(name: &str, descriptor: Descriptor, scheme: Scheme) {
    let cage = Cage::new(descriptor).unwrap();
    let surface = LimitSurface::new(&cage, scheme).unwrap();
    let (mesh, kind) = (surface.hierarchy().level(0).mesh(), surface.hierarchy().split_kind());
    let wave = |i: usize, rate: f64| (i as f64 * rate).sin();
    let positions = |v| Vector3::new(wave(v, 1.3), wave(v, 2.1), wave(v, 0.7));
    let x = surface.refine(&Cochain::new((0..mesh.num_vertices()).map(positions).collect()));
    let form = surface.refine(&Cochain::<1>::new((0..mesh.num_edges()).map(|e| wave(e, 0.37)).collect()));

    let mut points = Vec::new();
    for face in 0..mesh.num_faces() as u32 {
        for i in 0..40 {
            let corner = i % mesh.face_size(face) as u32;
            let (s, t) = (f64::from(i * 7 % 40) / 40.0, 0.5f64.powi(i as i32 % 9) - 0.001);
            let folded = kind == SplitKind::Triangle && s + t > 1.0;
            let (s, t) = if folded { (1.0 - s, 1.0 - t) } else { (s, t) };
            points.push(SurfacePoint { face, corner, s, t });
        }
        points.push(SurfacePoint { face, corner: 0, s: 0.0, t: 0.0 });
    }
    let found = surface.evaluate_vectors(&x, &form, &points).unwrap();
    let jets = surface.evaluate_0(&x, &points).unwrap();
    let forms = surface.evaluate_1(&form, &points).unwrap();
    for (i, ((found, jet), [a, b])) in found.iter().zip(&jets).zip(&forms).enumerate() {
        assert_eq!(found.position, *jet, "{name}");
        assert_eq!(found.components, [a.value, b.value], "{name}");
        if points[i].s + points[i].t == 0.0 {
            continue; // where there need not be two tangents
        }
        let [ts, tt] = jet.derivatives;
        let normal = ts.cross(&tt);
        let scale = found.vector.norm() * ts.norm().max(tt.norm());
        assert!(
            (found.vector.dot(&ts) - a.value).abs() <= 1e-9 * scale,
            "{name} {scheme:?}: {:?} {found:?}",
            points[i]
        );
        assert!(
            (found.vector.dot(&tt) - b.value).abs() <= 1e-9 * scale,
            "{name} {scheme:?}: {:?} {found:?}",
            points[i]
        );
        assert!(found.vector.dot(&normal).abs() <= 1e-9 * found.vector.norm() * normal.norm(), "{name}");
    }

    // Bit by bit the same in any order, alone, and on any number of threads.
    let stride = (3..).find(|stride| points.len() % stride != 0).unwrap();
    let order: Vec<usize> = (0..points.len()).map(|i| i * stride % points.len()).collect();
    let shuffled: Vec<SurfacePoint> = order.iter().map(|&i| points[i]).collect();
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let again = pool.install(|| surface.evaluate_vectors(&x, &form, &shuffled).unwrap());
        assert!(order.iter().zip(&again).all(|(&i, again)| *again == found[i]), "{name}");
    }
    for i in (0..points.len()).step_by(17) {
        assert_eq!(surface.evaluate_vectors(&x, &form, &points[i..=i]).unwrap(), found[i..=i], "{name}");
    }
}

#[test]
fn points_do_not_depend_on_each_other() {
    let catmark = Scheme::default();
    let cuts: Vec<u8> = (0..20).map(|i| 1 + i % 7).collect();
    assert_consistent("torus", grid(4, 4, true), catmark);
    assert_consistent("polygons", cut_grid(5, 4, true, &cuts), catmark);
    let creases =
        vec![Crease { vertices: [0, 1], sharpness: 2.5 }, Crease { vertices: [1, 2], sharpness: 10.0 }];
    assert_consistent("creased", Descriptor { creases, ..grid(4, 4, false) }, catmark);
    for variant in [Variant::Loop, Variant::ModifiedLoop] {
        for boundary in [BoundaryRule::Reflect, BoundaryRule::Thesis] {
            let scheme = Scheme::Loop(variant, boundary);
            assert_consistent("bipyramid", bipyramid(7), scheme);
            assert_consistent("triangles", cut_grid(4, 4, false, &[1, 2].repeat(8)), scheme);
        }
    }
}

#[test]
fn the_first_wrong_point_is_named() {
    let surface = LimitSurface::new(&Cage::new(grid(4, 4, true)).unwrap(), Scheme::default()).unwrap();
    let x = surface.refine(&Cochain::<0>::zeros(16));
    let mut points = vec![SurfacePoint { face: 3, corner: 1, s: 0.25, t: 1.0 }; 5000];
    points[1234].t = 1.5;
    points[4321].face = 16;
    assert_eq!(surface.evaluate_0(&x, &points).unwrap_err(), surface.check(&points[1234]).unwrap_err());
    assert!(surface.check(&points[1233]).is_ok());
    assert!(surface.check(&points[4321]).is_err());
}
