//! Model fans: what a configuration does to its neighbourhood is read off a cage that has nothing else.
//!
//! The tables of limits at darts, and of evaluation next to irregular vertices and features, are not
//! written down: a small cage with the wanted vertex in the middle is refined by the ordinary machinery, and the
//! rows of its operators between two late levels, where all else is regular, are the table.

use std::sync::OnceLock;

use nalgebra::DMatrix;

use super::neighbourhood::{Cells, Configuration, around_corner, around_face, fan_cells, patch_cells};
use crate::hierarchy::{Hierarchy, HierarchyError, Operators};
use crate::osd::{Refiner, Rule, Tags};
use crate::scheme::{Scheme, Variant};
use crate::sparse::{Csr, assemble, row_of};
use crate::topology::{Cage, Corner, Crease, Descriptor, HalfEdge, Mesh, Parent, SplitKind};

/// A cage whose vertex 0 has the given surroundings: `faces` quads or triangles round it.
pub fn cage(kind: SplitKind, c: Configuration) -> Cage {
    let n = c.faces;
    let w = |i: u32| if c.cyclic { 1 + i % n } else { 1 + i };
    let spokes = if c.cyclic { n } else { n + 1 };
    let face = |i: u32| match kind {
        SplitKind::Quad => vec![0, w(i), 1 + spokes + i, w(i + 1)],
        SplitKind::Triangle => vec![0, w(i), w(i + 1)],
    };
    let faces: Vec<Vec<u32>> = (0..n).map(face).collect();
    let infinite = super::INFINITE;
    let descriptor = Descriptor {
        num_vertices: (1 + spokes + if kind == SplitKind::Quad { n } else { 0 }) as usize,
        face_sizes: faces.iter().map(|face| face.len() as u32).collect(),
        face_vertices: faces.concat(),
        creases: match c.rule {
            Rule::Dart => vec![Crease { vertices: [0, 1], sharpness: infinite }],
            _ => Vec::new(),
        },
        corners: match c.rule {
            Rule::Corner => vec![Corner { vertex: 0, sharpness: infinite }],
            _ => Vec::new(),
        },
        ..Default::default()
    };
    Cage::new(descriptor).expect("a fan is a cage")
}

/// A refined cage with one configuration in its middle.
pub struct Model {
    hierarchy: Hierarchy,
    operators: Vec<OnceLock<Operators>>,
}

impl Model {
    /// Refines the model of a configuration, whatever the position in it.
    ///
    /// # Errors
    /// If the model does not fit memory or OpenSubdiv fails.
    pub fn new(
        kind: SplitKind,
        scheme: Scheme,
        configuration: Configuration,
        levels: usize,
    ) -> Result<Self, HierarchyError> {
        let cage = match configuration.pinched {
            true => cage(kind, Configuration::new(Rule::Crease, false, 1, 0)),
            false => cage(kind, configuration),
        };
        let hierarchy = Hierarchy::new(&cage, scheme, levels)?;
        Ok(Model { hierarchy, operators: (0..=levels).map(|_| OnceLock::new()).collect() })
    }

    /// The levels.
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// The operators from `level - 1` to `level`, made once.
    pub fn operators(&self, level: usize) -> &Operators {
        self.operators[level].get_or_init(|| self.hierarchy.operators(level))
    }

    /// The corner on `level` that has the configuration, and the cells that matter to its face.
    ///
    /// # Panics
    /// If the model is that of another configuration.
    pub fn patch(&self, level: usize, configuration: Configuration) -> (u32, Cells) {
        let (mesh, tags) = (self.hierarchy.level(level).mesh(), self.hierarchy.level(level).tags());
        let mut candidates = match configuration.pinched {
            true => {
                let parent = self.hierarchy.level(level - 1).mesh();
                let corner = parent.fans(0).next().expect("a model has faces").corners[0];
                vec![self.hierarchy.refinement(level).split().middle_corner(parent, corner)]
            }
            false => mesh.fans(0).flat_map(|fan| fan.corners).copied().collect(),
        }
        .into_iter();
        let found = candidates.find_map(|corner| {
            let (found, corners) = around_face(mesh, tags, corner);
            (found == configuration).then(|| (corner, patch_cells(mesh, found, &corners)))
        });
        found.expect("the model has its configuration in the middle")
    }
}

