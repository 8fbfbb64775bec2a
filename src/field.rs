//! Vector fields and normals on an embedded mesh.
//!
//! A 1-form becomes a tangent vector through the metric: `V` with `V . X = omega(X)` for every tangent `X`.
//! [`sharp`] and [`flat`] do that for any two tangents, [`face_vectors`] for those of flat faces. Lengths are in the units of the positions: where `omega` has
//! circulations in U, vectors are in U per length.

use nalgebra::{Matrix2, Vector2, Vector3};
use rayon::prelude::*;

use crate::cochain::Cochain;
use crate::topology::{HalfEdge, Mesh};

type Positions = Cochain<0, Vector3<f64>>;

/// The tangent vector of a 1-form at the centre of each face, by lowest-order (Whitney) interpolation:
/// on triangles (3.33) of Ke Wang's thesis, on quads its (C.1), at the centre of the parametrisation.
/// An `n`-gon, `n > 4`, which has no interpolation of its own, takes the covector that fits the values
/// from its centre to its corners best.
///
/// A face without area (all its tangents parallel) has the vector 0.
///
/// # Panics
/// If the cochains do not belong to the mesh.
pub fn face_vectors(mesh: &Mesh, positions: &Positions, form: &Cochain<1>) -> Vec<Vector3<f64>> {
    assert_eq!(positions.len(), mesh.num_vertices(), "positions of another mesh");
    assert_eq!(form.len(), mesh.num_edges(), "a 1-cochain of another mesh");
    let vector = |f: u32| match *mesh.face_half_edges(f) {
        [a, b, c] => triangle_vector(mesh, positions, form, [a, b, c]),
        [a, b, c, d] => quad_vector(mesh, positions, form, [a, b, c, d]),
        ref boundary => polygon_vector(mesh, positions, form, boundary),
    };
    (0..mesh.num_faces() as u32).into_par_iter().map(vector).collect()
}

/// At the barycentre, `omega = sum_ij c_ij (l_i dl_j - l_j dl_i)` with all `l = 1/3`: along the edge
/// vectors `T1` (from vertex 0 to 1) and `T2` (0 to 2) it is `c_01 + (c_01 + c_12 + c_20)/3 - ..`, the
/// edge's own value less a third of the circulation.
fn triangle_vector(mesh: &Mesh, x: &Positions, form: &Cochain<1>, edges: [HalfEdge; 3]) -> Vector3<f64> {
    let [ab, bc, ca] = edges.map(|h| form.along(h));
    let third = (ab + bc + ca) / 3.0;
    let [t1, t2] = [edges[0], edges[2].twin()].map(|h| edge_vector(mesh, x, h));
    sharp([t1, t2], [ab - third, third - ca])
}

/// At `s = t = 1/2`, `omega(d/ds)` is the mean of the two opposite edges, and so is `d/ds` itself.
fn quad_vector(mesh: &Mesh, x: &Positions, form: &Cochain<1>, edges: [HalfEdge; 4]) -> Vector3<f64> {
    let [bottom, right, top, left] = edges;
    let mean = |a: HalfEdge, b: HalfEdge| {
        ((edge_vector(mesh, x, a) + edge_vector(mesh, x, b)) / 2.0, (form.along(a) + form.along(b)) / 2.0)
    };
    let (ts, omega_s) = mean(bottom, top.twin());
    let (tt, omega_t) = mean(right, left.twin());
    sharp([ts, tt], [omega_s, omega_t])
}

/// Least squares over the directions from the centre to the vertices, whose values are lifted to the
/// boundary both ways round with equal weight; in the plane of the face's area vector.
fn polygon_vector(mesh: &Mesh, x: &Positions, form: &Cochain<1>, edges: &[HalfEdge]) -> Vector3<f64> {
    let n = edges.len();
    let points: Vec<Vector3<f64>> = edges.iter().map(|&h| x[mesh.tail(h) as usize]).collect();
    let centre = points.iter().sum::<Vector3<f64>>() / n as f64;
    let area: Vector3<f64> =
        (0..n).map(|i| (points[i] - centre).cross(&(points[(i + 1) % n] - centre))).sum();
    let t1 = edge_vector(mesh, x, edges[0]);
    let t2 = area.cross(&t1);
    let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
    for (i, point) in points.iter().enumerate() {
        // The value from the centre to vertex i is minus the lift of the centre from there.
        let lift = |t: usize| (n as f64 - 1.0 - 2.0 * t as f64) / (2.0 * n as f64);
        let value: f64 = (0..n).map(|t| -lift(t) * form.along(edges[(i + t) % n])).sum();
        let direction = Vector2::new((point - centre).dot(&t1), (point - centre).dot(&t2));
        normal += direction * direction.transpose();
        right += direction * value;
    }
    // V = a t1 + b t2 minimises the sum of (V . (x_i - centre) - value_i)^2.
    match solve(normal, right) {
        Some(v) => t1 * v.x + t2 * v.y,
        None => Vector3::zeros(),
    }
}

