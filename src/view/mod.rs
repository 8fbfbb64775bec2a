//! To look at: a surface with its forms, as a page for a browser and as a picture.
//!
//! A [`View`] is everything that is shown, computed once: levels whose vertices lie on the limit surface, with exact
//! normals, one for each side of a crease; the forms of degree 0, 1 and 2 at these vertices; strokes and arrows along
//! the field of the 1-form, traced on the limit surface; its zeros; the control cage and its creases.
//! [`View::page`] writes it as one page that asks for nothing outside itself; [`View::picture`] paints it here.
//!
//! Of the three degrees only one need be given. A missing 1-form is the gradient of the 0-form, a missing 0-form the
//! potential of the 1-form's exact part, a missing 2-form the curl of the 1-form.
//!
//! Everything is in the coordinates of the positions, turned so that up is `z`.

mod camera;
mod colour;
mod level;
mod page;
mod picture;
mod raster;
mod strokes;

pub use colour::Ramp;
pub use level::{Level, Vertex};
pub use picture::{Picture, PictureError};
pub use strokes::{Arrow, Stroke};

use nalgebra::Vector3;

use crate::cochain::Cochain;
use crate::design::{DesignError, Hodge, Metric, Singularity, singularities};
use crate::hierarchy::{Hierarchy, HierarchyError};
use crate::io::Positions;
use crate::io::fields::Fields;
use crate::limit::{LimitSurface, SurfaceError};
use crate::scheme::Scheme;
use crate::topology::{Cage, HalfEdge};

/// Which axis of the positions points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// As in glTF.
    Y,
    /// As on paper.
    #[default]
    Z,
}

/// What is drawn on the surface: in a picture, and on a page until somebody switches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layers {
    /// Lines along the field.
    pub strokes: bool,
    /// Its vectors.
    pub arrows: bool,
    /// The edges of the control cage.
    pub cage: bool,
    /// Sharp edges.
    pub creases: bool,
    /// The zeros of the field.
    pub zeros: bool,
    /// The edges of the level (on the page only).
    pub mesh: bool,
}

impl Layers {
    /// Nothing.
    pub const NONE: Layers =
        Layers { strokes: false, arrows: false, cage: false, creases: false, zeros: false, mesh: false };
}

impl Default for Layers {
    fn default() -> Self {
        Layers { strokes: true, cage: true, creases: true, zeros: true, ..Layers::NONE }
    }
}

/// What is made ready to be shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The finest level.
    pub levels: usize,
    /// How many strokes.
    pub lines: usize,
    /// The length of a stroke on either side of its seed, in diagonals of the box round the cage.
    pub length: f64,
    /// How many arrows.
    pub arrows: usize,
    /// Where up is.
    pub up: Up,
    /// The degree that is shown first; the 1-form, or else the first that is there.
    pub degree: Option<usize>,
    /// What is shown with it.
    pub layers: Layers,
    /// The potential of the 1-form's exact part, from those who have it already.
    pub potential: Option<Cochain<0>>,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            levels: 3,
            lines: 1400,
            length: 0.09,
            arrows: 260,
            up: Up::Z,
            degree: None,
            layers: Layers::default(),
            potential: None,
        }
    }
}

/// A form that is shown as colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// What it is, for people: `0-form`, `curl of the 1-form`.
    pub name: &'static str,
    /// The unit of its values.
    pub unit: &'static str,
    /// The least and the largest value at the vertices of all levels.
    pub range: [f64; 2],
    /// What the ends of the colour scale stand for. Values beyond have the colours of the ends: a few vertices
    /// near a singular point would leave the others one colour.
    pub scale: [f64; 2],
    /// The colours.
    pub ramp: Ramp,
}

/// A piece of a crease: its ends, and the sharpness of the cage's edge that it comes from.
pub type Crease = ([Vector3<f64>; 2], f32);

/// Everything that is shown of a surface.
#[derive(Clone, Debug)]
pub struct View {
    /// The levels, from the cage's own to the finest.
    pub levels: Vec<Level>,
    /// The 0-form, the length of the 1-form's tangent vector, the density of the 2-form.
    pub forms: [Option<Shown>; 3],
    /// The degree that is shown first.
    pub degree: Option<usize>,
    /// What is drawn with it.
    pub layers: Layers,
    /// The edges of the control cage.
    pub cage: Vec<[Vector3<f64>; 2]>,
    /// The creases on the limit surface, edge by edge of the finest level, with the sharpness of the cage's edge.
    pub creases: Vec<Crease>,
    /// Lines along the field.
    pub strokes: Vec<Stroke>,
    /// Tangent vectors of the field.
    pub arrows: Vec<Arrow>,
    /// The zeros of the field.
    pub zeros: Vec<Singularity>,
    /// The corners of the box round the finest level and the cage.
    pub bounds: [Vector3<f64>; 2],
    /// What could not be shown and why, one sentence each.
    pub notes: Vec<String>,
}

