use nalgebra::{Matrix2, Vector2, Vector3};

use crate::cochain::Cochain;
use crate::field::first_fundamental_form;
use crate::limit::{LimitSurface, PiecePoint, Pieces, PointError, SurfacePoint};

/// How streamlines are traced. Lengths are in the units of the positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracing {
    /// The length of a step, at most.
    pub step: f64,
    /// The length of a line in each direction, at most.
    pub length: f64,
    /// Also against the field.
    pub both_ways: bool,
    /// Where the field is shorter than this part of its largest value at the seeds, a line ends.
    pub least: f64,
}

/// Why a line ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// It is as long as was asked for.
    Length,
    /// The field vanishes.
    Zero,
    /// The boundary of the surface.
    Boundary,
    /// It came back to where it began.
    Closed,
}

/// A line along the field.
#[derive(Clone, Debug, PartialEq)]
pub struct Streamline {
    /// Its points, in the direction of the field.
    pub points: Vec<SurfacePoint>,
    /// Their positions.
    pub positions: Vec<Vector3<f64>>,
    /// The place of the seed among them.
    pub seed: usize,
    /// Why it ends: backwards and forwards. Backwards is `Length` if nobody asked for it.
    pub ends: [End; 2],
}

/// A line under way.
struct Line {
    at: PiecePoint,
    sign: f64,
    points: Vec<SurfacePoint>,
    positions: Vec<Vector3<f64>>,
    length: f64,
    end: Option<End>,
    start: Option<(Vector3<f64>, Vector3<f64>)>,
}

/// The streamlines of the limit of a 1-form through some points: Runge and Kutta's method of order 4, in the parameters
/// of the faces, at unit speed. A step ends at the rim of the surface, and the parameters of a face are continued into
/// the next, so that no accuracy is lost between them. `positions` and `form` are cochains of the cage.
///
/// # Errors
/// If a seed is not on the surface.
///
/// # Panics
/// If the cochains do not belong to the cage, or a length is not positive.
pub fn streamlines(
    surface: &LimitSurface,
    positions: &Cochain<0, Vector3<f64>>,
    form: &Cochain<1>,
    seeds: &[SurfacePoint],
    tracing: &Tracing,
) -> Result<Vec<Streamline>, PointError> {
    assert!(tracing.step > 0.0 && tracing.length > 0.0, "a line has a length and steps");
    seeds.iter().try_for_each(|seed| surface.check(seed))?;
    let field = Flow {
        surface,
        pieces: Pieces::new(surface.hierarchy()),
        positions: surface.refine(positions),
        form: surface.refine(form),
    };
    let signs: &[f64] = if tracing.both_ways { &[-1.0, 1.0] } else { &[1.0] };
    let mut lines: Vec<Line> = seeds
        .iter()
        .flat_map(|seed| {
            let at = field.pieces.locate(seed);
            signs.iter().map(move |&sign| Line {
                at,
                sign,
                points: Vec::new(),
                positions: Vec::new(),
                length: 0.0,
                end: None,
                start: None,
            })
        })
        .collect();
    field.trace(&mut lines, tracing);
    Ok(lines.chunks_mut(signs.len()).map(join).collect())
}

/// Points spread evenly over a limit surface: as many as asked for, the same every time. Faces get their share by
/// area, and within a face points follow a sequence of low discrepancy.
///
/// # Panics
/// If the positions do not belong to the cage.
pub fn seeds(
    surface: &LimitSurface,
    positions: &Cochain<0, Vector3<f64>>,
    count: usize,
) -> Vec<SurfacePoint> {
    let pieces = Pieces::new(surface.hierarchy());
    let positions = surface.refine(positions);
    let faces = pieces.mesh().num_faces() as u32;
    let is_quad = pieces.num_corners() == 4;
    let middle = if is_quad { [0.5; 2] } else { [1.0 / 3.0; 2] };
    let at: Vec<SurfacePoint> =
        (0..faces).map(|face| pieces.surface_point(PiecePoint { face, at: middle })).collect();
    let jets = surface.evaluate_0(&positions, &at).expect("pieces are on the surface");
    let area = |(face, jet): (u32, &crate::limit::Jet<Vector3<f64>>)| {
        let [a, b] = jet.derivatives;
        let area = a.cross(&b).norm() * pieces.scale(face).powi(2);
        if area.is_finite() { area } else { 0.0 }
    };
    let mut sums = vec![0.0];
    for area in (0..faces).zip(&jets).map(area) {
        sums.push(sums[sums.len() - 1] + area);
    }
    let all = sums[sums.len() - 1];
    let seed = |i: usize| {
        let target = all * (i as f64 + 0.5) / count as f64;
        let face = (sums.partition_point(|&sum| sum <= target).max(1) - 1).min(faces as usize - 1);
        // Roberts' sequence; beyond the diagonal of a triangle, reflected at its middle.
        let [mut u, mut v] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3]
            .map(|step: f64| (0.5 + step * (i + 1) as f64).fract());
        if !is_quad && u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        pieces.surface_point(PiecePoint { face: face as u32, at: [u, v] })
    };
    (0..count).map(seed).collect()
}

