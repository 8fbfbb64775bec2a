//! Cochains: one value for each vertex, oriented edge, oriented face or oriented cell, with the degree in the type.

use std::ops::{Index, IndexMut};

use rayon::prelude::*;

pub use crate::sparse::{Quantity, Value};
use crate::topology::{HalfEdge, Mesh};

/// A `K`-cochain: values on vertices (`K = 0`), oriented edges (`K = 1`), oriented faces (`K = 2`) or, in a
/// solid, oriented cells (`K = 3`).
///
/// A 1-cochain holds the circulation of a 1-form along each edge, in the direction of the edge; a
/// 2-cochain the flux through each face, positive for the counter-clockwise side; a 3-cochain the integral over
/// each cell. Reversing an edge, a face or a cell flips the sign. Units: a 1-form in units U per length has circulations in U; nothing else is
/// assumed. Positions are the 0-cochain `Cochain<0, Vector3<f64>>`.
///
/// Cochains of different degrees do not mix:
///
/// ```compile_fail
/// use formwork::cochain::Cochain;
/// let sum = Cochain::<0>::zeros(3) + Cochain::<1>::zeros(3);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cochain<const K: usize, T = f64> {
    values: Vec<T>,
}

impl<const K: usize, T> Cochain<K, T> {
    /// A cochain with these values, in the order of the mesh's vertices, edges or faces.
    pub fn new(values: Vec<T>) -> Self {
        Cochain { values }
    }

    /// The values.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// The values, and room for others.
    pub(crate) fn values_mut(&mut self) -> &mut Vec<T> {
        &mut self.values
    }

    /// The values, out of the cochain.
    pub fn into_values(self) -> Vec<T> {
        self.values
    }

    /// The number of cells.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether there are no cells.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }
}

impl<const K: usize> Cochain<K> {
    /// The zero cochain on `len` cells.
    pub fn zeros(len: usize) -> Self {
        Cochain::new(vec![0.0; len])
    }
}

impl<const K: usize, T> Index<usize> for Cochain<K, T> {
    type Output = T;
    fn index(&self, cell: usize) -> &T {
        &self.values[cell]
    }
}

impl<const K: usize, T> IndexMut<usize> for Cochain<K, T> {
    fn index_mut(&mut self, cell: usize) -> &mut T {
        &mut self.values[cell]
    }
}

impl<const K: usize, T: Quantity> std::ops::Add for Cochain<K, T> {
    type Output = Self;
    /// # Panics
    /// If the lengths differ.
    fn add(mut self, other: Self) -> Self {
        assert_eq!(self.len(), other.len(), "cochains on different meshes");
        for (x, &y) in self.values.iter_mut().zip(&other.values) {
            *x = *x + y;
        }
        self
    }
}

impl<const K: usize, T: Quantity> std::ops::Mul<f64> for Cochain<K, T> {
    type Output = Self;
    fn mul(mut self, factor: f64) -> Self {
        for x in &mut self.values {
            *x = x.scale(factor);
        }
        self
    }
}

/// A complex whose `K`-cochains have an exterior derivative. A surface has it for `K` = 0 and 1, a solid for
/// `K` = 0, 1 and 2; of the rest the compiler knows that there is none.
pub trait Differential<const K: usize> {
    /// `d_K c`: for each (K+1)-cell the sum of `c` over its boundary, with signs.
    ///
    /// # Panics
    /// If there is not one value for each `K`-cell.
    fn derive<T: Quantity>(&self, c: &[T]) -> Vec<T>;
}

impl Differential<0> for Mesh {
    fn derive<T: Quantity>(&self, x: &[T]) -> Vec<T> {
        assert_eq!(x.len(), self.num_vertices(), "a 0-cochain of another mesh");
        d0(self.edges(), x)
    }
}

impl Differential<1> for Mesh {
    fn derive<T: Quantity>(&self, c: &[T]) -> Vec<T> {
        assert_eq!(c.len(), self.num_edges(), "a 1-cochain of another mesh");
        d1(self, c)
    }
}

impl<T: Quantity> Cochain<0, T> {
    /// The exterior derivative `d0 x`: `(d0 x)(a -> b) = x_b - x_a`.
    ///
    /// # Panics
    /// If the cochain does not belong to a complex of this many vertices.
    pub fn exterior_derivative(&self, complex: &impl Differential<0>) -> Cochain<1, T> {
        Cochain::new(complex.derive(&self.values))
    }
}

impl<T: Quantity> Cochain<1, T> {
    /// The value along a half-edge: `c_ab` for `a -> b`, and `c_ba = -c_ab`.
    #[inline]
    pub fn along(&self, h: HalfEdge) -> T {
        along(&self.values, h)
    }

    /// The exterior derivative `d1 c`: the sum of `c` round each face, counter-clockwise.
    ///
    /// # Panics
    /// If the cochain does not belong to a complex of this many edges.
    pub fn exterior_derivative(&self, complex: &impl Differential<1>) -> Cochain<2, T> {
        Cochain::new(complex.derive(&self.values))
    }
}

impl<T: Quantity> Cochain<2, T> {
    /// The exterior derivative `d2 c` in a solid: the flux of `c` out of each cell.
    ///
    /// # Panics
    /// If the cochain does not belong to a complex of this many faces.
    pub fn exterior_derivative(&self, complex: &impl Differential<2>) -> Cochain<3, T> {
        Cochain::new(complex.derive(&self.values))
    }
}

/// `d0 x` on these edges.
pub(crate) fn d0<T: Quantity>(edges: &[[u32; 2]], x: &[T]) -> Vec<T> {
    edges.par_iter().map(|&[a, b]| x[b as usize] - x[a as usize]).collect()
}

/// `c_h`, the entry of a 1-cochain along a half-edge.
#[inline]
pub(crate) fn along<T: Quantity>(c: &[T], h: HalfEdge) -> T {
    c[h.edge() as usize].negate_if(h.index() & 1 == 1)
}

/// `d1 c`.
pub(crate) fn d1<T: Quantity>(mesh: &Mesh, c: &[T]) -> Vec<T> {
    let round = |f| mesh.face_half_edges(f).iter().fold(T::zero(), |sum, &h| sum + along(c, h));
    (0..mesh.num_faces() as u32).into_par_iter().map(round).collect()
}
