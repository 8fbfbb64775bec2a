//! The rows of the operators, and the operators as matrices: the rows of regular cells, of known length, are written
//! straight to their place between those of the exceptions.

use std::borrow::Cow;

use super::refinement::Refinement;
use super::wheel::{EdgeRows, FaceRows, Last};
use crate::scheme::Regular;
use crate::sparse::{Csr, Exceptions, assemble_in_place};
use crate::topology::{ChildEdge, HalfEdge, Mesh, Parent, SplitKind};

/// The most terms of a regular row. Centres of larger polygons count as exceptions.
const LONGEST: usize = 10;

/// The terms of a regular row, in any order, no column twice.
#[derive(Default)]
pub struct Terms {
    columns: [u32; LONGEST],
    weights: [f64; LONGEST],
    len: usize,
}

impl Terms {
    #[inline]
    fn push(&mut self, column: u32, weight: f64) {
        (self.columns[self.len], self.weights[self.len]) = (column, weight);
        self.len += 1;
    }

    /// Writes them in the order of their columns: each goes straight to its place, which is the number of smaller columns.
    /// All are compared with all, some at once and without branches, which beats a sort for so few.
    #[inline]
    fn write<const N: usize>(&self, columns: &mut [u32], weights: &mut [f64]) {
        let columns: &mut [u32; N] = columns.try_into().expect("a regular row has its length");
        let weights: &mut [f64; N] = weights.try_into().expect("a regular row has its length");
        // Columns are below 2^31; processors compare signed numbers more readily.
        let keys: [i32; N] = std::array::from_fn(|i| self.columns[i] as i32);
        let mut places = [0; N];
        for key in keys {
            for (place, other) in places.iter_mut().zip(keys) {
                *place += i32::from(key < other);
            }
        }
        for (i, place) in places.into_iter().enumerate() {
            (columns[place as usize], weights[place as usize]) = (self.columns[i], self.weights[i]);
        }
    }
}

/// The rows of an operator, one at a time.
pub trait Rows: Sync {
    /// The columns of a row, none twice, in any order, and their weights. `terms` may be where they are kept.
    fn get<'t>(&'t self, row: usize, terms: &'t mut Terms) -> (&'t [u32], &'t [f64]);
}

/// The rows of the exceptions, and for the others what `regular` gives: `length` terms in any order.
struct Mixed<'a, Length, Fill> {
    shape: (usize, usize),
    exceptions: Cow<'a, Exceptions>,
    length: Length,
    regular: Fill,
}

impl<Length: Sync, Fill: Fn(usize, &mut Terms) + Sync> Rows for Mixed<'_, Length, Fill> {
    #[inline]
    fn get<'t>(&'t self, row: usize, terms: &'t mut Terms) -> (&'t [u32], &'t [f64]) {
        self.exceptions.get(row).unwrap_or_else(|| {
            terms.len = 0;
            (self.regular)(row, terms);
            (&terms.columns[..terms.len], &terms.weights[..terms.len])
        })
    }
}

/// The rows of `S` of a degree.
pub fn rows<'a>(r: &'a Refinement, parent: &'a Mesh, degree: usize) -> Box<dyn Rows + 'a> {
    match degree {
        0 => Box::new(rows_of_s0(r, parent)),
        1 => Box::new(rows_of_s1(r, parent)),
        _ => Box::new(rows_of_s2(r, parent)),
    }
}

pub fn s0(r: &Refinement, parent: &Mesh) -> Csr {
    rows_of_s0(r, parent).matrix()
}

pub fn s1(r: &Refinement, parent: &Mesh) -> Csr {
    let rows = rows_of_s1(r, parent);
    if r.homotopy.regular != Regular::Loop {
        return rows.matrix();
    }
    let regular = EdgeRows::new(r, parent);
    rows.matrix_by(Last::default, |last, edge, columns, weights| match r.split.edge_parent(edge) {
        ChildEdge::Odd(corner) => regular.odd(corner, last, columns, weights),
        ChildEdge::Even(h) => regular.even(h, columns, weights),
    })
}

