use formwork::cochain::Cochain;
use formwork::io::atomic;
use formwork::nalgebra::{Vector2, Vector3};
use formwork::octet::{Hierarchy, Sampler, field};
use rayon::prelude::*;
use serde_json::json;
use tiny_skia::{Color, Paint, PathBuilder, Pixmap, PremultipliedColorU8, Stroke, Transform};

use super::{fields, load, work};
use crate::Failure;
use crate::args::volume::SliceVolume;
use crate::job::{check_outputs, format_of};
use crate::run::{Outcome, progress_bar_of, size_of};

type Vec3 = Vector3<f64>;

/// Steps of the texture along the field, each way, for a picture of 800 pixels.
const REACH: f64 = 22.0;

/// The plane, with two unit vectors in it.
struct Plane {
    centre: Vec3,
    normal: Vec3,
    across: Vec3,
    up: Vec3,
    /// Units of length a pixel.
    pixel: f64,
    size: u32,
}

impl Plane {
    fn point(&self, x: u32, y: u32) -> Vec3 {
        let half = f64::from(self.size) / 2.0;
        let [u, v] = [f64::from(x) + 0.5 - half, half - f64::from(y) - 0.5];
        self.centre + (self.across * u + self.up * v) * self.pixel
    }

    fn pixel_of(&self, p: Vec3) -> [f32; 2] {
        let half = f64::from(self.size) / 2.0;
        let place = (p - self.centre) / self.pixel;
        [(half + place.dot(&self.across)) as f32, (half - place.dot(&self.up)) as f32]
    }
}

/// What a pixel shows: how much, and which way in the plane.
#[derive(Clone, Copy)]
struct Sample {
    amount: f64,
    direction: Vector2<f64>,
}

pub fn run(args: &SliceVolume) -> Result<Outcome, Failure> {
    let (mesh, levels) = (&args.common.mesh, usize::from(args.levels));
    format_of(&args.output, &["png"])?;
    let mut inputs = vec![mesh.as_path()];
    inputs.extend(args.refining.field.as_deref());
    check_outputs(&inputs, std::slice::from_ref(&args.output))?;
    let mut solid = load(mesh)?;
    let fields = fields(&mut solid, mesh, args.refining.field.as_deref())?;
    let there = fields.degrees();
    let form = args
        .form
        .map(usize::from)
        .or_else(|| there.iter().copied().find(|&r| r > 0).or(there.first().copied()));
    let Some(form) = form.filter(|form| there.contains(form)) else {
        let wanted = args.form.map_or("form".to_owned(), |k| format!("{k}-form"));
        return Err(format!("{}: there is no {wanted} on it: give one with --field", mesh.display()).into());
    };

    let bar = progress_bar_of(!args.common.quiet && !args.common.json, work(levels), "refining");
    let scheme = args.refining.scheme.scheme();
    let hierarchy = Hierarchy::with_progress(solid.complex.clone(), scheme, levels, |level| {
        bar.set_position(work(level))
    })?;
    bar.set_message("drawing ");
    let positions = hierarchy.subdivide(&solid.positions);
    let plane = plane(args, &positions, &solid.positions);
    let sampler = Sampler::new(hierarchy.finest(), &positions);
    let amount = |amount: f64| Sample { amount, direction: Vector2::zeros() };
    let vector = |v: Vec3| Sample {
        amount: v.norm(),
        direction: Vector2::new(v.dot(&plane.across), -v.dot(&plane.up)),
    };
    let samples: Vec<Option<Sample>> = match form {
        0 => {
            let form = refined(&hierarchy, fields.form0);
            raster(&plane, |p| sampler.value(&form, p).map(amount))
        }
        1 => {
            let form = refined(&hierarchy, fields.form1);
            raster(&plane, |p| sampler.vector(&form, p).map(vector))
        }
        2 => {
            let form = refined(&hierarchy, fields.form2);
            raster(&plane, |p| sampler.flux(&form, p).map(vector))
        }
        _ => {
            let form = refined(&hierarchy, fields.form3);
            raster(&plane, |p| sampler.density(&form, p).map(amount))
        }
    };
    let covered = samples.iter().flatten().count();
    let range = range(&samples);
    let mut picture =
        paint(&plane, &samples, range).ok_or("the picture is too large: choose a smaller --size")?;
    outline(&mut picture, &plane, &hierarchy, &solid.positions);
    let png = picture.encode_png().map_err(|error| format!("the picture cannot be encoded ({error})"))?;
    atomic::write(&args.output, |out| std::io::Write::write_all(out, &png))?;
    bar.finish_and_clear();

    let [low, high] = range;
    let text = format!(
        "{}, level {levels}: {form}-form from {low:.4e} to {high:.4e} on the plane\nwrote {}{}\n",
        mesh.display(),
        args.output.display(),
        size_of(&args.output)
    );
    let json = json!({
        "command": "volume slice",
        "mesh": mesh.display().to_string(),
        "level": levels,
        "form": form,
        "range": range,
        "pixels": covered,
        "written": [args.output.display().to_string()],
    });
    Ok(Outcome { text, json, notes: solid.notes, holds: true })
}

