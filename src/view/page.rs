use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use nalgebra::Vector3;
use serde_json::{Value, json};

use super::camera::{DISTANCE, TOWARDS_EYE};
use super::picture::{ARROW, ARROW_LENGTHS, ARROW_POINTS};
use super::{Level, Shown, Stroke, View, colour};

const PAGE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/page.css");
const SHADERS: &str = include_str!("page/shaders.js");
const SCRIPT: &str = include_str!("page/page.js");
/// three.js, made by `scripts/three`.
const THREE: &str = include_str!("page/three/three.min.js");
/// Its licence goes wherever it goes.
const LICENCE: &str = include_str!("page/three/LICENSE");

impl View {
    /// One page for a browser that holds everything and asks for nothing: all levels, numbers of 16 bits in base64.
    ///
    /// `name` is its heading.
    pub fn page(&self, name: &str) -> String {
        // JSON in a script must not end it, nor open a comment.
        let data = self.data(name).to_string().replace('<', "\\u003c");
        let mut page = PAGE.to_owned();
        let title = name.replace('&', "&amp;").replace('<', "&lt;");
        let parts = [
            ("style", STYLE),
            ("licence", LICENCE),
            ("three", THREE),
            ("shaders", SHADERS),
            ("script", SCRIPT),
            // Last: in these, whatever looks like a mark stays.
            ("data", &*data),
            ("title", &*title),
        ];
        for (mark, part) in parts {
            page = page.replacen(&format!("{{{{{mark}}}}}"), part, 1);
        }
        page
    }

    fn data(&self, name: &str) -> Value {
        let form = |shown: &Shown| {
            let ramp = shown.ramp.stops();
            let bands = if shown.ramp == colour::Ramp::Height { colour::BANDS } else { 0.0 };
            json!({ "name": shown.name, "unit": shown.unit, "range": shown.range, "scale": shown.scale,
                "ramp": ramp, "bands": bands })
        };
        let layers = &self.layers;
        json!({
            "name": name,
            "bounds": self.bounds.map(|p| [p.x, p.y, p.z]),
            "size": self.size(),
            "view": { "towards": TOWARDS_EYE, "distance": DISTANCE },
            "colours": {
                "surface": colour::SURFACE, "crease": colour::CREASE, "cage": colour::CAGE, "zeros": colour::ZEROS,
                "lights": colour::LIGHTS, "brightness": colour::BRIGHTNESS,
            },
            "forms": self.forms.each_ref().map(|shown| shown.as_ref().map(form)),
            "degree": self.degree,
            "layers": {
                "strokes": layers.strokes, "arrows": layers.arrows, "cage": layers.cage,
                "creases": layers.creases, "zeros": layers.zeros, "mesh": layers.mesh,
            },
            "levels": self.levels.iter().map(|level| self.level(level)).collect::<Vec<_>>(),
            "cage": self.places(self.cage.iter().flatten()),
            "creases": {
                "points": self.places(self.creases.iter().flat_map(|(ends, _)| ends)),
                "sharpness": bytes_of(self.creases.iter().map(|(_, sharpness)| (sharpness * 25.5) as u8)),
            },
            "strokes": self.strokes_of(),
            "arrows": {
                "at": self.places(self.arrows.iter().map(|arrow| &arrow.position)),
                "vectors": words(self.arrows.iter().flat_map(|arrow| {
                    let vector = arrow.vector / arrow.vector.norm();
                    [vector, arrow.normal].into_iter().flat_map(signed)
                })),
                "speeds": words(self.arrows.iter().map(|arrow| self.part(1, arrow.vector.norm()))),
                "shape": ARROW.map(|t| t.map(|i| ARROW_POINTS[i])),
                "lengths": ARROW_LENGTHS,
            },
            "zeros": self.zeros.iter().map(|zero| {
                json!({ "at": [zero.position.x, zero.position.y, zero.position.z], "index": zero.index })
            }).collect::<Vec<_>>(),
            "notes": self.notes,
        })
    }

    fn level(&self, level: &Level) -> Value {
        let sizes = &level.face_sizes;
        let uniform = sizes.iter().all(|&size| size == sizes[0]).then(|| sizes[0]);
        let wide = level.vertices.len() > usize::from(u16::MAX);
        let indices = match wide {
            true => {
                STANDARD.encode(level.face_vertices.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())
            }
            false => words(level.face_vertices.iter().map(|&v| v as u16)),
        };
        let values = [0, 1, 2].map(|degree| {
            let of = || words(level.vertices.iter().map(|v| self.part(degree, v.values[degree])));
            self.forms[degree].is_some().then(of)
        });
        json!({
            "vertices": level.vertices.len(),
            "faces": sizes.len(),
            "size": uniform,
            "sizes": uniform.is_none().then(|| words(sizes.iter().map(|&size| size.min(65535) as u16))),
            "wide": wide,
            "indices": indices,
            "positions": self.places(level.vertices.iter().map(|v| &v.position)),
            "normals": words(level.vertices.iter().flat_map(|v| signed(v.normal))),
            "values": values,
        })
    }

    fn strokes_of(&self) -> Value {
        // Time counts in crossings of the surface at full speed.
        let crossing = self.size() / self.forms[1].as_ref().map_or(1.0, |shown| shown.scale[1]);
        let last = |stroke: &Stroke| stroke.times.last().copied().unwrap_or(0.0);
        let longest = self.strokes.iter().map(last).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        let points = self.strokes.iter().enumerate().flat_map(|(number, stroke)| {
            let each = stroke.points.iter().zip(&stroke.speeds).zip(&stroke.times);
            each.flat_map(move |((&p, &speed), &time)| {
                let [x, y, z] = self.place(p);
                [x, y, z, fraction(time / longest), self.part(1, speed), number as u16]
            })
        });
        json!({
            "points": words(points),
            "lasting": words(self.strokes.iter().map(|stroke| fraction(last(stroke) / longest))),
            "duration": longest / crossing,
        })
    }

    /// A place in the box, 16 bits an axis.
    fn place(&self, p: Vector3<f64>) -> [u16; 3] {
        let [low, high] = self.bounds;
        [0, 1, 2].map(|k| if high[k] > low[k] { fraction((p[k] - low[k]) / (high[k] - low[k])) } else { 0 })
    }

    fn places<'a>(&self, points: impl Iterator<Item = &'a Vector3<f64>>) -> String {
        words(points.flat_map(|&p| self.place(p)))
    }

    /// A value as a part of its form's range.
    fn part(&self, degree: usize, value: f64) -> u16 {
        let [low, high] = self.forms[degree].as_ref().map_or([0.0, 1.0], |shown| shown.range);
        if high > low { fraction((value - low) / (high - low)) } else { 0 }
    }
}

/// From `[0, 1]` to 16 bits.
fn fraction(x: f64) -> u16 {
    (65535.0 * x.clamp(0.0, 1.0)).round() as u16
}

/// A unit vector as three signed numbers of 16 bits.
fn signed(v: Vector3<f64>) -> [u16; 3] {
    [v.x, v.y, v.z].map(|x| (32767.0 * x.clamp(-1.0, 1.0)).round() as i16 as u16)
}

fn words(values: impl Iterator<Item = u16>) -> String {
    STANDARD.encode(values.flat_map(u16::to_le_bytes).collect::<Vec<u8>>())
}

fn bytes_of(values: impl Iterator<Item = u8>) -> String {
    STANDARD.encode(values.collect::<Vec<u8>>())
}
