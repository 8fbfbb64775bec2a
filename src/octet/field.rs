//! Vectors and densities at the centroids of cells.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::complex::{Complex, OCT_FACES};
use super::whitney::WhitneyTet;
use crate::cochain::Cochain;
use crate::topology::HalfEdge;

type Vec3 = Vector3<f64>;
type Positions = Cochain<0, Vec3>;

fn each<T: Send>(
    complex: &Complex,
    cell: impl Fn(u32, &[Vec3]) -> T + Sync,
    positions: &Positions,
) -> Vec<T> {
    assert_eq!(positions.len(), complex.num_cells(0), "positions of another complex");
    let value = |i: u32| {
        let vertices = complex.cell_vertices(i);
        let mut points = [Vec3::zeros(); 6];
        points.iter_mut().zip(vertices).for_each(|(point, &v)| *point = positions[v as usize]);
        cell(i, &points[..vertices.len()])
    };
    (0..complex.num_cells(3) as u32).into_par_iter().map(value).collect()
}

/// The signed volume of each cell: positive if it is stored as it lies.
///
/// # Panics
/// Here and below, if a cochain belongs to another complex.
pub fn volumes(complex: &Complex, positions: &Positions) -> Vec<f64> {
    each(complex, |_, points| volume(points), positions)
}

/// An octahedron is the eight tetrahedra from its centroid to its faces.
fn volume(p: &[Vec3]) -> f64 {
    let det = |a: Vec3, b: Vec3, c: Vec3| a.cross(&b).dot(&c) / 6.0;
    match p.len() {
        4 => det(p[1] - p[0], p[2] - p[0], p[3] - p[0]),
        _ => OCT_FACES.iter().map(|&[a, b, c]| det(p[a], p[b], p[c])).sum(),
    }
}

/// The vector of a 1-form at the centroid of each cell: of its Whitney form in tetrahedra; in octahedra the one that fits
/// the circulations along the three axes, each the mean of four ways round. Flat cells have the vector 0.
pub fn vectors(complex: &Complex, positions: &Positions, form: &Cochain<1>) -> Vec<Vec3> {
    assert_eq!(form.len(), complex.num_cells(1), "a 1-cochain of another complex");
    let along = |h: HalfEdge| form[h.edge() as usize] * h.sign();
    let vector = |cell: u32, p: &[Vec3]| match (cell as usize).checked_sub(complex.tets.len()) {
        None => {
            let edges = super::TET_EDGES.map(|[i, j]| along(complex.tet_edge(cell as usize, i, j)));
            let centre = p.iter().sum::<Vec3>() / 4.0;
            WhitneyTet::new([p[0], p[1], p[2], p[3]]).map_or(Vec3::zeros(), |tet| tet.vector(edges, centre))
        }
        Some(o) => {
            let across = |i: usize| -> f64 {
                let ways = (0..6).filter(|k| k % 3 != i);
                ways.map(|k| along(complex.oct_edge(o, i, k)) + along(complex.oct_edge(o, k, i + 3))).sum()
            };
            let axes = Matrix3::from_rows(&[0, 1, 2].map(|i| (p[i + 3] - p[i]).transpose()));
            let right = Vec3::new(across(0), across(1), across(2)) / 4.0;
            axes.try_inverse().map_or(Vec3::zeros(), |inverse| inverse * right)
        }
    };
    each(complex, vector, positions)
}

/// The flux vector of a 2-form, as its mean over each cell if there is no divergence: the sum over the faces of flux
/// times centroid, from the cell's own, over the volume. Flat cells have the vector 0.
pub fn fluxes(complex: &Complex, positions: &Positions, form: &Cochain<2>) -> Vec<Vec3> {
    assert_eq!(form.len(), complex.num_cells(2), "a 2-cochain of another complex");
    let flux = |cell: u32, p: &[Vec3]| {
        let volume = volume(p);
        if volume == 0.0 {
            return Vec3::zeros();
        }
        let centre = p.iter().sum::<Vec3>() / p.len() as f64;
        let corners = |k: usize| if p.len() == 4 { super::TET_FACES[k] } else { OCT_FACES[k] };
        let moment = |(k, side): (usize, &super::HalfFace)| {
            let face = corners(k).iter().map(|&i| p[i]).sum::<Vec3>() / 3.0;
            (face - centre) * (form[side.triangle() as usize] * side.sign())
        };
        complex.cell_faces(cell).iter().enumerate().map(moment).sum::<Vec3>() / volume
    };
    each(complex, flux, positions)
}

/// The density of a 3-form in each cell; 0 in flat ones.
pub fn densities(complex: &Complex, positions: &Positions, form: &Cochain<3>) -> Vec<f64> {
    assert_eq!(form.len(), complex.num_cells(3), "a 3-cochain of another complex");
    let density = |cell: u32, p: &[Vec3]| {
        let volume = volume(p);
        if volume == 0.0 { 0.0 } else { form[cell as usize] / volume }
    };
    each(complex, density, positions)
}

/// Where a plane cuts the triangles of a solid: line segments, on both sides of which are cells. The plane is that of
/// the points `x` with `normal . x = offset`.
pub fn cut(complex: &Complex, positions: &Positions, normal: Vec3, offset: f64) -> Vec<[Vec3; 2]> {
    let height = |v: u32| normal.dot(&positions[v as usize]) - offset;
    let segment = |t: u32| {
        let v = complex.triangle_vertices(t);
        let crossing = |k: usize| {
            let [a, b] = [v[k], v[(k + 1) % 3]];
            let (p, q) = (height(a), height(b));
            // A vertex in the plane counts as above it.
            let crossed = (p < 0.0) != (q < 0.0);
            let at = |a: u32, b: u32| positions[a as usize].lerp(&positions[b as usize], p / (p - q));
            crossed.then(|| at(a, b))
        };
        let mut points = (0..3).filter_map(crossing);
        points.next().zip(points.next()).map(|(a, b)| [a, b])
    };
    (0..complex.num_cells(2) as u32).filter_map(segment).collect()
}
