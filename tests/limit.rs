//! Limits beyond the laws that every mesh is held to: regular values, darts, tangents.

mod common;

use common::meshes::{bipyramid, fan, grid, hexagonal_torus, triangle_fan};
use common::shapes::shapes;
use common::{EXACT, LIMIT, assert_laws, random, triangle_schemes};
use formwork::cochain::Cochain;
use formwork::hierarchy::Hierarchy;
use formwork::limit::Limit;
use formwork::osd::{Refiner, Rule};
use formwork::scheme::{BoundaryRule, DooSabin, Scheme, Variant};
use formwork::sparse::row_of;
use formwork::topology::{Cage, Corner, Crease, Descriptor, HalfEdge};
use nalgebra::Vector3;

fn hierarchy(descriptor: Descriptor, scheme: Scheme, levels: usize) -> Hierarchy {
    Hierarchy::new(&Cage::new(descriptor).unwrap(), scheme, levels).unwrap()
}

/// A regular row, its entries found by the positions of their ends.
fn assert_regular_row(
    hierarchy: &Hierarchy,
    columns: u32,
    expected: impl Fn([i32; 2], [i32; 2]) -> f64,
    from: [u32; 2],
    to: [u32; 2],
) {
    let mesh = hierarchy.level(0).mesh();
    let vertex = |[i, j]: [u32; 2]| i + j * columns;
    let h = mesh.find_half_edge(vertex(from), vertex(to)).unwrap();
    let l1 = Limit::new(hierarchy, 0).unwrap().operators(mesh).l1;
    let place = |v: u32| [(v % columns) as i32 - from[0] as i32, (v / columns) as i32 - from[1] as i32];
    let (entries, weights) = row_of(&l1, h.edge() as usize);
    let mut found = 0;
    for e in 0..mesh.num_edges() as u32 {
        let [a, b] = mesh.edges()[e as usize].map(place);
        let weight = entries.iter().position(|&x| x == e).map_or(0.0, |i| weights[i] * h.sign());
        assert!((weight - expected(a, b)).abs() < 1e-15, "{a:?} -> {b:?}: {weight}");
        found += usize::from(weight != 0.0);
    }
    assert!(found >= 9);
}

#[test]
fn regular_quads_average_by_1_4_1() {
    // L1 on edges along one axis is (1, 4, 1) x (1, 4, 1) / 36 on the parallel edges.
    let weight = |x: i32| [4.0, 1.0, 0.0, 0.0][x.unsigned_abs().min(3) as usize];
    let expected = |a: [i32; 2], b: [i32; 2]| match [b[0] - a[0], b[1] - a[1]] {
        [1, 0] => weight(a[0]) * weight(a[1]) / 36.0,
        [-1, 0] => -weight(b[0]) * weight(b[1]) / 36.0,
        _ => 0.0,
    };
    assert_regular_row(&hierarchy(grid(9, 9, true), Scheme::default(), 0), 9, expected, [4, 4], [5, 4]);
}

#[test]
fn regular_triangles_are_appendix_a2() {
    // For the edge a -> b, a = (0, 0), b = (1, 0), c = (0, 1); the others by p -> (1-x, -y) and
    // p -> (1-x-y, y), both with the other sign.
    let listed: [([i32; 2], [i32; 2], f64); 6] = [
        ([0, 0], [1, 0], 44.0),
        ([1, 0], [2, 0], 8.0),
        ([1, 0], [0, 1], -13.0),
        ([1, 1], [1, 0], -6.0),
        ([0, 1], [1, 1], 5.0),
        ([2, 0], [1, 1], -1.0),
    ];
    let turn = |[x, y]: [i32; 2]| [1 - x, -y];
    let flip = |[x, y]: [i32; 2]| [1 - x - y, y];
    let mut all = Vec::new();
    for (a, b, weight) in listed {
        let turned = (turn(a), turn(b), -weight);
        for (a, b, weight) in [(a, b, weight), turned] {
            all.extend([(a, b, weight), (flip(a), flip(b), -weight)]);
        }
    }
    let expected = |a: [i32; 2], b: [i32; 2]| {
        let same = |&&(p, q, _): &&([i32; 2], [i32; 2], f64)| (p, q) == (a, b) || (q, p) == (a, b);
        all.iter().find(same).map_or(0.0, |&(p, _, weight)| if p == a { weight } else { -weight } / 120.0)
    };
    let scheme = Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);
    // Neighbours in this torus are (1, 0), (0, 1), (-1, 1).
    assert_regular_row(&hierarchy(hexagonal_torus(9, 9), scheme, 0), 9, expected, [4, 4], [5, 4]);
}

