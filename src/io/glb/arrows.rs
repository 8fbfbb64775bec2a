use nalgebra::Vector3;

use crate::field;
use crate::io::Surface;
use crate::io::surface::face_areas;

/// The longest arrow, in mean edge lengths: neighbours do not touch.
const LONGEST: f64 = 0.9;
/// The barbs reach back along the shaft and to the sides by these fractions of the arrow.
const BARB: (f64, f64) = (0.28, 0.14);
/// Arrows float above the surface by this fraction of the mean edge length, or the triangles would
/// swallow half of each line.
const LIFT: f64 = 0.02;

/// Line segments: pairs of indices into points.
#[derive(Debug, Default)]
pub(super) struct Lines {
    pub points: Vec<Vector3<f64>>,
    pub indices: Vec<u32>,
}

/// An arrow for each face of the surface whose vector is not zero, centred at the face, lying along it.
pub(super) fn arrows(surface: &Surface, vectors: &[Vector3<f64>]) -> Lines {
    let (mesh, positions) = (surface.mesh(), surface.positions());
    let longest = surface.faces().map(|f| vectors[f as usize].norm()).fold(0.0, f64::max);
    if longest == 0.0 || !longest.is_finite() {
        return Lines::default();
    }
    let length = |e: u32| {
        let [a, b] = mesh.edges()[e as usize].map(|v| positions[v as usize]);
        (b - a).norm()
    };
    let mean_edge = surface.edges().map(length).sum::<f64>() / surface.edges().len() as f64;

    let centres = field::face_centres(mesh, positions);
    let areas = face_areas(mesh, positions);
    let mut lines = Lines::default();
    for f in surface.drawn_faces() {
        // The longest vector may be tiny or huge: divide before multiplying.
        let arrow = vectors[f as usize] / longest * (LONGEST * mean_edge);
        let Some(normal) = areas[f as usize].try_normalize(0.0) else { continue };
        if arrow.norm() == 0.0 {
            continue;
        }
        let tip = centres[f as usize] + normal * (LIFT * mean_edge) + arrow / 2.0;
        let side = normal.cross(&arrow);
        let first = lines.points.len() as u32;
        lines.points.extend([
            tip - arrow,
            tip,
            tip - arrow * BARB.0 + side * BARB.1,
            tip - arrow * BARB.0 - side * BARB.1,
        ]);
        lines.indices.extend([0, 1, 1, 2, 1, 3].map(|i| first + i));
    }
    lines
}
