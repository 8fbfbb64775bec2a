//! From arguments to a job: the cage loaded, mended and checked, options settled, outputs known to be
//! writable. Whatever can go wrong without computing goes wrong here.

use std::fs;
use std::path::{Path, PathBuf};

use formwork::hierarchy::Hierarchy;
use formwork::io::fields::{self, Fields};
use formwork::io::{self, Asset, Format, Frames, LoadOptions, atomic::Draft};
use formwork::scheme::Scheme;
use formwork::topology::{Cage, CollapseReport, Element};

use crate::Failure;
use crate::args::{Common, SchemeName};

/// A checked cage with everything that decides how it is refined.
pub struct Job {
    /// The file's cage, after `--collapse` and with the options of the command line.
    pub asset: Asset,
    /// The same, checked.
    pub cage: Cage,
    pub scheme: Scheme,
    pub collapse: CollapseReport,
    /// Whether to draw a progress bar if stderr is a terminal.
    pub progress: bool,
}

impl Job {
    /// Loads and checks the cage.
    pub fn settle(common: &Common) -> Result<Self, Failure> {
        Self::settle_for(common, Frames::Rest, None)
    }

    /// [`Job::settle`], with time samples, for a mesh to be written in a format. A mesh from a USD stage
    /// stays in its place there if it goes to USD, and is taken out of it if not.
    pub fn settle_for(common: &Common, frames: Frames, target: Option<Format>) -> Result<Self, Failure> {
        let mut asset = io::load(&common.mesh, &LoadOptions { prim: common.prim.clone(), frames })?;
        if let Some(format) = target.filter(|format| !format.is_usd()) {
            asset.bake(format);
        }
        asset.descriptor.left_handed |= common.left_handed;
        asset.scheme = common.scheme.map_or(asset.scheme, SchemeName::opensubdiv);
        if let Some(boundary) = common.boundary {
            asset.descriptor.boundary = boundary;
        }
        if let Some(creasing) = common.creasing {
            asset.descriptor.creasing = creasing;
        }
        if let Some(triangles) = common.triangles {
            asset.descriptor.triangles = triangles;
        }
        let collapse = match common.collapse {
            true => asset.collapse(),
            false => CollapseReport::default(),
        };
        let cage = asset.cage()?;
        asset.notes.extend(collapse_note(&collapse));
        let scheme = common.scheme(asset.scheme, &cage.descriptor().face_sizes);
        if let Err(error) = scheme.split(&cage.descriptor().face_sizes) {
            let line = asset.source.line(Element::Face(error.face()));
            let place = line.map_or(String::new(), |line| format!("line {line}: "));
            return Err(format!("{}: {place}{error} (numbers start at 0)", asset.label()).into());
        }
        let progress = !common.quiet && !common.json;
        Ok(Job { asset, cage, scheme, collapse, progress })
    }

    /// The forms on the cage: those of a fields file, else those that the mesh brings along.
    pub fn fields(&mut self, file: Option<&Path>) -> Result<Fields, Failure> {
        if file.is_none() && self.asset.forms.is_empty() {
            return Ok(Fields::default());
        }
        // The cage alone is quick to build, and a mistake in the field is then known at once.
        let cage = Hierarchy::new(&self.cage, self.scheme, 0)?;
        let mesh = cage.level(0).mesh();
        match file {
            None => Ok(self.asset.fields(mesh)?),
            Some(path) => {
                if !self.asset.forms.is_empty() {
                    let note =
                        format!("{} takes the place of the forms in {}", path.display(), self.asset.label());
                    self.asset.notes.push(note);
                }
                Ok(fields::read(path, mesh)?)
            }
        }
    }
}

fn collapse_note(report: &CollapseReport) -> Option<String> {
    if report.is_empty() {
        return None;
    }
    let mut note = format!("collapsed: {} lost repeated vertices", faces(report.reduced.len()));
    if !report.removed.is_empty() {
        note += &format!(
            " and {} with fewer than three left went; the faces after face {} have lower numbers",
            faces(report.removed.len()),
            report.removed[0]
        );
    }
    Some(note)
}

fn faces(count: usize) -> String {
    if count == 1 { "1 face".to_owned() } else { format!("{count} faces") }
}

/// The extension of an output file, one of `supported` (lower case, without the dot).
pub fn format_of(path: &Path, supported: &[&'static str]) -> Result<&'static str, Failure> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let known = supported.iter().find(|&&known| extension.as_deref() == Some(known));
    let names: Vec<String> = supported.iter().map(|known| format!(".{known}")).collect();
    known.copied().ok_or_else(|| {
        let problem = match extension {
            None => "has no extension".to_owned(),
            Some(extension) => format!("has the extension .{extension}, which is not written here"),
        };
        format!("{}: {problem}: choose {}", path.display(), names.join(", ")).into()
    })
}

/// Makes sure that every output can be written and none is an input, before any work is done.
pub fn check_outputs(inputs: &[&Path], outputs: &[PathBuf]) -> Result<(), Failure> {
    for output in outputs {
        // The same file may be spelled in many ways.
        let same = |input: &&&Path| {
            **input == output
                || fs::canonicalize(input).is_ok_and(|a| fs::canonicalize(output).is_ok_and(|b| a == b))
        };
        if let Some(input) = inputs.iter().find(same) {
            return Err(format!(
                "{}: the output would replace the input {}: choose another name",
                output.display(),
                input.display()
            )
            .into());
        }
        drop(Draft::open(output)?);
    }
    Ok(())
}
