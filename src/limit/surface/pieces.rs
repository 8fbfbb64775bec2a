//! The faces of a level as pieces of the cage's faces, and the way from one into the next.

use super::super::frame::{Frame, child_corner};
use super::point::SurfacePoint;
use crate::hierarchy::Hierarchy;
use crate::topology::{HalfEdge, Mesh, SplitKind};

/// The corner of the finest level in whose face a point lies, and the point's frame there.
pub(super) fn finest_corner(hierarchy: &Hierarchy, point: &SurfacePoint) -> (u32, Frame) {
    let SurfacePoint { face, corner, s, t } = *point;
    let (kind, cage) = (hierarchy.split_kind(), hierarchy.level(0).mesh());
    let mut frame = Frame::new(s, t);
    let mut corner = cage.corners(face).start + corner;
    for level in 1..=hierarchy.num_levels() {
        let (parent, child) = (hierarchy.level(level - 1).mesh(), hierarchy.level(level).mesh());
        let split = hierarchy.refinement(level).split();
        if kind == SplitKind::Quad && parent.face_size(parent.corner_face(corner)) != 4 {
            corner = split.corner_at(parent, corner);
        } else {
            let (number, below) = frame.descend(kind);
            corner = child_corner(split, parent, child, corner, number);
            frame = below;
        }
    }
    (corner, frame)
}

/// The faces of the finest level of a hierarchy, each with parameters of its own: `u`, `v` from 0 to 1 from its start
/// corner along the edges that leave and reach it, on triangles with `u + v <= 1`. They are the cage's parameters but for
/// scale and offset, so forms and surfaces can be evaluated in them.
#[derive(Clone, Debug)]
pub struct Pieces<'a> {
    hierarchy: &'a Hierarchy,
    list: Vec<Piece>,
}

#[derive(Clone, Copy, Debug)]
struct Piece {
    /// The corner, on its own level, where the parameters start.
    start: u32,
    /// The face and corner of the cage, and the map to its parameters: `origin + scale (u, v)`.
    face: u32,
    corner: u32,
    origin: [f64; 2],
    scale: f64,
}

/// A point of a piece, or beyond its rim in the continuation of its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiecePoint {
    /// The face of the level.
    pub face: u32,
    /// `u` and `v`.
    pub at: [f64; 2],
}

impl<'a> Pieces<'a> {
    /// The pieces of the finest level.
    ///
    /// # Panics
    /// If the level has faces that are no quads in a hierarchy of quads: refine once.
    pub fn new(hierarchy: &'a Hierarchy) -> Self {
        let (kind, cage) = (hierarchy.split_kind(), hierarchy.level(0).mesh());
        let whole = |face: u32| {
            let start = cage.corners(face).start;
            Piece { start, face, corner: 0, origin: [0.0; 2], scale: 1.0 }
        };
        let mut list: Vec<Piece> = (0..cage.num_faces() as u32).map(whole).collect();
        for level in 1..=hierarchy.num_levels() {
            let (parent, child) = (hierarchy.level(level - 1).mesh(), hierarchy.level(level).mesh());
            let split = hierarchy.refinement(level).split();
            let mut below = vec![list[0]; child.num_faces()];
            for (face, piece) in list.iter().enumerate() {
                if kind == SplitKind::Quad && parent.face_size(face as u32) != 4 {
                    for (corner, at) in parent.corners(face as u32).enumerate() {
                        let start = split.corner_at(parent, at);
                        below[child.corner_face(start) as usize] =
                            Piece { start, corner: corner as u32, ..*piece };
                    }
                    continue;
                }
                for number in 0..4 {
                    let start = child_corner(split, parent, child, piece.start, number);
                    let (offset, half) = match (kind, number) {
                        (SplitKind::Triangle, 3) => ([0.5, 0.5], -0.5),
                        (SplitKind::Triangle, _) => ([[0.0, 0.0], [0.5, 0.0], [0.0, 0.5]][number], 0.5),
                        (SplitKind::Quad, _) => {
                            ([[0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]][number], 0.5)
                        }
                    };
                    let origin = [0, 1].map(|k| piece.origin[k] + piece.scale * offset[k]);
                    below[child.corner_face(start) as usize] =
                        Piece { start, origin, scale: piece.scale * half, ..*piece };
                }
            }
            list = below;
        }
        let square =
            |face: u32| kind == SplitKind::Triangle || hierarchy.finest().mesh().face_size(face) == 4;
        assert!((0..list.len() as u32).all(square), "polygons have no parameters before they are refined");
        Pieces { hierarchy, list }
    }

