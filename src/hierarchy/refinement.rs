use std::sync::Arc;

use super::assembly;
use super::kernel::{self, Workspace};
use crate::cochain::{Cochain, Quantity};
use crate::memory;
use crate::scheme::regular::turn;
use crate::scheme::{Homotopy, Regular, whitney};
use crate::sparse::{Csr, Exceptions, Row};
use crate::topology::{HalfEdge, Mesh, Split};

/// One step of refinement: the split and the two tables of the scheme.
#[derive(Clone, Debug)]
pub struct Refinement {
    pub(super) split: Split,
    pub(super) homotopy: Homotopy,
    /// The rows of `S1` that are exceptions, where those of `H1` are.
    pub(super) s1_exceptions: Exceptions,
    /// The level whose faces are the blocks of the kernel of 1-forms, if they are those that the formulas are for: on quads
    /// the level above the parent, on triangles the one above that.
    pub(super) blocks: Option<Arc<Mesh>>,
    /// On quads, for each half-edge that leaves a vertex which is regular in the parent the one that reaches it
    /// straight on, [`NONE`] for the others: half-edges of the level above, if there is one, else of the parent.
    pub(super) continued: Vec<HalfEdge>,
}

/// No half-edge.
pub(super) const NONE: HalfEdge = HalfEdge(u32::MAX);

/// The subdivision operators of one step, from level `K` to its refinement `K'`.
#[derive(Clone, Debug)]
pub struct Operators {
    /// `(|V'|, |V|)`: vertices.
    pub s0: Csr,
    /// `(|E'|, |E|)`: edges, each in its own direction. `d0' S0 = S1 d0`.
    pub s1: Csr,
    /// `(|F'|, |F|)`: faces. `d1' S1 = S2 d1`; the columns sum to 1.
    pub s2: Csr,
}

impl Refinement {
    /// `above` is the level above the parent and `top` the one above that, as far as there are.
    pub(super) fn new(
        parent: &Mesh,
        [above, top]: [Option<&Arc<Mesh>>; 2],
        split: Split,
        homotopy: Homotopy,
    ) -> Self {
        let quads = homotopy.regular == Regular::Catmark;
        let blocks = match homotopy.regular {
            Regular::Catmark => above.filter(|above| above.uniform_face_size() == Some(4)).cloned(),
            Regular::Loop => top.cloned(),
            Regular::Whitney => None,
        };
        let mut continued = Vec::new();
        if quads {
            // Vertices keep their numbers: one of the level above is regular in the parent or not.
            let mesh = blocks.as_deref().unwrap_or(parent);
            continued = memory::filled(NONE, 2 * mesh.num_edges());
            for v in (0..mesh.num_vertices() as u32).filter(|&v| homotopy.h0.position(v as usize).is_none()) {
                let fan = mesh.fans(v).next().expect("a regular vertex has a fan").corners;
                let spokes: [HalfEdge; 4] = std::array::from_fn(|i| mesh.corner_half_edge(fan[i]));
                for (i, h) in spokes.iter().enumerate() {
                    continued[h.index()] = spokes[(i + 2) % 4].twin();
                }
            }
        }
        let s1_exceptions = Exceptions::listed(
            (split.num_children(1), parent.num_edges()),
            homotopy.h1.members().iter().map(|&edge| edge as usize),
            |edge, row| add_s1_row(&split, &homotopy, parent, edge, 1.0, row),
        );
        Refinement { split, homotopy, s1_exceptions, blocks, continued }
    }

    /// The half-edge of the parent that reaches the tail of `h`, a regular vertex of a mesh of quads, straight on.
    #[inline]
    pub(super) fn continued(&self, h: HalfEdge) -> HalfEdge {
        let Some(above) = &self.blocks else { return self.continued[h.index()] };
        let inside = above.num_corners() as u32;
        let leaves_midpoint_or_centre = h.sign() > 0.0;
        match h.edge() {
            // p -> m_i, after m_{i+2} -> p; m_i -> p, after that of the quad across.
            corner if corner < inside => match leaves_midpoint_or_centre {
                true => HalfEdge::new(turn(corner, 2), false),
                false => {
                    let across = above.left_corner(above.corner_half_edge(corner).twin());
                    HalfEdge::new(across.expect("a regular edge has two faces"), true)
                }
            },
            // m -> v, after the other half; v -> m, after the half of the edge that reaches v.
            half => match leaves_midpoint_or_centre {
                true => HalfEdge::new(inside + ((half - inside) ^ 1), false),
                false => HalfEdge::new(inside + self.continued[(half - inside) as usize].twin().0, true),
            },
        }
    }

    /// The numbering of the children.
    pub fn split(&self) -> &Split {
        &self.split
    }

