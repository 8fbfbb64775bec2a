use formwork::cochain::Cochain;
use formwork::field;
use formwork::hierarchy::{Hierarchy, HierarchyError};
use formwork::io::fields::Fields;
use formwork::io::{AtVertices, Pose, Positions};
use formwork::limit::{Limit, LimitTangents};
use formwork::topology::Mesh;
use nalgebra::Vector3;

use super::count;

/// Takes the finest level of a hierarchy to its limit.
pub struct ToLimit<'a> {
    mesh: &'a Mesh,
    limit: Limit,
    tangents: LimitTangents,
    /// The 1-form of the finest level, and all forms in the limit.
    form1: Option<Cochain<1>>,
    forms: Fields,
    /// How many vertices have no tangent plane of their own.
    bare: usize,
}

impl<'a> ToLimit<'a> {
    /// With the forms of the finest level.
    pub fn new(hierarchy: &'a Hierarchy, fields: &Fields) -> Result<Self, HierarchyError> {
        let mesh = hierarchy.finest().mesh();
        let (limit, tangents) = Limit::with_tangents(hierarchy, hierarchy.num_levels())?;
        let forms = Fields {
            form0: fields.form0.as_ref().map(|form| limit.apply(mesh, form)),
            form1: fields.form1.as_ref().map(|form| limit.apply(mesh, form)),
            form2: fields.form2.as_ref().map(|form| limit.apply(mesh, form)),
        };
        // Which vertices have a tangent plane is a matter of tags, not of positions.
        let has_plane = tangents.at_vertices(mesh, &vec![Vector3::z(); tangents.len()]);
        let is_bare = |v: usize| has_plane[v].is_none() && !mesh.vertex_half_edges(v as u32).is_empty();
        let bare = (0..mesh.num_vertices()).filter(|&v| is_bare(v)).count();
        Ok(ToLimit { mesh, limit, tangents, form1: fields.form1.clone(), forms, bare })
    }

    /// The forms in the limit.
    pub fn forms(&self) -> &Fields {
        &self.forms
    }

    /// Values on the vertices of the finest level, in the limit.
    pub fn values(&self, values: &Cochain<0>) -> Cochain<0> {
        self.limit.apply(self.mesh, values)
    }

    /// Positions of the finest level in the limit, with normals and vectors.
    pub fn pose(&self, time: f64, positions: &Positions) -> Pose {
        let (mesh, tangents) = (self.mesh, &self.tangents);
        let on_limit = self.limit.apply(mesh, positions);
        let normals = tangents.at_vertices(mesh, &tangents.normals(mesh, positions));
        let flat_normals = field::vertex_normals(mesh, &on_limit);
        let vectors = self.form1.as_ref().zip(self.forms.form1.as_ref()).map(|(form, circulations)| {
            let of_pairs = tangents.vectors(mesh, positions, form);
            let flat = field::vertex_vectors(mesh, &field::face_vectors(mesh, &on_limit, circulations));
            let at_vertices = tangents.at_vertices(mesh, &of_pairs).into_iter().zip(flat);
            let at_vertices: Vec<_> = at_vertices.map(|(exact, flat)| exact.unwrap_or(flat)).collect();
            let at_corner = |corner: u32| match tangents.pair_of_corner(corner) {
                Some(pair) => of_pairs[pair],
                None => at_vertices[mesh.corner_vertex(corner) as usize],
            };
            let at_corners = (0..mesh.num_corners() as u32).map(at_corner).collect();
            [at_vertices, at_corners]
        });
        let unit = |(exact, flat): (Option<Vector3<f64>>, _)| {
            exact.and_then(|normal| normal.try_normalize(0.0)).unwrap_or(flat)
        };
        let normals = normals.into_iter().zip(flat_normals).map(unit).collect();
        Pose { time, positions: on_limit, at_vertices: Some(AtVertices { normals, vectors }) }
    }

    /// A word on vertices that have no normal and no vector of their own.
    pub fn note(&self) -> Option<String> {
        (self.bare > 0).then(|| {
            let vertices = count(self.bare, "vertex");
            format!("{vertices} without a tangent plane (sharp, without sharp edges): normals and vectors there are means of the faces round them")
        })
    }
}
