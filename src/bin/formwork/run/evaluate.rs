use std::path::Path;

use formwork::cochain::Cochain;
use formwork::field;
use formwork::io::npz::{self, Array};
use formwork::io::{Format, Frames, atomic, points};
use formwork::limit::{LimitSurface, SurfacePoint};
use formwork::topology::{Mesh, SplitKind};
use nalgebra::Vector3;
use serde_json::json;

use super::{Outcome, count, progress_bar, size_of};
use crate::Failure;
use crate::args::{Evaluate, scheme_name};
use crate::job::{Job, check_outputs, format_of};

pub fn run(args: &Evaluate) -> Result<Outcome, Failure> {
    let format = format_of(&args.output, &["json", "npz"])?;
    let mut job = Job::settle_for(&args.common, Frames::Rest, Some(Format::Json))?;
    let mut inputs = vec![args.common.mesh.as_path()];
    inputs.extend(args.field.as_deref());
    inputs.extend(args.points.as_deref());
    check_outputs(&inputs, std::slice::from_ref(&args.output))?;
    let fields = job.fields(args.field.as_deref())?;
    let given = args.points.as_deref().map(points::read).transpose()?;

    let bar = progress_bar(job.progress, 1, "refining");
    let surface = LimitSurface::new(&job.cage, job.scheme)?;
    bar.set_message("evaluating");
    let (mesh, kind) = (surface.hierarchy().level(0).mesh(), surface.hierarchy().split_kind());
    let points = match (&given, args.per_face) {
        (Some(given), _) => listed(given, &name(args.points.as_deref()), mesh, kind)?,
        (None, per_face) => per_face_points(mesh, kind, per_face.unwrap_or(1)),
    };
    for (number, point) in points.iter().enumerate() {
        let place = |error: formwork::limit::PointError| {
            format!("{}: points[{number}]: {error}", name(args.points.as_deref()))
        };
        surface.check(point).map_err(place)?;
    }
    let positions = surface.refine(&job.asset.positions);
    let x = surface.evaluate_0(&positions, &points)?;
    let tangents: Vec<[Vector3<f64>; 2]> = x.iter().map(|jet| jet.derivatives).collect();
    let mut columns = Columns::default();
    columns.vectors("positions", x.iter().map(|jet| jet.value).collect());
    for (i, name) in ["tangents_s", "tangents_t"].into_iter().enumerate() {
        columns.vectors(name, tangents.iter().map(|tangents| tangents[i]).collect());
    }
    if let Some(form) = &fields.form0 {
        let jets = surface.evaluate_0(&surface.refine(form), &points)?;
        columns.numbers("form0", 1, jets.iter().map(|jet| jet.value).collect());
    }
    if let Some(form) = &fields.form1 {
        let form: Cochain<1> = surface.refine(form);
        let jets = surface.evaluate_1(&form, &points)?;
        let components = |jet: &[formwork::limit::Jet<f64>; 2]| jet.map(|component| component.value);
        columns.numbers("form1", 2, jets.iter().flat_map(components).collect());
        let slopes = jets.iter().flatten().flat_map(|component| component.derivatives);
        columns.numbers("form1_derivatives", 4, slopes.collect());
        let sharp = |(jet, &tangents)| field::sharp(tangents, components(jet));
        columns.vectors("vector", jets.iter().zip(&tangents).map(sharp).collect());
        let curl = jets.iter().map(|[s, t]| t.derivatives[0] - s.derivatives[1]);
        columns.numbers("curl", 1, curl.collect());
    }
    if let Some(form) = &fields.form2 {
        let densities = surface.evaluate_2(&surface.refine(form), &points)?;
        columns.numbers("form2", 1, densities);
    }
    write(format, &args.output, &points, &columns)?;

    let text = format!(
        "{}: {} on the limit surface, refined {} for it\nwrote {}{}\n",
        job.asset.name,
        count(points.len(), "point"),
        count(surface.hierarchy().num_levels(), "time"),
        args.output.display(),
        size_of(&args.output)
    );
    let json = json!({
        "command": "evaluate",
        "mesh": job.asset.name,
        "scheme": scheme_name(job.scheme),
        "points": points.len(),
        "levels": surface.hierarchy().num_levels(),
        "quantities": columns.0.iter().map(|column| column.name).collect::<Vec<_>>(),
        "written": [args.output.display().to_string()],
    });
    Ok(Outcome { text, json, notes: job.asset.notes.clone(), holds: true })
}

