//! The functions of the C ABI: the only file of this crate that may hold `unsafe` code. Each checks its pointers
//! for null, makes slices and references of them, and calls safe code; what it cannot check is that arrays are as
//! long as the counts say and that handles are alive.

use std::ffi::{c_char, c_void};

use formwork::cochain::Quantity;
use formwork::memory;
use formwork::osd::{self, Refiner};
use formwork::topology::{Corner, Crease, Descriptor};

use crate::error::{self, FormworkStatus, Invalid, guard};
use crate::hierarchy::{FormworkHierarchy, FormworkOptions, opensubdivs};
use crate::records::{FormworkCage, FormworkCounts, FormworkStencilCounts};
use crate::stencils::FormworkStencils;

/// The version of Formwork, such as `"0.1.0"`.
#[unsafe(no_mangle)]
pub extern "C" fn formwork_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// `OPENSUBDIV_VERSION_NUMBER` of the OpenSubdiv that Formwork was built with.
#[unsafe(no_mangle)]
pub extern "C" fn formwork_opensubdiv_version() -> u32 {
    osd::version()
}

/// The message of the last call on this thread that failed; it is good until the next one fails.
#[unsafe(no_mangle)]
pub extern "C" fn formwork_last_error() -> *const c_char {
    error::last()
}

/// A hierarchy of all levels of a C++ program's `OpenSubdiv::Far::TopologyRefiner`, in its own numbering, by
/// the forms that go with its scheme. The refiner must have been refined uniformly, if at all;
/// it is read, not kept. `opensubdiv_version` is `OPENSUBDIV_VERSION_NUMBER` in the program, and must be that of
/// `formwork_opensubdiv_version`. `options` may be null.
///
/// # Safety
/// `refiner` points to such a refiner, or is null, which is an error; `out` may be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn formwork_hierarchy_from_refiner(
    refiner: *const c_void,
    opensubdiv_version: u32,
    options: *const FormworkOptions,
    out: *mut *mut FormworkHierarchy,
) -> FormworkStatus {
    guard(|| {
        if opensubdiv_version != osd::version() {
            return Err(Invalid(format!(
                "the program was compiled with OpenSubdiv {opensubdiv_version} and formwork with {}: build both with the same",
                osd::version()
            )));
        }
        // SAFETY: the caller's promise; of this version, as just checked.
        let refiner = unsafe { Refiner::borrow(refiner) }?;
        let options = unsafe { options.as_ref() }.copied().unwrap_or_default();
        let hierarchy = FormworkHierarchy::of_refiner(&refiner, options)?;
        unsafe { hand_over(hierarchy, out) }
    })
}

/// A hierarchy of a control mesh, refined `levels` times by a `FORMWORK_SCHEME_...`. `options` may be null.
///
/// # Safety
/// The arrays of `cage` are as long as its counts say; `out` may be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn formwork_hierarchy_from_cage(
    cage: *const FormworkCage,
    scheme: u32,
    options: *const FormworkOptions,
    levels: i32,
    out: *mut *mut FormworkHierarchy,
) -> FormworkStatus {
    guard(|| {
        // SAFETY: the caller's promise, as in all blocks below.
        let cage = unsafe { cage.as_ref() }.ok_or_else(|| null("cage"))?;
        let descriptor = unsafe { descriptor(cage) }?;
        let options = unsafe { options.as_ref() }.copied().unwrap_or_default();
        let hierarchy = FormworkHierarchy::of_cage(descriptor, scheme, options, levels)?;
        unsafe { hand_over(hierarchy, out) }
    })
}

/// Frees a hierarchy; null is fine.
///
/// # Safety
/// `hierarchy` is null or alive, and not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn formwork_hierarchy_free(hierarchy: *mut FormworkHierarchy) {
    unsafe { free(hierarchy) }
}

/// The number of the finest level.
///
/// # Safety
/// `hierarchy` is alive; `out` may be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn formwork_hierarchy_finest_level(
    hierarchy: *const FormworkHierarchy,
    out: *mut i32,
) -> FormworkStatus {
    guard(|| {
        let hierarchy = unsafe { hierarchy.as_ref() }.ok_or_else(|| null("hierarchy"))?;
        unsafe { write(out, hierarchy.levels().num_levels() as i32) }
    })
}

