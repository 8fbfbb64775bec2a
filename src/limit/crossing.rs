//! `X(v; e)`: what crosses an edge near one of its ends, from there to the limit.
//!
//! With `F` the fan block of `S2` (row `j`: the child at `v` of face `f_j`, over the faces round `v`) and
//! `h_i = H1(v -> m_{e_i})` the row of a spoke, `u_j` the unit rows and `c_i = 1` on smooth spokes, 0 on
//! sharp ones, `X` is the solution of
//!
//! ```text
//! quads:      X(v; e_i) (I - F) = h_i - c_i/12 (F_i - F_{i-1})
//! triangles:  X(v; e_i) (I - F) = h_i - c_i 25/192 (u_i - u_{i-1})
//!                                     + c_i/192 [c_{i+1} (u_i - u_{i+1}) - c_{i-1} (u_{i-1} - u_{i-2})]
//! ```
//!
//! It comes from the fixed point `K1 = R1 (H1 + K1' S2)` along one half of an edge; the midpoint, regular
//! in the child, gives the fixed numbers. `X` vanishes on sharp spokes, unless they end in a dart.
//!
//! Round a smooth vertex `F` is circulant and one row, solved by its Fourier modes, is the whole table.
//! Sectors that are reflected fold the table of twice their faces; other sectors and darts solve a dense
//! system, once for each number of faces.

use std::f64::consts::TAU;
use std::sync::OnceLock;

use nalgebra::DMatrix;

use crate::osd::{Rule, Rules};
use crate::scheme::FaceRows;
use crate::scheme::sector::{Place, for_each_rule};
use crate::sparse::Row;
use crate::topology::{HalfEdge, Mesh, SplitKind};

/// The rows `X` of a settled level, in tables by number of faces.
pub struct Crossing<'a> {
    mesh: &'a Mesh,
    rules: &'a Rules,
    rows: &'a FaceRows,
    smooth: Vec<OnceLock<Vec<f64>>>,
    sectors: Vec<OnceLock<Option<Vec<f64>>>>,
    darts: Vec<OnceLock<Vec<f64>>>,
}

impl<'a> Crossing<'a> {
    /// Prepares the rows of a level.
    pub fn new(mesh: &'a Mesh, rules: &'a Rules, rows: &'a FaceRows) -> Self {
        let fans = (0..mesh.num_vertices() as u32).flat_map(|v| mesh.fans(v));
        let most = fans.map(|fan| fan.corners.len()).max().unwrap_or(0);
        let smooth = (0..=2 * most).map(|_| OnceLock::new()).collect();
        let sectors = (0..=most).map(|_| OnceLock::new()).collect();
        let darts = (0..=most).map(|_| OnceLock::new()).collect();
        Crossing { mesh, rules, rows, smooth, sectors, darts }
    }

    /// Adds `scale` times `X(v; e)`, `h` being `e` seen from its tail `v`.
    pub fn add_row(&self, h: HalfEdge, scale: f64, out: &mut Row) {
        for_each_rule(self.mesh, self.rules, h, |weight, rule, fan, place| {
            let k = fan.corners.len();
            let mut add = |position: usize, x: f64| {
                out.add(self.mesh.corner_face(fan.corners[position]), scale * weight * x);
            };
            match place {
                Place::Smooth { position } if rule == Rule::Dart => {
                    let sharp =
                        |&c: &u32| self.rules.parent_sharp[self.mesh.corner_half_edge(c).edge() as usize];
                    let first = fan.corners.iter().position(sharp).unwrap_or(0);
                    let row = (position + k - first) % k;
                    let table = self.dart(k);
                    (0..k).for_each(|r| add((first + r) % k, table[row * k + r]));
                }
                _ => place.for_each_entry(k, |k| self.smooth(k), |n| self.sector(n), add),
            }
        });
    }

    fn smooth(&self, k: usize) -> &[f64] {
        self.smooth[k].get_or_init(|| {
            let fan = Fan { rows: self.rows, k, cyclic: true, first_is_sharp: false, b: self.rows.smooth(k) };
            solve_circulant(&fan.face_row(0), &fan.source(0))
        })
    }

    fn dart(&self, k: usize) -> &[f64] {
        self.darts[k].get_or_init(|| {
            let b = self.rows.smooth(k);
            Fan { rows: self.rows, k, cyclic: true, first_is_sharp: true, b }.solve()
        })
    }

    fn sector(&self, n: usize) -> Option<&[f64]> {
        let solve = || {
            let b = self.rows.sector(n)?;
            Some(Fan { rows: self.rows, k: n, cyclic: false, first_is_sharp: true, b }.solve())
        };
        self.sectors[n].get_or_init(solve).as_deref()
    }
}

/// One fan: `k` faces, face `i` between spokes `i` and `i + 1`.
struct Fan<'a> {
    rows: &'a FaceRows,
    k: usize,
    cyclic: bool,
    /// Whether spoke 0 is sharp; an open fan ends in sharp spokes.
    first_is_sharp: bool,
    /// `b_0 .. b_{k-1}` of a cyclic fan, the rows `B(q, r)` of an open one.
    b: Vec<f64>,
}

