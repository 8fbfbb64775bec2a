//! 1-forms on triangles that are the grandchildren of triangles: sixteen at a time.
//!
//! The children of a triangle are numbered by rule, so the incidence of the level two above, sixteen times smaller, tells
//! where everything is; and what a block of sixteen triangles needs of its surroundings is fetched once for all of them. A
//! block has four families, see [`super::family`], three at its corners and one in the middle: family `i` lies at corner
//! `i`, and side `i` of the block is the side `i` of that family, then that of the next.
//!
//! A child of a half of a side of a family looks at both families beside the side and, at its far end, at all round that
//! vertex: it is the sum of what the two corners that name the side give to it, each computed with its own family, and of
//!
//! ```text
//! at the midpoint     (c_0 + c_1)/16 - c/2      c the half of the side, c_0 and c_1 both, away from the midpoint
//! at the vertex v     h_v + c/2                 h_v = (sum of the spokes of v)/16, the displacement (A) of its child
//! ```
//!
//! Where a family across is missing, what is computed stands for nothing: those child edges are exceptions.
//!
//! A block is fetched, computed and stored in turn, by way of small arrays. Compiled for long vectors that is half again as
//! fast as all at once, mostly because it leaves for memory in long stores; the blocks of several triangles, or the families
//! of one, side by side in the lanes of vectors were slower.

use rayon::prelude::*;

use super::family::{Children, Family, complete};
use super::triangles::next;
use super::vectors::{self, Part};
use super::{BLOCK, Workspace, patch};
use crate::cochain::Quantity;
use crate::hierarchy::refinement::{NONE, Refinement};
use crate::memory::{self, Stores};
use crate::topology::{HalfEdge, Mesh};

/// `top` is the level two above the parent.
pub fn form1<T: Quantity>(r: &Refinement, top: &Mesh, c: &[T], out: &mut [T], workspace: &mut Workspace<T>) {
    let (num_corners, num_vertices) = (top.num_corners(), top.num_vertices());
    let (inside, halves) = c.split_at(4 * num_corners);
    let (inner, outer) = halves.split_at(2 * num_corners);
    let (corners, lefts) = (top.corner_half_edges(), top.left_corners());

    // h at the children of the vertices of the level above: those of vertices, and midpoints.
    let displaced = &mut workspace.vertices;
    memory::reuse(displaced, num_vertices + top.num_edges(), T::zero());
    let (at_vertices, at_midpoints) = displaced.split_at_mut(num_vertices);
    at_vertices.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(v, out)| {
        let spokes = top.vertex_half_edges(v as u32).iter();
        *out = spokes.fold(T::zero(), |sum, &h| sum + outer[2 * h.index() + 1]).scale(-1.0 / 16.0);
    });
    at_midpoints.par_chunks_mut(BLOCK).enumerate().for_each(|(i, out)| {
        let first = BLOCK * i;
        let edges = outer[4 * first..].as_chunks::<4>().0.iter().zip(lefts[2 * first..].as_chunks::<2>().0);
        for (out, (own, &[left, right])) in out.iter_mut().zip(edges) {
            if left != NONE.0 && right != NONE.0 {
                let inside = |c: u32| inner[2 * c as usize] + inner[2 * next(c) as usize + 1];
                *out = ((own[0] + own[2]) + (inside(left) + inside(right))).scale(-1.0 / 16.0);
            }
        }
    });
    let (at_vertices, at_midpoints) = (&*at_vertices, &*at_midpoints);

    // What each corner of the level two above gives to the eight children of the side that it names.
    let sides = &mut workspace.faces;
    memory::reuse(sides, 8 * num_corners, T::zero());
    let blocks = Blocks { corners, lefts, inside, inner, outer, at_midpoints };
    let bytes = size_of_val(out);
    let (odd, even) = out.split_at_mut(16 * num_corners);
    let (even, rest) = even.split_at_mut(8 * num_corners);
    let (halved, rest) = rest.split_at_mut(4 * num_corners);
    let chunks = odd.par_chunks_mut(48 * BLOCK).zip(even.par_chunks_mut(24 * BLOCK));
    let chunks = chunks.zip(halved.par_chunks_mut(12 * BLOCK)).zip(sides.par_chunks_mut(24 * BLOCK));
    chunks.enumerate().for_each(|(i, (((odd, even), halved), sides))| {
        let first = BLOCK * i;
        Stores::to_array_of(bytes, |stores| {
            vectors::run(Insides {
                blocks: &blocks,
                stores,
                first,
                odd: odd.as_chunks_mut().0,
                even: even.as_chunks_mut().0,
                halved: halved.as_chunks_mut().0,
                sides: sides.as_chunks_mut().0,
            });
        });
        patch(r, c, 48 * first, odd);
        patch(r, c, 16 * num_corners + 24 * first, even);
        patch(r, c, 24 * num_corners + 12 * first, halved);
    });

    let (sides, _) = sides.as_chunks::<8>();
    rest.par_chunks_mut(8 * BLOCK).enumerate().for_each(|(i, out)| {
        let first = BLOCK * i;
        vectors::run(Edges {
            own: outer[4 * first..].as_chunks().0,
            beside: lefts[2 * first..].as_chunks().0,
            ends: &top.edges()[first..],
            at_vertices,
            at_midpoints: &at_midpoints[first..],
            sides,
            out: out.as_chunks_mut().0,
        });
        patch(r, c, 28 * num_corners + 8 * first, out);
    });
}

