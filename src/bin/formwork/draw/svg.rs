//! Pictures as SVG.

use std::fmt::Write;

use super::{Colour, Mark, Picture, Point};

pub fn encode(picture: &Picture) -> String {
    let (w, h) = (picture.width, picture.height);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" height=\"{h}\">\n\
         <rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>\n"
    );
    for mark in &picture.marks {
        match mark {
            // A hair of the same colour closes the seams between neighbours.
            Mark::Fill { polygons, colour } => {
                let d: String = polygons.iter().map(|p| path(p, true)).collect();
                let c = hex(*colour);
                let _ = writeln!(out, "<path d=\"{d}\" fill=\"{c}\" stroke=\"{c}\" stroke-width=\".5\"/>");
            }
            Mark::Lines { lines, colour, width } => {
                let d: String = lines.iter().map(|p| path(p, false)).collect();
                let c = hex(*colour);
                let _ = writeln!(
                    out,
                    "<path d=\"{d}\" fill=\"none\" stroke=\"{c}\" stroke-width=\"{width}\" \
                     stroke-linecap=\"round\" stroke-linejoin=\"round\"/>"
                );
            }
            Mark::Dot { at, radius, colour } => {
                let [x, y] = at.map(number);
                let _ =
                    writeln!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{}\"/>", hex(*colour));
            }
            Mark::Text { at, text, size, colour, anchor } => {
                let [x, y] = at.map(number);
                let anchor = match anchor {
                    a if *a < 0.25 => "start",
                    a if *a < 0.75 => "middle",
                    _ => "end",
                };
                let text = text.replace('&', "&amp;").replace('<', "&lt;");
                let _ = writeln!(
                    out,
                    "<text x=\"{x}\" y=\"{y}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"{size}\" \
                     text-anchor=\"{anchor}\" fill=\"{}\">{text}</text>",
                    hex(*colour)
                );
            }
        }
    }
    out + "</svg>\n"
}

fn hex(c: Colour) -> String {
    format!("#{:02x}{:02x}{:02x}", c[0], c[1], c[2])
}

/// A hundredth of a page unit is finer than any screen.
fn number(x: f64) -> String {
    let text = format!("{x:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn path(points: &[Point], closed: bool) -> String {
    let mut d = String::new();
    for (i, p) in points.iter().enumerate() {
        let _ = write!(d, "{}{} {}", if i == 0 { "M" } else { "L" }, number(p[0]), number(p[1]));
    }
    if closed { d + "Z" } else { d }
}
