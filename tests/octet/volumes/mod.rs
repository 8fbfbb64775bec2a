//! Solids for tests: complexes, and positions of their vertices.
#![allow(dead_code)] // each test binary uses its own part

mod delaunay;

use std::collections::BTreeMap;

use formwork::cochain::Cochain;
use formwork::nalgebra::Vector3;
use formwork::octet::Complex;

use super::common::random;

/// The parameters that are tried: the default, both ends of the thesis' range and of the true one, and one beyond.
pub const PARAMETERS: [f64; 6] = [-5.0, -7.0, -6.9, 0.0, 1.0, 3.5];

pub struct Solid {
    pub name: String,
    pub complex: Complex,
    pub positions: Cochain<0, Vector3<f64>>,
}

impl Solid {
    fn new(name: &str, points: Vec<Vector3<f64>>, tets: Vec<[u32; 4]>, octs: Vec<[u32; 6]>) -> Self {
        let complex = Complex::new(points.len(), tets, octs).unwrap();
        Solid { name: name.into(), complex, positions: Cochain::new(points) }
    }

    /// The same solid with its vertices, edges and triangles numbered at random, and everything turned at random.
    pub fn scrambled(&self, seed: u64) -> Solid {
        let random = |len, salt| random(len, seed + salt);
        let order = |len: usize, salt| -> Vec<usize> {
            let key = random(len, salt);
            let mut order: Vec<usize> = (0..len).collect();
            order.sort_by(|&a, &b| key[a].total_cmp(&key[b]));
            order
        };
        let old = &self.complex;
        let from = order(old.num_cells(0), 1);
        let mut to = vec![0u32; from.len()];
        from.iter().enumerate().for_each(|(new, &v)| to[v] = new as u32);
        let flip = random(old.num_cells(1), 2);
        let edges = order(flip.len(), 3).into_iter().map(|e| {
            let [a, b] = old.edges()[e].map(|v| to[v as usize]);
            if flip[e] < 0.0 { [a, b] } else { [b, a] }
        });
        let flip = random(old.num_cells(2), 4);
        let triangles: Vec<[u32; 3]> = order(flip.len(), 5)
            .into_iter()
            .map(|t| {
                let [a, b, c] = old.triangle_vertices(t as u32).map(|v| to[v as usize]);
                if flip[t] < -0.5 {
                    [b, c, a]
                } else if flip[t] < 0.5 {
                    [b, a, c]
                } else {
                    [c, a, b]
                }
            })
            .collect();
        let flip = random(old.num_cells(3), 6);
        let tets = order(old.tets().len(), 7).into_iter().map(|t| {
            let [a, b, c, d] = old.tets()[t].map(|v| to[v as usize]);
            if flip[t] < 0.0 { [c, a, d, b] } else { [d, a, c, b] }
        });
        let octs = order(old.octs().len(), 8).into_iter().map(|o| {
            let [a, b, c, d, e, f] = old.octs()[o].map(|v| to[v as usize]);
            if flip[old.tets().len() + o] < 0.0 { [e, f, a, b, c, d] } else { [b, d, f, e, a, c] }
        });
        let complex =
            Complex::with_sides(from.len(), edges.collect(), &triangles, tets.collect(), octs.collect())
                .unwrap();
        let positions = Cochain::new(from.iter().map(|&v| self.positions[v]).collect());
        Solid { name: format!("{}, scrambled", self.name), complex, positions }
    }
}

/// Points with random numbers added.
fn moved(points: &[[f64; 3]], by: f64, seed: u64) -> Vec<Vector3<f64>> {
    let noise = random(3 * points.len(), seed);
    points.iter().enumerate().map(|(i, p)| Vector3::from_fn(|k, _| p[k] + by * noise[3 * i + k])).collect()
}

const UNITS: [[f64; 3]; 6] =
    [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [-1., 0., 0.], [0., -1., 0.], [0., 0., -1.]];

pub fn tet() -> Solid {
    let points = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    Solid::new("tetrahedron", moved(&points, 0.1, 1), vec![[0, 1, 2, 3]], vec![])
}

pub fn oct() -> Solid {
    Solid::new("octahedron", moved(&UNITS, 0.1, 2), vec![], vec![[0, 1, 2, 3, 4, 5]])
}

/// An affine image of the regular octahedron.
pub fn affine_oct() -> Solid {
    let a = random(12, 3);
    let map =
        |p: [f64; 3]| Vector3::from_fn(|i, _| a[9 + i] + (0..3).map(|k| a[3 * i + k] * p[k]).sum::<f64>());
    Solid::new("affine octahedron", UNITS.map(map).to_vec(), vec![], vec![[0, 1, 2, 3, 4, 5]])
}