/// A run of edges of the level two above the parent.
struct Edges<'a, T> {
    own: &'a [[T; 4]],
    beside: &'a [[u32; 2]],
    ends: &'a [[u32; 2]],
    at_vertices: &'a [T],
    at_midpoints: &'a [T],
    sides: &'a [[T; 8]],
    out: &'a mut [[T; 8]],
}

impl<T: Quantity> Part for Edges<'_, T> {
    #[inline(always)]
    fn run(self) {
        let edges = self.own.iter().zip(self.beside).zip(self.ends).zip(self.at_midpoints);
        for (out, (((own, &[left, right]), ends), &at_m)) in self.out.iter_mut().zip(edges) {
            if left != NONE.0 && right != NONE.0 {
                // From either end: the half there, that on the left of which the child goes to the vertex.
                let (left, right) = (&self.sides[left as usize], &self.sides[right as usize]);
                let at_v = [self.at_vertices[ends[0] as usize], self.at_vertices[ends[1] as usize]];
                let tail = halve([own[0], own[1]], [at_m, at_v[0]], four(right, 4), four(left, 0));
                let head = halve([own[2], own[3]], [at_m, at_v[1]], four(left, 4), four(right, 0));
                *out = [tail[0], tail[1], tail[2], tail[3], head[0], head[1], head[2], head[3]];
            }
        }
    }
}

#[inline(always)]
fn four<T: Copy>(values: &[T], at: usize) -> [T; 4] {
    [values[at], values[at + 1], values[at + 2], values[at + 3]]
}

/// The four children of an edge of the level above: `own` its halves, `at` the displacements of its ends, and what the
/// families on the left and right of it give.
#[inline(always)]
fn halve<T: Quantity>(own: [T; 2], at: [T; 2], left: [T; 4], right: [T; 4]) -> [T; 4] {
    let at_m = (own[0] + own[1]).scale(1.0 / 16.0);
    let (c0, c1) = (own[0].scale(0.5), own[1].scale(0.5));
    [
        at_m - c0 + (left[0] + right[2]),
        at[0] + c0 + (left[1] + right[3]),
        at_m - c1 + (right[0] + left[2]),
        at[1] + c1 + (right[1] + left[3]),
    ]
}

/// A 1-cochain on the grandchildren of triangles.
struct Blocks<'a, T> {
    corners: &'a [HalfEdge],
    lefts: &'a [u32],
    /// Inside the families: `o`.
    inside: &'a [T],
    /// Halves of the edges between the families of a block, directed away from the midpoints.
    inner: &'a [T],
    /// Quarters of the edges of the blocks, likewise.
    outer: &'a [T],
    at_midpoints: &'a [T],
}

/// A run of blocks, and where their child edges go.
struct Insides<'a, T> {
    blocks: &'a Blocks<'a, T>,
    stores: Option<&'a Stores>,
    first: usize,
    odd: &'a mut [[T; 48]],
    even: &'a mut [[T; 24]],
    halved: &'a mut [[T; 12]],
    sides: &'a mut [[T; 24]],
}