/// The edges of the faces round a dart, beginning with the sharp spoke; `None` if there is no such.
pub fn dart_ring(mesh: &Mesh, tags: &Tags, v: u32) -> Option<Vec<HalfEdge>> {
    let fan = mesh.fans(v).next()?;
    let (_, corners) = around_corner(mesh, tags, fan.corners[0]);
    Some(fan_cells(mesh, &corners, true).edges)
}

/// `K0` of a dart with `k` faces, on the edges of [`dart_ring`]. OpenSubdiv's limit mask is that of a smooth
/// vertex, which is not the limit of its own refinement; this is: `K0 = N (I - A)^-1`, `N` the displacement of
/// the vertex, `A` the block of `S1` on the ring.
pub fn dart_row(scheme: Scheme, kind: SplitKind, k: usize) -> Result<Vec<f64>, HierarchyError> {
    let configuration = Configuration::new(Rule::Dart, true, k as u32, 0);
    let levels = LEVELS;
    let model = Model::new(kind, scheme, configuration, levels)?;
    let hierarchy = model.hierarchy();
    let ring = |l: usize| {
        let level = hierarchy.level(l);
        dart_ring(level.mesh(), level.tags(), 0).expect("the model has a dart")
    };
    let (parent, child) = (signed(&ring(levels - 1)), signed(&ring(levels)));
    let a = block(&hierarchy.operators(levels).s1, &parent, &child);
    let (mesh, refinement) = (hierarchy.level(levels - 1).mesh(), hierarchy.refinement(levels));
    let displacement = assemble((1, mesh.num_edges()), |_, row| {
        refinement.homotopy().add_h0_row(mesh, refinement.split(), Parent::Vertex(0), 1.0, row);
    });
    let displacement = block(&displacement, &parent, &[(0, 1.0)]);
    let n = parent.len();
    let row = (DMatrix::identity(n, n) - dense(&a)).transpose().lu().solve(&dense(&displacement).transpose());
    Ok(row.expect("I - A is regular").as_slice().to_vec())
}

/// A small matrix with all its entries.
pub fn dense(matrix: &Csr) -> DMatrix<f64> {
    let mut dense = DMatrix::zeros(matrix.rows(), matrix.cols());
    for i in 0..matrix.rows() {
        let (columns, weights) = row_of(matrix, i);
        columns.iter().zip(weights).for_each(|(&j, &weight)| dense[(i, j as usize)] = weight);
    }
    dense
}

/// Half-edges as edges with signs.
pub fn signed(half_edges: &[HalfEdge]) -> Vec<(u32, f64)> {
    half_edges.iter().map(|h| (h.edge(), h.sign())).collect()
}

/// The rows of `matrix` for the cells `child`, over the cells `parent`, both with signs.
///
/// # Panics
/// If a row reaches beyond `parent`.
pub fn block(matrix: &Csr, parent: &[(u32, f64)], child: &[(u32, f64)]) -> Csr {
    let mut place = vec![u32::MAX; matrix.cols()];
    for (i, &(cell, _)) in parent.iter().enumerate() {
        place[cell as usize] = i as u32;
    }
    assemble((child.len(), parent.len()), |i, row| {
        let (cell, sign) = child[i];
        let (columns, weights) = row_of(matrix, cell as usize);
        for (&column, &weight) in columns.iter().zip(weights) {
            let at = place[column as usize];
            assert!(at != u32::MAX, "a row reaches beyond the neighbourhood");
            row.add(at, sign * weight * parent[at as usize].1);
        }
    })
}

/// The levels of a model. From the last but one on, the vertex is the only irregular one near it, and the
/// boundary of the model is out of reach.
pub const LEVELS: usize = 3;

/// The weight of a neighbour in the mask of a smooth vertex of valence `k`. OpenSubdiv's depends on a cosine
/// in single precision, so it is asked.
pub fn neighbour_weight(scheme: Scheme, k: usize) -> Result<f64, HierarchyError> {
    if let Scheme::Loop(Variant::ModifiedLoop, _) = scheme {
        return Ok((3.0 + 8.0 * crate::scheme::modified_loop::smooth_eps(k)) / (8.0 * k as f64));
    }
    let configuration = Configuration::new(Rule::Smooth, true, k as u32, 0);
    let mut refiner =
        Refiner::new(&cage(SplitKind::Triangle, configuration), scheme.opensubdiv(SplitKind::Triangle))?;
    refiner.refine_uniform(1)?;
    let (mesh, masks) = (refiner.mesh(0)?, refiner.masks(0)?);
    Ok(masks.vertex_edge[mesh.vertex_half_edges(0)[0].index()])
}
