//! Blender imports what we write, with our attributes. `scripts/clients --blender` installs it; it is large,
//! and these tests are skipped without it.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};

use crate::common::clients::root;
use crate::common::run::{scratch, succeed};

/// A Python that has `bpy`.
fn blender() -> Option<PathBuf> {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
    let installed = target.join("clients/bpy/bin/python");
    let python = std::env::var_os("FORMWORK_BPY").map_or(installed, PathBuf::from);
    if !python.exists() {
        eprintln!("skipped: no Blender; scripts/clients --blender installs one");
        return None;
    }
    Some(python)
}

/// What Blender made of files. In a process of its own: it may crash where others complain.
fn import(python: &Path, files: &[&Path]) -> Vec<Value> {
    let script = root().join("tests/clients/blender_check.py");
    let run = Command::new(python).arg(script).args(files).output().unwrap();
    let text = String::from_utf8(run.stdout).unwrap();
    let reports = text.lines().filter(|line| line.starts_with("{\"file\""));
    let reports: Vec<Value> = reports.map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(reports.len(), files.len(), "{text}\n{}", String::from_utf8_lossy(&run.stderr));
    reports
}

#[test]
fn our_attributes_arrive() {
    let Some(python) = blender() else { return };
    let folder = scratch();
    // 112 vertices, 217 edges, 105 faces: on level 1 a vertex for each, and four faces a quad.
    let names = ["cage.usda", "fine.usda", "fine.glb"].map(|name| folder.path().join(name));
    for (out, levels) in names.iter().zip(["0", "1", "1"]) {
        let field = "assets/creased_box.field.json";
        let args = ["subdivide", "assets/creased_box.obj", "--field", field, "-q", "-l", levels, "-o"];
        succeed(root(), &[&args[..], &[out.to_str().unwrap()]].concat());
    }
    let reports = import(&python, &[&names[0], &names[1], &names[2]]);
    let surface = |i: usize| &reports[i]["meshes"]["surface"];
    let attribute = |i: usize, name: &str| {
        let found = surface(i)["attributes"][name].as_array().unwrap_or_else(|| panic!("{name}")).clone();
        assert!(found[3].as_f64().unwrap() > 1.0, "{name} is zero");
        json!(found[..3])
    };
    let counts = |i: usize| json!([surface(i)["vertices"], surface(i)["edges"], surface(i)["polygons"]]);
    assert_eq!(counts(0), json!([112, 217, 105]));
    assert_eq!(attribute(0, "form1"), json!(["CORNER", "FLOAT", 434]));
    // Blender took the tags: the cage is a subdivision surface with creases.
    assert_eq!(attribute(0, "crease_edge"), json!(["EDGE", "FLOAT", 217]));

    assert_eq!(counts(1), json!([434, 868, 434]));
    assert_eq!(attribute(1, "form1"), json!(["CORNER", "FLOAT", 4 * 434]));
    assert_eq!(attribute(1, "form1Vector"), json!(["CORNER", "FLOAT_VECTOR", 4 * 434]));

    assert_eq!((&surface(2)["vertices"], &surface(2)["polygons"]), (&json!(434), &json!(2 * 434)));
    assert_eq!(attribute(2, "_FORM1"), json!(["POINT", "FLOAT_VECTOR", 434]));
    assert!(reports[2]["meshes"]["form1 arrows"]["edges"].as_u64().unwrap() > 400);
}
