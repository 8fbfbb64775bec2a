use std::ops::Range;

/// Which corners belong to which face. Where all faces are triangles, or all quads, as on every level but the
/// first, arithmetic says it and nothing is stored.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Faces {
    /// So many triangles.
    Triangles(usize),
    /// So many quads.
    Quads(usize),
    /// Face `f` has the corners `offsets[f]..offsets[f + 1]`; `face` has for each corner its face.
    Polygons { offsets: Vec<u32>, face: Vec<u32> },
}

use Faces::{Polygons, Quads, Triangles};

impl Faces {
    /// Faces of these sizes.
    pub fn new(sizes: &[u32]) -> Self {
        let all = |n: u32| !sizes.is_empty() && sizes.iter().all(|&size| size == n);
        if all(3) {
            return Triangles(sizes.len());
        }
        if all(4) {
            return Quads(sizes.len());
        }
        let mut offsets = Vec::with_capacity(sizes.len() + 1);
        offsets.push(0);
        let mut face = Vec::new();
        for (f, &size) in sizes.iter().enumerate() {
            face.extend((0..size).map(|_| f as u32));
            offsets.push(face.len() as u32);
        }
        Polygons { offsets, face }
    }

    pub fn len(&self) -> usize {
        match self {
            Triangles(count) | Quads(count) => *count,
            Polygons { offsets, .. } => offsets.len() - 1,
        }
    }

    /// The number of sides of every face, if they are all alike.
    pub fn uniform_size(&self) -> Option<usize> {
        match self {
            Triangles(_) => Some(3),
            Quads(_) => Some(4),
            Polygons { offsets, .. } => {
                let first = offsets.get(1).map_or(0, |&size| size as usize);
                let alike = offsets.windows(2).all(|ends| (ends[1] - ends[0]) as usize == first);
                alike.then_some(first)
            }
        }
    }

    #[inline]
    pub fn corners(&self, f: u32) -> Range<u32> {
        match self {
            Triangles(_) => 3 * f..3 * f + 3,
            Quads(_) => 4 * f..4 * f + 4,
            Polygons { offsets, .. } => offsets[f as usize]..offsets[f as usize + 1],
        }
    }

    #[inline]
    pub fn of_corner(&self, c: u32) -> u32 {
        match self {
            Triangles(_) => c / 3,
            Quads(_) => c / 4,
            Polygons { face, .. } => face[c as usize],
        }
    }

    #[inline]
    pub fn next(&self, c: u32) -> u32 {
        match self {
            Triangles(_) => c + 1 - 3 * u32::from(c % 3 == 2),
            Quads(_) => (c & !3) | ((c + 1) & 3),
            Polygons { .. } => {
                let range = self.corners(self.of_corner(c));
                if c + 1 == range.end { range.start } else { c + 1 }
            }
        }
    }

    #[inline]
    pub fn previous(&self, c: u32) -> u32 {
        match self {
            Triangles(_) => c + 3 * u32::from(c.is_multiple_of(3)) - 1,
            Quads(_) => (c & !3) | (c.wrapping_sub(1) & 3),
            Polygons { .. } => {
                let range = self.corners(self.of_corner(c));
                if c == range.start { range.end - 1 } else { c - 1 }
            }
        }
    }
}
