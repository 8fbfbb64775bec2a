//! 1-forms on triangles that are the grandchildren of triangles: sixteen at a time.
//!
//! The children of a triangle are numbered by rule, so the incidence of the level two above, sixteen times smaller, tells
//! where everything is; and what a block of sixteen triangles needs of its surroundings is fetched once for all of them. A
//! block has four families, three at its corners and one in the middle. In a family, whose corners are `v_i` and midpoints
//! `m_i` (of `v_i -> v_{i+1}`), write
//!
//! ```text
//! a_i = c(v_i -> m_i)        b_i = c(m_i -> v_{i+1})        o_i = c(m_i -> m_{i-1})
//! D_i = a_i + o_i + b_{i-1} on the child at v_i        D = -(o_0 + o_1 + o_2) on the one in the middle
//! ```
//!
//! and let a prime mark the family across side `i`, in which that side has number `t`. Then the rows of
//! [`Regular::s1`](crate::scheme::Regular::s1) become sums over these. A child of a half of side `i` looks at both
//! families beside the side and, at its far end, at all round that vertex: it is the sum of what the two corners that
//! name the side give to it, each computed with its own family, and of
//!
//! ```text
//! at the midpoint     (c_0 + c_1)/16 - c/2      c the half of the side, c_0 and c_1 both, away from the midpoint
//! at the vertex v     h_v + c/2                 h_v = (sum of the spokes of v)/16, the displacement (A) of its child
//! ```
//!
//! Where a family across is missing, what is computed stands for nothing: those child edges are exceptions.

use rayon::prelude::*;