/// The first fundamental form of two tangents, `g_ij = T_i . T_j`.
pub fn first_fundamental_form([t1, t2]: [Vector3<f64>; 2]) -> Matrix2<f64> {
    Matrix2::new(t1.dot(&t1), t1.dot(&t2), t1.dot(&t2), t2.dot(&t2))
}

/// The tangent vector of a covector: `V = g^ij omega_j T_i`, so that `V . T_i = omega_i`. Its length is in the
/// units of the form's values over those of the positions. 0 if the tangents are parallel.
#[inline]
pub fn sharp(tangents: [Vector3<f64>; 2], covector: [f64; 2]) -> Vector3<f64> {
    let (g, [t1, t2], [c1, c2]) = (first_fundamental_form(tangents), tangents, covector);
    let determinant = g.determinant();
    if determinant <= PARALLEL * g[(0, 0)] * g[(1, 1)] {
        return Vector3::zeros();
    }
    (t1 * (g[(1, 1)] * c1 - g[(0, 1)] * c2) + t2 * (g[(0, 0)] * c2 - g[(0, 1)] * c1)) / determinant
}

/// Tangents whose sine is below the root of this are parallel to rounding.
const PARALLEL: f64 = 1e-14;

/// The covector of a vector, `omega_i = V . T_i`: the inverse of [`sharp`] for tangent vectors.
pub fn flat(tangents: [Vector3<f64>; 2], vector: Vector3<f64>) -> [f64; 2] {
    tangents.map(|tangent| tangent.dot(&vector))
}

/// Solves a symmetric positive 2 x 2 system, unless it is singular to rounding.
fn solve(matrix: Matrix2<f64>, right: Vector2<f64>) -> Option<Vector2<f64>> {
    let regular = matrix.determinant() > PARALLEL * matrix[(0, 0)] * matrix[(1, 1)];
    if regular { matrix.try_inverse().map(|inverse| inverse * right) } else { None }
}

fn edge_vector(mesh: &Mesh, x: &Positions, h: HalfEdge) -> Vector3<f64> {
    x[mesh.head(h) as usize] - x[mesh.tail(h) as usize]
}

/// The mean over the faces round each vertex; 0 at isolated vertices.
///
/// # Panics
/// If there is not one vector for each face.
pub fn vertex_vectors(mesh: &Mesh, face_vectors: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    assert_eq!(face_vectors.len(), mesh.num_faces(), "face vectors of another mesh");
    let mean = |v: u32| {
        let corners = || mesh.fans(v).flat_map(|fan| fan.corners);
        let sum: Vector3<f64> = corners().map(|&c| face_vectors[mesh.corner_face(c) as usize]).sum();
        sum / (corners().count().max(1) as f64)
    };
    (0..mesh.num_vertices() as u32).into_par_iter().map(mean).collect()
}

/// The mean of each face's vertices.
///
/// # Panics
/// If the positions do not belong to the mesh.
pub fn face_centres(mesh: &Mesh, positions: &Positions) -> Vec<Vector3<f64>> {
    assert_eq!(positions.len(), mesh.num_vertices(), "positions of another mesh");
    let mean = |f: u32| {
        let vertices = mesh.face_vertices(f);
        let sum: Vector3<f64> = vertices.iter().map(|&v| positions[v as usize]).sum();
        sum / vertices.len() as f64
    };
    (0..mesh.num_faces() as u32).into_par_iter().map(mean).collect()
}

/// Unit normals at the vertices: the area-weighted mean of the faces round each. Where there is none
/// (isolated vertices, faces without area) the normal is `(0, 0, 1)`, so that it always has length 1.
///
/// # Panics
/// If the positions do not belong to the mesh.
pub fn vertex_normals(mesh: &Mesh, positions: &Positions) -> Vec<Vector3<f64>> {
    assert_eq!(positions.len(), mesh.num_vertices(), "positions of another mesh");
    let area = |f: u32| -> Vector3<f64> {
        let vertices = mesh.face_vertices(f);
        let first = positions[vertices[0] as usize];
        let fan = vertices[1..].windows(2).map(|pair| {
            let [a, b] = [pair[0], pair[1]].map(|v| positions[v as usize] - first);
            a.cross(&b)
        });
        fan.sum()
    };
    let areas: Vec<_> = (0..mesh.num_faces() as u32).into_par_iter().map(area).collect();
    let mean = vertex_vectors(mesh, &areas);
    mean.into_par_iter().map(|n| n.try_normalize(0.0).unwrap_or(Vector3::z())).collect()
}
