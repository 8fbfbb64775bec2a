use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;
use rayon::prelude::*;

use super::DesignError;
use super::boundary::boundary_loops;
use crate::cochain::Cochain;
use crate::hierarchy::Hierarchy;
use crate::limit::{LimitSurface, PiecePoint, Pieces, SurfacePoint, SurfaceVector};
use crate::topology::Mesh;

/// A zero of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Singularity {
    /// Where.
    pub point: SurfacePoint,
    /// Its position.
    pub position: Vector3<f64>,
    /// How often the field turns round it, counter-clockwise: 1 for sources, sinks and vortices, -1 for saddles.
    pub index: i32,
    /// The length of the field's vector there: what is left of it after Newton's method.
    pub residual: f64,
}

/// The zeros of a field, held against the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Singularities {
    /// The zeros, in the order of the cells they were found in.
    pub zeros: Vec<Singularity>,
    /// The sum of their indices.
    pub index_sum: i32,
    /// The Euler characteristic of the surface.
    pub euler: i32,
    /// How often the field turns against the boundary, the surface on the left, summed over all loops: 0 where it
    /// keeps its angle.
    pub boundary_turns: i32,
    /// The largest length of the field's vector at the points that were looked at.
    pub largest: f64,
}

impl Singularities {
    /// Poincare and Hopf: the indices sum to the Euler characteristic and the turns at the boundary.
    pub fn holds(&self) -> bool {
        self.index_sum == self.euler + self.boundary_turns
    }
}

/// The zeros of the limit of a 1-form. `positions` and `form` are cochains of the cage.
///
/// The surface is refined to cells, `levels` times at least once, and the field is evaluated, exactly, once in each of their
/// faces. Round each vertex the turning of the vectors from face to face is summed, against vectors carried along
/// with the surface; a sum that is no zero is a zero of the field in that cell, and Newton's method on the limit field
/// finds it. Zeros that cancel inside one cell are not seen: refine more to tell them apart.
///
/// # Errors
/// If the surface cannot be refined that far, or is not a manifold along an edge.
///
/// # Panics
/// If the cochains do not belong to the cage.
pub fn singularities(
    surface: &LimitSurface,
    positions: &Cochain<0, Vector3<f64>>,
    form: &Cochain<1>,
    levels: usize,
) -> Result<Singularities, DesignError> {
    let known = surface.hierarchy();
    let levels = levels.max(known.num_levels()).max(1);
    let hierarchy = Hierarchy::new(known.cage(), known.scheme(), levels)?;
    let field = Sampled::new(surface, &hierarchy, surface.refine(positions), surface.refine(form));
    let mesh = field.pieces.mesh();
    let cells = (0..mesh.num_vertices() as u32).into_par_iter();
    let zeros = cells.filter_map(|v| field.index(v).map(|index| field.locate(v, index)));
    let zeros: Vec<Singularity> = zeros.collect();
    let cage = known.level(0).mesh();
    let used = (0..cage.num_vertices() as u32).filter(|&v| cage.fans(v).len() > 0).count();
    Ok(Singularities {
        index_sum: zeros.iter().map(|zero| zero.index).sum(),
        zeros,
        euler: used as i32 - cage.num_edges() as i32 + cage.num_faces() as i32,
        boundary_turns: field.boundary_turns()?,
        largest: field.inside.iter().map(|sample| sample.vector.norm()).fold(0.0, f64::max),
    })
}

/// A field at one point of each face and of each boundary edge.
struct Sampled<'a> {
    surface: &'a LimitSurface,
    positions: Cochain<0, Vector3<f64>>,
    form: Cochain<1>,
    pieces: Pieces<'a>,
    inside: Vec<SurfaceVector>,
    /// For each boundary half-edge (in the order of the edges) a sample; `rim` has its number.
    outside: Vec<SurfaceVector>,
    rim: Vec<u32>,
}

impl<'a> Sampled<'a> {
    fn new(
        surface: &'a LimitSurface,
        hierarchy: &'a Hierarchy,
        positions: Cochain<0, Vector3<f64>>,
        form: Cochain<1>,
    ) -> Self {
        let pieces = Pieces::new(hierarchy);
        let mesh = pieces.mesh();
        // Not the very middle: symmetric fields have zeros there.
        let middle = if pieces.num_corners() == 4 { [0.4871, 0.4934] } else { [0.3296, 0.3389] };
        let points: Vec<SurfacePoint> = (0..mesh.num_faces() as u32)
            .map(|face| pieces.surface_point(PiecePoint { face, at: middle }))
            .collect();
        let mut rim = vec![u32::MAX; mesh.num_edges()];
        let mut edges = Vec::new();
        for face in 0..mesh.num_faces() as u32 {
            for i in 0..pieces.num_corners() {
                let e = pieces.half_edge(face, i).edge();
                if mesh.is_boundary_edge(e) {
                    rim[e as usize] = edges.len() as u32;
                    let (a, b) = (pieces.corners()[i], pieces.corners()[(i + 1) % pieces.num_corners()]);
                    let at = [0, 1].map(|k| 0.4871 * a[k] + 0.5129 * b[k]);
                    edges.push(pieces.surface_point(PiecePoint { face, at }));
                }
            }
        }
        let at = |points: &[SurfacePoint]| {
            surface.evaluate_vectors(&positions, &form, points).expect("pieces are on the surface")
        };
        let (inside, outside) = (at(&points), at(&edges));
        Sampled { surface, positions, form, pieces, inside, outside, rim }
    }

