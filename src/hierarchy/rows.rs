//! The rows of the operators: those of the exceptions, which are stored, and for all others those of a rule.

use std::borrow::Cow;
use std::ops::Range;

use super::hubs::{EVEN_TERMS, Hubs, ODD_TERMS};
use super::refinement::Refinement;
use crate::cochain::Quantity;
use crate::scheme::Regular;
use crate::sparse::{Exceptions, Row};
use crate::topology::{ChildEdge, HalfEdge, Mesh, Parent, SplitKind};

/// The most terms of a regular row. Centres of larger polygons count as exceptions.
pub const LONGEST: usize = 10;

/// The terms of a regular row, in any order, no column twice.
#[derive(Default)]
pub struct Terms {
    pub columns: [u32; LONGEST],
    pub weights: [f64; LONGEST],
    pub len: usize,
}

/// The formula of the regular rows of an operator.
pub trait Rule: Sync {
    /// The number of terms of a row.
    fn length(&self, row: usize) -> usize;

    /// The number of terms of a run of rows.
    fn lengths(&self, rows: Range<usize>) -> usize {
        rows.map(|row| self.length(row)).sum()
    }

    /// The terms of a row, in any order, no column twice: the column, the weight, and whether it is to be negated. The weight
    /// by itself is one of a few constants, which are rounded to the precision that is wanted when this is compiled.
    fn visit(&self, row: usize, visit: impl FnMut(u32, f64, bool));

    /// Writes the terms to the beginning of two arrays and says how many they are. What follows may be overwritten.
    #[inline]
    fn write<W: Quantity>(
        &self,
        row: usize,
        columns: &mut [u32; LONGEST],
        weights: &mut [W; LONGEST],
    ) -> usize {
        let mut len = 0;
        self.visit(row, |column, weight, negative| {
            (columns[len], weights[len]) = (column, W::one().scale(weight).negate_if(negative));
            len += 1;
        });
        len
    }

    /// Writes a run of rows, one after the other, to the beginning of two slices, and says how many terms they have.
    fn write_all<W: Quantity>(&self, rows: Range<usize>, columns: &mut [u32], weights: &mut [W]) -> usize {
        self.write_each(rows, columns, weights)
    }

    /// The same by [`Rule::write`].
    fn write_each<W: Quantity>(&self, rows: Range<usize>, columns: &mut [u32], weights: &mut [W]) -> usize {
        let mut end = 0;
        for row in rows {
            let (columns, weights) = (&mut columns[end..], &mut weights[end..]);
            end += match (columns.first_chunk_mut(), weights.first_chunk_mut()) {
                (Some(columns), Some(weights)) => self.write(row, columns, weights),
                // The last rows of all.
                _ => {
                    let mut terms = Terms::default();
                    self.get(row, &mut terms);
                    copy((&terms.columns[..terms.len], &terms.weights[..terms.len]), columns, weights)
                }
            };
        }
        end
    }

    /// Puts the terms into `terms`.
    #[inline]
    fn get(&self, row: usize, terms: &mut Terms) {
        terms.len = self.write(row, &mut terms.columns, &mut terms.weights);
    }
}

/// The columns and weights of a row.
type Stored<'a> = (&'a [u32], &'a [f64]);

/// The rows of an operator, one at a time.
pub trait Rows: Sync {
    /// The columns of a row, none twice, in any order, and their weights. `terms` may be where they are kept.
    fn get<'t>(&'t self, row: usize, terms: &'t mut Terms) -> (&'t [u32], &'t [f64]);
}

/// The rows of the exceptions, and those of a rule for the others.
pub struct Mixed<'a, R> {
    pub shape: (usize, usize),
    pub exceptions: Cow<'a, Exceptions>,
    pub rule: R,
}

impl<R: Rule> Rows for Mixed<'_, R> {
    #[inline]
    fn get<'t>(&'t self, row: usize, terms: &'t mut Terms) -> (&'t [u32], &'t [f64]) {
        self.exceptions.get(row).unwrap_or_else(|| {
            self.rule.get(row, terms);
            (&terms.columns[..terms.len], &terms.weights[..terms.len])
        })
    }
}

