use std::path::Path;

use nalgebra::Vector3;
use openusd::sdf::{Data, Value};

use super::build::{Editor, Moving, empty_stage, extent, integers, triples32};
use super::layer::Prim;
use super::{CREASING, Stage};
use super::{follow, text};
use crate::cochain::Cochain;
use crate::field;
use crate::io::forms::file_half_edges;
use crate::io::surface::face_areas;
use crate::io::{Asset, AtVertices, IoError, Pose, Positions, SaveOptions, Surface};
use crate::osd::OsdScheme;
use crate::topology::{BoundaryInterpolation, CreasingMethod, Descriptor, TriangleSubdivision};

/// What only a subdivision surface has.
pub(super) const TAGS: [&str; 9] = [
    "creaseIndices",
    "creaseLengths",
    "creaseSharpnesses",
    "cornerIndices",
    "cornerSharpnesses",
    "holeIndices",
    "interpolateBoundary",
    "triangleSubdivisionRule",
    CREASING,
];

/// Writes a surface as text: into the stage that its asset is from, or one of its own. Returns what had no
/// place there, one sentence each.
///
/// # Errors
/// [`IoError::FormatLimit`] if a number does not fit a 32-bit float, [`IoError::Content`] if something on
/// the stage cannot be said as text; [`IoError::Write`].
pub fn write(path: &Path, surface: &Surface, options: SaveOptions) -> Result<Vec<String>, IoError> {
    let asset = surface.asset();
    let stage = asset.and_then(|asset| asset.stage.as_deref());
    let mut notes = Vec::new();
    let (mut data, prim) = match stage {
        Some(stage) => (stage.data.clone(), stage.prim.clone()),
        None => empty_stage(),
    };
    let mut editor = Editor { data: &mut data, prim };
    let written = match surface.cage() {
        Some(cage) => {
            if follow::has_other_faces(surface) {
                notes.extend(follow::refined_faces(&mut editor, surface));
            }
            write_cage(&mut editor, surface, cage, stage, asset)
        }
        None => {
            if stage.is_some() {
                notes.extend(follow::refined_faces(&mut editor, surface));
            }
            write_refined(&mut editor, surface)
        }
    };
    written.and_then(|()| write_forms(&mut editor, surface, options)).ok_or_else(|| {
        IoError::FormatLimit {
            path: path.to_owned(),
            limit: "a value is too large for the 32-bit floats of USD: write .json or .obj instead",
        }
    })?;
    if let (Some(stage), Some(asset)) = (stage, asset) {
        complete(&mut data, stage);
        notes.extend(follow::relative_paths(&data, stage, &asset.name, path));
    }
    text::write(path, data).map(|()| notes)
}

/// The cage: what the stage says of it stays, unless it was changed after it was read.
fn write_cage(
    editor: &mut Editor,
    surface: &Surface,
    cage: &Descriptor,
    stage: Option<&Stage>,
    asset: Option<&Asset>,
) -> Option<()> {
    if stage.is_none_or(|stage| stage.descriptor != *cage) {
        let left_handed = cage.left_handed;
        editor.set("faceVertexCounts", "int[]", integers(cage.face_sizes.iter().copied()));
        editor.set("faceVertexIndices", "int[]", integers(cage.face_vertices.iter().copied()));
        let orientation = if left_handed { "leftHanded" } else { "rightHanded" };
        editor.set("orientation", "token", Value::token(orientation));
        TAGS.iter().for_each(|tag| editor.remove(tag));
        write_tags(editor, cage);
    }
    let points = triples32(surface.positions().values())?;
    let prim = Prim { data: editor.data, path: editor.prim.clone() };
    let has_extent = prim.attribute("extent").is_some();
    let said = prim.token("subdivisionScheme");
    let triangles = cage.face_sizes.iter().all(|&n| n == 3);
    let scheme = match asset.and_then(|asset| asset.scheme) {
        Some(OsdScheme::Bilinear) => Some("bilinear"),
        Some(OsdScheme::Loop) => Some("loop"),
        Some(OsdScheme::Catmark) => Some("catmullClark"),
        None if stage.is_some() => None, // a mesh of polygons stays one
        None => Some(if triangles { "loop" } else { "catmullClark" }),
    };
    if let Some(scheme) =
        scheme.filter(|&scheme| stage.is_none() || scheme != said.as_deref().unwrap_or("catmullClark"))
    {
        editor.set("subdivisionScheme", "token", Value::token(scheme));
    }
    if stage.is_none() {
        editor.set("points", "point3f[]", points.clone());
    }
    if !has_extent {
        editor.set("extent", "float3[]", extent(&points));
    }
    Some(())
}