#[test]
fn irregular_vertices_may_touch() {
    for k in 3..13 {
        for scheme in triangle_schemes() {
            assert_laws(&format!("bipyramid {k}"), &Cage::new(bipyramid(k)).unwrap(), scheme, 2);
        }
        let scheme = Scheme::Catmark(DooSabin::Original);
        assert_laws(&format!("fan {k}"), &Cage::new(fan(&vec![4; k as usize])).unwrap(), scheme, 2);
    }
}

/// A torus with an open crease: two darts.
fn darts() -> Descriptor {
    let mut descriptor = grid(4, 4, true);
    descriptor.creases.push(Crease { vertices: [0, 1], sharpness: 10.0 });
    descriptor
}

#[test]
fn refinement_converges_to_our_limit_at_darts_and_not_to_opensubdivs() {
    let levels = 7;
    let hierarchy = hierarchy(darts(), Scheme::default(), levels);
    let mesh = hierarchy.level(0).mesh();
    let refiner =
        Refiner::new(hierarchy.cage(), hierarchy.scheme().opensubdiv(hierarchy.split_kind())).unwrap();
    let x = Cochain::<0>::new(random(mesh.num_vertices(), 3));
    let ours = Limit::new(&hierarchy, 0).unwrap().apply(mesh, &x);
    let theirs = formwork::sparse::apply(&refiner.limit_stencils().unwrap().position, x.values());
    for dart in [0, 1] {
        assert_eq!(hierarchy.level(0).tags().vertex_rule[dart], Rule::Dart);
        let refined: Vec<f64> = (1..=levels)
            .scan(x.clone(), |x, level| {
                *x = hierarchy.refine(level, x);
                Some(x[dart])
            })
            .collect();
        let to_ours: Vec<f64> = refined.iter().map(|value| (value - ours[dart]).abs()).collect();
        let ratio = to_ours[levels - 1] / to_ours[levels - 2];
        assert!(ratio < 0.5, "{to_ours:?}");
        assert!(to_ours[levels - 1] < 1e-4, "{to_ours:?}");
        let to_theirs = (refined[levels - 1] - theirs[dart]).abs();
        assert!(to_theirs > 100.0 * to_ours[levels - 1], "{to_theirs}");
        println!("dart {dart}: to ours {:.1e}, to OpenSubdiv's {to_theirs:.1e}", to_ours[levels - 1]);
    }
}

/// `phi d0` is OpenSubdiv's pair of tangent masks, at vertices where those are left eigenvectors.
fn assert_tangents(name: &str, descriptor: Descriptor, scheme: Scheme) -> usize {
    let hierarchy = hierarchy(descriptor, scheme, 2);
    let level = hierarchy.finest();
    let (mesh, tags) = (level.mesh(), level.tags());
    let mut refiner = Refiner::new(hierarchy.cage(), scheme.opensubdiv(hierarchy.split_kind())).unwrap();
    refiner.refine_uniform(2).unwrap();
    let masks = refiner.limit_stencils().unwrap();
    let (_, tangents) = Limit::with_tangents(&hierarchy, 2).unwrap();
    let x = Cochain::<0>::new(random(mesh.num_vertices(), 5));
    let ours = tangents.along(&x.exterior_derivative(mesh));
    let theirs = [&masks.tangent1, &masks.tangent2].map(|mask| formwork::sparse::apply(mask, x.values()));
    let mut compared = 0;
    for v in 0..mesh.num_vertices() {
        let Some(fan) = mesh.fans(v as u32).next() else { continue };
        let whole = mesh.fans(v as u32).len() == 1;
        // At inner creases OpenSubdiv has one pair for both sides. At darts, and across Loop's creases of other than
        // three triangles, its masks are no left eigenvectors of its own S0, so not the limits of its tangents.
        let triangles = mesh.face_size(0) == 3;
        let known = match tags.vertex_rule[v] {
            Rule::Smooth => mesh.vertex_half_edges(v as u32).len() > 2,
            Rule::Crease if triangles => !fan.cyclic && fan.corners.len() == 3,
            Rule::Crease => !fan.cyclic && fan.corners.len() > 1,
            Rule::Dart | Rule::Corner => false,
        };
        if !(whole && known) {
            continue;
        }
        let pair = tangents.pair_of_corner(fan.corners[0]).unwrap();
        let [a, b] = ours[pair];
        // The pair may be turned: OpenSubdiv starts at an edge of its own. Both span the same plane.
        let area = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
        let y = Cochain::<0>::new(random(mesh.num_vertices(), 6));
        let other = tangents.along(&y.exterior_derivative(mesh))[pair];
        let of_y = [&masks.tangent1, &masks.tangent2].map(|m| formwork::sparse::apply(m, y.values())[v]);
        let (ours, theirs) = (area([a, b], other), area([theirs[0][v], theirs[1][v]], of_y));
        assert!((ours - theirs).abs() <= 1e-10 * theirs.abs().max(1e-3), "{name} {v}: {ours} {theirs}");
        compared += 1;
    }
    compared
}

