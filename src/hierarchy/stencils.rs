//! The operators as evaluators take them: lengths, columns and weights of row after row, a run of rows at a time.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::hubs::Hubs;
use super::refinement::Refinement;
use super::rows::{self, Mixed, Rule};
use crate::cochain::Quantity;
use crate::sparse::{Exceptions, front};
use crate::topology::Mesh;

/// The rows of `S0`, `S1` or `S2` of one step of refinement, made when they are asked for and not kept: what fills the
/// tables of evaluators without a matrix between. See [`Hierarchy::step_stencils`](super::Hierarchy::step_stencils).
#[derive(Clone, Debug)]
pub struct StepStencils {
    refinement: Arc<Refinement>,
    parent: Arc<Mesh>,
    degree: usize,
    /// Those of this degree, if they are not among the tables of the refinement.
    exceptions: Option<Exceptions>,
    hubs: Option<Hubs>,
}

/// Few enough rows that they stay in the cache, many enough that handing them to a thread costs nothing.
const RUN: usize = 2048;

impl StepStencils {
    pub(super) fn new(refinement: Arc<Refinement>, parent: Arc<Mesh>, degree: usize) -> Self {
        let exceptions = match rows::exceptions(&refinement, &parent, degree) {
            Cow::Owned(exceptions) => Some(exceptions),
            Cow::Borrowed(_) => None,
        };
        let hubs = if degree == 1 { Hubs::new(&refinement, &parent) } else { None };
        StepStencils { refinement, parent, degree, exceptions, hubs }
    }

    /// The number of rows and columns: cells of the child and of the parent.
    pub fn shape(&self) -> (usize, usize) {
        (self.refinement.split.num_children(self.degree), self.parent.num_cells(self.degree))
    }

    /// The number of terms of a run of rows.
    ///
    /// # Panics
    /// If there are no such rows.
    pub fn num_terms(&self, rows: Range<usize>) -> usize {
        assert!(rows.end <= self.shape().0, "rows {rows:?} of {}", self.shape().0);
        match self.degree {
            0 => self.s0().num_terms(rows),
            1 => self.s1().num_terms(rows),
            _ => self.s2().num_terms(rows),
        }
    }

    /// Writes a run of rows, in parallel: the length of each, and one row after the other their columns, in any order but
    /// none twice in a row, and their weights, of either precision.
    ///
    /// # Panics
    /// If there are no such rows, or `lengths` is not as long as the run or `columns` and `weights` are not as
    /// [`StepStencils::num_terms`] says.
    pub fn write<W: Quantity>(
        &self,
        rows: Range<usize>,
        lengths: &mut [u32],
        columns: &mut [u32],
        weights: &mut [W],
    ) {
        assert!(rows.end <= self.shape().0, "rows {rows:?} of {}", self.shape().0);
        match self.degree {
            0 => write(&self.s0(), rows, lengths, columns, weights),
            1 => write(&self.s1(), rows, lengths, columns, weights),
            _ => write(&self.s2(), rows, lengths, columns, weights),
        }
    }

    fn exceptions(&self) -> Cow<'_, Exceptions> {
        Cow::Borrowed(self.exceptions.as_ref().unwrap_or(&self.refinement.s1_exceptions))
    }

    fn s0(&self) -> Mixed<'_, impl Rule> {
        rows::of_s0(&self.refinement, &self.parent, self.exceptions())
    }

    fn s1(&self) -> Mixed<'_, impl Rule> {
        rows::of_s1(&self.refinement, &self.parent, self.exceptions(), self.hubs.as_ref())
    }

    fn s2(&self) -> Mixed<'_, impl Rule> {
        rows::of_s2(&self.refinement, &self.parent, self.exceptions())
    }
}

fn write<W: Quantity>(
    of: &Mixed<impl Rule>,
    rows: Range<usize>,
    mut lengths: &mut [u32],
    mut columns: &mut [u32],
    mut weights: &mut [W],
) {
    assert_eq!(lengths.len(), rows.len(), "one length for each row");
    assert_eq!(columns.len(), weights.len(), "a weight for each column");
    let mut runs = Vec::with_capacity(rows.len().div_ceil(RUN));
    for start in rows.clone().step_by(RUN) {
        let run = start..rows.end.min(start + RUN);
        let terms = of.num_terms(run.clone());
        let parts = (front(&mut lengths, run.len()), front(&mut columns, terms), front(&mut weights, terms));
        runs.push((run, parts));
    }
    assert!(columns.is_empty(), "room for the terms of these rows and no more");
    let one = |(run, (lengths, columns, weights))| of.write(run, lengths, columns, weights);
    // To hand over to a pool of one thread, and to wait for it, would take longer than small runs do.
    match rayon::current_num_threads() {
        1 => runs.into_iter().for_each(one),
        _ => runs.into_par_iter().for_each(one),
    }
}
