//! Designs tangent fields in the manner of the thesis' Figures 4.8 to 4.12 and draws them, streamline by streamline:
//! a source and sinks on a tetrahedron, two vortices on a torus, hair on a head that is open at the neck, and a harmonic
//! field of genus 2.
//!
//! ```text
//! cargo run --release --example 03_design -- [FOLDER [tetrahedron|torus|head|genus2]]
//! ```

use std::error::Error;
use std::path::Path;

use formwork::cochain::Cochain;
use formwork::design::{Condition, Hodge, Metric, Place, Source, Spec, VectorAt, Vortex, singularities};
use formwork::io::fields::Fields;
use formwork::io::{self, LoadOptions};
use formwork::limit::{LimitSurface, SurfacePoint};
use formwork::nalgebra::Vector3;
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::topology::{Cage, Descriptor};
use formwork::view::{Layers, Options, View};

type Vec3 = Vector3<f64>;
type Positions = Cochain<0, Vec3>;

/// A cage, what its field shall have, and how its boundary is met.
struct Figure {
    name: &'static str,
    cage: Cage,
    positions: Positions,
    scheme: Scheme,
    spec: Spec,
    conditions: Vec<Condition>,
    /// How many lines, and how long, in diagonals of the surface.
    lines: (usize, f64),
}

fn main() -> Result<(), Box<dyn Error>> {
    let argument = |i| std::env::args().nth(i);
    let folder = argument(1).unwrap_or(".".into());
    for figure in [tetrahedron()?, torus()?, head()?, genus2()?] {
        if argument(2).is_none_or(|name| name == figure.name) {
            draw(&figure, &Path::new(&folder).join(format!("design_{}.png", figure.name)))?;
        }
    }
    Ok(())
}

fn source(vertex: u32, strength: f64) -> Source {
    Source { place: Place::Cell(vertex), strength }
}

/// Figure 4.8: one vertex of a tetrahedron is a source, the others are sinks.
fn tetrahedron() -> Result<Figure, Box<dyn Error>> {
    let cage = Cage::new(Descriptor {
        num_vertices: 4,
        face_sizes: vec![3; 4],
        face_vertices: vec![0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2],
        ..Default::default()
    })?;
    let points = [[0.0, 0.0, 1.0], [0.94, 0.0, -0.33], [-0.47, 0.82, -0.33], [-0.47, -0.82, -0.33]];
    let third = -1.0 / 3.0;
    Ok(Figure {
        name: "tetrahedron",
        cage,
        positions: Cochain::new(points.map(Vec3::from).to_vec()),
        scheme: Scheme::Loop(Variant::ModifiedLoop, BoundaryRule::Reflect),
        spec: Spec {
            sources: vec![source(0, 1.0), source(1, third), source(2, third), source(3, third)],
            ..Spec::default()
        },
        conditions: Vec::new(),
        lines: (700, 0.045),
    })
}

/// Two vortices that turn against each other, and nothing harmonic.
fn torus() -> Result<Figure, Box<dyn Error>> {
    let asset = io::load("assets/torus.obj".as_ref(), &LoadOptions::default())?;
    let vortex = |face, strength| Vortex { place: Place::Cell(face), strength };
    Ok(Figure {
        name: "torus",
        cage: asset.cage()?,
        positions: asset.positions,
        scheme: Scheme::default(),
        spec: Spec { vortices: vec![vortex(105, 1.0), vortex(81, -1.0)], ..Spec::default() },
        conditions: Vec::new(),
        lines: (1100, 0.05),
    })
}