#[test]
fn covectors_extend_opensubdivs_tangents() {
    let loop_ = Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);
    let mut compared = assert_tangents("grid", grid(3, 4, false), Scheme::default());
    for k in 3..13 {
        compared += assert_tangents(&format!("fan {k}"), fan(&vec![4; k as usize]), Scheme::default());
        compared += assert_tangents(&format!("bipyramid {k}"), bipyramid(k), loop_);
        compared += assert_tangents(&format!("open fan {k}"), triangle_fan(k, false), loop_);
    }
    assert!(compared > 1000, "{compared}");
}

/// Pairs of one level, refined, are pairs of the level above but for their length: the vector of a form is the same.
fn assert_vectors_agree(name: &str, descriptor: Descriptor, scheme: Scheme) {
    let h = hierarchy(descriptor, scheme, 3);
    let mesh = h.level(0).mesh();
    let numbers = random(3 * mesh.num_vertices(), 7);
    let points = numbers.chunks(3).map(|c| Vector3::new(c[0], c[1], c[2]));
    let positions: Cochain<0, Vector3<f64>> = Cochain::new(points.collect());
    let form = Cochain::<1>::new(random(mesh.num_edges(), 8));
    let vectors = |level: usize| {
        let mesh = h.level(level).mesh();
        let x = (1..=level).fold(positions.clone(), |x, l| h.refine(l, &x));
        let c = (1..=level).fold(form.clone(), |c, l| h.refine(l, &c));
        let (_, tangents) = Limit::with_tangents(&h, level).unwrap();
        let of_pairs = tangents.vectors(mesh, &x, &c);
        let corners = (0..mesh.num_corners() as u32).map(|c| tangents.pair_of_corner(c));
        corners.map(|pair| pair.map(|pair| of_pairs[pair])).collect::<Vec<_>>()
    };
    let (coarse, fine) = (vectors(0), vectors(3));
    for corner in 0..mesh.num_corners() as u32 {
        let below = (1..=3).fold(corner, |c, l| h.refinement(l).split().corner_at(h.level(l - 1).mesh(), c));
        match (coarse[corner as usize], fine[below as usize]) {
            (Some(a), Some(b)) => {
                assert!((a - b).norm() <= 1e-9 * a.norm().max(1.0), "{name}, corner {corner}: {a} {b}");
            }
            (a, b) => assert_eq!(a.is_some(), b.is_some(), "{name}, corner {corner}"),
        }
    }
}

#[test]
fn vectors_at_vertices_do_not_depend_on_the_level() {
    let mut creased = grid(4, 4, true);
    for v in [1, 2, 6] {
        creased.creases.push(Crease { vertices: [v, v + 1], sharpness: if v == 6 { 2.5 } else { 10.0 } });
    }
    creased.corners.push(Corner { vertex: 9, sharpness: 10.0 });
    assert_vectors_agree("creased", creased, Scheme::default());
    assert_vectors_agree("darts", darts(), Scheme::default());
    assert_vectors_agree("open", grid(3, 2, false), Scheme::default());
    assert_vectors_agree("polygons", fan(&[3, 4, 5, 4, 6]), Scheme::Catmark(DooSabin::Original));
    for k in 4..13 {
        assert_vectors_agree("fan", fan(&vec![4; k as usize]), Scheme::default());
        for scheme in triangle_schemes().into_iter().skip(1) {
            assert_vectors_agree("bipyramid", bipyramid(k), scheme);
        }
    }
}

