use std::io::Write;

use formwork::design::{End, Streamline, Tracing, seeds, streamlines};
use formwork::io::{Format, Frames, Positions, atomic, points};
use formwork::limit::LimitSurface;
use serde_json::{Value, json};

use super::{Outcome, count, evaluate, progress_bar, size_of};
use crate::Failure;
use crate::args::{Streamlines, scheme_name};
use crate::job::{Job, check_outputs, format_of};

pub fn run(args: &Streamlines) -> Result<Outcome, Failure> {
    let format = format_of(&args.output, &["json", "usda", "obj"])?;
    let mut job = Job::settle_for(&args.common, Frames::Rest, Some(Format::Json))?;
    let mut inputs = vec![args.common.mesh.as_path()];
    inputs.extend(args.field.as_deref());
    inputs.extend(args.points.as_deref());
    check_outputs(&inputs, std::slice::from_ref(&args.output))?;
    let form = job.fields(args.field.as_deref())?.form1;
    let form = form.ok_or_else(|| {
        format!("{}: there is no 1-form to follow: give one with --field", job.asset.label())
    })?;
    let given = args.points.as_deref().map(points::read).transpose()?;

    let bar = progress_bar(job.progress, 1, "tracing");
    let surface = LimitSurface::new(&job.cage, job.scheme)?;
    let (mesh, kind) = (surface.hierarchy().level(0).mesh(), surface.hierarchy().split_kind());
    let starts = match (&given, &args.points) {
        (Some(given), Some(path)) => {
            let starts = evaluate::listed(given, &path.display().to_string(), mesh, kind)?;
            for (number, point) in starts.iter().enumerate() {
                let place = |error| format!("{}: points[{number}]: {error}", path.display());
                surface.check(point).map_err(place)?;
            }
            starts
        }
        _ => seeds(&surface, &job.asset.positions, args.seeds as usize),
    };
    let size = diagonal(&job.asset.positions);
    let tracing = Tracing {
        step: args.step.min(args.length) * size,
        length: args.length * size,
        both_ways: !args.forward,
        least: 1e-6,
    };
    let lines = streamlines(&surface, &job.asset.positions, &form, &starts, &tracing)?;
    drop(bar);
    match format {
        "json" => {
            let object = json!({ "lines": lines.iter().map(listed).collect::<Vec<_>>() });
            atomic::write(&args.output, |out| Ok(serde_json::to_writer(out, &object)?))?;
        }
        "obj" => atomic::write(&args.output, |out| write_obj(out, &lines))?,
        _ => atomic::write(&args.output, |out| write_usda(out, &lines, size))?,
    }
    let num_points: usize = lines.iter().map(|line| line.points.len()).sum();
    let ends = |end: End| lines.iter().flat_map(|line| line.ends).filter(|&e| e == end).count();
    let text = format!(
        "{}: {} of {}\nwrote {}{}\n",
        job.asset.label(),
        count(lines.len(), "line"),
        count(num_points, "point"),
        args.output.display(),
        size_of(&args.output)
    );
    let json = json!({
        "command": "streamlines",
        "mesh": job.asset.name,
        "scheme": scheme_name(job.scheme),
        "lines": lines.len(),
        "points": num_points,
        "ends": {
            "length": ends(End::Length),
            "zero": ends(End::Zero),
            "boundary": ends(End::Boundary),
            "closed": ends(End::Closed),
        },
        "written": [args.output.display().to_string()],
    });
    Ok(Outcome { text, json, notes: job.asset.notes.clone(), holds: true })
}

/// The diagonal of the box round the cage; 1 if it has none.
fn diagonal(positions: &Positions) -> f64 {
    let points = positions.values();
    let first = points.first().copied().unwrap_or_default();
    let (low, high) = points.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
    Some((high - low).norm()).filter(|x| *x > 0.0).unwrap_or(1.0)
}

fn end_name(end: End) -> &'static str {
    match end {
        End::Length => "length",
        End::Zero => "zero",
        End::Boundary => "boundary",
        End::Closed => "closed",
    }
}

fn listed(line: &Streamline) -> Value {
    json!({
        "positions": line.positions.iter().map(|p| [p.x, p.y, p.z]).collect::<Vec<_>>(),
        "points": line.points.iter().map(|p| json!([p.face, p.corner, p.s, p.t])).collect::<Vec<_>>(),
        "seed": line.seed,
        "ends": line.ends.map(end_name),
    })
}

fn write_obj(out: &mut dyn Write, lines: &[Streamline]) -> std::io::Result<()> {
    let mut first = 1;
    for line in lines {
        for p in &line.positions {
            writeln!(out, "v {} {} {}", p.x, p.y, p.z)?;
        }
        write!(out, "l")?;
        for i in 0..line.positions.len() {
            write!(out, " {}", first + i)?;
        }
        writeln!(out)?;
        first += line.positions.len();
    }
    Ok(())
}

/// Linear curves; a line of one point, which USD does not take, is left out.
fn write_usda(out: &mut dyn Write, lines: &[Streamline], size: f64) -> std::io::Result<()> {
    let lines = || lines.iter().filter(|line| line.positions.len() > 1);
    let join = |items: Vec<String>| items.join(", ");
    let points = lines().flat_map(|line| &line.positions).map(|p| format!("({}, {}, {})", p.x, p.y, p.z));
    let counts = lines().map(|line| line.positions.len().to_string());
    writeln!(
        out,
        "#usda 1.0\n(\n    defaultPrim = \"Streamlines\"\n    metersPerUnit = 0.01\n    upAxis = \"Y\"\n)\n"
    )?;
    writeln!(out, "def BasisCurves \"Streamlines\"\n{{\n    uniform token type = \"linear\"")?;
    writeln!(out, "    int[] curveVertexCounts = [{}]", join(counts.collect()))?;
    writeln!(out, "    point3f[] points = [{}]", join(points.collect()))?;
    writeln!(out, "    float[] widths = [{}] (\n        interpolation = \"constant\"\n    )\n}}", size * 2e-3)
}
