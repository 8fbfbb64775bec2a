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

/// Where an arrow lies, the unit normal there, and its vector.
type Anchor = (Vector3<f64>, Vector3<f64>, Vector3<f64>);

/// The anchors of a surface: its vertices on a limit surface, else its faces.
fn anchors(surface: &Surface) -> Vec<Anchor> {
    let (mesh, positions) = (surface.mesh(), surface.positions());
    if let Some(at) = surface.at_vertices() {
        let Some([vectors, _]) = &at.vectors else { return Vec::new() };
        let mut written = vec![false; mesh.num_vertices()];
        surface.drawn_faces().flat_map(|f| mesh.face_vertices(f)).for_each(|&v| written[v as usize] = true);
        let vertices = (0..mesh.num_vertices()).filter(|&v| written[v]);
        return vertices.map(|v| (positions[v], at.normals[v], vectors[v])).collect();
    }
    let Some(vectors) = surface.face_vectors() else { return Vec::new() };
    let centres = field::face_centres(mesh, positions);
    let areas = face_areas(mesh, positions);
    let anchor = |f: u32| {
        let normal = areas[f as usize].try_normalize(0.0)?;
        Some((centres[f as usize], normal, vectors[f as usize]))
    };
    surface.drawn_faces().filter_map(anchor).collect()
}

/// An arrow at each anchor whose vector is not zero, centred there, lying along the surface.
pub(super) fn arrows(surface: &Surface) -> Lines {
    let (mesh, positions) = (surface.mesh(), surface.positions());
    let anchors = anchors(surface);
    let longest = anchors.iter().map(|(_, _, vector)| vector.norm()).fold(0.0, f64::max);
    if longest == 0.0 || !longest.is_finite() {
        return Lines::default();
    }
    let length = |e: u32| {
        let [a, b] = mesh.edges()[e as usize].map(|v| positions[v as usize]);
        (b - a).norm()
    };
    let mean_edge = surface.edges().map(length).sum::<f64>() / surface.edges().len() as f64;

    let mut lines = Lines::default();
    for (centre, normal, vector) in anchors {
        // The longest vector may be tiny or huge: divide before multiplying.
        let arrow = vector / longest * (LONGEST * mean_edge);
        if arrow.norm() == 0.0 {
            continue;
        }
        let tip = centre + normal * (LIFT * mean_edge) + arrow / 2.0;
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
