//! Operators as the tables that stencil evaluators take: sizes, indices and weights of row after row.

use std::ops::Range;

use formwork::cochain::Quantity;
use formwork::hierarchy::{Hierarchy, StepStencils};
use formwork::limit::LimitTangents;
use formwork::sparse::{Csr, assemble, multiply, row_of};
use formwork::topology::Mesh;

use crate::error::Invalid;
use crate::hierarchy::FormworkHierarchy;

/// At every vertex of the level.
pub const FORMWORK_AT_VERTICES: u32 = 0;
/// At every corner of every face of the level, so that both sides of a crease are there.
pub const FORMWORK_AT_CORNERS: u32 = 1;

/// Stencils: rows that share their indices among one or more sets of weights.
pub enum FormworkStencils {
    /// Of one step of refinement, whose rows are made when they are asked for.
    Step(StepStencils),
    /// Of matrices.
    Stored {
        /// The number of values that go in.
        num_control_values: usize,
        /// Where each row starts, and the last ends.
        offsets: Vec<usize>,
        /// For each entry of each row its column.
        indices: Vec<u32>,
        /// For each set a weight for each entry.
        weights: Vec<Vec<f64>>,
    },
}

use FormworkStencils::{Step, Stored};

impl FormworkStencils {
    /// Refinement of `degree`-forms from one level to a finer one: the rows of that level or, with `intermediate`,
    /// of all levels after the first, level after level.
    pub fn refining(
        hierarchy: &FormworkHierarchy,
        degree: i32,
        levels: [i32; 2],
        intermediate: bool,
    ) -> Result<Self, Invalid> {
        let [from, to] = [hierarchy.level(levels[0])?, hierarchy.level(levels[1])?];
        let degree = check_degree(degree, 2)?;
        if from >= to {
            return Err(Invalid(format!(
                "stencils from level {from} to level {to}: the second must be the finer"
            )));
        }
        let hierarchy = hierarchy.levels();
        if to == from + 1 {
            let step = hierarchy.step_stencils(degree, to);
            let rows = step.shape().0;
            fits(step.num_terms(0..rows).max(rows))?;
            return Ok(Step(step));
        }
        if !intermediate {
            return Self::new(vec![hierarchy.composed_operator(degree, from, to)]);
        }
        let mut product = hierarchy.operator(degree, from + 1);
        let mut parts = Vec::new();
        for level in from + 2..=to {
            let next = multiply(&hierarchy.operator(degree, level), &product);
            parts.push(std::mem::replace(&mut product, next));
        }
        parts.push(product);
        Self::new(parts)
    }

    /// The limit of `degree`-forms on a level: values at vertices, circulations along edges, or integrals over
    /// faces, of forms on `from` that are refined to `level`.
    pub fn limits(hierarchy: &FormworkHierarchy, degree: i32, levels: [i32; 2]) -> Result<Self, Invalid> {
        let [from, level] = from_to(hierarchy, levels)?;
        let degree = check_degree(degree, 2)?;
        let (limit, _) = hierarchy.limit(level)?;
        let hierarchy = hierarchy.levels();
        let operators = limit.operators(hierarchy.level(level).mesh());
        let limit = match degree {
            0 => operators.l0,
            1 => operators.l1,
            _ => operators.l2,
        };
        Self::new(vec![refined_first(hierarchy, degree, limit, from, level)])
    }

