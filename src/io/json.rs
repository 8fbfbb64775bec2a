//! A refined mesh with its forms as one JSON object.
//!
//! | key | |
//! |---|---|
//! | `level` | the level of refinement |
//! | `positions` | `[x, y, z]` for each vertex |
//! | `face_sizes`, `face_vertices` | the polygons, counter-clockwise, one after the other |
//! | `edges` | `[a, b]` for each edge, in the direction of its orientation |
//! | `form0`, `form1`, `form2` | one value for each vertex, edge (from `a` to `b`), face; only forms that were given |
//! | `face_vectors` | the tangent vector `[x, y, z]` of the 1-form at the centre of each face |
//! | `normals` | on the limit: the unit normal `[x, y, z]` at each vertex |
//! | `vertex_vectors` | on the limit, instead of `face_vectors`: the tangent vector at each vertex, the mean of its sides at creases |
//! | `corner_vectors` | on the limit: the tangent vector at each entry of `face_vertices`, on its own side of creases |
//!
//! Indices start at 0. Faces that are holes are left out, and so are edges that have no other face.
//! Numbers read back to the same bits.

use std::io::{self, Write};
use std::path::Path;

use serde::Serialize;

use super::{IoError, Surface, atomic};

/// Writes a surface.
///
/// # Errors
/// [`IoError::Write`].
pub fn write(path: &Path, surface: &Surface) -> Result<(), IoError> {
    let (mesh, fields) = (surface.mesh(), surface.fields());
    atomic::write(path, |out| {
        let mut object = Object::new(out);
        object.value("level", &surface.level())?;
        object.array("positions", surface.positions().values().iter().map(|&x| <[f64; 3]>::from(x)))?;
        object.array("face_sizes", surface.faces().map(|f| mesh.face_size(f)))?;
        object.array("face_vertices", surface.faces().flat_map(|f| mesh.face_vertices(f)))?;
        object.array("edges", surface.edges().map(|e| mesh.edges()[e as usize]))?;
        if let Some(form) = &fields.form0 {
            object.array("form0", form.values().iter())?;
        }
        if let Some(form) = &fields.form1 {
            object.array("form1", surface.edges().map(|e| form[e as usize]))?;
        }
        if let Some(form) = &fields.form2 {
            object.array("form2", surface.faces().map(|f| form[f as usize]))?;
        }
        if let Some(vectors) = surface.face_vectors() {
            object.array("face_vectors", surface.faces().map(|f| <[f64; 3]>::from(vectors[f as usize])))?;
        }
        if let Some(at) = surface.at_vertices() {
            let arrays = |vectors: &[nalgebra::Vector3<f64>]| -> Vec<[f64; 3]> {
                vectors.iter().map(|&v| v.into()).collect()
            };
            object.array("normals", arrays(&at.normals).into_iter())?;
            if let Some([vertices, corners]) = &at.vectors {
                object.array("vertex_vectors", arrays(vertices).into_iter())?;
                let corners = arrays(corners);
                let written = surface.faces().flat_map(|f| mesh.corners(f)).map(|c| corners[c as usize]);
                object.array("corner_vectors", written)?;
            }
        }
        object.close()
    })
}

/// A JSON object of arrays, written as it comes: a fine mesh need not be in memory twice. Each array is
/// on lines of its own.
pub(super) struct Object<'a, W> {
    out: &'a mut W,
    open: bool,
}

impl<'a, W: Write> Object<'a, W> {
    pub(super) fn new(out: &'a mut W) -> Self {
        Object { out, open: false }
    }

    pub(super) fn value(&mut self, key: &str, value: &impl Serialize) -> io::Result<()> {
        write!(self.out, "{}\n\"{key}\": ", if self.open { "," } else { "{" })?;
        self.open = true;
        Ok(serde_json::to_writer(&mut *self.out, value)?)
    }

    pub(super) fn array(
        &mut self,
        key: &str,
        entries: impl Iterator<Item = impl Serialize>,
    ) -> io::Result<()> {
        write!(self.out, "{}\n\"{key}\": [", if self.open { "," } else { "{" })?;
        self.open = true;
        for (i, entry) in entries.enumerate() {
            self.out.write_all(if i == 0 { b"\n" } else { b",\n" })?;
            serde_json::to_writer(&mut *self.out, &entry)?;
        }
        self.out.write_all(b"\n]")
    }

    pub(super) fn close(self) -> io::Result<()> {
        self.out.write_all(if self.open { b"\n}\n" } else { b"{}\n" })
    }
}
