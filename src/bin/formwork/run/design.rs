use formwork::design::{Hodge, Singularities, Spec, singularities};
use formwork::io::fields::Fields;
use formwork::io::{self, Frames, atomic};
use formwork::limit::LimitSurface;
use serde_json::{Value, json};

use super::{Outcome, count, progress_bar, size_of, subdivide};
use crate::Failure;
use crate::args::{Design, METRICS, name_of};
use crate::job::{Job, check_outputs};

pub fn run(args: &Design) -> Result<Outcome, Failure> {
    let format = io::writer(&args.output)?;
    let job = Job::settle_for(&args.common, Frames::Rest, Some(format))?;
    let mut outputs = vec![args.output.clone()];
    outputs.extend(io::companion(&args.output, true));
    outputs.extend(args.field_out.clone());
    check_outputs(&[&args.common.mesh, &args.spec], &outputs)?;
    let (mut spec, conditions) = Spec::read(&args.spec)?;
    spec.balance = args.balance;

    let bar = progress_bar(job.progress, 1, "designing");
    let of_spec = |error: formwork::design::DesignError| format!("{}: {error}", args.spec.display());
    let surface = LimitSurface::new(&job.cage, job.scheme)?;
    let hodge = Hodge::new(&surface, &job.asset.positions, args.metric, &conditions).map_err(of_spec)?;
    let field = hodge.design(&spec).map_err(of_spec)?;
    let levels = surface.hierarchy().num_levels() + 2;
    let zeros = singularities(&surface, &job.asset.positions, &field.cochain, levels)?;
    drop(bar);
    if let Some(path) = &args.field_out {
        let mesh = hodge.mesh();
        let edges = mesh.edges().iter().zip(field.cochain.values()).map(|([a, b], x)| json!([a, b, x]));
        let object = json!({ "edges": edges.collect::<Vec<_>>() });
        atomic::write(path, |out| Ok(serde_json::to_writer(out, &object)?))?;
    }
    let fields = Fields { form1: Some(field.cochain), ..Fields::default() };
    let written =
        subdivide::refine("design", &job, &fields, (usize::from(args.level), true), &args.writing())?;

    let homology = hodge.homology();
    let mut text = format!(
        "{}: {}, {}\n",
        job.asset.label(),
        count(homology.loops().len(), "boundary loop"),
        count(homology.generators().len(), "generator")
    );
    for (what, off) in [("sources", field.balanced[0]), ("vortices", field.balanced[1])] {
        if off != 0.0 {
            text += &format!("balanced: {off} taken off the {what}, by area\n");
        }
    }
    text += &told(&zeros);
    text += written.text.split_once('\n').map_or("", |(_, rest)| rest);
    if let Some(path) = &args.field_out {
        text += &format!("wrote {}{}\n", path.display(), size_of(path));
    }
    let mut json = written.json;
    json["metric"] = json!(name_of(METRICS, args.metric));
    json["boundary_loops"] = json!(homology.loops().len());
    json["generators"] = json!(homology.generators().len());
    json["circulations"] = json!(field.circulations);
    json["balanced"] = json!({ "sources": field.balanced[0], "vortices": field.balanced[1] });
    json["miss"] = json!(field.miss);
    json["singularities"] = listed(&zeros);
    Ok(Outcome { text, json, notes: written.notes, holds: true })
}

fn told(zeros: &Singularities) -> String {
    let of = |index: i32| zeros.zeros.iter().filter(|zero| zero.index == index).count();
    let turns = match zeros.boundary_turns {
        0 => String::new(),
        turns => format!(", {turns} at the boundary"),
    };
    format!(
        "{}: {} of index 1, {} of index -1; indices sum to {}, Euler characteristic {}{turns}: {}\n",
        count(zeros.zeros.len(), "zero"),
        of(1),
        of(-1),
        zeros.index_sum,
        zeros.euler,
        if zeros.holds() { "OK" } else { "not all zeros were told apart" }
    )
}

fn listed(found: &Singularities) -> Value {
    let zero = |zero: &formwork::design::Singularity| {
        let (p, x) = (zero.point, zero.position);
        json!({
            "point": [json!(p.face), json!(p.corner), json!(p.s), json!(p.t)],
            "position": [x.x, x.y, x.z],
            "index": zero.index,
            "residual": zero.residual,
        })
    };
    json!({
        "zeros": found.zeros.iter().map(zero).collect::<Vec<_>>(),
        "index_sum": found.index_sum,
        "euler_characteristic": found.euler,
        "boundary_turns": found.boundary_turns,
        "holds": found.holds(),
    })
}