    /// Points of the limit surface of a level: 0-forms as their value and their derivatives along the two limit
    /// tangents, three sets of weights; 1-forms as their values along these tangents, two rows a point.
    pub fn points(
        hierarchy: &FormworkHierarchy,
        degree: i32,
        levels: [i32; 2],
        place: u32,
    ) -> Result<Self, Invalid> {
        let [from, level] = from_to(hierarchy, levels)?;
        let degree = check_degree(degree, 1)?;
        let (limit, tangents) = hierarchy.limit(level)?;
        let hierarchy = hierarchy.levels();
        let mesh = hierarchy.level(level).mesh();
        let points = points(mesh, tangents, place)?;
        let of_tangent = |row: usize, add: &mut dyn FnMut(u32, f64)| {
            if let Some(pair) = points[row / 2].pair {
                let (edges, weights) = row_of(tangents.rows(), 2 * pair + row % 2);
                edges.iter().zip(weights).for_each(|(&e, &weight)| add(e, weight));
            }
        };
        let refined = |rows| refined_first(hierarchy, degree, rows, from, level);
        if degree == 1 {
            let rows = assemble((2 * points.len(), mesh.num_edges()), |i, row| {
                of_tangent(i, &mut |e, weight| row.add(e, weight));
            });
            return Self::new(vec![refined(rows)]);
        }
        let l0 = limit.operators(mesh).l0;
        let values = assemble((points.len(), mesh.num_vertices()), |i, row| {
            row.add_row(&l0, points[i].vertex as usize, 1.0);
        });
        let derivatives = |which| {
            assemble((points.len(), mesh.num_vertices()), |i, row| {
                of_tangent(2 * i + which, &mut |e, weight| {
                    let [tail, head] = mesh.edges()[e as usize];
                    row.add(head, weight);
                    row.add(tail, -weight);
                });
            })
        };
        Self::joined([values, derivatives(0), derivatives(1)].map(refined))
    }

    /// The rows of one matrix after those of another, all of the same width.
    fn new(parts: Vec<Csr>) -> Result<Self, Invalid> {
        fits(parts.iter().map(|part| part.rows().max(part.nnz())).sum())?;
        let num_control_values = parts[0].cols();
        let (mut offsets, mut indices, mut weights) = (vec![0], Vec::new(), Vec::new());
        for part in parts {
            let before = indices.len();
            offsets.extend(part.indptr().raw_storage()[1..].iter().map(|end| before + end));
            let (_, columns, values) = part.into_raw_storage();
            if before == 0 {
                (indices, weights) = (columns, values);
            } else {
                indices.extend(columns);
                weights.extend(values);
            }
        }
        Ok(Stored { num_control_values, offsets, indices, weights: vec![weights] })
    }

    /// Matrices of the same shape as one set of weights each, on the indices that any of them has.
    fn joined(matrices: [Csr; 3]) -> Result<Self, Invalid> {
        let (mut offsets, mut indices, mut weights) = (vec![0], Vec::new(), vec![Vec::new(); 3]);
        for i in 0..matrices[0].rows() {
            let mut rows = matrices.each_ref().map(|matrix| row_of(matrix, i));
            while let Some(column) = rows.iter().filter_map(|row| row.0.first()).min().copied() {
                indices.push(column);
                for ((columns, values), into) in rows.iter_mut().zip(&mut weights) {
                    let here = columns.first() == Some(&column);
                    into.push(if here { values[0] } else { 0.0 });
                    let rest = usize::from(here);
                    (*columns, *values) = (&columns[rest..], &values[rest..]);
                }
            }
            offsets.push(indices.len());
        }
        fits(indices.len())?;
        Ok(Stored { num_control_values: matrices[0].cols(), offsets, indices, weights })
    }

    /// The number of values that go in.
    pub fn num_control_values(&self) -> usize {
        match self {
            Step(step) => step.shape().1,
            Stored { num_control_values, .. } => *num_control_values,
        }
    }

    /// The number of rows.
    pub fn num_rows(&self) -> usize {
        match self {
            Step(step) => step.shape().0,
            Stored { offsets, .. } => offsets.len() - 1,
        }
    }

    /// The number of sets of weights.
    pub fn num_sets(&self) -> usize {
        match self {
            Step(_) => 1,
            Stored { weights, .. } => weights.len(),
        }
    }

    /// So many rows from `first` on.
    pub fn run(&self, first: u32, count: u32) -> Result<Range<usize>, Invalid> {
        let (first, count, rows) = (first as usize, count as usize, self.num_rows());
        match first.checked_add(count).is_some_and(|end| end <= rows) {
            true => Ok(first..first + count),
            false => {
                Err(Invalid(format!("there are no {count} rows from {first} on: these stencils have {rows}")))
            }
        }
    }

