use std::io::Write;
use std::path::Path;

use formwork::fem::study::{Study, StudyError, Table, svg};
use formwork::io::atomic;
use serde_json::json;

use super::{Outcome, progress_bar_of};
use crate::Failure;
use crate::args;
use crate::job::{check_outputs, format_of};

pub fn run(args: &args::Study) -> Result<Outcome, Failure> {
    for output in &args.output {
        format_of(output, &["json", "svg"])?;
    }
    let mut study = settle(&args.problem)?;
    if !args.cells.is_empty() {
        study.cells.clone_from(&args.cells);
    }
    if let Some(elements) = args.elements {
        study.elements = vec![elements];
    }
    let place = |error: StudyError| match Study::named(&args.problem) {
        Some(_) => error.to_string(),
        None => format!("{}: {error}", args.problem),
    };
    study.check().map_err(place)?;
    check_outputs(&[Path::new(&args.problem)], &args.output)?;
    let steps = study.cells.len() * study.elements.len();
    let bar = progress_bar_of(!args.quiet, steps as u64, "solving");
    let tables = study.run(|| bar.inc(1)).map_err(place)?;
    drop(bar);
    let json = json!({ "command": "study", "study": study, "tables": tables });
    let mut text = report(&study, &tables);
    for output in &args.output {
        match format_of(output, &["json", "svg"])? {
            "json" => atomic::write(output, |out| Ok(serde_json::to_writer_pretty(out, &json)?))?,
            _ => atomic::write(output, |out| out.write_all(svg(&study, &tables).as_bytes()))?,
        }
        text += &format!("wrote {}\n", output.display());
    }
    Ok(Outcome { text, json, notes: Vec::new(), holds: true })
}

/// A study by name, or that of a file.
fn settle(problem: &str) -> Result<Study, Failure> {
    if let Some(study) = Study::named(problem) {
        return Ok(study);
    }
    let path = Path::new(problem);
    if path.extension().is_none() && !path.exists() {
        let error = StudyError::Unknown { name: problem.to_owned(), known: Study::NAMES.join(", ") };
        return Err(error.into());
    }
    Ok(Study::load(path)?)
}

fn report(study: &Study, tables: &[Table]) -> String {
    let mut text = String::new();
    for table in tables {
        text += &format!("{}, {}\n", study.name, table.cells.name());
        text += "     h  unknowns";
        for error in &table.errors {
            text += &format!("  {error:>13}   rate");
        }
        text += "  residual  condition\n";
        for row in &table.rows {
            text += &format!("{:>6}  {:>8}", format!("1/{:.0}", 1.0 / row.h), row.unknowns);
            for (error, rate) in row.errors.iter().zip(&row.rates) {
                let rate = rate.map_or("-".to_owned(), |rate| format!("{rate:.2}"));
                text += &format!("  {error:>13.3e}  {rate:>5}");
            }
            text += &format!("  {:>8.1e}  {:>9.1e}\n", row.residual, row.condition);
        }
        text.push('\n');
    }
    text
}
