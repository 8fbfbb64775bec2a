//! A mesh with its forms as one JSON object.
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
//! | `tags` | of a cage: `scheme`, `boundary`, `creasing`, `triangles`, `creases` as `[[a, b, sharpness], ..]`, `corners` as `[[vertex, sharpness], ..]`, `holes` |
//!
//! Indices start at 0. Of refined meshes, faces that are holes are left out, and so are edges that have no
//! other face. Numbers read back to the same bits. The extras of a glTF file hold the same object, without
//! `positions` and `face_vectors`.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use nalgebra::Vector3;
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use super::{Asset, Form1, Forms, IoError, Surface, atomic};
use crate::cochain::Cochain;
use crate::osd::OsdScheme;
use crate::topology::{
    BoundaryInterpolation, Corner, Crease, CreasingMethod, Descriptor, TriangleSubdivision,
};

/// Writes a surface.
///
/// # Errors
/// [`IoError::Write`].
pub fn write(path: &Path, surface: &Surface) -> Result<(), IoError> {
    atomic::write(path, |out| {
        let mut object = Object::new(out);
        object.value("level", &surface.level())?;
        object.array("positions", surface.positions().values().iter().map(|&x| <[f64; 3]>::from(x)))?;
        write_mesh(&mut object, surface)?;
        if let Some(vectors) = surface.face_vectors() {
            object.array("face_vectors", surface.faces().map(|f| <[f64; 3]>::from(vectors[f as usize])))?;
        }
        if let Some(at) = surface.at_vertices() {
            let triples =
                |vectors: &[Vector3<f64>]| -> Vec<[f64; 3]> { vectors.iter().map(|&v| v.into()).collect() };
            object.array("normals", triples(&at.normals).into_iter())?;
            if let Some([vertices, corners]) = &at.vectors {
                object.array("vertex_vectors", triples(vertices).into_iter())?;
                let corners = triples(corners);
                let mesh = surface.mesh();
                let written = surface.faces().flat_map(|f| mesh.corners(f)).map(|c| corners[c as usize]);
                object.array("corner_vectors", written)?;
            }
        }
        object.close()
    })
}

/// The keys that say all but where the vertices are.
pub(super) fn write_mesh<W: Write>(object: &mut Object<W>, surface: &Surface) -> io::Result<()> {
    let (mesh, fields) = (surface.mesh(), surface.fields());
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
    match surface.cage() {
        Some(cage) => {
            let scheme = surface.asset().and_then(|asset| asset.scheme);
            object.value("tags", &Tags::of(cage, scheme))
        }
        None => Ok(()),
    }
}

/// Reads a mesh from a file.
///
/// # Errors
/// [`IoError::Read`], or as for [`parse`].
pub fn read(path: &Path) -> Result<Asset, IoError> {
    let bytes = fs::read(path).map_err(IoError::read(path))?;
    parse(&path.display().to_string(), &bytes)
}

/// Reads a mesh from the contents of a file; `name` is used in messages. A refined mesh is read as a cage
/// without tags.
///
/// # Errors
/// [`IoError::Content`], naming line and column where the JSON is not that of [`write()`].
pub fn parse(name: &str, bytes: &[u8]) -> Result<Asset, IoError> {
    let file: File = serde_json::from_slice(bytes).map_err(|error| {
        let place = format!("line {}, column {}", error.line(), error.column());
        IoError::content(
            name,
            &place,
            format!("{}: this is not a mesh as formwork writes it", reason(&error)),
        )
    })?;
    let positions = file.positions.as_deref().unwrap_or_default();
    let positions = Cochain::new(positions.iter().map(|&x| Vector3::from(x)).collect());
    let mut asset = file.into_asset().map_err(|problem| IoError::content(name, "mesh", problem))?;
    asset.descriptor.num_vertices = positions.len();
    (asset.name, asset.positions) = (name.to_owned(), positions);
    Ok(asset)
}

/// serde's message without the place at its end.
pub(super) fn reason(error: &serde_json::Error) -> String {
    let message = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    message.strip_suffix(&place).unwrap_or(&message).to_owned()
}

