//! What a study is of, as JSON.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::series::Series;
use super::{Cells, Expression, Region, StudyError, problems};
use crate::fem::{Data, Metric, SpaceForm};
use crate::io::IoError;
use crate::limit::Taylor;

/// What is solved, and in which form.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// `Delta w = f`, all of `w` given on the boundary, by its energy ([`BoundaryProblem`](crate::fem::BoundaryProblem)).
    #[default]
    HodgeLaplace,
    /// `Delta Delta w = f`, likewise with `*dw` and `delta w`.
    BiLaplace,
    /// `Delta w = f` with natural data, `*w` and `*dw` on the boundary, and `delta w` as an unknown of its own
    /// ([`MixedProblem`](crate::fem::MixedProblem)).
    Mixed,
}

/// How boundary data is imposed: [`Imposed`](crate::fem::Imposed).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Imposition {
    /// By Nitsche's method.
    #[default]
    Nitsche,
    /// All of the traces.
    Strong,
    /// Their means over edges.
    Means,
    /// The squares of the means, with a factor.
    Penalty,
    /// Not at all: nothing is solved, and the best approximation in L2 is measured instead.
    Nearest,
}

/// A study: a problem in the chart `x`, `y`, and lattices to solve it on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Study {
    /// What it is called.
    #[serde(default = "Study::unnamed")]
    pub name: String,
    /// Where.
    #[serde(default)]
    pub domain: Region,
    /// What is solved.
    #[serde(default)]
    pub method: Method,
    /// The components of the solution by `dx` and `dy`, as formulas ([`Expression`]): its load and its boundary data are
    /// derived from it. `["poisson-1", "poisson-1"]` is the solution of `-u_xx - u_yy = 1` that is 0 on the boundary of the
    /// L-shape.
    pub solution: [String; 2],
    /// The components of the load, if it is not to be derived.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load: Option<[String; 2]>,
    /// The components of the form whose traces are prescribed, if they are not the solution's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub boundary_data: Option<[String; 2]>,
    /// A map of the chart whose image has the metric: 2 or 3 coordinates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<Vec<String>>,
    /// Or the metric itself: `g_11`, `g_12`, `g_22`. Without either it is flat.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub metric: Option<[String; 3]>,
    /// The kinds of cells.
    #[serde(default = "Study::both")]
    pub elements: Vec<Cells>,
    /// How data on the boundary is imposed.
    #[serde(default)]
    pub boundary: Imposition,
    /// The factor of Nitsche's squares, or of the penalty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factor: Option<f64>,
    /// The points of the rule along an edge of a quad, or the degree of that of a triangle (3 is the thesis' of 4 points).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rule: Option<usize>,
    /// The points on each edge of the boundary.
    #[serde(default = "Study::five")]
    pub boundary_points: usize,
    /// The cells along a unit of length, in the order in which they are gone through.
    #[serde(default = "Study::halvings")]
    pub cells: Vec<u32>,
}

impl Study {
    fn unnamed() -> String {
        "study".to_owned()
    }

    fn both() -> Vec<Cells> {
        vec![Cells::Quads, Cells::Triangles]
    }

    fn five() -> usize {
        5
    }

    fn halvings() -> Vec<u32> {
        vec![4, 8, 16, 32, 64]
    }

    /// A study by name: [`Study::NAMES`].
    pub fn named(name: &str) -> Option<Study> {
        problems::named(name)
    }

