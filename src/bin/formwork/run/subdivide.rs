use formwork::cochain::Cochain;
use formwork::hierarchy::Hierarchy;
use formwork::io::fields::Fields;
use formwork::io::{self, Ancestry, Frame, Frames, Pose, Positions, SaveOptions, Saved, Surface};
use serde_json::json;

use super::to_limit::ToLimit;
use super::{Outcome, count, progress_bar, size_of, work};
use crate::Failure;
use crate::args::{self, Common, Writing, scheme_name};
use crate::job::{Job, check_outputs};

/// From this sharpness on, OpenSubdiv takes an edge for infinitely sharp.
const INFINITELY_SHARP: f32 = 10.0;

/// `subdivide` and `limit`: a refined surface, as it is or on its limit.
pub struct Request {
    command: &'static str,
    levels: u8,
    on_limit: bool,
    writing: Writing,
    common: Common,
}

impl From<args::Subdivide> for Request {
    fn from(args: args::Subdivide) -> Self {
        let args::Subdivide { levels, limit, writing, common } = args;
        Request { command: "subdivide", levels, on_limit: limit, writing, common }
    }
}

impl From<args::Limit> for Request {
    fn from(args: args::Limit) -> Self {
        let args::Limit { level, writing, common } = args;
        Request { command: "limit", levels: level, on_limit: true, writing, common }
    }
}

pub fn run(args: &Request) -> Result<Outcome, Failure> {
    let (writing, mesh_file) = (&args.writing, &args.common.mesh);
    let format = io::writer(&writing.output)?;
    let levels = usize::from(args.levels);
    let mut job = Job::settle_for(&args.common, writing.frames.unwrap_or(Frames::Rest), Some(format))?;
    let mut inputs = vec![mesh_file.clone()];
    inputs.extend(writing.field.clone());
    inputs.extend(io::companion(mesh_file, false));
    let mut outputs = vec![writing.output.clone()];
    outputs.extend(io::companion(&writing.output, writing.field.is_some() || !job.asset.forms.is_empty()));
    let inputs: Vec<_> = inputs.iter().map(|path| path.as_path()).collect();
    check_outputs(&inputs, &outputs)?;
    let fields = job.fields(writing.field.as_deref())?;
    refine(args.command, &job, &fields, (levels, args.on_limit), writing)
}

/// Refines a cage with forms on it, puts it on its limit if so, and writes it.
pub fn refine(
    command: &str,
    job: &Job,
    fields: &Fields,
    target: (usize, bool),
    writing: &Writing,
) -> Result<Outcome, Failure> {
    refine_from(command, job, fields, 0, target, writing)
}

/// [`refine`], with forms that are on a level of the cage's.
pub fn refine_from(
    command: &str,
    job: &Job,
    fields: &Fields,
    from: usize,
    (levels, on_limit): (usize, bool),
    writing: &Writing,
) -> Result<Outcome, Failure> {
    let bar = progress_bar(job.progress, levels, "refining");
    let hierarchy =
        Hierarchy::with_progress(&job.cage, job.scheme, levels, |level| bar.set_position(work(level)))?;
    bar.set_message("writing ");
    let fields = Fields {
        form0: fields.form0.as_ref().map(|form| refined(&hierarchy, form, from)),
        form1: fields.form1.as_ref().map(|form| refined(&hierarchy, form, from)),
        form2: fields.form2.as_ref().map(|form| refined(&hierarchy, form, from)),
    };
    // The same operators serve every frame.
    let limit = on_limit.then(|| ToLimit::new(&hierarchy, &fields)).transpose()?;
    let finish = |time: f64, positions: &Positions| {
        let positions = hierarchy.subdivide(positions);
        match &limit {
            Some(limit) => limit.pose(time, &positions),
            None => Pose { time, positions, at_vertices: None },
        }
    };
    let rest = finish(0.0, &job.asset.positions);
    let frames = job.asset.frames.iter().map(|Frame { time, positions, .. }| finish(*time, positions));

    let finest = hierarchy.finest();
    // On level 0, holes are tags of the cage like any other.
    let left_out = match (levels, on_limit) {
        (0, false) => vec![false; finest.mesh().num_faces()],
        _ => finest.tags().face_hole.clone(),
    };
    let sharp = finest.tags().edge_sharpness.iter().map(|&sharpness| sharpness >= INFINITELY_SHARP);
    let steps = (1..=levels).map(|l| (hierarchy.level(l - 1).mesh(), hierarchy.refinement(l).split()));
    let follow = |values: &Cochain<0>| {
        let refined = hierarchy.subdivide(values);
        match &limit {
            Some(limit) => limit.values(&refined),
            None => refined,
        }
    };
    let fields = limit.as_ref().map_or(&fields, ToLimit::forms);
    let mut surface = Surface::new(levels, finest.mesh(), &rest.positions, fields, &left_out)?
        .of(&job.asset)
        .with_sharp_edges(sharp.collect())
        .with_ancestry(Ancestry::new(steps.collect(), finest.mesh(), &follow))
        .with_frames(frames.collect())?;
    if let Some(at_vertices) = rest.at_vertices {
        surface = surface.on_limit(at_vertices);
    }
    let saved = io::save(&writing.output, &surface, SaveOptions { tangents: writing.tangents })?;
    let mut outcome = outcome(command, job, &surface, &saved);
    outcome.notes.extend(limit.as_ref().and_then(|limit| limit.note()));
    Ok(outcome)
}

/// A form on a level, refined to the finest.
fn refined<const K: usize>(hierarchy: &Hierarchy, form: &Cochain<K>, from: usize) -> Cochain<K> {
    (from + 1..=hierarchy.num_levels()).fold(form.clone(), |form, level| hierarchy.refine(level, &form))
}

fn outcome(command: &str, job: &Job, surface: &Surface, saved: &Saved) -> Outcome {
    let mesh = surface.mesh();
    let left_out = mesh.num_faces() - surface.faces().len();
    let counts = [
        count(mesh.num_vertices(), "vertex"),
        count(surface.edges().len(), "edge"),
        count(surface.faces().len(), "face"),
    ];
    let mut text = format!("{}, level {}: {}", job.asset.label(), surface.level(), counts.join(", "));
    if left_out > 0 {
        text += &format!(" ({} left out as holes)", count(left_out, "face"));
    }
    if !surface.frames().is_empty() {
        text += &format!(", {}", count(surface.frames().len(), "frame"));
    }
    text.push('\n');
    for (i, path) in saved.paths.iter().enumerate() {
        let is_obj = saved.paths[0].extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
        let remark = if i > 0 && is_obj { ", the forms: OBJ has no place for them" } else { "" };
        text += &format!("wrote {}{}{remark}\n", path.display(), size_of(path));
    }
    let fields = surface.fields();
    let forms = [fields.form0.is_some(), fields.form1.is_some(), fields.form2.is_some()];
    let json = json!({
        "command": command,
        "mesh": job.asset.name,
        "prim": job.asset.prim,
        "scheme": scheme_name(job.scheme),
        "level": surface.level(),
        "vertices": mesh.num_vertices(),
        "edges": surface.edges().len(),
        "faces": surface.faces().len(),
        "faces_left_out": left_out,
        "forms": (0..3).filter(|&k| forms[k]).collect::<Vec<usize>>(),
        "frames": surface.frames().iter().map(|pose| pose.time).collect::<Vec<_>>(),
        "written": saved.paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
    });
    let notes = job.asset.notes.iter().chain(&saved.notes).cloned().collect();
    Outcome { text, json, notes, holds: true }
}