/// The counts of the cells of a level.
///
/// # Safety
/// `hierarchy` is alive; `out` may be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn formwork_hierarchy_counts(
    hierarchy: *const FormworkHierarchy,
    level: i32,
    out: *mut FormworkCounts,
) -> FormworkStatus {
    guard(|| {
        let hierarchy = unsafe { hierarchy.as_ref() }.ok_or_else(|| null("hierarchy"))?;
        let mesh = hierarchy.levels().level(hierarchy.level(level)?).mesh();
        let counts = FormworkCounts {
            vertices: mesh.num_vertices() as u32,
            edges: mesh.num_edges() as u32,
            faces: mesh.num_faces() as u32,
            corners: mesh.num_corners() as u32,
        };
        unsafe { write(out, counts) }
    })
}

/// The topology of a level; arrays that are null are left out. `edge_vertices` takes two vertices for each edge, in
/// its direction; `face_sizes` one number for each face; `face_vertices` and `face_edges` one for each corner, face
/// after face, edge `i` joining vertices `i` and `i + 1`; `face_edge_signs` +1 for each edge that runs with its
/// face and -1 for each that runs against it.
///
/// # Safety
/// `hierarchy` is alive; the arrays are as long as `formwork_hierarchy_counts` says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn formwork_hierarchy_topology(
    hierarchy: *const FormworkHierarchy,
    level: i32,
    edge_vertices: *mut u32,
    face_sizes: *mut u32,
    face_vertices: *mut u32,
    face_edges: *mut u32,
    face_edge_signs: *mut i8,
) -> FormworkStatus {
    guard(|| {
        let hierarchy = unsafe { hierarchy.as_ref() }.ok_or_else(|| null("hierarchy"))?;
        let mesh = hierarchy.levels().level(hierarchy.level(level)?).mesh();
        let half_edges = || (0..mesh.num_corners() as u32).map(|c| mesh.corner_half_edge(c));
        unsafe {
            fill(edge_vertices, mesh.edges().as_flattened().iter().copied());
            fill(face_sizes, (0..mesh.num_faces() as u32).map(|f| mesh.face_size(f) as u32));
            fill(face_vertices, mesh.corner_vertices().iter().copied());
            fill(face_edges, half_edges().map(|h| h.edge()));
            fill(face_edge_signs, half_edges().map(|h| h.sign() as i8));
        }
        Ok(())
    })
}

/// The stencils that refine forms of a degree (0, 1 or 2) from `from_level` to `to_level`. With `intermediate` other
/// than 0 also the rows of the levels between, coarser levels first.
///
/// # Safety
/// `hierarchy` is alive; `out` may be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn formwork_stencils_refine(
    hierarchy: *const FormworkHierarchy,
    degree: i32,
    from_level: i32,
    to_level: i32,
    intermediate: u32,
    out: *mut *mut FormworkStencils,
) -> FormworkStatus {
    guard(|| {
        let hierarchy = unsafe { hierarchy.as_ref() }.ok_or_else(|| null("hierarchy"))?;
        let levels = [from_level, to_level];
        let stencils = FormworkStencils::refining(hierarchy, degree, levels, intermediate != 0)?;
        unsafe { hand_over(stencils, out) }
    })
}

/// The stencils that take forms on `from_level` to their limit on `level`: values at its vertices (degree 0),
/// circulations along the limits of its edges (1), integrals over the limits of its faces (2).
///
/// # Safety
/// `hierarchy` is alive; `out` may be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn formwork_stencils_limit(
    hierarchy: *const FormworkHierarchy,
    degree: i32,
    from_level: i32,
    level: i32,
    out: *mut *mut FormworkStencils,
) -> FormworkStatus {
    guard(|| {
        let hierarchy = unsafe { hierarchy.as_ref() }.ok_or_else(|| null("hierarchy"))?;
        let stencils = FormworkStencils::limits(hierarchy, degree, [from_level, level])?;
        unsafe { hand_over(stencils, out) }
    })
}

