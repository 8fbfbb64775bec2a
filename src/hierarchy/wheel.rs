//! Rows that share their columns: those of the child edges and faces round a regular vertex of triangles, and of the edges
//! inside a triangle.
//!
//! Six rows round a vertex have the same columns and the same weights, turned by a sixth; so the columns are put in order
//! once for all of them, and a row is one walk along them.

use rayon::prelude::*;

use super::refinement::Refinement;
use crate::memory;
use crate::scheme::triangle_rows::{CORNER, EVEN, ODD, sides_and_across, spokes_and_rims};
use crate::topology::{HalfEdge, Mesh};

/// Columns in ascending order, each with the place where it was and, for an edge, whether it is seen against its
/// direction: twice the one plus the other.
#[derive(Clone, Copy)]
pub struct Wheel<const N: usize> {
    columns: [u32; N],
    places: [u8; N],
}

/// The weights of a row, by what [`Wheel`] keeps of a column.
type Weights = [f64; 32];

impl<const N: usize> Wheel<N> {
    const NONE: Self = Wheel { columns: [0; N], places: [0; N] };

    #[inline]
    fn of_edges(edges: [HalfEdge; N]) -> Self {
        let places = std::array::from_fn(|i| (2 * i + edges[i].index() % 2) as u8);
        Self::sorted(std::array::from_fn(|i| edges[i].edge()), places)
    }

    /// Each column goes straight to its place, which is the number of those that are smaller, or the same and before it:
    /// all are compared with all, without branches.
    #[inline]
    fn sorted(columns: [u32; N], places: [u8; N]) -> Self {
        let keys: [i32; N] = std::array::from_fn(|i| columns[i] as i32);
        let mut ranks = [0i32; N];
        for j in 0..N {
            for i in 0..N {
                ranks[i] += i32::from(keys[i] > keys[j] - i32::from(j < i));
            }
        }
        let mut wheel = Self::NONE;
        for i in 0..N {
            wheel.columns[ranks[i] as usize] = columns[i];
            wheel.places[ranks[i] as usize] = places[i];
        }
        wheel
    }

    /// The place of a column that is there once.
    #[inline]
    fn place(&self, column: u32) -> usize {
        let mut place = 0;
        for i in 0..N {
            place |= if self.columns[i] == column { u32::from(self.places[i]) } else { 0 };
        }
        place as usize / 2
    }

    /// Writes the columns that have a weight to the beginning of two slices. What follows there may be overwritten.
    #[inline]
    fn write(&self, weights_of: &Weights, columns: &mut [u32], weights: &mut [f64]) -> usize {
        match (columns.first_chunk_mut(), weights.first_chunk_mut()) {
            (Some(columns), Some(weights)) => self.write_all(weights_of, columns, weights),
            // The last rows of all.
            _ => {
                let (mut all_columns, mut all_weights) = ([0; N], [0.0; N]);
                let len = self.write_all(weights_of, &mut all_columns, &mut all_weights);
                columns[..len].copy_from_slice(&all_columns[..len]);
                weights[..len].copy_from_slice(&all_weights[..len]);
                len
            }
        }
    }

    /// Every column is written, the next one over it if it has no weight: no branch to guess.
    #[inline]
    fn write_all(&self, weights_of: &Weights, columns: &mut [u32; N], weights: &mut [f64; N]) -> usize {
        let mut end = 0;
        for (&column, &place) in self.columns.iter().zip(&self.places) {
            let weight = weights_of[usize::from(place % 32)];
            (columns[end], weights[end]) = (column, weight);
            end += usize::from(weight != 0.0);
        }
        end
    }
}

