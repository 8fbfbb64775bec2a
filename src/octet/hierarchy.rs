use rayon::prelude::*;

use super::complex::{Complex, ComplexError};
use super::linear::Linear;
use super::smooth::{Boundary, Smoothing};
use crate::cochain::Cochain;
use crate::sparse::{Csr, Value, assemble};

impl Linear {
    /// `S_K c`, from a complex to its split.
    ///
    /// # Panics
    /// If the cochain belongs to another complex.
    pub fn refine<const K: usize, T: Value>(self, coarse: &Complex, c: &Cochain<K, T>) -> Cochain<K, T> {
        const { assert!(K <= 3, "no such forms in space") }
        assert_eq!(c.len(), coarse.num_cells(K), "a {K}-cochain of another complex");
        if c.is_empty() {
            return Cochain::new(Vec::new());
        }
        let (c, zero) = (c.values(), T::zero());
        let value = |i| {
            let mut sum = zero;
            self.row(coarse, K, i, |j, weight| sum = sum + c[j as usize] * weight);
            sum
        };
        Cochain::new((0..coarse.num_children(K) as usize).into_par_iter().map(value).collect())
    }

    /// `S_r` as a matrix, one row for each fine cell.
    ///
    /// # Panics
    /// If `r > 3`.
    pub fn operator(self, coarse: &Complex, r: usize) -> Csr {
        let shape = (coarse.num_children(r) as usize, coarse.num_cells(r));
        assemble(shape, |i, row| self.row(coarse, r, i, |j, weight| row.add(j, weight)))
    }
}

/// How a solid is refined: `S_r` of the split, and after it smoothing, `C_r S_r`, or not.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Scheme {
    /// The split.
    pub linear: Linear,
    /// What smoothing does at the boundary; none, and the scheme is the linear one.
    pub smoothing: Option<Boundary>,
}

/// A solid refined a number of times. Level 0 is the one that was handed in.
#[derive(Clone, Debug)]
pub struct Hierarchy {
    linear: Linear,
    levels: Vec<Complex>,
    /// `smoothings[l]` follows the split to level `l + 1`.
    smoothings: Vec<Option<Smoothing>>,
}

impl Hierarchy {
    /// Refines a complex to level `levels`; 0 keeps it alone.
    ///
    /// # Errors
    /// [`ComplexError::TooLarge`] or [`ComplexError::TooMuchMemory`] if the finest level would not fit.
    pub fn new(complex: Complex, scheme: Scheme, levels: usize) -> Result<Self, ComplexError> {
        Self::with_progress(complex, scheme, levels, |_| ())
    }

    /// [`Hierarchy::new`], calling `progress(level)` as each level is done.
    ///
    /// # Errors
    /// As [`Hierarchy::new`].
    pub fn with_progress(
        complex: Complex,
        scheme: Scheme,
        levels: usize,
        mut progress: impl FnMut(usize),
    ) -> Result<Self, ComplexError> {
        complex.check_memory(levels, scheme.smoothing.is_some())?;
        let (mut all, mut smoothings) = (vec![complex], Vec::new());
        for level in 1..=levels {
            let fine = all[level - 1].split()?;
            smoothings.push(scheme.smoothing.map(|boundary| Smoothing::new(&fine, boundary)));
            all.push(fine);
            progress(level);
        }
        Ok(Hierarchy { linear: scheme.linear, levels: all, smoothings })
    }

    /// The number of times that it was refined.
    pub fn num_levels(&self) -> usize {
        self.levels.len() - 1
    }

    /// A level.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn level(&self, level: usize) -> &Complex {
        &self.levels[level]
    }

    /// The last level.
    pub fn finest(&self) -> &Complex {
        &self.levels[self.num_levels()]
    }

    /// The smoothing of a level, if the scheme smooths.
    ///
    /// # Panics
    /// If `level` is 0 or there is no such level.
    pub fn smoothing(&self, level: usize) -> Option<&Smoothing> {
        self.smoothings[level - 1].as_ref()
    }

    /// From level `level - 1` to level `level`.
    ///
    /// # Panics
    /// If `level` is 0 or there is no such level, or the cochain belongs to another complex.
    pub fn refine<const K: usize, T: Value>(&self, level: usize, c: &Cochain<K, T>) -> Cochain<K, T> {
        let fine = self.linear.refine(&self.levels[level - 1], c);
        match &self.smoothings[level - 1] {
            Some(smoothing) => smoothing.apply(&self.levels[level], &fine),
            None => fine,
        }
    }

    /// From level 0 to the finest.
    ///
    /// # Panics
    /// If the cochain belongs to another complex.
    pub fn subdivide<const K: usize, T: Value>(&self, c: &Cochain<K, T>) -> Cochain<K, T> {
        (1..=self.num_levels()).fold(c.clone(), |c, level| self.refine(level, &c))
    }
}

/// Bytes for each cell of a complex, by dimension, with the largest cochain beside them; and what smoothing adds.
/// Measured with `cargo bench --bench octet`, rounded up.
const BYTES: [[u128; 4]; 2] = [[8, 24, 24, 64], [160, 100, 100, 120]];

impl Complex {
    /// Refuses what cannot fit, before the memory is full.
    fn check_memory(&self, levels: usize, smooth: bool) -> Result<(), ComplexError> {
        let mut counts = [0, 1, 2, 3].map(|r| self.num_cells(r) as u128);
        let (mut tets, mut octs) = (self.tets.len() as u128, self.octs.len() as u128);
        let mut needed = 0;
        for _ in 0..levels {
            let [v, e, t, _] = counts;
            counts =
                [v + e + octs, 2 * e + 3 * t + 12 * octs, 4 * (t + tets) + 24 * octs, 5 * tets + 14 * octs];
            (tets, octs) = (4 * tets + 8 * octs, tets + 6 * octs);
            let bytes = |table: [u128; 4]| -> u128 { (0..4).map(|r| table[r] * counts[r]).sum() };
            needed += bytes(BYTES[0]) + if smooth { bytes(BYTES[1]) } else { 0 };
        }
        match crate::hierarchy::available_memory() {
            Some(available) if needed > available => Err(ComplexError::TooMuchMemory {
                levels,
                cells: counts[3],
                needed_mib: needed >> 20,
                available_mib: available >> 20,
            }),
            _ => Ok(()),
        }
    }
}
