//! The C ABI called as a C program would: what it writes, and what it leaves alone.

use std::ffi::CStr;
use std::ptr::{null, null_mut};

use formwork::cochain::Cochain;
use formwork::hierarchy::Hierarchy;
use formwork::scheme::{BoundaryRule, DooSabin, Scheme, Variant};
use formwork::topology::{BoundaryInterpolation, Cage, Corner, Crease, CreasingMethod, Descriptor};
use formwork_capi::abi::*;
use formwork_capi::error::FormworkStatus;
use formwork_capi::hierarchy::*;
use formwork_capi::records::{FormworkCage, FormworkCounts, FormworkStencilCounts};

/// A sheet of 2 x 2 quads, or of 8 triangles, clockwise, with every kind of tag.
fn sheet(triangles: bool) -> Descriptor {
    let quads = [[0, 3, 4, 1], [1, 4, 5, 2], [3, 6, 7, 4], [4, 7, 8, 5]];
    let cut = |[a, b, c, d]: [u32; 4]| [vec![a, b, c], vec![a, c, d]];
    let faces: Vec<Vec<u32>> = match triangles {
        true => quads.into_iter().flat_map(cut).collect(),
        false => quads.map(Vec::from).into(),
    };
    Descriptor {
        num_vertices: 9,
        face_sizes: faces.iter().map(|face| face.len() as u32).collect(),
        face_vertices: faces.concat(),
        creases: vec![
            Crease { vertices: [1, 4], sharpness: 1.5 },
            Crease { vertices: [4, 7], sharpness: 0.5 },
            Crease { vertices: [4, 5], sharpness: 10.0 },
        ],
        corners: vec![Corner { vertex: 3, sharpness: 2.5 }],
        holes: vec![1],
        boundary: BoundaryInterpolation::EdgeAndCorner,
        creasing: CreasingMethod::Chaikin,
        left_handed: true,
        ..Default::default()
    }
}

/// Owns what a C program would own, and calls.
struct Caller {
    hierarchy: *mut FormworkHierarchy,
}

impl Caller {
    fn new(d: &Descriptor, scheme: u32, options: FormworkOptions, levels: i32) -> Result<Self, String> {
        let crease_vertices: Vec<u32> = d.creases.iter().flat_map(|c| c.vertices).collect();
        let crease_sharpness: Vec<f32> = d.creases.iter().map(|c| c.sharpness).collect();
        let corner_vertices: Vec<u32> = d.corners.iter().map(|c| c.vertex).collect();
        let corner_sharpness: Vec<f32> = d.corners.iter().map(|c| c.sharpness).collect();
        let cage = FormworkCage {
            num_vertices: d.num_vertices as u32,
            num_faces: d.face_sizes.len() as u32,
            face_sizes: d.face_sizes.as_ptr(),
            face_vertices: d.face_vertices.as_ptr(),
            num_creases: d.creases.len() as u32,
            crease_vertices: crease_vertices.as_ptr(),
            crease_sharpness: crease_sharpness.as_ptr(),
            num_corners: d.corners.len() as u32,
            corner_vertices: corner_vertices.as_ptr(),
            corner_sharpness: corner_sharpness.as_ptr(),
            num_holes: d.holes.len() as u32,
            holes: d.holes.as_ptr(),
            boundary: d.boundary as u32,
            creasing: d.creasing as u32,
            triangles: d.triangles as u32,
            left_handed: d.left_handed.into(),
        };
        let mut hierarchy = null_mut();
        let status = unsafe { formwork_hierarchy_from_cage(&cage, scheme, &options, levels, &mut hierarchy) };
        message(status).map(|()| Caller { hierarchy })
    }

