use std::path::{Path, PathBuf};

use gltf::json::extras::RawValue;
use gltf::json::material::{Material, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf::json::mesh::{Mode, Semantic};
use nalgebra::Vector3;

use super::arrows;
use super::container::Container;
use super::{ARROWS, EXTRAS, SURFACE};
use crate::field;
use crate::io::atomic::{self, Draft};
use crate::io::json::{Object, write_mesh};
use crate::io::{IoError, SaveOptions, Surface};

/// Writes a surface as binary glTF.
///
/// # Errors
/// [`IoError::FormatLimit`] if a coordinate or a value does not fit a 32-bit float or the file would
/// exceed the 4 GiB of the format, [`IoError::NothingToWrite`] if all faces are holes; [`IoError::Write`].
pub fn write(path: &Path, surface: &Surface, options: SaveOptions) -> Result<(), IoError> {
    let glb = build(path, surface, options)?.finish().ok_or_else(|| too_long(path))?;
    atomic::write(path, |out| glb.to_writer(out).map_err(std::io::Error::other))
}

/// Writes a surface as a `.gltf` file and, beside it, the file of its numbers ([`buffer_path`]). Returns
/// both paths.
///
/// # Errors
/// As for [`write()`]; neither file is then left half written.
pub fn write_text(path: &Path, surface: &Surface, options: SaveOptions) -> Result<Vec<PathBuf>, IoError> {
    let beside = buffer_path(path);
    let name = beside.file_name().unwrap_or_default().to_string_lossy();
    let (json, bytes) =
        build(path, surface, options)?.finish_text(&percent_encoded(&name)).ok_or_else(|| too_long(path))?;
    let (mut document, mut buffer) = (Draft::open(path)?, Draft::open(&beside)?);
    document.write(|out| std::io::Write::write_all(out, &json))?;
    buffer.write(|out| std::io::Write::write_all(out, &bytes))?;
    buffer.publish()?;
    document.publish()?;
    Ok(vec![path.to_owned(), beside])
}

/// Where [`write_text`] puts the numbers: `box.gltf` -> `box.bin`.
pub fn buffer_path(path: &Path) -> PathBuf {
    path.with_extension("bin")
}

/// A file name as a URI.
fn percent_encoded(name: &str) -> String {
    let plain = |b: u8| b.is_ascii_alphanumeric() || b"-._~".contains(&b);
    name.bytes().map(|b| if plain(b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect()
}

fn too_long(path: &Path) -> IoError {
    limit(path, "the mesh exceeds the 4 GiB of glTF buffers here: refine less or write .json")
}

fn limit(path: &Path, limit: &'static str) -> IoError {
    IoError::FormatLimit { path: path.to_owned(), limit }
}

fn build(path: &Path, surface: &Surface, options: SaveOptions) -> Result<Container, IoError> {
    let (mesh, positions) = (surface.mesh(), surface.positions());
    let too_large =
        || limit(path, "a value is too large for the 32-bit floats of glTF: write .json or .obj instead");

    let mut glb = Container::new();
    let normals = match surface.at_vertices() {
        Some(at) => at.normals.clone(),
        None => field::vertex_normals(mesh, positions),
    };
    let mut attributes = vec![
        (Semantic::Positions, glb.points(&singles(positions.values()).ok_or_else(too_large)?)),
        (Semantic::Normals, glb.vectors(&singles(&normals).ok_or_else(too_large)?)),
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
        if options.tangents {
            let tangents: Vec<[f32; 4]> = vectors.iter().zip(&normals).map(|(v, n)| tangent(v, n)).collect();
            attributes.push((Semantic::Tangents, glb.tangents(&tangents)));
        }
    }
    let triangles = fans(surface.drawn_faces().map(|f| mesh.face_vertices(f)));
    if triangles.is_empty() {
        return Err(IoError::NothingToWrite);
    }
    let indices = glb.indices(&triangles);
    let extras = extras(surface).map_err(IoError::write(path))?;
    let look = material([0.8, 0.8, 0.78, 1.0]);
    glb.node(SURFACE, attributes, indices, Mode::Triangles, look, Some(extras));

    let arrows = arrows::arrows(surface);
    if !arrows.indices.is_empty() {
        let points = glb.points(&singles(&arrows.points).ok_or_else(too_large)?);
        let indices = glb.indices(&arrows.indices);
        let attributes = vec![(Semantic::Positions, points)];
        glb.node(ARROWS, attributes, indices, Mode::Lines, material([0.05, 0.2, 0.6, 1.0]), None);
    }
    Ok(glb)
}

/// The triangles of polygons: each as a fan round its first vertex.
pub(super) fn fans<'a>(faces: impl Iterator<Item = &'a [u32]>) -> Vec<u32> {
    faces.flat_map(|v| v[1..].windows(2).flat_map(|pair| [v[0], pair[0], pair[1]])).collect()
}

fn extras(surface: &Surface) -> std::io::Result<Box<RawValue>> {
    let mut text = format!("{{\"{EXTRAS}\": ").into_bytes();
    let mut object = Object::new(&mut text);
    object.value("level", &surface.level())?;
    write_mesh(&mut object, surface)?;
    object.close()?;
    text.push(b'}');
    let text = String::from_utf8(text).map_err(std::io::Error::other)?;
    RawValue::from_string(text).map_err(std::io::Error::other)
}

/// The direction of a vector in the tangent plane; where it has none, some direction in that plane: glTF
/// wants unit vectors.
fn tangent(vector: &Vector3<f64>, normal: &Vector3<f64>) -> [f32; 4] {
    let across = |v: &Vector3<f64>| (v - normal * normal.dot(v)).try_normalize(1e-12 * v.norm());
    let axis = if normal.x.abs() < 0.5 { Vector3::x() } else { Vector3::y() };
    let t = across(vector).or_else(|| across(&axis)).unwrap_or_else(Vector3::x);
    [t.x as f32, t.y as f32, t.z as f32, 1.0]
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
