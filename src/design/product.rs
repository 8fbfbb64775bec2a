use nalgebra::{DMatrix, Vector3};
use rayon::prelude::*;

use super::DesignError;
use crate::cochain::Cochain;
use crate::fem::{Elements, Quadrature};
use crate::limit::LimitSurface;
use crate::sparse::{Csr, assemble};
use crate::topology::Mesh;

/// Where lengths and angles are measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Metric {
    /// On the limit surface, between limit forms.
    #[default]
    Limit,
    /// On the control mesh, as in section 4.3.2 of the thesis.
    ControlMesh,
}

/// An inner product of 1-cochains, with the areas of vertices and faces.
#[derive(Clone, Debug)]
pub struct InnerProduct {
    /// `M1`, `(|E|, |E|)`, symmetric.
    pub mass: Csr,
    /// `M0`, `(|V|, |V|)`: the same of functions. A source's divergence is the vertex's function, so this spreads it.
    pub vertex_mass: Csr,
    /// The area that belongs to each vertex. They sum to the area of the surface.
    pub vertex_areas: Vec<f64>,
    /// The area of each face.
    pub face_areas: Vec<f64>,
}

impl InnerProduct {
    /// The inner product of a surface whose cage has these positions.
    ///
    /// # Errors
    /// On the control mesh, if a face has no area.
    ///
    /// # Panics
    /// If the positions do not belong to the cage.
    pub fn new(
        metric: Metric,
        surface: &LimitSurface,
        positions: &Cochain<0, Vector3<f64>>,
    ) -> Result<Self, DesignError> {
        match metric {
            Metric::Limit => Ok(Self::limit(surface, positions)),
            Metric::ControlMesh => Self::control_mesh(surface.hierarchy().level(0).mesh(), positions),
        }
    }

    /// That of the limit forms ([`crate::fem`]): `M1` by quadrature on the limit surface.
    ///
    /// # Panics
    /// If the positions do not belong to the cage.
    pub fn limit(surface: &LimitSurface, positions: &Cochain<0, Vector3<f64>>) -> Self {
        let elements = Elements::new(surface, positions, &Quadrature::new(surface.hierarchy().split_kind()));
        InnerProduct {
            mass: elements.mass(1),
            vertex_mass: elements.mass(0),
            vertex_areas: elements.vertex_areas().into_values(),
            face_areas: elements.face_areas().into_values(),
        }
    }

    /// That of the control mesh. On triangles half the cotangents of the angles opposite to an edge, on its diagonal, so
    /// that `d0' M1 d0` is the cotangent Laplacian of the thesis' codifferential. On other polygons, with edge vectors
    /// `e_i`, the midpoints `b_i` of the edges, the centre `x` of the vertices, the area vector `a n` and
    ///
    /// ```text
    /// U = n x (b - x)' / a        V = e (I - n n')        M = a U' U + P' P,  P = I - V U
    /// ```
    ///
    /// which is exact for forms that are constant in the plane of the polygon and positive for all others: de Goes,
    /// Butts, Desbrun, "Discrete differential operators on polygonal meshes", 2020, (their lambda is 1).
    ///
    /// # Errors
    /// If a face has no area.
    ///
    /// # Panics
    /// If the positions do not belong to the mesh.
    pub fn control_mesh(mesh: &Mesh, positions: &Cochain<0, Vector3<f64>>) -> Result<Self, DesignError> {
        assert_eq!(positions.len(), mesh.num_vertices(), "positions of another mesh");
        let local = |face: u32| local(mesh, positions, face).ok_or(DesignError::NoArea { face });
        let locals = (0..mesh.num_faces() as u32).into_par_iter().map(local);
        let locals: Vec<(f64, DMatrix<f64>)> = locals.collect::<Result<_, _>>()?;
        let mut faces_of = vec![Vec::new(); mesh.num_edges()];
        for face in 0..mesh.num_faces() as u32 {
            for (i, h) in mesh.face_half_edges(face).iter().enumerate() {
                faces_of[h.edge() as usize].push((face, i));
            }
        }
        let mass = assemble((mesh.num_edges(), mesh.num_edges()), |e, row| {
            for &(face, i) in &faces_of[e] {
                let edges = mesh.face_half_edges(face);
                for (j, h) in edges.iter().enumerate() {
                    let entry = locals[face as usize].1[(i, j)];
                    if entry != 0.0 {
                        row.add(h.edge(), edges[i].sign() * h.sign() * entry);
                    }
                }
            }
        });
        let face_areas: Vec<f64> = locals.iter().map(|(area, _)| *area).collect();
        let mut vertex_areas = vec![0.0; mesh.num_vertices()];
        for (face, area) in face_areas.iter().enumerate() {
            let vertices = mesh.face_vertices(face as u32);
            vertices.iter().for_each(|&v| vertex_areas[v as usize] += area / vertices.len() as f64);
        }
        let mut vertex_mass = Csr::eye(mesh.num_vertices());
        vertex_mass.data_mut().copy_from_slice(&vertex_areas);
        Ok(InnerProduct { mass, vertex_mass, vertex_areas, face_areas })
    }
}

/// The area of a face, and the product over its edges, counter-clockwise.
fn local(mesh: &Mesh, positions: &Cochain<0, Vector3<f64>>, face: u32) -> Option<(f64, DMatrix<f64>)> {
    let points: Vec<Vector3<f64>> = mesh.face_vertices(face).iter().map(|&v| positions[v as usize]).collect();
    let n = points.len();
    let centre = points.iter().sum::<Vector3<f64>>() / n as f64;
    let edge = |i: usize| points[(i + 1) % n] - points[i];
    let twice: Vector3<f64> =
        (0..n).map(|i| (points[i] - centre).cross(&(points[(i + 1) % n] - centre))).sum();
    let area = twice.norm() / 2.0;
    let longest = (0..n).map(|i| edge(i).norm_squared()).fold(0.0, f64::max);
    if area <= 1e-12 * longest || !area.is_finite() {
        return None;
    }
    if n == 3 {
        let half_cotangent = |i: usize| -edge((i + 1) % 3).dot(&edge((i + 2) % 3)) / (4.0 * area);
        return Some((
            area,
            DMatrix::from_diagonal(&nalgebra::DVector::from_fn(3, |i, _| half_cotangent(i))),
        ));
    }
    let normal = twice / (2.0 * area);
    let sharp = DMatrix::from_fn(3, n, |k, i| {
        let middle = (points[i] + points[(i + 1) % n]) / 2.0 - centre;
        normal.cross(&middle)[k] / area
    });
    let flat = DMatrix::from_fn(n, 3, |i, k| edge(i)[k] - edge(i).dot(&normal) * normal[k]);
    let rest = DMatrix::identity(n, n) - flat * &sharp;
    let product = sharp.transpose() * &sharp * area + rest.transpose() * rest;
    // Symmetric to the bit.
    Some((area, (&product + product.transpose()) * 0.5))
}