    /// The rows of refining stencils, in double and in single precision.
    fn rows(&self, degree: i32, levels: [i32; 2]) -> Vec<Vec<(i32, f64, f32)>> {
        let mut table = null_mut();
        let mut counts = FormworkStencilCounts::default();
        unsafe {
            let [from, to] = levels;
            message(formwork_stencils_refine(self.hierarchy, degree, from, to, 0, &mut table)).unwrap();
            message(formwork_stencils_counts(table, &mut counts)).unwrap();
            let (stencils, entries) = (counts.stencils as usize, counts.entries as usize);
            assert_eq!(counts.weight_sets, 1);
            let (mut sizes, mut indices) = (guarded(stencils, u32::MAX), guarded(entries, u32::MAX));
            let (mut weights, mut single) = (guarded(entries, f64::MAX), guarded(entries, f32::MAX));
            let all = counts.stencils;
            message(formwork_stencils_rows_f64(
                table,
                0,
                0,
                all,
                sizes.as_mut_ptr(),
                indices.as_mut_ptr(),
                weights.as_mut_ptr(),
            ))
            .unwrap();
            // In single precision in runs of a few rows, one after the other.
            let (mut next, mut start) = (0, 0);
            while next < all {
                let (count, mut run) = ((all - next).min(7), 0);
                message(formwork_stencils_entries(table, next, count, &mut run)).unwrap();
                let (mut some_sizes, mut some_indices) = (guarded(7, 0), guarded(run as usize, u32::MAX));
                let single = single[start..].as_mut_ptr();
                let (sizes_at, indices_at) = (some_sizes.as_mut_ptr(), some_indices.as_mut_ptr());
                message(formwork_stencils_rows_f32(table, 0, next, count, sizes_at, indices_at, single))
                    .unwrap();
                let end = start + run as usize;
                assert_eq!(some_sizes[..count as usize], sizes[next as usize..(next + count) as usize]);
                assert_eq!(some_indices.pop(), Some(u32::MAX), "written past the end");
                assert_eq!(some_indices, indices[start..end]);
                (next, start) = (next + count, end);
            }
            assert_eq!(start, entries);
            let mut none = 0;
            let rows = |set, first, count| {
                let (sizes, indices, weights) = (null_mut(), null_mut(), null_mut());
                message(formwork_stencils_rows_f64(table, set, first, count, sizes, indices, weights))
                    .unwrap_err()
            };
            assert_eq!(rows(1, 0, all), "there is no set of weights 1: these stencils have 1");
            assert_eq!(rows(0, 0, all), "the pointer to the sizes is null");
            let refused = format!("there are no 2 rows from {} on: these stencils have {all}", all - 1);
            assert_eq!(rows(0, all - 1, 2), refused);
            assert_eq!(
                message(formwork_stencils_entries(table, all - 1, 2, &mut none)).unwrap_err(),
                refused
            );
            message(formwork_stencils_entries(table, u32::MAX, 2, &mut none)).unwrap_err();
            message(formwork_stencils_entries(table, all, 0, &mut none)).unwrap();
            assert_eq!(none, 0);
            formwork_stencils_free(table);
            for array in [&mut sizes, &mut indices] {
                assert_eq!(array.pop(), Some(u32::MAX), "written past the end");
            }
            assert_eq!(
                (weights.pop(), single.pop()),
                (Some(f64::MAX), Some(f32::MAX)),
                "written past the end"
            );
            assert!(indices.iter().all(|&i| i < counts.control_values));
            let mut start = 0;
            let row = |&size: &u32| {
                let entries = start..start + size as usize;
                start = entries.end;
                let mut row: Vec<_> = entries.map(|i| (indices[i] as i32, weights[i], single[i])).collect();
                row.sort_by_key(|entry| entry.0);
                row
            };
            sizes.iter().map(row).collect()
        }
    }
}

impl Drop for Caller {
    fn drop(&mut self) {
        unsafe { formwork_hierarchy_free(self.hierarchy) }
    }
}

/// Room for values, and one more that must stay.
fn guarded<T: Copy>(len: usize, guard: T) -> Vec<T> {
    vec![guard; len + 1]
}

fn message(status: FormworkStatus) -> Result<(), String> {
    match status {
        FormworkStatus::Ok => Ok(()),
        _ => Err(unsafe { CStr::from_ptr(formwork_last_error()) }.to_str().unwrap().to_owned()),
    }
}

#[test]
fn every_scheme_and_option_gives_its_operators() {
    use {BoundaryRule as B, DooSabin as D, Variant as V};
    let schemes = [
        (FORMWORK_SCHEME_BILINEAR, 0, 0, Scheme::Bilinear),
        (FORMWORK_SCHEME_CATMARK, FORMWORK_DOO_SABIN_THESIS, 0, Scheme::Catmark(D::Thesis)),
        (FORMWORK_SCHEME_CATMARK, FORMWORK_DOO_SABIN_ORIGINAL, 0, Scheme::Catmark(D::Original)),
        (FORMWORK_SCHEME_LOOP, 0, FORMWORK_HALF_BOX_REFLECT, Scheme::Loop(V::Loop, B::Reflect)),
        (FORMWORK_SCHEME_LOOP, 0, FORMWORK_HALF_BOX_THESIS, Scheme::Loop(V::Loop, B::Thesis)),
        (FORMWORK_SCHEME_LOOP, 0, FORMWORK_HALF_BOX_DCT, Scheme::Loop(V::Loop, B::Dct)),
        (FORMWORK_SCHEME_MODIFIED_LOOP, 0, 0, Scheme::Loop(V::ModifiedLoop, B::Reflect)),
        (FORMWORK_SCHEME_WHITNEY, 0, 0, Scheme::Whitney),
    ];
    for (number, doo_sabin, half_box, scheme) in schemes {
        let d = sheet(matches!(scheme, Scheme::Loop(..) | Scheme::Whitney));
        let caller = Caller::new(&d, number, FormworkOptions { doo_sabin, half_box }, 2).unwrap();
        let hierarchy = Hierarchy::new(&Cage::new(d).unwrap(), scheme, 2).unwrap();
        let mesh = hierarchy.level(0).mesh();
        for (degree, from) in [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)] {
            let rows = caller.rows(degree, [from, 2]);
            let columns = hierarchy.level(from as usize).mesh().num_cells(degree as usize);
            let values: Vec<f64> = (0..columns).map(|i| (1.3 * i as f64).sin()).collect();
            let found =
                rows.iter().map(|row| row.iter().map(|&(j, w, _)| w * values[j as usize]).sum::<f64>());
            let expected = match degree {
                0 => refined::<0>(&hierarchy, from, values.clone()),
                1 => refined::<1>(&hierarchy, from, values.clone()),
                _ => refined::<2>(&hierarchy, from, values.clone()),
            };
            assert_eq!(rows.len(), expected.len(), "{scheme:?} {degree}");
            for (i, (found, expected)) in found.zip(&expected).enumerate() {
                assert!((found - expected).abs() < 1e-14, "{scheme:?} {degree}: row {i}: {found} {expected}");
            }
            assert!(rows.iter().flatten().all(|&(_, double, single)| double as f32 == single));
        }
        let mut counts = FormworkCounts::default();
        message(unsafe { formwork_hierarchy_counts(caller.hierarchy, 0, &mut counts) }).unwrap();
        let cells = [counts.vertices, counts.edges, counts.faces].map(|count| count as usize);
        assert_eq!(cells, [0, 1, 2].map(|k| mesh.num_cells(k)));
    }
}

