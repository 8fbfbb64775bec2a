use std::fs;
use std::path::{Path, PathBuf};

use super::{Asset, IoError, Surface, glb, json, npz, obj, usd};
use crate::osd::OsdScheme;

/// A file format of meshes. Every command reads and writes through [`load`] and [`save`], so a format that
/// is added here is known everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ, with OpenSubdiv's tags.
    Obj,
    /// A mesh with everything on it as one JSON object.
    Json,
    /// Binary glTF 2.0.
    Glb,
    /// glTF 2.0 as text, its numbers in a `.bin` file beside it.
    Gltf,
    /// Universal Scene Description as text; a `.usd` file that is read may be binary.
    Usda,
    /// The same, binary.
    Usdc,
    /// The same, packed.
    Usdz,
    /// Arrays for NumPy; written only.
    Npz,
}

/// Every extension, without its dot.
const EXTENSIONS: [(&str, Format); 9] = [
    ("obj", Format::Obj),
    ("json", Format::Json),
    ("glb", Format::Glb),
    ("gltf", Format::Gltf),
    ("usda", Format::Usda),
    ("usd", Format::Usda),
    ("usdc", Format::Usdc),
    ("usdz", Format::Usdz),
    ("npz", Format::Npz),
];

impl Format {
    /// The format that a file's extension names, in upper or lower case.
    pub fn of(path: &Path) -> Option<Format> {
        let extension = path.extension()?.to_str()?.to_lowercase();
        EXTENSIONS.iter().find(|(known, _)| *known == extension).map(|&(_, format)| format)
    }

    /// Whether [`save`] writes it. Not usdc and usdz: no crate writes a binary stage that Pixar's library
    /// opens.
    pub fn is_written(self) -> bool {
        !matches!(self, Format::Usdc | Format::Usdz)
    }

    /// Whether [`load`] reads it.
    pub fn is_read(self) -> bool {
        self != Format::Npz
    }

    /// Whether it is one of USD's: such files keep what else is on their stage, and have frames.
    pub fn is_usd(self) -> bool {
        matches!(self, Format::Usda | Format::Usdc | Format::Usdz)
    }
}

/// The extensions of the formats that `wanted` takes, for a message: `.obj, .json`.
fn extensions(wanted: impl Fn(Format) -> bool) -> String {
    let names: Vec<String> =
        EXTENSIONS.iter().filter(|(_, f)| wanted(*f)).map(|(name, _)| format!(".{name}")).collect();
    names.join(", ")
}

/// What to take from a file that holds more than one mesh, or moves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// The mesh: a prim path in USD, the name of a node or its number in glTF. Needed if there are
    /// several.
    pub prim: Option<String>,
    /// Which time samples to read.
    pub frames: Frames,
}

/// Which time samples of a moving mesh to read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Frames {
    /// None: the default value, or the first sample if there is no other.
    #[default]
    Rest,
    /// All time samples of the points.
    All,
    /// The time samples from the first to the second time, both included.
    Range(f64, f64),
    /// One time, between samples by linear interpolation.
    At(f64),
}

/// Reads a mesh from a file of any format that is read, by its extension.
///
/// # Errors
/// [`IoError::Format`] for an unknown extension; [`IoError::Read`]; what is wrong with the file, naming
/// the place in it; [`IoError::Content`] if `options` ask for what the file or its format does not have.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Asset, IoError> {
    let bytes = fs::read(path).map_err(IoError::read(path))?;
    let unreadable = || IoError::Format {
        path: path.to_owned(),
        use_: "read",
        choice: extensions(Format::is_read),
        hint: "",
    };
    let format = Format::of(path).ok_or_else(unreadable)?;
    let name = path.display().to_string();
    let refuse = |option: &str, what: &str| {
        Err(IoError::content(&name, option, format!("{what}: leave the option out")))
    };
    if options.prim.is_some() && matches!(format, Format::Obj | Format::Json) {
        return refuse("--prim", "a file of this format holds one mesh");
    }
    if options.frames != Frames::Rest && !format.is_usd() {
        return refuse("--frames", "only USD files have frames here");
    }
    match format {
        Format::Obj => obj::parse(&name, &bytes),
        Format::Json => json::parse(&name, &bytes),
        Format::Glb | Format::Gltf => glb::parse(path, &bytes, options),
        Format::Usda | Format::Usdc | Format::Usdz => usd::parse(&name, bytes, options),
        Format::Npz => Err(unreadable()),
    }
}