/// A head with a nose, ears and an open neck; hair that leaves a whorl at the crown and falls to the neck, combed to one
/// side on the forehead.
fn head() -> Result<Figure, Box<dyn Error>> {
    const N: i32 = 12;
    let (mut numbers, mut points, mut faces) = (std::collections::HashMap::new(), Vec::new(), Vec::new());
    for (axis, side) in (0..6).map(|i| (i / 2, i % 2)) {
        for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
            let mut ring = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(a, b)| {
                let mut key = [0; 3];
                (key[axis], key[(axis + 1) % 3], key[(axis + 2) % 3]) = (side as i32 * N, a, b);
                key
            });
            if side == 0 {
                ring.reverse();
            }
            let lattice = |key: [i32; 3]| {
                let angle =
                    |x: i32| (std::f64::consts::FRAC_PI_4 * f64::from(2 * x - N) / f64::from(N)).tan();
                Vec3::from(key.map(angle)).normalize()
            };
            let middle = ring.iter().map(|&key| lattice(key)).sum::<Vec3>() / 4.0;
            if middle.z < -0.86 {
                continue; // the neck
            }
            faces.push(ring.map(|key| {
                *numbers.entry(key).or_insert_with(|| {
                    points.push(on_head(lattice(key)));
                    points.len() as u32 - 1
                })
            }));
        }
    }
    let nearest = |target: Vec3| {
        let distance = |v: &usize| (points[*v] - target).norm();
        (0..points.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0) as u32
    };
    let crown = nearest(Vec3::new(0.12, -0.12, 1.1));
    let face_at = |target: Vec3| {
        let middle = |f: &[u32; 4]| f.iter().map(|&v| points[v as usize]).sum::<Vec3>() / 4.0;
        let distance = |i: &usize| (middle(&faces[*i]) - target).norm();
        (0..faces.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0) as u32
    };
    let whorl = face_at(points[crown as usize]);
    let forehead = SurfacePoint { face: face_at(Vec3::new(0.1, -0.95, 0.45)), corner: 0, s: 0.5, t: 0.5 };
    let spec = Spec {
        sources: vec![source(crown, 3.0)],
        vortices: vec![Vortex { place: Place::Cell(whorl), strength: 2.0 }],
        vectors: vec![VectorAt { point: forehead, vector: Vec3::new(1.5, 0.0, -0.6), weight: None }],
        // Normal at the neck: curl has nowhere to go, and is taken off evenly.
        balance: true,
        ..Spec::default()
    };
    let descriptor = Descriptor {
        num_vertices: points.len(),
        face_sizes: vec![4; faces.len()],
        face_vertices: faces.concat(),
        ..Default::default()
    };
    Ok(Figure {
        name: "head",
        cage: Cage::new(descriptor)?,
        positions: Cochain::new(points),
        scheme: Scheme::default(),
        spec,
        conditions: vec![Condition::Normal],
        lines: (1800, 0.035),
    })
}

/// Where a direction of the sphere is on the head.
fn on_head(d: Vec3) -> Vec3 {
    let bump = |x: f64, y: f64, z: f64, width: f64| {
        (-(d - Vec3::new(x, y, z).normalize()).norm_squared() / (width * width)).exp()
    };
    let mut p = Vec3::new(0.76 * d.x, 0.92 * d.y, 1.12 * d.z);
    p += Vec3::new(0.0, -0.50, -0.10) * bump(0.0, -1.0, -0.16, 0.19); // nose
    p += Vec3::new(0.0, -0.16, 0.0) * bump(0.0, -1.0, 0.30, 0.4); // brow
    p += Vec3::new(0.0, -0.42, -0.05) * bump(0.0, -0.8, -0.62, 0.28); // chin
    for side in [-1.0, 1.0] {
        p += Vec3::new(0.0, 0.20, 0.0) * bump(0.38 * side, -0.93, 0.05, 0.17); // eyes
        p += Vec3::new(0.34 * side, 0.12, 0.0) * bump(side, 0.1, -0.1, 0.2); // ears
    }
    // The neck goes down from the jaw.
    let down = ((-d.z - 0.62) / 0.3).clamp(0.0, 1.0);
    p + Vec3::new(0.0, 0.12, -0.35) * down * down
}

/// The harmonic field with unit circulation round one handle of a plate with two windows.
fn genus2() -> Result<Figure, Box<dyn Error>> {
    let asset = io::load("assets/genus2.obj".as_ref(), &LoadOptions::default())?;
    Ok(Figure {
        name: "genus2",
        cage: asset.cage()?,
        positions: asset.positions,
        scheme: Scheme::default(),
        spec: Spec { harmonic: vec![(0, 1.0), (1, 0.6), (2, 0.3), (3, -0.8)], ..Spec::default() },
        conditions: Vec::new(),
        lines: (1300, 0.045),
    })
}

fn draw(figure: &Figure, out: &Path) -> Result<(), Box<dyn Error>> {
    let surface = LimitSurface::new(&figure.cage, figure.scheme)?;
    let hodge = Hodge::new(&surface, &figure.positions, Metric::Limit, &figure.conditions)?;
    let field = hodge.design(&figure.spec)?.cochain;
    let zeros = singularities(&surface, &figure.positions, &field, 3)?;
    let (lines, length) = figure.lines;
    let options = Options {
        levels: if figure.name == "tetrahedron" { 6 } else { 4 },
        lines,
        length,
        layers: Layers { cage: false, ..Layers::default() },
        potential: Some(hodge.decompose(&field).potential),
        ..Options::default()
    };
    let fields = Fields { form1: Some(field), ..Fields::default() };
    let view = View::new(&figure.cage, figure.scheme, &figure.positions, &fields, &options)?;
    std::fs::write(out, view.picture([1400, 1000])?.encode_png()?)?;
    println!(
        "{}: {} harmonic fields, {} zeros, indices {} = Euler {} + boundary {}",
        out.display(),
        hodge.homology().generators().len(),
        zeros.zeros.len(),
        zeros.index_sum,
        zeros.euler,
        zeros.boundary_turns
    );
    Ok(())
}
