//! The characteristic map of a vertex, and forms on it.

use std::f64::consts::TAU;

use nalgebra::{Complex, Vector2, Vector3};

use super::AnalysisError;
use super::ring::Ring;
use super::spectrum::{eigenvalues, eigenvector};
use super::symmetry::{Block, Symmetry};
use crate::cochain::Cochain;
use crate::hierarchy::HierarchyError;
use crate::limit::{Jet, LimitSurface, PointError, SurfacePoint};
use crate::topology::{Cage, SplitKind};

/// The characteristic map: the limit surface in the plane whose control points on the rings of a vertex are the two subdominant
/// eigenvectors of `S0`, `x` and `y`. Refined, it is itself, scaled by the eigenvalues.
///
/// Inside the surface these are the real and imaginary part of the largest eigenvalue of mode 1, with the end of the first
/// spoke at `(1, 0)`. At a boundary vertex `x` is the dominant odd eigenvector, 1 at the end of the first spoke and -1 at
/// that of the last, and `y` the dominant even one but the constants, at most 1 on the first ring. OpenSubdiv's rules have more
/// than one eigenvector for an eigenvalue there if `k` is 1, and 4 (Catmull-Clark) or 6 (Loop); with more faces the `x` that they
/// have vanishes along the boundary, and so the map is not injective. Modified Loop has no such vertices from `k = 2` on.
///
/// Points are those of the cage ([`Ring::descriptor`]): its faces `0 .. k` are those at the vertex, which is their corner 0. The map
/// is defined on all rings of faces but the last one.
pub struct CharacteristicMap {
    ring: Ring,
    eigenvalues: [f64; 2],
    /// On the vertices of the rings.
    control: Vec<Vector2<f64>>,
    surface: LimitSurface,
    /// On the finest level of the surface.
    positions: Cochain<0, Vector3<f64>>,
}

/// What sampling says of a characteristic map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regularity {
    /// The number of points.
    pub samples: usize,
    /// The least and the largest determinant of the derivatives by `s` and `t`.
    pub determinant: [f64; 2],
    /// By how much of a full turn the rim of the first ring runs round the vertex: 1, or 1/2 at a boundary vertex, if it does
    /// so once.
    pub turn: f64,
    /// What it should be.
    pub expected_turn: f64,
}

impl Regularity {
    /// Whether nothing speaks against injectivity: the determinant is positive at every sample, by more than rounding, and the
    /// rim runs round the vertex once. With a positive determinant everywhere the map would be injective.
    pub fn holds(&self) -> bool {
        let [least, most] = self.determinant;
        least > 1e-9 * most && (self.turn - self.expected_turn).abs() < 1e-6
    }
}

/// A form at a point of the characteristic map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Where the point is.
    pub position: Vector2<f64>,
    /// Of a 1-form the factors of `dx` and `dy`; of a 0-form its value, of a 2-form the factor of `dx^dy`, both twice.
    pub parts: [f64; 2],
}