fn name(path: Option<&Path>) -> String {
    path.map_or("--per-face".to_owned(), |path| path.display().to_string())
}

/// The points of a file. On a polygon that is split into quads a point needs its corner.
pub fn listed(
    given: &[points::Point],
    file: &str,
    mesh: &Mesh,
    kind: SplitKind,
) -> Result<Vec<SurfacePoint>, Failure> {
    let settle = |(number, point): (usize, &points::Point)| {
        let polygon = (point.face as usize) < mesh.num_faces()
            && kind == SplitKind::Quad
            && mesh.face_size(point.face) != 4;
        if polygon && point.corner.is_none() {
            let size = mesh.face_size(point.face);
            let face = point.face;
            return Err(format!(
                "{file}: points[{number}]: face {face} has {size} corners, and each has parameters of its own: write [{face}, corner, s, t]"
            )
            .into());
        }
        let corner = point.corner.unwrap_or(0);
        Ok(SurfacePoint { face: point.face, corner, s: point.s, t: point.t })
    };
    given.iter().enumerate().map(settle).collect()
}

/// `k x k` points inside every face.
fn per_face_points(mesh: &Mesh, kind: SplitKind, k: u32) -> Vec<SurfacePoint> {
    let mut points = Vec::new();
    let at = |i: u32, offset: f64| (f64::from(i) + offset) / f64::from(k);
    for face in 0..mesh.num_faces() as u32 {
        let corners = match kind {
            SplitKind::Quad if mesh.face_size(face) != 4 => mesh.face_size(face) as u32,
            _ => 1,
        };
        for corner in 0..corners {
            for (i, j) in (0..k).flat_map(|j| (0..k).map(move |i| (i, j))) {
                let mut add = |s, t| points.push(SurfacePoint { face, corner, s, t });
                match kind {
                    SplitKind::Quad => add(at(i, 0.5), at(j, 0.5)),
                    SplitKind::Triangle => {
                        if i + j < k {
                            add(at(i, 1.0 / 3.0), at(j, 1.0 / 3.0));
                        }
                        if i + j + 1 < k {
                            add(at(i, 2.0 / 3.0), at(j, 2.0 / 3.0));
                        }
                    }
                }
            }
        }
    }
    points
}

/// What was evaluated, a row for each point.
#[derive(Default)]
struct Columns(Vec<Column>);

struct Column {
    name: &'static str,
    width: usize,
    values: Vec<f64>,
}

impl Columns {
    fn numbers(&mut self, name: &'static str, width: usize, values: Vec<f64>) {
        self.0.push(Column { name, width, values });
    }

    fn vectors(&mut self, name: &'static str, values: Vec<Vector3<f64>>) {
        self.numbers(name, 3, values.iter().flat_map(|v| [v.x, v.y, v.z]).collect());
    }
}

fn write(format: &str, path: &Path, points: &[SurfacePoint], columns: &Columns) -> Result<(), Failure> {
    if format == "npz" {
        let faces: Vec<u32> = points.iter().flat_map(|point| [point.face, point.corner]).collect();
        let parameters: Vec<f64> = points.iter().flat_map(|point| [point.s, point.t]).collect();
        let (n, pair) = ([points.len()], [points.len(), 2]);
        let shapes: Vec<[usize; 2]> = columns.0.iter().map(|column| [n[0], column.width]).collect();
        let mut arrays = vec![
            ("faces", &pair[..], Array::Indices(&faces)),
            ("parameters", &pair[..], Array::Floats(&parameters)),
        ];
        for (column, shape) in columns.0.iter().zip(&shapes) {
            let shape = if column.width == 1 { &shape[..1] } else { &shape[..] };
            arrays.push((column.name, shape, Array::Floats(&column.values)));
        }
        return Ok(npz::write_arrays(path, &arrays)?);
    }
    let rows = |column: &Column| -> serde_json::Value {
        match column.width {
            1 => json!(column.values),
            width => column.values.chunks(width).map(|row| json!(row)).collect(),
        }
    };
    let mut object = serde_json::Map::new();
    let listed = points.iter().map(|point| json!([point.face, point.corner, point.s, point.t]));
    object.insert("points".to_owned(), listed.collect());
    for column in &columns.0 {
        object.insert(column.name.to_owned(), rows(column));
    }
    Ok(atomic::write(path, |out| Ok(serde_json::to_writer(out, &object)?))?)
}
