//! Sparse operators: one matrix type, one way to assemble it, one way to apply it.
//!
//! Every linear map of this crate (`d0`, `d1`, the homotopies `H0`, `H1`, the subdivision operators
//! `S0`, `S1`, `S2`) is a [`Csr`] matrix, filled row by row through [`assemble`]. Rows are independent
//! of each other, so the result is bitwise the same for any number of threads.

mod cholesky;
mod exceptions;
mod fronts;
mod quantity;

pub use cholesky::{Cholesky, NoFactors};
pub use exceptions::Exceptions;
pub use quantity::{Quantity, Value};

use std::ops::Range;
use std::sync::Mutex;

use rayon::prelude::*;

use crate::memory;

/// A compressed sparse row matrix in `f64`: 32-bit columns, 64-bit row offsets, columns ascending in
/// each row, none repeated.
pub type Csr = sprs::CsMatI<f64, u32, usize>;

/// Entries at or below this magnitude are rounding left over from terms that cancel exactly: they
/// are not stored. Subdivision weights are of order 1 and sums of a few dozen terms, so true weights
/// are far larger and sums of true weights err by less.
pub const ROUNDING_DUST: f64 = 1e-15;

/// One row under assembly: a sum of terms `weight * column`, in any order and with repeats.
pub struct Row {
    /// With room for all columns, so that a repeated column costs one addition and no search: where in `terms` each was put
    /// last, which may be stale. Or without any, where so few rows are wanted of so wide a matrix that the room would cost
    /// more; then columns repeat in `terms`.
    places: Vec<u32>,
    terms: Vec<(u32, f64)>,
}

impl Row {
    /// For `rows` rows of a matrix of so many columns.
    fn new(rows: usize, columns: usize) -> Self {
        let room = if columns < 16 * rows { columns } else { 0 };
        Row { places: memory::zeros(room), terms: Vec::new() }
    }

    /// Adds `weight` to the entry in `column`.
    ///
    /// # Panics
    /// If `column` is out of range, here or when the matrix is complete.
    #[inline]
    pub fn add(&mut self, column: u32, weight: f64) {
        if self.places.is_empty() {
            return self.terms.push((column, weight));
        }
        let place = &mut self.places[column as usize];
        match self.terms.get_mut(*place as usize) {
            Some((of, sum)) if *of == column => *sum += weight,
            _ => {
                *place = self.terms.len() as u32;
                self.terms.push((column, weight));
            }
        }
    }

    /// Adds `scale` times row `row` of `matrix`.
    pub fn add_row(&mut self, matrix: &Csr, row: usize, scale: f64) {
        self.add_all(row_of(matrix, row), scale);
    }

    /// Adds `scale` times a row given by its columns and weights.
    pub fn add_all(&mut self, (columns, weights): (&[u32], &[f64]), scale: f64) {
        for (&column, &weight) in columns.iter().zip(weights) {
            self.add(column, scale * weight);
        }
    }

    /// Moves the finished row to the end of `part` and clears this one for the next.
    fn flush(&mut self, part: &mut Part) {
        // Stable, so that the terms of a column are added in the order in which they came, with room or without.
        self.terms.sort_by_key(|&(column, _)| column);
        for terms in self.terms.chunk_by(|a, b| a.0 == b.0) {
            part.push(terms[0].0, terms.iter().fold(0.0, |sum, &(_, weight)| sum + weight));
        }
        self.terms.clear();
        part.end_row();
    }
}

/// A run of consecutive finished rows.
#[derive(Default)]
pub(crate) struct Part {
    row_ends: Vec<usize>,
    columns: Vec<u32>,
    weights: Vec<f64>,
}

impl Part {
    fn push(&mut self, column: u32, weight: f64) {
        if weight.abs() > ROUNDING_DUST {
            self.columns.push(column);
            self.weights.push(weight);
        }
    }

    fn end_row(&mut self) {
        self.row_ends.push(self.columns.len());
    }

    /// A row of these columns, ascending, less those whose weight is dust.
    #[inline]
    pub fn push_row(&mut self, columns: &[u32], weights: &[f64]) {
        let start = self.columns.len();
        self.columns.extend_from_slice(columns);
        self.weights.extend_from_slice(weights);
        // Every column is written, the next one over it if it is dust: no branch to guess.
        let (to_columns, to_weights) = (&mut self.columns[start..], &mut self.weights[start..]);
        let mut end = 0;
        for (&column, &weight) in columns.iter().zip(weights) {
            (to_columns[end], to_weights[end]) = (column, weight);
            end += usize::from(weight.abs() > ROUNDING_DUST);
        }
        self.columns.truncate(start + end);
        self.weights.truncate(start + end);
        self.end_row();
    }
}

/// The front of a slice, which is taken off it.
pub(crate) fn front<'a, T>(slice: &mut &'a mut [T], len: usize) -> &'a mut [T] {
    let (front, rest) = std::mem::take(slice).split_at_mut(len);
    *slice = rest;
    front
}

