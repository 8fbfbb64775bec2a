//! Boundary value problems: the tables of the thesis' problems, by numbers found with another program.
//!
//! The reference is a Python program of exact spline tables, unrelated to this one; its errors are quoted with three digits
//! and met to 5 %. `formwork study NAME` prints the whole tables, to h = 1/64.

mod common;

use common::meshes::{bipyramid, grid, hexagonal_torus};
use common::{EXACT, random};
use formwork::cochain::Cochain;
use formwork::fem::study::{Cells, Imposition, Lattice, Region, Study};
use formwork::fem::{
    BoundaryProblem, Data, Elements, Imposed, Metric, MixedProblem, Operator, Quadrature, SpaceForm, square,
};
use formwork::limit::{LimitSurface, SurfacePoint, Taylor};
use formwork::nalgebra::{DMatrix, Vector3};
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::topology::{Cage, SplitKind};

/// What is wanted, by columns: the errors of each lattice.
#[track_caller]
fn meets(mut study: Study, cells: Cells, sizes: &[u32], wanted: &[&[f64]]) {
    (study.elements, study.cells) = (vec![cells], sizes.to_vec());
    let table = study.run(|| ()).unwrap().remove(0);
    assert_eq!(table.errors.len(), wanted.len(), "{}: {:?}", study.name, table.errors);
    for (row, h) in table.rows.iter().enumerate() {
        for (k, name) in table.errors.iter().enumerate() {
            let (found, wanted) = (h.errors[k], wanted[k][row]);
            assert!(
                (found / wanted - 1.0).abs() < 0.05,
                "{}, {}, {name} at h = 1/{}: {found:.3e}, wanted {wanted:.2e}",
                study.name,
                cells.name(),
                1.0 / h.h
            );
        }
        assert!(h.residual < 1e-9, "{}: {:e}", study.name, h.residual);
    }
}

fn named(name: &str) -> Study {
    Study::named(name).unwrap()
}

const Q: Cells = Cells::Quads;
const T: Cells = Cells::Triangles;

#[test]
fn problems_one_and_two() {
    meets(named("I"), Q, &[8, 16, 32], &[&[1.24e-2, 5.13e-4, 3.88e-5], &[4.63e-1, 4.81e-2, 7.86e-3]]);
    meets(named("I"), T, &[8, 16, 32], &[&[1.83e-2, 1.57e-3, 1.81e-4], &[7.23e-1, 1.53e-1, 3.72e-2]]);
    meets(named("II"), Q, &[8, 16, 32], &[&[2.69e-2, 2.27e-3, 2.55e-4], &[1.08, 2.22e-1, 5.25e-2]]);
    meets(named("II"), T, &[8, 16, 32], &[&[2.55e-2, 2.18e-3, 2.49e-4], &[1.01, 2.12e-1, 5.14e-2]]);
}

#[test]
fn deformed_problems() {
    meets(named("I-F"), Q, &[8, 16, 32], &[&[1.65e-2, 6.97e-4, 5.46e-5], &[7.58e-1, 9.25e-2, 1.68e-2]]);
    meets(named("I-F"), T, &[8, 16, 32], &[&[1.44e-2, 1.63e-3, 2.17e-4], &[8.59e-1, 2.42e-1, 6.74e-2]]);
    meets(named("II-F"), Q, &[8, 16], &[&[4.09e-2, 3.44e-3], &[2.18, 4.95e-1]]);
    meets(named("II-F"), T, &[8, 16], &[&[2.22e-2, 2.49e-3], &[1.35, 3.77e-1]]);
    meets(named("I-Fsym"), Q, &[8, 16], &[&[1.27e-2, 5.30e-4], &[4.82e-1, 5.05e-2]]);
    meets(named("I-Fsym"), T, &[8, 16], &[&[1.83e-2, 1.58e-3], &[7.35e-1, 1.57e-1]]);
}