impl CharacteristicMap {
    /// The characteristic map of a vertex.
    ///
    /// # Errors
    /// If the eigenvectors are not there.
    pub fn new(ring: Ring) -> Result<Self, AnalysisError> {
        let blocks = ring.blocks(0);
        let of = |symmetry| {
            blocks.iter().find(|b| b.symmetry == symmetry).ok_or(AnalysisError::NoCharacteristicMap)
        };
        let (eigenvalues, control): ([f64; 2], Vec<Vector2<f64>>) = match ring.is_boundary() {
            false => {
                let (value, vector) = dominant(&ring, of(Symmetry::Mode(1))?, 0)?;
                let first = vector[1];
                ([value; 2], vector.iter().map(|&z| z / first).map(|z| Vector2::new(z.re, z.im)).collect())
            }
            true => {
                let (odd, x) = dominant(&ring, of(Symmetry::Odd)?, 0)?;
                let (even, y) = dominant(&ring, of(Symmetry::Even)?, 1)?;
                let near = ring.num_vertices_to(1);
                let largest = |y: &[Complex<f64>]| {
                    y.iter().fold(0.0, |most: f64, z| if z.re.abs() > most.abs() { z.re } else { most })
                };
                // A single triangle has no vertex inside its first ring.
                let scale = match largest(&y[..near]) {
                    small if small.abs() < 1e-9 => largest(&y),
                    scale => scale,
                };
                let at = |(x, y): (&Complex<f64>, &Complex<f64>)| Vector2::new(x.re, y.re / scale);
                // Where a wiggle of the surface outlives the crease, x vanishes on the crease.
                let first = if x[1].norm() > 1e-9 { x[1] } else { Complex::from(largest(&x)) };
                let x: Vec<Complex<f64>> = x.iter().map(|z| z / first).collect();
                ([odd, even], x.iter().zip(&y).map(at).collect())
            }
        };
        if !control.iter().all(|p| p.x.is_finite() && p.y.is_finite()) {
            return Err(AnalysisError::NoCharacteristicMap);
        }
        let cage = Cage::new(ring.descriptor().clone()).map_err(HierarchyError::from)?;
        let surface = LimitSurface::new(&cage, ring.scheme())?;
        // The vertices beyond the rings do not matter to the faces within.
        let mut positions = vec![Vector3::zeros(); ring.descriptor().num_vertices];
        for (position, p) in positions.iter_mut().zip(&control) {
            *position = Vector3::new(p.x, p.y, 0.0);
        }
        let positions = surface.refine(&Cochain::new(positions));
        Ok(CharacteristicMap { ring, eigenvalues, control, surface, positions })
    }

    /// The rings.
    pub fn ring(&self) -> &Ring {
        &self.ring
    }

    /// The eigenvalues of `x` and `y`.
    pub fn eigenvalues(&self) -> [f64; 2] {
        self.eigenvalues
    }

    /// The control points, on the vertices of the rings.
    pub fn control(&self) -> &[Vector2<f64>] {
        &self.control
    }

    /// The faces on which the map is defined, from the middle.
    pub fn faces(&self) -> std::ops::Range<u32> {
        let inside = |&f: &usize| self.ring.ring_of_face(f) < self.ring.rings();
        0..(0..self.ring.num_cells(2)).filter(inside).count() as u32
    }

    /// The map at points, with its derivatives by `s` and `t`. The third coordinate is 0.
    ///
    /// # Errors
    /// If a point is not on the cage.
    pub fn evaluate(&self, points: &[SurfacePoint]) -> Result<Vec<Jet<Vector3<f64>>>, PointError> {
        self.surface.evaluate_0(&self.positions, points)
    }

    /// The basis form of a cell of the rings, in its direction there, at points.
    ///
    /// # Errors
    /// If a point is not on the cage.
    ///
    /// # Panics
    /// If `degree > 2` or the rings have no such cell.
    pub fn basis(
        &self,
        degree: usize,
        cell: usize,
        points: &[SurfacePoint],
    ) -> Result<Vec<Sample>, PointError> {
        let mesh = self.surface.hierarchy().level(0).mesh();
        assert!(cell < self.ring.num_cells(degree), "the rings have no such cell");
        let unit = |number: usize, value: f64| {
            let mut values = vec![0.0; mesh.num_cells(degree)];
            values[number] = value;
            values
        };
        let flat = |p: Vector3<f64>| Vector2::new(p.x, p.y);
        Ok(match degree {
            0 => {
                let form = self.surface.refine(&Cochain::<0>::new(unit(cell, 1.0)));
                let values = self.surface.evaluate_0(&form, points)?;
                let at = |(p, v): (Jet<Vector3<f64>>, Jet<f64>)| Sample {
                    position: flat(p.value),
                    parts: [v.value; 2],
                };
                self.evaluate(points)?.into_iter().zip(values).map(at).collect()
            }
            1 => {
                let [a, b] = self.ring.edges()[cell];
                let h = mesh.find_half_edge(a, b).expect("the rings are part of the cage");
                let form = self.surface.refine(&Cochain::<1>::new(unit(h.edge() as usize, h.sign())));
                let vectors = self.surface.evaluate_vectors(&self.positions, &form, points)?;
                let at = |v: &crate::limit::SurfaceVector| Sample {
                    position: flat(v.position.value),
                    parts: [v.vector.x, v.vector.y],
                };
                vectors.iter().map(at).collect()
            }
            _ => {
                let form = self.surface.refine(&Cochain::<2>::new(unit(cell, 1.0)));
                let densities = self.surface.evaluate_2(&form, points)?;
                let at = |(p, density): (Jet<Vector3<f64>>, f64)| Sample {
                    position: flat(p.value),
                    parts: [density / determinant(&p); 2],
                };
                self.evaluate(points)?.into_iter().zip(densities).map(at).collect()
            }
        })
    }

