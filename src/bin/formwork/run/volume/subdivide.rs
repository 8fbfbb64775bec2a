use formwork::io::volume;
use formwork::octet::{Hierarchy, SolidFields, to_grid};
use serde_json::json;

use super::{fields, load, work};
use crate::Failure;
use crate::args::volume::SubdivideVolume;
use crate::job::check_outputs;
use crate::run::{Outcome, count, progress_bar_of, size_of};

pub fn run(args: &SubdivideVolume) -> Result<Outcome, Failure> {
    let (mesh, output, levels) = (&args.common.mesh, &args.output, usize::from(args.levels));
    volume::check_writable(output)?;
    let mut inputs = vec![mesh.as_path()];
    inputs.extend(args.refining.field.as_deref());
    check_outputs(&inputs, std::slice::from_ref(output))?;
    let mut solid = load(mesh)?;
    let fields = fields(&mut solid, mesh, args.refining.field.as_deref())?;

    let scheme = args.refining.scheme.scheme();
    let bar = progress_bar_of(!args.common.quiet && !args.common.json, work(levels), "refining");
    let hierarchy =
        Hierarchy::with_progress(solid.complex, scheme, levels, |level| bar.set_position(work(level)))?;
    let positions = hierarchy.subdivide(&solid.positions);
    let fields = SolidFields {
        form0: fields.form0.map(|form| hierarchy.subdivide(&form)),
        form1: fields.form1.map(|form| hierarchy.subdivide(&form)),
        form2: fields.form2.map(|form| hierarchy.subdivide(&form)),
        form3: fields.form3.map(|form| hierarchy.subdivide(&form)),
    };
    bar.set_message("writing ");
    let fine = hierarchy.finest();
    volume::save(output, to_grid(fine, &positions, &fields))?;
    bar.finish_and_clear();

    let counts = [
        count(fine.num_cells(0), "vertex"),
        count(fine.num_cells(1), "edge"),
        count(fine.num_cells(2), "triangle"),
        count(fine.tets().len(), "tetrahedron"),
        count(fine.octs().len(), "octahedron"),
    ];
    let text = format!(
        "{}, level {levels}: {}\nwrote {}{}\n",
        mesh.display(),
        counts.join(", "),
        output.display(),
        size_of(output)
    );
    let json = json!({
        "command": "volume subdivide",
        "mesh": mesh.display().to_string(),
        "level": levels,
        "smooth": args.refining.scheme.smooth,
        "c": args.refining.scheme.c,
        "vertices": fine.num_cells(0),
        "edges": fine.num_cells(1),
        "triangles": fine.num_cells(2),
        "tetrahedra": fine.tets().len(),
        "octahedra": fine.octs().len(),
        "forms": fields.degrees(),
        "written": [output.display().to_string()],
    });
    Ok(Outcome { text, json, notes: solid.notes, holds: true })
}
