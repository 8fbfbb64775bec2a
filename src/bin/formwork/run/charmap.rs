use formwork::analysis::{AnalysisError, CharacteristicMap, Regularity, Ring};
use formwork::limit::SurfacePoint;
use formwork::topology::SplitKind;
use serde_json::json;

use super::{Outcome, size_of};
use crate::Failure;
use crate::args::{CharMap, Valences, scheme_name};
use crate::draw::{ACCENT, GREY, INK, PALE, Panel, Picture, Point};
use crate::job::{check_outputs, format_of};

/// Rings of the map in a picture, one less than those of control points.
const RINGS: usize = 3;
/// Lines of the grid to a side of a face.
const LINES: usize = 8;
/// The size of one map on the page, and of the space under it for its numbers.
const SIDE: f64 = 250.0;
const CAPTION: f64 = 52.0;
const MARGIN: f64 = 14.0;

pub fn run(args: &CharMap) -> Result<Outcome, Failure> {
    if let Some(output) = &args.output {
        format_of(output, &["svg", "png"])?;
        check_outputs(&[], std::slice::from_ref(output))?;
    }
    let Valences(first, last) = args.valence;
    let (mut maps, mut notes) = (Vec::new(), Vec::new());
    for faces in usize::from(first)..=usize::from(last) {
        let ring = Ring::new(args.vertex.scheme(), faces, args.vertex.boundary, RINGS)?;
        match CharacteristicMap::new(ring) {
            Ok(map) => {
                let regularity = map.regularity(usize::from(args.samples));
                maps.push((map, regularity));
            }
            // In a range, a valence without a map is worth knowing, and the others are too.
            Err(error @ AnalysisError::NoCharacteristicMap) if first < last => {
                notes.push(format!("valence {faces}: {error}"));
            }
            Err(error) => return Err(error.into()),
        }
    }
    let name = scheme_name(args.vertex.scheme());
    let place = if args.vertex.boundary { "boundary vertices" } else { "vertices" };
    let mut text = format!("{name}, characteristic maps of {place}\n\n");
    text += "valence  eigenvalues           determinant             turn      samples  injective\n";
    for (map, found) in &maps {
        let [a, b] = map.eigenvalues();
        let [low, high] = found.determinant;
        text += &format!(
            "{:>7}  {a:.6}, {b:.6}    {low:>9.3e} to {high:<9.3e}  {:.6}  {:>7}  {}\n",
            map.ring().faces(),
            found.turn,
            found.samples,
            if found.holds() { "yes, as sampled" } else { "no" },
        );
    }
    if let Some(output) = &args.output {
        picture(name, &maps)?.save(output)?;
        text += &format!("\nwrote {}{}\n", output.display(), size_of(output));
    }
    let json = json!({
        "command": "charmap",
        "scheme": name,
        "boundary": args.vertex.boundary,
        "maps": maps.iter().map(|(map, found)| json!({
            "valence": map.ring().faces(),
            "eigenvalues": map.eigenvalues(),
            "determinant": found.determinant,
            "turn": found.turn,
            "expected_turn": found.expected_turn,
            "samples": found.samples,
            "injective_as_sampled": found.holds(),
        })).collect::<Vec<_>>(),
        "written": args.output.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
    });
    Ok(Outcome { text, json, notes, holds: true })
}

/// Maps of boundary vertices are half disks.
fn height(boundary: bool) -> f64 {
    if boundary { 0.62 * SIDE } else { SIDE }
}

