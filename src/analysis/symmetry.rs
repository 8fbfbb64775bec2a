//! Matrices on the rings, split by the symmetry of the rings.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix};

use super::lattice::{Lattice, Place};

/// How a vector on the rings behaves under their symmetries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Symmetry {
    /// At an interior vertex with `k` faces: turned by one sector, it is multiplied by `exp(-2 pi i m / k)`. Modes `m` and
    /// `k - m` are conjugate; the smaller one stands for both.
    Mode(usize),
    /// At a boundary vertex: pulled back by the reflection, it stays as it is.
    Even,
    /// At a boundary vertex: pulled back by the reflection, it changes its sign.
    Odd,
}

/// A matrix on the vectors of one symmetry, in terms of one cell from each orbit.
#[derive(Clone, Debug)]
pub struct Block {
    /// Which vectors.
    pub symmetry: Symmetry,
    /// How many times the block occurs: twice for a mode and its conjugate, else once.
    pub copies: usize,
    /// The matrix.
    pub matrix: DMatrix<Complex<f64>>,
    /// For each row the cell it stands for.
    pub cells: Vec<usize>,
}

/// An orbit: cells with what a vector of the symmetry is on them, relative to the first.
struct Orbit {
    cells: Vec<usize>,
    factors: Vec<Complex<f64>>,
}

/// All blocks of a matrix on cells at these places.
pub fn blocks(lattice: &Lattice, places: &[Place], matrix: &DMatrix<f64>) -> Vec<Block> {
    let symmetries: Vec<Symmetry> = match lattice.cyclic {
        true => (0..=lattice.sectors / 2).map(Symmetry::Mode).collect(),
        false => vec![Symmetry::Even, Symmetry::Odd],
    };
    let of = |symmetry: Symmetry| {
        let orbits = orbits(lattice, places, symmetry);
        let cells: Vec<usize> = orbits.iter().map(|orbit| orbit.cells[0]).collect();
        let block = DMatrix::from_fn(orbits.len(), orbits.len(), |o, p| {
            let terms = orbits[p].cells.iter().zip(&orbits[p].factors);
            terms.map(|(&column, factor)| factor * matrix[(cells[o], column)]).sum()
        });
        let copies = match symmetry {
            Symmetry::Mode(m) if m > 0 && 2 * m < lattice.sectors => 2,
            _ => 1,
        };
        Block { symmetry, copies, matrix: block, cells }
    };
    symmetries.into_iter().map(of).collect()
}

fn orbits(lattice: &Lattice, places: &[Place], symmetry: Symmetry) -> Vec<Orbit> {
    let number = |place: Place| places.iter().position(|&p| p == place).expect("the rings are symmetric");
    let mut orbits = Vec::new();
    for (cell, &place) in places.iter().enumerate() {
        let orbit = match symmetry {
            Symmetry::Mode(m) if place.is_centre() => {
                (m == 0).then(|| Orbit { cells: vec![cell], factors: vec![Complex::from(1.0)] })
            }
            Symmetry::Mode(m) => (place.sector == 0).then(|| {
                let k = lattice.sectors;
                let turned = |sector| number(Place { sector, ..place });
                let factor = |s: usize| Complex::from_polar(1.0, TAU * ((m * s) % k) as f64 / k as f64);
                Orbit { cells: (0..k).map(turned).collect(), factors: (0..k).map(factor).collect() }
            }),
            Symmetry::Even | Symmetry::Odd => {
                let (mirrored, sign) = lattice.mirrored(place);
                let sign = if symmetry == Symmetry::Even { sign } else { -sign };
                let mirrored = number(mirrored);
                let one = Complex::from(1.0);
                match mirrored {
                    // On a cell that is its own mirror image, vectors of the other symmetry vanish.
                    _ if mirrored == cell => {
                        (sign > 0.0).then(|| Orbit { cells: vec![cell], factors: vec![one] })
                    }
                    _ => (cell < mirrored)
                        .then(|| Orbit { cells: vec![cell, mirrored], factors: vec![one, one * sign] }),
                }
            }
        };
        orbits.extend(orbit);
    }
    orbits
}

impl Block {
    /// A vector of this symmetry on all cells, from one entry for each row.
    pub(super) fn extend(
        &self,
        lattice: &Lattice,
        places: &[Place],
        vector: &[Complex<f64>],
    ) -> Vec<Complex<f64>> {
        let mut extended = vec![Complex::from(0.0); places.len()];
        for (orbit, &value) in orbits(lattice, places, self.symmetry).iter().zip(vector) {
            for (&cell, factor) in orbit.cells.iter().zip(&orbit.factors) {
                extended[cell] = value * factor;
            }
        }
        extended
    }
}
