//! What the refiner says of a level, as plain arrays.

use crate::memory;
use crate::sparse::Csr;

/// OpenSubdiv's subdivision schemes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OsdScheme {
    /// `SCHEME_BILINEAR`: quad split.
    Bilinear = 0,
    /// `SCHEME_CATMARK`: quad split.
    Catmark = 1,
    /// `SCHEME_LOOP`: triangle split; takes triangles only.
    Loop = 2,
}

/// The subdivision rule of a vertex: OpenSubdiv's `Sdc::Crease::Rule`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rule {
    /// No sharp edge.
    Smooth,
    /// One sharp edge ends here.
    Dart,
    /// Two sharp edges pass through.
    Crease,
    /// Sharp itself, or more than two sharp edges, or non-manifold.
    Corner,
}

impl Rule {
    pub(super) fn from_number(number: u8) -> Self {
        [Rule::Smooth, Rule::Dart, Rule::Crease, Rule::Corner][number as usize]
    }

    /// Whether the vertex rule ignores sharp edges: smooth vertices have none, darts are treated alike.
    pub fn is_smooth(self) -> bool {
        matches!(self, Rule::Smooth | Rule::Dart)
    }
}

/// Sharpness, rules and holes of one level.
#[derive(Clone, Debug, PartialEq)]
pub struct Tags {
    /// For each edge; 10 is infinitely sharp, which boundary and non-manifold edges always are.
    pub edge_sharpness: Vec<f32>,
    /// For each vertex.
    pub vertex_sharpness: Vec<f32>,
    /// For each vertex.
    pub vertex_rule: Vec<Rule>,
    /// For each face, whether it is left out of what is drawn or written. Beside the holes of the cage
    /// and their descendants these are, with [`BoundaryInterpolation::None`](crate::topology::BoundaryInterpolation::None), the faces that touch the
    /// boundary of the cage.
    pub face_hole: Vec<bool>,
}

/// [`Tags`] of few cells: those that are not smooth, or holes.
#[derive(Clone, Debug)]
pub(crate) struct TagLists {
    /// Of the level: vertices, edges, faces.
    pub num_cells: [usize; 3],
    pub edges: Vec<(u32, f32)>,
    pub vertices: Vec<(u32, (f32, Rule))>,
    pub holes: Vec<u32>,
}

impl TagLists {
    /// The tags of all cells.
    pub fn tags(&self) -> Tags {
        let [vertices, edges, faces] = self.num_cells;
        let mut tags = Tags {
            edge_sharpness: memory::zeros(edges),
            vertex_sharpness: memory::zeros(vertices),
            vertex_rule: memory::filled(Rule::Smooth, vertices),
            face_hole: memory::zeros(faces),
        };
        self.edges.iter().for_each(|&(e, sharpness)| tags.edge_sharpness[e as usize] = sharpness);
        for &(v, (sharpness, rule)) in &self.vertices {
            (tags.vertex_sharpness[v as usize], tags.vertex_rule[v as usize]) = (sharpness, rule);
        }
        self.holes.iter().for_each(|&f| tags.face_hole[f as usize] = true);
        tags
    }
}

/// The weights of S0 from one level to the next, in `f64`, keyed to corners and half-edges.
///
/// With `p_f` the average of the vertices of face `f` (in Loop's scheme, for `m_e`, the vertex of the
/// triangle opposite to `e`), the children are
///
/// ```text
/// m_e = edge_end[2e] a + edge_end[2e + 1] b + sum_f edge_face[c(f, e)] p_f        e = (a, b)
/// v'  = vertex_self[v] v + sum_w vertex_edge[h(v -> w)] w + sum_f vertex_face[c(f, v)] p_f
/// ```
///
/// where `c(f, e)` is the corner of `f` that edge `e` leaves and `c(f, v)` the corner of `f` at `v`.
/// They are OpenSubdiv's own masks: creases, fractional sharpness and Chaikin's rule are in them.
#[derive(Clone, Debug, PartialEq)]
pub struct Masks {
    /// For each vertex.
    pub vertex_self: Vec<f64>,
    /// For each half-edge, the weight of its head in the child of its tail.
    pub vertex_edge: Vec<f64>,
    /// For each corner.
    pub vertex_face: Vec<f64>,
    /// For each half-edge, the weight of its tail in the midpoint.
    pub edge_end: Vec<f64>,
    /// For each corner.
    pub edge_face: Vec<f64>,
    /// Which rules the weights came from.
    pub rules: Rules,
}

/// The rules behind the masks from one level to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Rules {
    /// For each vertex, its rule on this level.
    pub parent_rule: Vec<Rule>,
    /// For each vertex, the rule of its child.
    pub child_rule: Vec<Rule>,
    /// For each vertex, the weight that OpenSubdiv gave to the rule of the parent where it blended the
    /// two; 1 where it did not.
    pub parent_weight: Vec<f64>,
    /// For each edge, whether it is sharp on this level.
    pub parent_sharp: Vec<bool>,
    /// For each half-edge, whether the child edge at its tail is sharp.
    pub child_sharp: Vec<bool>,
}

/// The children of a level's cells, as OpenSubdiv numbers them: see [`crate::topology::Split`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Children {
    /// For each vertex its child vertex.
    pub vertex_vertex: Vec<u32>,
    /// For each edge its child vertex.
    pub edge_vertex: Vec<u32>,
    /// For each face its child vertex; none in the triangle split.
    pub face_vertex: Vec<u32>,
    /// For each half-edge the half of its edge at its tail.
    pub edge_edges: Vec<u32>,
    /// For each corner the child edge inside the face that belongs to it.
    pub face_edges: Vec<u32>,
    /// For each face its child faces: one for each corner, and in the triangle split the one in the middle.
    pub face_faces: Vec<u32>,
}

impl Rules {
    /// The rules of a level where nothing decays any more: every sharpness is 0 or infinite, so that each
    /// child has the rule of its parent.
    pub fn settled(tags: &Tags) -> Self {
        let sharp: Vec<bool> = tags.edge_sharpness.iter().map(|&s| s > 0.0).collect();
        Rules {
            parent_rule: tags.vertex_rule.clone(),
            child_rule: tags.vertex_rule.clone(),
            parent_weight: vec![1.0; tags.vertex_rule.len()],
            child_sharp: sharp.iter().flat_map(|&sharp| [sharp; 2]).collect(),
            parent_sharp: sharp,
        }
    }
}

/// Limit masks on the finest level, each `(|V|, |V|)`.
///
/// OpenSubdiv's position masks are exact limits except at darts, next to semi-sharp features, at
/// vertices of valence 2 and, on level 0, at vertices of faces that are not quads.
#[derive(Clone, Debug)]
pub struct LimitStencils {
    /// Limit positions.
    pub position: Csr,
    /// First limit tangents, towards the leading edge of each vertex.
    pub tangent1: Csr,
    /// Second limit tangents.
    pub tangent2: Csr,
}
