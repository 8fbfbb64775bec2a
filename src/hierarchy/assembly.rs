//! The operators as matrices: the rows of regular cells are written straight to their place between those of the
//! exceptions.

use super::refinement::Refinement;
use super::rows::{self, LONGEST, Mixed, Rule, Terms};
use super::wheel::{EdgeRows, FaceRows, Last};
use crate::scheme::Regular;
use crate::sparse::{Csr, assemble_in_place};
use crate::topology::{ChildEdge, Mesh};

pub fn s0(r: &Refinement, parent: &Mesh) -> Csr {
    matrix(rows::of_s0(r, parent, rows::exceptions(r, parent, 0)))
}

pub fn s1(r: &Refinement, parent: &Mesh) -> Csr {
    let rows = rows::of_s1(r, parent, rows::exceptions(r, parent, 1), None);
    if r.homotopy.regular != Regular::Loop {
        return matrix(rows);
    }
    let regular = EdgeRows::new(r, parent);
    matrix_by(&rows, Last::default, |last, edge, columns, weights| match r.split.edge_parent(edge) {
        ChildEdge::Odd(corner) => regular.odd(corner, last, columns, weights),
        ChildEdge::Even(h) => regular.even(h, columns, weights),
    })
}

pub fn s2(r: &Refinement, parent: &Mesh) -> Csr {
    let rows = rows::of_s2(r, parent, rows::exceptions(r, parent, 2));
    if r.homotopy.regular != Regular::Loop {
        return matrix(rows);
    }
    let regular = FaceRows::new(r, parent);
    matrix_by(&rows, Terms::default, |terms, face, columns, weights| match face % 4 {
        3 => {
            rows.rule.get(face, terms);
            write::<4>(terms, &mut columns[..4], &mut weights[..4]);
            4
        }
        _ => {
            let vertex = parent.corner_vertex(r.split.parent_corner(parent, face));
            regular.at(vertex, face as u32 / 4, columns, weights)
        }
    })
}

fn matrix<R: Rule>(rows: Mixed<R>) -> Csr {
    if rows.exceptions.members().len() == rows.shape.0 {
        return rows.exceptions.into_owned().into_rows();
    }
    matrix_by(&rows, Terms::default, |terms, row, columns, weights| {
        rows.rule.get(row, terms);
        write_sorted(terms, &mut columns[..terms.len], &mut weights[..terms.len]);
        terms.len
    })
}

/// The matrix whose regular rows `write(scratch, row, columns, weights)` writes to the beginning of two slices, where
/// what follows belongs to later rows; it says how long they are.
fn matrix_by<R: Rule, S>(
    rows: &Mixed<R>,
    scratch: impl Fn() -> S + Sync,
    write: impl Fn(&mut S, usize, &mut [u32], &mut [f64]) -> usize + Sync,
) -> Csr {
    assemble_in_place(rows.shape, rows.lengths(0..rows.shape.0), |run, offsets, columns, weights| {
        let mut scratch = scratch();
        let base = offsets[run.start];
        for (row, stored) in rows.stored(run) {
            let (start, len) = (offsets[row] - base, offsets[row + 1] - offsets[row]);
            let (columns, weights) = (&mut columns[start..], &mut weights[start..]);
            match stored {
                Some((stored_columns, stored_weights)) => {
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

/// Writes terms in the order of their columns: each goes straight to its place, which is the number of smaller columns.
/// All are compared with all, some at once and without branches, which beats a sort for so few.
#[inline]
fn write<const N: usize>(terms: &Terms, columns: &mut [u32], weights: &mut [f64]) {
    let columns: &mut [u32; N] = columns.try_into().expect("a regular row has its length");
    let weights: &mut [f64; N] = weights.try_into().expect("a regular row has its length");
    // Columns are below 2^31; processors compare signed numbers more readily.
    let keys: [i32; N] = std::array::from_fn(|i| terms.columns[i] as i32);
    let mut places = [0; N];
    for key in keys {
        for (place, other) in places.iter_mut().zip(keys) {
            *place += i32::from(key < other);
        }
    }
    for (i, place) in places.into_iter().enumerate() {
        (columns[place as usize], weights[place as usize]) = (terms.columns[i], terms.weights[i]);
    }
}

#[inline]
fn write_sorted(terms: &Terms, columns: &mut [u32], weights: &mut [f64]) {
    match terms.len {
        0 => {}
        1 => write::<1>(terms, columns, weights),
        2 => write::<2>(terms, columns, weights),
        3 => write::<3>(terms, columns, weights),
        4 => write::<4>(terms, columns, weights),
        5 => write::<5>(terms, columns, weights),
        6 => write::<6>(terms, columns, weights),
        7 => write::<7>(terms, columns, weights),
        8 => write::<8>(terms, columns, weights),
        9 => write::<9>(terms, columns, weights),
        LONGEST => write::<LONGEST>(terms, columns, weights),
        len => unreachable!("no regular row has {len} terms"),
    }
}