/// The stencils of limit points, at the vertices (`FORMWORK_AT_VERTICES`) or the corners (`FORMWORK_AT_CORNERS`) of
/// `level`, of forms on `from_level`. Degree 0: one row a point, with three sets of weights, for the value and its
/// derivatives along two limit tangents. Degree 1: two rows a point, the values of the form along the same two
/// tangents. Both derivatives are 0 where the surface has no tangents: at isolated vertices, and at sharp vertices
/// without sharp edges. A vertex on a crease has tangents on each side; its corners tell them apart, and
/// `FORMWORK_AT_VERTICES` takes those of one.
///
/// # Safety
/// `hierarchy` is alive; `out` may be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn formwork_stencils_points(
    hierarchy: *const FormworkHierarchy,
    degree: i32,
    from_level: i32,
    level: i32,
    place: u32,
    out: *mut *mut FormworkStencils,
) -> FormworkStatus {
    guard(|| {
        let hierarchy = unsafe { hierarchy.as_ref() }.ok_or_else(|| null("hierarchy"))?;
        let stencils = FormworkStencils::points(hierarchy, degree, [from_level, level], place)?;
        unsafe { hand_over(stencils, out) }
    })
}

/// Frees stencils; null is fine.
///
/// # Safety
/// `stencils` is null or alive, and not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn formwork_stencils_free(stencils: *mut FormworkStencils) {
    unsafe { free(stencils) }
}

/// The counts of stencils.
///
/// # Safety
/// `stencils` is alive; `out` may be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn formwork_stencils_counts(
    stencils: *const FormworkStencils,
    out: *mut FormworkStencilCounts,
) -> FormworkStatus {
    guard(|| {
        let stencils = unsafe { stencils.as_ref() }.ok_or_else(|| null("stencils"))?;
        let counts = FormworkStencilCounts {
            control_values: stencils.num_control_values() as u32,
            stencils: stencils.num_rows() as u32,
            entries: stencils.num_entries(0..stencils.num_rows()) as u32,
            weight_sets: stencils.num_sets() as u32,
        };
        unsafe { write(out, counts) }
    })
}

/// The number of entries of `count` rows from `first` on.
///
/// # Safety
/// `stencils` is alive; `out` may be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn formwork_stencils_entries(
    stencils: *const FormworkStencils,
    first: u32,
    count: u32,
    out: *mut u32,
) -> FormworkStatus {
    guard(|| {
        let stencils = unsafe { stencils.as_ref() }.ok_or_else(|| null("stencils"))?;
        let entries = stencils.num_entries(stencils.run(first, count)?);
        unsafe { write(out, entries as u32) }
    })
}

/// `count` rows from `first` on, with one set of weights (0 the values, 1 and 2 the derivatives if there are any) in single
/// precision. `sizes` takes the number of entries of each row; `indices` and `weights`, row after row, the control value and
/// the weight of each entry, in no order.
///
/// # Safety
/// `stencils` is alive; `sizes` is as long as `count` says, `indices` and `weights` as `formwork_stencils_entries` says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn formwork_stencils_rows_f32(
    stencils: *const FormworkStencils,
    set: u32,
    first: u32,
    count: u32,
    sizes: *mut u32,
    indices: *mut u32,
    weights: *mut f32,
) -> FormworkStatus {
    guard(|| unsafe { rows(stencils, set, [first, count], sizes, indices, weights) })
}

/// `formwork_stencils_rows_f32` in double precision.
///
/// # Safety
/// As there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn formwork_stencils_rows_f64(
    stencils: *const FormworkStencils,
    set: u32,
    first: u32,
    count: u32,
    sizes: *mut u32,
    indices: *mut u32,
    weights: *mut f64,
) -> FormworkStatus {
    guard(|| unsafe { rows(stencils, set, [first, count], sizes, indices, weights) })
}

/// Advice before large fresh memory is touched: it is to lie on huge pages, where the system has them, which costs far fewer
/// page faults. Nothing is read or written, and anything may be refused; any range will do.
#[unsafe(no_mangle)]
pub extern "C" fn formwork_prefer_huge_pages(start: *const c_void, bytes: usize) {
    memory::prefer_huge_pages(start as usize, bytes);
}

