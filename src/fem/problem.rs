//! Problems on surfaces as JSON.

use std::fs;
use std::path::Path;

use serde::Deserialize;

use super::TimeRule;
use crate::io::IoError;

/// A problem for the Hodge Laplacian of a degree.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The degree of the forms, 0 to 2.
    pub degree: usize,
    /// Whether forms are 0 on the boundary (1-forms: along it), instead of its natural conditions.
    pub essential: bool,
    /// What is asked.
    pub task: Task,
}

/// What is asked of a Hodge Laplacian.
#[derive(Clone, Debug, PartialEq)]
pub enum Task {
    /// `w` with `Delta w = f - P f`.
    Solve {
        /// Whether by conjugate gradients instead of factors; functions only.
        iterative: bool,
    },
    /// The lowest eigenforms; the form with this number, from 0, is the one to be shown.
    Eigenforms {
        /// How many.
        count: usize,
        /// Which is shown.
        show: usize,
    },
    /// What becomes of a form.
    Diffusion {
        /// The length of a step.
        step: f64,
        /// The number of steps.
        steps: usize,
        /// Their rule.
        rule: TimeRule,
    },
}

/// What is wrong with a problem file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum ProblemError {
    #[error(transparent)]
    Read(#[from] IoError),
    #[error(
        "{file}: line {line}, column {column}: {reason}: see formwork solve --help for what a problem is"
    )]
    Syntax { file: String, line: usize, column: usize, reason: String },
    #[error("{file}: \"{key}\": {reason}")]
    Value { file: String, key: &'static str, reason: &'static str },
}

#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum Kind {
    Poisson,
    HodgeLaplace,
    Eigenforms,
    Diffusion,
}

#[derive(Clone, Copy, Default, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum Boundary {
    #[default]
    Natural,
    Essential,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Rule {
    #[default]
    Euler,
    CrankNicolson,
}

#[derive(Clone, Copy, Default, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum Solver {
    #[default]
    Direct,
    Iterative,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    problem: Kind,
    degree: Option<usize>,
    #[serde(default)]
    boundary: Boundary,
    count: Option<usize>,
    show: Option<usize>,
    step: Option<f64>,
    steps: Option<usize>,
    rule: Option<Rule>,
    solver: Option<Solver>,
}

impl Problem {
    /// Reads a problem from a file, see [`Problem::parse`].
    ///
    /// # Errors
    /// [`ProblemError`].
    pub fn read(path: &Path) -> Result<Self, ProblemError> {
        let bytes = fs::read(path).map_err(IoError::read(path))?;
        Self::parse(&path.display().to_string(), &bytes)
    }

    /// Reads a problem from the contents of a file, one of these; `name` is used in messages:
    ///
    /// ```json
    /// {"problem": "poisson", "solver": "iterative"}
    /// {"problem": "hodge-laplace", "degree": 1, "boundary": "essential"}
    /// {"problem": "eigenforms", "degree": 1, "count": 6, "show": 4}
    /// {"problem": "diffusion", "degree": 1, "step": 0.01, "steps": 10, "rule": "crank-nicolson"}
    /// ```
    ///
    /// # Errors
    /// [`ProblemError::Syntax`], [`ProblemError::Value`].
    pub fn parse(name: &str, bytes: &[u8]) -> Result<Self, ProblemError> {
        let file: File = serde_json::from_slice(bytes).map_err(|error| {
            let message = error.to_string();
            let place = format!(" at line {} column {}", error.line(), error.column());
            let reason = message.strip_suffix(&place).unwrap_or(&message).to_owned();
            ProblemError::Syntax { file: name.to_owned(), line: error.line(), column: error.column(), reason }
        })?;
        let wrong = |key, reason| Err(ProblemError::Value { file: name.to_owned(), key, reason });
        let kind = file.problem;
        let strays = [
            ("count", file.count.is_some() && kind != Kind::Eigenforms),
            ("show", file.show.is_some() && kind != Kind::Eigenforms),
            ("step", file.step.is_some() && kind != Kind::Diffusion),
            ("steps", file.steps.is_some() && kind != Kind::Diffusion),
            ("rule", file.rule.is_some() && kind != Kind::Diffusion),
            ("solver", file.solver.is_some() && kind != Kind::Poisson),
        ];
        if let Some((key, _)) = strays.into_iter().find(|(_, stray)| *stray) {
            return wrong(key, "belongs to another problem: leave it out");
        }
        let degree = match (kind, file.degree) {
            (Kind::Poisson, None | Some(0)) => 0,
            (Kind::Poisson, _) => {
                return wrong("degree", "Poisson's problem is one of functions: ask for hodge-laplace");
            }
            (_, Some(degree @ 0..=2)) => degree,
            (_, None) => return wrong("degree", "is missing: give 0, 1 or 2"),
            _ => return wrong("degree", "a surface has forms of degree 0, 1 and 2: give one of these"),
        };
        let task = match kind {
            Kind::Poisson | Kind::HodgeLaplace => {
                Task::Solve { iterative: file.solver.unwrap_or_default() == Solver::Iterative }
            }
            Kind::Eigenforms => {
                let (count, show) = (file.count.unwrap_or(6), file.show.unwrap_or(0));
                if !(1..=200).contains(&count) {
                    return wrong("count", "give a number from 1 to 200");
                }
                if show >= count {
                    return wrong("show", "is the number of a form, from 0, below \"count\"");
                }
                Task::Eigenforms { count, show }
            }
            Kind::Diffusion => {
                let Some(step) = file.step else {
                    return wrong("step", "is missing: give the length of a step, in units of length^2");
                };
                if !(1e-30..1e30).contains(&step) {
                    return wrong("step", "give a positive number");
                }
                let steps = file.steps.unwrap_or(1);
                if steps > 1_000_000 {
                    return wrong("steps", "give a million at most");
                }
                let rule = match file.rule.unwrap_or_default() {
                    Rule::Euler => TimeRule::Euler,
                    Rule::CrankNicolson => TimeRule::CrankNicolson,
                };
                Task::Diffusion { step, steps, rule }
            }
        };
        Ok(Problem { degree, essential: file.boundary == Boundary::Essential, task })
    }
}
