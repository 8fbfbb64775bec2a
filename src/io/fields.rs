//! Forms on a mesh, as JSON.
//!
//! ```json
//! {
//!   "vertices": [[0, 1.5]],
//!   "edges": [[0, 1, 0.25], [2, 1, -3]],
//!   "faces": [[4, 0.5]]
//! }
//! ```
//!
//! Each key is a form: `vertices` a 0-form as `[vertex, value]`, `edges` a 1-form as `[a, b, value]` with
//! the circulation from vertex `a` to vertex `b`, `faces` a 2-form as `[face, value]`. All indices start
//! at 0. Cells that are not listed have the value 0; a key that is left out means that there is no such
//! form. A key `face_vectors`, which [`write_to`] adds for other programs, is passed over.

use std::fmt;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;

use super::json::Object;
use super::{IoError, Surface, atomic};
use crate::cochain::Cochain;
use crate::io::error::quote;
use crate::topology::{HalfEdge, Mesh};

/// Forms on one mesh, at most one of each degree.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fields {
    /// One value for each vertex.
    pub form0: Option<Cochain<0>>,
    /// One value for each edge, in the direction of the mesh's edge.
    pub form1: Option<Cochain<1>>,
    /// One value for each face, positive for the counter-clockwise side.
    pub form2: Option<Cochain<2>>,
}

impl Fields {
    /// Whether there is no form.
    pub fn is_empty(&self) -> bool {
        self.form0.is_none() && self.form1.is_none() && self.form2.is_none()
    }
}

/// What is wrong with a fields file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum FieldsProblem {
    #[error(
        "line {line}, column {column}: {reason}: write {{\"edges\": [[a, b, value], ..]}} in JSON, where NaN and infinity do not exist"
    )]
    Syntax { line: usize, column: usize, reason: String },
    #[error("holds no form: give it \"edges\", \"vertices\" or \"faces\"")]
    NoForm,
    #[error("{entry}: an entry is {expected}, correct it")]
    Shape { entry: Entry, expected: &'static str },
    #[error(
        "{entry}: {index} is not the index of a {cell}, of which there are {count}: correct it (indices start at 0)"
    )]
    OutOfRange { entry: Entry, index: String, cell: &'static str, count: usize },
    #[error("{entry}: no edge joins vertices {a} and {b}: correct the entry (indices start at 0)")]
    NoEdge { entry: Entry, a: u32, b: u32 },
    #[error("{entry}: {cell} has a value already, from entry {first}: remove one of them")]
    Repeated { entry: Entry, cell: String, first: usize },
}

/// An entry of a fields file as it stands there, for a message: `edges[3] = [1, 7, 0.5]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    key: &'static str,
    number: usize,
    text: String,
}

impl fmt::Display for Entry {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}[{}] = {}", self.key, self.number, self.text)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    vertices: Option<Vec<Value>>,
    edges: Option<Vec<Value>>,
    faces: Option<Vec<Value>>,
    #[serde(rename = "face_vectors")]
    _face_vectors: Option<IgnoredAny>,
}

/// Reads forms on `mesh` from a file.
///
/// # Errors
/// [`IoError::Read`], or as for [`parse`].
pub fn read(path: &Path, mesh: &Mesh) -> Result<Fields, IoError> {
    let bytes = fs::read(path).map_err(IoError::read(path))?;
    parse(&path.display().to_string(), &bytes, mesh)
}

/// Reads forms on `mesh` from the contents of a file; `name` is used in messages.
///
/// # Errors
/// [`IoError::Fields`], naming the entry: bad JSON, an unknown key, an entry of another shape, an index
/// out of range, an edge that does not exist, a cell given twice (an edge in either direction).
pub fn parse(name: &str, bytes: &[u8], mesh: &Mesh) -> Result<Fields, IoError> {
    let fail = |problem| IoError::Fields { file: name.to_owned(), problem };
    let file: File = serde_json::from_slice(bytes).map_err(|error| fail(syntax(&error)))?;
    let fields = Fields {
        form0: file.vertices.map(|entries| cells("vertices", &entries, mesh)).transpose().map_err(fail)?,
        form1: file.edges.map(|entries| edges(&entries, mesh)).transpose().map_err(fail)?,
        form2: file.faces.map(|entries| cells("faces", &entries, mesh)).transpose().map_err(fail)?,
    };
    if fields.is_empty() { Err(fail(FieldsProblem::NoForm)) } else { Ok(fields) }
}

fn syntax(error: &serde_json::Error) -> FieldsProblem {
    let (line, column) = (error.line(), error.column());
    let message = error.to_string();
    // The message carries the place at its end; it goes to the front, where editors look for it.
    let place = format!(" at line {line} column {column}");
    let reason = message.strip_suffix(&place).unwrap_or(&message).to_owned();
    FieldsProblem::Syntax { line, column, reason }
}

/// The values of one form under construction, and which entry gave each.
struct Form {
    key: &'static str,
    values: Vec<f64>,
    given_by: Vec<u32>,
}

const NOBODY: u32 = u32::MAX;

impl Form {
    fn new(key: &'static str, cells: usize) -> Self {
        Form { key, values: vec![0.0; cells], given_by: vec![NOBODY; cells] }
    }

