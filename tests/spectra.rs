//! The spectra of the triangle schemes round a vertex: Lemma 3.32, (4.1) and B.2 of Ke Wang's thesis, and
//! the eigenvalue 1/2 that modified Loop is made for.

mod common;

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use approx::assert_abs_diff_eq;
use common::meshes::polygons;
use common::step::Step;
use common::triangle_schemes;
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::sparse::{Csr, row_of};
use formwork::topology::{Descriptor, Parent};
use nalgebra::DMatrix;

fn loop_(variant: Variant) -> Scheme {
    Scheme::Loop(variant, BoundaryRule::default())
}

/// A disk of `sectors` lattice sectors round vertex 0, three rings deep, with a key for every vertex that
/// is the same on every level: sector, and lattice coordinates from the centre.
struct Disk {
    keys: Vec<(usize, i32, i32)>,
    descriptor: Descriptor,
}

fn disk(sectors: usize, cyclic: bool) -> Disk {
    const RINGS: i32 = 3;
    let mut keys = vec![(0, 0, 0)];
    let spokes = if cyclic { sectors } else { sectors + 1 };
    for s in 0..spokes {
        let inside = cyclic || s < sectors;
        for i in 1..=RINGS {
            (0..=RINGS - i).filter(|&j| j == 0 || inside).for_each(|j| keys.push((s, i, j)));
        }
    }
    let number = |key| keys.iter().position(|&k| k == key).unwrap() as u32;
    let vertex = |s: usize, i: i32, j: i32| number(normal(s, i, j, spokes));
    let mut faces = Vec::new();
    for s in 0..sectors {
        for i in 0..RINGS {
            for j in 0..RINGS - i {
                faces.push(vec![vertex(s, i, j), vertex(s, i + 1, j), vertex(s, i, j + 1)]);
                if i + j + 2 <= RINGS {
                    faces.push(vec![vertex(s, i + 1, j), vertex(s, i + 1, j + 1), vertex(s, i, j + 1)]);
                }
            }
        }
    }
    Disk { descriptor: polygons(keys.len(), &faces), keys }
}

/// The one name of a lattice point: on a spoke it belongs to the sector that the spoke begins.
fn normal(s: usize, i: i32, j: i32, spokes: usize) -> (usize, i32, i32) {
    match (i, j) {
        (0, 0) => (0, 0, 0),
        (0, j) => ((s + 1) % spokes, j, 0),
        _ => (s % spokes, i, j),
    }
}

/// The blocks of S0, S1 and S2 that map the two inner rings to the two inner rings of the next level.
fn blocks(sectors: usize, cyclic: bool, scheme: Scheme) -> [DMatrix<f64>; 3] {
    let disk = disk(sectors, cyclic);
    let spokes = if cyclic { sectors } else { sectors + 1 };
    let step = Step::new(disk.descriptor, scheme);
    let (coarse, fine) = (step.hierarchy.level(0).mesh(), step.hierarchy.level(1).mesh());
    let split = step.hierarchy.refinement(1).split();
    // A point of the fine lattice is the sum of two coarse ones, both seen from the same sector.
    let seen_from = |(t, i, j): (usize, i32, i32), s: usize| match (t == s, j) {
        _ if (i, j) == (0, 0) => Some((0, 0)),
        (true, _) => Some((i, j)),
        (false, 0) if t == (s + 1) % spokes => Some((0, i)),
        _ => None,
    };
    let fine_keys: Vec<_> = (0..fine.num_vertices())
        .map(|v| match split.vertex_parent(v) {
            Parent::Vertex(v) => {
                let (s, i, j) = disk.keys[v as usize];
                (s, 2 * i, 2 * j)
            }
            Parent::Edge(e) => {
                let [a, b] = coarse.edges()[e as usize].map(|v| disk.keys[v as usize]);
                let sum = |s| Some((seen_from(a, s)?, seen_from(b, s)?));
                let (s, (p, q)) = (0..spokes).find_map(|s| Some((s, sum(s)?))).unwrap();
                normal(s, p.0 + q.0, p.1 + q.1, spokes)
            }
            Parent::Face(_) => unreachable!(),
        })
        .collect();
    // Cells are named by the sorted keys of their vertices; only those of the two inner rings have a name.
    let name = |vertices: &[u32], keys: &[(usize, i32, i32)]| {
        let mut name: Vec<_> = vertices.iter().map(|&v| keys[v as usize]).collect();
        name.sort_unstable();
        name.iter().all(|&(_, i, j)| i + j <= 2).then_some(name)
    };
    let block = |k: usize, matrix: &Csr| {
        let cell = |mesh: &formwork::topology::Mesh, c: usize| match k {
            0 => vec![c as u32],
            1 => mesh.edges()[c].to_vec(),
            _ => mesh.face_vertices(c as u32).to_vec(),
        };
        let mut numbers = BTreeMap::new();
        let mut columns = Vec::new();
        for c in 0..coarse.num_cells(k) {
            let vertices = cell(coarse, c);
            if let Some(name) = name(&vertices, &disk.keys) {
                numbers.insert(name, columns.len());
                columns.push((c, disk.keys[vertices[0] as usize]));
            }
        }
        let mut block = DMatrix::zeros(columns.len(), columns.len());
        let mut rows = 0;
        for c in 0..fine.num_cells(k) {
            let vertices = cell(fine, c);
            let Some(&row) = name(&vertices, &fine_keys).and_then(|name| numbers.get(&name)) else {
                continue;
            };
            rows += 1;
            // An edge may run the other way on the next level.
            let sign = if k == 1 && fine_keys[vertices[0] as usize] != columns[row].1 { -1.0 } else { 1.0 };
            let (indices, weights) = row_of(matrix, c);
            for (&index, &weight) in indices.iter().zip(weights) {
                let column = columns.iter().position(|&(c, _)| c == index as usize);
                block[(row, column.expect("the two inner rings depend on nothing outside"))] = sign * weight;
            }
        }
        assert_eq!(rows, columns.len());
        block
    };
    [block(0, &step.operators.s0), block(1, &step.operators.s1), block(2, &step.operators.s2)]
}