#[test]
fn applied_and_assembled_limits_agree() {
    let h = hierarchy(fan(&[3, 4, 5, 4, 6]), Scheme::default(), 1);
    for level in 0..2 {
        let mesh = h.level(level).mesh();
        let limit = Limit::new(&h, level).unwrap();
        let operators = limit.operators(mesh);
        let (x, c, f) =
            (random(mesh.num_vertices(), 1), random(mesh.num_edges(), 2), random(mesh.num_faces(), 3));
        let pairs = [
            (limit.apply(mesh, &Cochain::<0>::new(x.clone())).into_values(), operators.l0, x),
            (limit.apply(mesh, &Cochain::<1>::new(c.clone())).into_values(), operators.l1, c),
            (limit.apply(mesh, &Cochain::<2>::new(f.clone())).into_values(), operators.l2, f),
        ];
        for (applied, matrix, input) in pairs {
            let product = formwork::sparse::apply(&matrix, &input);
            assert!(applied.iter().zip(&product).all(|(a, b)| (a - b).abs() <= EXACT));
        }
    }
}

#[test]
fn limits_of_semi_sharp_creases_cost_their_length() {
    // Sharpness 9 would be 16 million faces if all of the mesh were refined until it is settled.
    let mut descriptor = grid(8, 8, true);
    descriptor.creases.push(Crease { vertices: [0, 1], sharpness: 8.5 });
    let h = hierarchy(descriptor, Scheme::default(), 1);
    let (parent, child) = (h.level(0).mesh(), h.level(1).mesh());
    let x = Cochain::<1>::new(random(parent.num_edges(), 9));
    let coarse = Limit::new(&h, 0).unwrap().apply(parent, &x);
    let fine = Limit::new(&h, 1).unwrap().apply(child, &h.refine(1, &x));
    let split = h.refinement(1).split();
    for e in 0..parent.num_edges() as u32 {
        let half = HalfEdge::new(e, true);
        let sum = fine[split.even_edge(half.twin()) as usize] - fine[split.even_edge(half) as usize];
        assert!((sum - coarse[e as usize]).abs() <= LIMIT, "edge {e}");
    }
}

#[test]
fn limits_of_other_weights_hold_on_shapes() {
    // The default weights are measured in tests/shapes.rs; the tables of darts and sectors in all others here.
    let Some(shapes) = shapes("loop") else { return };
    for shape in shapes.iter().filter(|shape| shape.name.contains("dart") || shape.name.contains("crease")) {
        let cage = Cage::new(shape.descriptor()).unwrap();
        for scheme in triangle_schemes() {
            assert_laws(&shape.name, &cage, scheme, 2);
        }
    }
}

#[test]
fn high_valences_share_their_models() {
    // A boundary vertex of 200 faces has 200 configurations, one for each place in its sector.
    let mut open = fan(&[4; 200]);
    open.face_sizes.truncate(199);
    open.face_vertices.truncate(4 * 199);
    let cage = Cage::new(open).unwrap();
    let surface = formwork::limit::LimitSurface::new(&cage, Scheme::default()).unwrap();
    let x = surface.refine(&Cochain::<0>::new(random(cage.descriptor().num_vertices, 4)));
    let hierarchy = Hierarchy::new(&cage, Scheme::default(), 0).unwrap();
    let mesh = hierarchy.level(0).mesh();
    let limit = Limit::new(&hierarchy, 0).unwrap();
    let values = Cochain::<0>::new(random(mesh.num_vertices(), 4));
    let expected = limit.apply(mesh, &values)[0];
    let points: Vec<_> =
        (0..199).map(|face| formwork::limit::SurfacePoint { face, corner: 0, s: 0.0, t: 0.0 }).collect();
    let jets = surface.evaluate_0(&x, &points).unwrap();
    assert!(jets.iter().all(|jet| (jet.value - expected).abs() < 1e-12));
}