    /// Samples the determinant of the map's derivatives on the faces at the vertex, `(per_side + 1)^2` points to a square, but
    /// for the quarter of each that the others repeat, half as large and so on.
    ///
    /// # Panics
    /// If `per_side` is 0.
    pub fn regularity(&self, per_side: usize) -> Regularity {
        assert!(per_side > 0, "no points");
        let quad = self.ring.split_kind() == SplitKind::Quad;
        let (k, n) = (self.ring.faces() as u32, per_side);
        let at = |face: u32, s: usize, t: usize| {
            let [s, t] = [s, t].map(|x| x as f64 / n as f64);
            SurfacePoint { face, corner: 0, s, t }
        };
        let is_new = |s: usize, t: usize| match quad {
            true => 2 * s.max(t) >= n,
            false => s + t <= n && 2 * (s + t) >= n,
        };
        let (mut samples, mut range) = (0, [f64::INFINITY, f64::NEG_INFINITY]);
        let (mut turn, mut last): (f64, Option<f64>) = (0.0, None);
        for face in 0..k {
            let grid = (0..=n).flat_map(|s| (0..=n).map(move |t| (s, t))).filter(|&(s, t)| is_new(s, t));
            let points: Vec<_> = grid.map(|(s, t)| at(face, s, t)).collect();
            let jets = self.evaluate(&points).expect("the points are on the faces");
            samples += jets.len();
            for det in jets.iter().map(determinant) {
                range = [range[0].min(det), range[1].max(det)];
            }
            let rim: Vec<_> = match quad {
                true => (0..=n).map(|t| at(face, n, t)).chain((0..n).rev().map(|s| at(face, s, n))).collect(),
                false => (0..=n).map(|t| at(face, n - t, t)).collect(),
            };
            for jet in self.evaluate(&rim).expect("the points are on the faces") {
                let angle = jet.value.y.atan2(jet.value.x);
                if let Some(last) = last {
                    let step = (angle - last) / TAU;
                    turn += step - step.round();
                }
                last = Some(angle);
            }
        }
        let expected_turn = if self.ring.is_boundary() { 0.5 } else { 1.0 };
        Regularity { samples, determinant: range, turn, expected_turn }
    }
}

/// The determinant of the derivatives of a map of the plane.
fn determinant(jet: &Jet<Vector3<f64>>) -> f64 {
    let [a, b] = jet.derivatives;
    a.x * b.y - a.y * b.x
}

/// The largest eigenvalue of a block but for the first so many, and an eigenvector on all vertices.
fn dominant(ring: &Ring, block: &Block, skip: usize) -> Result<(f64, Vec<Complex<f64>>), AnalysisError> {
    let mut values = eigenvalues(block)?;
    values.sort_by(|a, b| b.value.norm().total_cmp(&a.value.norm()));
    let found = values.get(skip).filter(|e| e.multiplicity == block.copies);
    let value = found.ok_or(AnalysisError::NoCharacteristicMap)?.value;
    let vector = eigenvector(&block.matrix, value).ok_or(AnalysisError::NoCharacteristicMap)?;
    // Real where the block is: only the phase of the whole is free.
    let largest =
        vector.iter().fold(Complex::from(0.0), |most, &z| if z.norm() > most.norm() { z } else { most });
    let vector: Vec<_> = match block.symmetry {
        Symmetry::Mode(_) => vector,
        _ => vector.iter().map(|z| z / largest).collect(),
    };
    Ok((value.re, block.extend(ring.lattice(), ring.places(0), &vector)))
}
