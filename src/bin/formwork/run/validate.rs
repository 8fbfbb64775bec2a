use formwork::laws::{self, Report};
use serde_json::json;

use super::{Outcome, progress_bar, work};
use crate::Failure;
use crate::args::{Validate, scheme_name};
use crate::job::Job;

pub fn run(args: &Validate) -> Result<Outcome, Failure> {
    let levels = usize::from(args.levels);
    let job = Job::settle(&args.common)?;
    let bar = progress_bar(job.progress, levels, "measuring");
    let report = laws::measure(&job.cage, job.scheme, levels, |level| bar.set_position(work(level)))?;
    let json = json!({
        "command": "validate",
        "mesh": job.asset.name,
        "scheme": scheme_name(job.scheme),
        "levels": report.levels,
        "limit_laws": report.limit_laws,
        "limit": report.limit,
        "tolerance": report.tolerance,
        "worst": report.worst(),
        "holds": report.holds(),
    });
    let heading = format!("{}, scheme {}", job.asset.name, scheme_name(job.scheme));
    Ok(Outcome { text: table(&heading, &report), json, notes: job.asset.notes, holds: report.holds() })
}

fn table(heading: &str, report: &Report) -> String {
    let mut text = format!("{heading}\n\nExact laws, largest deviation\n");
    text += "level   d0 S0 - S1 d0   d1 S1 - S2 d1   column sums of S2 - 1   S0 - OpenSubdiv's S0\n";
    for row in &report.levels {
        text += &format!(
            "{:>5}   {:>13}   {:>13}   {:>21}   {:>20}\n",
            row.level,
            short(row.d0_s0_minus_s1_d0),
            short(row.d1_s1_minus_s2_d1),
            short(row.s2_column_sum_minus_1),
            optional(row.s0_minus_opensubdiv)
        );
    }
    text += "\nLaws of the limit, largest deviation\n";
    text += "level   L1 d0 - d0 L0   L2 d1 - d1 L1       R L' S - L   L0 - OpenSubdiv's where exact\n";
    for row in &report.limit_laws {
        text += &format!(
            "{:>5}   {:>13}   {:>13}   {:>14}   {:>28}\n",
            row.level,
            short(row.l1_d0_minus_d0_l0),
            short(row.l2_d1_minus_d1_l1),
            optional(row.restricted),
            optional(row.l0_minus_opensubdiv)
        );
    }
    text += "\nA refined differential, summed along each control edge\n";
    text += "level   - OpenSubdiv's refined values   - limit circulation   rate\n";
    for row in &report.limit {
        let rate = row.rate.map_or("-".to_owned(), |rate| format!("{rate:.2}"));
        text += &format!(
            "{:>5}   {:>29}   {:>19}   {rate:>4}\n",
            row.level,
            short(row.telescoped_minus_refined),
            short(row.telescoped_minus_limit)
        );
    }
    if report.levels.iter().any(|row| row.s0_minus_opensubdiv.is_none()) {
        text += "\nOpenSubdiv has no such scheme: S0 and the refined values are formwork's own.\n";
    }
    let verdict = if report.holds() { "OK" } else { "FAIL" };
    text + &format!(
        "\nCommutation d S = S d: worst deviation {}, tolerance {:.0e}: {verdict}\n",
        short(report.worst()),
        report.tolerance
    )
}

/// OpenSubdiv has no such scheme where there is nothing to compare with.
fn optional(deviation: Option<f64>) -> String {
    deviation.map_or("-".to_owned(), short)
}

fn short(deviation: f64) -> String {
    if deviation == 0.0 { "0".to_owned() } else { format!("{deviation:.1e}") }
}