fn null(what: &str) -> Invalid {
    Invalid(format!("the pointer to the {what} is null"))
}

unsafe fn rows<W: Quantity>(
    stencils: *const FormworkStencils,
    set: u32,
    [first, count]: [u32; 2],
    sizes: *mut u32,
    indices: *mut u32,
    weights: *mut W,
) -> Result<(), Invalid> {
    let stencils = unsafe { stencils.as_ref() }.ok_or_else(|| null("stencils"))?;
    let (set, run) = (stencils.set(set)?, stencils.run(first, count)?);
    let entries = stencils.num_entries(run.clone());
    unsafe {
        let sizes = array_mut("sizes", sizes, run.len())?;
        let indices = array_mut("indices", indices, entries)?;
        let weights = array_mut("weights", weights, entries)?;
        stencils.write(set, run, sizes, indices, weights);
    }
    Ok(())
}

unsafe fn write<T>(out: *mut T, value: T) -> Result<(), Invalid> {
    *unsafe { out.as_mut() }.ok_or_else(|| null("result"))? = value;
    Ok(())
}

unsafe fn hand_over<T>(value: T, out: *mut *mut T) -> Result<(), Invalid> {
    if out.is_null() {
        return Err(null("result"));
    }
    unsafe { out.write(Box::into_raw(Box::new(value))) };
    Ok(())
}

unsafe fn free<T>(handle: *mut T) {
    if !handle.is_null() {
        drop(unsafe { Box::from_raw(handle) });
    }
}

unsafe fn fill<T>(out: *mut T, values: impl Iterator<Item = T>) {
    if !out.is_null() {
        values.enumerate().for_each(|(i, value)| unsafe { out.add(i).write(value) });
    }
}

unsafe fn array<'a, T>(what: &str, start: *const T, count: usize) -> Result<&'a [T], Invalid> {
    match (start.is_null(), count) {
        (_, 0) => Ok(&[]),
        (true, _) => Err(null(what)),
        (false, _) => Ok(unsafe { std::slice::from_raw_parts(start, count) }),
    }
}

unsafe fn array_mut<'a, T>(what: &str, start: *mut T, count: usize) -> Result<&'a mut [T], Invalid> {
    match (start.is_null(), count) {
        (_, 0) => Ok(&mut []),
        (true, _) => Err(null(what)),
        (false, _) => Ok(unsafe { std::slice::from_raw_parts_mut(start, count) }),
    }
}

unsafe fn descriptor(cage: &FormworkCage) -> Result<Descriptor, Invalid> {
    let (creases, corners) = (cage.num_creases as usize, cage.num_corners as usize);
    let (boundary, creasing, triangles) = opensubdivs(cage.boundary, cage.creasing, cage.triangles)?;
    unsafe {
        let face_sizes = array("sizes of faces", cage.face_sizes, cage.num_faces as usize)?;
        let num_corners = face_sizes.iter().map(|&size| size as usize).sum();
        let crease_vertices = array("vertices of creases", cage.crease_vertices, 2 * creases)?;
        let crease_sharpness = array("sharpness of creases", cage.crease_sharpness, creases)?;
        let corner_vertices = array("vertices of corners", cage.corner_vertices, corners)?;
        let corner_sharpness = array("sharpness of corners", cage.corner_sharpness, corners)?;
        let creases = crease_vertices.chunks_exact(2).zip(crease_sharpness);
        let corners = corner_vertices.iter().zip(corner_sharpness);
        Ok(Descriptor {
            num_vertices: cage.num_vertices as usize,
            face_sizes: face_sizes.to_vec(),
            face_vertices: array("vertices of faces", cage.face_vertices, num_corners)?.to_vec(),
            creases: creases
                .map(|(ends, &sharpness)| Crease { vertices: [ends[0], ends[1]], sharpness })
                .collect(),
            corners: corners.map(|(&vertex, &sharpness)| Corner { vertex, sharpness }).collect(),
            holes: array("holes", cage.holes, cage.num_holes as usize)?.to_vec(),
            boundary,
            creasing,
            triangles,
            left_handed: cage.left_handed != 0,
        })
    }
}
