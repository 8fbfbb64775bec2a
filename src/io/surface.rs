use std::collections::HashSet;

use nalgebra::Vector3;

use super::fields::Fields;
use super::{Ancestry, Asset, IoError, Positions};
use crate::field;
use crate::topology::{Descriptor, Fan, Mesh};

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
    asset: Option<&'a Asset>,
    frames: Vec<Pose>,
    sharp_edges: Vec<bool>,
    ancestry: Option<Ancestry<'a>>,
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

/// A moving surface at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// In time codes of a stage.
    pub time: f64,
    /// One position for each vertex.
    pub positions: Positions,
    /// What is known at the vertices, if the surface lies on its limit.
    pub at_vertices: Option<AtVertices>,
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

        finite_positions(positions)?;
        finite("the value of vertex", values(&fields.form0), |x| x.is_finite())?;
        finite("the value of edge", values(&fields.form1), |x| x.is_finite())?;
        finite("the value of face", values(&fields.form2), |x| x.is_finite())?;
        let face_vectors = fields.form1.as_ref().map(|form| field::face_vectors(mesh, positions, form));
        finite("the vector of face", face_vectors.as_deref().unwrap_or_default(), |x| {
            x.iter().all(|x| x.is_finite())
        })?;
        Ok(Surface {
            level,
            mesh,
            positions,
            fields,
            face_vectors,
            at_vertices: None,
            faces,
            edges,
            asset: None,
            frames: Vec::new(),
            sharp_edges: Vec::new(),
            ancestry: None,
        })
    }

    /// The same with exact normals and vectors at the vertices, which replace the vectors of the faces.
    ///
    /// # Panics
    /// If there is not one for each vertex and corner of the mesh.
    pub fn on_limit(mut self, at_vertices: AtVertices) -> Self {
        at_vertices.check(self.mesh);
        self.face_vectors = None;
        self.at_vertices = Some(at_vertices);
        self
    }

    /// The asset that was refined. On level 0 a surface of all its faces that is not moved to the limit is its
    /// cage: it is written with its tags, and then holes are tags like the others. The writer of USD keeps the
    /// rest of its stage.
    pub fn of(mut self, asset: &'a Asset) -> Self {
        self.asset = Some(asset);
        self
    }

    /// The whole mesh at other times, ascending. It has the forms and the faces of this surface.
    ///
    /// # Errors
    /// [`IoError::Overflow`] if a position is not finite.
    ///
    /// # Panics
    /// If the positions do not belong to the mesh.
    pub fn with_frames(mut self, frames: Vec<Pose>) -> Result<Self, IoError> {
        for pose in &frames {
            assert_eq!(pose.positions.len(), self.mesh.num_vertices(), "positions of another mesh");
            pose.at_vertices.iter().for_each(|at| at.check(self.mesh));
            finite_positions(&pose.positions)?;
        }
        self.frames = frames;
        Ok(self)
    }

    /// Edges of the whole mesh over which vectors and normals are not averaged.
    ///
    /// # Panics
    /// If there is not one flag for each edge.
    pub fn with_sharp_edges(mut self, sharp: Vec<bool>) -> Self {
        assert_eq!(sharp.len(), self.mesh.num_edges(), "edges of another mesh");
        self.sharp_edges = sharp;
        self
    }

    /// How the mesh came from its cage: what a file says of the cage (materials, colours, texture
    /// coordinates) follows it.
    pub fn with_ancestry(mut self, ancestry: Ancestry<'a>) -> Self {
        self.ancestry = Some(ancestry);
        self
    }

    /// The cage that this surface is, with its tags; `None` if it is refined, or known by its mesh alone.
    pub fn cage(&self) -> Option<&'a Descriptor> {
        let is_cage =
            self.level == 0 && self.at_vertices.is_none() && self.faces.len() == self.mesh.num_faces();
        self.asset.filter(|_| is_cage).map(|asset| &asset.descriptor)
    }

    /// What [`Surface::of`] gave.
    pub fn asset(&self) -> Option<&'a Asset> {
        self.asset
    }

    /// What [`Surface::with_frames`] gave.
    pub fn frames(&self) -> &[Pose] {
        &self.frames
    }

    /// What [`Surface::with_ancestry`] gave.
    pub fn ancestry(&self) -> Option<&Ancestry<'a>> {
        self.ancestry.as_ref()
    }

    /// For each corner of the faces that are written the mean of `of_face` over the faces round its vertex
    /// that hang together without a sharp edge between them.
    ///
    /// # Panics
    /// If there is not one vector for each face of the mesh.
    pub fn corner_means(&self, of_face: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        assert_eq!(of_face.len(), self.mesh.num_faces(), "vectors of another mesh");
        let mut means = vec![Vector3::zeros(); self.mesh.num_corners()];
        for fan in (0..self.mesh.num_vertices() as u32).flat_map(|v| self.mesh.fans(v)) {
            for sector in self.sectors(fan) {
                let sum: Vector3<f64> =
                    sector.iter().map(|&c| of_face[self.mesh.corner_face(c) as usize]).sum();
                for &c in &sector {
                    means[c as usize] = sum / sector.len() as f64;
                }
            }
        }
        self.faces.iter().flat_map(|&f| self.mesh.corners(f)).map(|c| means[c as usize]).collect()
    }

    /// The corners of a fan, cut at its sharp spokes.
    fn sectors(&self, fan: Fan) -> Vec<Vec<u32>> {
        let starts = |c: u32| self.is_sharp(self.mesh.corner_half_edge(c).edge());
        let mut corners = fan.corners.to_vec();
        if fan.cyclic {
            let first = corners.iter().position(|&c| starts(c)).unwrap_or(0);
            corners.rotate_left(first);
        }
        let mut sectors: Vec<Vec<u32>> = Vec::new();
        for c in corners {
            match sectors.last_mut() {
                Some(sector) if !starts(c) => sector.push(c),
                _ => sectors.push(vec![c]),
            }
        }
        sectors
    }

    fn is_sharp(&self, edge: u32) -> bool {
        self.sharp_edges.get(edge as usize).copied().unwrap_or(false)
    }

    /// Whether an edge between two of the faces is sharp, so that vectors and normals have two sides
    /// there.
    pub fn is_one_sided(&self) -> bool {
        let sharp = |&e: &u32| self.is_sharp(e) && !self.mesh.is_boundary_edge(e);
        self.edges.iter().any(sharp)
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

    /// The faces that are written and are no holes: those of a cage are written as tags.
    pub fn drawn_faces(&self) -> impl Iterator<Item = u32> + '_ {
        let holes: HashSet<u32> =
            self.cage().into_iter().flat_map(|cage| cage.holes.iter().copied()).collect();
        self.faces().filter(move |f| !holes.contains(f))
    }

    /// The edges of the faces that are written, ascending.
    pub fn edges(&self) -> impl ExactSizeIterator<Item = u32> + Clone + '_ {
        self.edges.iter().copied()
    }
}