    /// The index of the field round a vertex, if it is not 0.
    fn index(&self, v: u32) -> Option<i32> {
        let mesh = self.pieces.mesh();
        let fans = mesh.fans(v).filter_map(|fan| {
            let mut ring: Vec<&SurfaceVector> =
                fan.corners.iter().map(|&c| &self.inside[mesh.corner_face(c) as usize]).collect();
            if !fan.cyclic {
                let first = mesh.corner_half_edge(fan.corners[0]).edge();
                let last =
                    mesh.corner_half_edge(mesh.previous_corner(fan.corners[fan.corners.len() - 1])).edge();
                let at = |e: u32| self.outside.get(self.rim[e as usize] as usize);
                ring.insert(0, at(first)?);
                ring.push(at(last)?);
            }
            Some(index_round(&ring))
        });
        Some(fans.sum::<i32>()).filter(|&index| index != 0)
    }

    /// The zero in the cell of a vertex: where the field is shortest on a grid, and from there by Newton's method.
    fn locate(&self, v: u32, index: i32) -> Singularity {
        const GRID: usize = 6;
        let mesh = self.pieces.mesh();
        let mut starts = Vec::new();
        for &c in mesh.fans(v).flat_map(|fan| fan.corners) {
            let face = mesh.corner_face(c);
            for i in 0..=GRID {
                for j in 0..=GRID {
                    let at = [i as f64 / GRID as f64, j as f64 / GRID as f64];
                    if self.pieces.num_corners() == 4 || i + j <= GRID {
                        starts.push(PiecePoint { face, at });
                    }
                }
            }
        }
        let points: Vec<SurfacePoint> = starts.iter().map(|&p| self.pieces.surface_point(p)).collect();
        let lengths = self.vectors(&points).into_iter().map(|found| found.vector.norm());
        let mut order: Vec<(usize, f64)> =
            lengths.map(|x| if x.is_finite() { x } else { f64::INFINITY }).enumerate().collect();
        order.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut best = (points[order[0].0], order[0].1);
        for &(i, _) in order.iter().take(4) {
            let found = self.newton(starts[i]);
            if found.1 < best.1 {
                best = found;
            }
        }
        if best.1 >= 1e-9 * order[order.len() - 1].1.min(f64::MAX) {
            best = self.creep(starts[order[0].0], best);
        }
        let [found] = self.vectors(&[best.0])[..] else { unreachable!("one point") };
        Singularity { point: best.0, position: found.position.value, index, residual: best.1 }
    }

    fn vectors(&self, points: &[SurfacePoint]) -> Vec<SurfaceVector> {
        let found = self.surface.evaluate_vectors(&self.positions, &self.form, points);
        found.expect("pieces are on the surface")
    }

    /// Where derivatives do not help, beside irregular vertices: to the best of eight neighbours, ever closer.
    fn creep(&self, start: PiecePoint, mut best: (SurfacePoint, f64)) -> (SurfacePoint, f64) {
        let (mut at, mut step) = (start, 0.1);
        let mut least = f64::INFINITY;
        for _ in 0..120 {
            let around = (0..9).map(|i| [f64::from(i % 3 - 1), f64::from(i / 3 - 1)]);
            let tried: Vec<PiecePoint> = around
                .map(|d| self.onto(PiecePoint { at: [0, 1].map(|k| at.at[k] + step * d[k]), ..at }))
                .collect();
            let points: Vec<SurfacePoint> = tried.iter().map(|&p| self.pieces.surface_point(p)).collect();
            let found = self.vectors(&points).into_iter().map(|v| v.vector.norm()).enumerate();
            let (i, length) = found
                .filter(|(_, length)| length.is_finite())
                .fold((4, f64::INFINITY), |least, next| if next.1 < least.1 { next } else { least });
            if length < least {
                (at, least) = (tried[i], length);
                if length < best.1 {
                    best = (points[i], length);
                }
            } else {
                step /= 2.0;
            }
        }
        best
    }

    /// A point beyond the rim of its piece, on the piece where it lies.
    fn onto(&self, mut at: PiecePoint) -> PiecePoint {
        for _ in 0..4 {
            let Some(edge) = self.pieces.beyond(at) else { break };
            match self.pieces.across(at, [0.0; 2], edge) {
                Some((next, _)) => at = next,
                None => break,
            }
        }
        at
    }