/// Builds a matrix of `shape = (rows, columns)` by calling `fill(i, row)` once for each row `i`.
///
/// Rows are filled in parallel, each by one thread.
pub fn assemble(shape: (usize, usize), fill: impl Fn(usize, &mut Row) + Sync) -> Csr {
    assemble_parts(
        shape,
        || Row::new(shape.0, shape.1),
        |row, rows, part| {
            for i in rows {
                fill(i, row);
                row.flush(part);
            }
        },
    )
}

/// Rows whose entries stay in the cache until they are moved to the matrix.
const PART: usize = 1024;

/// Builds a matrix from runs of rows, `fill(scratch, rows, part)` each, where `scratch` is handed from run to run.
///
/// While some runs are filled those before them are moved to the matrix, so that fresh memory, which is dear, is touched
/// for the matrix only.
pub(crate) fn assemble_parts<S: Send>(
    shape: (usize, usize),
    scratch: impl Fn() -> S + Sync,
    fill: impl Fn(&mut S, Range<usize>, &mut Part) + Sync,
) -> Csr {
    let rows = shape.0;
    let starts: Vec<usize> = (0..rows).step_by(PART).collect();
    let at_once = 4 * rayon::current_num_threads();
    let (mut fresh, mut ready): (Vec<Part>, Vec<Part>) = Default::default();
    fresh.resize_with(at_once.min(starts.len()), Part::default);
    ready.resize_with(fresh.len(), Part::default);
    let idle = Mutex::new(Vec::new());
    let (mut all, mut offsets) = (Part::default(), memory::with_capacity(rows + 1));
    offsets.push(0);
    let mut append = |ready: &mut [Part]| {
        for part in ready {
            let before = all.columns.len();
            offsets.extend(part.row_ends.drain(..).map(|end| before + end));
            memory::append(&mut all.columns, &mut part.columns);
            memory::append(&mut all.weights, &mut part.weights);
        }
    };
    for starts in starts.chunks(at_once) {
        let fill = || {
            fresh.par_iter_mut().zip(starts).for_each(|(part, &start)| {
                let waiting = idle.lock().expect("no thread has panicked").pop();
                let mut own = waiting.unwrap_or_else(&scratch);
                fill(&mut own, start..(start + PART).min(rows), part);
                idle.lock().expect("no thread has panicked").push(own);
            });
        };
        rayon::join(|| append(&mut ready), fill);
        std::mem::swap(&mut fresh, &mut ready);
    }
    append(&mut ready);
    all.columns.shrink_to_fit();
    all.weights.shrink_to_fit();
    Csr::new(shape, offsets, all.columns, all.weights)
}

/// Builds a matrix whose rows have known lengths: `fill(rows, offsets, columns, weights)` writes a run of rows
/// straight to their place, row `i` to `offsets[i] - offsets[rows.start] ..`, columns ascending.
///
/// `lengths` are those of all rows. Runs are filled in parallel.
pub fn assemble_in_place(
    shape: (usize, usize),
    lengths: impl Iterator<Item = usize>,
    fill: impl Fn(Range<usize>, &[usize], &mut [u32], &mut [f64]) + Sync,
) -> Csr {
    let mut offsets = memory::with_capacity(shape.0 + 1);
    offsets.push(0);
    let mut end = 0;
    offsets.extend(lengths.map(|length| {
        end += length;
        end
    }));
    assert_eq!(offsets.len(), shape.0 + 1, "one length for each row");
    let (mut columns, mut weights) = (memory::zeros_to_fill(end), memory::zeros_to_fill(end));
    fill_runs(0..shape.0, &offsets, &mut columns, &mut weights, &fill);
    Csr::new(shape, offsets, columns, weights)
}

/// Few enough rows that a run is done at once, many enough that splitting them costs nothing.
const RUN: usize = 8192;

fn fill_runs(
    rows: Range<usize>,
    offsets: &[usize],
    columns: &mut [u32],
    weights: &mut [f64],
    fill: &(impl Fn(Range<usize>, &[usize], &mut [u32], &mut [f64]) + Sync),
) {
    if rows.len() <= RUN {
        return fill(rows, offsets, columns, weights);
    }
    let middle = rows.start + (rows.len() / 2).next_multiple_of(RUN);
    let split = offsets[middle] - offsets[rows.start];
    let ((c0, c1), (w0, w1)) = (columns.split_at_mut(split), weights.split_at_mut(split));
    rayon::join(
        || fill_runs(rows.start..middle, offsets, c0, w0, fill),
        || fill_runs(middle..rows.end, offsets, c1, w1, fill),
    );
}

/// The columns and weights of one row.
///
/// # Panics
/// If `row` is out of range.
#[inline]
pub fn row_of(matrix: &Csr, row: usize) -> (&[u32], &[f64]) {
    let offsets = matrix.indptr();
    let range = offsets.outer_inds_sz(row);
    (&matrix.indices()[range.clone()], &matrix.data()[range])
}

