//! The regular rows of `S1` of triangles where the order of their terms does not matter: what rows share is looked up once.

use std::ops::Range;

use super::refinement::Refinement;
use super::wheel::round_regular;
use crate::cochain::Quantity;
use crate::scheme::Regular;
use crate::scheme::triangle_rows::{EVEN, ODD, sides_and_across, spokes_and_rims};
use crate::topology::{HalfEdge, Mesh};

/// A regular vertex: its six spokes, and the edges opposite to it, of which the first are there again after the last, so
/// that those of a row lie side by side however it is turned. One line of the cache.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Hub([HalfEdge; 16]);

/// The hubs of all regular vertices; what stands for others means nothing.
#[derive(Clone, Debug)]
pub struct Hubs(Vec<Hub>);

/// The terms of an even row, and of an odd one: the weights that are not 0.
pub const EVEN_TERMS: usize = 10;
pub const ODD_TERMS: usize = 7;

/// The weights of the spokes of a row, twice: those of a row that begins at spoke `i` begin at `6 - i`.
const SPOKES: [f64; 12] = {
    let mut twice = [0.0; 12];
    let mut i = 0;
    while i < 12 {
        twice[i] = EVEN[i % 6];
        i += 1;
    }
    twice
};

/// The weights of the edges opposite from the fourth on, the others of which have none.
const RIMS: [f64; 4] = [EVEN[10], EVEN[11], EVEN[6], EVEN[7]];

impl Hubs {
    /// Those of a step; none but for Loop's schemes.
    pub fn new(r: &Refinement, parent: &Mesh) -> Option<Self> {
        let hub = |fan: &[u32; 6]| {
            let edges = spokes_and_rims(parent, fan);
            let mut hub = [HalfEdge(0); 16];
            hub[..12].copy_from_slice(&edges);
            hub[12..].copy_from_slice(&edges[6..10]);
            Hub(hub)
        };
        let hubs = || Hubs(round_regular(r, parent, Hub([HalfEdge(0); 16]), hub));
        (r.homotopy.regular == Regular::Loop).then(hubs)
    }

    /// Writes a run of regular rows, one after the other, to the beginning of two slices; how many terms they have.
    pub fn write<W: Quantity>(
        &self,
        parent: &Mesh,
        rows: Range<usize>,
        columns: &mut [u32],
        weights: &mut [W],
    ) -> usize {
        let first_even = parent.num_corners().clamp(rows.start, rows.end);
        let (odd, even) = (rows.start..first_even, first_even..rows.end);
        let (num_odd, num_even) = (ODD_TERMS * odd.len(), EVEN_TERMS * even.len());
        let (odd_columns, even_columns) = columns[..num_odd + num_even].split_at_mut(num_odd);
        let (odd_weights, even_weights) = weights[..num_odd + num_even].split_at_mut(num_odd);
        if !odd.is_empty() {
            write_odd(parent, odd, odd_columns.as_chunks_mut().0, odd_weights.as_chunks_mut().0);
        }

        let first = even.start.wrapping_sub(parent.num_corners());
        let out = even_columns.as_chunks_mut().0.iter_mut().zip(even_weights.as_chunks_mut().0);
        for (i, (columns, weights)) in out.enumerate() {
            let h = HalfEdge((first + i) as u32);
            self.0[parent.tail(h) as usize].write(h, columns, weights);
        }
        num_odd + num_even
    }
}

impl Hub {
    /// The row of the half `m -> v` at the vertex of the edge of a spoke `h`.
    #[inline]
    fn write<W: Quantity>(
        &self,
        h: HalfEdge,
        columns: &mut [u32; EVEN_TERMS],
        weights: &mut [W; EVEN_TERMS],
    ) {
        let Hub(edges) = self;
        let (mut place, mut fourth) = (0, 0);
        for (i, &spoke) in edges[..6].iter().enumerate() {
            let here = spoke == h;
            place += if here { i } else { 0 };
            fourth += if here { (i + 4) % 6 } else { 0 };
        }
        let spokes = SPOKES[6 - place..].first_chunk::<6>().expect("a row begins at one of six spokes");
        let rims = edges[6 + fourth..].first_chunk::<4>().expect("a row begins at one of six spokes");
        for j in 0..6 {
            (columns[j], weights[j]) = term(edges[j], spokes[j]);
        }
        for j in 0..4 {
            (columns[6 + j], weights[6 + j]) = term(rims[j], RIMS[j]);
        }
    }
}

/// The rows of a run of corners, three to a triangle.
fn write_odd<W: Quantity>(
    parent: &Mesh,
    corners: Range<usize>,
    columns: &mut [[u32; ODD_TERMS]],
    weights: &mut [[W; ODD_TERMS]],
) {
    for face in corners.start / 3..corners.end.div_ceil(3) {
        let edges = sides_and_across(parent, std::array::from_fn(|i| (3 * face + i) as u32));
        for i in 0..3 {
            let (next, previous) = ((i + 1) % 3, (i + 2) % 3);
            let places = [i, next, previous, 3 + 2 * i, 4 + 2 * i, 3 + 2 * previous, 4 + 2 * previous];
            let row_weights = [ODD[0], ODD[1], ODD[2], ODD[3], ODD[4], ODD[7], ODD[8]];
            // The run may begin or end within a triangle.
            let row = (3 * face + i).wrapping_sub(corners.start);
            if let (Some(columns), Some(weights)) = (columns.get_mut(row), weights.get_mut(row)) {
                for j in 0..ODD_TERMS {
                    (columns[j], weights[j]) = term(edges[places[j]], row_weights[j]);
                }
            }
        }
    }
}

#[inline]
fn term<W: Quantity>(h: HalfEdge, weight: f64) -> (u32, W) {
    (h.edge(), W::one().scale(weight).negate_if(h.index() % 2 == 1))
}
