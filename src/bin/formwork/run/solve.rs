use formwork::cochain::Cochain;
use formwork::fem::{
    Diffusion, Elements, FemError, HilbertComplex, HodgeLaplace, Problem, Quadrature, Resolvent, Task,
    interior, poisson,
};
use formwork::hierarchy::Hierarchy;
use formwork::io::fields::Fields;
use formwork::io::{self, Frames};
use formwork::limit::LimitSurface;
use formwork::sparse::apply;
use serde_json::{Value, json};

use super::{Outcome, count, progress_bar, subdivide};
use crate::Failure;
use crate::args::Solve;
use crate::job::{Job, check_outputs};

/// What a task leaves: a form on the cells that are free, and what to say of it.
struct Found {
    form: Vec<f64>,
    text: String,
    json: Value,
}

pub fn run(args: &Solve) -> Result<Outcome, Failure> {
    let format = io::writer(&args.output)?;
    let mut job = Job::settle_for(&args.common, Frames::Rest, Some(format))?;
    let mut inputs = vec![args.common.mesh.as_path(), &args.problem];
    inputs.extend(args.field.as_deref());
    let mut outputs = vec![args.output.clone()];
    outputs.extend(io::companion(&args.output, true));
    check_outputs(&inputs, &outputs)?;
    let problem = Problem::read(&args.problem)?;
    let fields = job.fields(args.field.as_deref())?;

    let bar = progress_bar(job.progress, 1, "solving");
    let level = usize::from(args.level);
    let surface = LimitSurface::with_levels(&job.cage, job.scheme, level)?;
    let hierarchy = surface.hierarchy();
    let data = match problem.task {
        Task::Eigenforms { .. } => None,
        _ => Some(data(hierarchy, &fields, problem.degree, level).ok_or_else(|| {
            let cells = ["vertices", "edges", "faces"][problem.degree];
            format!(
                "{}: there is no {}-form to work on: give its \"{cells}\" in --field",
                job.asset.label(),
                problem.degree
            )
        })?),
    };
    let elements = Elements::new(&surface, &job.asset.positions, &Quadrature::new(hierarchy.split_kind()));
    let mut complex = independent(&elements, level, problem.essential);
    let mut keep = [0, 1, 2].map(|k| vec![true; complex.len(k)]);
    if problem.essential {
        keep = interior(hierarchy.level(level).mesh());
        complex = complex.restricted(&keep);
    }
    let keep = &keep[problem.degree];
    let data = data.map(|data| {
        let kept = data.into_iter().zip(keep).filter(|(_, kept)| **kept);
        kept.map(|(x, _)| x).collect::<Vec<f64>>()
    });
    let of_mesh = |error: FemError| format!("{}: {error}", job.asset.label());
    let found = solve(&complex, &problem, data.as_deref()).map_err(of_mesh)?;
    let mut values = found.form.into_iter();
    let all = keep.iter().map(|kept| if *kept { values.next().unwrap_or(0.0) } else { 0.0 }).collect();
    drop(bar);

    let fields = match problem.degree {
        0 => Fields { form0: Some(Cochain::new(all)), ..Fields::default() },
        1 => Fields { form1: Some(Cochain::new(all)), ..Fields::default() },
        _ => Fields { form2: Some(Cochain::new(all)), ..Fields::default() },
    };
    let mut written = subdivide::refine_from("solve", &job, &fields, level, (level, true), &args.writing())?;
    written.text = format!(
        "{}, level {level}: {}-forms, {}\n{}{}",
        job.asset.label(),
        problem.degree,
        count(complex.len(problem.degree), "unknown"),
        found.text,
        written.text.split_once('\n').map_or("", |(_, rest)| rest)
    );
    written.json["degree"] = json!(problem.degree);
    written.json["unknowns"] = json!(complex.len(problem.degree));
    if let (Value::Object(to), Value::Object(from)) = (&mut written.json, found.json) {
        to.extend(from);
    }
    Ok(written)
}