/// Why a surface cannot be shown.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum ViewError {
    #[error(transparent)]
    Hierarchy(#[from] HierarchyError),
    #[error("there is no {degree}-form to show: give one, or choose another degree")]
    NoForm { degree: usize },
    #[error("no face can be shown: all are holes")]
    NoFaces,
    #[error("a position or a value is not finite at level {level}: correct the mesh or the forms")]
    NotFinite { level: usize },
}

impl View {
    /// Refines a cage and its forms, and traces the field.
    ///
    /// What is not there on every surface (a field's zeros on surfaces that are not manifolds) is left out, and a note
    /// says so.
    ///
    /// # Errors
    /// If the cage cannot be refined that far, nothing can be drawn, or the degree asked for is not there.
    ///
    /// # Panics
    /// If the positions or the forms do not belong to the cage.
    pub fn new(
        cage: &Cage,
        scheme: Scheme,
        positions: &Positions,
        fields: &Fields,
        options: &Options,
    ) -> Result<View, ViewError> {
        let positions = match options.up {
            Up::Z => positions.clone(),
            Up::Y => {
                let turned = |p: &Vector3<f64>| Vector3::new(p.x, -p.z, p.y);
                Cochain::new(positions.values().iter().map(turned).collect())
            }
        };
        let mut notes = Vec::new();
        let hierarchy = Hierarchy::new(cage, scheme, options.levels)?;
        let mesh = hierarchy.level(0).mesh();

        let mut fields = fields.clone();
        let given = [fields.form0.is_some(), fields.form1.is_some(), fields.form2.is_some()];
        if fields.form1.is_none() {
            fields.form1 = fields.form0.as_ref().map(|form| form.exterior_derivative(mesh));
        }
        if fields.form2.is_none() {
            fields.form2 = fields.form1.as_ref().map(|form| form.exterior_derivative(mesh));
        }
        let surface = match &fields.form1 {
            None => None,
            Some(_) => LimitSurface::new(cage, scheme)
                .map_err(|error: SurfaceError| notes.push(format!("no strokes and no arrows: {error}")))
                .ok(),
        };
        if let (None, Some(form)) = (&fields.form0, &fields.form1) {
            fields.form0 = match (&options.potential, &surface) {
                (Some(potential), _) => Some(potential.clone()),
                (None, None) => None,
                (None, Some(surface)) => potential(surface, &positions, form)
                    .map_err(|error| notes.push(format!("no potential of the 1-form: {error}")))
                    .ok(),
            };
        }
        let there = [fields.form0.is_some(), fields.form1.is_some(), fields.form2.is_some()];
        let degree = match options.degree {
            Some(degree) if !there.get(degree).copied().unwrap_or(false) => {
                return Err(ViewError::NoForm { degree });
            }
            Some(degree) => Some(degree),
            None => [1, 0, 2].into_iter().find(|&degree| there[degree]),
        };

        let levels = level::levels(&hierarchy, &positions, &fields)?;
        let forms = [0, 1, 2].map(|degree| there[degree].then(|| shown(degree, &given, &levels)));
        let mut view = View {
            forms,
            degree,
            layers: options.layers,
            cage: mesh.edges().iter().map(|ends| ends.map(|v| positions[v as usize])).collect(),
            creases: creases(&hierarchy, &positions)?,
            strokes: Vec::new(),
            arrows: Vec::new(),
            zeros: Vec::new(),
            bounds: bounds(&levels, &positions),
            levels,
            notes,
        };
        if let (Some(surface), Some(form)) = (&surface, &fields.form1) {
            let size = view.size();
            let field = strokes::Field::new(surface, &positions, form);
            view.strokes = field.strokes(options.lines, options.length * size, 0.005 * size);
            view.arrows = field.arrows(options.arrows);
            match singularities(surface, &positions, form, ZERO_LEVELS) {
                Ok(found) => view.zeros = found.zeros,
                Err(error) => view.notes.push(format!("zeros of the field are not shown: {error}")),
            }
        }
        Ok(view)
    }

