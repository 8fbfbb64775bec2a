//! Surfaces in space of any genus, closed and bounded, as quads and as triangles.
#![allow(dead_code)] // each user has its own part

use std::collections::HashMap;

use formwork::cochain::Cochain;
use formwork::hierarchy::Hierarchy;
use formwork::nalgebra::Vector3;
use formwork::scheme::Scheme;
use formwork::topology::{Cage, Descriptor};

use super::meshes::polygons;

pub type Positions = Cochain<0, Vector3<f64>>;

/// A cage with its positions, its genus and its number of boundary loops.
pub struct Solid {
    pub name: String,
    pub cage: Cage,
    pub positions: Positions,
    pub genus: usize,
    pub loops: usize,
}

impl Solid {
    pub fn euler(&self) -> i32 {
        2 - 2 * self.genus as i32 - self.loops as i32
    }

    /// The first Betti number.
    pub fn betti(&self) -> usize {
        2 * self.genus + self.loops.saturating_sub(1)
    }
}

/// The surface of the unit cubes of a set, as quads seen from outside.
pub fn voxels(size: [i32; 3], solid: impl Fn([i32; 3]) -> bool) -> (Descriptor, Positions) {
    let inside = |p: [i32; 3]| (0..3).all(|k| (0..size[k]).contains(&p[k])) && solid(p);
    let (mut numbers, mut points, mut faces) = (HashMap::new(), Vec::new(), Vec::new());
    for z in 0..size[2] {
        for y in 0..size[1] {
            for x in 0..size[0] {
                for (axis, side) in (0..6).map(|i| (i / 2, (i % 2) as i32)) {
                    let mut beyond = [x, y, z];
                    beyond[axis] += 2 * side - 1;
                    if !inside([x, y, z]) || inside(beyond) {
                        continue;
                    }
                    let corner = |a: i32, b: i32| {
                        let mut p = [x, y, z];
                        p[axis] += side;
                        p[(axis + 1) % 3] += a;
                        p[(axis + 2) % 3] += b;
                        p
                    };
                    let mut ring = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    if side == 0 {
                        ring.reverse();
                    }
                    let number = |p: [i32; 3]| {
                        *numbers.entry(p).or_insert_with(|| {
                            points.push(Vector3::from(p.map(f64::from)));
                            points.len() as u32 - 1
                        })
                    };
                    faces.push(ring.map(number).to_vec());
                }
            }
        }
    }
    (polygons(points.len(), &faces), Cochain::new(points))
}

/// A slab with `genus` holes.
pub fn slab(genus: i32) -> (Descriptor, Positions) {
    voxels([2 * genus + 1, 3, 1], |[x, y, _]| !(y == 1 && x % 2 == 1))
}

/// Each quad cut in two, along one diagonal or the other.
pub fn triangles(d: &Descriptor) -> Descriptor {
    let halves = d.face_vertices.chunks_exact(4).enumerate().flat_map(|(i, c)| match i % 2 {
        0 => [vec![c[0], c[1], c[2]], vec![c[0], c[2], c[3]]],
        _ => [vec![c[0], c[1], c[3]], vec![c[1], c[2], c[3]]],
    });
    polygons(d.num_vertices, &halves.collect::<Vec<_>>())
}

/// A mesh without some of its faces, and without vertices that have none left.
pub fn without(d: &Descriptor, positions: &Positions, drop: &[usize]) -> (Descriptor, Positions) {
    let size = d.face_sizes[0] as usize;
    let kept: Vec<&[u32]> = d
        .face_vertices
        .chunks_exact(size)
        .enumerate()
        .filter(|(i, _)| !drop.contains(i))
        .map(|(_, f)| f)
        .collect();
    let mut number = vec![u32::MAX; d.num_vertices];
    let mut points = Vec::new();
    let mut faces = Vec::new();
    for face in kept {
        let renamed = face.iter().map(|&v| {
            if number[v as usize] == u32::MAX {
                number[v as usize] = points.len() as u32;
                points.push(positions[v as usize]);
            }
            number[v as usize]
        });
        faces.push(renamed.collect());
    }
    (polygons(points.len(), &faces), Cochain::new(points))
}

/// The mesh of a refined level as a cage of its own.
pub fn refined(cage: &Cage, scheme: Scheme, positions: &Positions, levels: usize) -> (Cage, Positions) {
    let hierarchy = Hierarchy::new(cage, scheme, levels).unwrap();
    let mesh = hierarchy.finest().mesh();
    let faces: Vec<Vec<u32>> = (0..mesh.num_faces() as u32).map(|f| mesh.face_vertices(f).to_vec()).collect();
    (Cage::new(polygons(mesh.num_vertices(), &faces)).unwrap(), hierarchy.subdivide(positions))
}

/// Closed surfaces of genus 0 to 3 and bounded ones, each as quads and as triangles.
pub fn all() -> Vec<Solid> {
    let mut solids = Vec::new();
    let mut add = |name: &str, (d, positions): (Descriptor, Positions), genus: usize, loops: usize| {
        for (kind, d) in [("quads", d.clone()), ("triangles", triangles(&d))] {
            let (name, positions) = (format!("{name}, {kind}"), positions.clone());
            solids.push(Solid { name, cage: Cage::new(d).unwrap(), positions, genus, loops });
        }
    };
    for genus in 0..=3 {
        add(&format!("genus {genus}"), slab(genus as i32), genus, 0);
    }
    let cut = |genus: i32, drop: &[usize]| {
        let (d, positions) = slab(genus);
        without(&d, &positions, drop)
    };
    let far = |genus: i32| slab(genus).0.face_sizes.len() - 1;
    add("disc", cut(0, &[0]), 0, 1);
    add("annulus", cut(0, &[0, far(0)]), 0, 2);
    add("torus with a hole", cut(1, &[0]), 1, 1);
    add("genus 2 with two holes", cut(2, &[0, far(2)]), 2, 2);
    solids
}