    fn entry(&self, number: usize, entry: &Value) -> Entry {
        let text = entry.to_string();
        Entry { key: self.key, number, text: if text.len() <= 60 { text } else { quote(&text) } }
    }

    fn set(
        &mut self,
        number: usize,
        entry: &Value,
        cell: usize,
        name: String,
        value: f64,
    ) -> Result<(), FieldsProblem> {
        match self.given_by[cell] {
            NOBODY => {
                self.given_by[cell] = number as u32;
                self.values[cell] = value;
                Ok(())
            }
            first => Err(FieldsProblem::Repeated {
                entry: self.entry(number, entry),
                cell: name,
                first: first as usize,
            }),
        }
    }

    fn index(
        &self,
        number: usize,
        entry: &Value,
        index: &Value,
        (cell, count): (&'static str, usize),
    ) -> Result<u32, FieldsProblem> {
        match index.as_u64() {
            Some(index) if index < count as u64 => Ok(index as u32),
            _ => Err(FieldsProblem::OutOfRange {
                entry: self.entry(number, entry),
                index: index.to_string(),
                cell,
                count,
            }),
        }
    }
}

/// The entry as an array of `N` numbers.
fn numbers<const N: usize>(entry: &Value) -> Option<&[Value; N]> {
    let array: &[Value; N] = entry.as_array()?.as_slice().try_into().ok()?;
    array.iter().all(Value::is_number).then_some(array)
}

fn cells<const K: usize>(
    key: &'static str,
    entries: &[Value],
    mesh: &Mesh,
) -> Result<Cochain<K>, FieldsProblem> {
    let (cell, expected) = match K {
        0 => ("vertex", "[vertex, value], two numbers"),
        _ => ("face", "[face, value], two numbers"),
    };
    let count = mesh.num_cells(K);
    let mut form = Form::new(key, count);
    for (number, entry) in entries.iter().enumerate() {
        let shape = || FieldsProblem::Shape { entry: form.entry(number, entry), expected };
        let [index, value] = numbers(entry).ok_or_else(shape)?;
        let value = value.as_f64().ok_or_else(shape)?;
        let index = form.index(number, entry, index, (cell, count))?;
        form.set(number, entry, index as usize, format!("{cell} {index}"), value)?;
    }
    Ok(Cochain::new(form.values))
}

fn edges(entries: &[Value], mesh: &Mesh) -> Result<Cochain<1>, FieldsProblem> {
    let expected = "[a, b, value], three numbers";
    let vertices = ("vertex", mesh.num_vertices());
    let mut form = Form::new("edges", mesh.num_edges());
    for (number, entry) in entries.iter().enumerate() {
        let shape = || FieldsProblem::Shape { entry: form.entry(number, entry), expected };
        let [a, b, value] = numbers(entry).ok_or_else(shape)?;
        let value = value.as_f64().ok_or_else(shape)?;
        let a = form.index(number, entry, a, vertices)?;
        let b = form.index(number, entry, b, vertices)?;
        let Some(h) = find(mesh, a, b) else {
            return Err(FieldsProblem::NoEdge { entry: form.entry(number, entry), a, b });
        };
        form.set(
            number,
            entry,
            h.edge() as usize,
            format!("the edge between {a} and {b}"),
            h.sign() * value,
        )?;
    }
    Ok(Cochain::new(form.values))
}

/// Searches from the end with fewer edges: a file may list all the spokes of one large fan.
pub(super) fn find(mesh: &Mesh, a: u32, b: u32) -> Option<HalfEdge> {
    if mesh.vertex_half_edges(a).len() <= mesh.vertex_half_edges(b).len() {
        mesh.find_half_edge(a, b)
    } else {
        mesh.find_half_edge(b, a).map(HalfEdge::twin)
    }
}

/// Writes the forms of a surface, with the indices of the mesh that its writers write: faces that are
/// left out are not counted, and neither are edges without a face. Where there is a 1-form, the key
/// `face_vectors` has its tangent vector at the centre of each face.
///
/// # Errors
/// [`IoError::Write`].
pub fn write(path: &Path, surface: &Surface) -> Result<(), IoError> {
    atomic::write(path, |out| write_to(out, surface))
}

/// [`write()`], into a stream.
///
/// # Errors
/// Those of the stream.
pub fn write_to(out: &mut impl Write, surface: &Surface) -> io::Result<()> {
    let fields = surface.fields();
    let mut object = Object::new(out);
    if let Some(form) = &fields.form0 {
        object.array("vertices", form.values().iter().enumerate())?;
    }
    if let Some(form) = &fields.form1 {
        let entry = |e: u32| {
            let [a, b] = surface.mesh().edges()[e as usize];
            (a, b, form[e as usize])
        };
        object.array("edges", surface.edges().map(entry))?;
    }
    if let Some(form) = &fields.form2 {
        object.array("faces", surface.faces().map(|f| form[f as usize]).enumerate())?;
    }
    if let Some(vectors) = surface.face_vectors() {
        object.array("face_vectors", surface.faces().map(|f| <[f64; 3]>::from(vectors[f as usize])))?;
    }
    object.close()
}
