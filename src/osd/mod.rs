//! OpenSubdiv: the authority on topology, numbering, edge directions and 0-form weights.
//!
//! A [`Refiner`] owns OpenSubdiv's topology refiner and answers in flat arrays. It is asked for each
//! level's incidence (as a [`Mesh`]), tags and S0 masks while a hierarchy is built, and for its own
//! stencils and limits when results are checked against it.

#[allow(unsafe_code)]
mod bridge;

use bridge::ffi;
use cxx::UniquePtr;

use crate::sparse::{Csr, assemble};
use crate::topology::{BoundaryInterpolation, Cage, CreasingMethod, Mesh, TriangleSubdivision};

/// The most levels that OpenSubdiv refines.
pub const MAX_LEVELS: usize = 15;

/// What OpenSubdiv, or the C++ side of the bridge, objected to.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("OpenSubdiv: {0}; please report this mesh, it passed every check that is known to be needed")]
pub struct OsdError(String);

impl From<cxx::Exception> for OsdError {
    fn from(exception: cxx::Exception) -> Self {
        OsdError(exception.what().to_owned())
    }
}

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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    fn from_number(number: u8) -> Self {
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
    /// and their descendants these are, with [`BoundaryInterpolation::None`], the faces that touch the
    /// boundary of the cage.
    pub face_hole: Vec<bool>,
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

/// OpenSubdiv's topology refiner.
pub struct Refiner(UniquePtr<ffi::Refiner>);

impl Refiner {
    /// A refiner with level 0 only.
    ///
    /// # Errors
    /// If OpenSubdiv refuses the cage, or Loop's scheme is asked for a face that is not a triangle.
    pub fn new(cage: &Cage, scheme: OsdScheme) -> Result<Self, OsdError> {
        let d = cage.descriptor();
        // OpenSubdiv checks the sum of the sizes only, and crashes on what that lets through.
        if scheme == OsdScheme::Loop && d.face_sizes.iter().any(|&size| size != 3) {
            return Err(OsdError("SCHEME_LOOP was asked for a face that is not a triangle".into()));
        }
        let crease_vertices: Vec<u32> = d.creases.iter().flat_map(|c| c.vertices).collect();
        let crease_sharpness: Vec<f32> = d.creases.iter().map(|c| c.sharpness).collect();
        let corner_vertices: Vec<u32> = d.corners.iter().map(|c| c.vertex).collect();
        let corner_sharpness: Vec<f32> = d.corners.iter().map(|c| c.sharpness).collect();
        let arrays = ffi::CageArrays {
            num_vertices: d.num_vertices as u32,
            face_sizes: &d.face_sizes,
            face_vertices: &d.face_vertices,
            crease_vertices: &crease_vertices,
            crease_sharpness: &crease_sharpness,
            corner_vertices: &corner_vertices,
            corner_sharpness: &corner_sharpness,
            holes: &d.holes,
            boundary: match d.boundary {
                BoundaryInterpolation::None => 0,
                BoundaryInterpolation::EdgeOnly => 1,
                BoundaryInterpolation::EdgeAndCorner => 2,
            },
            creasing: u8::from(d.creasing == CreasingMethod::Chaikin),
            triangles: u8::from(d.triangles == TriangleSubdivision::Smooth),
            left_handed: d.left_handed,
            scheme: scheme as u8,
        };
        Ok(Refiner(ffi::new_refiner(&arrays)?))
    }

    /// Adds levels 1 to `levels`, every cell refined. Can be done once.
    ///
    /// # Errors
    /// If `levels` is 0 or above [`MAX_LEVELS`], on a second call, or out of memory.
    pub fn refine_uniform(&mut self, levels: usize) -> Result<(), OsdError> {
        Ok(self.0.pin_mut().refine_uniform(levels.min(MAX_LEVELS + 1) as u32)?)
    }

    /// The incidence of a level.
    ///
    /// # Errors
    /// If there is no such level.
    pub fn mesh(&self, level: usize) -> Result<Mesh, OsdError> {
        let n = self.0.counts(level as u32)?;
        let mut face_sizes = vec![0; n.faces];
        let mut face_vertices = vec![0; n.corners];
        let mut face_edges = vec![0; n.corners];
        let mut edge_vertices = vec![0; 2 * n.edges];
        self.0.topology(
            level as u32,
            ffi::TopologyArrays {
                face_sizes: &mut face_sizes,
                face_vertices: &mut face_vertices,
                face_edges: &mut face_edges,
                edge_vertices: &mut edge_vertices,
            },
        )?;
        let edges = edge_vertices.chunks_exact(2).map(|ends| [ends[0], ends[1]]).collect();
        Mesh::from_arrays(n.vertices, &face_sizes, face_vertices, &face_edges, edges)
            .map_err(|error| OsdError(error.to_string()))
    }

    /// Sharpness, rules and holes of a level.
    ///
    /// # Errors
    /// If there is no such level.
    pub fn tags(&self, level: usize) -> Result<Tags, OsdError> {
        let n = self.0.counts(level as u32)?;
        let mut edge_sharpness = vec![0.0; n.edges];
        let mut vertex_sharpness = vec![0.0; n.vertices];
        let mut vertex_rule = vec![0; n.vertices];
        let mut face_hole = vec![0; n.faces];
        self.0.tags(
            level as u32,
            ffi::TagArrays {
                edge_sharpness: &mut edge_sharpness,
                vertex_sharpness: &mut vertex_sharpness,
                vertex_rule: &mut vertex_rule,
                face_hole: &mut face_hole,
            },
        )?;
        Ok(Tags {
            edge_sharpness,
            vertex_sharpness,
            vertex_rule: rules(&vertex_rule),
            face_hole: flags(&face_hole),
        })
    }

    /// The weights of S0 from `level` to `level + 1`.
    ///
    /// # Errors
    /// If there is no level `level + 1`.
    pub fn masks(&self, level: usize) -> Result<Masks, OsdError> {
        let n = self.0.counts(level as u32)?;
        let mut masks = Masks {
            vertex_self: vec![0.0; n.vertices],
            vertex_edge: vec![0.0; 2 * n.edges],
            vertex_face: vec![0.0; n.corners],
            edge_end: vec![0.0; 2 * n.edges],
            edge_face: vec![0.0; n.corners],
            parent_rule: Vec::new(),
            child_rule: Vec::new(),
            parent_weight: vec![0.0; n.vertices],
            parent_sharp: self.tags(level)?.edge_sharpness.iter().map(|&s| s > 0.0).collect(),
            child_sharp: Vec::new(),
        };
        let mut parent_rule = vec![0; n.vertices];
        let mut child_rule = vec![0; n.vertices];
        let mut child_sharp = vec![0; 2 * n.edges];
        self.0.masks(
            level as u32,
            ffi::MaskArrays {
                vertex_self: &mut masks.vertex_self,
                vertex_edge: &mut masks.vertex_edge,
                vertex_face: &mut masks.vertex_face,
                edge_end: &mut masks.edge_end,
                edge_face: &mut masks.edge_face,
                parent_rule: &mut parent_rule,
                child_rule: &mut child_rule,
                parent_weight: &mut masks.parent_weight,
                child_sharp: &mut child_sharp,
            },
        )?;
        masks.parent_rule = rules(&parent_rule);
        masks.child_rule = rules(&child_rule);
        masks.child_sharp = flags(&child_sharp);
        Ok(masks)
    }

    /// The children of the cells of `level`.
    ///
    /// # Errors
    /// If there is no level `level + 1`.
    pub fn children(&self, level: usize) -> Result<Children, OsdError> {
        let n = self.0.counts(level as u32)?;
        let child = self.0.counts(level as u32 + 1)?;
        let mut children = Children {
            vertex_vertex: vec![0; n.vertices],
            edge_vertex: vec![0; n.edges],
            face_vertex: vec![0; child.vertices - n.vertices - n.edges],
            edge_edges: vec![0; 2 * n.edges],
            face_edges: vec![0; n.corners],
            face_faces: vec![0; child.faces],
        };
        self.0.children(
            level as u32,
            ffi::ChildArrays {
                vertex_vertex: &mut children.vertex_vertex,
                edge_vertex: &mut children.edge_vertex,
                face_vertex: &mut children.face_vertex,
                edge_edges: &mut children.edge_edges,
                face_edges: &mut children.face_edges,
                face_faces: &mut children.face_faces,
            },
        )?;
        Ok(children)
    }

    /// OpenSubdiv's own S0 from `level - 1` to `level`, `(|V'|, |V|)`: the rows of its double-precision
    /// stencil table, a computation apart from [`Refiner::masks`].
    ///
    /// # Errors
    /// If `level` is 0 or there is no such level.
    pub fn stencils(&self, level: usize) -> Result<Csr, OsdError> {
        let columns = self.0.counts(level.saturating_sub(1) as u32)?.vertices;
        Ok(matrix(&self.0.stencils(level as u32)?, columns))
    }

    /// OpenSubdiv's limit masks on the finest level.
    ///
    /// # Errors
    /// If the C++ side fails.
    pub fn limit_stencils(&self) -> Result<LimitStencils, OsdError> {
        let mut level = 0;
        while self.0.counts(level + 1).is_ok() {
            level += 1;
        }
        let columns = self.0.counts(level)?.vertices;
        let stencils = |which| Ok::<_, OsdError>(matrix(&self.0.limit_stencils(which)?, columns));
        Ok(LimitStencils { position: stencils(0)?, tangent1: stencils(1)?, tangent2: stencils(2)? })
    }

    /// Refines one value a vertex from `level - 1` to `level` by OpenSubdiv's own primvar refiner.
    ///
    /// # Errors
    /// If `level` is 0 or there is no such level, or `values` has not one entry for each vertex.
    pub fn interpolate(&self, level: usize, values: &[f64]) -> Result<Vec<f64>, OsdError> {
        let mut refined = vec![0.0; self.0.counts(level as u32)?.vertices];
        self.0.interpolate(level as u32, values, &mut refined)?;
        Ok(refined)
    }

    /// OpenSubdiv's factorised single-precision table from level 0 to the finest level.
    ///
    /// # Errors
    /// If the C++ side fails.
    pub fn float_stencil_table(&self) -> Result<FloatStencilTable, OsdError> {
        Ok(FloatStencilTable(ffi::float_stencil_table(&self.0)?))
    }
}

/// What OpenSubdiv pipelines evaluate today: its stencil table, applied by its `Osd::CpuEvaluator`. The
/// yardstick of the benchmarks.
pub struct FloatStencilTable(UniquePtr<ffi::FloatStencilTable>);

impl FloatStencilTable {
    /// The number of rows.
    pub fn num_stencils(&self) -> usize {
        self.0.num_stencils()
    }

    /// Applies the table to `width` interleaved values a control vertex.
    ///
    /// # Errors
    /// If the lengths do not fit the table.
    pub fn evaluate(&self, values: &[f32], width: usize, out: &mut [f32]) -> Result<(), OsdError> {
        Ok(self.0.evaluate(values, width as u32, out)?)
    }
}

fn rules(numbers: &[u8]) -> Vec<Rule> {
    numbers.iter().map(|&n| Rule::from_number(n)).collect()
}

fn flags(bytes: &[u8]) -> Vec<bool> {
    bytes.iter().map(|&byte| byte != 0).collect()
}

fn matrix(stencils: &ffi::Stencils, columns: usize) -> Csr {
    let mut starts = Vec::with_capacity(stencils.sizes.len());
    let mut next = 0;
    for &size in &stencils.sizes {
        starts.push(next);
        next += size as usize;
    }
    assemble((starts.len(), columns), |i, row| {
        let range = starts[i]..starts[i] + stencils.sizes[i] as usize;
        for (&column, &weight) in stencils.indices[range.clone()].iter().zip(&stencils.weights[range]) {
            row.add(column, weight);
        }
    })
}