    /// The number of entries of a run of rows.
    pub fn num_entries(&self, rows: Range<usize>) -> usize {
        match self {
            Step(step) => step.num_terms(rows),
            Stored { offsets, .. } => offsets[rows.end] - offsets[rows.start],
        }
    }

    /// `set`, if there is such a set of weights.
    pub fn set(&self, set: u32) -> Result<usize, Invalid> {
        let sets = self.num_sets();
        let found = Some(set as usize).filter(|&set| set < sets);
        found.ok_or_else(|| Invalid(format!("there is no set of weights {set}: these stencils have {sets}")))
    }

    /// Writes a run of rows: the number of entries of each, and row after row their indices and weights.
    pub fn write<W: Quantity>(
        &self,
        set: usize,
        rows: Range<usize>,
        sizes: &mut [u32],
        indices: &mut [u32],
        weights: &mut [W],
    ) {
        match self {
            Step(step) => step.write(rows, sizes, indices, weights),
            Stored { offsets, indices: all, weights: sets, .. } => {
                let entries = offsets[rows.start]..offsets[rows.end];
                let ends = offsets[rows.start..=rows.end].windows(2);
                sizes.iter_mut().zip(ends).for_each(|(size, ends)| *size = (ends[1] - ends[0]) as u32);
                indices.copy_from_slice(&all[entries.clone()]);
                let weights = weights.iter_mut().zip(&sets[set][entries]);
                weights.for_each(|(to, &weight)| *to = W::one().scale(weight));
            }
        }
    }
}

/// A point of the surface where a limit is taken.
struct Point {
    vertex: u32,
    /// The number of its tangents, if it has any.
    pair: Option<usize>,
}

fn points(mesh: &Mesh, tangents: &LimitTangents, place: u32) -> Result<Vec<Point>, Invalid> {
    let at_vertex = |vertex: u32| {
        let corners = mesh.fans(vertex).flat_map(|fan| fan.corners);
        Point { vertex, pair: corners.filter_map(|&c| tangents.pair_of_corner(c)).next() }
    };
    let at_corner = |c: u32| Point { vertex: mesh.corner_vertex(c), pair: tangents.pair_of_corner(c) };
    match place {
        FORMWORK_AT_VERTICES => Ok((0..mesh.num_vertices() as u32).map(at_vertex).collect()),
        FORMWORK_AT_CORNERS => Ok((0..mesh.num_corners() as u32).map(at_corner).collect()),
        _ => Err(Invalid(format!("the place is {place}: use 0 for vertices or 1 for corners"))),
    }
}

/// `rows`, which act on `level`, after refinement from level `from`.
fn refined_first(hierarchy: &Hierarchy, degree: usize, rows: Csr, from: usize, level: usize) -> Csr {
    (from + 1..=level).rev().fold(rows, |rows, level| multiply(&rows, &hierarchy.operator(degree, level)))
}

fn from_to(hierarchy: &FormworkHierarchy, levels: [i32; 2]) -> Result<[usize; 2], Invalid> {
    let [from, level] = [hierarchy.level(levels[0])?, hierarchy.level(levels[1])?];
    match from <= level {
        true => Ok([from, level]),
        false => Err(Invalid(format!(
            "the limit on level {level} of forms on level {from}: the first must be the finer"
        ))),
    }
}

fn check_degree(degree: i32, most: usize) -> Result<usize, Invalid> {
    let taken = if most == 2 { "0, 1 or 2" } else { "0 or 1" };
    let found = usize::try_from(degree).ok().filter(|&degree| degree <= most);
    found.ok_or_else(|| Invalid(format!("the degree is {degree}: use {taken} here")))
}

/// Evaluators count entries in 31 bits.
fn fits(entries: usize) -> Result<(), Invalid> {
    match entries <= i32::MAX as usize {
        true => Ok(()),
        false => Err(Invalid(format!(
            "{entries} entries are more than stencil tables hold: take one level at a time"
        ))),
    }
}