fn write_tags(editor: &mut Editor, cage: &Descriptor) {
    let boundary = match cage.boundary {
        BoundaryInterpolation::None => "none",
        BoundaryInterpolation::EdgeOnly => "edgeOnly",
        BoundaryInterpolation::EdgeAndCorner => "edgeAndCorner",
    };
    editor.set("interpolateBoundary", "token", Value::token(boundary));
    if cage.triangles == TriangleSubdivision::Smooth {
        editor.set("triangleSubdivisionRule", "token", Value::token("smooth"));
    }
    if cage.creasing == CreasingMethod::Chaikin {
        editor.set(CREASING, "token", Value::token("chaikin"));
        editor.metadata(CREASING, "custom", Value::Bool(true));
    }
    if !cage.creases.is_empty() {
        editor.set("creaseIndices", "int[]", integers(cage.creases.iter().flat_map(|c| c.vertices)));
        editor.set("creaseLengths", "int[]", integers(cage.creases.iter().map(|_| 2)));
        let sharpness = cage.creases.iter().map(|c| c.sharpness).collect();
        editor.set("creaseSharpnesses", "float[]", Value::FloatVec(sharpness));
    }
    if !cage.corners.is_empty() {
        editor.set("cornerIndices", "int[]", integers(cage.corners.iter().map(|c| c.vertex)));
        let sharpness = cage.corners.iter().map(|c| c.sharpness).collect();
        editor.set("cornerSharpnesses", "float[]", Value::FloatVec(sharpness));
    }
    if !cage.holes.is_empty() {
        editor.set("holeIndices", "int[]", integers(cage.holes.iter().copied()));
    }
}

/// A mesh of polygons, which is what it is to be drawn as.
fn write_refined(editor: &mut Editor, surface: &Surface) -> Option<()> {
    let mesh = surface.mesh();
    TAGS.iter().for_each(|tag| editor.remove(tag));
    editor.set("subdivisionScheme", "token", Value::token("none"));
    editor.set("orientation", "token", Value::token("rightHanded"));
    editor.set("faceVertexCounts", "int[]", integers(surface.faces().map(|f| mesh.face_size(f) as u32)));
    let vertices = surface.faces().flat_map(|f| mesh.face_vertices(f).iter().copied());
    editor.set("faceVertexIndices", "int[]", integers(vertices));
    let points = moving(surface, |positions, _| triples32(positions.values()))?;
    let extent = Moving {
        rest: extent(&points.rest),
        samples: points.samples.iter().map(|(time, points)| (*time, extent(points))).collect(),
    };
    editor.set("points", "point3f[]", points);
    editor.set("extent", "float3[]", extent);

    let one_sided = surface.is_one_sided();
    let on_limit = surface.at_vertices().is_some();
    let normals = moving(surface, |positions, at_vertices| match at_vertices {
        Some(at) => triples32(&at.normals),
        None if !one_sided => triples32(&field::vertex_normals(mesh, positions)),
        None => {
            let means = surface.corner_means(&face_areas(mesh, positions));
            triples32(&means.iter().map(|n| n.try_normalize(0.0).unwrap_or(Vector3::z())).collect::<Vec<_>>())
        }
    })?;
    let interpolation = if one_sided && !on_limit { "faceVarying" } else { "vertex" };
    editor.remove("primvars:normals");
    editor.set_primvar("normals", "normal3f[]", interpolation, normals);
    Some(())
}

