use crate::cochain::Cochain;
use crate::topology::{Mesh, Parent, Split};

/// How a refined mesh came from its cage, and so what becomes of other values that a file has on the cage.
pub struct Ancestry<'a> {
    levels: Vec<(&'a Mesh, &'a Split)>,
    finest: &'a Mesh,
    refine: &'a dyn Fn(&Cochain<0>) -> Cochain<0>,
}

impl<'a> Ancestry<'a> {
    /// `levels` are the meshes that were split, the cage first, and how; `finest` is what they became, and
    /// `refine` takes a 0-form from the cage to it.
    ///
    /// # Panics
    /// If `finest` is not what the last split makes.
    pub fn new(
        levels: Vec<(&'a Mesh, &'a Split)>,
        finest: &'a Mesh,
        refine: &'a dyn Fn(&Cochain<0>) -> Cochain<0>,
    ) -> Self {
        let children = levels.last().map(|(_, split)| split.num_children(2));
        assert!(children.is_none_or(|children| children == finest.num_faces()), "splits of another mesh");
        Ancestry { levels, finest, refine }
    }

    /// The mesh of the cage.
    pub fn cage(&self) -> &'a Mesh {
        self.levels.first().map_or(self.finest, |(mesh, _)| mesh)
    }

    /// Each level with its split and what became of it.
    fn steps(&self) -> impl Iterator<Item = (&'a Mesh, &'a Split, &'a Mesh)> {
        let children = self.levels.iter().skip(1).map(|(mesh, _)| *mesh).chain([self.finest]);
        self.levels.iter().zip(children).map(|(&(parent, split), child)| (parent, split, child))
    }

    /// For each face the face of the cage that it lies in.
    pub fn control_faces(&self) -> Vec<u32> {
        self.steps().fold(
            (0..self.cage().num_faces() as u32).collect(),
            |control: Vec<u32>, (parent, split, child)| {
                (0..child.num_faces()).map(|f| control[split.face_parent(parent, f) as usize]).collect()
            },
        )
    }

    /// Values on vertices, refined as positions are.
    ///
    /// # Panics
    /// If there is not one for each vertex of the cage.
    pub fn at_vertices(&self, values: Vec<f64>) -> Vec<f64> {
        (self.refine)(&Cochain::new(values)).into_values()
    }

    /// Values on vertices, interpolated linearly along edges and within faces.
    ///
    /// # Panics
    /// If there is not one for each vertex of the cage.
    pub fn linear_at_vertices(&self, values: Vec<f64>) -> Vec<f64> {
        self.steps().fold(values, |values, (parent, split, child)| {
            let mean = |vertices: &[u32]| {
                vertices.iter().map(|&v| values[v as usize]).sum::<f64>() / vertices.len() as f64
            };
            let value = |x: usize| match split.vertex_parent(x) {
                Parent::Vertex(v) => values[v as usize],
                Parent::Edge(e) => mean(&parent.edges()[e as usize]),
                Parent::Face(f) => mean(parent.face_vertices(f)),
            };
            (0..child.num_vertices()).map(value).collect()
        })
    }

    /// Values on the corners of faces, which may differ between the faces of a vertex, interpolated linearly
    /// within each face: OpenSubdiv's rule `FVAR_LINEAR_ALL`.
    ///
    /// # Panics
    /// If there is not one for each corner of the cage.
    pub fn linear_at_corners(&self, values: Vec<f64>) -> Vec<f64> {
        self.steps().fold(values, |values, (parent, split, child)| {
            let mut fine = Vec::with_capacity(child.num_corners());
            for face in 0..child.num_faces() as u32 {
                let of = split.face_parent(parent, face as usize);
                let corners = parent.corners(of);
                let here = &values[corners.start as usize..corners.end as usize];
                let (vertices, edges) = (parent.face_vertices(of), parent.face_half_edges(of));
                fine.extend(child.face_vertices(face).iter().map(
                    |&x| match split.vertex_parent(x as usize) {
                        Parent::Vertex(v) => {
                            vertices.iter().zip(here).find(|(w, _)| **w == v).map_or(0.0, |(_, &value)| value)
                        }
                        Parent::Edge(e) => {
                            let i = edges.iter().position(|h| h.edge() == e).unwrap_or_default();
                            (here[i] + here[(i + 1) % here.len()]) / 2.0
                        }
                        Parent::Face(_) => here.iter().sum::<f64>() / here.len() as f64,
                    },
                ));
            }
            fine
        })
    }
}
