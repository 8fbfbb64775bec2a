//! The bridge to OpenSubdiv: flat arrays in, flat arrays out, every call that can fail a `Result`.
//!
//! The only file of the crate that may hold `unsafe` code, but for the second bridge in [`crate::memory`]. The C++
//! side (`cpp/`) checks every level and every array length itself, so no argument can make it read or write out of
//! bounds; what it cannot check is a malformed cage, and [`crate::topology::Cage`] has refused those, and the pointer that
//! [`super::Refiner::borrow`] is given.

use std::ffi::c_void;

use super::{BorrowError, Refiner};

impl Refiner {
    /// Reads the `OpenSubdiv::Far::TopologyRefiner` of a C++ program, which stays its owner. Asking this refiner
    /// to refine is an error. From the first call on OpenSubdiv's error and warning callbacks are left as the
    /// program has them.
    ///
    /// # Errors
    /// If the pointer is null, or the refiner was refined adaptively or with face vertices first.
    ///
    /// # Safety
    /// The pointer must be null or point to a refiner of OpenSubdiv [`super::version`], which lives, and is not
    /// changed, as long as what is returned.
    pub unsafe fn borrow(refiner: *const c_void) -> Result<Self, BorrowError> {
        if refiner.is_null() {
            return Err(BorrowError::Null);
        }
        // SAFETY: not null; the rest is the caller's promise.
        let borrowed = unsafe { ffi::borrow_refiner(refiner.cast()) }.map_err(super::OsdError::from)?;
        Refiner(borrowed).checked()
    }
}

#[cxx::bridge(namespace = "formwork")]
pub(super) mod ffi {
    /// A control cage; see `topology::Descriptor`.
    struct CageArrays<'a> {
        num_vertices: u32,
        face_sizes: &'a [u32],
        face_vertices: &'a [u32],
        crease_vertices: &'a [u32],
        crease_sharpness: &'a [f32],
        corner_vertices: &'a [u32],
        corner_sharpness: &'a [f32],
        holes: &'a [u32],
        boundary: u8,
        creasing: u8,
        triangles: u8,
        left_handed: bool,
        scheme: u8,
    }

    /// The sizes of one level's arrays.
    #[derive(Clone, Copy)]
    struct Counts {
        vertices: usize,
        edges: usize,
        faces: usize,
        corners: usize,
    }

    /// A refiner as it was made.
    struct Description {
        scheme: u8,
        boundary: u8,
        creasing: bool,
        triangles: bool,
        levels: u32,
        uniform: bool,
        faces_first: bool,
    }

    /// One level's incidence, to be filled in.
    struct TopologyArrays<'a> {
        face_sizes: &'a mut [u32],
        face_vertices: &'a mut [u32],
        face_edges: &'a mut [u32],
        edge_vertices: &'a mut [u32],
    }

    /// The edges and vertices of one level that are sharp or not smooth, and the faces that are holes, ascending.
    struct TagLists {
        edges: Vec<u32>,
        edge_sharpness: Vec<f32>,
        vertices: Vec<u32>,
        vertex_sharpness: Vec<f32>,
        vertex_rule: Vec<u8>,
        holes: Vec<u32>,
    }

    /// The weights of S0 from one level to the next, to be filled in; see `osd::Masks`.
    struct MaskArrays<'a> {
        vertex_self: &'a mut [f64],
        vertex_edge: &'a mut [f64],
        vertex_face: &'a mut [f64],
        edge_end: &'a mut [f64],
        edge_face: &'a mut [f64],
        parent_rule: &'a mut [u8],
        child_rule: &'a mut [u8],
        parent_weight: &'a mut [f64],
        parent_sharp: &'a mut [bool],
        child_sharp: &'a mut [bool],
    }

    /// The children of one level's cells, to be filled in.
    struct ChildArrays<'a> {
        vertex_vertex: &'a mut [u32],
        edge_vertex: &'a mut [u32],
        face_vertex: &'a mut [u32],
        edge_edges: &'a mut [u32],
        face_edges: &'a mut [u32],
        face_faces: &'a mut [u32],
    }

    /// Sparse rows: row `i` has `sizes[i]` entries.
    struct Stencils {
        sizes: Vec<u32>,
        indices: Vec<u32>,
        weights: Vec<f64>,
    }

    unsafe extern "C++" {
        include!("cpp/refiner.h");
        include!("cpp/bfr.h");

        type Refiner;
        type FarRefiner;

        fn opensubdiv_version() -> u32;
        unsafe fn borrow_refiner(refiner: *const FarRefiner) -> Result<UniquePtr<Refiner>>;
        fn new_refiner(cage: &CageArrays) -> Result<UniquePtr<Refiner>>;
        fn description(self: &Refiner) -> Result<Description>;
        fn refine_uniform(self: Pin<&mut Refiner>, levels: u32, full_last_level: bool) -> Result<()>;
        fn counts(self: &Refiner, level: u32) -> Result<Counts>;
        fn topology(self: &Refiner, level: u32, out: TopologyArrays) -> Result<()>;
        fn tags(self: &Refiner, level: u32) -> Result<TagLists>;
        fn masks(self: &Refiner, level: u32, known: &[bool], out: MaskArrays) -> Result<()>;
        fn children(self: &Refiner, level: u32, out: ChildArrays) -> Result<()>;
        fn numbers_children_in_order(self: &Refiner, level: u32, centres: bool) -> Result<bool>;
        fn stencils(self: &Refiner, level: u32) -> Result<Stencils>;
        fn per_level_tables(self: &Refiner) -> Result<usize>;
        fn limit_stencils(self: &Refiner, which: u8) -> Result<Stencils>;
        fn interpolate(self: &Refiner, level: u32, source: &[f64], out: &mut [f64]) -> Result<()>;

        type FloatStencilTable;

        fn float_stencil_table(refiner: &Refiner) -> Result<UniquePtr<FloatStencilTable>>;
        fn float_table_of(
            columns: u32,
            row_ends: &[u64],
            indices: &[u32],
            weights: &[f64],
        ) -> Result<UniquePtr<FloatStencilTable>>;
        fn num_stencils(self: &FloatStencilTable) -> usize;
        fn evaluate(self: &FloatStencilTable, source: &[f32], width: u32, out: &mut [f32]) -> Result<()>;

        /// Refers to its refiner.
        type Bfr<'a>;

        fn new_bfr<'a>(refiner: &'a Refiner, smooth: u8, sharp: u8) -> Result<UniquePtr<Bfr<'a>>>;
        fn evaluate(
            self: &Bfr,
            positions: &[f64],
            faces: &[u32],
            uv: &[f64],
            derivatives: bool,
            out: &mut [f64],
        ) -> Result<()>;
    }
}