/// One line from what was traced against the field, if anything, and along it.
fn join(parts: &mut [Line]) -> Streamline {
    let (back, forth) = match parts {
        [back, forth] => (Some(back), forth),
        [forth] => (None, forth),
        _ => unreachable!("a line has one part or two"),
    };
    let end = |line: &Line| line.end.unwrap_or(End::Length);
    let ends = [back.as_deref().map_or(End::Length, end), end(forth)];
    let (mut points, mut positions) = (Vec::new(), Vec::new());
    // A closed line is all there the first time.
    if let Some(back) = back.filter(|_| ends[1] != End::Closed) {
        points.extend(back.points.iter().skip(1).rev());
        positions.extend(back.positions.iter().skip(1).rev());
    }
    let seed = points.len();
    points.append(&mut forth.points);
    positions.append(&mut forth.positions);
    Streamline { points, positions, seed, ends }
}

struct Flow<'a> {
    surface: &'a LimitSurface,
    pieces: Pieces<'a>,
    positions: Cochain<0, Vector3<f64>>,
    form: Cochain<1>,
}

/// The field at a point, in the parameters of a piece.
#[derive(Clone, Copy)]
struct Sample {
    position: Vector3<f64>,
    vector: Vector3<f64>,
    /// The velocity of unit speed.
    velocity: [f64; 2],
}