use super::triangles::next;
use super::vectors::{self, Part};
use super::{BLOCK, Workspace, patch};
use crate::cochain::Quantity;
use crate::hierarchy::refinement::{NONE, Refinement};
use crate::memory;
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
    let (odd, even) = out.split_at_mut(16 * num_corners);
    let (even, rest) = even.split_at_mut(8 * num_corners);
    let (halved, rest) = rest.split_at_mut(4 * num_corners);
    let chunks = odd.par_chunks_mut(48 * BLOCK).zip(even.par_chunks_mut(24 * BLOCK));
    let chunks = chunks.zip(halved.par_chunks_mut(12 * BLOCK)).zip(sides.par_chunks_mut(24 * BLOCK));
    chunks.enumerate().for_each(|(i, (((odd, even), halved), sides))| {
        let first = 3 * BLOCK * i;
        vectors::run(Run {
            blocks: &blocks,
            first: BLOCK * i,
            odd: odd.as_chunks_mut().0,
            even: even.as_chunks_mut().0,
            halved: halved.as_chunks_mut().0,
            sides: sides.as_chunks_mut().0,
        });
        patch(r, c, 16 * first, odd);
        patch(r, c, 16 * num_corners + 8 * first, even);
        patch(r, c, 24 * num_corners + 4 * first, halved);
    });

    let (sides, _) = sides.as_chunks::<8>();
    rest.par_chunks_mut(8 * BLOCK).enumerate().for_each(|(i, out)| {
        let first = BLOCK * i;
        let (own, beside) = (outer[4 * first..].as_chunks().0, lefts[2 * first..].as_chunks().0);
        let out_of = out.as_chunks_mut().0;
        vectors::run(Edges {
            own,
            beside,
            ends: &top.edges()[first..],
            at_vertices,
            at_midpoints: &at_midpoints[first..],
            sides,
            out: out_of,
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

/// A family and its surroundings, all divided by 32.
#[derive(Clone, Copy)]
struct Family<T> {
    a: [T; 3],
    b: [T; 3],
    o: [T; 3],
    /// `a'_{t+1}`, `o'_{t+1}`, `o'_t`, `b'_{t-1}` across each side.
    across: [[T; 4]; 3],
}

/// A run of blocks, and where their child edges go.
struct Run<'a, T> {
    blocks: &'a Blocks<'a, T>,
    first: usize,
    odd: &'a mut [[T; 48]],
    even: &'a mut [[T; 24]],
    halved: &'a mut [[T; 12]],
    sides: &'a mut [[T; 24]],
}

impl<T: Quantity> Part for Run<'_, T> {
    #[inline(always)]
    fn run(self) {
        let out = self.odd.iter_mut().zip(self.even).zip(self.halved).zip(self.sides);
        for (i, (((odd, even), halved), sides)) in out.enumerate() {
            self.blocks.refine(self.first + i, odd, even, halved, sides);
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
        let zero = T::zero();
        let mut families = [Family { a: [zero; 3], b: [zero; 3], o: [zero; 3], across: [[zero; 4]; 3] }; 4];
        self.fetch(block, &mut families);
        complete(&mut families);
        let mut children = [Children { odd: [zero; 12], even: [zero; 6], sides: [zero; 12] }; 4];
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
            // Side i of the block is that of family i, then that of the next.
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
            // Side i of the block is that of family i, then that of the next.
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

/// Signs and units, and what the families of a block have from each other. Side `n` of family `n - 1` is side `n` of the
/// one in the middle.
#[inline(always)]
fn complete<T: Quantity>(families: &mut [Family<T>; 4]) {
    let (plus, minus) = (|x: T| x.scale(1.0 / 32.0), |x: T| x.scale(-1.0 / 32.0));
    for (i, family) in families.iter_mut().enumerate().take(3) {
        for j in 0..3 {
            (family.a[j], family.b[j]) = (minus(family.a[j]), plus(family.b[j]));
        }
        for side in [i, (i + 2) % 3] {
            let [a, o1, o0, b] = family.across[side];
            family.across[side] = [minus(a), plus(o1), plus(o0), plus(b)];
        }
    }
    for family in families.iter_mut() {
        for j in 0..3 {
            family.o[j] = plus(family.o[j]);
        }
    }
    for i in 0..3 {
        let n = (i + 1) % 3;
        // Seen from the middle, the same edge runs the other way.
        families[3].a[n] = T::zero() - families[i].b[n];
        families[3].b[n] = T::zero() - families[i].a[n];
    }
    for i in 0..3 {
        let n = (i + 1) % 3;
        families[i].across[n] = families[3].seen_across(n);
        families[3].across[n] = families[i].seen_across(n);
    }
}

/// The child edges inside a family: 12 in its triangles, 6 halves of the edges that part these; and for each side what
/// it gives to its children, the one next to its midpoint and the one next to `v_i`, then the two at `v_{i+1}`.
#[derive(Clone, Copy)]
struct Children<T> {
    odd: [T; 12],
    even: [T; 6],
    sides: [T; 12],
}

impl<T: Copy> Children<T> {
    #[inline(always)]
    fn side(&self, i: usize) -> [T; 4] {
        [self.sides[4 * i], self.sides[4 * i + 1], self.sides[4 * i + 2], self.sides[4 * i + 3]]
    }
}

impl<T: Quantity> Family<T> {
    /// What the family across side `t` sees of this one.
    #[inline(always)]
    fn seen_across(&self, t: usize) -> [T; 4] {
        let (n, p) = ((t + 1) % 3, (t + 2) % 3);
        [self.a[n], self.o[n], self.o[t], self.b[p]]
    }

    #[inline(always)]
    fn refine(&self, out: &mut Children<T>) {
        let Family { a, b, o, .. } = self;
        let d = [a[0] + o[0] + b[2], a[1] + o[1] + b[0], a[2] + o[2] + b[1]];
        let middle = T::zero() - (o[0] + o[1] + o[2]);
        self.third([0, 1, 2], &d, middle, out);
        self.third([1, 2, 0], &d, middle, out);
        self.third([2, 0, 1], &d, middle, out);
    }

    /// What belongs to corner `i`, the next one `n` and the previous one `p`; `d` the curls of the children at the corners.
    ///
    /// The row of an odd child edge cuts the corner between the half-edges `e_j` and `e_{j-1}` of its face; with the
    /// curl `D` of the face, and `x`, `y` the half-edges after and before the twin of `e_j` in the face beyond, `z`, `w`
    /// those of `e_{j-1}`, it is `9 e_{j+1} - 3 D + (y - 3 x) + (z - 3 w)`.
    #[inline(always)]
    fn third(&self, [i, n, p]: [usize; 3], d: &[T; 3], middle: T, out: &mut Children<T>) {
        let Family { a, b, o, across } = self;
        let Children { odd, even, sides } = out;
        let three = |x: T| x.scale(3.0);
        let nine = |x: T| x.scale(9.0);
        let two = |x: T| x + x;
        // Across side i, and across side p.
        let ([a1, o1, o0, _], [_, _, o2, b2]) = (across[i], across[p]);
        let d3 = three(d[i]);

        // The child at v_i: a_i, o_i, b_p. At v_i, at m_i and at m_p.
        odd[3 * i + i] = nine(o[i]) - d3 + (o1 - three(a1)) + (o2 - three(b2));
        odd[3 * i + n] = nine(b[p]) - d3 + (three(o[n]) - o[p]) + (a1 - three(o1));
        odd[3 * i + p] = nine(a[i]) - d3 + (b2 - three(o2)) + (three(o[p]) - o[n]);
        // The middle runs against o: at m_n it leaves o_p and is reached by o_n.
        odd[9 + i] = (a[p] - three(b[n])) + (b[i] - three(a[n])) - nine(o[i]) - three(middle);

        // The half of o_i at m_i, and that at m_p: spokes of the one and of the other, then their rims.
        let spokes = two(a[i] + o[n] + o0) + b[i] - o1 - o[i].scale(8.0);
        even[2 * i] = spokes + (b[p] + a1) - (a[n] - o[p]);
        let [_, o1, o0, b2] = across[p];
        let spokes = o[i].scale(8.0) - two(o[p] + o1 + b[p]) - a[p] + o0;
        even[2 * i + 1] = spokes + (b[n] - o[n]) - (b2 + a[i]);

        // Side i: at v_i the child next to its midpoint and the one next to v_i, then the two at v_n.
        let there = three(d[n]);
        let [a3, o3, ..] = across[n];
        sides[4 * i] = two(b[p] - o[n]) - d3 - middle;
        sides[4 * i + 1] = two(b[p] - o[i]) + d3 + (o0 + b2 - b[p]);
        sides[4 * i + 2] = two(o[i] - a[n]) + there + middle;
        sides[4 * i + 3] = two(o[n] - a[n]) - there - (a3 + o3 - a[n]);
    }
}
