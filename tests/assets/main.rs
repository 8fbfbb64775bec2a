//! Assets through Formwork and out again: USD, glTF, OBJ and JSON, checked by the programs that people use.

#[path = "../common/mod.rs"]
mod common;

mod batch;
mod blender;
mod damaged;
mod gltf;
mod round_trips;
mod usd_read;
mod usd_write;

use formwork::hierarchy::Hierarchy;
use formwork::io::fields::Fields;
use formwork::io::{Asset, LoadOptions};
use formwork::scheme::Scheme;
use formwork::topology::Mesh;
use std::path::Path;

/// Reads the only mesh of a file.
#[track_caller]
fn load(path: &Path) -> Asset {
    formwork::io::load(path, &LoadOptions::default()).unwrap()
}

/// Level 0, with OpenSubdiv's numbering.
fn level0(asset: &Asset) -> Mesh {
    Hierarchy::new(&asset.cage().unwrap(), Scheme::default(), 0).unwrap().level(0).mesh().clone()
}

/// The forms that a file carries itself.
#[track_caller]
fn fields(asset: &Asset) -> Fields {
    asset.fields(&level0(asset)).unwrap()
}
