use std::io::Write;
use std::path::{Path, PathBuf};

use formwork::design::{Hodge, Metric, Spec};
use formwork::io::fields::Fields;
use formwork::io::{Format, Frames, atomic};
use formwork::limit::LimitSurface;
use formwork::view::{Layers, Options, Up, View};
use serde_json::json;

use super::{Outcome, count, progress_bar, size_of};
use crate::Failure;
use crate::args::{self, Layer, scheme_name};
use crate::job::{Job, check_outputs, format_of};

/// The most faces of the finest level, unless `--levels` asks for more.
const FACES: usize = 30_000;

pub fn run(args: &args::View) -> Result<Outcome, Failure> {
    for (path, extension) in [(&args.output, "html"), (&args.png, "png")] {
        path.as_deref().map(|path| format_of(path, &[extension])).transpose()?;
    }
    // In the space of glTF if it comes from a stage: metres, Y up.
    let mut job = Job::settle_for(&args.common, Frames::Rest, Some(Format::Glb))?;
    let inputs = [Some(&args.common.mesh), args.field.as_ref(), args.spec.as_ref()];
    let inputs: Vec<&Path> = inputs.into_iter().flatten().map(PathBuf::as_path).collect();
    let outputs: Vec<PathBuf> = [&args.output, &args.png].into_iter().flatten().cloned().collect();
    check_outputs(&inputs, &outputs)?;
    if let [page, picture] = &outputs[..]
        && page == picture
    {
        return Err(format!("{}: the page and the picture need two names", page.display()).into());
    }

    let bar = progress_bar(job.progress, 1, "preparing");
    let mut options = Options {
        levels: args.levels.map_or_else(|| levels(&job), usize::from),
        lines: args.lines as usize,
        up: args.up.unwrap_or_else(|| up(&args.common.mesh)),
        degree: args.form.map(usize::from),
        layers: layers(&args.show),
        ..Options::default()
    };
    let fields = match &args.spec {
        None => job.fields(args.field.as_deref())?,
        Some(spec) => {
            let (form1, potential) = designed(&job, spec, args.balance)?;
            options.potential = Some(potential);
            Fields { form1: Some(form1), ..Fields::default() }
        }
    };
    let view = View::new(&job.cage, job.scheme, &job.asset.positions, &fields, &options)
        .map_err(|error| format!("{}: {error}", job.asset.label()))?;
    bar.set_message("drawing  ");
    let picture = match &args.png {
        Some(_) => Some(view.picture(args.size)?.encode_png()?),
        None => None,
    };
    let mesh_name = args.common.mesh.file_name().map(|name| name.to_string_lossy().into_owned());
    if let Some(path) = &args.output {
        let page = view.page(&mesh_name.unwrap_or_else(|| job.asset.name.clone()));
        atomic::write(path, |out| out.write_all(page.as_bytes()))?;
    }
    if let (Some(path), Some(picture)) = (&args.png, picture) {
        atomic::write(path, |out| out.write_all(&picture))?;
    }
    drop(bar);

    let finest = view.finest();
    let mut text = format!(
        "{}, level {}: {}, {}\n",
        job.asset.label(),
        options.levels,
        count(finest.vertices.len(), "vertex"),
        count(finest.face_sizes.len(), "face")
    );
    for shown in view.forms.iter().flatten() {
        let unit = if shown.unit.is_empty() { String::new() } else { format!(" {}", shown.unit) };
        text += &format!("{}: {:.4} to {:.4}{unit}\n", shown.name, shown.range[0], shown.range[1]);
    }
    for path in &outputs {
        text += &format!("wrote {}{}\n", path.display(), size_of(path));
    }
    let forms = view.forms.iter().enumerate().filter_map(|(degree, shown)| {
        let shown = shown.as_ref()?;
        Some(json!({ "degree": degree, "name": shown.name, "range": shown.range, "scale": shown.scale }))
    });
    let json = json!({
        "command": "view",
        "mesh": job.asset.name,
        "scheme": scheme_name(job.scheme),
        "level": options.levels,
        "vertices": finest.vertices.len(),
        "faces": finest.face_sizes.len(),
        "forms": forms.collect::<Vec<_>>(),
        "degree": view.degree,
        "strokes": view.strokes.len(),
        "arrows": view.arrows.len(),
        "zeros": view.zeros.len(),
        "written": outputs.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
    });
    let notes = job.asset.notes.iter().chain(&view.notes).cloned().collect();
    Ok(Outcome { text, json, notes, holds: true })
}

/// The field of a spec, and the potential of its exact part.
fn designed(
    job: &Job,
    path: &Path,
    balance: bool,
) -> Result<(formwork::cochain::Cochain<1>, formwork::cochain::Cochain<0>), Failure> {
    let (mut spec, conditions) = Spec::read(path)?;
    spec.balance = balance;
    let of_spec = |error: formwork::design::DesignError| format!("{}: {error}", path.display());
    let surface = LimitSurface::new(&job.cage, job.scheme)?;
    let hodge = Hodge::new(&surface, &job.asset.positions, Metric::Limit, &conditions).map_err(of_spec)?;
    let field = hodge.design(&spec).map_err(of_spec)?.cochain;
    let potential = hodge.decompose(&field).potential;
    Ok((field, potential))
}

/// As many levels as stay below so many faces.
fn levels(job: &Job) -> usize {
    let descriptor = job.cage.descriptor();
    // The first split makes a face of every corner of a polygon, or four of a triangle.
    let first = match job.scheme {
        formwork::scheme::Scheme::Loop(..) => 4 * descriptor.face_sizes.len(),
        _ => descriptor.face_vertices.len(),
    };
    (1..=4).take_while(|level| first << (2 * (level - 1)) <= FACES).last().unwrap_or(0)
}

fn up(mesh: &Path) -> Up {
    let extension = mesh.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("obj" | "json") | None => Up::Z,
        _ => Up::Y,
    }
}

fn layers(show: &[Layer]) -> Layers {
    let has = |layer| show.contains(&layer);
    Layers {
        strokes: has(Layer::Strokes),
        arrows: has(Layer::Arrows),
        cage: has(Layer::Cage),
        creases: has(Layer::Creases),
        zeros: has(Layer::Zeros),
        mesh: has(Layer::Mesh),
    }
}
