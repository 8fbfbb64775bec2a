//! The smooth schemes: convolution on the lattice, boundaries, and how smooth they are as far as measured.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use formwork::cochain::Cochain;
use formwork::nalgebra::Vector3;
use formwork::octet::{Boundary, Complex, Hierarchy, Linear, Scheme, Smoothing, TET_EDGES, WhitneyTet};

use super::common::random;
use super::volumes::{Solid, delaunay, lattice, ring};
use super::{EXACT, difference};

const PERIOD: i32 = 6;

fn wrapped(p: Vector3<f64>) -> [i32; 3] {
    std::array::from_fn(|k| (p[k].round() as i32).rem_euclid(PERIOD))
}

/// The points of an `r`-cell, unwrapped: near the first.
fn unwrapped(solid: &Solid, r: usize, i: usize) -> Vec<[i32; 3]> {
    let complex = &solid.complex;
    let vertices: Vec<u32> = match r {
        0 => vec![i as u32],
        1 => complex.edges()[i].to_vec(),
        2 => complex.triangle_vertices(i as u32).to_vec(),
        _ => complex.cell_vertices(i as u32).to_vec(),
    };
    let points: Vec<[i32; 3]> = vertices.iter().map(|&v| wrapped(solid.positions[v as usize])).collect();
    let near = |p: &[i32; 3]| {
        std::array::from_fn(|k| {
            points[0][k] + (p[k] - points[0][k] + PERIOD / 2).rem_euclid(PERIOD) - PERIOD / 2
        })
    };
    points.iter().map(near).collect()
}

/// What stays of an order of points when they move: which way round it runs.
fn turn(points: &[[i32; 3]]) -> i32 {
    let p = |i: usize| Vector3::from(points[i].map(f64::from));
    let det = |a: Vector3<f64>, b: Vector3<f64>, c: Vector3<f64>| a.cross(&b).dot(&c);
    let turn = match points.len() {
        1 => 1.0,
        2 => (p(1) - p(0)).dot(&Vector3::new(9.0, 3.0, 1.0)),
        3 => (p(1) - p(0)).cross(&(p(2) - p(0))).dot(&Vector3::new(9.0, 3.0, 1.0)),
        4 => det(p(1) - p(0), p(2) - p(0), p(3) - p(0)),
        _ => det(p(0) - p(3), p(1) - p(4), p(2) - p(5)),
    };
    if turn > 0.0 { 1 } else { -1 }
}

/// (7.1): on the lattice every smooth scheme is one and the same convolution, cell by cell.
#[test]
fn on_the_lattice_smoothing_is_convolution() {
    let solid = lattice(PERIOD, true);
    let steps: Vec<([i32; 3], f64)> = (-2..=2)
        .flat_map(|x| (-2..=2).flat_map(move |y| (-2..=2).map(move |z| [x, y, z])))
        .filter_map(|p: [i32; 3]| {
            let size: i32 = p.iter().map(|x| x * x).sum();
            let axis = p.iter().filter(|x| **x != 0).count() == 1;
            match size {
                0 => Some((p, 1.0 / 8.0)),
                2 => Some((p, 1.0 / 16.0)),
                4 if axis => Some((p, 1.0 / 48.0)),
                _ => None,
            }
        })
        .collect();
    assert_eq!(steps.len(), 19);
    for solid in [solid.scrambled(77), solid] {
        let complex = &solid.complex;
        let smoothing = Smoothing::new(complex, Boundary::Loop);
        assert!((0..complex.num_cells(1) as u32).all(|e| smoothing.is_regular_edge(e)));
        assert!((0..complex.num_cells(2) as u32).all(|t| smoothing.is_regular_triangle(t)));
        let values: [Vec<f64>; 4] = [0, 1, 2, 3].map(|r| random(complex.num_cells(r), 5));
        let [z, w, f, m] = values.clone();
        let smooth = [
            smoothing.apply(complex, &Cochain::<0>::new(z)).into_values(),
            smoothing.apply(complex, &Cochain::<1>::new(w)).into_values(),
            smoothing.apply(complex, &Cochain::<2>::new(f)).into_values(),
            smoothing.apply(complex, &Cochain::<3>::new(m)).into_values(),
        ];
        for r in 0..4 {
            let key = |points: &[[i32; 3]], step: [i32; 3]| {
                let mut key: Vec<[i32; 3]> = points
                    .iter()
                    .map(|p| std::array::from_fn(|k| (p[k] + step[k]).rem_euclid(PERIOD)))
                    .collect();
                key.sort_unstable();
                key
            };
            let cells: Vec<_> = (0..complex.num_cells(r)).map(|i| unwrapped(&solid, r, i)).collect();
            let numbers: BTreeMap<_, usize> = cells.iter().map(|p| key(p, [0; 3])).zip(0..).collect();
            let convolved: Vec<f64> = cells
                .iter()
                .map(|points| {
                    let term = |&(step, weight): &([i32; 3], f64)| {
                        let j = numbers[&key(points, step)];
                        weight * values[r][j] * f64::from(turn(points) * turn(&cells[j]))
                    };
                    steps.iter().map(term).sum()
                })
                .collect();
            let deviation = difference(&convolved, &smooth[r]);
            assert!(deviation < EXACT, "{}, r {r}: {deviation:e}", solid.name);
        }
    }
}

