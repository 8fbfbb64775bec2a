//! Parameters on faces, and how they change from a face to its children.

use crate::topology::{Mesh, Split, SplitKind};

/// A point of a face, in parameters that start at one of its corners, with what they are to an outer frame.
///
/// On a quad with corners `v, a, q, b`, counter-clockwise from the frame's, `(s, t)` in `[0, 1]^2` is
/// `v + s (a - v) + t (b - v)`; on a triangle `(v, a, b)` it is the point with barycentric coordinates
/// `(1 - s - t, s, t)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// `(s, t)`.
    pub point: [f64; 2],
    /// `jacobian[i][k]`: the derivative of parameter `i` by parameter `k` of the outer frame.
    pub jacobian: [[f64; 2]; 2],
}

impl Frame {
    /// The outer frame itself.
    pub fn new(s: f64, t: f64) -> Self {
        Frame { point: [s, t], jacobian: [[1.0, 0.0], [0.0, 1.0]] }
    }

    /// The child face that holds the point, by number, and the frame there. The children of a quad are
    /// numbered counter-clockwise from the frame's corner, those of a triangle likewise with the one in the
    /// middle last. A child's axes are parallel to its parent's, those of the middle triangle opposite.
    pub fn descend(self, kind: SplitKind) -> (usize, Frame) {
        let [s, t] = self.point;
        let (child, point, scale) = match kind {
            SplitKind::Quad => match (s >= 0.5, t >= 0.5) {
                (false, false) => (0, [2.0 * s, 2.0 * t], 2.0),
                (true, false) => (1, [2.0 * s - 1.0, 2.0 * t], 2.0),
                (true, true) => (2, [2.0 * s - 1.0, 2.0 * t - 1.0], 2.0),
                (false, true) => (3, [2.0 * s, 2.0 * t - 1.0], 2.0),
            },
            SplitKind::Triangle if s >= 0.5 => (1, [2.0 * s - 1.0, 2.0 * t], 2.0),
            SplitKind::Triangle if t >= 0.5 => (2, [2.0 * s, 2.0 * t - 1.0], 2.0),
            SplitKind::Triangle if s + t <= 0.5 => (0, [2.0 * s, 2.0 * t], 2.0),
            SplitKind::Triangle => (3, [1.0 - 2.0 * s, 1.0 - 2.0 * t], -2.0),
        };
        (child, Frame { point, jacobian: self.jacobian.map(|row| row.map(|x| scale * x)) })
    }

    /// The same point in the frame that starts `steps` corners further, counter-clockwise.
    pub fn turned(self, kind: SplitKind, steps: usize) -> Frame {
        let ([s, t], [ds, dt]) = (self.point, self.jacobian);
        let minus = |row: [f64; 2]| row.map(|x| -x);
        let third = (1.0 - s - t, [-ds[0] - dt[0], -ds[1] - dt[1]]);
        let (point, jacobian) = match (kind, steps) {
            (_, 0) => ([s, t], [ds, dt]),
            (SplitKind::Quad, 1) => ([t, 1.0 - s], [dt, minus(ds)]),
            (SplitKind::Quad, 2) => ([1.0 - s, 1.0 - t], [minus(ds), minus(dt)]),
            (SplitKind::Quad, _) => ([1.0 - t, s], [minus(dt), ds]),
            (SplitKind::Triangle, 1) => ([t, third.0], [dt, third.1]),
            (SplitKind::Triangle, _) => ([third.0, s], [third.1, ds]),
        };
        Frame { point, jacobian }
    }

    /// The components of a covector of this frame in the outer one.
    #[inline]
    pub fn pull<T>(&self, c: [T; 2]) -> [T; 2]
    where
        T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
    {
        let j = &self.jacobian;
        [c[0] * j[0][0] + c[1] * j[1][0], c[0] * j[0][1] + c[1] * j[1][1]]
    }

    /// The area of this frame's unit square in units of the outer one's, inverted.
    pub fn determinant(&self) -> f64 {
        let j = &self.jacobian;
        j[0][0] * j[1][1] - j[0][1] * j[1][0]
    }
}

/// The corner, on the next level, where the frame of a child starts, `corner` being where its parent's does.
pub fn child_corner(split: &Split, parent: &Mesh, child_mesh: &Mesh, corner: u32, child: usize) -> u32 {
    let turn = |mesh: &Mesh, corner, steps| (0..steps).fold(corner, |c, _| mesh.next_corner(c));
    match split.kind() {
        SplitKind::Quad => {
            let at = split.corner_at(parent, turn(parent, corner, child));
            turn(child_mesh, at, (4 - child) % 4)
        }
        SplitKind::Triangle if child == 3 => split.middle_corner(parent, corner),
        SplitKind::Triangle => {
            let at = split.corner_at(parent, turn(parent, corner, child));
            turn(child_mesh, at, (3 - child) % 3)
        }
    }
}