/// The other ways to impose data, and the thesis' own set-up, which is of first order in the end.
#[test]
fn other_ways_to_impose_data() {
    let way = |boundary, factor| Study { boundary, factor, ..named("I") };
    meets(way(Imposition::Strong, None), Q, &[8, 16], &[&[1.24e-2, 5.13e-4], &[4.63e-1, 4.81e-2]]);
    meets(way(Imposition::Means, None), Q, &[8, 16], &[&[1.36e-2, 7.45e-4], &[5.48e-1, 6.58e-2]]);
    meets(way(Imposition::Means, None), T, &[8, 16], &[&[2.32e-2, 1.91e-3], &[8.48e-1, 1.78e-1]]);
    meets(way(Imposition::Nearest, None), Q, &[8, 16], &[&[1.21e-2, 5.10e-4], &[4.78e-1, 4.85e-2]]);
    meets(way(Imposition::Nearest, None), T, &[8, 16], &[&[1.57e-2, 1.48e-3], &[7.40e-1, 1.54e-1]]);
    let thesis = Study { rule: Some(2), boundary_points: 2, ..way(Imposition::Penalty, Some(100.0)) };
    meets(thesis, Q, &[8, 16, 32], &[&[2.85e-2, 6.65e-3, 3.27e-3], &[9.62e-1, 1.60e-1, 5.29e-2]]);
    meets(named("I-thesis"), T, &[4, 8, 16], &[&[2.38, 2.78e-1, 3.47e-2], &[6.29e1, 1.47e1, 3.55]]);
}

#[test]
fn the_l_shape() {
    meets(named("lshape-smooth"), Q, &[4, 8, 16], &[&[1.11, 2.17e-2, 8.89e-4], &[1.66e1, 8.19e-1, 8.35e-2]]);
    meets(named("lshape-smooth"), T, &[8], &[&[3.18e-2], &[1.24]]);
    let singular: [&[f64]; 2] = [&[1.94e-2, 7.57e-3, 2.96e-3], &[2.20e-1, 1.39e-1, 8.76e-2]];
    meets(named("lshape-singular"), Q, &[4, 8, 16], &singular);
    meets(named("lshape-singular"), T, &[4, 8], &[&[3.28e-2, 1.29e-2], &[2.94e-1, 1.85e-1]]);
    meets(named("lshape-one"), Q, &[4, 8, 16], &[&[8.08e-3, 3.08e-3, 1.19e-3], &[9.27e-2, 5.69e-2, 3.55e-2]]);
    meets(named("lshape-one"), T, &[4, 8], &[&[1.39e-2, 5.30e-3], &[1.25e-1, 7.61e-2]]);
}

#[test]
fn the_bi_laplacian() {
    let quads: [&[f64]; 3] = [
        &[1.36e-2, 2.71e-3, 6.99e-4, 1.80e-4],
        &[1.44e-1, 2.26e-2, 5.20e-3, 1.30e-3],
        &[2.79, 9.42e-1, 4.14e-1, 2.00e-1],
    ];
    meets(named("bilaplace"), Q, &[4, 8, 16, 32], &quads);
    let triangles: [&[f64]; 3] =
        [&[6.55e-2, 1.77e-2, 4.71e-3], &[5.40e-1, 1.41e-1, 3.65e-2], &[1.00e1, 4.96, 2.46]];
    meets(named("bilaplace"), T, &[4, 8, 16], &triangles);
    let strong = Study { boundary: Imposition::Strong, ..named("bilaplace") };
    meets(strong, Q, &[8, 16], &[&[3.26e-3, 7.67e-4], &[2.53e-2, 5.59e-3], &[9.53e-1, 4.16e-1]]);
}

#[test]
fn the_mixed_form() {
    let flat: [&[f64]; 3] =
        [&[1.24e-2, 5.13e-4, 3.88e-5], &[4.49e-1, 4.05e-2, 4.55e-3], &[1.97e-3, 1.03e-4, 6.11e-6]];
    meets(named("I-mixed"), Q, &[8, 16, 32], &flat);
    let flat: [&[f64]; 3] =
        [&[1.75e-2, 1.58e-3, 1.82e-4], &[3.72e-2, 3.28e-3, 2.43e-4], &[1.97e-3, 1.03e-4, 6.11e-6]];
    meets(named("I-mixed"), T, &[8, 16, 32], &flat);
    let deformed: [&[f64]; 3] =
        [&[1.79e-2, 6.88e-4, 5.45e-5], &[5.21e-1, 4.14e-2, 4.65e-3], &[2.69e-1, 8.44e-3, 4.39e-4]];
    meets(named("I-F-mixed"), Q, &[8, 16, 32], &deformed);
}

