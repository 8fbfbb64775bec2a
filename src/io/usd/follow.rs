//! What a stage says of the faces of a mesh, and of the files beside it, when the mesh is refined and
//! written elsewhere.

use std::path::Path as FilePath;

use openusd::sdf::{Data, SpecData, Value};

use super::Stage;
use super::build::{Editor, integers};
use super::layer::Prim;
use crate::io::Surface;

/// Attributes of points that are neither primvars nor written anew.
const OF_POINTS: [&str; 3] = ["velocities", "accelerations", "faceVaryingLinearInterpolation"];

/// Lets values and subsets of faces follow the faces, and takes out what belongs to vertices and corners
/// that are no more: names it. `control` is the old face of each new one; empty if that is not known, and
/// then nothing follows.
pub(super) fn refined_faces(editor: &mut Editor, surface: &Surface, control: &[u32]) -> Vec<String> {
    let mut dropped = Vec::new();
    for name in attributes(editor) {
        let is_form = ["form0", "form1", "form2", "form1Vector", "normals"]
            .iter()
            .any(|form| name.strip_prefix("primvars:") == Some(form));
        let is_primvar = name.starts_with("primvars:") && !name.ends_with(":indices") && !is_form;
        if OF_POINTS.contains(&name.as_str()) {
            editor.remove(&name);
            dropped.push(name);
        } else if is_primvar && !follows(editor, &name, control) {
            editor.remove(&name);
            editor.remove(&format!("{name}:indices"));
            dropped.push(name);
        }
    }
    for form in ["form0", "form1", "form2", "form1Vector"] {
        // Those of the cage; the refined ones come after.
        let keep = match form {
            "form0" => surface.fields().form0.is_some(),
            "form2" => surface.fields().form2.is_some(),
            _ => surface.fields().form1.is_some(),
        };
        if !keep {
            editor.remove(&format!("primvars:{form}"));
        }
    }
    let subsets = Prim { data: editor.data, path: editor.prim.clone() }.children();
    let subsets = subsets.into_iter().filter(|prim| prim.type_name() == "GeomSubset");
    let paths: Vec<_> = subsets
        .filter(|prim| prim.token("elementType").is_none_or(|element| element == "face"))
        .map(|prim| prim.path)
        .collect();
    for path in paths {
        if control.is_empty() {
            dropped.push(format!("the faces of {path}"));
        }
        let indices = path.append_property("indices").ok().and_then(|path| editor.data.spec_mut(&path));
        if let Some(spec) = indices {
            each_value(spec, |value| match value {
                Value::IntVec(faces) => {
                    let chosen: std::collections::HashSet<u32> = faces.iter().map(|&f| f as u32).collect();
                    let of = |(i, face): (usize, &u32)| chosen.contains(face).then_some(i as u32);
                    integers(control.iter().enumerate().filter_map(of))
                }
                other => other.clone(),
            });
        }
    }
    match dropped.is_empty() {
        true => Vec::new(),
        false => vec![format!("{}: not refined and therefore left out: {}", editor.prim, dropped.join(", "))],
    }
}

fn attributes(editor: &Editor) -> Vec<String> {
    match editor.data.spec(&editor.prim).and_then(|spec| spec.get("propertyChildren")) {
        Some(Value::TokenVec(names)) => names.iter().map(|name| name.as_str().to_owned()).collect(),
        _ => Vec::new(),
    }
}

/// Whether a primvar still fits: a constant does, a value for each face follows its face.
fn follows(editor: &mut Editor, name: &str, control: &[u32]) -> bool {
    let path_of = |name: &str| editor.prim.append_property(name).ok();
    let (Some(path), Some(index_path)) = (path_of(name), path_of(&format!("{name}:indices"))) else {
        return false;
    };
    let Some(spec) = editor.data.spec(&path) else { return true };
    let wide = matches!(spec.get("elementSize"), Some(Value::Int(size)) if *size != 1);
    match spec.get("interpolation") {
        Some(Value::Token(token)) if token.as_str() == "uniform" && !control.is_empty() && !wide => {}
        Some(Value::Token(token)) if token.as_str() != "constant" => return false,
        _ => return true,
    }
    let listed = if editor.data.spec(&index_path).is_some() { index_path } else { path };
    let Some(spec) = editor.data.spec_mut(&listed) else { return false };
    let mut fits = true;
    each_value(spec, |value| {
        pick(value, control).unwrap_or_else(|| {
            fits = false;
            value.clone()
        })
    });
    fits
}

/// Changes the default and every sample of an attribute.
fn each_value(spec: &mut SpecData, mut change: impl FnMut(&Value) -> Value) {
    if let Some(value) = spec.get_mut("default") {
        *value = change(value);
    }
    if let Some(Value::TimeSamples(samples)) = spec.get_mut("timeSamples") {
        for (_, value) in samples {
            *value = change(value);
        }
    }
}

/// The entries of a list at these places; `None` if it is too short or no list.
fn pick(value: &Value, places: &[u32]) -> Option<Value> {
    macro_rules! pick {
        ($($kind:ident),+) => {
            match value {
                $(Value::$kind(v) => {
                    let at = |&i: &u32| v.get(i as usize).cloned();
                    Some(Value::$kind(places.iter().map(at).collect::<Option<_>>()?))
                })+
                _ => None,
            }
        };
    }
    pick!(
        BoolVec,
        UcharVec,
        IntVec,
        UintVec,
        Int64Vec,
        Uint64Vec,
        HalfVec,
        FloatVec,
        DoubleVec,
        StringVec,
        TokenVec,
        AssetPathVec,
        QuathVec,
        QuatfVec,
        QuatdVec,
        Vec2hVec,
        Vec2fVec,
        Vec2dVec,
        Vec2iVec,
        Vec3hVec,
        Vec3fVec,
        Vec3dVec,
        Vec3iVec,
        Vec4hVec,
        Vec4fVec,
        Vec4dVec,
        Vec4iVec,
        Matrix4dVec
    )
}

/// A word on paths to other files, which are relative to a folder that may not be that of the output.
pub(super) fn relative_paths(data: &Data, stage: &Stage, from: &str, to: &FilePath) -> Option<String> {
    let folder = |path: &FilePath| {
        let parent = path.parent().filter(|p| *p != FilePath::new("")).unwrap_or(FilePath::new("."));
        std::fs::canonicalize(parent).ok()
    };
    let moved = folder(FilePath::new(from)) != folder(to);
    let relative = |path: &str| !path.is_empty() && !path.starts_with('/') && !path.contains("://");
    let names_file = |value: &Value| match value {
        Value::AssetPath(path) => relative(path.as_str()),
        Value::AssetPathVec(paths) => paths.iter().any(|path| relative(path.as_str())),
        Value::ReferenceListOp(_) | Value::PayloadListOp(_) => true,
        _ => false,
    };
    let mut values = data.iter().flat_map(|(_, spec)| spec.fields.iter());
    if !((moved || stage.packed > 0) && values.any(|(_, value)| names_file(value))) {
        return None;
    }
    Some(match stage.packed {
        0 => format!("the stage names files relative to the folder of {from}: write beside it or copy them"),
        _ => format!("the stage names files inside the package {from}: unpack them beside the output"),
    })
}
