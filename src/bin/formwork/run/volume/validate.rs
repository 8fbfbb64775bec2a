use formwork::octet::laws;
use serde_json::json;

use super::{load, work};
use crate::Failure;
use crate::args::volume::ValidateVolume;
use crate::run::{Outcome, grouped, progress_bar_of};

pub fn run(args: &ValidateVolume) -> Result<Outcome, Failure> {
    let solid = load(&args.common.mesh)?;
    let levels = usize::from(args.levels);
    let bar = progress_bar_of(!args.common.quiet && !args.common.json, work(levels), "measuring");
    let scheme = args.scheme.scheme();
    let progress = |level| bar.set_position(work(level));
    let report = laws::measure(&solid.complex, &solid.positions, scheme, levels, progress)?;
    bar.finish_and_clear();

    let kind = if args.scheme.smooth { "smooth" } else { "linear" };
    let mut text = format!(
        "{}, {kind} scheme, c = {}\n\nlevel        cells   d S0 - S1 d   d S1 - S2 d   d S2 - S3 d   total of a 3-form\n",
        args.common.mesh.display(),
        args.scheme.c
    );
    for row in &report.levels {
        let [a, b, c] = row.commutation.map(short);
        text += &format!(
            "{:>5}   {:>10}   {a:>11}   {b:>11}   {c:>11}   {:>17}\n",
            row.level,
            grouped(row.cells[3]),
            short(row.total)
        );
    }
    if let Some([edges, triangles]) = report.levels.last().and_then(|row| row.regular) {
        text += &format!(
            "\nLike the lattice on the last level: {:.1} % of the edges, {:.1} % of the triangles.\n",
            100.0 * edges,
            100.0 * triangles
        );
    }
    let verdict = if report.holds() { "OK" } else { "FAIL" };
    text += &format!(
        "\nCommutation d S = S d: worst deviation {}, tolerance {:.0e}: {verdict}\n",
        short(report.worst()),
        report.tolerance
    );
    let json = json!({
        "command": "volume validate",
        "mesh": args.common.mesh.display().to_string(),
        "smooth": args.scheme.smooth,
        "c": args.scheme.c,
        "levels": report.levels,
        "tolerance": report.tolerance,
        "worst": report.worst(),
        "holds": report.holds(),
    });
    Ok(Outcome { text, json, notes: solid.notes, holds: report.holds() })
}

fn short(deviation: f64) -> String {
    if deviation == 0.0 { "0".to_owned() } else { format!("{deviation:.1e}") }
}
