use std::path::{Path, PathBuf};

use formwork::field;
use formwork::hierarchy::{Hierarchy, HierarchyError};
use formwork::io::fields::{self, Fields};
use formwork::io::{AtVertices, Positions, Surface, glb, json, npz, obj};
use formwork::limit::Limit;
use serde_json::json;

use super::{Outcome, count, progress_bar, size_of, work};
use crate::Failure;
use crate::args::{self, Common, scheme_name};
use crate::job::{Job, check_outputs, format_of};

/// `subdivide` and `limit`: a refined surface, as it is or on its limit.
pub struct Request {
    command: &'static str,
    formats: &'static [&'static str],
    field: Option<PathBuf>,
    levels: u8,
    on_limit: bool,
    output: PathBuf,
    common: Common,
}

impl From<args::Subdivide> for Request {
    fn from(args: args::Subdivide) -> Self {
        Request {
            command: "subdivide",
            formats: &["glb", "json", "obj"],
            field: args.field,
            levels: args.levels,
            on_limit: args.limit,
            output: args.output,
            common: args.common,
        }
    }
}

impl From<args::Limit> for Request {
    fn from(args: args::Limit) -> Self {
        Request {
            command: "limit",
            formats: &["npz", "json", "glb", "obj"],
            field: args.field,
            levels: args.level,
            on_limit: true,
            output: args.output,
            common: args.common,
        }
    }
}

pub fn run(args: &Request) -> Result<Outcome, Failure> {
    let format = format_of(&args.output, args.formats)?;
    let levels = usize::from(args.levels);
    let job = Job::settle(&args.common)?;
    let mut inputs = vec![args.common.mesh.as_path()];
    inputs.extend(args.field.as_deref());
    let mut outputs = vec![args.output.clone()];
    if format == "obj" && args.field.is_some() {
        outputs.push(obj::fields_path(&args.output));
    }
    check_outputs(&inputs, &outputs)?;
    let fields = read_fields(args.field.as_deref(), &job)?;

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
    let mut notes = Vec::new();
    let (positions, refined, at_vertices) = match args.on_limit {
        false => (positions, refined, None),
        true => {
            let (positions, fields, at_vertices, note) = limit(&hierarchy, &positions, &refined)?;
            notes.extend(note);
            (positions, fields, Some(at_vertices))
        }
    };
    let mut surface = Surface::new(levels, finest.mesh(), &positions, &refined, &finest.tags().face_hole)?;
    if let Some(at_vertices) = at_vertices {
        surface = surface.on_limit(at_vertices);
    }
    let written = write(format, &args.output, &surface)?;
    let mut outcome = outcome(args.command, &job, &surface, &written);
    outcome.notes.extend(notes);
    if format == "glb" && refined.form2.is_some() {
        outcome.notes.push("glTF has no place for the 2-form: write .json or .obj to keep it".to_owned());
    }
    Ok(outcome)
}

/// The forms on the cage that a file holds. The cage alone is quick to build, and a mistake in the file is then
/// known before anything is refined.
pub fn read_fields(path: Option<&Path>, job: &Job) -> Result<Fields, Failure> {
    Ok(match path {
        None => Fields::default(),
        Some(path) => fields::read(path, Hierarchy::new(&job.cage, job.scheme, 0)?.level(0).mesh())?,
    })
}

/// Positions and forms of the finest level in the limit, with normals and vectors, and a note on vertices that
/// have none of their own.
fn limit(
    hierarchy: &Hierarchy,
    positions: &Positions,
    fields: &Fields,
) -> Result<(Positions, Fields, AtVertices, Option<String>), HierarchyError> {
    let mesh = hierarchy.finest().mesh();
    let (limit, tangents) = Limit::with_tangents(hierarchy, hierarchy.num_levels())?;
    let on_limit = limit.apply(mesh, positions);
    let forms = Fields {
        form0: fields.form0.as_ref().map(|form| limit.apply(mesh, form)),
        form1: fields.form1.as_ref().map(|form| limit.apply(mesh, form)),
        form2: fields.form2.as_ref().map(|form| limit.apply(mesh, form)),
    };
    let normals = tangents.at_vertices(mesh, &tangents.normals(mesh, positions));
    let is_bare = |v: usize| normals[v].is_none() && !mesh.vertex_half_edges(v as u32).is_empty();
    let bare = (0..mesh.num_vertices()).filter(|&v| is_bare(v)).count();
    let note = (bare > 0).then(|| {
        let vertices = count(bare, "vertex");
        format!("{vertices} without a tangent plane (sharp, without sharp edges): normals and vectors there are means of the faces round them")
    });
    let flat_normals = field::vertex_normals(mesh, &on_limit);
    let vectors = fields.form1.as_ref().zip(forms.form1.as_ref()).map(|(form, circulations)| {
        let of_pairs = tangents.vectors(mesh, positions, form);
        let flat = field::vertex_vectors(mesh, &field::face_vectors(mesh, &on_limit, circulations));
        let at_vertices = tangents.at_vertices(mesh, &of_pairs).into_iter().zip(flat);
        let at_vertices: Vec<_> = at_vertices.map(|(exact, flat)| exact.unwrap_or(flat)).collect();
        let at_corner = |corner: u32| match tangents.pair_of_corner(corner) {
            Some(pair) => of_pairs[pair],
            None => at_vertices[mesh.corner_vertex(corner) as usize],
        };
        let at_corners = (0..mesh.num_corners() as u32).map(at_corner).collect();
        [at_vertices, at_corners]
    });
    let unit = |(exact, flat): (Option<nalgebra::Vector3<f64>>, _)| {
        exact.and_then(|normal| normal.try_normalize(0.0)).unwrap_or(flat)
    };
    let normals = normals.into_iter().zip(flat_normals).map(unit).collect();
    Ok((on_limit, forms, AtVertices { normals, vectors }, note))
}

fn write(format: &str, path: &Path, surface: &Surface) -> Result<Vec<PathBuf>, Failure> {
    match format {
        "obj" => return Ok(obj::write(path, surface)?),
        "json" => json::write(path, surface)?,
        "npz" => npz::write_surface(path, surface)?,
        _ => glb::write(path, surface)?,
    }
    Ok(vec![path.to_owned()])
}

fn outcome(command: &str, job: &Job, surface: &Surface, written: &[PathBuf]) -> Outcome {
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
        "command": command,
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
