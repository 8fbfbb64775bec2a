//! OpenSubdiv: the authority on topology, numbering, edge directions and 0-form weights.
//!
//! A [`Refiner`] owns OpenSubdiv's topology refiner, or reads that of a C++ program, and answers in flat arrays. It is asked for each
//! level's incidence (as a [`Mesh`]), tags and S0 masks while a hierarchy is built, and for its own
//! stencils and limits when results are checked against it.

mod bfr;
mod borrowed;
#[allow(unsafe_code)]
mod bridge;
mod level;

pub use bfr::{BFR_SHARP_LEVEL, BFR_SMOOTH_LEVEL, Bfr};
pub use borrowed::{BorrowError, version};
pub(crate) use level::TagLists;
pub use level::{Children, LimitStencils, Masks, OsdScheme, Rule, Rules, Tags};

use bridge::ffi;
use cxx::UniquePtr;

use crate::memory;
use crate::sparse::{Csr, assemble};
use crate::topology::{BoundaryInterpolation, Cage, CreasingMethod, Mesh, SplitKind, TriangleSubdivision};

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
        Ok(self.0.pin_mut().refine_uniform(levels.min(MAX_LEVELS + 1) as u32, true)?)
    }

    /// [`Refiner::refine_uniform`], but of the finest level only what values are refined by: its [`Refiner::mesh`]
    /// is not known. Half the time and half the memory.
    ///
    /// # Errors
    /// As there.
    pub fn refine_uniform_without_last_edges(&mut self, levels: usize) -> Result<(), OsdError> {
        Ok(self.0.pin_mut().refine_uniform(levels.min(MAX_LEVELS + 1) as u32, false)?)
    }

    /// The incidence of a level.
    ///
    /// # Errors
    /// If there is no such level, or it is the last of
    /// [`Refiner::refine_uniform_without_last_edges`].
    pub fn mesh(&self, level: usize) -> Result<Mesh, OsdError> {
        let Incidence { num_vertices, face_sizes, face_vertices, face_edges, edges } =
            self.incidence(level)?;
        Mesh::from_arrays(num_vertices, &face_sizes, &face_vertices, &face_edges, edges)
            .map_err(|error| OsdError(error.to_string()))
    }

    fn incidence(&self, level: usize) -> Result<Incidence, OsdError> {
        let n = self.0.counts(level as u32)?;
        let mut face_sizes = memory::zeros(n.faces);
        let mut face_vertices = memory::zeros(n.corners);
        let mut face_edges = memory::zeros(n.corners);
        let mut edge_vertices = memory::zeros(2 * n.edges);
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
        Ok(Incidence { num_vertices: n.vertices, face_sizes, face_vertices, face_edges, edges })
    }

    /// Sharpness, rules and holes of a level.
    ///
    /// # Errors
    /// If there is no such level.
    pub fn tags(&self, level: usize) -> Result<Tags, OsdError> {
        Ok(self.tag_lists(level)?.tags())
    }

    /// The same in little memory.
    pub(crate) fn tag_lists(&self, level: usize) -> Result<TagLists, OsdError> {
        let n = self.0.counts(level as u32)?;
        let lists = self.0.tags(level as u32)?;
        let vertices = lists.vertex_sharpness.into_iter().zip(rules(&lists.vertex_rule));
        Ok(TagLists {
            num_cells: [n.vertices, n.edges, n.faces],
            edges: lists.edges.into_iter().zip(lists.edge_sharpness).collect(),
            vertices: lists.vertices.into_iter().zip(vertices).collect(),
            holes: lists.holes,
        })
    }

    /// The weights of S0 from `level` to `level + 1`.
    ///
    /// # Errors
    /// If there is no level `level + 1`.
    pub fn masks(&self, level: usize) -> Result<Masks, OsdError> {
        self.masks_except(level, &[])
    }

    /// [`Refiner::masks`], but those of vertices that are `known`, and of edges between two of them, are left 0 and
    /// smooth: most of a fine level is regular, and whoever knows it need not ask. None is known if it is empty.
    ///
    /// # Errors
    /// If there is no level `level + 1`, or neither none nor all vertices are spoken of.
    pub fn masks_except(&self, level: usize, known: &[bool]) -> Result<Masks, OsdError> {
        let n = self.0.counts(level as u32)?;
        let mut masks = Masks {
            vertex_self: memory::zeros(n.vertices),
            vertex_edge: memory::zeros(2 * n.edges),
            vertex_face: memory::zeros(n.corners),
            edge_end: memory::zeros(2 * n.edges),
            edge_face: memory::zeros(n.corners),
            rules: Rules {
                parent_rule: Vec::new(),
                child_rule: Vec::new(),
                parent_weight: memory::zeros(n.vertices),
                parent_sharp: memory::zeros(n.edges),
                child_sharp: memory::zeros(2 * n.edges),
            },
        };
        let mut parent_rule = memory::zeros(n.vertices);
        let mut child_rule = memory::zeros(n.vertices);
        self.0.masks(
            level as u32,
            known,
            ffi::MaskArrays {
                vertex_self: &mut masks.vertex_self,
                vertex_edge: &mut masks.vertex_edge,
                vertex_face: &mut masks.vertex_face,
                edge_end: &mut masks.edge_end,
                edge_face: &mut masks.edge_face,
                parent_rule: &mut parent_rule,
                child_rule: &mut child_rule,
                parent_weight: &mut masks.rules.parent_weight,
                parent_sharp: &mut masks.rules.parent_sharp,
                child_sharp: &mut masks.rules.child_sharp,
            },
        )?;
        masks.rules.parent_rule = rules(&parent_rule);
        masks.rules.child_rule = rules(&child_rule);
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
            vertex_vertex: memory::zeros(n.vertices),
            edge_vertex: memory::zeros(n.edges),
            face_vertex: memory::zeros(child.vertices - n.vertices - n.edges),
            edge_edges: memory::zeros(2 * n.edges),
            face_edges: memory::zeros(n.corners),
            face_faces: memory::zeros(child.faces),
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

    /// Whether the children of the cells of `level` are numbered by the rule of [`crate::topology::Split`], and
    /// directed by it as far as the refiner knows.
    ///
    /// # Errors
    /// If there is no level `level + 1`.
    pub fn numbers_children_as(&self, level: usize, kind: SplitKind) -> Result<bool, OsdError> {
        Ok(self.0.numbers_children_in_order(level as u32, kind == SplitKind::Quad)?)
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

    /// Builds and drops OpenSubdiv's double-precision stencil tables of S0, each level from the one before, and
    /// returns the number of their entries: what benchmarks measure our tables against.
    ///
    /// # Errors
    /// If the C++ side fails.
    pub fn build_per_level_tables(&self) -> Result<usize, OsdError> {
        Ok(self.0.per_level_tables()?)
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
        let mut refined = memory::zeros(self.0.counts(level as u32)?.vertices);
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

/// The arrays of one level, as [`Mesh::from_arrays`] takes them.
struct Incidence {
    num_vertices: usize,
    face_sizes: Vec<u32>,
    face_vertices: Vec<u32>,
    face_edges: Vec<u32>,
    edges: Vec<[u32; 2]>,
}

/// What OpenSubdiv pipelines evaluate today: its stencil table, applied by its `Osd::CpuEvaluator`. The
/// yardstick of the benchmarks.
pub struct FloatStencilTable(UniquePtr<ffi::FloatStencilTable>);

impl FloatStencilTable {
    /// The rows of a matrix as such a table, weights in single precision.
    ///
    /// # Errors
    /// If the C++ side fails.
    pub fn of(matrix: &Csr) -> Result<Self, OsdError> {
        let row_ends: Vec<u64> =
            matrix.indptr().raw_storage().iter().skip(1).map(|&end| end as u64).collect();
        Ok(FloatStencilTable(ffi::float_table_of(
            matrix.cols() as u32,
            &row_ends,
            matrix.indices(),
            matrix.data(),
        )?))
    }

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
