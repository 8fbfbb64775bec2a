//! Every exact law, three levels deep, on every bundled asset and every shape of OpenSubdiv's regression
//! suite.

mod common;

use common::shapes::{Shape, shapes};
use common::{EXACT, assert_laws, assert_stencils, meshes, triangle_schemes};
use formwork::cochain::Cochain;
use formwork::hierarchy::Hierarchy;
use formwork::osd::Refiner;
use formwork::scheme::{BoundaryRule, DooSabin, Scheme, Variant};
use formwork::sparse::{apply, max_difference, multiply};
use formwork::topology::{Cage, Crease, HalfEdge, Parent, SplitKind, TopologyError};

const LOOP: Scheme = Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);

/// Shapes whose faces repeat a vertex: refused as they are, sound once collapsed.
const COLLAPSED_POLES: [&str; 2] = ["catmark_nonman_quadpole8", "catmark_nonman_quadpole360"];

fn cage(shape: &Shape) -> Cage {
    let mut descriptor = shape.descriptor();
    if COLLAPSED_POLES.contains(&shape.name.as_str()) {
        assert!(matches!(Cage::new(descriptor.clone()), Err(TopologyError::RepeatedVertex { .. })));
        let report = descriptor.collapse();
        assert_eq!(report.reduced.len(), report.kept.len() / 2, "half of the quads become triangles");
        assert!(report.removed.is_empty());
    }
    Cage::new(descriptor).unwrap_or_else(|error| panic!("{}: {error}", shape.name))
}

/// The first scheme three levels deep; the others differ from it in the first level as in any.
fn assert_laws_on_shapes(family: &str, schemes: &[Scheme]) {
    let Some(shapes) = shapes(family) else { return };
    let (mut worst, mut worst_s0) = (0.0f64, 0.0f64);
    for shape in &shapes {
        let cage = cage(shape);
        for (i, &scheme) in schemes.iter().enumerate() {
            let report = assert_laws(&shape.name, &cage, scheme, if i == 0 { 3 } else { 1 });
            worst = worst.max(report.worst());
            worst_s0 =
                report.levels.iter().filter_map(|row| row.s0_minus_opensubdiv).fold(worst_s0, f64::max);
        }
    }
    println!("{} {family} shapes: worst law {worst:.1e}, worst S0 weight {worst_s0:.1e}", shapes.len());
}

/// Operators over several levels against the products of those of each level, and against each of these the kernel of 1-forms
/// and the rows as evaluators take them.
fn assert_composed(name: &str, cage: &Cage, scheme: Scheme) {
    let hierarchy = Hierarchy::new(cage, scheme, 3).unwrap_or_else(|error| panic!("{name}: {error}"));
    for degree in 0..3 {
        for (from, to) in [(0, 2), (0, 3), (1, 3)] {
            let steps = (from + 2..=to).map(|level| hierarchy.operator(degree, level));
            let first = hierarchy.operator(degree, from + 1);
            let product = steps.fold(first, |product, step| multiply(&step, &product));
            let off = max_difference(&hierarchy.composed_operator(degree, from, to), &product);
            assert!(off <= EXACT, "{name}, {scheme:?}, degree {degree}, {from} to {to}: {off:e}");
        }
    }
    for level in 1..=3 {
        let edges = hierarchy.level(level - 1).mesh().num_edges();
        let form = Cochain::<1>::new((0..edges).map(|e| (e as f64 * 0.37).sin()).collect());
        let (kernel, product) =
            (hierarchy.refine(level, &form), apply(&hierarchy.operator(1, level), form.values()));
        let off = kernel.values().iter().zip(&product).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off <= EXACT, "{name}, {scheme:?}, level {level} without a matrix: {off:e}");
        assert_stencils(&hierarchy, level);
    }
}

#[test]
fn composed_operators_are_products() {
    // Products of large shapes take minutes and show nothing else.
    let small = |family: &str| {
        let cages = shapes(family).unwrap_or_default().into_iter().map(|shape| (cage(&shape), shape.name));
        cages.filter(|(cage, _)| cage.descriptor().face_sizes.len() <= 64).collect::<Vec<_>>()
    };
    for (cage, name) in small("catmark") {
        assert_composed(&name, &cage, Scheme::default());
    }
    for (cage, name) in small("loop") {
        for scheme in triangle_schemes() {
            assert_composed(&name, &cage, scheme);
        }
    }
    for (cage, name) in small("bilinear") {
        assert_composed(&name, &cage, Scheme::Bilinear);
    }
    // Polygons, creases that decay, an isolated vertex, irregular triangles; a valence that is searched.
    let mut alone = meshes::cut_grid(6, 6, false, &[1, 3, 7, 2, 5, 4, 6].repeat(6)[..36]);
    alone.num_vertices += 1;
    alone.creases = vec![Crease { vertices: [8, 9], sharpness: 1.5 }];
    assert_composed("an isolated vertex", &Cage::new(alone).unwrap(), Scheme::default());
    assert_composed("a fan", &Cage::new(meshes::triangle_fan(40, true)).unwrap(), LOOP);
    assert_composed("a bipyramid", &Cage::new(meshes::bipyramid(7)).unwrap(), LOOP);
}

