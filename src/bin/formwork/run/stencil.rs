use formwork::analysis::{CharacteristicMap, Ring};
use serde_json::json;

use super::basis::cell_of;
use super::{Outcome, size_of};
use crate::Failure;
use crate::args::{Stencil, scheme_name};
use crate::draw::{ACCENT, GREY, INK, PALE, Panel, Picture, Point, extent};
use crate::job::{check_outputs, format_of};

const SIDE: f64 = 560.0;
const MARGIN: f64 = 30.0;

/// A weight and the cell that it is of.
type Term = (usize, f64);

pub fn run(args: &Stencil) -> Result<Outcome, Failure> {
    if let Some(output) = &args.output {
        format_of(output, &["svg", "png"])?;
        check_outputs(&[], std::slice::from_ref(output))?;
    }
    let (faces, degree) = (usize::from(args.valence), usize::from(args.cell.degree));
    let ring = Ring::new(args.vertex.scheme(), faces, args.vertex.boundary, 2)?;
    let (cell, sign, what) = cell_of(&ring, &args.cell)?;
    let row = ring.operator(degree).row(cell) * sign;
    let terms: Vec<Term> = row.iter().copied().enumerate().filter(|(_, w)| w.abs() > 1e-12).collect();
    let factor = factor(&terms);
    let name = scheme_name(args.vertex.scheme());
    let place = if args.vertex.boundary { "boundary valence" } else { "valence" };
    let title = format!("{name}, {place} {faces}: row of S{degree} of {what}{}", times(factor));
    let edges = ring.edges();
    let mut text = format!("{title}\n");
    for &(c, w) in &terms {
        let of = match degree {
            0 => format!("vertex {c}"),
            1 => format!("edge {}-{}", edges[c][0], edges[c][1]),
            _ => format!("face {c}"),
        };
        text += &format!("  {of:<12}{:>10}\n", number(w, factor));
    }
    if let Some(output) = &args.output {
        let map = CharacteristicMap::new(ring)?;
        picture(&map, degree, cell, sign, &terms, factor, &title).save(output)?;
        text += &format!("wrote {}{}\n", output.display(), size_of(output));
    }
    let json = json!({
        "command": "stencil",
        "scheme": name,
        "valence": faces,
        "boundary": args.vertex.boundary,
        "degree": degree,
        "cell": cell,
        "terms": terms.iter().map(|&(c, w)| match degree {
            1 => json!({ "edge": edges[c], "weight": w }),
            _ => json!({ "cell": c, "weight": w }),
        }).collect::<Vec<_>>(),
        "edges": edges,
        "written": args.output.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
    });
    Ok(Outcome { text, json, notes: Vec::new(), holds: true })
}

/// The least number that makes all weights whole, if there is one among those that subdivision has; else 1.
fn factor(terms: &[Term]) -> f64 {
    let candidates =
        (0..=9).map(|p| f64::from(1u32 << p)).flat_map(|d| [d, 3.0 * d, 5.0 * d, 7.0 * d, 9.0 * d, 25.0 * d]);
    let mut candidates: Vec<f64> = candidates.collect();
    candidates.sort_by(f64::total_cmp);
    // OpenSubdiv's Loop weights are those of a cosine in single precision.
    let whole = |d: &f64| terms.iter().all(|(_, w)| (w * d - (w * d).round()).abs() < 1e-7 * d);
    candidates.into_iter().filter(|d| *d <= 2048.0).find(whole).unwrap_or(1.0)
}

fn times(factor: f64) -> String {
    if factor == 1.0 { String::new() } else { format!(", times {factor}") }
}

fn number(weight: f64, factor: f64) -> String {
    let w = weight * factor;
    if (w - w.round()).abs() < 1e-3 && (factor > 1.0 || w.abs() > 0.5) {
        return format!("{}", w.round());
    }
    format!("{w:.4}")
}

fn middle(points: &[Point]) -> Point {
    [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / points.len() as f64)
}

fn picture(
    map: &CharacteristicMap,
    degree: usize,
    cell: usize,
    sign: f64,
    terms: &[Term],
    factor: f64,
    title: &str,
) -> Picture {
    let ring = map.ring();
    let d = ring.descriptor();
    let control: Vec<Point> = map.control().iter().map(|p| [p.x, p.y]).collect();
    let [a, b] = map.eigenvalues();
    let [low, high] = extent(control.iter().copied());
    let tall = SIDE * ((high[1] - low[1]) / (high[0] - low[0])).clamp(0.3, 1.0);
    let mut picture = Picture::new(SIDE + 2.0 * MARGIN, tall + 2.0 * MARGIN + 30.0);
    let panel = Panel::around(control.iter().copied(), [MARGIN, MARGIN], [SIDE, tall]);
    // The rings of the next level are the same, smaller.
    let parent = |v: u32| panel.place(control[v as usize]);
    let child = |v: u32| panel.place([a * control[v as usize][0], b * control[v as usize][1]]);
    let edges = ring.edges();
    let size = d.face_sizes[0] as usize;
    let face = |f: usize| &d.face_vertices[f * size..(f + 1) * size];
    picture.lines(edges.iter().map(|e| e.map(child).to_vec()).collect(), PALE, 0.5);
    picture.lines(edges.iter().map(|e| e.map(parent).to_vec()).collect(), GREY, 1.0);
    let mut labels = Vec::new();
    for &(c, w) in terms {
        let at = match degree {
            0 => parent(c as u32),
            1 => {
                let [p, q] = edges[c].map(parent);
                let along = |x: f64| [0, 1].map(|k| p[k] + x * (q[k] - p[k]));
                picture.arrow(vec![along(0.06), along(0.94)], INK, 1.3);
                along(0.62)
            }
            _ => middle(&face(c).iter().map(|&v| parent(v)).collect::<Vec<_>>()),
        };
        labels.push((at, number(w, factor)));
    }
    match degree {
        0 => picture.dot(child(cell as u32), 6.0, ACCENT),
        1 => {
            let [p, q] = edges[cell].map(child);
            picture.arrow(if sign > 0.0 { vec![p, q] } else { vec![q, p] }, ACCENT, 3.2);
        }
        _ => {
            let corners: Vec<Point> = face(cell).iter().map(|&v| child(v)).collect();
            let rim = [corners.clone(), vec![corners[0]]].concat();
            picture.lines(vec![rim], ACCENT, 3.2);
        }
    }
    for (at, text) in labels {
        label(&mut picture, at, &text);
    }
    picture.text([SIDE / 2.0 + MARGIN, tall + 2.0 * MARGIN + 10.0], title, 14.0, INK, 0.5);
    picture
}

/// A number on white.
fn label(picture: &mut Picture, at: Point, text: &str) {
    let half = [4.6 * text.len() as f64 + 1.0, 8.0];
    let corner = |x: f64, y: f64| [at[0] + x * half[0], at[1] + y * half[1]];
    let polygons = vec![vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]];
    picture.marks.push(crate::draw::Mark::Fill { polygons, colour: [255, 255, 255] });
    picture.text([at[0], at[1] + 5.0], text, 14.0, INK, 0.5);
}