/// How to write.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SaveOptions {
    /// Also write the direction of the 1-form: `TANGENT` in glTF, for shaders, `primvars:combDir` in USD, for fur.
    pub tangents: bool,
}

/// What [`save`] did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Saved {
    /// The files written: some formats need a second one ([`companion`]).
    pub paths: Vec<PathBuf>,
    /// What had no place there, one sentence each.
    pub notes: Vec<String>,
}

/// Writes a surface to a file of any format that is written, by its extension.
///
/// # Errors
/// [`IoError::Format`] for an extension that is not written, [`IoError::Write`], or
/// [`IoError::FormatLimit`] if the format cannot hold the surface. No file is then left half written.
pub fn save(path: &Path, surface: &Surface, options: SaveOptions) -> Result<Saved, IoError> {
    let mut saved = Saved { paths: vec![path.to_owned()], notes: Vec::new() };
    let format = writer(path)?;
    match format {
        Format::Obj => saved.paths = obj::write(path, surface)?,
        Format::Json => json::write(path, surface)?,
        Format::Gltf => saved.paths = glb::write_text(path, surface, options)?,
        Format::Glb => glb::write(path, surface, options)?,
        Format::Npz => npz::write_surface(path, surface)?,
        Format::Usda | Format::Usdc | Format::Usdz => saved.notes = usd::write(path, surface, options)?,
    }
    if !format.is_usd() && surface.frames().len() > 1 {
        saved.notes.push(format!("only the first of {} frames: write .usda for all", surface.frames().len()));
    }
    if let (Format::Obj, Some(cage)) = (format, surface.cage()) {
        let assumed = match cage.face_sizes.iter().all(|&n| n == 3) {
            true => OsdScheme::Loop,
            false => OsdScheme::Catmark,
        };
        let scheme = surface.asset().and_then(|asset| asset.scheme);
        if let Some(scheme) = scheme.filter(|&scheme| scheme != assumed) {
            saved
                .notes
                .push(format!("OBJ does not say that the scheme is {scheme:?}: name it with --scheme"));
        }
    }
    Ok(saved)
}

/// The format that a file will be written in.
///
/// # Errors
/// [`IoError::Format`] for an extension that is not written.
pub fn writer(path: &Path) -> Result<Format, IoError> {
    let format = Format::of(path);
    match format {
        Some(format) if format.is_written() => Ok(format),
        _ => Err(IoError::Format {
            path: path.to_owned(),
            use_: "written",
            choice: extensions(Format::is_written),
            hint: match format {
                Some(format) if format.is_usd() => " (usdcat turns .usda into it)",
                _ => "",
            },
        }),
    }
}

/// The second file that [`save`] writes beside `path`: the forms of an OBJ, if there are `forms`, the
/// numbers of a `.gltf`.
pub fn companion(path: &Path, forms: bool) -> Option<PathBuf> {
    match Format::of(path)? {
        Format::Obj => forms.then(|| obj::fields_path(path)),
        Format::Gltf => Some(glb::buffer_path(path)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_known_by_their_extensions() {
        assert_eq!(Format::of("a/b.OBJ".as_ref()), Some(Format::Obj));
        assert_eq!(Format::of("b.usd".as_ref()), Some(Format::Usda));
        assert_eq!(Format::of("b.stl".as_ref()), None);
        let message = writer("b.usdc".as_ref()).unwrap_err().to_string();
        assert!(message.contains("b.usdc: ") && message.contains("usdcat"), "{message}");
    }
}
