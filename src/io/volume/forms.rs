//! Forms on a solid, as JSON.
//!
//! ```json
//! {
//!   "vertices":  [[0, 1.5]],
//!   "edges":     [[0, 1, 0.25], [2, 1, -3]],
//!   "triangles": [[0, 1, 2, 0.5]],
//!   "cells":     [[7, 2.0]]
//! }
//! ```
//!
//! `edges` is a 1-form, the circulation from vertex `a` to `b`; `triangles` a 2-form, the flux through `a, b, c` towards
//! the side from which they run counter-clockwise; `cells` a 3-form, the integral over a cell. Cells are numbered as in
//! the mesh file, tetrahedra first, each octahedron after them. Indices start at 0. What is not listed is 0; a key that
//! is left out means that there is no such form.

use std::fs;
use std::path::Path;

use serde::Deserialize;

use crate::io::IoError;

/// Forms by the vertices of their cells; 3-forms by numbers of cells.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolidForms {
    /// 0-form: vertex, value.
    pub vertices: Option<Vec<(u32, f64)>>,
    /// 1-form: from, to, circulation.
    pub edges: Option<Vec<(u32, u32, f64)>>,
    /// 2-form: three vertices, flux.
    pub triangles: Option<Vec<(u32, u32, u32, f64)>>,
    /// 3-form: cell, integral.
    pub cells: Option<Vec<(u32, f64)>>,
}

impl SolidForms {
    /// Whether there is no form.
    pub fn is_empty(&self) -> bool {
        *self == SolidForms::default()
    }
}

/// Reads forms from a file.
///
/// # Errors
/// [`IoError::Read`]; [`IoError::Content`] with the line that is wrong.
pub fn read(path: &Path) -> Result<SolidForms, IoError> {
    let bytes = fs::read(path).map_err(IoError::read(path))?;
    parse(&path.display().to_string(), &bytes)
}

/// Reads forms from the contents of a file; `name` is used in messages.
///
/// # Errors
/// [`IoError::Content`] with the line that is wrong.
pub fn parse(name: &str, bytes: &[u8]) -> Result<SolidForms, IoError> {
    let forms: SolidForms = serde_json::from_slice(bytes).map_err(|error| {
        let place = format!("line {}, column {}", error.line(), error.column());
        let reason = error.to_string();
        let reason = reason.split(" at line ").next().unwrap_or_default().to_owned();
        IoError::content(name, &place, format!("{reason}: write {{\"edges\": [[a, b, value], ..]}} in JSON"))
    })?;
    if forms.is_empty() {
        let problem = "holds no form: give it \"vertices\", \"edges\", \"triangles\" or \"cells\"";
        return Err(IoError::content(name, "file", problem));
    }
    Ok(forms)
}
