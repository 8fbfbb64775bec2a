//! The operators of a hierarchy as a NumPy archive.
//!
//! For each level `l`, with `V`, `E`, `F` its counts and `C` its corners:
//!
//! | array | shape, type | |
//! |---|---|---|
//! | `l{l}/edges` | `(E, 2)` i32 | the vertices of each edge, in the direction of its orientation |
//! | `l{l}/face_sizes` | `(F,)` i32 | |
//! | `l{l}/face_vertices` | `(C,)` i32 | the polygons, counter-clockwise, one after the other |
//! | `l{l}/d0`, `l{l}/d1` | matrices `(E, V)`, `(F, E)` | the exterior derivatives |
//! | `l{l}/S0`, `l{l}/S1`, `l{l}/S2` | matrices, `l >= 1` | from level `l - 1` to level `l` |
//! | `l{l}/vertex_parent_kind` | `(V,)` u8, `l >= 1` | 0 vertex, 1 edge, 2 face of level `l - 1` |
//! | `l{l}/vertex_parent_index` | `(V,)` i32, `l >= 1` | its number |
//!
//! A matrix `M` is four arrays, `M_data` (f64), `M_indices` (i32), `M_indptr` (i64) and `M_shape` (i64):
//! compressed sparse rows. In SciPy:
//!
//! ```text
//! def matrix(npz, name):
//!     parts = (npz[f"{name}_{part}"] for part in ("data", "indices", "indptr"))
//!     return scipy.sparse.csr_matrix(tuple(parts), shape=npz[f"{name}_shape"])
//! ```
//!
//! Faces that are holes belong to the complex and are here.

use std::io::{self, Seek, Write};
use std::path::Path;

use npyz::npz::NpzWriter;
use npyz::zip::{CompressionMethod, DateTime, write::FileOptions};
use npyz::{AutoSerialize, WriterBuilder};

use nalgebra::Vector3;

use super::{IoError, Surface, atomic};
use crate::sparse::Csr;
use crate::topology::{Mesh, Parent, Split};

/// One level of a hierarchy.
pub struct Level<'a> {
    /// The complex.
    pub mesh: &'a Mesh,
    /// The way from the level before; none for level 0.
    pub step: Option<Step<'a>>,
}

/// The way from one level to the next.
pub struct Step<'a> {
    /// The numbering of the children.
    pub split: &'a Split,
    /// `S0`, `S1` and `S2`.
    pub operators: [Csr; 3],
}

/// Writes levels 0, 1, .. as the iterator makes them: the operators of one level are in memory at a time.
///
/// # Errors
/// [`IoError::Write`].
pub fn write<'a>(path: &Path, levels: impl IntoIterator<Item = Level<'a>>) -> Result<(), IoError> {
    atomic::write(path, |out| {
        let mut archive = Archive { npz: NpzWriter::new(out) };
        let write = || {
            for (l, level) in levels.into_iter().enumerate() {
                archive.level(l, &level)?;
            }
            archive.npz.zip_writer().finish()?;
            Ok(())
        };
        let result = write();
        if result.is_err() {
            // Dropped unfinished, it would try once more and print its own complaint.
            std::mem::forget(archive);
        }
        result
    })
}

