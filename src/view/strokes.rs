use nalgebra::Vector3;

use crate::cochain::Cochain;
use crate::design::{Streamline, Tracing, seeds, streamlines};
use crate::io::Positions;
use crate::limit::{LimitSurface, SurfacePoint, SurfaceVector};

/// A line along the field, with what is needed to let something drift on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Its points on the limit surface, in the direction of the field.
    pub points: Vec<Vector3<f64>>,
    /// The length of the field's vector at each.
    pub speeds: Vec<f64>,
    /// When something carried by the field from the first point passes each, in units of length by value of the form.
    pub times: Vec<f64>,
}

/// A tangent vector of the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrow {
    /// Where.
    pub position: Vector3<f64>,
    /// The vector.
    pub vector: Vector3<f64>,
    /// The unit normal.
    pub normal: Vector3<f64>,
}

/// Where the field is slower than this part of a fast one, time does not stand still: pictures would too.
const SLOW: f64 = 0.04;

/// The field of a 1-form on its limit surface.
pub(super) struct Field<'a> {
    surface: &'a LimitSurface,
    positions: &'a Positions,
    form: &'a Cochain<1>,
    /// The same on the surface's own level.
    refined: (Positions, Cochain<1>),
}

impl<'a> Field<'a> {
    pub fn new(surface: &'a LimitSurface, positions: &'a Positions, form: &'a Cochain<1>) -> Self {
        Field { surface, positions, form, refined: (surface.refine(positions), surface.refine(form)) }
    }

    fn evaluate(&self, points: &[SurfacePoint]) -> Vec<SurfaceVector> {
        let found = self.surface.evaluate_vectors(&self.refined.0, &self.refined.1, points);
        found.expect("seeds and lines are on the surface")
    }

    /// Lines through points spread over the surface. Where the field vanishes there are none.
    pub fn strokes(&self, count: usize, length: f64, step: f64) -> Vec<Stroke> {
        let starts = seeds(self.surface, self.positions, count);
        let tracing = Tracing { step, length, both_ways: true, least: 1e-4 };
        let lines = streamlines(self.surface, self.positions, self.form, &starts, &tracing);
        let lines = lines.expect("seeds are on the surface");
        let points: Vec<SurfacePoint> = lines.iter().flat_map(|line| &line.points).copied().collect();
        let speeds = self.evaluate(&points).into_iter().map(|sample| sample.vector.norm());
        let speeds: Vec<f64> = speeds.map(|speed| if speed.is_finite() { speed } else { 0.0 }).collect();
        let mut sorted = speeds.clone();
        sorted.sort_by(f64::total_cmp);
        let fast = sorted.get(sorted.len() * 95 / 100).copied().unwrap_or(0.0);
        let mut rest = &speeds[..];
        let stroke = |line: Streamline| {
            let (own, others) = rest.split_at(line.positions.len());
            rest = others;
            let mut times = vec![0.0];
            for (ends, speed) in line.positions.windows(2).zip(own.windows(2)) {
                let speed = ((speed[0] + speed[1]) / 2.0).max(SLOW * fast);
                times.push(times[times.len() - 1] + (ends[1] - ends[0]).norm() / speed);
            }
            Stroke { points: line.positions, speeds: own.to_vec(), times }
        };
        lines.into_iter().map(stroke).filter(|stroke| stroke.points.len() > 2).collect()
    }

    /// Vectors at points spread over the surface.
    pub fn arrows(&self, count: usize) -> Vec<Arrow> {
        let found = self.evaluate(&seeds(self.surface, self.positions, count));
        let arrow = |sample: SurfaceVector| {
            let [a, b] = sample.position.derivatives;
            let normal = a.cross(&b).try_normalize(0.0)?;
            let arrow = Arrow { position: sample.position.value, vector: sample.vector, normal };
            (arrow.vector.iter().chain(&normal).all(|x| x.is_finite()) && arrow.vector.norm() > 0.0)
                .then_some(arrow)
        };
        found.into_iter().filter_map(arrow).collect()
    }
}