pub fn s2(r: &Refinement, parent: &Mesh) -> Csr {
    let rows = rows_of_s2(r, parent);
    if r.homotopy.regular != Regular::Loop {
        return rows.matrix();
    }
    let regular = FaceRows::new(r, parent);
    let middle = |face, terms: &mut Terms| {
        terms.len = 0;
        r.homotopy.regular.s2(parent, &r.split, face, |f, weight| terms.push(f, weight));
    };
    rows.matrix_by(Terms::default, |terms, face, columns, weights| match face % 4 {
        3 => {
            middle(face, terms);
            terms.write::<4>(&mut columns[..4], &mut weights[..4]);
            4
        }
        _ => {
            let vertex = parent.corner_vertex(r.split.parent_corner(parent, face));
            regular.at(vertex, face as u32 / 4, columns, weights)
        }
    })
}

fn rows_of_s0<'a>(
    r: &'a Refinement,
    parent: &'a Mesh,
) -> Mixed<'a, impl Fn(usize) -> usize, impl Fn(usize, &mut Terms) + Sync> {
    let shape = (r.split.num_children(0), parent.num_vertices());
    let exceptions = Exceptions::collect(
        shape,
        |vertex| {
            let large = |f| parent.face_size(f) > LONGEST;
            let polygon = matches!(r.split.vertex_parent(vertex), Parent::Face(f) if large(f));
            polygon || r.homotopy.h0.position(vertex).is_some()
        },
        |vertex, row| r.add_s0_row(parent, vertex, 1.0, row),
    );
    let regular = r.homotopy.regular;
    let [at_vertex, at_edge] = match regular {
        Regular::Whitney => [1, 2],
        Regular::Catmark => [9, 6],
        Regular::Loop => [7, 4],
    };
    let length = move |vertex| match r.split.vertex_parent(vertex) {
        Parent::Vertex(_) => at_vertex,
        Parent::Edge(_) => at_edge,
        Parent::Face(f) => parent.face_size(f),
    };
    let regular = move |vertex, terms: &mut Terms| {
        regular.s0(parent, r.split.vertex_parent(vertex), |v, weight| terms.push(v, weight));
    };
    Mixed { shape, exceptions: Cow::Owned(exceptions), length, regular }
}

fn rows_of_s1<'a>(
    r: &'a Refinement,
    parent: &'a Mesh,
) -> Mixed<'a, impl Fn(usize) -> usize, impl Fn(usize, &mut Terms) + Sync> {
    let shape = (r.split.num_children(1), parent.num_edges());
    let (regular, kind) = (r.homotopy.regular, r.split.kind());
    let (exceptions, [even, odd]) = match regular {
        // Of any length.
        Regular::Whitney => {
            let all = Exceptions::collect(shape, |_| true, |edge, row| r.add_s1_row(parent, edge, 1.0, row));
            (Cow::Owned(all), [0, 0])
        }
        Regular::Catmark => (Cow::Borrowed(&r.s1_exceptions), [6, 4]),
        Regular::Loop => (Cow::Borrowed(&r.s1_exceptions), [10, 7]),
    };
    let num_odd = parent.num_corners();
    let length = move |edge| if edge < num_odd { odd } else { even };
    let continued = |h: HalfEdge| r.continued(h);
    let regular = move |edge, terms: &mut Terms| {
        // Said twice, so that each branch is compiled for its own kind of row.
        let push = |h: HalfEdge, weight: f64| terms.push(h.edge(), weight * h.sign());
        match r.split.edge_parent(edge) {
            place @ ChildEdge::Odd(_) => regular.s1(parent, kind, place, continued, push),
            place @ ChildEdge::Even(_) => regular.s1(parent, kind, place, continued, push),
        }
    };
    Mixed { shape, exceptions, length, regular }
}