/// `n` tetrahedra round an edge.
pub fn ring(n: u32) -> Solid {
    let angle = |i: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
    let mut points = vec![[0., 0., -1.], [0., 0., 1.]];
    points.extend((0..n).map(|i| [angle(i).cos(), angle(i).sin(), 0.]));
    let tets = (0..n).map(|i| [0, 1, 2 + i, 2 + (i + 1) % n]).collect();
    Solid::new(&format!("ring of {n}"), moved(&points, 0.05, u64::from(n)), tets, vec![])
}

/// The lattice cells with even points in `[0, size]^3`, or, `periodic`, the lattice modulo `size`.
pub fn lattice(size: i32, periodic: bool) -> Solid {
    let wrap = |p: [i32; 3]| if periodic { p.map(|x| x.rem_euclid(size)) } else { p };
    let mut numbers = BTreeMap::new();
    let mut points = Vec::new();
    let range = if periodic { 0..size } else { 0..size + 1 };
    for p in range.clone().flat_map(|x| range.clone().flat_map(move |y| (0..=size).map(move |z| [x, y, z]))) {
        if (p[0] + p[1] + p[2]) % 2 == 0 && range.contains(&p[2]) {
            numbers.insert(p, points.len() as u32);
            points.push(p.map(f64::from));
        }
    }
    let number = |p: [i32; 3]| numbers.get(&wrap(p)).copied();
    let (mut tets, mut octs) = (Vec::new(), Vec::new());
    for x in 0..=size {
        for y in 0..=size {
            for z in 0..=size {
                if periodic && [x, y, z].contains(&size) {
                    continue;
                }
                let at = |d: [i32; 3]| number([x + d[0], y + d[1], z + d[2]]);
                let even = (x + y + z) % 2 == 0;
                let corners = if even {
                    [[0, 0, 0], [0, 1, 1], [1, 0, 1], [1, 1, 0]]
                } else {
                    [[1, 1, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
                };
                if let [Some(a), Some(b), Some(c), Some(d)] = corners.map(at) {
                    tets.push([a, b, c, d]);
                }
                let units = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]];
                if let ([Some(a), Some(b), Some(c), Some(d), Some(e), Some(f)], false) = (units.map(at), even)
                {
                    octs.push([a, b, c, d, e, f]);
                }
            }
        }
    }
    let name = if periodic { "periodic lattice" } else { "lattice" };
    Solid::new(&format!("{name} of {size}"), moved(&points, 0.0, 4), tets, octs)
}

/// An octahedron with a tetrahedron on each face.
pub fn stella() -> Solid {
    let mut points = UNITS.to_vec();
    let mut tets = Vec::new();
    for face in formwork::octet::OCT_FACES {
        let [a, b, c] = face.map(|v| UNITS[v]);
        points.push(std::array::from_fn(|k| a[k] + b[k] + c[k]));
        tets.push([face[0] as u32, face[1] as u32, face[2] as u32, points.len() as u32 - 1]);
    }
    Solid::new("octahedron in eight tetrahedra", moved(&points, 0.1, 5), tets, vec![[0, 1, 2, 3, 4, 5]])
}

/// Two octahedra that share a face.
pub fn two_octs() -> Solid {
    let mut points = UNITS.to_vec();
    points.extend(
        [[2. / 3., 2. / 3., -1. / 3.], [-1. / 3., 2. / 3., 2. / 3.], [2. / 3., -1. / 3., 2. / 3.]]
            .map(|p: [f64; 3]| p.map(|x| x + 2. / 3.)),
    );
    Solid::new("two octahedra", moved(&points, 0.1, 6), vec![], vec![[0, 1, 2, 3, 4, 5], [0, 1, 2, 7, 8, 6]])
}

/// The Delaunay tetrahedra of random points.
pub fn delaunay(points: usize, seed: u64) -> Solid {
    let x = random(3 * points, seed);
    let points: Vec<Vector3<f64>> = x.chunks(3).map(|p| Vector3::new(p[0], p[1], p[2])).collect();
    let tets = delaunay::tetrahedra(&points);
    Solid::new(&format!("Delaunay of {} points", points.len()), points, tets, vec![])
}

/// Small solids of every kind.
pub fn zoo() -> Vec<Solid> {
    let mut zoo = vec![tet(), oct(), affine_oct(), stella(), two_octs(), lattice(3, false), lattice(4, true)];
    zoo.extend([3, 4, 5, 6].map(ring));
    zoo.push(delaunay(25, 7));
    let scrambled: Vec<Solid> = zoo.iter().zip(50..).map(|(solid, seed)| solid.scrambled(seed)).collect();
    zoo.extend(scrambled);
    zoo
}
