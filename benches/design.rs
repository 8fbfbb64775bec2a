//! Hodge decomposition and design on closed surfaces of about 100 000 faces: what is set up once, and what each
//! decomposition and each change of the features costs after that. Orthogonality is printed beside the times.

mod common;
#[path = "../tests/common/solids.rs"]
mod solids;

use std::hint::black_box;
use std::time::Instant;

use common::{RUNS, Random, meshes, paired};
use formwork::cochain::Cochain;
use formwork::design::{Hodge, Homology, InnerProduct, Metric, Place, Source, Spec, Vortex};
use formwork::limit::LimitSurface;
use formwork::nalgebra::Vector3;
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::topology::Cage;
use solids::{Positions, refined, triangles, voxels};

fn main() {
    println!("seconds; set-up once, the rest medians of {RUNS}; {} threads", rayon_threads());
    let catmark = Scheme::default();
    let loop_ = Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);
    let plate = || voxels([15, 9, 3], |[x, y, _]| !(y / 3 == 1 && (x / 3) % 2 == 1));
    let cube = || voxels([1, 1, 1], |_| true);
    let wanted = std::env::args().skip(1).find(|arg| !arg.starts_with('-')).unwrap_or_default();
    let cases: [(&str, (Cage, Positions), Scheme); 3] = [
        ("quads, genus 0", refine(cube(), catmark, 7, false), catmark),
        ("quads, genus 2", refine(plate(), catmark, 4, false), catmark),
        ("triangles, genus 2", refine(solids::slab(2), loop_, 5, true), loop_),
    ];
    for (name, (cage, positions), scheme) in cases.into_iter().filter(|(name, ..)| name.contains(&wanted)) {
        measure(name, &cage, &positions, scheme);
    }
}

fn rayon_threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

fn refine(
    (d, positions): (formwork::topology::Descriptor, Positions),
    scheme: Scheme,
    levels: usize,
    cut: bool,
) -> (Cage, Positions) {
    let cage = Cage::new(if cut { triangles(&d) } else { d }).unwrap();
    refined(&cage, scheme, &positions, levels)
}

fn measure(name: &str, cage: &Cage, positions: &Cochain<0, Vector3<f64>>, scheme: Scheme) {
    let mut random = Random::new();
    let lap = |start: &mut Instant| {
        let seconds = start.elapsed().as_secs_f64();
        *start = Instant::now();
        seconds
    };
    let mut clock = Instant::now();
    let surface = LimitSurface::new(cage, scheme).unwrap();
    let surface_time = lap(&mut clock);
    let product = InnerProduct::limit(&surface, positions);
    let product_time = lap(&mut clock);
    let homology = Homology::new(surface.hierarchy().level(0).mesh(), &[]).unwrap();
    let homology_time = lap(&mut clock);
    let hodge = Hodge::with_product(&surface, positions, Metric::Limit, product, homology).unwrap();
    let factor_time = lap(&mut clock);
    let mesh = hodge.mesh();
    println!(
        "\n{name}: {} faces, refined {} times to be evaluated, {} harmonic fields, {:.1} M entries in the factor",
        mesh.num_faces(),
        surface.hierarchy().num_levels(),
        hodge.homology().generators().len(),
        hodge.factor_entries() as f64 / 1e6
    );
    println!("  set-up: surface {surface_time:.2}, masses {product_time:.2}, trees {homology_time:.3}");
    println!("  factor and harmonic fields {factor_time:.2}");

    let c: Cochain<1> = Cochain::new((0..mesh.num_edges()).map(|_| random.unit() - 0.5).collect());
    let (v, f) = (mesh.num_vertices() as u32, mesh.num_faces() as u32);
    let spec = |random: &mut Random| Spec {
        sources: [1.0, -1.0]
            .map(|strength| Source { place: Place::Cell(random.below(v)), strength })
            .to_vec(),
        vortices: [1.0, -1.0]
            .map(|strength| Vortex { place: Place::Cell(random.below(f)), strength })
            .to_vec(),
        ..Spec::default()
    };
    let times = paired([&mut || drop(black_box(hodge.decompose(&c))), &mut || {
        drop(black_box(hodge.design(&spec(&mut random)).unwrap()));
    }]);
    let parts = hodge.decompose(&c);
    let product = |a: &Cochain<1>, b: &Cochain<1>| -> f64 {
        a.values().iter().zip(hodge.mass(b).values()).map(|(x, y)| x * y).sum()
    };
    let cosine = |a, b| product(a, b).abs() / (product(a, a) * product(b, b)).sqrt().max(f64::MIN_POSITIVE);
    let worst = [
        cosine(&parts.exact, &parts.coexact),
        cosine(&parts.exact, &parts.harmonic),
        cosine(&parts.coexact, &parts.harmonic),
    ];
    println!(
        "  decomposition {:.3}, parts orthogonal to {:.1e}",
        times[0] / 1e3,
        worst.into_iter().fold(0.0, f64::max)
    );
    println!("  design with other sources and vortices {:.3}", times[1] / 1e3);
}