impl AtVertices {
    fn check(&self, mesh: &Mesh) {
        assert_eq!(self.normals.len(), mesh.num_vertices(), "normals of another mesh");
        if let Some([vertices, corners]) = &self.vectors {
            let wanted = (mesh.num_vertices(), mesh.num_corners());
            assert_eq!((vertices.len(), corners.len()), wanted, "vectors of another mesh");
        }
    }
}

/// The area vector of each face; a face need not be plane.
pub(super) fn face_areas(mesh: &Mesh, positions: &Positions) -> Vec<Vector3<f64>> {
    let area = |f: u32| -> Vector3<f64> {
        let vertices = mesh.face_vertices(f);
        let from_first = |v: u32| positions[v as usize] - positions[vertices[0] as usize];
        vertices[1..].windows(2).map(|pair| from_first(pair[0]).cross(&from_first(pair[1]))).sum()
    };
    (0..mesh.num_faces() as u32).map(area).collect()
}

fn values<const K: usize>(form: &Option<crate::cochain::Cochain<K>>) -> &[f64] {
    form.as_ref().map(|form| form.values()).unwrap_or_default()
}

fn finite_positions(positions: &Positions) -> Result<(), IoError> {
    finite("the position of vertex", positions.values(), |x| x.iter().all(|x| x.is_finite()))
}

fn finite<T>(what: &'static str, values: &[T], is_finite: impl Fn(&T) -> bool) -> Result<(), IoError> {
    match values.iter().position(|value| !is_finite(value)) {
        Some(index) => Err(IoError::Overflow { what, index }),
        None => Ok(()),
    }
}