/// The boundary is smoothed by itself, what flows out of it does not change, and the total of a 3-form is kept.
#[test]
fn boundaries_keep_to_themselves() {
    for boundary in [Boundary::Loop, Boundary::Fixed] {
        for solid in [ring(5), delaunay(30, 2), lattice(3, false).scrambled(6)] {
            let scheme = Scheme { linear: Linear::default(), smoothing: Some(boundary) };
            let hierarchy = Hierarchy::new(solid.complex.clone(), scheme, 2).unwrap();
            let (coarse, fine) = (&solid.complex, hierarchy.finest());
            let m = random(coarse.num_cells(3), 3);
            let total = |complex: &Complex, values: &[f64], positions: &Cochain<0, Vector3<f64>>| -> f64 {
                (0..).zip(values).map(|(cell, value)| value * orientation(complex, positions, cell)).sum()
            };
            let before = total(coarse, &m, &solid.positions);
            let refined = hierarchy.subdivide(&Cochain::<3>::new(m));
            let linear = Scheme { linear: Linear::default(), smoothing: None };
            let linear = Hierarchy::new(solid.complex.clone(), linear, 2).unwrap();
            let after = total(fine, refined.values(), &linear.subdivide(&solid.positions));
            assert!((before - after).abs() < 1e-12, "{}: {before} {after}", solid.name);

            // Values inside do not reach the boundary, for any degree.
            let mut on_edge = vec![0; coarse.num_cells(2)];
            (0..coarse.num_cells(3) as u32)
                .for_each(|c| coarse.cell_faces(c).iter().for_each(|f| on_edge[f.triangle() as usize] += 1));
            let inner: Vec<f64> = random(on_edge.len(), 8)
                .iter()
                .zip(&on_edge)
                .map(|(x, &n)| if n == 2 { *x } else { 0.0 })
                .collect();
            let refined = hierarchy.subdivide(&Cochain::<2>::new(inner));
            let mut of_cells = vec![0; fine.num_cells(2)];
            (0..fine.num_cells(3) as u32)
                .for_each(|c| fine.cell_faces(c).iter().for_each(|f| of_cells[f.triangle() as usize] += 1));
            let leak = refined.values().iter().zip(&of_cells).filter(|(_, n)| **n == 1);
            assert!(leak.fold(0.0f64, |worst, (x, _)| worst.max(x.abs())) < 1e-16, "{}", solid.name);
        }
    }
}

/// 1 if a cell is positive where it lies, else -1.
fn orientation(complex: &Complex, x: &Cochain<0, Vector3<f64>>, cell: u32) -> f64 {
    let p: Vec<Vector3<f64>> = complex.cell_vertices(cell).iter().map(|&v| x[v as usize]).collect();
    let volume = match p.len() {
        4 => (p[1] - p[0]).cross(&(p[2] - p[0])).dot(&(p[3] - p[0])),
        _ => (p[0] - p[3]).cross(&(p[1] - p[4])).dot(&(p[2] - p[5])),
    };
    volume.signum()
}

/// Where the boundary is regular, its vertices follow Loop's scheme: 5/8 and 1/16, 3/8 and 1/8.
#[test]
fn boundaries_follow_loop() {
    let solid = lattice(6, false);
    let (coarse, x) = (&solid.complex, &solid.positions);
    let hierarchy =
        Hierarchy::new(coarse.clone(), Scheme { smoothing: Some(Boundary::Loop), ..Default::default() }, 1)
            .unwrap();
    let mut cells = vec![0; coarse.num_cells(2)];
    (0..coarse.num_cells(3) as u32)
        .for_each(|c| coarse.cell_faces(c).iter().for_each(|f| cells[f.triangle() as usize] += 1));
    let mut around: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for t in (0..cells.len()).filter(|&t| cells[t] == 1) {
        let v = coarse.triangle_vertices(t as u32);
        (0..3).for_each(|k| around.entry(v[k]).or_default().extend([v[(k + 1) % 3], v[(k + 2) % 3]]));
    }
    let values = Cochain::<0>::new(random(x.len(), 4));
    let fine = hierarchy.subdivide(&values);
    let mut regular = 0;
    for (v, near) in around.iter().filter(|(_, near)| near.len() == 12) {
        // Each of the six neighbours is listed twice.
        let sum: f64 = near.iter().map(|&w| values[w as usize]).sum::<f64>() / 2.0;
        let expected = 0.625 * values[*v as usize] + sum / 16.0;
        assert!((fine[*v as usize] - expected).abs() < EXACT);
        regular += 1;
    }
    assert!(regular > 0);
}

