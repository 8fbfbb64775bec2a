//! `design`, `decompose` and `streamlines` as commands.

mod common;

use std::fs;
use std::path::{Path, PathBuf};

use common::run::{formwork, json_file, object, scratch, succeed};
use serde_json::{Value, json};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn out(folder: &Path, name: &str) -> String {
    folder.join(name).display().to_string()
}

fn spec(folder: &Path, spec: &Value) -> String {
    let path = folder.join("spec.json");
    fs::write(&path, spec.to_string()).unwrap();
    path.display().to_string()
}

#[test]
fn a_design_is_reported_and_its_values_serve_other_commands() {
    let folder = scratch();
    let (mesh, field) = (out(folder.path(), "torus.usda"), out(folder.path(), "field.json"));
    let args = [
        "design",
        "assets/torus.obj",
        "--spec",
        "assets/torus.design.json",
        "--json",
        "--field-out",
        &field,
        "-o",
        &mesh,
    ];
    let report = object(&root(), &args);
    assert_eq!((&report["generators"], &report["boundary_loops"]), (&2.into(), &0.into()));
    assert_eq!(report["singularities"]["euler_characteristic"], 0);
    assert_eq!(report["singularities"]["holds"], true);
    let zeros = report["singularities"]["zeros"].as_array().unwrap();
    assert!(zeros.iter().any(|zero| zero["index"] == 1) && zeros.iter().any(|zero| zero["index"] == -1));
    let text = fs::read_to_string(&mesh).unwrap();
    assert!(text.contains("primvars:form1Vector") && !text.contains("combDir"));

    let parts = out(folder.path(), "parts.json");
    succeed(&root(), &["decompose", "assets/torus.obj", "--field", &field, "-o", &parts]);
    let (parts, given) = (json_file(Path::new(&parts)), json_file(Path::new(&field)));
    let row =
        |name: &str| parts[name].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect::<Vec<_>>();
    let (exact, coexact, harmonic) = (row("exact"), row("coexact"), row("harmonic"));
    for (i, entry) in given["edges"].as_array().unwrap().iter().enumerate() {
        assert_eq!(parts["edges"][i], json!([entry[0], entry[1]]));
        let sum = exact[i] + coexact[i] + harmonic[i];
        assert!((sum - entry[2].as_f64().unwrap()).abs() < 1e-12);
    }
    assert_eq!(parts["cycles"].as_array().unwrap().len(), 2);

    for name in ["lines.json", "lines.usda", "lines.obj"] {
        let lines = out(folder.path(), name);
        let args =
            ["streamlines", "assets/torus.obj", "--field", &field, "--seeds", "12", "--json", "-o", &lines];
        assert_eq!(object(&root(), &args)["lines"], 12);
        let text = fs::read_to_string(&lines).unwrap();
        match name {
            "lines.usda" => assert!(text.starts_with("#usda 1.0") && text.contains("BasisCurves")),
            "lines.obj" => assert_eq!(text.lines().filter(|line| line.starts_with("l ")).count(), 12),
            _ => assert_eq!(json_file(Path::new(&lines))["lines"].as_array().unwrap().len(), 12),
        }
    }
}

#[test]
fn fur_gets_unit_directions() {
    let folder = scratch();
    let mesh = out(folder.path(), "gem.usda");
    let args = [
        "design",
        "assets/torus.obj",
        "--spec",
        "assets/torus.design.json",
        "--tangents",
        "--level",
        "1",
        "-o",
        &mesh,
    ];
    succeed(&root(), &args);
    let text = fs::read_to_string(&mesh).unwrap();
    let line = text.lines().find(|line| line.contains("vector3f[] primvars:combDir")).unwrap();
    let numbers: Vec<f64> = line
        .split(|c: char| !(c.is_ascii_digit() || "-+.e".contains(c)))
        .filter_map(|word| word.parse().ok())
        .collect();
    let vectors: Vec<&[f64]> = numbers[numbers.len() % 3..].chunks(3).collect();
    assert!(vectors.len() >= 512, "{}", vectors.len());
    for v in vectors {
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((length - 1.0).abs() < 1e-5, "{v:?}");
    }
}

#[test]
fn bad_specs_are_one_line_and_exit_with_2() {
    let folder = scratch();
    let refuse = |text: Value, mesh: &str, words: &[&str]| {
        let spec = spec(folder.path(), &text);
        let run = formwork(&root(), &["design", mesh, "--spec", &spec, "-o", &out(folder.path(), "x.json")]);
        let message = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(2), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
        assert!(!folder.path().join("x.json").exists());
    };
    let torus = "assets/torus.obj";
    refuse(json!({ "vortices": [{ "face": 1, "strength": 0.5 }] }), torus, &["vortices", "0.5", "balance"]);
    refuse(json!({ "sources": [{ "face": 1, "strength": 0.5 }] }), torus, &["sources[0]", "vertex"]);
    refuse(json!({ "sources": [{ "vertex": 1000, "strength": 0.5 }] }), torus, &["no vertex 1000", "128"]);
    refuse(json!({ "sauces": [] }), torus, &["line 1", "sauces"]);
    refuse(json!({ "boundary": ["normal"] }), torus, &["boundary loop"]);
    refuse(json!({ "edges": [{ "vertices": [0, 50], "value": 1 }] }), torus, &["0 and 50"]);
    refuse(json!({ "vectors": [{ "at": [0, 3, 3], "vector": [1, 0, 0] }] }), torus, &["face 0"]);
    refuse(json!({ "harmonic": [{ "generator": 2, "circulation": 1 }] }), torus, &["generator 2"]);
    refuse(json!({}), "assets/fin.obj", &["edge", "faces"]);
    let run = formwork(&root(), &["decompose", torus, "-o", &out(folder.path(), "x.json")]);
    assert_eq!(run.status.code(), Some(2));
}
