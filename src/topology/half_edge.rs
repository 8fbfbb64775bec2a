/// An edge together with a direction.
///
/// Half-edge `2e` runs along edge `e`, from its first vertex to its second; `2e + 1` runs against
/// it. A face names its boundary by half-edges, which carry the signs of `d1`; a vertex names the
/// edges that leave it the same way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct HalfEdge(pub u32);

impl HalfEdge {
    /// Edge `e` along its orientation, or against it.
    #[inline]
    pub fn new(edge: u32, along: bool) -> Self {
        HalfEdge(2 * edge + u32::from(!along))
    }

    /// The edge.
    #[inline]
    pub fn edge(self) -> u32 {
        self.0 >> 1
    }

    /// `+1` along the edge, `-1` against it: `c(h) = sign(h) * c[edge(h)]` for a 1-cochain `c`.
    #[inline]
    pub fn sign(self) -> f64 {
        if self.0 & 1 == 0 { 1.0 } else { -1.0 }
    }

    /// The same edge in the other direction.
    #[inline]
    pub fn twin(self) -> Self {
        HalfEdge(self.0 ^ 1)
    }

    /// The position of this half-edge in an array with one entry for each half-edge.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}
