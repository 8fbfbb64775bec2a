use formwork::analysis::{CharacteristicMap, Ring, Sample};
use formwork::limit::SurfacePoint;
use formwork::topology::SplitKind;
use serde_json::json;

use super::{Outcome, size_of};
use crate::Failure;
use crate::args::{Basis, Cell, scheme_name};
use crate::draw::{ACCENT, Grid, INK, Panel, Picture, Point, extent, legend};
use crate::job::{check_outputs, format_of};

/// Rings of control points; forms are drawn on one less.
const RINGS: usize = 4;
/// Samples along the sides of a face at the vertex, where forms bend most, and of all others.
const NEAR: usize = 32;
const FAR: usize = 14;
const SIDE: f64 = 340.0;
const MARGIN: f64 = 22.0;

pub fn run(args: &Basis) -> Result<Outcome, Failure> {
    format_of(&args.output, &["svg", "png"])?;
    check_outputs(&[], std::slice::from_ref(&args.output))?;
    let (faces, degree) = (usize::from(args.valence), usize::from(args.cell.degree));
    let map = CharacteristicMap::new(Ring::new(args.vertex.scheme(), faces, args.vertex.boundary, RINGS)?)?;
    let (cell, sign, what) = cell_of(map.ring(), &args.cell)?;
    let name = scheme_name(args.vertex.scheme());
    let place = if args.vertex.boundary { "boundary valence" } else { "valence" };
    let title = format!("{name}, {place} {faces}: {degree}-form of {what}");
    let (picture, ranges) = picture(&map, degree, cell, sign, &title)?;
    picture.save(&args.output)?;

    let parts: &[&str] = if degree == 1 { &["dx", "dy"] } else { &["value"] };
    let mut text = format!("{title}\n");
    for (part, range) in parts.iter().zip(&ranges) {
        // No -0.0000.
        let [low, high] = range.map(|x| if x.abs() < 5e-5 { 0.0 } else { x });
        text += &format!("{part:<6}{low:>9.4} to {high:.4}\n");
    }
    text += &format!("wrote {}{}\n", args.output.display(), size_of(&args.output));
    let json = json!({
        "command": "basis",
        "scheme": name,
        "valence": faces,
        "boundary": args.vertex.boundary,
        "degree": degree,
        "cell": cell,
        "edges": map.ring().edges(),
        "parts": parts.iter().zip(&ranges).map(|(part, range)| json!({ "part": part, "range": range })).collect::<Vec<_>>(),
        "eigenvalues": map.eigenvalues(),
        "written": [args.output.display().to_string()],
    });
    Ok(Outcome { text, json, notes: Vec::new(), holds: true })
}

/// The number of a cell that was named, 1 or -1 if it was named against its direction, and its name.
pub fn cell_of(ring: &Ring, named: &Cell) -> Result<(usize, f64, String), Failure> {
    let (degree, edges) = (usize::from(named.degree), ring.edges());
    let (cell, sign) = match named.edge {
        None => (named.cell, 1.0),
        Some(_) if degree != 1 => {
            return Err("--edge names a cell of degree 1: leave it out, or --degree".into());
        }
        Some([a, b]) => {
            let found = edges.iter().position(|&e| e == [a, b]).map(|e| (e, 1.0));
            let found = found.or_else(|| edges.iter().position(|&e| e == [b, a]).map(|e| (e, -1.0)));
            found.ok_or_else(|| {
                format!("--edge {a}-{b}: there is no such edge near the vertex, choose 0-1 or one that --json lists")
            })?
        }
    };
    let count = ring.num_cells(degree);
    if cell >= count {
        let last = count - 1;
        return Err(
            format!("--cell {cell}: there are {count} cells of degree {degree}, choose 0 to {last}").into()
        );
    }
    let name = match degree {
        0 => format!("vertex {cell}"),
        1 => {
            let [a, b] = edges[cell];
            let [a, b] = if sign > 0.0 { [a, b] } else { [b, a] };
            format!("edge {a}-{b}")
        }
        _ => format!("face {cell}"),
    };
    Ok((cell, sign, name))
}