impl<R: Rule> Mixed<'_, R> {
    /// Each of a run of rows: where it is stored, or `None` where it follows the rule.
    #[inline]
    pub fn stored(&self, rows: Range<usize>) -> impl Iterator<Item = (usize, Option<Stored<'_>>)> {
        let exceptions = &*self.exceptions;
        let mut among = exceptions.among(rows.clone()).peekable();
        rows.map(move |row| {
            let position = among.next_if(|&position| exceptions.members()[position] as usize == row);
            (row, position.map(|position| exceptions.stored(position)))
        })
    }

    /// The number of terms of each of a run of rows.
    pub fn lengths(&self, rows: Range<usize>) -> impl Iterator<Item = usize> {
        self.stored(rows).map(|(row, stored)| match stored {
            Some((columns, _)) => columns.len(),
            None => self.rule.length(row),
        })
    }

    /// The number of terms of a run of rows, all together: those of all if they were regular, and what is different.
    pub fn num_terms(&self, rows: Range<usize>) -> usize {
        let among = self.exceptions.among(rows.clone());
        let others = self.exceptions.members()[among.clone()].iter();
        let others: usize = others.map(|&row| self.rule.length(row as usize)).sum();
        self.rule.lengths(rows) - others + self.exceptions.num_terms(among)
    }

    /// Writes a run of rows one after the other, their terms in any order, and the length of each.
    pub fn write<W: Quantity>(
        &self,
        rows: Range<usize>,
        lengths: &mut [u32],
        mut columns: &mut [u32],
        mut weights: &mut [W],
    ) {
        lengths.iter_mut().zip(rows.clone()).for_each(|(out, row)| *out = self.rule.length(row) as u32);
        let mut next = rows.start;
        for position in self.exceptions.among(rows.clone()) {
            let row = self.exceptions.members()[position] as usize;
            let before = self.rule.write_all(next..row, columns, weights);
            (columns, weights) = (&mut columns[before..], &mut weights[before..]);
            let len = copy(self.exceptions.stored(position), columns, weights);
            (columns, weights) = (&mut columns[len..], &mut weights[len..]);
            lengths[row - rows.start] = len as u32;
            next = row + 1;
        }
        self.rule.write_all(next..rows.end, columns, weights);
    }
}

/// Copies a row to the beginning of two slices; its length.
fn copy<W: Quantity>(row: Stored, columns: &mut [u32], weights: &mut [W]) -> usize {
    let len = row.0.len();
    columns[..len].copy_from_slice(row.0);
    weights[..len].iter_mut().zip(row.1).for_each(|(out, &weight)| *out = W::one().scale(weight));
    len
}

/// The rows of `S` of a degree.
pub fn rows<'a>(r: &'a Refinement, parent: &'a Mesh, degree: usize) -> Box<dyn Rows + 'a> {
    let exceptions = exceptions(r, parent, degree);
    match degree {
        0 => Box::new(of_s0(r, parent, exceptions)),
        1 => Box::new(of_s1(r, parent, exceptions, None)),
        _ => Box::new(of_s2(r, parent, exceptions)),
    }
}

/// The exceptions among the rows of `S` of a degree.
pub fn exceptions<'a>(r: &'a Refinement, parent: &'a Mesh, degree: usize) -> Cow<'a, Exceptions> {
    let shape = (r.split.num_children(degree), parent.num_cells(degree));
    match degree {
        0 => Cow::Owned(Exceptions::collect(
            shape,
            |vertex| {
                let large = |f| parent.face_size(f) > LONGEST;
                let polygon = matches!(r.split.vertex_parent(vertex), Parent::Face(f) if large(f));
                polygon || r.homotopy.h0.position(vertex).is_some()
            },
            |vertex, row| r.add_s0_row(parent, vertex, 1.0, row),
        )),
        // Of any length.
        1 if r.homotopy.regular == Regular::Whitney => {
            Cow::Owned(Exceptions::collect(shape, |_| true, |edge, row| r.add_s1_row(parent, edge, 1.0, row)))
        }
        1 => Cow::Borrowed(&r.s1_exceptions),
        _ => {
            let fill = |face: usize, row: &mut Row| r.add_s2_row(parent, face, 1.0, row);
            let places = r.homotopy.h1.members().iter().map(|&edge| r.split.edge_parent(edge as usize));
            let non_manifold =
                |place| matches!(place, ChildEdge::Even(h) if parent.is_non_manifold_edge(h.edge()));
            Cow::Owned(match places.clone().any(non_manifold) {
                true => Exceptions::collect(shape, |face| !r.is_regular_face(parent, face), fill),
                false => {
                    let faces = places.flat_map(|place| r.split.faces_beside(parent, place));
                    Exceptions::listed(shape, faces.map(|face| face as usize), fill)
                }
            })
        }
    }
}

/// The regular rows of `S0`.
pub struct VertexRule<'a> {
    r: &'a Refinement,
    parent: &'a Mesh,
    /// The lengths of the rows at vertices and midpoints.
    lengths: [usize; 2],
}

pub fn of_s0<'a>(
    r: &'a Refinement,
    parent: &'a Mesh,
    exceptions: Cow<'a, Exceptions>,
) -> Mixed<'a, VertexRule<'a>> {
    let shape = (r.split.num_children(0), parent.num_vertices());
    let lengths = match r.homotopy.regular {
        Regular::Whitney => [1, 2],
        Regular::Catmark => [9, 6],
        Regular::Loop => [7, 4],
    };
    Mixed { shape, exceptions, rule: VertexRule { r, parent, lengths } }
}

