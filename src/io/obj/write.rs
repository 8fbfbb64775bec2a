use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::io::atomic::Draft;
use crate::io::{IoError, Surface, fields};
use crate::topology::{
    BoundaryInterpolation, Corner, Crease, CreasingMethod, Descriptor, TriangleSubdivision,
};

/// Writes a mesh: `v` and `f` lines, numbers that read back to the same bits; `vn` too if it lies on its limit,
/// the tags if it is a cage.
///
/// OBJ has no place for forms. If the surface has some, they go to a second file, [`fields_path`], with
/// the indices of the written mesh. Returns the paths written.
///
/// # Errors
/// [`IoError::Write`]; neither file is then left half written.
pub fn write(path: &Path, surface: &Surface) -> Result<Vec<PathBuf>, IoError> {
    let mut mesh = Draft::open(path)?;
    mesh.write(|out| {
        for x in surface.positions().values() {
            writeln!(out, "v {} {} {}", x.x, x.y, x.z)?;
        }
        for n in surface.at_vertices().map_or(&[][..], |at| &at.normals) {
            writeln!(out, "vn {} {} {}", n.x, n.y, n.z)?;
        }
        for face in surface.faces() {
            write!(out, "f")?;
            for &v in surface.mesh().face_vertices(face) {
                match surface.at_vertices() {
                    Some(_) => write!(out, " {0}//{0}", v + 1)?,
                    None => write!(out, " {}", v + 1)?,
                }
            }
            writeln!(out)?;
        }
        match surface.cage() {
            Some(cage) => write_tags(out, cage),
            None => Ok(()),
        }
    })?;
    if surface.fields().is_empty() {
        mesh.publish()?;
        return Ok(vec![path.to_owned()]);
    }
    let forms_path = fields_path(path);
    let mut forms = Draft::open(&forms_path)?;
    forms.write(|out| fields::write_to(out, surface))?;
    forms.publish()?;
    mesh.publish()?;
    Ok(vec![path.to_owned(), forms_path])
}

/// One line a tag; options that are what the reader takes for granted are not said.
fn write_tags(out: &mut impl Write, cage: &Descriptor) -> io::Result<()> {
    match cage.boundary {
        BoundaryInterpolation::None => writeln!(out, "t interpolateboundary 1/0/0 0")?,
        BoundaryInterpolation::EdgeAndCorner => writeln!(out, "t interpolateboundary 1/0/0 1")?,
        BoundaryInterpolation::EdgeOnly => {}
    }
    if cage.creasing == CreasingMethod::Chaikin {
        writeln!(out, "t creasemethod 0/0/1 chaikin")?;
    }
    if cage.triangles == TriangleSubdivision::Smooth {
        writeln!(out, "t smoothtriangles 0/0/1 smooth")?;
    }
    for Crease { vertices: [a, b], sharpness } in &cage.creases {
        writeln!(out, "t crease 2/1/0 {a} {b} {sharpness}")?;
    }
    for Corner { vertex, sharpness } in &cage.corners {
        writeln!(out, "t corner 1/1/0 {vertex} {sharpness}")?;
    }
    for hole in &cage.holes {
        writeln!(out, "t hole 1/0/0 {hole}")?;
    }
    Ok(())
}

/// Where [`write()`] puts the forms: `box.obj` -> `box.fields.json`.
pub fn fields_path(path: &Path) -> PathBuf {
    path.with_extension("fields.json")
}