/// Forms that the space holds are found to rounding, in a metric that is not flat too: all terms are consistent.
#[test]
fn what_the_space_holds_is_found() {
    let formula = |a: fn(Taylor, Taylor) -> [Taylor; 2]| {
        SpaceForm::new(move |[x, y, _]| {
            let [a, b] = a(x, y);
            [a, b, Taylor::constant(0.0)]
        })
    };
    let one = Taylor::constant(1.0);
    let quadratic =
        formula(|x, y| [x * x - x * y * 2.0 + y * y * 3.0, y * y * 0.5 + x * y - Taylor::constant(1.0)]);
    let bump = Metric::chart(move |[x, y]| {
        let e = (x * y * 0.5).exp();
        [e, x * 0.1, e + one * 0.5]
    });
    for cells in [Q, T] {
        let lattice = Lattice::new(Region::Lshape, cells, 3).unwrap();
        let surface = lattice.surface();
        for (metric, operator) in [
            (Metric::Surface, Operator::HodgeLaplace),
            (bump.clone(), Operator::HodgeLaplace),
            (Metric::Surface, Operator::BiLaplace),
            (bump.clone(), Operator::BiLaplace),
        ] {
            // Many points: what is not polynomial is then integrated alike on both sides.
            let rules = match cells {
                Cells::Quads => Quadrature::graded(vec![square(9); 8]),
                Cells::Triangles => Quadrature::new(SplitKind::Triangle),
            };
            let elements = Elements::new(&surface, &lattice.positions, &rules)
                .with_metric(metric.clone())
                .within(|face| lattice.is_inside(face));
            let problem = BoundaryProblem::new(&elements, operator, 9);
            let data = Data { solution: quadratic.clone(), load: None };
            let imposed = Imposed::nitsche(operator, cells.kind());
            let solved = problem.solve(&data, imposed).unwrap();
            let off = problem.errors(&solved.form, &data);
            let flat = matches!(metric, Metric::Surface);
            // Green's formula holds for the integrals, not for the rules, where they are not exact.
            let most = if flat {
                1e-9
            } else if cells == Q {
                1e-7
            } else {
                1e-4
            };
            assert!(
                off.l2 < most && off.energy < 10.0 * most,
                "{cells:?}, {operator:?}, {metric:?}: {off:?}"
            );
            // The mixed form is exact if `delta w` is in the space as well, which it is in flat metrics.
            if operator == Operator::HodgeLaplace && flat {
                let mixed = MixedProblem::new(&elements, 9);
                let off = mixed.errors(&mixed.solve(&data).unwrap(), &data);
                assert!(off.l2 < most && off.d < 10.0 * most, "{cells:?}, {metric:?}: {off:?}");
            }
        }
    }
}

/// Forms are dependent as often as is said, by the eigenvalues of their mass, and are not once those cells are left out:
/// three times on charts, once on a torus, never on quads or where a vertex is irregular.
#[test]
fn dependent_cells_are_found() {
    let independent = |elements: &Elements, name: &str, relations: usize| {
        for degree in 1..=2 {
            let (mass, dropped) = (elements.mass(degree), elements.dependent(degree));
            assert_eq!(dropped.len(), relations, "{name}, degree {degree}");
            let zeros = |left_out: &[u32]| {
                let kept: Vec<usize> = (0..mass.rows())
                    .filter(|&i| mass.get(i, i).is_some_and(|&x| x > 0.0) && !left_out.contains(&(i as u32)))
                    .collect();
                let block = DMatrix::from_fn(kept.len(), kept.len(), |i, j| {
                    mass.get(kept[i], kept[j]).copied().unwrap_or(0.0)
                });
                let values = block.symmetric_eigenvalues();
                values.iter().filter(|&&x| x < EXACT * values.max()).count()
            };
            assert_eq!((zeros(&[]), zeros(&dropped)), (relations, 0), "{name}, degree {degree}");
        }
    };
    for region in [Region::Square, Region::Lshape] {
        for (cells, relations) in [(Q, 0), (T, 3)] {
            let lattice = Lattice::new(region, cells, 3).unwrap();
            let surface = lattice.surface();
            let elements = Elements::new(&surface, &lattice.positions, &Quadrature::new(cells.kind()))
                .within(|face| lattice.is_inside(face));
            independent(&elements, &format!("{region:?}, {cells:?}"), relations);
            if region == Region::Square {
                let unknowns = elements.independent_edges().iter().filter(|is| **is).count();
                let n = 3;
                let all = if cells == Q { 2 * (n + 2) * (n + 3) } else { 3 * n * n + 14 * n + 12 - 3 };
                assert_eq!(unknowns, all);
            }
        }
    }
    let triangles = Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);
    let meshes = [
        ("torus", hexagonal_torus(7, 6), 1),
        ("torus of quads", grid(6, 5, true), 0),
        ("bipyramid", bipyramid(5), 0),
    ];
    for (name, d, relations) in meshes {
        let cage = Cage::new(d).unwrap();
        let scheme = if name == "torus of quads" { Scheme::default() } else { triangles };
        let surface = LimitSurface::new(&cage, scheme).unwrap();
        let n = cage.descriptor().num_vertices;
        let positions =
            Cochain::new(random(3 * n, 1).chunks_exact(3).map(|p| Vector3::new(p[0], p[1], p[2])).collect());
        let elements =
            Elements::new(&surface, &positions, &Quadrature::new(surface.hierarchy().split_kind()));
        independent(&elements, name, relations);
    }
}