impl Rule for VertexRule<'_> {
    #[inline]
    fn length(&self, row: usize) -> usize {
        match self.r.split.vertex_parent(row) {
            Parent::Vertex(_) => self.lengths[0],
            Parent::Edge(_) => self.lengths[1],
            Parent::Face(f) => self.parent.face_size(f),
        }
    }

    #[inline]
    fn visit(&self, row: usize, mut visit: impl FnMut(u32, f64, bool)) {
        let visit = |vertex, weight| visit(vertex, weight, false);
        self.r.homotopy.regular.s0(self.parent, self.r.split.vertex_parent(row), visit);
    }
}

/// The regular rows of `S1`.
pub struct EdgeRule<'a> {
    r: &'a Refinement,
    parent: &'a Mesh,
    /// The lengths of the even and the odd rows.
    lengths: [usize; 2],
    /// Where many rows are wanted of triangles.
    hubs: Option<&'a Hubs>,
}

pub fn of_s1<'a>(
    r: &'a Refinement,
    parent: &'a Mesh,
    exceptions: Cow<'a, Exceptions>,
    hubs: Option<&'a Hubs>,
) -> Mixed<'a, EdgeRule<'a>> {
    let shape = (r.split.num_children(1), parent.num_edges());
    let lengths = match r.homotopy.regular {
        // All are exceptions.
        Regular::Whitney => [0, 0],
        Regular::Catmark => [6, 4],
        Regular::Loop => [EVEN_TERMS, ODD_TERMS],
    };
    Mixed { shape, exceptions, rule: EdgeRule { r, parent, lengths, hubs } }
}

impl Rule for EdgeRule<'_> {
    #[inline]
    fn length(&self, row: usize) -> usize {
        match self.r.split.edge_parent(row) {
            ChildEdge::Even(_) => self.lengths[0],
            ChildEdge::Odd(_) => self.lengths[1],
        }
    }

    fn lengths(&self, rows: Range<usize>) -> usize {
        let first_even = self.parent.num_corners().clamp(rows.start, rows.end);
        self.lengths[0] * (rows.end - first_even) + self.lengths[1] * (first_even - rows.start)
    }

    fn write_all<W: Quantity>(&self, rows: Range<usize>, columns: &mut [u32], weights: &mut [W]) -> usize {
        match self.hubs {
            Some(hubs) => hubs.write(self.parent, rows, columns, weights),
            None => self.write_each(rows, columns, weights),
        }
    }

    #[inline]
    fn visit(&self, row: usize, mut visit: impl FnMut(u32, f64, bool)) {
        let (split, regular) = (&self.r.split, self.r.homotopy.regular);
        let continued = |h: HalfEdge| self.r.continued(h);
        let visit = |h: HalfEdge, weight: f64| visit(h.edge(), weight, h.index() % 2 == 1);
        // Said twice, so that each branch is compiled for its own kind of row.
        match split.edge_parent(row) {
            place @ ChildEdge::Odd(_) => regular.s1(self.parent, split.kind(), place, continued, visit),
            place @ ChildEdge::Even(_) => regular.s1(self.parent, split.kind(), place, continued, visit),
        }
    }
}

/// The regular rows of `S2`.
pub struct FaceRule<'a> {
    r: &'a Refinement,
    parent: &'a Mesh,
}

pub fn of_s2<'a>(
    r: &'a Refinement,
    parent: &'a Mesh,
    exceptions: Cow<'a, Exceptions>,
) -> Mixed<'a, FaceRule<'a>> {
    let shape = (r.split.num_children(2), parent.num_faces());
    Mixed { shape, exceptions, rule: FaceRule { r, parent } }
}

impl Rule for FaceRule<'_> {
    #[inline]
    fn length(&self, row: usize) -> usize {
        match (self.r.homotopy.regular, self.r.split.kind()) {
            (Regular::Whitney, _) => 1,
            (_, SplitKind::Triangle) if row % 4 != 3 => 5,
            _ => 4,
        }
    }

    fn lengths(&self, rows: Range<usize>) -> usize {
        match (self.r.homotopy.regular, self.r.split.kind()) {
            (Regular::Whitney, _) => rows.len(),
            (_, SplitKind::Triangle) => 5 * rows.len() - (rows.end / 4 - rows.start / 4),
            _ => 4 * rows.len(),
        }
    }

    #[inline]
    fn visit(&self, row: usize, mut visit: impl FnMut(u32, f64, bool)) {
        let visit = |face, weight| visit(face, weight, false);
        self.r.homotopy.regular.s2(self.parent, &self.r.split, row, visit);
    }
}