    /// The studies that have names.
    pub const NAMES: &'static [&'static str] = problems::NAMES;

    /// Reads a study.
    ///
    /// # Errors
    /// If the file cannot be read, or holds something else.
    pub fn load(path: &Path) -> Result<Study, StudyError> {
        let text = std::fs::read_to_string(path).map_err(IoError::read(path))?;
        serde_json::from_str(&text).map_err(|error| StudyError::Syntax {
            file: path.display().to_string(),
            line: error.line(),
            column: error.column(),
            reason: error.to_string().split(" at line").next().unwrap_or_default().to_owned(),
        })
    }

    /// Whether the metric is that of the plane.
    pub fn is_flat(&self) -> bool {
        self.map.is_none() && self.metric.is_none()
    }

    /// Whether everything in it makes sense.
    ///
    /// # Errors
    /// If not, saying what does not.
    pub fn check(&self) -> Result<(), StudyError> {
        let wrong =
            |field: &'static str, reason: &str| Err(StudyError::Field { field, reason: reason.to_owned() });
        if self.map.is_some() && self.metric.is_some() {
            return wrong("metric", "there is a map already: give one of the two");
        }
        if self.map.as_ref().is_some_and(|map| !(2..=3).contains(&map.len())) {
            return wrong("map", "a map has 2 or 3 coordinates");
        }
        if self.cells.is_empty() || self.elements.is_empty() {
            return wrong(
                "cells",
                "there are no lattices: name the cells along a unit of length, and their kinds",
            );
        }
        if let Some(&count) = self.cells.iter().find(|n| !(2..=1024).contains(*n)) {
            return Err(StudyError::Cells { count });
        }
        if !(1..=10).contains(&self.boundary_points) {
            return wrong("boundary-points", "take 1 to 10");
        }
        if self.factor.is_some_and(|x| !(x > 0.0 && x.is_finite())) {
            return wrong("factor", "take a number above 0");
        }
        if self.method == Method::Mixed && self.boundary != Imposition::Nitsche {
            return wrong("boundary", "the data of the mixed form is natural: leave this out");
        }
        self.elements.iter().try_for_each(|cells| self.rule(cells.kind()).map(|_| ()))?;
        self.data()?;
        self.metric()?;
        Ok(())
    }

    /// The data of the problem.
    ///
    /// # Errors
    /// If a formula makes no sense.
    pub fn data(&self) -> Result<Data, StudyError> {
        let solution = match &self.boundary_data {
            Some(boundary) => form(boundary)?,
            None => form(&self.solution)?,
        };
        let load = match (&self.load, &self.boundary_data) {
            (Some(load), _) => Some(form(load)?),
            (None, Some(_)) => {
                let reason = "without a load it would be the load as well: give one".to_owned();
                return Err(StudyError::Field { field: "boundary-data", reason });
            }
            (None, None) => None,
        };
        form(&self.solution)?;
        Ok(Data { solution, load })
    }

    /// What errors are measured against.
    pub(super) fn exact(&self, data: &Data) -> Data {
        let solution = form(&self.solution).unwrap_or_else(|_| data.solution.clone());
        Data { solution, load: None }
    }

    /// The metric.
    ///
    /// # Errors
    /// If a formula makes no sense.
    pub fn metric(&self) -> Result<Metric, StudyError> {
        let parse = |texts: &[String]| {
            texts.iter().map(|text| Expression::parse(text)).collect::<Result<Vec<_>, _>>()
        };
        if let Some(map) = &self.map {
            let map = parse(map)?;
            return Ok(Metric::mapped(move |p| {
                std::array::from_fn(|k| map.get(k).map_or(Taylor::constant(0.0), |x| x.at(&p)))
            }));
        }
        if let Some(tensor) = &self.metric {
            let tensor = parse(tensor)?;
            return Ok(Metric::chart(move |[x, y]| {
                std::array::from_fn(|k| tensor[k].at(&[x, y, Taylor::constant(0.0)]))
            }));
        }
        Ok(Metric::Surface)
    }
}

fn form(components: &[String; 2]) -> Result<SpaceForm, StudyError> {
    enum Component {
        Formula(Box<Expression>),
        Poisson(Series),
    }
    let parse = |text: &String| match text.as_str() {
        "poisson-1" => Ok(Component::Poisson(Series::fit())),
        text => Expression::parse(text).map(|x| Component::Formula(Box::new(x))),
    };
    let parsed = [parse(&components[0])?, parse(&components[1])?];
    Ok(SpaceForm::new(move |p| {
        let [x, y] = [0, 1].map(|k| match &parsed[k] {
            Component::Formula(formula) => formula.at(&p),
            Component::Poisson(series) => series.at(p[0], p[1]),
        });
        [x, y, Taylor::constant(0.0)]
    }))
}