#[test]
fn laws_hold_on_every_catmark_shape() {
    assert_laws_on_shapes("catmark", &[DooSabin::Thesis, DooSabin::Original].map(Scheme::Catmark));
}

#[test]
fn laws_hold_on_every_loop_shape() {
    let mut schemes = triangle_schemes();
    schemes.swap(0, 1); // Loop itself first
    assert_laws_on_shapes("loop", &schemes);
}

#[test]
fn laws_hold_on_every_bilinear_shape() {
    assert_laws_on_shapes("bilinear", &[Scheme::Bilinear]);
}

#[test]
fn laws_hold_on_every_asset() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let mut meshes = 0;
    for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.extension().is_none_or(|extension| extension != "obj") {
            continue;
        }
        let cage = formwork::io::obj::read(&path).unwrap().cage().unwrap();
        let mut schemes = vec![Scheme::default(), Scheme::Catmark(DooSabin::Original), Scheme::Bilinear];
        schemes.extend(triangle_schemes());
        schemes.retain(|scheme| scheme.split(&cage.descriptor().face_sizes).is_ok());
        for &scheme in &schemes {
            assert_laws(&path.display().to_string(), &cage, scheme, 3);
        }
        meshes += 1;
    }
    assert!(meshes >= 7);
}

#[test]
fn numbering_and_parents_are_opensubdivs() {
    let loop_ = triangle_schemes()[1];
    for (family, scheme) in [("catmark", Scheme::default()), ("loop", loop_), ("bilinear", Scheme::Bilinear)]
    {
        let Some(shapes) = shapes(family) else { return };
        for shape in &shapes {
            assert_numbering(shape, scheme);
        }
    }
}

fn assert_numbering(shape: &Shape, scheme: Scheme) {
    let (cage, name) = (cage(shape), &shape.name);
    let hierarchy = Hierarchy::new(&cage, scheme, 2).unwrap();
    let kind = hierarchy.refinement(1).split().kind();
    let mut refiner = Refiner::new(&cage, scheme.opensubdiv(kind)).unwrap();
    refiner.refine_uniform(2).unwrap();
    for level in 0..=2 {
        // We refine complexes and decay tags by rule; OpenSubdiv has every array alike.
        assert!(*hierarchy.level(level).mesh() == refiner.mesh(level).unwrap(), "{name}: level {level}");
        assert!(*hierarchy.level(level).tags() == refiner.tags(level).unwrap(), "{name}: level {level}");
    }
    for level in 0..2 {
        let mesh = hierarchy.level(level).mesh();
        let split = hierarchy.refinement(level + 1).split();
        let children = refiner.children(level).unwrap();
        let cells = |count: usize| 0..count as u32;
        let vertices_of = |count, parent: fn(u32) -> Parent| -> Vec<u32> {
            cells(count).map(|cell| split.vertex_of(parent(cell))).collect()
        };
        assert_eq!(children.vertex_vertex, vertices_of(mesh.num_vertices(), Parent::Vertex), "{name}");
        assert_eq!(children.edge_vertex, vertices_of(mesh.num_edges(), Parent::Edge), "{name}");
        if kind == SplitKind::Quad {
            assert_eq!(children.face_vertex, vertices_of(mesh.num_faces(), Parent::Face), "{name}");
        }
        let halves: Vec<u32> = cells(2 * mesh.num_edges()).map(|h| split.even_edge(HalfEdge(h))).collect();
        assert_eq!(children.edge_edges, halves, "{name}");
        assert_eq!(children.face_edges, cells(mesh.num_corners()).collect::<Vec<_>>(), "{name}");
        // OpenSubdiv lists the children of each face together, and so do we, corner after corner.
        assert_eq!(children.face_faces, cells(split.num_children(2)).collect::<Vec<_>>(), "{name}");
        for corner in cells(mesh.num_corners()) {
            let child = split.face_at(mesh, corner);
            assert_eq!(split.face_parent(mesh, child as usize), mesh.corner_face(corner), "{name}");
        }
    }
}
