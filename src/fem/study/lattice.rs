//! Charts for studies: lattices of cells, with one layer of cells around them.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::StudyError;
use crate::cochain::Cochain;
use crate::limit::LimitSurface;
use crate::scheme::{BoundaryRule, Scheme, Variant};
use crate::topology::{Cage, Descriptor, SplitKind};

/// A domain of the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Region {
    /// `[0, 1]^2`.
    #[default]
    Square,
    /// `[-1, 1]^2` without `(0, 1] x [-1, 0)`.
    Lshape,
}

/// What the cells are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cells {
    /// Squares.
    #[default]
    Quads,
    /// Squares cut from `(0, 0)` to `(1, 1)`.
    Triangles,
}

impl Cells {
    /// How such faces are split.
    pub fn kind(self) -> SplitKind {
        match self {
            Cells::Quads => SplitKind::Quad,
            Cells::Triangles => SplitKind::Triangle,
        }
    }

    /// What they are called.
    pub fn name(self) -> &'static str {
        match self {
            Cells::Quads => "quads",
            Cells::Triangles => "triangles",
        }
    }

    fn scheme(self) -> Scheme {
        match self {
            Cells::Quads => Scheme::default(),
            Cells::Triangles => Scheme::Loop(Variant::Loop, BoundaryRule::Reflect),
        }
    }
}

/// A lattice of square cells, as a cage: those of the region, and as holes those that touch it, so that the region is
/// regular up to its boundary, and the cells of the cage are those whose forms reach it.
#[derive(Clone, Debug)]
pub struct Lattice {
    /// The cage.
    pub cage: Cage,
    /// The positions of its vertices, in the plane.
    pub positions: Cochain<0, Vector3<f64>>,
    cells: Cells,
}

impl Lattice {
    /// With so many cells along a unit of length.
    ///
    /// # Errors
    /// If there are none, or too many.
    pub fn new(region: Region, cells: Cells, per_unit: u32) -> Result<Self, StudyError> {
        if !(2..=1024).contains(&per_unit) {
            return Err(StudyError::Cells { count: per_unit });
        }
        let n = per_unit as i32;
        let (from, to) = match region {
            Region::Square => (0, n),
            Region::Lshape => (-n, n),
        };
        let is_inside = |i: i32, j: i32| {
            (from..to).contains(&i)
                && (from..to).contains(&j)
                && (region == Region::Square || i < 0 || j >= 0)
        };
        let touches =
            |x: i32, y: i32| [(0, 0), (1, 0), (0, 1), (1, 1)].iter().any(|(a, b)| is_inside(x - a, y - b));
        let side = (to - from + 3) as usize;
        let mut number = vec![u32::MAX; side * side];
        let (mut places, mut face_vertices, mut face_sizes, mut holes) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for j in from - 1..=to {
            for i in from - 1..=to {
                let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                let faces: &[&[usize]] = match cells {
                    Cells::Quads => &[&[0, 1, 2, 3]],
                    Cells::Triangles => &[&[0, 1, 2], &[0, 2, 3]],
                };
                // Whole cells, so that the rim has no more irregular vertices than corners.
                if !corners.iter().any(|&(x, y)| touches(x, y)) {
                    continue;
                }
                for face in faces {
                    if !is_inside(i, j) {
                        holes.push(face_sizes.len() as u32);
                    }
                    face_sizes.push(face.len() as u32);
                    for &c in *face {
                        let (x, y) = corners[c];
                        let at = (x - from + 1) as usize + side * (y - from + 1) as usize;
                        if number[at] == u32::MAX {
                            number[at] = places.len() as u32;
                            places.push(Vector3::new(f64::from(x), f64::from(y), 0.0) / f64::from(n));
                        }
                        face_vertices.push(number[at]);
                    }
                }
            }
        }
        let descriptor =
            Descriptor { num_vertices: places.len(), face_sizes, face_vertices, holes, ..Default::default() };
        let cage = Cage::new(descriptor).expect("a lattice is a cage");
        Ok(Lattice { cage, positions: Cochain::new(places), cells })
    }

    /// Its limit surface, which is the plane.
    pub fn surface(&self) -> LimitSurface {
        let surface =
            LimitSurface::new(&self.cage, self.cells.scheme()).expect("a lattice has a limit surface");
        assert_eq!(surface.hierarchy().num_levels(), 0, "features lie apart");
        surface
    }

    /// Whether each face counts.
    pub fn is_inside(&self, face: u32) -> bool {
        self.cage.descriptor().holes.binary_search(&face).is_err()
    }
}
