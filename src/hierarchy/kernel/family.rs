//! Four triangles that are the children of one, and what they give to the 1-form of the next level.
//!
//! In a family, whose corners are `v_i` and midpoints `m_i` (of `v_i -> v_{i+1}`), write
//!
//! ```text
//! a_i = c(v_i -> m_i)        b_i = c(m_i -> v_{i+1})        o_i = c(m_i -> m_{i-1})
//! D_i = a_i + o_i + b_{i-1} on the child at v_i        D = -(o_0 + o_1 + o_2) on the one in the middle
//! ```
//!
//! and let a prime mark the family across side `i`, in which that side has number `t`. Then the rows of
//! [`Regular::s1`](crate::scheme::Regular::s1) become sums over these.

use crate::cochain::Quantity;

/// A family and its surroundings; once they are [`complete`], all divided by 32.
#[derive(Clone, Copy)]
pub struct Family<T> {
    pub a: [T; 3],
    pub b: [T; 3],
    pub o: [T; 3],
    /// `a'_{t+1}`, `o'_{t+1}`, `o'_t`, `b'_{t-1}` across each side.
    pub across: [[T; 4]; 3],
}

/// Signs and units, and what the four families of a block have from each other. Side `n` of family `n - 1` is side `n` of the
/// one in the middle, the last.
#[inline(always)]
pub fn complete<T: Quantity>(families: &mut [Family<T>; 4]) {
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
pub struct Children<T> {
    pub odd: [T; 12],
    pub even: [T; 6],
    sides: [T; 12],
}

impl<T: Quantity> Children<T> {
    #[inline(always)]
    pub fn zero() -> Self {
        Children { odd: [T::zero(); 12], even: [T::zero(); 6], sides: [T::zero(); 12] }
    }

    /// What side `i` gives.
    #[inline(always)]
    pub fn side(&self, i: usize) -> [T; 4] {
        [self.sides[4 * i], self.sides[4 * i + 1], self.sides[4 * i + 2], self.sides[4 * i + 3]]
    }
}

impl<T: Quantity> Family<T> {
    #[inline(always)]
    pub fn zero() -> Self {
        let three = [T::zero(); 3];
        Family { a: three, b: three, o: three, across: [[T::zero(); 4]; 3] }
    }

    /// What the family across side `t` sees of this one.
    #[inline(always)]
    fn seen_across(&self, t: usize) -> [T; 4] {
        let (n, p) = ((t + 1) % 3, (t + 2) % 3);
        [self.a[n], self.o[n], self.o[t], self.b[p]]
    }

    /// Its child edges, from what is around it.
    #[inline(always)]
    pub fn refine(&self, out: &mut Children<T>) {
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