/// An array to be written: its numbers, row by row.
pub enum Array<'a> {
    /// Numbers, f64.
    Floats(&'a [f64]),
    /// Vectors, f64, with one axis more than the shape says.
    Vectors(&'a [Vector3<f64>]),
    /// Indices, i32.
    Indices(&'a [u32]),
    /// A matrix, as four arrays, whatever the shape says.
    Matrix(&'a Csr),
}

/// Writes arrays, each with its name and shape.
///
/// # Errors
/// [`IoError::Write`].
///
/// # Panics
/// If an array does not have its shape.
pub fn write_arrays(path: &Path, arrays: &[(&str, &[usize], Array)]) -> Result<(), IoError> {
    atomic::write(path, |out| {
        let mut archive = Archive { npz: NpzWriter::new(out) };
        let mut write = || {
            for (name, shape, array) in arrays {
                match array {
                    Array::Floats(values) => archive.array(name, shape, values.iter().copied())?,
                    Array::Matrix(matrix) => archive.matrix(name, matrix)?,
                    Array::Indices(values) => archive.array(name, shape, signed(values.iter().copied()))?,
                    Array::Vectors(values) => {
                        let shape = [*shape, &[3]].concat();
                        archive.array(name, &shape, values.iter().flat_map(|v| [v.x, v.y, v.z]))?;
                    }
                }
            }
            archive.npz.zip_writer().finish()?;
            Ok(())
        };
        let result = write();
        if result.is_err() {
            std::mem::forget(archive); // as in `write`
        }
        result
    })
}

/// Writes a surface that lies on its limit: `edges` (E, 2), `face_sizes`, `face_vertices`, `positions` (V, 3),
/// `normals` (V, 3) and, where there are such forms, `values` (V,), `circulations` (E,), `fluxes` (F,),
/// `vertex_vectors` (V, 3) and `corner_vectors`, one row for each entry of `face_vertices`.
///
/// # Errors
/// [`IoError::Write`].
pub fn write_surface(path: &Path, surface: &Surface) -> Result<(), IoError> {
    let (mesh, fields) = (surface.mesh(), surface.fields());
    let faces: Vec<u32> = surface.faces().collect();
    let corners: Vec<u32> = faces.iter().flat_map(|&f| mesh.corners(f)).collect();
    let edges: Vec<u32> = surface.edges().flat_map(|e| mesh.edges()[e as usize]).collect();
    let sizes: Vec<u32> = faces.iter().map(|&f| mesh.face_size(f) as u32).collect();
    let vertices: Vec<u32> = corners.iter().map(|&c| mesh.corner_vertex(c)).collect();
    let circulations: Option<Vec<f64>> =
        fields.form1.as_ref().map(|form| surface.edges().map(|e| form[e as usize]).collect());
    let fluxes: Option<Vec<f64>> =
        fields.form2.as_ref().map(|form| faces.iter().map(|&f| form[f as usize]).collect());
    let vectors = surface.at_vertices().and_then(|at| at.vectors.as_ref());
    let corner_vectors: Option<Vec<_>> =
        vectors.map(|[_, of_corners]| corners.iter().map(|&c| of_corners[c as usize]).collect());
    let shapes = [mesh.num_vertices(), edges.len() / 2, faces.len(), corners.len()].map(|n| [n]);
    let [v, e, f, c] = [&shapes[0][..], &shapes[1], &shapes[2], &shapes[3]];
    let pairs = [e[0], 2];
    let mut arrays = vec![
        ("edges", &pairs[..], Array::Indices(&edges)),
        ("face_sizes", f, Array::Indices(&sizes)),
        ("face_vertices", c, Array::Indices(&vertices)),
        ("positions", v, Array::Vectors(surface.positions().values())),
    ];
    if let Some(at) = surface.at_vertices() {
        arrays.push(("normals", v, Array::Vectors(&at.normals)));
    }
    if let Some(form) = &fields.form0 {
        arrays.push(("values", v, Array::Floats(form.values())));
    }
    if let Some(circulations) = &circulations {
        arrays.push(("circulations", e, Array::Floats(circulations)));
    }
    if let Some(fluxes) = &fluxes {
        arrays.push(("fluxes", f, Array::Floats(fluxes)));
    }
    if let (Some([of_vertices, _]), Some(of_corners)) = (vectors, &corner_vectors) {
        arrays.push(("vertex_vectors", v, Array::Vectors(of_vertices)));
        arrays.push(("corner_vectors", c, Array::Vectors(of_corners)));
    }
    write_arrays(path, &arrays)
}

struct Archive<W: Write + Seek> {
    npz: NpzWriter<W>,
}

impl<W: Write + Seek> Archive<W> {
    fn level(&mut self, l: usize, level: &Level) -> io::Result<()> {
        let mesh = level.mesh;
        let name = |array: &str| format!("l{l}/{array}");
        let ends = mesh.edges().iter().flatten().copied();
        self.array(&name("edges"), &[mesh.num_edges(), 2], signed(ends))?;
        let sizes = (0..mesh.num_faces() as u32).map(|f| mesh.face_size(f) as u32);
        self.array(&name("face_sizes"), &[mesh.num_faces()], signed(sizes))?;
        let corners = mesh.corner_vertices().iter().copied();
        self.array(&name("face_vertices"), &[mesh.num_corners()], signed(corners))?;
        self.matrix(&name("d0"), &mesh.d0())?;
        self.matrix(&name("d1"), &mesh.d1())?;
        let Some(step) = &level.step else { return Ok(()) };
        for (k, operator) in step.operators.iter().enumerate() {
            self.matrix(&name(&format!("S{k}")), operator)?;
        }
        let parents = (0..mesh.num_vertices()).map(|v| match step.split.vertex_parent(v) {
            Parent::Vertex(i) => (0u8, i),
            Parent::Edge(i) => (1, i),
            Parent::Face(i) => (2, i),
        });
        let shape = [mesh.num_vertices()];
        self.array(&name("vertex_parent_kind"), &shape, parents.clone().map(|(kind, _)| kind))?;
        self.array(&name("vertex_parent_index"), &shape, signed(parents.map(|(_, index)| index)))
    }

    fn matrix(&mut self, name: &str, matrix: &Csr) -> io::Result<()> {
        let entries = [matrix.nnz()];
        self.array(&format!("{name}_data"), &entries, matrix.data().iter().copied())?;
        self.array(&format!("{name}_indices"), &entries, signed(matrix.indices().iter().copied()))?;
        let offsets = matrix.indptr();
        let offsets = offsets.as_slice().unwrap_or_default().iter().map(|&offset| offset as i64);
        self.array(&format!("{name}_indptr"), &[matrix.rows() + 1], offsets)?;
        let shape = [matrix.rows() as i64, matrix.cols() as i64];
        self.array(&format!("{name}_shape"), &[2], shape.into_iter())
    }

    fn array<T: AutoSerialize>(
        &mut self,
        name: &str,
        shape: &[usize],
        values: impl Iterator<Item = T>,
    ) -> io::Result<()> {
        // Stored, like numpy.savez: the arrays load at the speed of the disk. No date, so that the same
        // input gives the same bytes.
        let options = FileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .last_modified_time(DateTime::default())
            .large_file(true);
        let shape: Vec<u64> = shape.iter().map(|&n| n as u64).collect();
        let array = self.npz.array(name, options)?;
        let mut array = array.default_dtype().shape(&shape).begin_nd()?;
        array.extend(values)?;
        array.finish()
    }
}

/// NumPy and SciPy index by signed numbers. Every index here is below 2^31: a cage has no more of
/// anything, and a hierarchy refuses to be refined beyond.
fn signed(indices: impl Iterator<Item = u32>) -> impl Iterator<Item = i32> {
    indices.map(|index| index as i32)
}
