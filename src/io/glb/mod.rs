//! A refined mesh as binary glTF 2.0: one file that viewers and game engines open.
//!
//! - Node `surface`: the faces as triangles (polygons as fans) with `POSITION`, `NORMAL` and, where there
//!   are such forms, the vertex attributes `_FORM0` (SCALAR, the 0-form) and `_FORM1` (VEC3, the tangent
//!   vector of the 1-form, the mean over the faces round each vertex, or the exact one on a limit surface).
//! - Node `form1 arrows`, where the 1-form is not zero: lines, an arrow at the centre of each face, or at each
//!   vertex of a limit surface. The
//!   longest is 0.9 times the mean edge length, the others in proportion.
//!
//! Faces that are holes are left out. glTF stores 32-bit floats, and has no attributes of faces: a 2-form is
//! not written.

mod arrows;
mod container;

use std::path::Path;

use gltf::json::material::{Material, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf::json::mesh::{Mode, Semantic};
use nalgebra::Vector3;

use super::{IoError, Surface, atomic};
use crate::field;
use container::Container;

/// Writes a surface.
///
/// # Errors
/// [`IoError::FormatLimit`] if a coordinate or a value does not fit a 32-bit float or the file would
/// exceed the 4 GiB of the format; [`IoError::Write`].
pub fn write(path: &Path, surface: &Surface) -> Result<(), IoError> {
    let (mesh, positions) = (surface.mesh(), surface.positions());
    let limit = |limit| IoError::FormatLimit { path: path.to_owned(), limit };
    let too_large =
        || limit("a value is too large for the 32-bit floats of glTF: write .json or .obj instead");

    let mut glb = Container::new();
    let mut attributes = vec![
        (Semantic::Positions, glb.points(&singles(positions.values()).ok_or_else(too_large)?)),
        (Semantic::Normals, {
            let normals = match surface.at_vertices() {
                Some(at) => at.normals.clone(),
                None => field::vertex_normals(mesh, positions),
            };
            glb.vectors(&singles(&normals).ok_or_else(too_large)?)
        }),
    ];
    if let Some(form) = &surface.fields().form0 {
        let values: Vec<f32> = form.values().iter().map(|&x| x as f32).collect();
        if values.iter().any(|x| !x.is_finite()) {
            return Err(too_large());
        }
        attributes.push((Semantic::Extras("FORM0".into()), glb.scalars(&values)));
    }
    let limit_vectors = surface.at_vertices().and_then(|at| at.vectors.as_ref()).map(|[vectors, _]| vectors);
    let mean = || surface.face_vectors().map(|vectors| field::vertex_vectors(mesh, vectors));
    if let Some(vectors) = limit_vectors.cloned().or_else(mean) {
        attributes
            .push((Semantic::Extras("FORM1".into()), glb.vectors(&singles(&vectors).ok_or_else(too_large)?)));
    }
    let triangles: Vec<u32> = surface
        .faces()
        .flat_map(|f| {
            let vertices = mesh.face_vertices(f);
            vertices[1..].windows(2).flat_map(|pair| [vertices[0], pair[0], pair[1]])
        })
        .collect();
    let indices = glb.indices(&triangles);
    glb.node("surface", attributes, indices, Mode::Triangles, material([0.8, 0.8, 0.78, 1.0]));

    let arrows = arrows::arrows(surface);
    if !arrows.indices.is_empty() {
        let points = glb.points(&singles(&arrows.points).ok_or_else(too_large)?);
        let indices = glb.indices(&arrows.indices);
        let attributes = vec![(Semantic::Positions, points)];
        glb.node("form1 arrows", attributes, indices, Mode::Lines, material([0.05, 0.2, 0.6, 1.0]));
    }
    let too_long = || limit("the mesh exceeds the 4 GiB of binary glTF: refine less or write .json");
    let glb = glb.finish().ok_or_else(too_long)?;
    atomic::write(path, |out| glb.to_writer(out).map_err(std::io::Error::other))
}

/// 32-bit copies; `None` if one overflows.
fn singles(vectors: &[Vector3<f64>]) -> Option<Vec<[f32; 3]>> {
    let single = |v: &Vector3<f64>| {
        let v = [v.x as f32, v.y as f32, v.z as f32];
        v.iter().all(|x| x.is_finite()).then_some(v)
    };
    vectors.iter().map(single).collect()
}

/// Not metallic, as glTF's default is: that shows black without surroundings to mirror. Two-sided, for
/// open surfaces.
fn material(colour: [f32; 4]) -> Material {
    Material {
        double_sided: true,
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor(colour),
            metallic_factor: StrengthFactor(0.0),
            roughness_factor: StrengthFactor(0.7),
            ..Default::default()
        },
        ..Default::default()
    }
}