/// Derivatives of basis forms are those that evaluation has.
#[test]
fn jets_agree_with_evaluation() {
    for solid in common::solids::all().into_iter().filter(|s| s.genus > 0) {
        let triangles = solid.cage.descriptor().face_sizes.iter().all(|&n| n == 3);
        let scheme =
            if triangles { Scheme::Loop(Variant::Loop, BoundaryRule::Reflect) } else { Scheme::default() };
        let (cage, _) = common::solids::refined(&solid.cage, scheme, &solid.positions, 1);
        let surface = LimitSurface::new(&cage, scheme).unwrap();
        assert_eq!(surface.hierarchy().num_levels(), 0);
        let mesh = surface.hierarchy().level(0).mesh();
        let f: Cochain<0> = Cochain::new(random(mesh.num_vertices(), 3));
        let w: Cochain<1> = Cochain::new(random(mesh.num_edges(), 4));
        for face in (0..mesh.num_faces() as u32).step_by(5) {
            for at in [[0.3, 0.4], [0.05, 0.02], [0.6, 0.1]] {
                let jets = surface.basis_jets(surface.face_basis(face), at, [2, 1]);
                let cells = surface.face_cells(face);
                let point = SurfacePoint { face, corner: surface.face_origin(face), s: at[0], t: at[1] };
                let zero = Taylor::constant(0.0);
                let found = cells.vertices.iter().zip(&jets.forms0);
                let found = found.fold(zero, |sum, (&v, &x)| sum + x * f.values()[v as usize]);
                let jet = surface.evaluate_0(&f, &[point]).unwrap()[0];
                let near = |a: f64, b: f64| {
                    assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{}: {a} {b}", solid.name)
                };
                near(found.value(), jet.value);
                near(found.derivative(1, 0), jet.derivatives[0]);
                near(found.derivative(0, 1), jet.derivatives[1]);
                let component = surface.evaluate_1(&w, &[point]).unwrap()[0];
                for k in 0..2 {
                    let terms = cells.half_edges.iter().zip(&jets.forms1);
                    let found = terms.fold(zero, |sum, (&h, x)| {
                        let sign = if h % 2 == 0 { 1.0 } else { -1.0 };
                        sum + x[k] * (sign * w.values()[h as usize / 2])
                    });
                    near(found.value(), component[k].value);
                    near(found.derivative(1, 0), component[k].derivatives[0]);
                    near(found.derivative(0, 1), component[k].derivatives[1]);
                }
            }
        }
    }
}

/// Studies say what is wrong with them.
#[test]
fn studies_are_checked() {
    let fails = |change: fn(&mut Study), word: &str| {
        let mut study = named("I");
        change(&mut study);
        let said = study.check().unwrap_err().to_string();
        assert!(said.contains(word), "{said}");
    };
    Study::NAMES.iter().for_each(|name| named(name).check().unwrap());
    fails(|s| s.solution[0] = "sin(".to_owned(), "sin(");
    fails(|s| s.solution[1] = "w".to_owned(), "unknown");
    fails(|s| s.cells = vec![1], "1 cells");
    fails(|s| s.cells = Vec::new(), "lattices");
    fails(|s| s.rule = Some(5), "rule");
    fails(|s| s.boundary_points = 0, "boundary-points");
    fails(|s| s.factor = Some(-1.0), "factor");
    fails(|s| s.boundary_data = Some(["0".to_owned(), "0".to_owned()]), "load");
}
