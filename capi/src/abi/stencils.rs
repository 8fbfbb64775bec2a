//! Tables of stencils behind handles.

use std::ffi::c_void;

use formwork::cochain::Quantity;
use formwork::memory;

use super::{array_mut, free, hand_over, null, write};
use crate::error::{FormworkStatus, Invalid, guard};
use crate::hierarchy::FormworkHierarchy;
use crate::records::FormworkStencilCounts;
use crate::stencils::FormworkStencils;

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
/// `stencils` is alive; `sizes` is as long as `count` says, `indices` and `weights` as `formwork_stencils_entries` says, and
/// all hold numbers, whichever.
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
pub extern "C" fn formwork_prefer_huge_pages(start: *const c_void, bytes: u64) {
    memory::prefer_huge_pages(start as usize, bytes as usize);
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