/// The weights of a row that begins 0, 1, .. turns further on. Its places are in groups, each of `TURNS` times so many.
fn turned<const N: usize, const TURNS: usize>(row: [f64; N], groups: [usize; 2]) -> [Weights; TURNS] {
    std::array::from_fn(|by| {
        let mut weights = [0.0; 32];
        let mut start = 0;
        for each in groups {
            for i in 0..TURNS * each {
                let weight = row[start + (i + (TURNS - by) * each) % (TURNS * each)];
                weights[2 * (start + i)] = weight;
                weights[2 * (start + i) + 1] = -weight;
            }
            start += TURNS * each;
        }
        weights
    })
}

/// The regular rows of `S1` of triangles.
pub struct EdgeRows<'a> {
    parent: &'a Mesh,
    /// For each regular vertex its spokes and rims.
    wheels: Vec<Wheel<12>>,
    even: [Weights; 6],
    odd: [Weights; 3],
}

/// The sides of the triangle whose rows were written last, and of those across.
pub struct Last {
    face: usize,
    wheel: Wheel<9>,
}

impl Default for Last {
    fn default() -> Self {
        Last { face: usize::MAX, wheel: Wheel::NONE }
    }
}

impl<'a> EdgeRows<'a> {
    pub fn new(r: &Refinement, parent: &'a Mesh) -> Self {
        let wheel = |fan: &[u32; 6]| Wheel::of_edges(spokes_and_rims(parent, fan));
        EdgeRows {
            parent,
            wheels: round_regular(r, parent, Wheel::NONE, wheel),
            even: turned(EVEN, [1, 1]),
            odd: turned(ODD, [1, 2]),
        }
    }

    /// The row of the half of an edge at the tail of `h`.
    #[inline]
    pub fn even(&self, h: HalfEdge, columns: &mut [u32], weights: &mut [f64]) -> usize {
        let wheel = &self.wheels[self.parent.tail(h) as usize];
        wheel.write(&self.even[wheel.place(h.edge())], columns, weights)
    }

    /// The row of the edge that cuts a corner off.
    #[inline]
    pub fn odd(&self, corner: u32, last: &mut Last, columns: &mut [u32], weights: &mut [f64]) -> usize {
        let (face, i) = (corner as usize / 3, corner as usize % 3);
        if last.face != face {
            let corners = std::array::from_fn(|j| (3 * face + j) as u32);
            *last = Last { face, wheel: Wheel::of_edges(sides_and_across(self.parent, corners)) };
        }
        last.wheel.write(&self.odd[i], columns, weights)
    }
}

/// The regular rows of `S2` of triangles, but for those of triangles in the middle.
pub struct FaceRows {
    wheels: Vec<Wheel<6>>,
    corner: [Weights; 6],
}

impl FaceRows {
    pub fn new(r: &Refinement, parent: &Mesh) -> Self {
        let places = std::array::from_fn(|i| 2 * i as u8);
        let wheel = |fan: &[u32; 6]| Wheel::sorted(fan.map(|c| parent.corner_face(c)), places);
        FaceRows { wheels: round_regular(r, parent, Wheel::NONE, wheel), corner: turned(CORNER, [1, 0]) }
    }

    /// The row of the child of a face at a vertex.
    #[inline]
    pub fn at(&self, vertex: u32, face: u32, columns: &mut [u32], weights: &mut [f64]) -> usize {
        let wheel = &self.wheels[vertex as usize];
        wheel.write(&self.corner[wheel.place(face)], columns, weights)
    }
}

/// What `of` makes of the six triangles round each regular vertex; `none` for all others.
pub fn round_regular<W: Copy + Send + Sync>(
    r: &Refinement,
    parent: &Mesh,
    none: W,
    of: impl Fn(&[u32; 6]) -> W + Sync,
) -> Vec<W> {
    let vertices = (0..parent.num_vertices() as u32).into_par_iter();
    memory::collect(vertices.map(|v| match r.homotopy.h0.position(v as usize) {
        Some(_) => none,
        None => {
            let fan = parent.fans(v).next().expect("a regular vertex has a fan");
            of(fan.corners.try_into().expect("six triangles round a regular vertex"))
        }
    }))
}
