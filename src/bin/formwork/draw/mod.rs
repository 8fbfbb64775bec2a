//! Line drawings, as SVG and PNG.
//!
//! A [`Picture`] is a list of marks in page units, y downwards. A [`Panel`] places a part of the plane, y upwards, on the page.

mod field;
mod font;
mod png;
mod svg;

use std::io::Write;
use std::path::Path;

pub use field::{Grid, legend};

use crate::Failure;
use formwork::io::atomic;

pub type Point = [f64; 2];
pub type Colour = [u8; 3];

pub const INK: Colour = [38, 38, 42];
pub const GREY: Colour = [150, 150, 155];
pub const PALE: Colour = [205, 205, 208];
pub const ACCENT: Colour = [176, 51, 47];

/// One mark, in page units.
pub enum Mark {
    /// Polygons of one colour.
    Fill { polygons: Vec<Vec<Point>>, colour: Colour },
    /// Open lines of one colour and width.
    Lines { lines: Vec<Vec<Point>>, colour: Colour, width: f64 },
    /// A disk.
    Dot { at: Point, radius: f64, colour: Colour },
    /// A line of text with its baseline at a point: where in the text that is, 0 at its start, 1 at its end.
    Text { at: Point, text: String, size: f64, colour: Colour, anchor: f64 },
}

/// A page.
pub struct Picture {
    pub width: f64,
    pub height: f64,
    pub marks: Vec<Mark>,
}

impl Picture {
    /// A white page.
    pub fn new(width: f64, height: f64) -> Self {
        Picture { width, height, marks: Vec::new() }
    }

    pub fn text(&mut self, at: Point, text: impl Into<String>, size: f64, colour: Colour, anchor: f64) {
        self.marks.push(Mark::Text { at, text: text.into(), size, colour, anchor });
    }

    pub fn lines(&mut self, lines: Vec<Vec<Point>>, colour: Colour, width: f64) {
        self.marks.push(Mark::Lines { lines, colour, width });
    }

    /// An arrow along a line, its head at the end.
    pub fn arrow(&mut self, line: Vec<Point>, colour: Colour, width: f64) {
        let [.., before, tip] = line[..] else { return };
        let [x, y] = [tip[0] - before[0], tip[1] - before[1]];
        let length = x.hypot(y).max(1e-9);
        let [x, y] = [x, y].map(|d| 4.0 * width * d / length);
        let head = |side: f64| [tip[0] - x - side * 0.45 * y, tip[1] - y + side * 0.45 * x];
        self.lines(vec![line, vec![head(1.0), tip, head(-1.0)]], colour, width);
    }

    pub fn dot(&mut self, at: Point, radius: f64, colour: Colour) {
        self.marks.push(Mark::Dot { at, radius, colour });
    }

    /// Writes the picture in the format of the file's name, complete or not at all.
    pub fn save(&self, path: &Path) -> Result<(), Failure> {
        let is_png = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        let bytes = if is_png { png::encode(self)? } else { svg::encode(self).into_bytes() };
        Ok(atomic::write(path, |out| out.write_all(&bytes))?)
    }
}

/// Where a part of the plane goes on a page.
#[derive(Clone, Copy)]
pub struct Panel {
    scale: f64,
    origin: Point,
}

impl Panel {
    /// The box around some points, as large as fits into `size` at `corner` (top left) and in its middle.
    pub fn around(points: impl IntoIterator<Item = Point>, corner: Point, size: Point) -> Self {
        let [low, high] = extent(points);
        let scale = (0..2).map(|k| size[k] / (high[k] - low[k]).max(1e-9)).fold(f64::INFINITY, f64::min);
        let middle = [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0];
        let origin =
            [corner[0] + size[0] / 2.0 - scale * middle[0], corner[1] + size[1] / 2.0 + scale * middle[1]];
        Panel { scale, origin }
    }

    pub fn place(&self, p: Point) -> Point {
        [self.origin[0] + self.scale * p[0], self.origin[1] - self.scale * p[1]]
    }

    pub fn place_all(&self, points: &[Point]) -> Vec<Point> {
        points.iter().map(|&p| self.place(p)).collect()
    }
}

/// The lowest and the highest coordinates.
pub fn extent(points: impl IntoIterator<Item = Point>) -> [Point; 2] {
    let around = |[low, high]: [Point; 2], p: Point| {
        [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
    };
    points.into_iter().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], around)
}