/// The object as it is read.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    #[serde(rename = "level")]
    _level: Option<IgnoredAny>,
    positions: Option<Vec<[f64; 3]>>,
    pub(super) face_sizes: Vec<u32>,
    pub(super) face_vertices: Vec<u32>,
    edges: Option<Vec<[u32; 2]>>,
    form0: Option<Vec<f64>>,
    form1: Option<Vec<f64>>,
    form2: Option<Vec<f64>>,
    #[serde(rename = "face_vectors")]
    _face_vectors: Option<IgnoredAny>,
    #[serde(rename = "normals")]
    _normals: Option<IgnoredAny>,
    #[serde(rename = "vertex_vectors")]
    _vertex_vectors: Option<IgnoredAny>,
    #[serde(rename = "corner_vectors")]
    _corner_vectors: Option<IgnoredAny>,
    pub(super) tags: Option<Tags>,
}

impl File {
    /// The asset, but for its positions and their number.
    pub(super) fn into_asset(self) -> Result<Asset, String> {
        let form1 = match (self.form1, self.edges) {
            (None, _) => None,
            (Some(values), Some(edges)) if edges.len() == values.len() => {
                Some(Form1::Edges(edges.into_iter().zip(values).collect()))
            }
            (Some(values), edges) => {
                let edges = edges.map_or(0, |edges| edges.len());
                return Err(format!(
                    "form1 has {} values for {edges} edges: give one for each",
                    values.len()
                ));
            }
        };
        let scheme = self.tags.as_ref().and_then(|tags| tags.scheme).map(Into::into);
        let mut descriptor = self.tags.map_or_else(Default::default, Tags::into_descriptor);
        descriptor.face_sizes = self.face_sizes;
        descriptor.face_vertices = self.face_vertices;
        let forms = Forms { form0: self.form0, form1, form2: self.form2 };
        Ok(Asset { descriptor, forms, scheme, ..Default::default() })
    }
}

/// The tags of a cage.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Tags {
    scheme: Option<SchemeName>,
    boundary: Boundary,
    creasing: Creasing,
    triangles: Triangles,
    creases: Vec<(u32, u32, f32)>,
    corners: Vec<(u32, f32)>,
    pub(super) holes: Vec<u32>,
}

/// Names for the values of an enum of another module.
macro_rules! names {
    ($name:ident for $of:ident { $($value:ident),+ }) => {
        #[derive(Clone, Copy, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        enum $name { $($value),+ }
        impl From<$of> for $name {
            fn from(value: $of) -> Self { match value { $($of::$value => $name::$value),+ } }
        }
        impl From<$name> for $of {
            fn from(value: $name) -> Self { match value { $($name::$value => $of::$value),+ } }
        }
    };
}

names!(Boundary for BoundaryInterpolation { None, EdgeOnly, EdgeAndCorner });
names!(Creasing for CreasingMethod { Uniform, Chaikin });
names!(SchemeName for OsdScheme { Catmark, Loop, Bilinear });
names!(Triangles for TriangleSubdivision { Catmark, Smooth });

impl Tags {
    fn of(cage: &Descriptor, scheme: Option<OsdScheme>) -> Self {
        Tags {
            scheme: scheme.map(Into::into),
            boundary: cage.boundary.into(),
            creasing: cage.creasing.into(),
            triangles: cage.triangles.into(),
            creases: cage.creases.iter().map(|c| (c.vertices[0], c.vertices[1], c.sharpness)).collect(),
            corners: cage.corners.iter().map(|c| (c.vertex, c.sharpness)).collect(),
            holes: cage.holes.clone(),
        }
    }

    fn into_descriptor(self) -> Descriptor {
        let crease = |(a, b, sharpness)| Crease { vertices: [a, b], sharpness };
        Descriptor {
            boundary: self.boundary.into(),
            creasing: self.creasing.into(),
            triangles: self.triangles.into(),
            creases: self.creases.into_iter().map(crease).collect(),
            corners: self
                .corners
                .into_iter()
                .map(|(vertex, sharpness)| Corner { vertex, sharpness })
                .collect(),
            holes: self.holes,
            ..Default::default()
        }
    }
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