impl Flow<'_> {
    /// The field at points that may lie beyond the rims of their pieces; velocities are in the pieces they were given in.
    fn sample(&self, points: &[PiecePoint]) -> Vec<Sample> {
        // Each point's way home, applied to both axes.
        let landed: Vec<(PiecePoint, Matrix2<f64>)> = points.iter().map(|&p| self.land(p)).collect();
        let at: Vec<SurfacePoint> = landed.iter().map(|(p, _)| self.pieces.surface_point(*p)).collect();
        let found = self.surface.evaluate_vectors(&self.positions, &self.form, &at);
        let found = found.expect("pieces are on the surface");
        let sample = |((p, turn), found): (&(PiecePoint, Matrix2<f64>), &crate::limit::SurfaceVector)| {
            let scale = self.pieces.scale(p.face);
            let g = first_fundamental_form(found.position.derivatives);
            let covector = Vector2::from(found.components);
            let speed = found.vector.norm();
            let velocity =
                g.try_inverse().map_or(Vector2::zeros(), |inverse| inverse * covector / speed / scale);
            let velocity = turn.try_inverse().expect("a change of axes") * velocity;
            Sample {
                position: found.position.value,
                vector: found.vector,
                velocity: if velocity.iter().all(|x| x.is_finite()) { velocity.into() } else { [0.0; 2] },
            }
        };
        landed.iter().zip(&found).map(sample).collect()
    }

    /// The piece that a point beyond the rim lies on, and what that does to vectors. At the boundary it stays beyond.
    fn land(&self, mut point: PiecePoint) -> (PiecePoint, Matrix2<f64>) {
        let mut turn = Matrix2::identity();
        for _ in 0..8 {
            let Some(edge) = self.pieces.beyond(point) else { break };
            let Some((next, first)) = self.pieces.across(point, turn.column(0).into_owned().into(), edge)
            else {
                break;
            };
            let (_, second) = self
                .pieces
                .across(point, turn.column(1).into_owned().into(), edge)
                .expect("there is a piece across");
            turn = Matrix2::from_columns(&[Vector2::from(first), Vector2::from(second)]);
            point = next;
        }
        (point, turn)
    }

    /// All lines, step by step, side by side.
    fn trace(&self, lines: &mut [Line], tracing: &Tracing) {
        let mut slowest = None;
        loop {
            let mut active: Vec<&mut Line> = lines.iter_mut().filter(|line| line.end.is_none()).collect();
            if active.is_empty() {
                return;
            }
            let here: Vec<PiecePoint> = active.iter().map(|line| line.at).collect();
            let first = self.sample(&here);
            let slowest = *slowest.get_or_insert_with(|| {
                let longest =
                    first.iter().map(|s| s.vector.norm()).filter(|x| x.is_finite()).fold(0.0, f64::max);
                tracing.least * longest
            });
            for (line, sample) in active.iter_mut().zip(&first) {
                self.record(line, sample, slowest, tracing);
            }
            let steps: Vec<f64> = active.iter().map(|line| line.sign * self.step(line, tracing)).collect();
            let go = |from: &[PiecePoint], k: &[Sample], part: f64| -> Vec<PiecePoint> {
                let moved = |((p, k), h): ((&PiecePoint, &Sample), &f64)| PiecePoint {
                    at: [0, 1].map(|i| p.at[i] + part * h * k.velocity[i]),
                    ..*p
                };
                from.iter().zip(k).zip(&steps).map(moved).collect()
            };
            let second = self.sample(&go(&here, &first, 0.5));
            let third = self.sample(&go(&here, &second, 0.5));
            let fourth = self.sample(&go(&here, &third, 1.0));
            for (i, line) in active.iter_mut().enumerate().filter(|(_, line)| line.end.is_none()) {
                let change = [0, 1].map(|k| {
                    let v = |samples: &[Sample]| samples[i].velocity[k];
                    steps[i] * (v(&first) + 2.0 * v(&second) + 2.0 * v(&third) + v(&fourth)) / 6.0
                });
                self.advance(line, change, steps[i].abs());
            }
        }
    }

    /// Notes where a line is, and whether it ends there.
    fn record(&self, line: &mut Line, sample: &Sample, slowest: f64, tracing: &Tracing) {
        line.points.push(self.pieces.surface_point(line.at));
        line.positions.push(sample.position);
        let speed = sample.vector.norm();
        let (start, direction) = *line.start.get_or_insert((sample.position, sample.vector));
        let near = (sample.position - start).norm() < 0.75 * tracing.step;
        if speed <= slowest || !speed.is_finite() || sample.velocity == [0.0; 2] {
            line.end = Some(End::Zero);
        } else if line.length >= tracing.length * (1.0 - 1e-9) {
            line.end = Some(End::Length);
        } else if line.length > 4.0 * tracing.step && near && direction.dot(&sample.vector) > 0.0 {
            line.end = Some(End::Closed);
        }
    }

    /// The length of the next step.
    fn step(&self, line: &Line, tracing: &Tracing) -> f64 {
        tracing.step.min(tracing.length - line.length).max(0.0)
    }

    /// Moves a line, as far as the surface goes.
    fn advance(&self, line: &mut Line, change: [f64; 2], length: f64) {
        let from = line.at;
        let to = PiecePoint { at: [0, 1].map(|k| from.at[k] + change[k]), ..from };
        let (landed, _) = self.land(to);
        line.at = landed;
        line.length += length;
        if self.pieces.beyond(landed).is_some() {
            // Half the way, and half of what is left: the last point on the surface.
            let (mut inside, mut outside) = (0.0, 1.0);
            for _ in 0..40 {
                let middle: f64 = (inside + outside) / 2.0;
                let at = PiecePoint { at: [0, 1].map(|k| from.at[k] + middle * change[k]), ..from };
                match self.pieces.beyond(self.land(at).0) {
                    Some(_) => outside = middle,
                    None => inside = middle,
                }
            }
            let at = PiecePoint { at: [0, 1].map(|k| from.at[k] + inside * change[k]), ..from };
            line.at = self.land(at).0;
            line.points.push(self.pieces.surface_point(line.at));
            line.positions.push(self.sample(&[line.at])[0].position);
            line.end = Some(End::Boundary);
        }
    }
}
