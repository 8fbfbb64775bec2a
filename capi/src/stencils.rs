//! Operators as the tables that stencil evaluators take: sizes, indices and weights of row after row.

use formwork::hierarchy::Hierarchy;
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
pub struct FormworkStencils {
    /// The number of values that go in.
    pub num_control_values: usize,
    /// For each row its number of entries.
    pub sizes: Vec<u32>,
    /// For each entry of each row its column.
    pub indices: Vec<u32>,
    /// For each set a weight for each entry.
    pub weights: Vec<Vec<f64>>,
}

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
        Self::new(vec![refined(values)])?.joined([refined(derivatives(0)), refined(derivatives(1))])
    }

    /// The rows of one matrix after those of another, all of the same width.
    fn new(parts: Vec<Csr>) -> Result<Self, Invalid> {
        fits(parts.iter().map(|part| part.rows().max(part.nnz())).sum())?;
        let num_control_values = parts[0].cols();
        let (mut sizes, mut indices, mut weights) = (Vec::new(), Vec::new(), Vec::new());
        for part in parts {
            sizes.extend((0..part.rows()).map(|i| row_of(&part, i).0.len() as u32));
            let (_, columns, values) = part.into_raw_storage();
            if indices.is_empty() {
                (indices, weights) = (columns, values);
            } else {
                indices.extend(columns);
                weights.extend(values);
            }
        }
        Ok(FormworkStencils { num_control_values, sizes, indices, weights: vec![weights] })
    }

    /// These stencils with two more sets of weights, on the indices that any of the three has.
    fn joined(self, more: [Csr; 2]) -> Result<Self, Invalid> {
        let mut joined = FormworkStencils {
            num_control_values: self.num_control_values,
            sizes: Vec::with_capacity(self.sizes.len()),
            indices: Vec::new(),
            weights: vec![Vec::new(); 3],
        };
        let mut start = 0;
        for (i, &size) in self.sizes.iter().enumerate() {
            let own = start..start + size as usize;
            start = own.end;
            let mut rows = [
                (&self.indices[own.clone()], &self.weights[0][own]),
                row_of(&more[0], i),
                row_of(&more[1], i),
            ];
            let before = joined.indices.len();
            while let Some(column) = rows.iter().filter_map(|row| row.0.first()).min().copied() {
                joined.indices.push(column);
                for ((columns, weights), into) in rows.iter_mut().zip(&mut joined.weights) {
                    let here = columns.first() == Some(&column);
                    into.push(if here { weights[0] } else { 0.0 });
                    let rest = usize::from(here);
                    (*columns, *weights) = (&columns[rest..], &weights[rest..]);
                }
            }
            joined.sizes.push((joined.indices.len() - before) as u32);
        }
        fits(joined.indices.len())?;
        Ok(joined)
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
