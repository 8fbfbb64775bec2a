//! Forms at points: limits inside cells, curl and divergence.

use formwork::cochain::Cochain;
use formwork::nalgebra::Vector3;
use formwork::octet::{Hierarchy, Linear, Sampler, Scheme};

use super::common::random;
use super::volumes::{Solid, affine_oct, delaunay, lattice, oct, ring};

type Vec3 = Vector3<f64>;

/// Circulations and fluxes of `a + b x p` and `a + k p`.
fn fields(solid: &Solid, a: Vec3, b: Vec3, k: f64) -> (Cochain<1>, Cochain<2>) {
    let x = |v: u32| solid.positions[v as usize];
    let along =
        solid.complex.edges().iter().map(|&[p, q]| (a + b.cross(&((x(p) + x(q)) / 2.0))).dot(&(x(q) - x(p))));
    let through = (0..solid.complex.num_cells(2) as u32).map(|t| {
        let [p, q, r] = solid.complex.triangle_vertices(t).map(x);
        (a + (p + q + r) * (k / 3.0)).dot(&(q - p).cross(&(r - p))) / 2.0
    });
    (Cochain::new(along.collect()), Cochain::new(through.collect()))
}

fn points(solid: &Solid, seed: u64) -> Vec<Vec3> {
    let inside = random(4 * 200, seed);
    let cells = solid.complex.num_cells(3);
    let point = |(i, weights): (usize, &[f64])| {
        let vertices = solid.complex.cell_vertices((i % cells) as u32);
        let corners: Vec<Vec3> = vertices.iter().map(|&v| solid.positions[v as usize]).collect();
        let centre = corners.iter().sum::<Vec3>() / corners.len() as f64;
        let to = corners[i % corners.len()] * weights[0].abs() + centre * (1.0 - weights[0].abs());
        // Off the planes through four vertices of an octahedron.
        let to = to + (corners[(i + 1) % corners.len()] - to) * (0.1 + 0.2 * weights[1].abs());
        to + (corners[(i + 2) % corners.len()] - to) * (0.1 + 0.2 * weights[2].abs())
    };
    inside.chunks(4).enumerate().map(point).collect()
}

/// Fields that Whitney forms hold exactly come out at every point, with their curl and divergence.
#[test]
fn simple_fields_are_found_at_points() {
    let (a, b, k) = (Vec3::new(0.4, -1.0, 0.7), Vec3::new(-0.2, 0.9, 0.5), 1.3);
    for solid in [ring(5), delaunay(40, 3), lattice(3, false), affine_oct()] {
        for solid in [solid.scrambled(4), solid] {
            let sampler = Sampler::new(&solid.complex, &solid.positions);
            let (w, f) = fields(&solid, a, b, k);
            let curl = w.exterior_derivative(&solid.complex);
            let divergence = f.exterior_derivative(&solid.complex);
            let height = Cochain::<0>::new(solid.positions.values().iter().map(|p| p.dot(&a)).collect());
            for x in points(&solid, 5) {
                let name = &solid.name;
                let near = |found: Vec3, expected: Vec3| (found - expected).norm() < 1e-9;
                assert!(near(sampler.vector(&w, x).expect(name), a + b.cross(&x)), "{name} {x}");
                assert!(near(sampler.flux(&f, x).unwrap(), a + x * k), "{name} {x}");
                assert!(near(sampler.flux(&curl, x).unwrap(), b * 2.0), "{name} {x}");
                // Random orders of the cells turn some of them: a density is a number a volume all the same.
                let found = sampler.density(&divergence, x).unwrap();
                assert!((found - 3.0 * k).abs() < 1e-9, "{name} {x}: {found}");
                assert!((sampler.value(&height, x).unwrap() - x.dot(&a)).abs() < 1e-12, "{name}");
            }
        }
    }
}

#[test]
fn outside_there_is_nothing() {
    let solid = delaunay(30, 9);
    let sampler = Sampler::new(&solid.complex, &solid.positions);
    let form = Cochain::<1>::zeros(solid.complex.num_cells(1));
    for x in [Vec3::new(5.0, 0.0, 0.0), Vec3::new(0.0, -1.7, 0.0), Vec3::new(f64::NAN, 0.0, 0.0)] {
        assert_eq!(sampler.vector(&form, x), None);
    }
}

/// In an octahedron too, the sampler is the limit: on a finer level it finds the same, in the tetrahedra there.
#[test]
fn in_an_octahedron_the_limit_is_found() {
    let solid = oct();
    let hierarchy =
        Hierarchy::new(solid.complex.clone(), Scheme { linear: Linear::default(), smoothing: None }, 3)
            .unwrap();
    let (w, f) = (Cochain::<1>::new(random(12, 1)), Cochain::<2>::new(random(8, 2)));
    let m = Cochain::<3>::new(vec![0.7]);
    let x = hierarchy.subdivide(&solid.positions);
    let (fine_w, fine_f, fine_m) =
        (hierarchy.subdivide(&w), hierarchy.subdivide(&f), hierarchy.subdivide(&m));
    let (coarse, fine) =
        (Sampler::new(&solid.complex, &solid.positions), Sampler::new(hierarchy.finest(), &x));
    let mut in_tets = 0;
    for p in points(&solid, 8) {
        let Some(cell) = fine.locate(p) else { continue };
        in_tets += usize::from((cell as usize) < hierarchy.finest().tets().len());
        let near = |a: Vec3, b: Vec3| (a - b).norm() < 1e-9 * (1.0 + b.norm());
        assert!(near(coarse.vector(&w, p).unwrap(), fine.vector(&fine_w, p).unwrap()), "{p}");
        assert!(near(coarse.flux(&f, p).unwrap(), fine.flux(&fine_f, p).unwrap()), "{p}");
        let (a, b) = (coarse.density(&m, p).unwrap(), fine.density(&fine_m, p).unwrap());
        assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{p}");
    }
    assert!(in_tets > 50);
}
