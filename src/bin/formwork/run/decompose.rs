use formwork::design::Hodge;
use formwork::io::npz::{self, Array};
use formwork::io::{Format, Frames, atomic};
use formwork::limit::LimitSurface;
use serde_json::json;

use super::{Outcome, count, progress_bar, size_of};
use crate::Failure;
use crate::args::{Decompose, METRICS, name_of, scheme_name};
use crate::job::{Job, check_outputs, format_of};

pub fn run(args: &Decompose) -> Result<Outcome, Failure> {
    let format = format_of(&args.output, &["json", "npz"])?;
    let mut job = Job::settle_for(&args.common, Frames::Rest, Some(Format::Json))?;
    let mut inputs = vec![args.common.mesh.as_path()];
    inputs.extend(args.field.as_deref());
    check_outputs(&inputs, std::slice::from_ref(&args.output))?;
    let form = job.fields(args.field.as_deref())?.form1;
    let form = form.ok_or_else(|| {
        format!("{}: there is no 1-form to decompose: give one with --field", job.asset.label())
    })?;

    let bar = progress_bar(job.progress, 1, "decomposing");
    let surface = LimitSurface::new(&job.cage, job.scheme)?;
    let hodge = Hodge::new(&surface, &job.asset.positions, args.metric, &args.conditions)
        .map_err(|error| format!("{}: {error}", job.asset.label()))?;
    let parts = hodge.decompose(&form);
    drop(bar);
    let mesh = hodge.mesh();
    let named = [("exact", &parts.exact), ("coexact", &parts.coexact), ("harmonic", &parts.harmonic)];
    if format == "npz" {
        let ends: Vec<u32> = mesh.edges().iter().flatten().copied().collect();
        let (v, e, f) = ([mesh.num_vertices()], [mesh.num_edges()], [mesh.num_faces()]);
        let g = [parts.circulations.len()];
        let pairs = [mesh.num_edges(), 2];
        let mut arrays = vec![
            ("edges", &pairs[..], Array::Indices(&ends)),
            ("potential", &v[..], Array::Floats(parts.potential.values())),
            ("stream", &f[..], Array::Floats(parts.stream.values())),
            ("circulations", &g[..], Array::Floats(&parts.circulations)),
        ];
        arrays.extend(named.iter().map(|(name, part)| (*name, &e[..], Array::Floats(part.values()))));
        npz::write_arrays(&args.output, &arrays)?;
    } else {
        let cycle = |i: usize| -> Vec<u32> {
            hodge.homology().cycle(mesh, i).into_iter().map(|h| mesh.tail(h)).collect()
        };
        let object = json!({
            "edges": mesh.edges(),
            "potential": parts.potential.values(),
            "stream": parts.stream.values(),
            "exact": parts.exact.values(),
            "coexact": parts.coexact.values(),
            "harmonic": parts.harmonic.values(),
            "circulations": parts.circulations,
            "cycles": (0..parts.circulations.len()).map(cycle).collect::<Vec<_>>(),
        });
        atomic::write(&args.output, |out| Ok(serde_json::to_writer(out, &object)?))?;
    }

    let energy = |part: &formwork::cochain::Cochain<1>| -> f64 {
        part.values().iter().zip(hodge.mass(part).values()).map(|(x, y)| x * y).sum()
    };
    let all = energy(&form);
    let share = |part| if all > 0.0 { 100.0 * energy(part) / all } else { 0.0 };
    let mut text = format!("{}: {}\n", job.asset.label(), count(parts.circulations.len(), "generator"));
    for (name, part) in named {
        text += &format!("  {name:9} {:6.2} % of the energy\n", share(part));
    }
    text += &format!("wrote {}{}\n", args.output.display(), size_of(&args.output));
    let json = json!({
        "command": "decompose",
        "mesh": job.asset.name,
        "scheme": scheme_name(job.scheme),
        "metric": name_of(METRICS, args.metric),
        "generators": parts.circulations.len(),
        "energy": {
            "all": all,
            "exact": energy(&parts.exact),
            "coexact": energy(&parts.coexact),
            "harmonic": energy(&parts.harmonic),
        },
        "circulations": parts.circulations,
        "written": [args.output.display().to_string()],
    });
    Ok(Outcome { text, json, notes: job.asset.notes.clone(), holds: true })
}