impl<T: Quantity> Part for Insides<'_, T> {
    #[inline(always)]
    fn run(self) {
        let out = self.odd.iter_mut().zip(self.even).zip(self.halved).zip(self.sides);
        let (odd_here, even_here) = (&mut [T::zero(); 48], &mut [T::zero(); 24]);
        let halved_here = &mut [T::zero(); 12];
        for (i, (((odd, even), halved), sides)) in out.enumerate() {
            match self.stores {
                None => self.blocks.refine(self.first + i, odd, even, halved, sides),
                Some(stores) => {
                    self.blocks.refine(self.first + i, odd_here, even_here, halved_here, sides);
                    stores.copy(odd, odd_here);
                    stores.copy(even, even_here);
                    stores.copy(halved, halved_here);
                }
            }
        }
    }
}

impl<T: Quantity> Blocks<'_, T> {
    /// The child edges inside a block: 48 in its triangles, 24 halves of edges inside its families, 12 on the edges between
    /// these; and for each of its sides what that gives to its own.
    #[inline(always)]
    fn refine(
        &self,
        block: usize,
        odd: &mut [T; 48],
        even: &mut [T; 24],
        halved: &mut [T; 12],
        sides: &mut [T; 24],
    ) {
        let mut families = [Family::zero(); 4];
        self.fetch(block, &mut families);
        complete(&mut families);
        let mut children = [Children::zero(); 4];
        for (family, children) in families.iter().zip(&mut children) {
            family.refine(children);
        }
        for (f, family) in children.iter().enumerate() {
            odd[12 * f..12 * f + 12].copy_from_slice(&family.odd);
            even[6 * f..6 * f + 6].copy_from_slice(&family.even);
        }
        let corners = &self.corners[3 * block..3 * block + 3];
        let inner = &self.inner[6 * block..6 * block + 6];
        let at = |i: usize| self.at_midpoints[corners[i].edge() as usize];
        for i in 0..3 {
            let (n, p) = ((i + 1) % 3, (i + 2) % 3);
            // The edge between family i and the one in the middle leads from one midpoint to another.
            let own = [inner[2 * i], inner[2 * i + 1]];
            let at = [at(i), at(p)];
            let four = halve(own, at, children[i].side(n), children[3].side(n));
            halved[4 * i..4 * i + 4].copy_from_slice(&four);
            sides[8 * i..8 * i + 4].copy_from_slice(&children[i].side(i));
            sides[8 * i + 4..8 * i + 8].copy_from_slice(&children[n].side(i));
        }
    }

    /// What the families of a block need of memory: not what they have from each other, which is left to [`complete`].
    #[inline(always)]
    fn fetch(&self, block: usize, families: &mut [Family<T>; 4]) {
        let corners = &self.corners[3 * block..3 * block + 3];
        let inside = &self.inside[12 * block..12 * block + 12];
        let inner = &self.inner[6 * block..6 * block + 6];
        for (f, family) in families.iter_mut().enumerate() {
            family.o.copy_from_slice(&inside[3 * f..3 * f + 3]);
        }
        for i in 0..3 {
            let n = (i + 1) % 3;
            (families[i].a[n], families[i].b[n]) = (inner[2 * i], inner[2 * i + 1]);
            let h = corners[i];
            let (there, back) = (self.quarters(h), self.quarters(h.twin()));
            (families[i].a[i], families[i].b[i]) = (there[1], there[0]);
            (families[n].a[i], families[n].b[i]) = (back[0], back[1]);

            let t = match self.lefts[h.twin().index()] {
                t if t == NONE.0 => (3 * block + i) as u32,
                t => t,
            };
            let (block, t) = (t as usize / 3, t as usize % 3);
            let (j, p) = (if t == 2 { 0 } else { t + 1 }, if t == 0 { 2 } else { t - 1 });
            let corners = &self.corners[3 * block..3 * block + 3];
            let inside = &self.inside[12 * block..12 * block + 12];
            let inner = &self.inner[6 * block..6 * block + 6];
            // The family there at the end of side t, then that at its beginning.
            families[i].across[i] =
                [self.quarters(corners[j])[1], inside[3 * j + j], inside[3 * j + t], inner[2 * j + 1]];
            families[n].across[i] =
                [inner[2 * t], inside[3 * t + j], inside[3 * t + t], self.quarters(corners[p].twin())[1]];
        }
    }

    /// The quarters of the half of an edge at the tail of `h`: that at the midpoint, and that at the vertex.
    #[inline(always)]
    fn quarters(&self, h: HalfEdge) -> &[T] {
        &self.outer[2 * h.index()..2 * h.index() + 2]
    }
}