    /// The tables `H0` and `H1`.
    pub fn homotopy(&self) -> &Homotopy {
        &self.homotopy
    }

    /// Whether the row of `S2` of a child face follows the formula: those of `H1` along its boundary do.
    pub(super) fn is_regular_face(&self, parent: &Mesh, child: usize) -> bool {
        let mut regular = true;
        self.split.face_boundary(parent, child, |edge, _| {
            regular &= self.homotopy.h1.position(self.split.edge_of(edge) as usize).is_none();
        });
        regular
    }

    /// `S0 = W0 + H0 d0`, `S1 = W1 + d0' H0 + H1 d1`, `S2 = W2 + d1' H1`.
    pub fn operators(&self, parent: &Mesh) -> Operators {
        let (s0, (s1, s2)) =
            rayon::join(|| self.s0(parent), || rayon::join(|| self.s1(parent), || self.s2(parent)));
        Operators { s0, s1, s2 }
    }

    /// `S0 = W0 + H0 d0`, `(|V'|, |V|)`.
    pub fn s0(&self, parent: &Mesh) -> Csr {
        assembly::s0(self, parent)
    }

    /// `S1 = W1 + d0' H0 + H1 d1`, `(|E'|, |E|)`.
    pub fn s1(&self, parent: &Mesh) -> Csr {
        assembly::s1(self, parent)
    }

    /// `S2 = W2 + d1' H1`, `(|F'|, |F|)`.
    pub fn s2(&self, parent: &Mesh) -> Csr {
        assembly::s2(self, parent)
    }

    /// Adds `scale` times the row of `S0` of a child vertex.
    pub(crate) fn add_s0_row(&self, parent: &Mesh, vertex: usize, scale: f64, row: &mut Row) {
        let child = self.split.vertex_parent(vertex);
        self.homotopy.for_each_h0(parent, &self.split, child, |h, weight| {
            row.add(parent.tail(h), -scale * weight);
            row.add(parent.head(h), scale * weight);
        });
        // Last: at a vertex of high valence the many small terms before it lose less that way.
        whitney::w0(parent, child, |v, weight| row.add(v, scale * weight));
    }

    /// Adds `scale` times the row of `S1` of a child edge.
    pub(crate) fn add_s1_row(&self, parent: &Mesh, edge: usize, scale: f64, row: &mut Row) {
        match self.s1_exceptions.get(edge) {
            Some(stored) => row.add_all(stored, scale),
            None => add_s1_row(&self.split, &self.homotopy, parent, edge, scale, row),
        }
    }

    /// Adds `scale` times the row of `S2` of a child face.
    pub(crate) fn add_s2_row(&self, parent: &Mesh, face: usize, scale: f64, row: &mut Row) {
        let of = self.split.face_parent(parent, face);
        row.add(of, scale * whitney::w2(parent, self.split.kind(), of));
        self.split.face_boundary(parent, face, |edge, sign| {
            self.homotopy.add_h1_row(parent, &self.split, edge, scale * sign, row);
        });
    }

    /// The same operators applied to a cochain without forming them.
    pub(super) fn apply_into<const K: usize, T: Quantity>(
        &self,
        parent: &Mesh,
        x: &Cochain<K, T>,
        out: &mut Vec<T>,
        workspace: &mut Workspace<T>,
    ) {
        assert_eq!(x.len(), parent.num_cells(K), "a cochain of another mesh");
        memory::reuse(out, self.split.num_children(K), T::zero());
        // All passes from within the pool: a caller that is not would be put to sleep and woken for each.
        rayon::scope(|_| match K {
            0 => kernel::form0(self, parent, x.values(), out),
            1 => kernel::form1(self, parent, x.values(), out, workspace),
            2 => kernel::form2(self, parent, x.values(), out),
            _ => unreachable!("a surface has cells of dimension 0, 1 and 2"),
        });
    }
}

/// Adds `scale` times the row of `W1 + d0' H0 + H1 d1` of a child edge.
fn add_s1_row(split: &Split, homotopy: &Homotopy, parent: &Mesh, edge: usize, scale: f64, row: &mut Row) {
    let place = split.edge_parent(edge);
    whitney::w1(parent, split.kind(), place, |h, weight| row.add(h.edge(), scale * weight * h.sign()));
    let [tail, head] = split.edge_ends(parent, place);
    homotopy.add_h0_row(parent, split, head, scale, row);
    homotopy.add_h0_row(parent, split, tail, -scale, row);
    homotopy.for_each_h1(parent, split, place, |f, weight| {
        for h in parent.face_half_edges(f) {
            row.add(h.edge(), scale * weight * h.sign());
        }
    });
}
