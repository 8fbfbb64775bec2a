//! `K0` and `K1` in closed form where a level is settled.
//!
//! ```text
//! K0[v]       smooth, quads:      4/(k(k+5)) sum_i c_{v w_i} + 1/(k(k+5)) sum_i (4 P_{f_i,v} - c_{v w_i} - c_{v w_{i+1}})
//!             smooth, triangles:  a/(k a + 3/8 - eps_v) sum_i (1 - eps_{w_i}) c_{v w_i}
//!             crease:             1/6 on the two crease spokes
//!             corner:             0
//!             dart:               the fixed point K0 = N + K0 A on the ring of the vertex, see super::model
//! K1[v -> w]  quads:              X(v; e) - X(w; e)
//!             triangles:          X(v; e) - X(w; e) + 1/4 (D_left - D_right), the last on smooth edges only
//! ```
//!
//! `a` is the weight of a neighbour in the mask of `v`, `P` the lift of [`crate::scheme::whitney`], `X` the
//! rows of [`super::crossing`].

use std::sync::OnceLock;

use super::crossing::Crossing;
use super::model;
use crate::hierarchy::HierarchyError;
use crate::osd::{Rule, Rules, Tags};
use crate::scheme::modified_loop::{eps, smooth_eps};
use crate::scheme::{FaceRows, Scheme, Variant, whitney};
use crate::sparse::Row;
use crate::topology::{HalfEdge, Mesh, SplitKind};

/// The closed forms on one level. They hold at vertices with settled surroundings, see [`Self::is_settled`].
pub struct Settled<'a> {
    mesh: &'a Mesh,
    tags: &'a Tags,
    scheme: Scheme,
    rules: &'a Rules,
    rows: Option<&'a FaceRows>,
    crossing: Option<Crossing<'a>>,
    /// For each valence, Loop's weight of a neighbour, once it is needed.
    loop_weights: Vec<OnceLock<f64>>,
    /// For each valence, the row of a dart on its ring, once it is needed.
    darts: Vec<OnceLock<Vec<f64>>>,
}

impl<'a> Settled<'a> {
    /// Prepares the closed forms of one level: the tables of every valence that it has.
    ///
    /// # Errors
    /// If OpenSubdiv fails on a model fan.
    pub fn new(
        mesh: &'a Mesh,
        tags: &'a Tags,
        rules: &'a Rules,
        scheme: Scheme,
        rows: Option<&'a FaceRows>,
    ) -> Result<Self, HierarchyError> {
        let crossing = rows.map(|rows| Crossing::new(mesh, rules, rows));
        let most = (0..mesh.num_vertices() as u32).map(|v| mesh.vertex_half_edges(v).len()).max();
        let empty = || (0..=most.unwrap_or(0)).map(|_| OnceLock::new());
        let settled = Settled {
            mesh,
            tags,
            scheme,
            rules,
            rows,
            crossing,
            loop_weights: empty().collect(),
            darts: empty().map(|_| OnceLock::new()).collect(),
        };
        settled.tabulate()?;
        Ok(settled)
    }