/// The largest jump between the forms of the tetrahedra at a vertex, for 1-, 2- and 3-forms, over some vertices.
fn jumps(complex: &Complex, x: &Cochain<0, Vector3<f64>>, forms: &Forms, wanted: &[u32]) -> [f64; 3] {
    let mut found: BTreeMap<u32, Vec<[Vector3<f64>; 3]>> = wanted.iter().map(|&v| (v, Vec::new())).collect();
    for (t, v) in complex
        .tets()
        .iter()
        .enumerate()
        .filter(|(_, v)| v.iter().any(|v| found.contains_key(v)))
        .collect::<Vec<_>>()
    {
        let whitney = WhitneyTet::new(v.map(|v| x[v as usize])).expect("no flat cells");
        let sides: Vec<_> =
            complex.cell_faces(t as u32).iter().map(|s| forms.1[s.triangle() as usize] * s.sign()).collect();
        let along = TET_EDGES.map(|[i, j]| {
            let face = (0..4).find(|k| *k != i && *k != j).unwrap();
            let t = complex.cell_faces(t as u32)[face].triangle();
            let h = complex.triangles()[t as usize].into_iter();
            h.map(|h| (complex.edges()[h.edge() as usize], forms.0[h.edge() as usize]))
                .find_map(|(ends, w)| match ends {
                    ends if ends == [v[i], v[j]] => Some(w),
                    ends if ends == [v[j], v[i]] => Some(-w),
                    _ => None,
                })
                .unwrap()
        });
        for own in v.iter().filter(|v| wanted.contains(v)) {
            let p = x[*own as usize];
            let density = Vector3::new(whitney.density(forms.2[t]), 0.0, 0.0);
            let fluxes = [sides[0], sides[1], sides[2], sides[3]];
            found.get_mut(own).unwrap().push([whitney.vector(along, p), whitney.flux(fluxes, p), density]);
        }
    }
    let mut worst = [0.0f64; 3];
    for values in found.values() {
        for (a, b) in values.iter().flat_map(|a| values.iter().map(move |b| (a, b))) {
            (0..3).for_each(|r| worst[r] = worst[r].max((a[r] - b[r]).norm()));
        }
    }
    worst
}

type Forms = (Cochain<1>, Cochain<2>, Cochain<3>);

/// The jumps on some levels, at vertices chosen by `wanted(hierarchy, level, positions)`.
fn measure(
    solid: &Solid,
    levels: RangeInclusive<usize>,
    wanted: impl Fn(&Hierarchy, usize, &Cochain<0, Vector3<f64>>) -> Vec<u32>,
) -> Vec<[f64; 3]> {
    let scheme = Scheme { linear: Linear::default(), smoothing: Some(Boundary::Fixed) };
    let hierarchy = Hierarchy::new(solid.complex.clone(), scheme, *levels.end()).unwrap();
    let values = |r: usize| random(solid.complex.num_cells(r), 21 + r as u64);
    let mut forms: Forms = (Cochain::new(values(1)), Cochain::new(values(2)), Cochain::new(values(3)));
    let mut x = solid.positions.clone();
    let mut rows = Vec::new();
    for level in 1..=*levels.end() {
        x = hierarchy.refine(level, &x);
        forms = (
            hierarchy.refine(level, &forms.0),
            hierarchy.refine(level, &forms.1),
            hierarchy.refine(level, &forms.2),
        );
        if levels.contains(&level) {
            rows.push(jumps(hierarchy.level(level), &x, &forms, &wanted(&hierarchy, level, &x)));
        }
    }
    rows
}

/// On the lattice, and so inside every cell, the jumps halve, as those of a form with bounded derivatives do.
#[test]
fn on_the_lattice_jumps_halve() {
    let rows = measure(&lattice(4, false), 1..=3, |_, _, x| {
        let near = (0..x.len() as u32).filter(|&v| (x[v as usize] - Vector3::repeat(2.0)).norm() < 0.4);
        near.collect()
    });
    println!("on the lattice, levels 1 to 3: {rows:.3?}");
    for r in 0..3 {
        assert!(rows[2][r] < 0.6 * rows[1][r] && rows[2][r] > 1e-6, "{}-form: {rows:?}", r + 1);
    }
}

/// What the documentation says of irregular edges: the jumps of 1-forms shrink at valence 4 and more, those of 2- and
/// 3-forms grow at valence 3, the rest is open.
#[test]
fn at_irregular_edges_jumps_are_as_documented() {
    for n in [3, 4, 5, 6] {
        let rows = measure(&ring(n), 2..=4, |hierarchy, level, x| {
            // The vertices of the edge (0, 1) and its halves, far from its ends.
            let coarse = hierarchy.level(0).edges();
            let mut chain = vec![coarse.iter().position(|ends| *ends == [0, 1]).unwrap() as u32];
            for _ in 0..level {
                chain = chain.into_iter().flat_map(|e| [2 * e, 2 * e + 1]).collect();
            }
            let ends = chain.iter().flat_map(|&e| hierarchy.level(level).edges()[e as usize]);
            ends.filter(|&v| x[v as usize].z.abs() < 0.4).collect()
        });
        println!("edge of valence {n}, levels 2 to 4: {rows:.2?}");
        let shrinks = |r: usize| rows[2][r] / rows[0][r];
        match n {
            3 => assert!(shrinks(1) > 1.2 && shrinks(2) > 1.2, "{rows:?}"),
            _ => assert!(shrinks(0) < 0.8, "{n}: {rows:?}"),
        }
    }
}
