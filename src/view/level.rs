use nalgebra::Vector3;

use super::ViewError;
use crate::cochain::Cochain;
use crate::field;
use crate::hierarchy::{Hierarchy, HierarchyError};
use crate::io::Positions;
use crate::io::fields::Fields;
use crate::limit::{Limit, LimitTangents};
use crate::topology::Mesh;

/// A vertex of one side of a surface: where creases or corners meet there are several in one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// On the limit surface.
    pub position: Vector3<f64>,
    /// The unit normal of the limit surface. Where it has none (a sharp vertex without sharp edges), the mean of
    /// the faces.
    pub normal: Vector3<f64>,
    /// The 0-form; the length of the tangent vector of the 1-form; the density of the 2-form, which is its integral over
    /// the faces round the vertex by their area. 0 if there is no such form.
    pub values: [f64; 3],
}

/// A level on the limit surface, without holes.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// The vertices.
    pub vertices: Vec<Vertex>,
    /// The number of vertices of each face, counter-clockwise.
    pub face_sizes: Vec<u32>,
    /// The vertices of one face after the other.
    pub face_vertices: Vec<u32>,
}

impl Level {
    /// The vertices of each face.
    pub fn faces(&self) -> impl Iterator<Item = &[u32]> {
        let mut rest = &self.face_vertices[..];
        self.face_sizes.iter().map(move |&size| {
            let (face, others) = rest.split_at(size as usize);
            rest = others;
            face
        })
    }

    /// The triangles that fan out from the first vertex of each face.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.faces().flat_map(|face| face[1..].windows(2).map(|pair| [face[0], pair[0], pair[1]]))
    }
}

/// Every level of a hierarchy.
pub(super) fn levels(
    hierarchy: &Hierarchy,
    positions: &Positions,
    fields: &Fields,
) -> Result<Vec<Level>, ViewError> {
    let (mut positions, mut fields) = (positions.clone(), fields.clone());
    let mut levels = Vec::new();
    for number in 0..=hierarchy.num_levels() {
        if number > 0 {
            positions = hierarchy.refine(number, &positions);
            fields = Fields {
                form0: fields.form0.map(|form| hierarchy.refine(number, &form)),
                form1: fields.form1.map(|form| hierarchy.refine(number, &form)),
                form2: fields.form2.map(|form| hierarchy.refine(number, &form)),
            };
        }
        let level = Sides::new(hierarchy, number)?.level(&positions, &fields);
        let finite = |x: &f64| x.is_finite();
        let good = |v: &Vertex| v.position.iter().chain(&v.values).all(finite);
        if !level.vertices.iter().all(good) {
            return Err(ViewError::NotFinite { level: number });
        }
        if level.face_sizes.is_empty() {
            return Err(ViewError::NoFaces);
        }
        levels.push(level);
    }
    Ok(levels)
}

const NONE: u32 = u32::MAX;

/// The vertices of a level, side by side.
struct Sides<'a> {
    mesh: &'a Mesh,
    limit: Limit,
    tangents: LimitTangents,
    faces: Vec<u32>,
    /// For each corner its vertex here; `NONE` in holes.
    of_corner: Vec<u32>,
    /// For each vertex here a corner.
    corner: Vec<u32>,
}

impl<'a> Sides<'a> {
    fn new(hierarchy: &'a Hierarchy, number: usize) -> Result<Self, HierarchyError> {
        let level = hierarchy.level(number);
        let mesh = level.mesh();
        let (limit, tangents) = Limit::with_tangents(hierarchy, number)?;
        let faces = (0..mesh.num_faces() as u32).filter(|&f| !level.tags().face_hole[f as usize]);
        let faces: Vec<u32> = faces.collect();
        let mut of_pair = vec![NONE; tangents.len()];
        let mut of_vertex = vec![NONE; mesh.num_vertices()];
        let (mut of_corner, mut corner) = (vec![NONE; mesh.num_corners()], Vec::new());
        for c in faces.iter().flat_map(|&f| mesh.corners(f)) {
            let number = match tangents.pair_of_corner(c) {
                Some(pair) => &mut of_pair[pair],
                None => &mut of_vertex[mesh.corner_vertex(c) as usize],
            };
            if *number == NONE {
                *number = corner.len() as u32;
                corner.push(c);
            }
            of_corner[c as usize] = *number;
        }
        Ok(Sides { mesh, limit, tangents, faces, of_corner, corner })
    }

    fn level(&self, positions: &Positions, fields: &Fields) -> Level {
        let (mesh, tangents) = (self.mesh, &self.tangents);
        let points = self.limit.apply(mesh, positions);
        let normals = tangents.normals(mesh, positions);
        let flat_normals = field::vertex_normals(mesh, &points);
        let height = fields.form0.as_ref().map(|form| self.limit.apply(mesh, form));
        let lengths = fields.form1.as_ref().map(|form| {
            let exact = tangents.vectors(mesh, positions, form);
            let flat = field::face_vectors(mesh, &points, &self.limit.apply(mesh, form));
            (exact, field::vertex_vectors(mesh, &flat))
        });
        let densities = fields.form2.as_ref().map(|form| self.densities(&points, form));
        let vertex = |(number, &c): (usize, &u32)| {
            let v = mesh.corner_vertex(c) as usize;
            let pair = tangents.pair_of_corner(c);
            let length = |(exact, flat): &(Vec<Vector3<f64>>, Vec<Vector3<f64>>)| {
                pair.map_or(flat[v], |pair| exact[pair]).norm()
            };
            Vertex {
                position: points[v],
                normal: pair.map(|pair| normals[pair]).filter(|n| n.norm() > 0.5).unwrap_or(flat_normals[v]),
                values: [
                    height.as_ref().map_or(0.0, |form| form[v]),
                    lengths.as_ref().map_or(0.0, length),
                    densities.as_ref().map_or(0.0, |densities| densities[number]),
                ],
            }
        };
        let corners = || self.faces.iter().flat_map(|&f| mesh.corners(f));
        Level {
            vertices: self.corner.iter().enumerate().map(vertex).collect(),
            face_sizes: self.faces.iter().map(|&f| mesh.face_size(f) as u32).collect(),
            face_vertices: corners().map(|c| self.of_corner[c as usize]).collect(),
        }
    }

    /// The integrals of the limit of a 2-form over the faces round each vertex, on its side, by their area.
    fn densities(&self, points: &Positions, form: &Cochain<2>) -> Vec<f64> {
        let mesh = self.mesh;
        let integrals = self.limit.apply(mesh, form);
        let mut sums = vec![[0.0; 2]; self.corner.len()];
        for &f in &self.faces {
            let of_face = [integrals[f as usize], area(mesh.face_vertices(f), points)];
            for c in mesh.corners(f) {
                let sum = &mut sums[self.of_corner[c as usize] as usize];
                *sum = [0, 1].map(|i| sum[i] + of_face[i]);
            }
        }
        sums.into_iter().map(|[sum, area]| if area > 0.0 { sum / area } else { 0.0 }).collect()
    }
}

/// The length of a polygon's area vector.
fn area(vertices: &[u32], points: &Positions) -> f64 {
    let first = points[vertices[0] as usize];
    let fan = vertices[1..].windows(2);
    let parts = fan.map(|pair| {
        let [a, b] = [pair[0], pair[1]].map(|v| points[v as usize] - first);
        a.cross(&b) / 2.0
    });
    parts.sum::<Vector3<f64>>().norm()
}
