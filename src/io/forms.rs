use super::fields::{self, Fields};
use crate::cochain::Cochain;
use crate::topology::{Descriptor, Mesh};

/// Forms as the file of a mesh carries them, before its edges have numbers. [`Forms::on`] puts them on
/// the mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Forms {
    /// One value for each vertex.
    pub form0: Option<Vec<f64>>,
    /// A 1-form, in one of the ways that files have.
    pub form1: Option<Form1>,
    /// One value for each face, positive for the side from which the surface is seen.
    pub form2: Option<Vec<f64>>,
}

/// A 1-form without edge numbers.
#[derive(Clone, Debug, PartialEq)]
pub enum Form1 {
    /// For each corner, in the order of the file's faces, the circulation from its vertex to the next one
    /// in that order. The faces of an edge say the same, up to sign and, at most, [`SAME_EDGE`].
    Corners(Vec<f64>),
    /// `a`, `b` and the circulation from `a` to `b`; edges not listed have 0.
    Edges(Vec<([u32; 2], f64)>),
}

/// How far the values of an edge's faces may differ, relative to the larger: a few roundings of the
/// 32-bit floats that files hold them in.
pub const SAME_EDGE: f64 = 1e-6;

impl Forms {
    /// Whether there is no form.
    pub fn is_empty(&self) -> bool {
        self.form0.is_none() && self.form1.is_none() && self.form2.is_none()
    }

    /// The forms on level 0 of the cage that `descriptor` describes.
    ///
    /// # Errors
    /// What is wrong, in words: a wrong number of values, one that is not finite, the two sides of an
    /// edge that differ, an edge that does not exist.
    pub fn on(&self, descriptor: &Descriptor, mesh: &Mesh) -> Result<Fields, String> {
        Ok(Fields {
            form0: self
                .form0
                .as_ref()
                .map(|v| cells("form0", "vertex", v, mesh.num_vertices()))
                .transpose()?,
            form1: self.form1.as_ref().map(|form| form.on(descriptor, mesh)).transpose()?,
            form2: self.form2.as_ref().map(|v| cells("form2", "face", v, mesh.num_faces())).transpose()?,
        })
    }
}

fn cells<const K: usize>(name: &str, cell: &str, values: &[f64], count: usize) -> Result<Cochain<K>, String> {
    check(name, cell, values, count)?;
    Ok(Cochain::new(values.to_vec()))
}

fn check(name: &str, cell: &str, values: &[f64], count: usize) -> Result<(), String> {
    if values.len() != count {
        let found = values.len();
        return Err(format!("{name} has {found} values: give it {count}, one for each {cell}"));
    }
    match values.iter().position(|x| !x.is_finite()) {
        Some(i) => Err(format!("{name} has the value {} at {cell} {i}: values must be finite", values[i])),
        None => Ok(()),
    }
}

impl Form1 {
    fn on(&self, d: &Descriptor, mesh: &Mesh) -> Result<Cochain<1>, String> {
        match self {
            Form1::Corners(values) => {
                check("form1", "corner of a face", values, mesh.num_corners())?;
                on_corners(d, mesh, values)
            }
            Form1::Edges(edges) => on_edges(mesh, edges),
        }
    }
}

fn on_corners(d: &Descriptor, mesh: &Mesh, values: &[f64]) -> Result<Cochain<1>, String> {
    let mut form = vec![0.0; mesh.num_edges()];
    let mut known = vec![false; mesh.num_edges()];
    for face in 0..mesh.num_faces() as u32 {
        let first = mesh.corners(face).start as usize;
        for (i, h) in file_half_edges(d, mesh, face).enumerate() {
            let (e, value) = (h.edge() as usize, values[first + i] * h.sign());
            if !known[e] {
                (known[e], form[e]) = (true, value);
            } else if (form[e] - value).abs() > SAME_EDGE * form[e].abs().max(value.abs()) {
                let [a, b] = mesh.edges()[e];
                return Err(format!(
                    "form1 has {} from vertex {a} to vertex {b} in one face and {value} in face {face}: both sides of an edge must say the same, with opposite signs as each face runs along it",
                    form[e]
                ));
            }
        }
    }
    Ok(Cochain::new(form))
}

/// The half-edges of a face in the order of the file's corners, as the file runs along them. A face that
/// is listed clockwise was turned, its first vertex staying.
pub(super) fn file_half_edges(
    d: &Descriptor,
    mesh: &Mesh,
    face: u32,
) -> impl Iterator<Item = crate::topology::HalfEdge> {
    let edges = mesh.face_half_edges(face);
    let (n, turned) = (edges.len(), d.left_handed);
    (0..n).map(move |i| if turned { edges[n - 1 - i].twin() } else { edges[i] })
}

fn on_edges(mesh: &Mesh, edges: &[([u32; 2], f64)]) -> Result<Cochain<1>, String> {
    let mut form = vec![0.0; mesh.num_edges()];
    let mut given_by = vec![usize::MAX; mesh.num_edges()];
    for (i, &([a, b], value)) in edges.iter().enumerate() {
        let inside = (a.max(b) as usize) < mesh.num_vertices();
        let Some(h) = (if inside { fields::find(mesh, a, b) } else { None }) else {
            return Err(format!("form1: entry {i}: no edge joins vertices {a} and {b}: correct it"));
        };
        let e = h.edge() as usize;
        if given_by[e] != usize::MAX {
            return Err(format!(
                "form1: entry {i}: the edge between {a} and {b} has a value already, from entry {}: remove one",
                given_by[e]
            ));
        }
        if !value.is_finite() {
            return Err(format!("form1: entry {i} has the value {value}: values must be finite"));
        }
        (given_by[e], form[e]) = (i, h.sign() * value);
    }
    Ok(Cochain::new(form))
}
