//! What a stage says of the faces of a mesh, and of the files beside it, when the mesh is refined and
//! written elsewhere.

use std::path::Path as FilePath;

use openusd::sdf::{Data, Value};

use super::Stage;
use super::build::{Editor, integers};
use super::layer::Prim;
use super::primvars::{self, Fate, each_value};
use crate::io::Surface;

/// Attributes of points that are neither primvars nor written anew.
const OF_POINTS: [&str; 3] = ["velocities", "accelerations", "faceVaryingLinearInterpolation"];

/// Whether faces went after the stage was read, as --collapse lets them: what the stage says of faces and
/// corners then goes by other numbers.
pub(super) fn has_other_faces(surface: &Surface) -> bool {
    surface.asset().is_some_and(|asset| {
        let read = asset.stage.as_ref().map(|stage| &stage.descriptor.face_sizes);
        read.is_some_and(|sizes| *sizes != asset.descriptor.face_sizes)
    })
}

/// Lets primvars and subsets of faces follow the refinement, and takes out what cannot: names it. Without an
/// ancestry only what is constant stays.
pub(super) fn refined_faces(editor: &mut Editor, surface: &Surface) -> Vec<String> {
    let (mut dropped, mut linear) = (Vec::new(), Vec::new());
    let ancestry = surface.ancestry().filter(|_| !has_other_faces(surface));
    for name in attributes(editor) {
        let is_form = ["form0", "form1", "form2", "form1Vector", "normals"]
            .iter()
            .any(|form| name.strip_prefix("primvars:") == Some(form));
        let is_primvar = name.starts_with("primvars:") && !name.ends_with(":indices") && !is_form;
        let fate = match is_primvar {
            true => primvars::refine(editor, &name, surface, ancestry),
            false if OF_POINTS.contains(&name.as_str()) => Fate::Lost,
            false => Fate::Kept,
        };
        match fate {
            Fate::Kept => {}
            Fate::Linear => linear.push(name),
            Fate::Lost => {
                editor.remove(&name);
                editor.remove(&format!("{name}:indices"));
                dropped.push(name);
            }
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
    let control = ancestry.map(|ancestry| ancestry.control_faces()).unwrap_or_default();
    let control: Vec<u32> = match control.is_empty() {
        true => Vec::new(),
        false => surface.faces().map(|f| control[f as usize]).collect(),
    };
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
    let note = |what: &str, names: Vec<String>| match names.is_empty() {
        true => None,
        false => Some(format!("{}: {what}: {}", editor.prim, names.join(", "))),
    };
    let notes = [
        note("interpolated linearly within each face", linear),
        note("not refined and therefore left out", dropped),
    ];
    notes.into_iter().flatten().collect()
}

fn attributes(editor: &Editor) -> Vec<String> {
    match editor.data.spec(&editor.prim).and_then(|spec| spec.get("propertyChildren")) {
        Some(Value::TokenVec(names)) => names.iter().map(|name| name.as_str().to_owned()).collect(),
        _ => Vec::new(),
    }
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