fn refined<const K: usize>(hierarchy: &Hierarchy, from: i32, values: Vec<f64>) -> Vec<f64> {
    let form = Cochain::<K>::new(values);
    (from as usize + 1..=2).fold(form, |form, level| hierarchy.refine(level, &form)).into_values()
}

#[test]
fn topology_is_that_of_the_level() {
    let caller = Caller::new(&sheet(false), FORMWORK_SCHEME_CATMARK, FormworkOptions::default(), 1).unwrap();
    let hierarchy = Hierarchy::new(&Cage::new(sheet(false)).unwrap(), Scheme::default(), 1).unwrap();
    let mesh = hierarchy.level(1).mesh();
    let (edges, faces, corners) = (mesh.num_edges(), mesh.num_faces(), mesh.num_corners());
    let (mut ends, mut sizes) = (guarded(2 * edges, 999), guarded(faces, 999));
    let (mut vertices, mut sides, mut signs) =
        (guarded(corners, 999), guarded(corners, 999), guarded(corners, 9));
    let [ends_at, sizes_at] = [&mut ends, &mut sizes].map(|array| array.as_mut_ptr());
    let [vertices_at, sides_at] = [&mut vertices, &mut sides].map(|array| array.as_mut_ptr());
    let status = unsafe {
        let signs_at = signs.as_mut_ptr();
        formwork_hierarchy_topology(caller.hierarchy, 1, ends_at, sizes_at, vertices_at, sides_at, signs_at)
    };
    message(status).unwrap();
    assert_eq!([&mut ends, &mut sizes, &mut vertices, &mut sides].map(|array| array.pop()), [Some(999); 4]);
    assert_eq!(signs.pop(), Some(9));
    assert_eq!(ends, mesh.edges().as_flattened());
    assert!(sizes.iter().all(|&size| size == 4));
    assert_eq!(vertices, mesh.corner_vertices());
    for c in 0..corners {
        let half_edge = mesh.corner_half_edge(c as u32);
        assert_eq!((sides[c], f64::from(signs[c])), (half_edge.edge(), half_edge.sign()));
    }
    let mut finest = -1;
    message(unsafe { formwork_hierarchy_finest_level(caller.hierarchy, &mut finest) }).unwrap();
    assert_eq!(finest, 1);
}

#[test]
fn what_is_wrong_is_said() {
    let refused = |change: &dyn Fn(&mut Descriptor), scheme, levels| {
        let mut d = sheet(false);
        change(&mut d);
        Caller::new(&d, scheme, FormworkOptions::default(), levels).err().expect("refused")
    };
    let catmark = FORMWORK_SCHEME_CATMARK;
    assert_eq!(refused(&|_| (), 5, 1), "the scheme is 5: use 0 to 4");
    assert_eq!(refused(&|_| (), catmark, -1), "-1 levels: use 0 or more");
    assert!(refused(&|_| (), catmark, 16).contains("at most 15"));
    assert!(refused(&|_| (), FORMWORK_SCHEME_LOOP, 1).contains("triangles only"));
    assert!(refused(&|d| d.face_vertices[2] = 9, catmark, 1).contains("vertex 9"));
    assert!(refused(&|d| d.holes[0] = 4, catmark, 1).contains("hole 0"));
    let last = unsafe { CStr::from_ptr(formwork_last_error()) };
    assert!(last.to_str().unwrap().contains("hole 0"), "the message stays");
    unsafe {
        let status = formwork_hierarchy_from_cage(null(), catmark, null(), 1, null_mut());
        assert_eq!(message(status).unwrap_err(), "the pointer to the cage is null");
        formwork_hierarchy_free(null_mut());
        formwork_stencils_free(null_mut());
        assert_eq!(CStr::from_ptr(formwork_version()).to_str().unwrap(), env!("CARGO_PKG_VERSION"));
    }
}