/// `sum_j weights[j] * x[columns[j]]`, or `None` for an empty row.
#[inline]
pub fn dot<T: Quantity>((columns, weights): (&[u32], &[f64]), x: &[T]) -> Option<T> {
    let terms = columns.iter().zip(weights).map(|(&c, &w)| x[c as usize].scale(w));
    terms.reduce(|sum, term| sum + term)
}

/// `matrix * x`, rows in parallel.
///
/// # Panics
/// If `x` is not as long as the matrix is wide.
pub fn apply<T: Quantity>(matrix: &Csr, x: &[T]) -> Vec<T> {
    assert_eq!(matrix.cols(), x.len(), "operator and cochain do not match");
    (0..matrix.rows()).into_par_iter().map(|i| dot(row_of(matrix, i), x).unwrap_or(T::zero())).collect()
}

/// `x . y`: the same sum on any number of threads, in blocks of a fixed size.
pub fn inner(x: &[f64], y: &[f64]) -> f64 {
    let block = |(x, y): (&[f64], &[f64])| x.iter().zip(y).map(|(a, b)| a * b).sum::<f64>();
    let sums: Vec<f64> = x.par_chunks(4096).zip(y.par_chunks(4096)).map(block).collect();
    sums.iter().sum()
}

/// `sum_i weights[i] vectors[i]`, of length `len`.
pub fn combination(vectors: &[Vec<f64>], weights: &[f64], len: usize) -> Vec<f64> {
    let mut sum = vec![0.0; len];
    for (vector, &weight) in vectors.iter().zip(weights) {
        sum.par_iter_mut().zip(vector).for_each(|(x, y)| *x += weight * y);
    }
    sum
}

/// The largest magnitude of an entry of `a - b`, over all entries.
///
/// # Panics
/// If the shapes differ.
pub fn max_difference(a: &Csr, b: &Csr) -> f64 {
    assert_eq!(a.shape(), b.shape(), "matrices of different shapes");
    let difference = assemble_difference(a, b);
    difference.into_iter().fold(0.0, f64::max)
}

fn assemble_difference(a: &Csr, b: &Csr) -> Vec<f64> {
    (0..a.rows())
        .into_par_iter()
        .map(|i| {
            let ((ca, wa), (cb, wb)) = (row_of(a, i), row_of(b, i));
            let (mut p, mut q, mut worst) = (0, 0, 0.0f64);
            while p < ca.len() || q < cb.len() {
                let left = ca.get(p).copied().unwrap_or(u32::MAX);
                let right = cb.get(q).copied().unwrap_or(u32::MAX);
                let x = if left <= right {
                    p += 1;
                    wa[p - 1]
                } else {
                    0.0
                };
                let y = if right <= left {
                    q += 1;
                    wb[q - 1]
                } else {
                    0.0
                };
                worst = worst.max((x - y).abs());
            }
            worst
        })
        .collect()
}

/// The product `a * b`.
///
/// # Panics
/// If `a` is not as wide as `b` is tall.
pub fn multiply(a: &Csr, b: &Csr) -> Csr {
    assert_eq!(a.cols(), b.rows(), "matrices that cannot be multiplied");
    assemble((a.rows(), b.cols()), |i, row| {
        let (columns, weights) = row_of(a, i);
        for (&column, &weight) in columns.iter().zip(weights) {
            row.add_row(b, column as usize, weight);
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(rows: &[&[(u32, f64)]], columns: usize) -> Csr {
        assemble((rows.len(), columns), |i, row| {
            for &(column, weight) in rows[i] {
                row.add(column, weight);
            }
        })
    }

    #[test]
    fn repeated_terms_add_and_cancelled_terms_vanish() {
        let m = matrix(&[&[(2, 1.0), (0, 0.5), (2, 2.0)], &[(1, 0.3), (1, -0.3)], &[]], 3);
        assert_eq!(row_of(&m, 0), (&[0, 2][..], &[0.5, 3.0][..]));
        assert_eq!(row_of(&m, 1).0.len(), 0);
        assert_eq!(apply(&m, &[2.0, 7.0, 1.0]), [4.0, 0.0, 0.0]);
    }

    #[test]
    fn product_and_difference_agree_with_hand_values() {
        let a = matrix(&[&[(0, 1.0), (1, 2.0)], &[(1, -1.0)]], 2);
        let b = matrix(&[&[(1, 3.0)], &[(0, 1.0), (1, 1.0)]], 2);
        let expected = matrix(&[&[(0, 2.0), (1, 5.0)], &[(0, -1.0), (1, -1.0)]], 2);
        assert_eq!(max_difference(&multiply(&a, &b), &expected), 0.0);
        assert_eq!(max_difference(&a, &b), 2.0);
    }
}
