//! Solids in files: tetrahedra and pyramids with data on them.
//!
//! | module | reads | writes |
//! |---|---|---|
//! | [`msh`] | Gmsh, versions 2.2 and 4.1, text and binary | |
//! | [`vtu`] | VTK's unstructured grids | the same |
//! | [`forms`] | forms on a solid, as JSON | |

pub mod forms;
pub mod msh;
pub mod vtu;

use std::fs;
use std::path::Path;

use nalgebra::Vector3;

use super::IoError;

/// An unstructured grid: points, cells by kind, and named data.
///
/// Vertices of a pyramid: its base, counter-clockwise seen from the apex, then the apex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Grid {
    /// The points.
    pub points: Vec<Vector3<f64>>,
    /// Line segments.
    pub lines: Vec<[u32; 2]>,
    /// Triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Tetrahedra.
    pub tets: Vec<[u32; 4]>,
    /// Pyramids.
    pub pyramids: Vec<[u32; 5]>,
    /// Data with an entry for each point.
    pub point_data: Vec<Array>,
    /// Data with an entry for each cell: lines, triangles, tetrahedra, pyramids. NaN where there is none.
    pub cell_data: Vec<Array>,
    /// What was passed over, one sentence each.
    pub notes: Vec<String>,
}

/// Named data, `components` numbers an entry.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// The name.
    pub name: String,
    /// Numbers an entry.
    pub components: usize,
    /// The numbers, entry after entry.
    pub values: Vec<f64>,
}

impl Grid {
    /// The number of cells of every kind.
    pub fn num_cells(&self) -> usize {
        self.lines.len() + self.triangles.len() + self.tets.len() + self.pyramids.len()
    }
}

/// Reads a grid, by the extension of the file: `.msh` or `.vtu`.
///
/// # Errors
/// [`IoError::Format`] for another extension; [`IoError::Read`]; [`IoError::Content`] with the place that is wrong.
pub fn load(path: &Path) -> Result<Grid, IoError> {
    let extension = extension(path);
    let parse = match extension.as_str() {
        "msh" => msh::parse,
        "vtu" => vtu::parse,
        _ => return Err(unknown(path, "read", ".msh, .vtu")),
    };
    let bytes = fs::read(path).map_err(IoError::read(path))?;
    parse(&path.display().to_string(), bytes)
}

/// Writes a grid as `.vtu`.
///
/// # Errors
/// [`IoError::Format`] for another extension; [`IoError::Write`].
pub fn save(path: &Path, grid: Grid) -> Result<(), IoError> {
    check_writable(path)?;
    vtu::write(path, grid)
}

/// Whether [`save`] knows the extension.
///
/// # Errors
/// [`IoError::Format`] if not.
pub fn check_writable(path: &Path) -> Result<(), IoError> {
    if extension(path) == "vtu" { Ok(()) } else { Err(unknown(path, "written", ".vtu")) }
}

fn extension(path: &Path) -> String {
    path.extension().map_or(String::new(), |e| e.to_string_lossy().to_lowercase())
}

fn unknown(path: &Path, use_: &'static str, choice: &str) -> IoError {
    IoError::Format { path: path.to_owned(), use_, choice: choice.to_owned(), hint: " for a solid" }
}