/// The form on the finest level; there is one.
fn refined<const K: usize>(hierarchy: &Hierarchy, form: Option<Cochain<K>>) -> Cochain<K> {
    hierarchy.subdivide(&form.unwrap_or_default())
}

/// Through the refined solid, wide enough for the control mesh too.
fn plane(args: &SliceVolume, positions: &Cochain<0, Vec3>, control: &Cochain<0, Vec3>) -> Plane {
    let normal = Vec3::from(args.normal).normalize();
    let points = || positions.values().iter().copied();
    let low = points().reduce(|a, b| a.inf(&b)).unwrap_or_default();
    let high = points().reduce(|a, b| a.sup(&b)).unwrap_or_default();
    let heights = points().map(|p| normal.dot(&p));
    let [bottom, top] = [f64::min as fn(f64, f64) -> f64, f64::max]
        .map(|choose| heights.clone().reduce(choose).unwrap_or(0.0));
    // The axis that is most square to the normal but the third one leads to the right, if it can.
    let guide = if normal.z.abs() > 0.9 { Vec3::y() } else { Vec3::z() };
    let up = (guide - normal * normal.dot(&guide)).normalize();
    let across = up.cross(&normal);
    let middle = (low + high) / 2.0;
    let centre = middle + normal * (bottom + args.at * (top - bottom) - normal.dot(&middle));
    let all = || points().chain(control.values().iter().copied());
    let reach = |axis: Vec3| all().map(|p| axis.dot(&(p - centre)).abs()).fold(0.0, f64::max);
    let half = reach(across).max(reach(up)).max(f64::MIN_POSITIVE) * 1.05;
    Plane { centre, normal, across, up, pixel: 2.0 * half / f64::from(args.size), size: args.size }
}

fn raster(plane: &Plane, sample: impl Fn(Vec3) -> Option<Sample> + Sync) -> Vec<Option<Sample>> {
    let size = plane.size;
    (0..size * size).into_par_iter().map(|i| sample(plane.point(i % size, i / size))).collect()
}

/// From the first to the last percent of the amounts: a few pixels near a singular edge would darken the rest.
fn range(samples: &[Option<Sample>]) -> [f64; 2] {
    let mut amounts: Vec<f64> = samples.iter().flatten().map(|sample| sample.amount).collect();
    amounts.sort_by(f64::total_cmp);
    let at = |part: f64| amounts.get((part * (amounts.len() as f64 - 1.0)) as usize).copied().unwrap_or(0.0);
    [at(0.01), at(0.99)]
}