    /// The finest level.
    pub fn finest(&self) -> &Level {
        &self.levels[self.levels.len() - 1]
    }

    /// The diagonal of the box.
    pub fn size(&self) -> f64 {
        let diagonal = (self.bounds[1] - self.bounds[0]).norm();
        if diagonal > 0.0 { diagonal } else { 1.0 }
    }
}

/// How often the cage is refined to tell zeros apart.
const ZERO_LEVELS: usize = 3;

/// The potential of the exact part of a 1-form.
fn potential(
    surface: &LimitSurface,
    positions: &Positions,
    form: &Cochain<1>,
) -> Result<Cochain<0>, DesignError> {
    Ok(Hodge::new(surface, positions, Metric::Limit, &[])?.decompose(form).potential)
}

/// What is said of a form, and the scale of its colours.
fn shown(degree: usize, given: &[bool; 3], levels: &[Level]) -> Shown {
    let values = || levels.iter().flat_map(|level| &level.vertices).map(|vertex| vertex.values[degree]);
    let range = values().fold([f64::MAX, f64::MIN], |[low, high], x| [low.min(x), high.max(x)]);
    let finest = levels.last().map(|level| &level.vertices[..]).unwrap_or_default();
    let mut lengths: Vec<f64> = finest.iter().map(|vertex| vertex.values[degree].abs()).collect();
    lengths.sort_by(f64::total_cmp);
    let large = lengths.get(lengths.len().saturating_sub(1) * 98 / 100).copied().unwrap_or(0.0);
    // A form that is 0 has a scale too; what is left of one by rounding is 0.
    let largest = levels.iter().flat_map(|level| &level.vertices).flat_map(|vertex| vertex.values);
    let noise = 1e-12 * largest.fold(0.0, |a: f64, b| a.max(b.abs()));
    let (large, range) = if large > noise || degree == 0 { (large, range) } else { (1.0, [0.0; 2]) };
    let (name, unit, scale, ramp) = match degree {
        0 if given[0] => ("0-form", "", range, Ramp::Height),
        0 => ("potential of the exact part", "", range, Ramp::Height),
        1 if given[1] => ("length of the 1-form", "per unit of length", [0.0, large], Ramp::Speed),
        1 => ("gradient of the 0-form", "per unit of length", [0.0, large], Ramp::Speed),
        _ if given[2] => ("2-form", "per unit of area", [-large, large], Ramp::Signed),
        _ => ("curl of the 1-form", "per unit of area", [-large, large], Ramp::Signed),
    };
    let scale = if scale[1] - scale[0] > noise { scale } else { [scale[0] - 0.5, scale[0] + 0.5] };
    Shown { name, unit, range, scale, ramp }
}

/// The descendants of the cage's sharp edges on the finest level, in the limit.
fn creases(hierarchy: &Hierarchy, positions: &Positions) -> Result<Vec<Crease>, HierarchyError> {
    let cage = hierarchy.level(0).mesh();
    let sharpness = (0..).zip(hierarchy.level(0).tags().edge_sharpness.iter().copied());
    let is_crease = |&(e, sharpness): &(u32, f32)| sharpness > 0.0 && !cage.is_boundary_edge(e);
    let mut creases: Vec<(u32, f32)> = sharpness.filter(is_crease).collect();
    for level in 1..=hierarchy.num_levels() {
        let split = hierarchy.refinement(level).split();
        let halves = |e| [true, false].map(|along| split.even_edge(HalfEdge::new(e, along)));
        creases = creases.into_iter().flat_map(|(e, s)| halves(e).map(|half| (half, s))).collect();
    }
    let mesh = hierarchy.finest().mesh();
    let limit = crate::limit::Limit::new(hierarchy, hierarchy.num_levels())?;
    let points = limit.apply(mesh, &hierarchy.subdivide(positions));
    Ok(creases.into_iter().map(|(e, s)| (mesh.edges()[e as usize].map(|v| points[v as usize]), s)).collect())
}

fn bounds(levels: &[Level], positions: &Positions) -> [Vector3<f64>; 2] {
    let vertices = levels.iter().flat_map(|level| &level.vertices).map(|vertex| vertex.position);
    let all = vertices.chain(positions.values().iter().copied());
    let infinite = Vector3::repeat(f64::INFINITY);
    all.fold([infinite, -infinite], |[low, high], p| [low.inf(&p), high.sup(&p)])
}
