//! Pictures as PNG, two pixels to a page unit.

use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};

use super::{Colour, Mark, Picture, Point, font};
use crate::Failure;

const SCALE: f32 = 2.0;

pub fn encode(picture: &Picture) -> Result<Vec<u8>, Failure> {
    let size = [picture.width, picture.height].map(|x| (x as f32 * SCALE).ceil() as u32);
    let mut pixels = Pixmap::new(size[0], size[1]).ok_or("the picture is too large: draw fewer valences")?;
    pixels.fill(Color::WHITE);
    for mark in &picture.marks {
        match mark {
            Mark::Fill { polygons, colour } => {
                if let Some(path) = path(polygons, true) {
                    let transform = Transform::from_scale(SCALE, SCALE);
                    pixels.fill_path(&path, &paint(*colour), FillRule::EvenOdd, transform, None);
                    // As in SVG: a hair closes the seams between neighbours.
                    stroke(&mut pixels, polygons, *colour, 0.5, true);
                }
            }
            Mark::Lines { lines, colour, width } => stroke(&mut pixels, lines, *colour, *width, false),
            Mark::Dot { at, radius, colour } => {
                let [x, y] = at.map(|x| x as f32);
                if let Some(path) = PathBuilder::from_circle(x, y, *radius as f32) {
                    let transform = Transform::from_scale(SCALE, SCALE);
                    pixels.fill_path(&path, &paint(*colour), FillRule::Winding, transform, None);
                }
            }
            Mark::Text { at, text, size, colour, anchor } => {
                let strokes = font::strokes(text, *at, *size, *anchor);
                stroke(&mut pixels, &strokes, *colour, size / 11.0, false);
            }
        }
    }
    Ok(pixels.encode_png().map_err(|error| format!("the picture cannot be encoded ({error})"))?)
}

fn paint(c: Colour) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(c[0], c[1], c[2], 255);
    paint
}

fn path(lines: &[Vec<Point>], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for line in lines.iter().filter(|line| line.len() > 1) {
        for (i, p) in line.iter().enumerate() {
            let [x, y] = p.map(|x| x as f32);
            if i == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
        }
        if closed {
            builder.close();
        }
    }
    builder.finish()
}

fn stroke(pixels: &mut Pixmap, lines: &[Vec<Point>], colour: Colour, width: f64, closed: bool) {
    let stroke = Stroke {
        width: width as f32,
        line_cap: LineCap::Round,
        line_join: LineJoin::Round,
        ..Stroke::default()
    };
    if let Some(path) = path(lines, closed) {
        pixels.stroke_path(&path, &paint(colour), &stroke, Transform::from_scale(SCALE, SCALE), None);
    }
}