    /// The level's mesh.
    pub fn mesh(&self) -> &'a Mesh {
        self.hierarchy.finest().mesh()
    }

    /// The number of corners of the pieces.
    pub fn num_corners(&self) -> usize {
        if self.hierarchy.split_kind() == SplitKind::Quad { 4 } else { 3 }
    }

    /// The corner, on the level, where a piece's parameters start.
    pub fn start(&self, face: u32) -> u32 {
        self.list[face as usize].start
    }

    /// The size of a piece in the cage's parameters, negative if its axes run against them.
    pub fn scale(&self, face: u32) -> f64 {
        self.list[face as usize].scale
    }

    /// The parameters of a piece's corners.
    pub fn corners(&self) -> &'static [[f64; 2]] {
        match self.hierarchy.split_kind() {
            SplitKind::Quad => &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            SplitKind::Triangle => &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
        }
    }

    /// The point of the surface, moved onto the piece if it is beyond its rim.
    pub fn surface_point(&self, point: PiecePoint) -> SurfacePoint {
        let piece = &self.list[point.face as usize];
        let [mut u, mut v] = point.at.map(|x| x.clamp(0.0, 1.0));
        if self.num_corners() == 3 && u + v > 1.0 {
            (u, v) = (u / (u + v), v / (u + v));
        }
        let at = |k: usize| (piece.origin[k] + piece.scale * [u, v][k]).clamp(0.0, 1.0);
        let (s, t) = (at(0), at(1));
        SurfacePoint { face: piece.face, corner: piece.corner, s, t }
    }

    /// The piece that holds a point of the surface.
    pub fn locate(&self, point: &SurfacePoint) -> PiecePoint {
        let kind = self.hierarchy.split_kind();
        let (corner, frame) = finest_corner(self.hierarchy, point);
        let (mesh, n) = (self.mesh(), self.num_corners() as u32);
        let face = mesh.corner_face(corner);
        let steps = (self.list[face as usize].start + n - corner) % n;
        PiecePoint { face, at: frame.turned(kind, steps as usize).point }
    }

    /// The half-edge that leaves corner `i` of a piece, counted from its start.
    pub fn half_edge(&self, face: u32, i: usize) -> HalfEdge {
        self.mesh().corner_half_edge(self.corner(face, i))
    }

    fn corner(&self, face: u32, i: usize) -> u32 {
        let (first, n) = (self.mesh().corners(face).start, self.num_corners() as u32);
        first + (self.list[face as usize].start - first + i as u32) % n
    }

    /// The edge of its piece that a point is furthest beyond, by number from the start corner; `None` on the piece.
    pub fn beyond(&self, point: PiecePoint) -> Option<usize> {
        let [u, v] = point.at;
        let distances: &[f64] = match self.num_corners() {
            4 => &[v, 1.0 - u, 1.0 - v, u],
            _ => &[v, 1.0 - u - v, u],
        };
        let (i, least) = (0..distances.len())
            .map(|i| (i, distances[i]))
            .fold((0, f64::INFINITY), |least, next| if next.1 < least.1 { next } else { least });
        (least < -1e-12).then_some(i)
    }

    /// A point and a vector of one piece in the parameters of that across edge `i`, its parameters being continued past
    /// the edge; `None` if nothing is there. Away from irregular vertices the continued parameters are as smooth as the
    /// surface.
    pub fn across(&self, point: PiecePoint, vector: [f64; 2], i: usize) -> Option<(PiecePoint, [f64; 2])> {
        let (corners, n) = (self.corners(), self.num_corners());
        let twin = self.half_edge(point.face, i).twin();
        let corner = self.mesh().left_corner(twin)?;
        let face = self.mesh().corner_face(corner);
        let j = (0..n).find(|&j| self.corner(face, j) == corner).expect("the corner is one of the face's");
        // p = c_i + x a_i + y b_i is c_j + (1 - x) a_j - y b_j there.
        let axes = |i: usize| {
            let difference = |to: usize| [0, 1].map(|k| corners[to][k] - corners[i][k]);
            [difference((i + 1) % n), difference((i + n - 1) % n)]
        };
        let ([a, b], [c, d]) = (axes(i), axes(j));
        let determinant = a[0] * b[1] - a[1] * b[0];
        let along = |p: [f64; 2]| {
            [(p[0] * b[1] - p[1] * b[0]) / determinant, (a[0] * p[1] - a[1] * p[0]) / determinant]
        };
        let [x, y] = along([point.at[0] - corners[i][0], point.at[1] - corners[i][1]]);
        let [dx, dy] = along(vector);
        let at = [0, 1].map(|k| corners[j][k] + (1.0 - x) * c[k] - y * d[k]);
        Some((PiecePoint { face, at }, [0, 1].map(|k| -dx * c[k] - dy * d[k])))
    }
}
