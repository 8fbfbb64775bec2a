//! The laws of limits: `L1 d0 = d0 L0`, `L2 d1 = d1 L1`, `R L' S = L`, and OpenSubdiv's limit positions.

mod common;

use common::shapes::shapes;
use common::{LIMIT, triangle_schemes};
use formwork::hierarchy::Hierarchy;
use formwork::limit::Limit;
use formwork::scheme::{DooSabin, Scheme};
use formwork::sparse::{assemble, max_difference, multiply};
use formwork::topology::{Cage, HalfEdge, Parent};

/// `L1 d0 = d0 L0` and `L2 d1 = d1 L1` on `level`, `R L' S = L` from the next.
fn assert_limit_laws(name: &str, hierarchy: &Hierarchy, level: usize) -> f64 {
    let (parent, child) = (hierarchy.level(level).mesh(), hierarchy.level(level + 1).mesh());
    let coarse = Limit::new(hierarchy, level).unwrap().operators(parent);
    let fine = Limit::new(hierarchy, level + 1).unwrap().operators(child);
    let steps = hierarchy.operators(level + 1);
    let split = hierarchy.refinement(level + 1).split();
    let r0 = assemble((parent.num_vertices(), child.num_vertices()), |v, row| {
        row.add(split.vertex_of(Parent::Vertex(v as u32)), 1.0);
    });
    let r1 = assemble((parent.num_edges(), child.num_edges()), |e, row| {
        let h = HalfEdge::new(e as u32, true);
        row.add(split.even_edge(h), -1.0);
        row.add(split.even_edge(h.twin()), 1.0);
    });
    let mut children = vec![Vec::new(); parent.num_faces()];
    for f in 0..child.num_faces() {
        children[split.face_parent(parent, f) as usize].push(f as u32);
    }
    let r2 = assemble((parent.num_faces(), child.num_faces()), |f, row| {
        children[f].iter().for_each(|&child| row.add(child, 1.0));
    });
    let (d0, d1) = (parent.d0(), parent.d1());
    let found = [
        ("L1 d0 = d0 L0", max_difference(&multiply(&coarse.l1, &d0), &multiply(&d0, &coarse.l0))),
        ("L2 d1 = d1 L1", max_difference(&multiply(&coarse.l2, &d1), &multiply(&d1, &coarse.l1))),
        ("R0 L0' S0 = L0", max_difference(&multiply(&r0, &multiply(&fine.l0, &steps.s0)), &coarse.l0)),
        ("R1 L1' S1 = L1", max_difference(&multiply(&r1, &multiply(&fine.l1, &steps.s1)), &coarse.l1)),
        ("R2 L2' S2 = L2", max_difference(&multiply(&r2, &multiply(&fine.l2, &steps.s2)), &coarse.l2)),
    ];
    for (law, deviation) in found {
        assert!(deviation <= LIMIT, "{name}, level {level}: {law} to {deviation:e} only");
    }
    found.iter().map(|(_, deviation)| *deviation).fold(0.0, f64::max)
}

fn assert_on_shapes(family: &str, schemes: &[Scheme]) {
    let Some(shapes) = shapes(family) else { return };
    let mut worst = 0.0f64;
    for shape in &shapes {
        let mut descriptor = shape.descriptor();
        descriptor.collapse();
        let cage = Cage::new(descriptor).unwrap();
        for &scheme in schemes {
            let hierarchy = Hierarchy::new(&cage, scheme, 2).unwrap();
            for level in 0..2 {
                worst = worst.max(assert_limit_laws(&shape.name, &hierarchy, level));
            }
        }
    }
    println!("{} {family} shapes: worst limit law {worst:.1e}", shapes.len());
}

#[test]
fn limit_laws_hold_on_every_catmark_shape() {
    assert_on_shapes("catmark", &[DooSabin::Thesis, DooSabin::Original].map(Scheme::Catmark));
}

#[test]
fn limit_laws_hold_on_every_loop_shape() {
    assert_on_shapes("loop", &triangle_schemes());
}

#[test]
fn limit_laws_hold_next_to_each_other() {
    let modified = Scheme::Loop(formwork::scheme::Variant::ModifiedLoop, Default::default());
    for k in 3..13 {
        let cage = Cage::new(common::meshes::bipyramid(k)).unwrap();
        for scheme in triangle_schemes() {
            let hierarchy = Hierarchy::new(&cage, scheme, 2).unwrap();
            for level in 0..2 {
                assert_limit_laws(&format!("bipyramid {k} {scheme:?}"), &hierarchy, level);
            }
        }
    }
    let _ = modified;
}