fn paint(plane: &Plane, samples: &[Option<Sample>], [low, high]: [f64; 2]) -> Option<Pixmap> {
    let size = plane.size;
    let mut picture = Pixmap::new(size, size)?;
    picture.fill(Color::WHITE);
    let pixels: Vec<Option<[u8; 3]>> = (0..size * size)
        .into_par_iter()
        .map(|i| {
            let sample = samples[i as usize]?;
            let part = if high > low { ((sample.amount - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 };
            let light = match sample.direction.norm() > 0.0 {
                true => 0.62 + 0.76 * texture(size, samples, i % size, i / size),
                false => 1.0,
            };
            Some(colour(part).map(|x| (255.0 * (x * light).clamp(0.0, 1.0)) as u8))
        })
        .collect();
    for (pixel, colour) in picture.pixels_mut().iter_mut().zip(pixels) {
        if let Some([r, g, b]) = colour {
            *pixel = PremultipliedColorU8::from_rgba(r, g, b, 255)?;
        }
    }
    Some(picture)
}

/// Line integral convolution (Cabral and Leedom 1993): noise, averaged along the field through a pixel, and stretched
/// to `[0, 1]`.
fn texture(size: u32, samples: &[Option<Sample>], x: u32, y: u32) -> f64 {
    let (mut sum, mut count) = (noise(x, y), 1.0);
    let reach = (REACH * f64::from(size) / 800.0).max(6.0) as u32;
    for way in [1.0, -1.0] {
        let mut p = Vector2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        for _ in 0..reach {
            let inside = p.iter().all(|&x| (0.0..f64::from(size)).contains(&x));
            let sample = if inside { samples[(p.y as u32 * size + p.x as u32) as usize] } else { None };
            let Some(step) = sample.and_then(|sample| sample.direction.try_normalize(0.0)) else { break };
            p += step * way;
            sum += noise(p.x as u32, p.y as u32);
            count += 1.0;
        }
    }
    // The mean of n such numbers has the deviation 0.29 / sqrt n.
    (0.5 + (sum / count - 0.5) * f64::sqrt(count) * 0.8).clamp(0.0, 1.0)
}

/// Noise in blocks of two pixels.
fn noise(x: u32, y: u32) -> f64 {
    let mut hash = (x / 2).wrapping_mul(0x9e37_79b1) ^ (y / 2).wrapping_mul(0x85eb_ca77);
    hash = (hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d);
    hash = (hash ^ (hash >> 12)).wrapping_mul(0x297a_2d39);
    f64::from(hash ^ (hash >> 15)) / f64::from(u32::MAX)
}

/// From dark blue over green to yellow, even in lightness.
fn colour(part: f64) -> [f64; 3] {
    const STOPS: [[f64; 3]; 6] = [
        [0.24, 0.15, 0.45],
        [0.22, 0.35, 0.62],
        [0.16, 0.55, 0.60],
        [0.27, 0.72, 0.49],
        [0.66, 0.84, 0.27],
        [0.99, 0.93, 0.30],
    ];
    let place = part * 5.0;
    let i = (place as usize).min(4);
    std::array::from_fn(|k| STOPS[i][k] + (STOPS[i + 1][k] - STOPS[i][k]) * (place - i as f64))
}

/// The control mesh where the plane cuts it, its straight sides where smoothing has not moved them.
fn outline(picture: &mut Pixmap, plane: &Plane, hierarchy: &Hierarchy, positions: &Cochain<0, Vec3>) {
    let segments = field::cut(hierarchy.level(0), positions, plane.normal, plane.normal.dot(&plane.centre));
    let mut path = PathBuilder::new();
    for [a, b] in segments.iter().map(|ends| ends.map(|p| plane.pixel_of(p))) {
        path.move_to(a[0], a[1]);
        path.line_to(b[0], b[1]);
    }
    let mut ink = Paint::default();
    ink.set_color_rgba8(20, 20, 30, 130);
    let stroke = Stroke { width: (plane.size as f32 / 800.0).max(0.7), ..Stroke::default() };
    if let Some(path) = path.finish() {
        picture.stroke_path(&path, &ink, &stroke, Transform::identity(), None);
    }
}
