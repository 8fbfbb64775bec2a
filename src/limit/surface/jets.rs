//! The basis of the limit forms with higher derivatives.

use std::ops::{Add, Mul};

use super::super::frame::Frame;
use super::super::taylor::Taylor;
use super::super::triangle::exponents;
use super::LimitSurface;
use super::walk::{Found, descent};
use crate::sparse::{Csr, row_of};
use crate::topology::SplitKind;

/// The basis forms of a face at one of its points, with derivatives by the parameters `s`, `t` that start at the face's
/// own origin; cells in the order of [`FaceCells`](super::FaceCells).
#[derive(Clone, Debug)]
pub struct BasisJets {
    /// For each vertex its 0-form.
    pub forms0: Vec<Taylor>,
    /// For each half-edge the components of its 1-form along `s` and `t`.
    pub forms1: Vec<[Taylor; 2]>,
}

impl LimitSurface {
    /// A basis ([`LimitSurface::face_basis`]) at a point of its face, 0- and 1-forms up to terms of these orders, 5 at
    /// most. Next to an irregular vertex the derivatives are those on the part that holds the point, and grow towards the
    /// vertex; at the vertex itself, where they do not exist, all is NaN.
    ///
    /// # Panics
    /// If there is no such basis, or an order exceeds 5.
    pub fn basis_jets(&self, number: usize, [s, t]: [f64; 2], orders: [usize; 2]) -> BasisJets {
        let kind = self.hierarchy().split_kind();
        let sizes = self.tables.get(number).sizes;
        let none = Taylor::constant(f64::NAN);
        let zero = Taylor::constant(0.0);
        let (steps, found) = descent(self, number, Frame::new(s, t), 0);
        let forms0 = match found {
            Found::Patch(frame) => {
                let at = variables(&frame, orders[0]);
                lift(&steps, patch0(kind, at), zero)
            }
            Found::Vertex(_) => vec![none; sizes[0]],
        };
        let (steps, found) = descent(self, number, Frame::new(s, t), 1);
        let forms1 = match found {
            Found::Patch(frame) => {
                let forms: Vec<[Taylor; 2]> =
                    patch1(kind, variables(&frame, orders[1])).into_iter().map(|w| frame.pull(w)).collect();
                let [a, b] = [0, 1].map(|k| lift(&steps, forms.iter().map(|w| w[k]).collect(), zero));
                a.into_iter().zip(b).map(|(a, b)| [a, b]).collect()
            }
            Found::Vertex(_) => vec![[none; 2]; sizes[1]],
        };
        BasisJets { forms0, forms1 }
    }
}

/// The parameters of a frame as functions of those of the outer one.
fn variables(frame: &Frame, order: usize) -> [Taylor; 2] {
    [0, 1].map(|i| Taylor::linear(frame.point[i], frame.jacobian[i], order))
}

/// What each cell of a face counts, of what each coefficient below `steps` does.
fn lift<T>(steps: &[&Csr], below: Vec<T>, zero: T) -> Vec<T>
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    steps.iter().rev().fold(below, |below, map| {
        let mut above = vec![zero; map.cols()];
        for (i, &x) in below.iter().enumerate() {
            let (columns, entries) = row_of(map, i);
            for (&j, &entry) in columns.iter().zip(entries) {
                above[j as usize] = above[j as usize] + x * entry;
            }
        }
        above
    })
}

/// The uniform cubic B-splines of a unit cell.
fn cubic(x: Taylor) -> [Taylor; 4] {
    let y = Taylor::constant(1.0) - x;
    let middle = |x: Taylor| Taylor::constant(2.0 / 3.0) - x * x + x * x * x * 0.5;
    [y * y * y * (1.0 / 6.0), middle(x), middle(y), x * x * x * (1.0 / 6.0)]
}

/// The uniform quadratic B-splines of a unit cell.
fn quadratic(x: Taylor) -> [Taylor; 3] {
    let y = Taylor::constant(1.0) - x;
    [y * y * 0.5, Taylor::constant(0.5) + x * y, x * x * 0.5]
}

fn products(a: &[Taylor], b: &[Taylor]) -> Vec<Taylor> {
    b.iter().flat_map(|&b| a.iter().map(move |&a| a * b)).collect()
}

/// Bernstein's polynomials of degree 4.
fn quartics([s, t]: [Taylor; 2]) -> Vec<Taylor> {
    let one = Taylor::constant(1.0);
    let power = |x: Taylor, n: usize| (0..n).fold(one, |power, _| power * x);
    let factorial = |n: usize| (1..=n).product::<usize>() as f64;
    let bernstein = |[i, j, k]: [usize; 3]| {
        let multiplicity = 24.0 / (factorial(i) * factorial(j) * factorial(k));
        power(one - s - t, i) * power(s, j) * power(t, k) * multiplicity
    };
    exponents(4).map(bernstein).collect()
}

/// The 0-forms of the coefficients of a patch ([`super::super::patch`]).
fn patch0(kind: SplitKind, [s, t]: [Taylor; 2]) -> Vec<Taylor> {
    match kind {
        SplitKind::Quad => products(&cubic(s), &cubic(t)),
        SplitKind::Triangle => quartics([s, t]),
    }
}

/// Their 1-forms.
fn patch1(kind: SplitKind, [s, t]: [Taylor; 2]) -> Vec<[Taylor; 2]> {
    let zero = Taylor::constant(0.0);
    let (along_s, along_t) = match kind {
        SplitKind::Quad => (products(&quadratic(s), &cubic(t)), products(&cubic(s), &quadratic(t))),
        SplitKind::Triangle => (quartics([s, t]), quartics([s, t])),
    };
    along_s.into_iter().map(|a| [a, zero]).chain(along_t.into_iter().map(|b| [zero, b])).collect()
}
