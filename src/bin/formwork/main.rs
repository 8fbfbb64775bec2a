//! The command line: arguments -> job -> run. Everything it does is in the library's public API.
//!
//! Exit codes: 0 fine, 2 the input, the arguments or a file is at fault (one line on stderr), 3 a law does
//! not hold, 1 some assets of a batch failed.

mod args;
mod draw;
mod job;
mod run;

use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind as Usage;

use args::{Args, Command};
use run::Outcome;

/// What ends a run: a message for the user, in one line.
type Failure = Box<dyn std::error::Error>;

const LAW_BROKEN: u8 = 3;
const SOME_FAILED: u8 = 1;

fn main() -> ExitCode {
    // A damaged USD file may make its reader panic, which becomes a message like any other.
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if std::thread::current().name() != Some(formwork::io::usd::READER_THREAD) {
            hook(panic);
        }
    }));
    let args = match Args::try_parse() {
        Ok(args) => args,
        Err(error) => return usage(&error),
    };
    let (json, quiet, failing) = match (&args.command, args.command.common()) {
        (Command::Batch(args), _) => (args.json, args.quiet, SOME_FAILED),
        (Command::Study(args), _) => (args.json, args.quiet, LAW_BROKEN),
        (Command::Volume(args), _) => {
            let common = args.command.common();
            (common.json, common.quiet, LAW_BROKEN)
        }
        (command, None) if command.vertex().is_some() => {
            command.vertex().map_or((false, false, LAW_BROKEN), |v| (v.json, v.quiet, LAW_BROKEN))
        }
        (_, common) => common.map_or((false, false, LAW_BROKEN), |c| (c.json, c.quiet, LAW_BROKEN)),
    };
    let outcome = match args.command {
        Command::Inspect(args) => run::inspect::run(&args),
        Command::Subdivide(args) => run::subdivide::run(&args.into()),
        Command::Limit(args) => run::subdivide::run(&args.into()),
        Command::Evaluate(args) => run::evaluate::run(&args),
        Command::Operators(args) => run::operators::run(&args),
        Command::Solve(args) => run::solve::run(&args),
        Command::Masses(args) => run::masses::run(&args),
        Command::Validate(args) => run::validate::run(&args),
        Command::Design(args) => run::design::run(&args),
        Command::Decompose(args) => run::decompose::run(&args),
        Command::Streamlines(args) => run::streamlines::run(&args),
        Command::Study(args) => run::study::run(&args),
        Command::Spectrum(args) => run::spectrum::run(&args),
        Command::Stencil(args) => run::stencil::run(&args),
        Command::CharMap(args) => run::charmap::run(&args),
        Command::Basis(args) => run::basis::run(&args),
        Command::View(args) => run::view::run(&args),
        Command::Batch(args) => run::batch::run(&args),
        Command::Volume(args) => run::volume::run(&args.command),
    };
    match outcome.and_then(|outcome| report(&outcome, json, quiet).map(|()| outcome.holds)) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(failing),
        Err(failure) => complain(&failure.to_string()),
    }
}

fn report(outcome: &Outcome, json: bool, quiet: bool) -> Result<(), Failure> {
    if !json && !quiet {
        for note in &outcome.notes {
            // If stderr is closed, nobody wants the notes.
            let _ = writeln!(io::stderr(), "formwork: note: {}", one_line(note));
        }
    }
    let text = match json {
        true => format!("{}\n", outcome.to_json()),
        false => outcome.text.clone(),
    };
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        // `formwork ... | head` has seen what it wanted.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        Err(error) => {
            Err(format!("standard output cannot be written ({error}): redirect it elsewhere").into())
        }
        Ok(()) => Ok(()),
    }
}

fn complain(message: &str) -> ExitCode {
    let _ = writeln!(io::stderr(), "formwork: {}", one_line(message));
    ExitCode::from(2)
}

/// Help and version are answers; everything else becomes one line, like any other error.
fn usage(error: &clap::Error) -> ExitCode {
    match error.kind() {
        Usage::DisplayHelp | Usage::DisplayVersion => {
            let _ = error.print();
            ExitCode::SUCCESS
        }
        Usage::DisplayHelpOnMissingArgumentOrSubcommand => {
            let _ = error.print();
            ExitCode::from(2)
        }
        _ => {
            let text = error.render().to_string();
            let said = text.lines().map(str::trim);
            let said = said.filter(|line| !line.is_empty() && !line.starts_with("For more information"));
            let said: Vec<&str> = said.take_while(|line| !line.starts_with("Usage:")).collect();
            let said = said.join(" ");
            complain(&format!("{}; see formwork --help", said.strip_prefix("error: ").unwrap_or(&said)))
        }
    }
}

/// Names of files may hold line ends and other control characters; a message is one line all the same.
fn one_line(message: &str) -> String {
    let escape = |c: char| if c.is_control() { c.escape_default().to_string() } else { c.to_string() };
    message.chars().map(escape).collect()
}