/// The complex of a level, with nothing in it that is dependent.
fn independent(elements: &Elements, level: usize, essential: bool) -> HilbertComplex {
    let mut complex = elements.complex(level);
    // Where the surface had to be refined there are irregular vertices, and then no relations.
    if level == elements.surface().hierarchy().num_levels() {
        complex = complex.pinned(2, &elements.dependent(2));
        // Relations of edges reach the boundary: forms that vanish along it have none.
        if !essential {
            complex = complex.pinned(1, &elements.dependent(1));
        }
    }
    complex
}

/// The form of a degree on a level.
fn data(hierarchy: &Hierarchy, fields: &Fields, degree: usize, level: usize) -> Option<Vec<f64>> {
    fn refined<const K: usize>(
        hierarchy: &Hierarchy,
        form: Option<&Cochain<K>>,
        level: usize,
    ) -> Option<Vec<f64>> {
        let form = (1..=level).fold(form?.clone(), |form, l| hierarchy.refine(l, &form));
        Some(form.into_values())
    }
    match degree {
        0 => refined(hierarchy, fields.form0.as_ref(), level),
        1 => refined(hierarchy, fields.form1.as_ref(), level),
        _ => refined(hierarchy, fields.form2.as_ref(), level),
    }
}

fn solve(complex: &HilbertComplex, problem: &Problem, data: Option<&[f64]>) -> Result<Found, FemError> {
    let degree = problem.degree;
    match problem.task {
        Task::Solve { iterative } => {
            let load = apply(complex.mass(degree), data.unwrap_or_default());
            let (solution, condition) = if iterative {
                poisson(complex, &load)?
            } else {
                let laplace = HodgeLaplace::new(complex, degree)?;
                (laplace.solve(&load, None)?, laplace.resolvent().condition())
            };
            let aside = solution.defect.iter().map(|x| x * x).sum::<f64>().sqrt();
            let text = format!(
                "{}, the data's harmonic part set aside: {aside:.6}\nresidual {:.1e} after {}, condition {condition:.1e}\n",
                count(solution.defect.len(), "harmonic form"),
                solution.residual,
                count(solution.iterations, "step"),
            );
            let json = json!({
                "problem": "hodge-laplace",
                "harmonic_part": solution.defect,
                "residual": solution.residual,
                "iterations": solution.iterations,
                "condition": condition,
            });
            Ok(Found { form: solution.form, text, json })
        }
        Task::Eigenforms { count, show } => {
            let resolvent = Resolvent::new(complex, degree, Resolvent::natural_shift(complex))?;
            let mut spectrum = resolvent.lowest(count)?;
            let zeros = spectrum.zeros(resolvent.shift());
            let show = show.min(spectrum.values.len() - 1);
            let row = |(i, x): (usize, &f64)| {
                format!("  {i:>3}  {:.9}{}\n", x.max(0.0), if i == show { "  shown" } else { "" })
            };
            let rows: String = spectrum.values.iter().enumerate().map(row).collect();
            let betti = complex.betti()?[degree];
            let text = format!("eigenvalues, of which {zeros} are 0 (Betti number {betti}):\n{rows}");
            let json = json!({
                "problem": "eigenforms",
                "eigenvalues": spectrum.values,
                "residuals": spectrum.residuals,
                "zeros": zeros,
                "betti": betti,
                "shown": show,
                "condition": resolvent.condition(),
            });
            Ok(Found { form: spectrum.forms.swap_remove(show), text, json })
        }
        Task::Diffusion { step, steps, rule } => {
            let diffusion = Diffusion::new(complex, degree, step, rule)?;
            let mut form = data.unwrap_or_default().to_vec();
            let size = |w: &[f64]| {
                let weighed = apply(complex.mass(degree), w);
                w.iter().zip(weighed).map(|(x, y)| x * y).sum::<f64>().sqrt()
            };
            let before = size(&form);
            (0..steps).for_each(|_| diffusion.step(&mut form));
            let after = size(&form);
            let text =
                format!("{} of {step}: the norm went from {before:.6} to {after:.6}\n", count(steps, "step"));
            let json = json!({
                "problem": "diffusion",
                "steps": steps,
                "step": step,
                "norm": { "before": before, "after": after },
                "condition": diffusion.resolvent().condition(),
            });
            Ok(Found { form, text, json })
        }
    }
}
