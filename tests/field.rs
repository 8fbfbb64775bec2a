//! From 1-forms to vectors on embedded faces.

mod common;

use approx::assert_relative_eq;
use common::meshes::{fan, grid, polygons};
use formwork::cochain::Cochain;
use formwork::field::{face_centres, face_vectors, vertex_normals, vertex_vectors};
use formwork::hierarchy::Hierarchy;
use formwork::osd::{OsdScheme, Refiner};
use formwork::scheme::Scheme;
use formwork::topology::{Cage, Descriptor, Mesh};
use nalgebra::Vector3;

fn mesh(descriptor: Descriptor) -> Mesh {
    Refiner::new(&Cage::new(descriptor).unwrap(), OsdScheme::Catmark).unwrap().mesh(0).unwrap()
}

/// The integral of a constant covector along every edge.
fn constant_form(mesh: &Mesh, positions: &Cochain<0, Vector3<f64>>, covector: Vector3<f64>) -> Cochain<1> {
    Cochain::new(positions.exterior_derivative(mesh).values().iter().map(|edge| covector.dot(edge)).collect())
}

/// On flat faces of any shape and size a constant form is a constant vector.
#[test]
fn constant_forms_are_reproduced_on_any_polygon() {
    let sizes = [3, 4, 5, 6, 4, 7];
    let mesh = mesh(fan(&sizes));
    // A plane star: positions round the centre, pushed about so that no face is regular.
    let tilt = |p: Vector3<f64>| Vector3::new(p.x, p.y, 0.3 * p.x - 0.8 * p.y);
    let position = |v: usize| {
        let angle = v as f64 * 2.4;
        tilt(
            Vector3::new(angle.cos(), angle.sin(), 0.0)
                * if v == 0 { 0.0 } else { 1.0 + 0.3 * (v as f64).sin() },
        )
    };
    let positions = Cochain::new((0..mesh.num_vertices()).map(position).collect());
    let vector = tilt(Vector3::new(0.7, -1.1, 0.0));
    let form = constant_form(&mesh, &positions, vector);
    for v in face_vectors(&mesh, &positions, &form) {
        assert_relative_eq!(v, vector, epsilon = 1e-12);
    }
}

/// (3.33) at the barycentre, by hand: on the triangle (0,0), (1,0), (0,1) the form with circulations 1, 0, 0
/// is `l_0 dl_1 - l_1 dl_0 = (1 - y) dx + x dy`, which is (2/3, 1/3) there.
#[test]
fn triangles_are_interpolated_by_whitney_forms() {
    let mesh = mesh(polygons(3, &[vec![0, 1, 2]]));
    let positions = Cochain::new(vec![Vector3::zeros(), Vector3::x(), Vector3::y()]);
    let vectors = face_vectors(&mesh, &positions, &Cochain::new(vec![1.0, 0.0, 0.0]));
    assert_relative_eq!(vectors[0], Vector3::new(2.0 / 3.0, 1.0 / 3.0, 0.0), epsilon = 1e-15);
}

/// (C.1): on a 2 x 1 rectangle the bottom edge's `(1 - t) ds` is half of `ds = dx / 2` in the middle.
#[test]
fn quads_are_interpolated_by_their_opposite_edges() {
    let mesh = mesh(grid(1, 1, false));
    let positions =
        Cochain::new([[0., 0.], [2., 0.], [0., 1.], [2., 1.]].map(|[x, y]| Vector3::new(x, y, 0.0)).into());
    let vectors = face_vectors(&mesh, &positions, &Cochain::new(vec![1.0, 0.0, 0.0, 0.0]));
    assert_relative_eq!(vectors[0], Vector3::new(0.25, 0.0, 0.0), epsilon = 1e-15);
}

#[test]
fn degenerate_faces_give_zero_and_never_nan() {
    let mesh = mesh(polygons(8, &[vec![0, 1, 2], vec![0, 2, 3, 4], vec![0, 4, 5, 6, 7]]));
    let on_a_line = Cochain::new((0..8).map(|v| Vector3::x() * v as f64).collect());
    for positions in [on_a_line, Cochain::new(vec![Vector3::zeros(); 8])] {
        let vectors = face_vectors(&mesh, &positions, &Cochain::new(vec![1.0; mesh.num_edges()]));
        assert!(vectors.iter().all(|v| *v == Vector3::zeros()), "{vectors:?}");
        for normal in vertex_normals(&mesh, &positions) {
            assert_relative_eq!(normal.norm(), 1.0, epsilon = 1e-15);
        }
    }
}

#[test]
fn averages_and_normals_are_those_of_a_plane() {
    let mesh = mesh(Descriptor { num_vertices: 17, ..grid(3, 3, false) });
    let position = |v: usize| Vector3::new((v % 4) as f64, (v / 4) as f64, 0.0);
    let positions = Cochain::new((0..17).map(position).collect());
    assert_eq!(face_centres(&mesh, &positions)[4], Vector3::new(1.5, 1.5, 0.0));
    assert!(vertex_normals(&mesh, &positions).iter().all(|n| *n == Vector3::z()));
    let vectors: Vec<Vector3<f64>> = (0..9).map(|f| Vector3::x() * f as f64).collect();
    let means = vertex_vectors(&mesh, &vectors);
    assert_eq!((means[0].x, means[5].x, means[16].x), (0.0, 2.0, 0.0));
}

/// Refined positions and a refined constant form: the vectors tend to the covector on a flat surface.
#[test]
fn a_constant_field_stays_constant_on_a_refined_plane() {
    let cage = Cage::new(grid(4, 4, false)).unwrap();
    let hierarchy = Hierarchy::new(&cage, Scheme::default(), 2).unwrap();
    let positions =
        Cochain::new((0..25).map(|v| Vector3::new((v % 5) as f64, (v / 5) as f64, 0.0)).collect());
    let vector = Vector3::new(0.4, -0.9, 0.0);
    let form = constant_form(hierarchy.level(0).mesh(), &positions, vector);
    let (positions, form) = (hierarchy.subdivide(&positions), hierarchy.subdivide(&form));
    for v in face_vectors(hierarchy.finest().mesh(), &positions, &form) {
        assert_relative_eq!(v, vector, epsilon = 1e-12);
    }
}