/// The parts of the form side by side, and their ranges.
fn picture(
    map: &CharacteristicMap,
    degree: usize,
    cell: usize,
    sign: f64,
    title: &str,
) -> Result<(Picture, Vec<[f64; 2]>), Failure> {
    let parts = if degree == 1 { 2 } else { 1 };
    let mut grids: Vec<Grid> = (0..parts).map(|_| Grid::default()).collect();
    let [near_grid, far_grid] = [NEAR, FAR].map(|steps| face_grid(map.ring().split_kind(), steps));
    let mut rims: Vec<Vec<Point>> = Vec::new();
    for face in map.faces() {
        let near = map.ring().ring_of_face(face as usize) == 1;
        let (parameters, triangles) = if near { &near_grid } else { &far_grid };
        // A density does not exist at the vertex itself.
        let inner = |[s, t]: [f64; 2]| if near && degree == 2 && s + t == 0.0 { [1e-3; 2] } else { [s, t] };
        let at = |[s, t]: [f64; 2]| SurfacePoint { face, corner: 0, s, t };
        let points: Vec<_> = parameters.iter().map(|&p| at(inner(p))).collect();
        let samples = map.basis(degree, cell, &points)?;
        let positions: Vec<Point> = samples.iter().map(|s| [s.position.x, s.position.y]).collect();
        for (k, grid) in grids.iter_mut().enumerate() {
            let value = |sample: &Sample| sign * sample.parts[k];
            grid.extend(&positions, &samples.iter().map(value).collect::<Vec<f64>>(), triangles);
        }
        for rim in rim_lines(map.ring().split_kind()) {
            let points: Vec<_> = rim.into_iter().map(at).collect();
            rims.push(map.evaluate(&points)?.iter().map(|jet| [jet.value.x, jet.value.y]).collect());
        }
    }
    let range = grids.iter().map(Grid::range).fold(0.0, f64::max);
    let width = MARGIN + parts as f64 * (SIDE + MARGIN);
    let [low, high] = extent(grids[0].points.iter().copied());
    let tall = SIDE * ((high[1] - low[1]) / (high[0] - low[0])).clamp(0.3, 1.0);
    let mut picture = Picture::new(width.max(420.0), tall + 118.0);
    let middle = picture.width / 2.0;
    picture.text([middle, 26.0], title, 14.0, INK, 0.5);
    for (k, grid) in grids.iter().enumerate() {
        let left = middle + (k as f64 - parts as f64 / 2.0) * (SIDE + MARGIN) + MARGIN / 2.0;
        let panel = Panel::around(grid.points.iter().copied(), [left, 40.0], [SIDE, tall]);
        grid.paint(&mut picture, &panel, range);
        let placed = rims.iter().map(|rim| panel.place_all(rim)).collect();
        picture.lines(placed, [110, 110, 115], 0.4);
        mark(&mut picture, &panel, map, degree, cell, sign)?;
        let part = ["dx part", "dy part"][k];
        if parts == 2 {
            picture.text([left + SIDE / 2.0, tall + 60.0], part, 12.0, INK, 0.5);
        }
    }
    legend(&mut picture, [middle - 100.0, tall + 74.0], [200.0, 10.0], range);
    let of = |grid: &Grid| {
        let finite = grid.values.iter().filter(|x| x.is_finite());
        finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &x| [a.min(x), b.max(x)])
    };
    Ok((picture, grids.iter().map(of).collect()))
}

/// The cell itself: a dot, or an arrow along the edge on the surface.
fn mark(
    picture: &mut Picture,
    panel: &Panel,
    map: &CharacteristicMap,
    degree: usize,
    cell: usize,
    sign: f64,
) -> Result<(), Failure> {
    let ring = map.ring();
    let d = ring.descriptor();
    let size = if ring.split_kind() == SplitKind::Quad { 4 } else { 3 };
    let at = |face: u32, corner: u32, s: f64| SurfacePoint { face, corner, s, t: 0.0 };
    let place = |points: &[SurfacePoint]| -> Result<Vec<Point>, Failure> {
        Ok(map.evaluate(points)?.iter().map(|jet| panel.place([jet.value.x, jet.value.y])).collect())
    };
    let corners = map.faces().flat_map(|face| (0..size as u32).map(move |corner| (face, corner)));
    let vertex = |face: u32, corner: u32| d.face_vertices[face as usize * size + corner as usize % size];
    let mut corners = corners.map(|(f, c)| (f, c, [vertex(f, c), vertex(f, c + 1)]));
    match degree {
        0 => {
            if let Some((face, corner, _)) = corners.find(|(_, _, ends)| ends[0] as usize == cell) {
                picture.dot(place(&[at(face, corner, 0.0)])?[0], 3.5, INK);
            }
        }
        1 => {
            let [a, b] = ring.edges()[cell];
            let along = |ends: [u32; 2]| (ends == [a, b]).then_some(1.0).or((ends == [b, a]).then_some(-1.0));
            if let Some((face, corner, way)) = corners.find_map(|(f, c, ends)| Some((f, c, along(ends)?))) {
                let points: Vec<_> = (0..=16).map(|i| at(face, corner, f64::from(i) / 16.0)).collect();
                let mut line = place(&points)?;
                if way * sign < 0.0 {
                    line.reverse();
                }
                picture.arrow(line, INK, 1.8);
            }
        }
        _ => {
            if (cell as u32) < map.faces().end {
                let middle = if size == 4 { [0.5, 0.5] } else { [1.0 / 3.0, 1.0 / 3.0] };
                let [s, t] = middle;
                let point = SurfacePoint { face: cell as u32, corner: 0, s, t };
                picture.dot(place(&[point])?[0], 3.5, ACCENT);
            }
        }
    }
    Ok(())
}

/// Points of a face and the triangles between them.
fn face_grid(kind: SplitKind, steps: usize) -> (Vec<[f64; 2]>, Vec<[usize; 3]>) {
    let quad = kind == SplitKind::Quad;
    let (mut points, mut numbers) = (Vec::new(), vec![usize::MAX; (steps + 1) * (steps + 1)]);
    for i in 0..=steps {
        for j in 0..=steps {
            if quad || i + j <= steps {
                numbers[i * (steps + 1) + j] = points.len();
                points.push([i, j].map(|x| x as f64 / steps as f64));
            }
        }
    }
    let number = |i: usize, j: usize| numbers[i * (steps + 1) + j];
    let mut triangles = Vec::new();
    for i in 0..steps {
        for j in 0..steps {
            if quad || i + j < steps {
                triangles.push([number(i, j), number(i + 1, j), number(i, j + 1)]);
            }
            if quad || i + j + 1 < steps {
                triangles.push([number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]);
            }
        }
    }
    (points, triangles)
}

/// The sides of a face.
fn rim_lines(kind: SplitKind) -> Vec<Vec<[f64; 2]>> {
    let corners: &[[f64; 2]] = match kind {
        SplitKind::Quad => &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        SplitKind::Triangle => &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
    };
    let n = corners.len();
    let side = |i: usize| -> Vec<[f64; 2]> {
        let (a, b) = (corners[i], corners[(i + 1) % n]);
        let at = |x: f64| [0, 1].map(|k| (a[k] + x * (b[k] - a[k])).clamp(0.0, 1.0));
        (0..=12).map(|j| at(f64::from(j) / 12.0)).collect()
    };
    (0..n).map(side).collect()
}
