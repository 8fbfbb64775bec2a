use std::path::PathBuf;

use formwork::hierarchy::Hierarchy;
use formwork::io::fields::{self, Fields};
use formwork::io::{Surface, glb, json, obj};
use serde_json::json;

use super::{Outcome, count, progress_bar, size_of, work};
use crate::Failure;
use crate::args::{Subdivide, scheme_name};
use crate::job::{Job, check_outputs, format_of};

const FORMATS: [&str; 3] = ["glb", "json", "obj"];

pub fn run(args: &Subdivide) -> Result<Outcome, Failure> {
    let format = format_of(&args.output, &FORMATS)?;
    let levels = usize::from(args.levels);
    let job = Job::settle(&args.common)?;
    let mut inputs = vec![args.common.mesh.as_path()];
    inputs.extend(args.field.as_deref());
    let mut outputs = vec![args.output.clone()];
    if format == "obj" && args.field.is_some() {
        outputs.push(obj::fields_path(&args.output));
    }
    check_outputs(&inputs, &outputs)?;

    let fields = match &args.field {
        None => Fields::default(),
        // The cage alone is quick to build, and a mistake in the field is then known at once.
        Some(path) => fields::read(path, Hierarchy::new(&job.cage, job.scheme, 0)?.level(0).mesh())?,
    };

    let bar = progress_bar(job.progress, levels, "refining");
    let hierarchy =
        Hierarchy::with_progress(&job.cage, job.scheme, levels, |level| bar.set_position(work(level)))?;
    bar.set_message("writing ");
    let positions = hierarchy.subdivide(&job.asset.positions);
    let refined = Fields {
        form0: fields.form0.as_ref().map(|form| hierarchy.subdivide(form)),
        form1: fields.form1.as_ref().map(|form| hierarchy.subdivide(form)),
        form2: fields.form2.as_ref().map(|form| hierarchy.subdivide(form)),
    };
    let finest = hierarchy.finest();
    let surface = Surface::new(levels, finest.mesh(), &positions, &refined, &finest.tags().face_hole)?;
    let written = write(format, &args.output, &surface)?;
    let mut outcome = outcome(&job, &surface, &written);
    if format == "glb" && refined.form2.is_some() {
        outcome.notes.push("glTF has no place for the 2-form: write .json or .obj to keep it".to_owned());
    }
    Ok(outcome)
}

fn write(format: &str, path: &std::path::Path, surface: &Surface) -> Result<Vec<PathBuf>, Failure> {
    match format {
        "obj" => return Ok(obj::write(path, surface)?),
        "json" => json::write(path, surface)?,
        _ => glb::write(path, surface)?,
    }
    Ok(vec![path.to_owned()])
}

fn outcome(job: &Job, surface: &Surface, written: &[PathBuf]) -> Outcome {
    let mesh = surface.mesh();
    let left_out = mesh.num_faces() - surface.faces().len();
    let counts = [
        count(mesh.num_vertices(), "vertex"),
        count(surface.edges().len(), "edge"),
        count(surface.faces().len(), "face"),
    ];
    let mut text = format!("{}, level {}: {}", job.asset.name, surface.level(), counts.join(", "));
    if left_out > 0 {
        text += &format!(" ({} left out as holes)", count(left_out, "face"));
    }
    text.push('\n');
    for (i, path) in written.iter().enumerate() {
        let remark = if i == 0 { "" } else { ", the forms: OBJ has no place for them" };
        text += &format!("wrote {}{}{remark}\n", path.display(), size_of(path));
    }
    let fields = surface.fields();
    let forms = [fields.form0.is_some(), fields.form1.is_some(), fields.form2.is_some()];
    let json = json!({
        "command": "subdivide",
        "mesh": job.asset.name,
        "scheme": scheme_name(job.scheme),
        "level": surface.level(),
        "vertices": mesh.num_vertices(),
        "edges": surface.edges().len(),
        "faces": surface.faces().len(),
        "faces_left_out": left_out,
        "forms": (0..3).filter(|&k| forms[k]).collect::<Vec<usize>>(),
        "written": written.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
    });
    Outcome { text, json, notes: job.asset.notes.clone(), holds: true }
}
