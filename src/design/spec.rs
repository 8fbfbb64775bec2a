use nalgebra::Vector3;

use crate::limit::SurfacePoint;

/// Where a feature is: on a cell of the cage, or at a point of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// A vertex (sources) or a face (vortices) of the cage, by number.
    Cell(u32),
    /// A point. What it gets is shared by the cells whose forms do not vanish there, in their proportion.
    At(SurfacePoint),
}

/// A source, or a sink. In the metric of the limit surface its divergence is the limit function of the vertex, scaled to the
/// strength: smooth, and as narrow as the cage allows. On the control mesh all of it is at the vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// Where.
    pub place: Place,
    /// How much flows out, negative for a sink: the integral of the divergence, in units of the form's values.
    pub strength: f64,
}

/// A vortex. Its curl is the limit 2-form of the face, scaled to the strength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vortex {
    /// Where.
    pub place: Place,
    /// Its circulation, counter-clockwise positive: the integral of the curl.
    pub strength: f64,
}

/// A prescribed circulation along an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeValue {
    /// The ends of the edge, in the direction in which the value counts.
    pub vertices: [u32; 2],
    /// The circulation: in the metric of the limit surface, of the limit field along the limit edge; on the control
    /// mesh, of the cochain.
    pub value: f64,
    /// How dearly the value is held, against 1 for the field's energy; `None` holds it exactly.
    pub weight: Option<f64>,
}

/// A prescribed vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VectorAt {
    /// Where.
    pub point: SurfacePoint,
    /// The vector; its part along the surface counts.
    pub vector: Vector3<f64>,
    /// How dearly it is held, see [`EdgeValue::weight`].
    pub weight: Option<f64>,
}

/// Faces where what prescribed values add to the field costs more than elsewhere, or less.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Faces of the cage.
    pub faces: Vec<u32>,
    /// The factor of the energy, 1 elsewhere. The last region that names a face counts.
    pub weight: f64,
}

/// The features of a field.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spec {
    /// Sources and sinks; those of one place add up.
    pub sources: Vec<Source>,
    /// Vortices; those of one place add up.
    pub vortices: Vec<Vortex>,
    /// Prescribed values on edges.
    pub edges: Vec<EdgeValue>,
    /// Prescribed vectors.
    pub vectors: Vec<VectorAt>,
    /// Circulations round the cycles of generators, by number. Those that are not given are 0, or what suits the
    /// prescribed edges and vectors best, if there are any.
    pub harmonic: Vec<(usize, f64)>,
    /// Regions.
    pub regions: Vec<Region>,
    /// Whether an excess of sources or vortices is taken off evenly by area, where it is an error otherwise.
    pub balance: bool,
}