/// The maps in rows of at most five.
fn picture(name: &str, maps: &[(CharacteristicMap, Regularity)]) -> Result<Picture, Failure> {
    let columns = match maps.len() {
        n @ ..=4 => n.max(1),
        n if n.is_multiple_of(5) => 5,
        _ => 4,
    };
    let rows = maps.len().div_ceil(columns).max(1);
    let tall = height(maps.iter().all(|(map, _)| map.ring().is_boundary()));
    let step = [SIDE + MARGIN, tall + CAPTION + MARGIN];
    let size = [MARGIN + columns as f64 * step[0], MARGIN + rows as f64 * step[1]];
    let mut picture = Picture::new(size[0], size[1]);
    for (i, (map, found)) in maps.iter().enumerate() {
        let corner = [MARGIN + (i % columns) as f64 * step[0], MARGIN + (i / columns) as f64 * step[1]];
        draw(&mut picture, corner, map)?;
        let middle = corner[0] + SIDE / 2.0;
        let [a, b] = map.eigenvalues();
        let values = if (a - b).abs() < 1e-9 { format!("{a:.4}") } else { format!("{a:.4}, {b:.4}") };
        let title = format!("{name}, valence {}", map.ring().faces());
        picture.text([middle, corner[1] + tall + 18.0], title, 13.0, INK, 0.5);
        let [low, high] = found.determinant;
        let below = format!("eigenvalue {values}, det {low:.2} to {high:.2}");
        picture.text([middle, corner[1] + tall + 36.0], below, 10.5, GREY, 0.5);
    }
    Ok(picture)
}

/// One map: the refined grid, darker at the vertex; the control points of the first two rings.
fn draw(picture: &mut Picture, corner: Point, map: &CharacteristicMap) -> Result<(), Failure> {
    let ring = map.ring();
    let control: Vec<Point> = map.control().iter().map(|p| [p.x, p.y]).collect();
    let mut layers: [Vec<Vec<Point>>; 3] = Default::default();
    for face in map.faces() {
        let near = ring.ring_of_face(face as usize) == 1;
        for (line, is_rim) in face_lines(ring.split_kind(), if near { 16 } else { 6 }) {
            let points: Vec<_> =
                line.into_iter().map(|[s, t]| SurfacePoint { face, corner: 0, s, t }).collect();
            let jets = map.evaluate(&points)?;
            let layer = if is_rim {
                2
            } else if near {
                1
            } else {
                0
            };
            layers[layer].push(jets.iter().map(|jet| [jet.value.x, jet.value.y]).collect());
        }
    }
    // Those of the second ring are the first ones round which nothing is left to choose.
    let shown = ring.num_vertices_to(2);
    let drawn = layers.iter().flatten().flatten().chain(&control[..shown]).copied();
    let panel = Panel::around(drawn, corner, [SIDE, height(ring.is_boundary())]);
    let [far, near, rims] = layers.map(|lines| lines.iter().map(|l| panel.place_all(l)).collect());
    picture.lines(far, PALE, 0.5);
    picture.lines(near, [120, 138, 170], 0.6);
    picture.lines(rims, INK, 0.8);
    let net = |edges: &mut dyn Iterator<Item = [u32; 2]>| -> Vec<Vec<Point>> {
        edges.map(|e| e.map(|v| panel.place(control[v as usize])).to_vec()).collect()
    };
    let lines = net(&mut ring.edges().into_iter().filter(|e| e.iter().all(|&v| (v as usize) < shown)));
    picture.lines(lines, ACCENT, 0.5);
    for &p in &control[..shown] {
        picture.dot(panel.place(p), 2.0, ACCENT);
    }
    Ok(())
}

/// Lines of the grid on a face in its parameters, of so many pieces, and whether they are its rim.
fn face_lines(kind: SplitKind, points: usize) -> Vec<(Vec<[f64; 2]>, bool)> {
    let part = |i: usize, n: usize| i as f64 / n as f64;
    let mut lines = Vec::new();
    for i in 0..=LINES {
        let x = part(i, LINES);
        let along = |at: &dyn Fn(f64) -> [f64; 2]| -> Vec<[f64; 2]> {
            (0..=points).map(|j| at(part(j, points))).collect()
        };
        match kind {
            SplitKind::Quad => {
                let is_rim = i == 0 || i == LINES;
                lines.push((along(&|y| [x, y]), is_rim));
                lines.push((along(&|y| [y, x]), is_rim));
            }
            SplitKind::Triangle => {
                lines.extend((i < LINES).then(|| (along(&|y| [x, y * (1.0 - x)]), i == 0)));
                lines.extend((i < LINES).then(|| (along(&|y| [y * (1.0 - x), x]), i == 0)));
                lines.extend((i > 0).then(|| (along(&|y| [x * y, x * (1.0 - y)]), i == LINES)));
            }
        }
    }
    lines
}