    /// Follows Newton's steps from piece to piece; where it came to, and the length of the vector there.
    fn newton(&self, start: PiecePoint) -> (SurfacePoint, f64) {
        let length = |p: PiecePoint| {
            let point = self.pieces.surface_point(p);
            (point, self.vectors(&[point])[0].vector.norm())
        };
        let (mut at, mut best) = (start, length(start));
        for _ in 0..30 {
            let point = self.pieces.surface_point(at);
            let jets = self.surface.evaluate_1(&self.form, &[point]).expect("pieces are on the surface")[0];
            let [[a, b], [c, d]] = jets.map(|jet| jet.derivatives);
            let determinant = a * d - b * c;
            let [x, y] = jets.map(|jet| jet.value);
            let scale = self.pieces.scale(at.face);
            let step = [(d * x - b * y) / determinant / scale, (a * y - c * x) / determinant / scale];
            if !step.iter().all(|x| x.is_finite()) || (step[0] == 0.0 && step[1] == 0.0) {
                break;
            }
            let most = step[0].abs().max(step[1].abs());
            let shorten = if most > 0.5 { 0.5 / most } else { 1.0 };
            at.at = [at.at[0] - shorten * step[0], at.at[1] - shorten * step[1]];
            at = self.onto(at);
            let found = length(at);
            if !found.1.is_finite() {
                break;
            }
            if found.1 < best.1 {
                best = found;
            }
            at = PiecePoint { at: at.at.map(|x| x.clamp(-0.2, 1.2)), ..at };
            if most < 1e-14 {
                break;
            }
        }
        best
    }

    /// How often the field turns against the boundary.
    fn boundary_turns(&self) -> Result<i32, DesignError> {
        let mesh: &Mesh = self.pieces.mesh();
        let mut turns = 0;
        for ring in boundary_loops(mesh)? {
            let angles: Vec<f64> = ring
                .iter()
                .map(|h| {
                    let sample = &self.outside[self.rim[h.edge() as usize] as usize];
                    let corner = mesh.left_corner(*h).expect("the surface is on the left");
                    let (tangent, normal) = (self.along(corner), normal(sample));
                    angle(&tangent, &sample.vector, &normal)
                })
                .collect();
            let n = angles.len();
            turns +=
                ((0..n).map(|i| wrap(angles[(i + 1) % n] - angles[i])).sum::<f64>() / TAU).round() as i32;
        }
        Ok(turns)
    }

    /// The direction of the edge that leaves a corner, at its sample.
    fn along(&self, corner: u32) -> Vector3<f64> {
        let mesh = self.pieces.mesh();
        let face = mesh.corner_face(corner);
        let n = self.pieces.num_corners();
        let e = mesh.corner_half_edge(corner).edge();
        let i = (0..n).find(|&i| self.pieces.half_edge(face, i).edge() == e).expect("an edge of the face");
        let (a, b) = (self.pieces.corners()[i], self.pieces.corners()[(i + 1) % n]);
        let scale = self.pieces.scale(face);
        let [by_s, by_t] = self.outside[self.rim[e as usize] as usize].position.derivatives;
        (by_s * (b[0] - a[0]) + by_t * (b[1] - a[1])) * scale
    }
}

fn normal(sample: &SurfaceVector) -> Vector3<f64> {
    let [a, b] = sample.position.derivatives;
    a.cross(&b).try_normalize(0.0).unwrap_or_else(Vector3::z)
}

/// The angle from `a` to `b`, counter-clockwise seen from the tip of `normal`.
fn angle(a: &Vector3<f64>, b: &Vector3<f64>, normal: &Vector3<f64>) -> f64 {
    normal.dot(&a.cross(b)).atan2(a.dot(b))
}

fn wrap(angle: f64) -> f64 {
    angle - TAU * ((angle + PI) / TAU).floor()
}

/// A vector carried from one tangent plane to another by the shortest turn between their normals.
fn carry(vector: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> Vector3<f64> {
    let (axis, cosine) = (from.cross(to), from.dot(to));
    vector * cosine + axis.cross(vector) + axis * (axis.dot(vector) / (1.0 + cosine).max(1e-9))
}

/// The index of the vectors along a closed ring: their turning from each to the next, against carried vectors, and what a
/// vector that is carried round turns.
fn index_round(ring: &[&SurfaceVector]) -> i32 {
    let normals: Vec<Vector3<f64>> = ring.iter().map(|sample| normal(sample)).collect();
    let start = {
        let [t, _] = ring[0].position.derivatives;
        (t - normals[0] * normals[0].dot(&t)).try_normalize(0.0).unwrap_or_else(Vector3::x)
    };
    let (mut carried, mut sum) = (start, 0.0);
    for i in 0..ring.len() {
        let j = (i + 1) % ring.len();
        let vector = carry(&ring[i].vector, &normals[i], &normals[j]);
        sum += angle(&vector, &ring[j].vector, &normals[j]);
        carried = carry(&carried, &normals[i], &normals[j]);
    }
    ((sum + angle(&start, &carried, &normals[0])) / TAU).round() as i32
}