    /// Asks the models of all valences for their rows, so that no row fails later.
    fn tabulate(&self) -> Result<(), HierarchyError> {
        let Some(rows) = self.rows else { return Ok(()) };
        for v in 0..self.mesh.num_vertices() as u32 {
            let k = self.mesh.vertex_half_edges(v).len();
            match self.tags.vertex_rule[v as usize] {
                Rule::Dart if self.darts[k].get().is_none() => {
                    let _ = self.darts[k].set(model::dart_row(self.scheme, rows.kind(), k)?);
                }
                Rule::Smooth
                    if rows.kind() == SplitKind::Triangle && self.loop_weights[k].get().is_none() =>
                {
                    let _ = self.loop_weights[k].set(model::neighbour_weight(self.scheme, k)?);
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Whether the closed forms hold at a vertex: every sharpness there is 0 or infinite and its faces are
    /// those that the split leaves. Modified Loop looks at the rules of the neighbours too.
    pub fn is_settled(&self, v: u32) -> bool {
        let neighbours = || self.mesh.vertex_half_edges(v).iter().map(|&h| self.mesh.head(h));
        let looks_further = matches!(self.scheme, Scheme::Loop(Variant::ModifiedLoop, _));
        self.rows.is_none() || self.is_calm(v) && (!looks_further || neighbours().all(|w| self.is_calm(w)))
    }

    fn is_calm(&self, v: u32) -> bool {
        let lasts = |sharpness: f32| sharpness <= 0.0 || sharpness >= super::INFINITE;
        let sharpness = |h: &HalfEdge| self.tags.edge_sharpness[h.edge() as usize];
        let mesh = self.mesh;
        let edges = mesh.vertex_half_edges(v);
        let quads = || {
            let mut corners = mesh.fans(v).flat_map(|fan| fan.corners);
            corners.all(|&c| mesh.face_size(mesh.corner_face(c)) == 4)
        };
        lasts(self.tags.vertex_sharpness[v as usize])
            && edges.iter().all(|h| lasts(sharpness(h)))
            && self.rows.is_none_or(|rows| rows.kind() == SplitKind::Triangle || quads())
    }

    /// Adds `K0[v]`.
    pub fn k0(&self, v: u32, row: &mut Row) {
        let Some(rows) = self.rows else { return };
        let spokes = self.mesh.vertex_half_edges(v);
        match (self.tags.vertex_rule[v as usize], rows.kind()) {
            (Rule::Corner, _) => {}
            (Rule::Crease, _) => {
                let sharp = |h: &&HalfEdge| self.tags.edge_sharpness[h.edge() as usize] > 0.0;
                spokes.iter().filter(sharp).for_each(|&h| add(row, h, 1.0 / 6.0));
            }
            (Rule::Dart, _) => self.dart(v, row),
            (Rule::Smooth, SplitKind::Quad) => {
                let k = spokes.len() as f64;
                let unit = 1.0 / (k * (k + 5.0));
                // Each spoke borders two faces.
                spokes.iter().for_each(|&h| add(row, h, 2.0 * unit));
                for &corner in self.mesh.fans(v).flat_map(|fan| fan.corners) {
                    whitney::vertex_to_centre(self.mesh, corner, |h, weight| {
                        add(row, h, 4.0 * unit * weight)
                    });
                }
            }
            (Rule::Smooth, SplitKind::Triangle) => {
                let k = spokes.len();
                let a = *self.loop_weights[k].get().expect("tabulated");
                let here = if self.modified() { smooth_eps(k) } else { 0.0 };
                let omega = a / (k as f64 * a + 0.375 - here);
                spokes.iter().for_each(|&h| add(row, h, omega * (1.0 - self.eps_of_head(h))));
            }
        }
    }

    /// The row of a dart, from spoke to spoke beginning with the sharp one. The neighbours of the model are
    /// regular; those here may pull on the midpoints, which weigh as the spokes' ends do.
    fn dart(&self, v: u32, row: &mut Row) {
        let mesh = self.mesh;
        let table = self.darts[mesh.vertex_half_edges(v).len()].get().expect("tabulated");
        let Some(ring) = model::dart_ring(mesh, self.tags, v) else { return };
        for (&h, &weight) in ring.iter().zip(table) {
            add(row, h, weight);
        }
        if self.modified() {
            for &h in mesh.vertex_half_edges(v) {
                let sharp = self.tags.edge_sharpness[h.edge() as usize] > 0.0;
                let pull = |&h2: &HalfEdge, weight: f64| {
                    let w = mesh.head(h);
                    weight * (f64::from(mesh.head(h2) == w) - f64::from(mesh.tail(h2) == w))
                };
                if !sharp {
                    let end: f64 = ring.iter().zip(table).map(|(h2, &weight)| pull(h2, weight)).sum();
                    add(row, h, -end * self.eps_of_head(h));
                }
            }
        }
    }

    fn modified(&self) -> bool {
        matches!(self.scheme, Scheme::Loop(Variant::ModifiedLoop, _))
    }

    fn eps_of_head(&self, h: HalfEdge) -> f64 {
        if self.modified() { eps(self.mesh, self.rules, h.twin()) } else { 0.0 }
    }

    /// Adds `K1[h]`, from the tail of `h` to its head.
    pub fn k1(&self, h: HalfEdge, row: &mut Row) {
        let (Some(rows), Some(crossing)) = (self.rows, &self.crossing) else { return };
        crossing.add_row(h, 1.0, row);
        crossing.add_row(h.twin(), -1.0, row);
        let smooth = self.tags.edge_sharpness[h.edge() as usize] <= 0.0;
        if rows.kind() == SplitKind::Triangle && smooth {
            for (side, weight) in [(h, 0.25), (h.twin(), -0.25)] {
                if let Some(corner) = self.mesh.left_corner(side) {
                    row.add(self.mesh.corner_face(corner), weight);
                }
            }
        }
    }
}

fn add(row: &mut Row, h: HalfEdge, weight: f64) {
    row.add(h.edge(), weight * h.sign());
}
