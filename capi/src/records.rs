//! What crosses the C ABI as plain records.

/// A control mesh, as `Far::TopologyDescriptor` has it. Arrays with a count of 0 may be null.
#[repr(C)]
pub struct FormworkCage {
    /// The number of vertices.
    pub num_vertices: u32,
    /// The number of faces.
    pub num_faces: u32,
    /// For each face its number of vertices.
    pub face_sizes: *const u32,
    /// The vertices of all faces, face after face, counter-clockwise: as many as the sizes add up to.
    pub face_vertices: *const u32,
    /// The number of sharp edges.
    pub num_creases: u32,
    /// Two vertices for each sharp edge.
    pub crease_vertices: *const u32,
    /// For each sharp edge its sharpness, 10 for infinitely sharp.
    pub crease_sharpness: *const f32,
    /// The number of sharp vertices.
    pub num_corners: u32,
    /// The sharp vertices.
    pub corner_vertices: *const u32,
    /// For each its sharpness.
    pub corner_sharpness: *const f32,
    /// The number of holes.
    pub num_holes: u32,
    /// The faces that are holes.
    pub holes: *const u32,
    /// `Sdc::Options::VtxBoundaryInterpolation`: 0 none, 1 edges only, 2 edges and corners.
    pub boundary: u32,
    /// `Sdc::Options::CreasingMethod`: 0 uniform, 1 Chaikin.
    pub creasing: u32,
    /// `Sdc::Options::TriangleSubdivision`: 0 as Catmull-Clark, 1 smooth.
    pub triangles: u32,
    /// Other than 0 if the vertices of faces run clockwise.
    pub left_handed: u32,
}

/// The cells of a level.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct FormworkCounts {
    /// Vertices: the values of a 0-form.
    pub vertices: u32,
    /// Edges: the values of a 1-form.
    pub edges: u32,
    /// Faces: the values of a 2-form.
    pub faces: u32,
    /// The sizes of the faces, added up.
    pub corners: u32,
}

/// What a table of stencils holds.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct FormworkStencilCounts {
    /// The number of values that go in.
    pub control_values: u32,
    /// The number of rows, which is the number of values that come out.
    pub stencils: u32,
    /// The number of entries of all rows.
    pub entries: u32,
    /// The number of sets of weights: 1, or 3 with the derivatives `du` and `dv`.
    pub weight_sets: u32,
}
