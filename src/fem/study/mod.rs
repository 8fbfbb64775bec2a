//! Refinement studies: a boundary value problem of 1-forms with a known solution, on finer and finer lattices, and how fast
//! its errors fall.

mod expression;
mod lattice;
mod plot;
mod problems;
mod series;
mod spec;

pub use expression::Expression;
pub use lattice::{Cells, Lattice, Region};
pub use plot::svg;
pub use series::Series;
pub use spec::{Imposition, Method, Study};

use serde::Serialize;

use super::{
    BoundaryProblem, Data, Elements, Errors, FemError, Imposed, Metric, MixedProblem, Operator, Quadrature,
    square, triangle,
};
use crate::io::IoError;
use crate::limit::QuadratureRule;
use crate::topology::SplitKind;

/// Why there is no study.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum StudyError {
    #[error(transparent)]
    Read(#[from] IoError),
    #[error(
        "{file}: line {line}, column {column}: {reason}: see formwork study --help for what a study holds"
    )]
    Syntax { file: String, line: usize, column: usize, reason: String },
    #[error("{text:?} is no formula: {reason}")]
    Expression { text: String, reason: String },
    #[error("{field}: {reason}")]
    Field { field: &'static str, reason: String },
    #[error("there is no problem {name:?}: take one of {known}, or the file of a study")]
    Unknown { name: String, known: String },
    #[error("{count} cells along a unit of length are no lattice: take 2 to 1024")]
    Cells { count: u32 },
    #[error("with {cells} cells along a unit of length: {error}")]
    Solve { cells: u32, error: FemError },
}

/// What a study found on one lattice.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The size of a cell.
    pub h: f64,
    /// The number of unknowns.
    pub unknowns: usize,
    /// The names of the errors are those of [`Table::errors`].
    pub errors: Vec<f64>,
    /// `log2` of the error before over this one, `h` having been halved; for other steps by `h` as well.
    pub rates: Vec<Option<f64>>,
    /// What is left over of the last linear system, relative.
    pub residual: f64,
    /// An estimate of its condition number, in the 1-norm.
    pub condition: f64,
}

/// What a study found on one kind of cells.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Table {
    /// The cells.
    pub cells: Cells,
    /// What was measured.
    pub errors: Vec<&'static str>,
    /// A row for each lattice.
    pub rows: Vec<Row>,
}

