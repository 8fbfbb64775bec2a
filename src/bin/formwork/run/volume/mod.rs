//! `formwork volume`: solids.

mod inspect;
mod slice;
mod subdivide;
mod validate;

use std::path::Path;

use formwork::io::volume::{self, forms};
use formwork::octet::{Solid, SolidFields};

use super::Outcome;
use crate::Failure;
use crate::args::volume::VolumeCommand;

pub fn run(command: &VolumeCommand) -> Result<Outcome, Failure> {
    match command {
        VolumeCommand::Inspect(args) => inspect::run(args),
        VolumeCommand::Subdivide(args) => subdivide::run(args),
        VolumeCommand::Validate(args) => validate::run(args),
        VolumeCommand::Slice(args) => slice::run(args),
    }
}

/// Reads and checks a solid.
fn load(path: &Path) -> Result<Solid, Failure> {
    let grid = volume::load(path)?;
    Solid::from_grid(grid).map_err(|error| format!("{}: {error} (numbers start at 0)", path.display()).into())
}

/// The forms of a fields file, else those that the mesh brings along.
fn fields(solid: &mut Solid, mesh: &Path, file: Option<&Path>) -> Result<SolidFields, Failure> {
    let (name, forms) = match file {
        None => (mesh, solid.forms.clone()),
        Some(path) => {
            if !solid.forms.is_empty() {
                let note = format!("{} takes the place of the forms in {}", path.display(), mesh.display());
                solid.notes.push(note);
            }
            (path, forms::read(path)?)
        }
    };
    solid.fields(&forms).map_err(|error| format!("{}: {error} (numbers start at 0)", name.display()).into())
}

/// The work of levels 0 to `level`: each has about seven times the cells of the one before.
fn work(level: usize) -> u64 {
    (7u64.pow(level as u32 + 1) - 1) / 6
}
