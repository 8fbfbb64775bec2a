//! The functions of the C ABI: the only module of this crate that may hold `unsafe` code. Each checks its pointers
//! for null, makes slices and references of them, and calls safe code; what it cannot check is that arrays are as
//! long as the counts say and that handles are alive.

mod stencils;

use std::ffi::{c_char, c_void};

use formwork::osd::{self, Refiner};
use formwork::topology::{Corner, Crease, Descriptor};

use crate::error::{self, FormworkStatus, Invalid, guard};
use crate::hierarchy::{FormworkHierarchy, FormworkOptions, opensubdivs};
use crate::records::{FormworkCage, FormworkCounts};

pub use stencils::*;

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

fn null(what: &str) -> Invalid {
    Invalid(format!("the pointer to the {what} is null"))
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