fn write_forms(editor: &mut Editor, surface: &Surface, options: SaveOptions) -> Option<()> {
    let (mesh, fields) = (surface.mesh(), surface.fields());
    if let Some(form) = &fields.form0 {
        set_form(editor, 0, "vertex", form.values().to_vec())?;
    }
    if let Some(form) = &fields.form1 {
        // In the order of the file's corners, which a left-handed cage has its own of.
        let unturned = Descriptor::default();
        let descriptor = surface.cage().unwrap_or(&unturned);
        let half_edges = surface.faces().flat_map(|f| file_half_edges(descriptor, mesh, f));
        set_form(editor, 1, "faceVarying", half_edges.map(|h| form.along(h)).collect())?;
        let interpolation = if surface.is_one_sided() { "faceVarying" } else { "vertex" };
        let vectors = form_vectors(surface, form, |v| v)?;
        editor.set_primvar("primvars:form1Vector", "vector3f[]", interpolation, vectors);
        if options.tangents {
            let directions =
                form_vectors(surface, form, |v| v.try_normalize(f64::MIN_POSITIVE).unwrap_or_default())?;
            editor.set_primvar("primvars:combDir", "vector3f[]", interpolation, directions);
        }
    }
    if let Some(form) = &fields.form2 {
        set_form(editor, 2, "uniform", surface.faces().map(|f| form[f as usize]).collect())?;
    }
    Some(())
}

/// The tangent vectors of the 1-form, or what is made of them: one for each vertex, or each corner of the faces that are
/// written where they have two sides.
fn form_vectors(
    surface: &Surface,
    form: &Cochain<1>,
    change: impl Fn(Vector3<f64>) -> Vector3<f64>,
) -> Option<Moving> {
    let (mesh, one_sided) = (surface.mesh(), surface.is_one_sided());
    let triples =
        |vectors: &[Vector3<f64>]| triples32(&vectors.iter().map(|&v| change(v)).collect::<Vec<_>>());
    moving(surface, |positions, at_vertices| {
        if let Some(at) = at_vertices {
            let [of_vertices, of_corners] = at.vectors.as_ref()?;
            let written = surface.faces().flat_map(|f| mesh.corners(f));
            return match one_sided {
                false => triples(of_vertices),
                true => triples(&written.map(|c| of_corners[c as usize]).collect::<Vec<_>>()),
            };
        }
        let of_face = match std::ptr::eq(positions, surface.positions()) {
            true => surface.face_vectors().unwrap_or_default().to_vec(),
            false => field::face_vectors(mesh, positions, form),
        };
        match one_sided {
            false => triples(&field::vertex_vectors(mesh, &of_face)),
            true => triples(&surface.corner_means(&of_face)),
        }
    })
}

/// In 32 bits, or in 64 where the stage has them so already; `None` if a value overflows.
fn set_form(editor: &mut Editor, degree: usize, interpolation: &str, values: Vec<f64>) -> Option<()> {
    let name = format!("primvars:form{degree}");
    let prim = Prim { data: editor.data, path: editor.prim.clone() };
    let type_name = prim.attribute(&name).and_then(|spec| spec.get("typeName"));
    if matches!(type_name, Some(Value::Token(token)) if token.as_str() == "double[]") {
        editor.set_primvar(&name, "double[]", interpolation, Value::DoubleVec(values));
        return Some(());
    }
    let single = |&x: &f64| Some(x as f32).filter(|x| x.is_finite());
    let values: Vec<f32> = values.iter().map(single).collect::<Option<_>>()?;
    editor.set_primvar(&name, "float[]", interpolation, Value::FloatVec(values));
    Some(())
}

/// A value that follows from positions and, on the limit, what is known there, for each frame; the first is the
/// value at rest.
fn moving(
    surface: &Surface,
    value: impl Fn(&Positions, Option<&AtVertices>) -> Option<Value>,
) -> Option<Moving> {
    let sample = |pose: &Pose| Some((pose.time, value(&pose.positions, pose.at_vertices.as_ref())?));
    let samples = surface.frames().iter().map(sample).collect::<Option<Vec<_>>>()?;
    Some(Moving { rest: value(surface.positions(), surface.at_vertices())?, samples })
}

/// What a stage should say and this one does not; what USD assumes then is said.
fn complete(data: &mut Data, stage: &Stage) {
    let first = stage.prim.ancestors_below_root().last();
    let name = first.and_then(|path| path.name().map(str::to_owned)).unwrap_or_default();
    let root = openusd::sdf::Path::abs_root();
    if let Some(spec) = data.spec_mut(&root) {
        let assumed = [
            ("defaultPrim", Value::token(name)),
            ("metersPerUnit", Value::Double(0.01)),
            ("upAxis", Value::token("Y")),
        ];
        for (key, value) in assumed {
            if !spec.contains(key) {
                spec.add(key, value);
            }
        }
    }
}
