use nalgebra::Vector3;

use super::fields::Fields;
use super::{IoError, Positions};
use crate::field;
use crate::topology::Mesh;

/// One level of a hierarchy with positions and forms, as its writers see it: the faces that are not left
/// out, and the edges of those faces. All vertices stay.
pub struct Surface<'a> {
    level: usize,
    mesh: &'a Mesh,
    positions: &'a Positions,
    fields: &'a Fields,
    face_vectors: Option<Vec<Vector3<f64>>>,
    at_vertices: Option<AtVertices>,
    faces: Vec<u32>,
    edges: Vec<u32>,
}

/// What is known at the vertices of a surface that lies on its limit.
#[derive(Clone, Debug, PartialEq)]
pub struct AtVertices {
    /// The unit normal of the limit surface at each vertex.
    pub normals: Vec<Vector3<f64>>,
    /// The tangent vectors of the 1-form, if there is one: at each vertex, the mean of its sides where a crease
    /// gives it several, and at each corner of a face, in the order of the face's vertices, that of its side.
    pub vectors: Option<[Vec<Vector3<f64>>; 2]>,
}

impl<'a> Surface<'a> {
    /// A surface without the faces that `left_out` marks. `fields` are forms on the whole mesh.
    ///
    /// # Errors
    /// [`IoError::NothingToWrite`] if no face stays, [`IoError::Overflow`] if a position or a value is not
    /// finite, which no format could say.
    ///
    /// # Panics
    /// If the positions, the forms or `left_out` do not belong to the mesh.
    pub fn new(
        level: usize,
        mesh: &'a Mesh,
        positions: &'a Positions,
        fields: &'a Fields,
        left_out: &[bool],
    ) -> Result<Self, IoError> {
        assert_eq!(left_out.len(), mesh.num_faces(), "holes of another mesh");
        assert_eq!(positions.len(), mesh.num_vertices(), "positions of another mesh");
        let lengths = [
            fields.form0.as_ref().map(|form| form.len()),
            fields.form1.as_ref().map(|form| form.len()),
            fields.form2.as_ref().map(|form| form.len()),
        ];
        for (k, len) in lengths.into_iter().enumerate() {
            assert!(len.is_none_or(|len| len == mesh.num_cells(k)), "a {k}-form of another mesh");
        }

        let faces: Vec<u32> = (0..mesh.num_faces() as u32).filter(|&f| !left_out[f as usize]).collect();
        if faces.is_empty() {
            return Err(IoError::NothingToWrite);
        }
        let mut has_face = vec![false; mesh.num_edges()];
        for h in faces.iter().flat_map(|&f| mesh.face_half_edges(f)) {
            has_face[h.edge() as usize] = true;
        }
        let edges = (0..mesh.num_edges() as u32).filter(|&e| has_face[e as usize]).collect();

        finite("the position of vertex", positions.values(), |x| x.iter().all(|x| x.is_finite()))?;
        finite("the value of vertex", values(&fields.form0), |x| x.is_finite())?;
        finite("the value of edge", values(&fields.form1), |x| x.is_finite())?;
        finite("the value of face", values(&fields.form2), |x| x.is_finite())?;
        let face_vectors = fields.form1.as_ref().map(|form| field::face_vectors(mesh, positions, form));
        finite("the vector of face", face_vectors.as_deref().unwrap_or_default(), |x| {
            x.iter().all(|x| x.is_finite())
        })?;
        Ok(Surface { level, mesh, positions, fields, face_vectors, at_vertices: None, faces, edges })
    }

    /// The same with exact normals and vectors at the vertices, which replace the vectors of the faces.
    ///
    /// # Panics
    /// If there is not one for each vertex and corner of the mesh.
    pub fn on_limit(mut self, at_vertices: AtVertices) -> Self {
        assert_eq!(at_vertices.normals.len(), self.mesh.num_vertices(), "normals of another mesh");
        if let Some([vertices, corners]) = &at_vertices.vectors {
            let lengths = (vertices.len(), corners.len());
            let wanted = (self.mesh.num_vertices(), self.mesh.num_corners());
            assert_eq!(lengths, wanted, "vectors of another mesh");
        }
        self.face_vectors = None;
        self.at_vertices = Some(at_vertices);
        self
    }

    /// The level of refinement; 0 is the control cage.
    pub fn level(&self) -> usize {
        self.level
    }

    /// The whole mesh.
    pub fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// One position for each vertex of the mesh.
    pub fn positions(&self) -> &'a Positions {
        self.positions
    }

    /// The forms on the whole mesh.
    pub fn fields(&self) -> &'a Fields {
        self.fields
    }

    /// The tangent vector of the 1-form at the centre of each face of the whole mesh, if there is one and the
    /// surface does not lie on its limit.
    pub fn face_vectors(&self) -> Option<&[Vector3<f64>]> {
        self.face_vectors.as_deref()
    }

    /// The exact normals and vectors at the vertices, if the surface lies on its limit.
    pub fn at_vertices(&self) -> Option<&AtVertices> {
        self.at_vertices.as_ref()
    }

    /// The faces that are written, ascending: the `i`-th of them is face `i` of the file.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = u32> + Clone + '_ {
        self.faces.iter().copied()
    }

    /// The edges of the faces that are written, ascending.
    pub fn edges(&self) -> impl ExactSizeIterator<Item = u32> + Clone + '_ {
        self.edges.iter().copied()
    }
}

fn values<const K: usize>(form: &Option<crate::cochain::Cochain<K>>) -> &[f64] {
    form.as_ref().map(|form| form.values()).unwrap_or_default()
}

fn finite<T>(what: &'static str, values: &[T], is_finite: impl Fn(&T) -> bool) -> Result<(), IoError> {
    match values.iter().position(|value| !is_finite(value)) {
        Some(index) => Err(IoError::Overflow { what, index }),
        None => Ok(()),
    }
}
