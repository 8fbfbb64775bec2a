use formwork::hierarchy::Hierarchy;
use formwork::io::npz;
use serde_json::json;

use super::{Outcome, count, progress_bar, size_of, work};
use crate::Failure;
use crate::args::{Operators, scheme_name};
use crate::job::{Job, check_outputs, format_of};

pub fn run(args: &Operators) -> Result<Outcome, Failure> {
    format_of(&args.output, &["npz"])?;
    let levels = usize::from(args.levels);
    let job = Job::settle(&args.common)?;
    check_outputs(&[&args.common.mesh], std::slice::from_ref(&args.output))?;

    let bar = progress_bar(job.progress, levels, "refining");
    let hierarchy =
        Hierarchy::with_progress(&job.cage, job.scheme, levels, |level| bar.set_position(work(level)))?;
    bar.set_message("writing ");
    let level = |l: usize| npz::Level {
        mesh: hierarchy.level(l).mesh(),
        step: (l > 0).then(|| {
            let operators = hierarchy.operators(l);
            bar.set_position(work(l));
            npz::Step {
                split: hierarchy.refinement(l).split(),
                operators: [operators.s0, operators.s1, operators.s2],
            }
        }),
    };
    npz::write(&args.output, (0..=levels).map(level))?;

    let mesh = hierarchy.finest().mesh();
    let counts = [
        count(mesh.num_vertices(), "vertex"),
        count(mesh.num_edges(), "edge"),
        count(mesh.num_faces(), "face"),
    ];
    let text = format!(
        "{}, levels 0 to {levels}; level {levels}: {}\nwrote {}{}\n",
        job.asset.name,
        counts.join(", "),
        args.output.display(),
        size_of(&args.output)
    );
    let json = json!({
        "command": "operators",
        "mesh": job.asset.name,
        "scheme": scheme_name(job.scheme),
        "levels": levels,
        "vertices": mesh.num_vertices(),
        "edges": mesh.num_edges(),
        "faces": mesh.num_faces(),
        "written": [args.output.display().to_string()],
    });
    Ok(Outcome { text, json, notes: job.asset.notes.clone(), holds: true })
}