impl Study {
    /// The lattices' elements in the study's metric, with a rule of its own or the default.
    fn elements<'a>(
        &self,
        surface: &'a crate::limit::LimitSurface,
        lattice: &Lattice,
        rules: &Quadrature,
        metric: &Metric,
    ) -> Elements<'a> {
        Elements::new(surface, &lattice.positions, rules)
            .with_metric(metric.clone())
            .within(|face| lattice.is_inside(face))
    }

    /// The rule by which the system is integrated.
    fn rule(&self, kind: SplitKind) -> Result<Quadrature, StudyError> {
        let wrong = |reason: String| StudyError::Field { field: "rule", reason };
        let rule = match (self.rule, kind) {
            (None, SplitKind::Quad) => square(if self.is_flat() { 4 } else { 5 }),
            (None, SplitKind::Triangle) => triangle(8),
            (Some(n), SplitKind::Quad) if (1..=10).contains(&n) => square(n),
            (Some(3), SplitKind::Triangle) => strang_fix(),
            (Some(n), SplitKind::Triangle) if [4, 6, 8].contains(&n) => triangle(n),
            (Some(n), SplitKind::Quad) => {
                return Err(wrong(format!("{n} points along an edge: take 1 to 10")));
            }
            (Some(n), SplitKind::Triangle) => {
                return Err(wrong(format!("there is no rule of degree {n} on triangles: take 3, 4, 6 or 8")));
            }
        };
        Ok(Quadrature::graded(vec![rule; 8]))
    }

    /// Solves on every lattice.
    ///
    /// # Errors
    /// If a formula makes no sense, or a system cannot be solved.
    pub fn run(&self, mut done: impl FnMut()) -> Result<Vec<Table>, StudyError> {
        let (data, metric) = (self.data()?, self.metric()?);
        let mut tables = Vec::new();
        for &cells in &self.elements {
            let mut rows: Vec<Row> = Vec::new();
            let mut errors = Vec::new();
            for &per_unit in &self.cells {
                let found = self
                    .once(cells, per_unit, &data, &metric)?
                    .map_err(|error| StudyError::Solve { cells: per_unit, error })?;
                errors = found.0;
                let mut row = found.1;
                if let Some(before) = rows.last() {
                    let step = (before.h / row.h).ln();
                    let rates = before.errors.iter().zip(&row.errors).map(|(a, b)| Some((a / b).ln() / step));
                    row.rates = rates.collect();
                }
                rows.push(row);
                done();
            }
            tables.push(Table { cells, errors, rows });
        }
        Ok(tables)
    }

    /// Solves on one lattice: the names of the errors, and the row without rates.
    #[allow(clippy::type_complexity)]
    fn once(
        &self,
        cells: Cells,
        per_unit: u32,
        data: &Data,
        metric: &Metric,
    ) -> Result<Result<(Vec<&'static str>, Row), FemError>, StudyError> {
        let kind = cells.kind();
        let lattice = Lattice::new(self.domain, cells, per_unit)?;
        let surface = lattice.surface();
        let elements = self.elements(&surface, &lattice, &self.rule(kind)?, metric);
        // Errors are measured by a finer rule than systems are assembled with.
        let finer = match kind {
            SplitKind::Quad => square(6),
            SplitKind::Triangle => conical(6),
        };
        let fine = self.elements(&surface, &lattice, &Quadrature::graded(vec![finer; 8]), metric);
        let row = |unknowns: usize, errors: Vec<f64>, [residual, condition]: [f64; 2]| Row {
            h: 1.0 / f64::from(per_unit),
            unknowns,
            rates: vec![None; errors.len()],
            errors,
            residual,
            condition,
        };
        let points = self.boundary_points;
        let primal = |operator: Operator| -> Result<(Vec<&'static str>, Row), FemError> {
            let problem = BoundaryProblem::new(&elements, operator, points);
            let imposed = match self.boundary {
                Imposition::Nitsche => match (Imposed::nitsche(operator, kind), self.factor) {
                    (Imposed::Nitsche([_, second]), Some(factor)) => Imposed::Nitsche([factor, second]),
                    (good, _) => good,
                },
                Imposition::Strong => Imposed::Strong,
                Imposition::Means => Imposed::Means,
                Imposition::Penalty => Imposed::Penalty(self.factor.unwrap_or(100.0)),
                Imposition::Nearest => Imposed::Means,
            };
            let solved = match self.boundary {
                Imposition::Nearest => problem.nearest(data)?,
                _ => problem.solve(data, imposed)?,
            };
            let off = BoundaryProblem::new(&fine, operator, 1).errors(&solved.form, &self.exact(data));
            let Errors { l2, energy, second } = off;
            let (names, errors) = match operator {
                Operator::HodgeLaplace => (vec!["L2", "energy"], vec![l2, energy]),
                Operator::BiLaplace => (vec!["L2", "H1", "H2"], vec![l2, energy, second]),
            };
            Ok((names, row(solved.unknowns, errors, [solved.residual, solved.condition])))
        };
        Ok(match self.method {
            Method::HodgeLaplace => primal(Operator::HodgeLaplace),
            Method::BiLaplace => primal(Operator::BiLaplace),
            Method::Mixed => MixedProblem::new(&elements, points).solve(data).map(|solved| {
                let off = MixedProblem::new(&fine, 1).errors(&solved, &self.exact(data));
                let errors = vec![off.l2, off.d, off.sigma];
                (
                    vec!["L2", "L2 of dw", "L2 of delta w"],
                    row(solved.unknowns, errors, [solved.residual, solved.condition]),
                )
            }),
        })
    }
}

/// The rule of 4 points and degree 3 of the thesis, with a negative weight.
fn strang_fix() -> QuadratureRule {
    let outer = [[0.2, 0.2], [0.6, 0.2], [0.2, 0.6]].map(|at| (at, 25.0 / 96.0));
    [&[([1.0 / 3.0; 2], -27.0 / 96.0)], &outer[..]].concat()
}

/// Gauss' points of a square, the square folded onto the triangle: exact to degree `2n - 2`.
fn conical(n: usize) -> QuadratureRule {
    square(n).into_iter().map(|([s, t], w)| ([s * (1.0 - t), t], w * (1.0 - t))).collect()
}