/// The traces of the first powers fix the spectrum, and unlike eigenvalues they are exact to rounding.
fn traces(matrix: &DMatrix<f64>) -> Vec<f64> {
    let mut power = DMatrix::identity(matrix.nrows(), matrix.nrows());
    (0..12)
        .map(|_| {
            power = &power * matrix;
            power.trace()
        })
        .collect()
}

fn assert_spectrum(matrix: &DMatrix<f64>, eigenvalues: &[f64]) {
    assert_eq!(matrix.nrows(), eigenvalues.len());
    for (p, trace) in traces(matrix).into_iter().enumerate() {
        let expected: f64 = eigenvalues.iter().map(|l| l.powi(p as i32 + 1)).sum();
        assert_abs_diff_eq!(trace, expected, epsilon = 1e-13);
    }
}

/// Lemma 3.32: the spectrum of S1 is that of S0 without the eigenvalue 1, together with that of S2.
#[test]
fn spectra_of_edges_are_those_of_vertices_and_faces() {
    for scheme in triangle_schemes() {
        for (sectors, cyclic) in (3..=12).map(|n| (n, true)).chain((1..=5).map(|k| (k, false))) {
            let [s0, s1, s2] = blocks(sectors, cyclic, scheme);
            assert_eq!(s1.nrows(), s0.nrows() - 1 + s2.nrows());
            for ((t0, t1), t2) in traces(&s0).iter().zip(traces(&s1)).zip(traces(&s2)) {
                assert_abs_diff_eq!(t1, t0 - 1.0 + t2, epsilon = 1e-13);
            }
        }
    }
}

/// (4.1): four times S2 has the eigenvalues of beta, 1/4 for each valence and 1/8 twice.
#[test]
fn spectra_of_faces_are_those_of_the_thesis() {
    for n in 3..=12usize {
        let [_, _, s2] = blocks(n, true, loop_(Variant::Loop));
        let own = (0..n).map(|m| if (n, m) == (6, 3) { 0.5 } else { 0.5f64.powi(m.min(n - m) as i32) });
        let all = own.chain(vec![0.25; n]).chain(vec![0.125; 2 * n]).map(|l| l / 4.0);
        assert_spectrum(&s2, &all.collect::<Vec<_>>());
    }
    // B.2, the regular boundary, with the thesis' constants; the printed list has one 1/4 too many.
    let (c, d) = (2.0 / 3.0, 1.0 / 6.0);
    let [_, _, s2] = blocks(3, false, Scheme::Loop(Variant::Loop, BoundaryRule::Thesis));
    let own = [1.0, 1.0 - 3.0 * d, 1.0 - c - d, 1.0 - c - d, -1.0 + 2.0 * c + d];
    let all = own.into_iter().chain([0.25; 3]).chain([0.125; 4]).map(|l| l / 4.0);
    assert_spectrum(&s2, &all.collect::<Vec<_>>());
}

/// `3/8 + cos(2 pi / n)/4` for Loop and 1/2 for modified Loop is an eigenvalue of S0, twice; and what is left of
/// modified Loop once the constants are taken out has no eigenvalue beyond.
#[test]
fn subdominant_eigenvalues_are_known() {
    for variant in [Variant::Loop, Variant::ModifiedLoop] {
        for n in 3..=12usize {
            let [s0, _, _] = blocks(n, true, loop_(variant));
            let size = s0.nrows();
            let lambda = match variant {
                Variant::Loop => 0.375 + (TAU / n as f64).cos() / 4.0,
                Variant::ModifiedLoop => 0.5,
            };
            let singular = |matrix: DMatrix<f64>| matrix.svd(true, false);
            let mut values: Vec<f64> = singular(&s0 - DMatrix::identity(size, size) * lambda)
                .singular_values
                .iter()
                .copied()
                .collect();
            values.sort_by(f64::total_cmp);
            assert!(values[1] < 1e-14, "{variant:?} {n}: {values:?}");
            if variant == Variant::Loop {
                continue;
            }
            assert!(values[2] > 1e-3, "{n}: {values:?}");
            // The left eigenvector of 1 is the left null vector of S0 - 1.
            let svd = singular(&s0 - DMatrix::identity(size, size));
            let left = svd.u.unwrap().column(svd.singular_values.imin()).into_owned();
            let constants = DMatrix::from_element(size, 1, 1.0);
            let rest = (&s0 - &constants * left.transpose() / left.sum()) / lambda;
            let squared = (0..6).fold(rest, |power, _| &power * &power);
            assert_abs_diff_eq!(squared.trace(), 2.0, epsilon = 1e-2);
        }
    }
}
