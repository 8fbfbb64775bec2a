//! The rows of an operator that do not follow its rule.

use std::ops::Range;

use rayon::prelude::*;

use super::{Csr, Row, assemble, row_of};
use crate::memory;

/// A few rows of a tall matrix: those where a mesh is not regular. All others follow a rule, and are not stored.
#[derive(Clone, Debug)]
pub struct Exceptions {
    /// One bit for each row of the tall matrix, and for each word how many bits are set before it: a row
    /// is found in constant time, without hashing.
    words: Vec<u64>,
    before: Vec<u32>,
    /// The rows that are stored, ascending.
    members: Vec<u32>,
    rows: Csr,
}

impl Exceptions {
    /// Of a matrix of `shape`, the rows that `is_exception` names, each filled as by [`assemble`].
    pub fn collect(
        shape: (usize, usize),
        is_exception: impl Fn(usize) -> bool + Sync,
        fill: impl Fn(usize, &mut Row) + Sync,
    ) -> Self {
        let word = |w: usize| {
            let bits = 64 * w..(64 * w + 64).min(shape.0);
            bits.fold(0u64, |word, row| word | u64::from(is_exception(row)) << (row % 64))
        };
        let words = memory::collect((0..shape.0.div_ceil(64)).into_par_iter().with_min_len(64).map(word));
        Self::of_words(words, shape.1, fill)
    }

    /// Of a matrix of `shape`, the rows that are in `list`, in any order and with repeats.
    pub fn listed(
        shape: (usize, usize),
        list: impl Iterator<Item = usize>,
        fill: impl Fn(usize, &mut Row) + Sync,
    ) -> Self {
        let mut words = vec![0u64; shape.0.div_ceil(64)];
        list.for_each(|row| words[row / 64] |= 1 << (row % 64));
        Self::of_words(words, shape.1, fill)
    }

    /// The rows whose bits are set.
    fn of_words(words: Vec<u64>, columns: usize, fill: impl Fn(usize, &mut Row) + Sync) -> Self {
        let mut before = Vec::with_capacity(words.len());
        let mut members = Vec::new();
        for (w, &word) in words.iter().enumerate() {
            before.push(members.len() as u32);
            let mut rest = word;
            while rest != 0 {
                members.push(64 * w as u32 + rest.trailing_zeros());
                rest &= rest - 1;
            }
        }
        let rows = assemble((members.len(), columns), |i, row| fill(members[i] as usize, row));
        Exceptions { words, before, members, rows }
    }

    /// The numbers of the rows that are stored, ascending.
    pub fn members(&self) -> &[u32] {
        &self.members
    }

    /// The stored rows alone, as a matrix.
    pub fn into_rows(self) -> Csr {
        self.rows
    }

    /// The stored rows among `rows`, as positions in [`Exceptions::members`].
    pub fn among(&self, rows: Range<usize>) -> Range<usize> {
        let first_at = |row: usize| self.members.partition_point(|&member| (member as usize) < row);
        first_at(rows.start)..first_at(rows.end)
    }

    /// The number of terms of the stored rows at a run of positions.
    pub fn num_terms(&self, positions: Range<usize>) -> usize {
        self.rows.indptr().outer_inds_slice(positions.start, positions.end).len()
    }

    /// The columns and weights of the stored row at a position.
    #[inline]
    pub fn stored(&self, position: usize) -> (&[u32], &[f64]) {
        row_of(&self.rows, position)
    }

    /// Where row `row` is stored, if it is.
    #[inline]
    pub fn position(&self, row: usize) -> Option<usize> {
        let (word, bit) = (self.words[row / 64], 1u64 << (row % 64));
        (word & bit != 0).then(|| self.before[row / 64] as usize + (word & (bit - 1)).count_ones() as usize)
    }

    /// The columns and weights of row `row`; `None` where it follows the rule.
    #[inline]
    pub fn get(&self, row: usize) -> Option<(&[u32], &[f64])> {
        Some(self.stored(self.position(row)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_found_where_they_are() {
        let is = |row: usize| row.is_multiple_of(7) || (60..70).contains(&row);
        let few = Exceptions::collect((1000, 1000), is, |row, out| out.add(row as u32, 2.0));
        for row in 0..1000 {
            let expected = is(row).then_some((vec![row as u32], vec![2.0]));
            assert_eq!(few.get(row).map(|(c, w)| (c.to_vec(), w.to_vec())), expected);
        }
        let twice = (0..1000).rev().chain(0..500).filter(|&row| is(row));
        let listed = Exceptions::listed((1000, 1000), twice, |row, out| out.add(row as u32, 2.0));
        assert_eq!((listed.members(), &listed.rows), (few.members(), &few.rows));
        assert_eq!(few.num_terms(few.among(60..70)), 10);
        let members: Vec<u32> = (100..200).filter(|&row| is(row)).map(|row| row as u32).collect();
        assert_eq!(&few.members()[few.among(100..200)], members);
    }
}
