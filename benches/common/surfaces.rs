//! The surfaces of the benchmarks.

use formwork::cochain::{Cochain, Quantity};
use formwork::hierarchy::Hierarchy;
use formwork::scheme::Scheme;
use formwork::topology::{Cage, Crease, Descriptor};

use super::{Random, meshes};

/// Loop, with everything at its default.
pub const LOOP: Scheme =
    Scheme::Loop(formwork::scheme::Variant::Loop, formwork::scheme::BoundaryRule::Reflect);

/// Quads and triangles, regular and irregular, of about as many faces as asked for (those of the irregular quads
/// counted after the first split, by four).
pub fn all(faces: usize) -> [(&'static str, Cage, Scheme); 4] {
    let quads = (faces as f64).sqrt().round() as u32;
    let triangles = (faces as f64 / 2.0).sqrt().round() as u32;
    [
        ("regular quads", Cage::new(meshes::grid(quads, quads, false)).unwrap(), Scheme::default()),
        ("irregular quads", irregular(quads), Scheme::default()),
        ("regular triangles", cut(triangles, |_| 1), LOOP),
        ("irregular triangles", cut(triangles, |random| 1 + random.below(2) as u8), LOOP),
    ]
}

/// A grid with two cells in seven cut into triangles, one in seven merged where it can be, and one edge in
/// fifty creased.
pub fn irregular(side: u32) -> Cage {
    let mut random = Random::new();
    let cuts: Vec<u8> = (0..side * side).map(|_| 1 + random.below(7) as u8).collect();
    creased(meshes::cut_grid(side, side, false, &cuts), &mut random)
}

/// A grid with each cell cut along one of its diagonals; where that is random valences run from 4 to 8, and
/// one edge in fifty is creased.
fn cut(side: u32, mut way: impl FnMut(&mut Random) -> u8) -> Cage {
    let mut random = Random::new();
    let cuts: Vec<u8> = (0..side * side).map(|_| way(&mut random)).collect();
    let mixed = cuts.iter().any(|&cut| cut != cuts[0]);
    let descriptor = meshes::cut_grid(side, side, false, &cuts);
    if mixed { creased(descriptor, &mut random) } else { Cage::new(descriptor).unwrap() }
}

fn creased(mut d: Descriptor, random: &mut Random) -> Cage {
    let mut start = 0;
    for &size in &d.face_sizes {
        let edge = [d.face_vertices[start], d.face_vertices[start + 1]];
        start += size as usize;
        if random.below(25) == 0 {
            d.creases.push(Crease { vertices: edge, sharpness: [1.5, 10.0][random.below(2) as usize] });
        }
    }
    Cage::new(d).unwrap()
}

/// A 1-form on the cage.
pub fn form<T: Quantity + From<f32>>(hierarchy: &Hierarchy) -> Cochain<1, T> {
    let value = |e: usize| T::from((e as f32 * 0.37).sin());
    Cochain::new((0..hierarchy.level(0).mesh().num_edges()).map(value).collect())
}