impl Fan<'_> {
    fn is_smooth(&self, spoke: usize) -> bool {
        let first = if self.cyclic { spoke.is_multiple_of(self.k) } else { spoke == 0 };
        !(self.first_is_sharp && first) && (self.cyclic || spoke < self.k)
    }

    /// Adds `weight (u_i - u_{i-1})`, the faces left and right of a spoke inside the fan.
    fn add_across(&self, spoke: usize, weight: f64, row: &mut [f64]) {
        row[spoke % self.k] += weight;
        row[(spoke + self.k - 1) % self.k] -= weight;
    }

    /// `h_i = B(e_i) - c_i tau/2 (u_i - u_{i-1})`.
    fn spoke_row(&self, spoke: usize) -> Vec<f64> {
        let k = self.k;
        let mut row = match self.cyclic {
            true => (0..k).map(|l| self.b[(l + k - spoke % k) % k]).collect(),
            false if spoke < k => self.b[spoke * k..(spoke + 1) * k].to_vec(),
            false => vec![0.0; k],
        };
        if self.is_smooth(spoke) {
            self.add_across(spoke, -0.5 * self.rows.tau(), &mut row);
        }
        row
    }

    /// `F_j = u_j/4 + h_j - h_{j+1}`, and on triangles what the odd child edge adds,
    /// `c_j/32 (u_j - u_{j-1}) + c_{j+1}/32 (u_j - u_{j+1})`.
    fn face_row(&self, j: usize) -> Vec<f64> {
        let (near, far) = (self.spoke_row(j), self.spoke_row(j + 1));
        let mut row: Vec<f64> = std::iter::zip(near, far).map(|(near, far)| near - far).collect();
        row[j] += 0.25;
        if self.rows.kind() == SplitKind::Triangle {
            for (spoke, weight) in [(j, 1.0 / 32.0), (j + 1, -1.0 / 32.0)] {
                if self.is_smooth(spoke) {
                    self.add_across(spoke, weight, &mut row);
                }
            }
        }
        row
    }

    /// The right-hand side for spoke `i`.
    fn source(&self, spoke: usize) -> Vec<f64> {
        let mut row = self.spoke_row(spoke);
        if !self.is_smooth(spoke) {
            return row;
        }
        let k = self.k;
        match self.rows.kind() {
            SplitKind::Quad => {
                let (left, right) = (self.face_row(spoke % k), self.face_row((spoke + k - 1) % k));
                for (x, (left, right)) in row.iter_mut().zip(std::iter::zip(left, right)) {
                    *x -= (left - right) / 12.0;
                }
            }
            SplitKind::Triangle => {
                self.add_across(spoke, -25.0 / 192.0, &mut row);
                let before = if spoke == 0 { k - 1 } else { spoke - 1 };
                for beside in [spoke + 1, before] {
                    if self.is_smooth(beside) {
                        self.add_across(beside, -1.0 / 192.0, &mut row);
                    }
                }
            }
        }
        row
    }

    /// The rows of spokes `0 .. k-1`, one after the other.
    fn solve(&self) -> Vec<f64> {
        let k = self.k;
        let rows = |row: &dyn Fn(usize) -> Vec<f64>| {
            DMatrix::from_row_iterator(k, k, (0..k).flat_map(row).collect::<Vec<_>>())
        };
        let blocks = DMatrix::identity(k, k) - rows(&|j| self.face_row(j));
        let sources = rows(&|i| self.source(i));
        // F has the eigenvalues of S2, of magnitude below 1.
        let x = blocks.transpose().lu().solve(&sources.transpose()).expect("I - F is regular");
        // The transpose of what is wanted, stored column by column.
        x.as_slice().to_vec()
    }
}

/// Solves `x (I - F) = r` for the circulant `F` with first row `f`, by Fourier modes.
fn solve_circulant(f: &[f64], r: &[f64]) -> Vec<f64> {
    let k = f.len();
    let turn: Vec<(f64, f64)> = (0..k).map(|j| (TAU * j as f64 / k as f64).sin_cos()).collect();
    let mode = |x: &[f64], m: usize| {
        x.iter().enumerate().fold((0.0, 0.0), |(re, im), (j, x)| {
            let (sin, cos) = turn[m * j % k];
            (re + x * cos, im - x * sin)
        })
    };
    let modes: Vec<(f64, f64)> = (0..k)
        .map(|m| {
            let ((a, b), (f_re, f_im)) = (mode(r, m), mode(f, m));
            let (c, d) = (1.0 - f_re, -f_im);
            let square = c * c + d * d;
            ((a * c + b * d) / square, (b * c - a * d) / square)
        })
        .collect();
    let value = |j: usize| {
        let terms = modes.iter().enumerate().map(|(m, (re, im))| {
            let (sin, cos) = turn[m * j % k];
            re * cos - im * sin
        });
        terms.sum::<f64>() / k as f64
    };
    (0..k).map(value).collect()
}
