use formwork::cochain::Cochain;
use formwork::hierarchy::Hierarchy;
use formwork::io::fields::Fields;
use formwork::io::{self, Ancestry, Frames, SaveOptions, Saved, Surface};
use serde_json::json;

use super::{Outcome, count, progress_bar, size_of, work};
use crate::Failure;
use crate::args::{Subdivide, scheme_name};
use crate::job::{Job, check_outputs};

/// From this sharpness on, OpenSubdiv takes an edge for infinitely sharp.
const INFINITELY_SHARP: f32 = 10.0;

pub fn run(args: &Subdivide) -> Result<Outcome, Failure> {
    let format = io::writer(&args.output)?;
    let levels = usize::from(args.levels);
    let frames = args.frames.unwrap_or(Frames::Rest);
    let mut job = Job::settle_for(&args.common, frames, Some(format))?;
    let mut inputs = vec![args.common.mesh.clone()];
    inputs.extend(args.field.clone());
    inputs.extend(io::companion(&args.common.mesh, false));
    let mut outputs = vec![args.output.clone()];
    outputs.extend(io::companion(&args.output, args.field.is_some() || !job.asset.forms.is_empty()));
    let inputs: Vec<_> = inputs.iter().map(|path| path.as_path()).collect();
    check_outputs(&inputs, &outputs)?;
    let fields = job.fields(args.field.as_deref())?;

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
    // On level 0, holes are tags of the cage like any other.
    let left_out = match levels {
        0 => vec![false; finest.mesh().num_faces()],
        _ => finest.tags().face_hole.clone(),
    };
    let sharp = finest.tags().edge_sharpness.iter().map(|&sharpness| sharpness >= INFINITELY_SHARP);
    // The same operators serve every frame.
    let frames = job.asset.frames.iter().map(|f| (f.time, hierarchy.subdivide(&f.positions)));
    let refine = |values: &Cochain<0>| hierarchy.subdivide(values);
    let mut surface = Surface::new(levels, finest.mesh(), &positions, &refined, &left_out)?
        .of(&job.asset)
        .with_sharp_edges(sharp.collect())
        .with_frames(frames.collect())?;
    if levels > 0 {
        let steps = (1..=levels).map(|l| (hierarchy.level(l - 1).mesh(), hierarchy.refinement(l).split()));
        surface = surface.with_ancestry(Ancestry::new(steps.collect(), finest.mesh(), &refine));
    }
    let saved = io::save(&args.output, &surface, SaveOptions { tangents: args.tangents })?;
    Ok(outcome(&job, &surface, &saved))
}

fn outcome(job: &Job, surface: &Surface, saved: &Saved) -> Outcome {
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
        "command": "subdivide",
        "mesh": job.asset.name,
        "prim": job.asset.prim,
        "scheme": scheme_name(job.scheme),
        "level": surface.level(),
        "vertices": mesh.num_vertices(),
        "edges": surface.edges().len(),
        "faces": surface.faces().len(),
        "faces_left_out": left_out,
        "forms": (0..3).filter(|&k| forms[k]).collect::<Vec<usize>>(),
        "frames": surface.frames().iter().map(|(time, _)| time).collect::<Vec<_>>(),
        "written": saved.paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
    });
    let notes = job.asset.notes.iter().chain(&saved.notes).cloned().collect();
    Outcome { text, json, notes, holds: true }
}