fn rows_of_s2<'a>(
    r: &'a Refinement,
    parent: &'a Mesh,
) -> Mixed<'a, impl Fn(usize) -> usize, impl Fn(usize, &mut Terms) + Sync> {
    let shape = (r.split.num_children(2), parent.num_faces());
    let exceptions = Exceptions::collect(
        shape,
        |face| !r.is_regular_face(parent, face),
        |face, row| r.add_s2_row(parent, face, 1.0, row),
    );
    let (regular, kind) = (r.homotopy.regular, r.split.kind());
    let length = move |face: usize| match (regular, kind) {
        (Regular::Whitney, _) => 1,
        (_, SplitKind::Triangle) if face % 4 != 3 => 5,
        _ => 4,
    };
    let regular = move |face, terms: &mut Terms| {
        regular.s2(parent, &r.split, face, |f, weight| terms.push(f, weight));
    };
    Mixed { shape, exceptions: Cow::Owned(exceptions), length, regular }
}

impl<Length: Fn(usize) -> usize, Fill: Fn(usize, &mut Terms) + Sync> Mixed<'_, Length, Fill> {
    fn matrix(self) -> Csr {
        let Mixed { shape, exceptions, length, regular } = self;
        let write = |terms: &mut Terms, row: usize, columns: &mut [u32], weights: &mut [f64]| {
            terms.len = 0;
            regular(row, terms);
            write_sorted(terms, &mut columns[..terms.len], &mut weights[..terms.len]);
            terms.len
        };
        Mixed { shape, exceptions, length, regular: () }.matrix_by(Terms::default, write)
    }
}

impl<Length: Fn(usize) -> usize, Fill> Mixed<'_, Length, Fill> {
    /// The matrix whose regular rows `write(scratch, row, columns, weights)` writes to the beginning of two slices, where
    /// what follows belongs to later rows; it says how long they are.
    fn matrix_by<S>(
        self,
        scratch: impl Fn() -> S + Sync,
        write: impl Fn(&mut S, usize, &mut [u32], &mut [f64]) -> usize + Sync,
    ) -> Csr {
        let Mixed { shape, exceptions, length, .. } = self;
        if exceptions.members().len() == shape.0 {
            return exceptions.into_owned().into_rows();
        }
        let mut members = exceptions.members().iter().enumerate().peekable();
        let lengths = (0..shape.0).map(|row| match members.next_if(|(_, member)| **member as usize == row) {
            Some((position, _)) => exceptions.stored(position).0.len(),
            None => length(row),
        });
        assemble_in_place(shape, lengths, |rows, offsets, columns, weights| {
            let mut scratch = scratch();
            let mut members = exceptions.among(rows.clone()).peekable();
            let base = offsets[rows.start];
            for row in rows {
                let (start, len) = (offsets[row] - base, offsets[row + 1] - offsets[row]);
                let (columns, weights) = (&mut columns[start..], &mut weights[start..]);
                match members.next_if(|&position| exceptions.members()[position] as usize == row) {
                    Some(position) => {
                        let (stored_columns, stored_weights) = exceptions.stored(position);
                        columns[..len].copy_from_slice(stored_columns);
                        weights[..len].copy_from_slice(stored_weights);
                    }
                    None => {
                        let written = write(&mut scratch, row, columns, weights);
                        assert_eq!(written, len, "a regular row of another length");
                    }
                }
            }
        })
    }
}

#[inline]
fn write_sorted(terms: &Terms, columns: &mut [u32], weights: &mut [f64]) {
    match terms.len {
        0 => {}
        1 => terms.write::<1>(columns, weights),
        2 => terms.write::<2>(columns, weights),
        3 => terms.write::<3>(columns, weights),
        4 => terms.write::<4>(columns, weights),
        5 => terms.write::<5>(columns, weights),
        6 => terms.write::<6>(columns, weights),
        7 => terms.write::<7>(columns, weights),
        8 => terms.write::<8>(columns, weights),
        9 => terms.write::<9>(columns, weights),
        10 => terms.write::<10>(columns, weights),
        len => unreachable!("no regular row has {len} terms"),
    }
}
