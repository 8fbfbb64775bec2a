//! Specs as JSON.

use std::fs;
use std::path::Path;

use nalgebra::Vector3;
use serde::Deserialize;

use super::{Condition, EdgeValue, Place, Region, Source, Spec, VectorAt, Vortex};
use crate::io::IoError;
use crate::limit::SurfacePoint;

/// What is wrong with a spec file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum SpecError {
    #[error(transparent)]
    Read(#[from] IoError),
    #[error(
        "{file}: line {line}, column {column}: {reason}: see formwork design --help for what a spec holds"
    )]
    Syntax { file: String, line: usize, column: usize, reason: String },
    #[error("{file}: {list}[{number}]: {reason}")]
    Entry { file: String, list: &'static str, number: usize, reason: &'static str },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    sources: Vec<FeatureEntry>,
    #[serde(default)]
    vortices: Vec<FeatureEntry>,
    #[serde(default)]
    edges: Vec<EdgeEntry>,
    #[serde(default)]
    vectors: Vec<VectorEntry>,
    #[serde(default)]
    boundary: Vec<BoundaryEntry>,
    #[serde(default)]
    harmonic: Vec<HarmonicEntry>,
    #[serde(default)]
    regions: Vec<RegionEntry>,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "a point is [face, s, t] or [face, corner, s, t]")]
enum At {
    Short(u32, f64, f64),
    Long(u32, u32, f64, f64),
}

impl From<&At> for SurfacePoint {
    fn from(at: &At) -> Self {
        match *at {
            At::Short(face, s, t) => SurfacePoint { face, corner: 0, s, t },
            At::Long(face, corner, s, t) => SurfacePoint { face, corner, s, t },
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FeatureEntry {
    vertex: Option<u32>,
    face: Option<u32>,
    at: Option<At>,
    strength: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EdgeEntry {
    vertices: [u32; 2],
    value: f64,
    weight: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct VectorEntry {
    at: At,
    vector: [f64; 3],
    weight: Option<f64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum BoundaryEntry {
    Tangential,
    Normal,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HarmonicEntry {
    generator: usize,
    circulation: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RegionEntry {
    faces: Vec<u32>,
    weight: f64,
}

impl Spec {
    /// Reads a spec and the conditions at boundary loops from a file, see [`Spec::parse`].
    ///
    /// # Errors
    /// [`SpecError`].
    pub fn read(path: &Path) -> Result<(Spec, Vec<Condition>), SpecError> {
        let bytes = fs::read(path).map_err(IoError::read(path))?;
        Self::parse(&path.display().to_string(), &bytes)
    }

    /// Reads a spec and the conditions at boundary loops from the contents of a file; `name` is used in messages. All
    /// keys are optional, indices start at 0:
    ///
    /// ```json
    /// {"sources": [{"vertex": 3, "strength": 1}, {"at": [7, 0.5, 0.5], "strength": -1}],
    ///  "vortices": [{"face": 2, "strength": 1}, {"at": [4, 0, 0.1, 0.2], "strength": -1}],
    ///  "edges": [{"vertices": [0, 1], "value": 0.5, "weight": 10}],
    ///  "vectors": [{"at": [7, 0.5, 0.5], "vector": [1, 0, 0]}],
    ///  "boundary": ["tangential", "normal"],
    ///  "harmonic": [{"generator": 0, "circulation": 1}],
    ///  "regions": [{"faces": [0, 1], "weight": 5}]}
    /// ```
    ///
    /// # Errors
    /// [`SpecError::Syntax`], [`SpecError::Entry`].
    pub fn parse(name: &str, bytes: &[u8]) -> Result<(Spec, Vec<Condition>), SpecError> {
        let file: File = serde_json::from_slice(bytes).map_err(|error| {
            let message = error.to_string();
            let place = format!(" at line {} column {}", error.line(), error.column());
            let reason = message.strip_suffix(&place).unwrap_or(&message).to_owned();
            SpecError::Syntax { file: name.to_owned(), line: error.line(), column: error.column(), reason }
        })?;
        let place = |list, number, entry: &FeatureEntry| {
            let reason = match (list, entry.vertex, entry.face, &entry.at) {
                ("sources", Some(cell), None, None) | ("vortices", None, Some(cell), None) => {
                    return Ok(Place::Cell(cell));
                }
                (_, None, None, Some(at)) => return Ok(Place::At(at.into())),
                ("sources", ..) => "a source is at a \"vertex\" or \"at\" a point: name one of them",
                _ => "a vortex is at a \"face\" or \"at\" a point: name one of them",
            };
            Err(SpecError::Entry { file: name.to_owned(), list, number, reason })
        };
        let source = |(i, entry)| Ok(Source { place: place("sources", i, entry)?, strength: entry.strength });
        let vortex =
            |(i, entry)| Ok(Vortex { place: place("vortices", i, entry)?, strength: entry.strength });
        let edge = |entry: &EdgeEntry| EdgeValue {
            vertices: entry.vertices,
            value: entry.value,
            weight: entry.weight,
        };
        let vector = |entry: &VectorEntry| VectorAt {
            point: (&entry.at).into(),
            vector: Vector3::from(entry.vector),
            weight: entry.weight,
        };
        let spec = Spec {
            sources: file.sources.iter().enumerate().map(source).collect::<Result<_, SpecError>>()?,
            vortices: file.vortices.iter().enumerate().map(vortex).collect::<Result<_, SpecError>>()?,
            edges: file.edges.iter().map(edge).collect(),
            vectors: file.vectors.iter().map(vector).collect(),
            harmonic: file.harmonic.iter().map(|entry| (entry.generator, entry.circulation)).collect(),
            regions: file.regions.into_iter().map(|r| Region { faces: r.faces, weight: r.weight }).collect(),
            balance: false,
        };
        let condition = |entry: &BoundaryEntry| match entry {
            BoundaryEntry::Tangential => Condition::Tangential,
            BoundaryEntry::Normal => Condition::Normal,
        };
        Ok((spec, file.boundary.iter().map(condition).collect()))
    }
}
