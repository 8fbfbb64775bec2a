//! `formwork batch`: failures apart, shards, going on where it stopped; the same on a Dask cluster.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};

use crate::common::clients::{clients, root};
use crate::common::run::{formwork, json_file, scratch};

const ASSETS: usize = 40;

/// Forty meshes, two of them broken: a face of number 11 and an attribute of number 27.
fn make(folder: &Path) {
    let mut assets = Vec::new();
    for i in 0..ASSETS {
        let mut mesh =
            format!("v 0 0 {i}\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 1\nv 2 1 1\nf 1 2 3 4\nf 2 5 6 3\n");
        if i == 11 {
            mesh += "f 1 2 99\n";
        }
        let (mut name, out) = (format!("mesh{i}.obj"), ["usda", "glb", "json", "obj"][i % 4]);
        fs::write(folder.join(&name), &mesh).unwrap();
        if i == 27 {
            name = "mesh27.usda".to_owned();
            fs::write(folder.join(&name), "#usda 1.0\ndef Mesh \"m\" {}\n").unwrap();
        }
        let mut asset = json!({ "mesh": name, "output": format!("out/mesh{i}.{out}") });
        if i % 5 == 0 {
            fs::write(folder.join(format!("field{i}.json")), "{\"edges\": [[0, 1, 1], [2, 5, -2]]}").unwrap();
            asset["field"] = json!(format!("field{i}.json"));
        }
        if i % 7 == 0 {
            asset["options"] = json!(["--levels", "3"]);
        }
        assets.push(asset);
    }
    let manifest = json!({ "options": ["--boundary", "edge-and-corner"], "assets": assets });
    fs::write(folder.join("manifest.json"), manifest.to_string()).unwrap();
}

/// The outputs, without the reports.
fn outputs(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder.join("out")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if !name.ends_with(".report.json") {
            found.insert(name, fs::read(path).unwrap());
        }
    }
    found
}

/// Runs a batch in a folder: its exit code, and what it said.
fn batch(folder: &Path, more: &[&str]) -> (Option<i32>, Value) {
    let run = formwork(folder, &[&["batch", "manifest.json", "--json"], more].concat());
    (run.status.code(), serde_json::from_slice(&run.stdout).unwrap())
}

#[track_caller]
fn assert_counts(said: &Value, done: usize, unchanged: usize, failed: usize) {
    let expected = (json!(done), json!(unchanged), json!(failed));
    assert_eq!((said["done"].clone(), said["unchanged"].clone(), said["failed"].clone()), expected, "{said}");
}

fn assert_failures(said: &Value) {
    let mut errors: Vec<&str> =
        said["failures"].as_array().unwrap().iter().map(|f| f["error"].as_str().unwrap()).collect();
    errors.sort();
    assert_eq!(errors.len(), 2);
    assert!(errors[0].starts_with("mesh11.obj: line 9: face 2 refers to vertex 99"), "{}", errors[0]);
    assert!(errors[1].starts_with("mesh27.usda: /m: faceVertexCounts is missing"), "{}", errors[1]);
}

#[test]
fn forty_assets_two_of_them_broken() {
    let folder = scratch();
    make(folder.path());
    let (code, said) = batch(folder.path(), &["--jobs", "2"]);
    assert_eq!(code, Some(1));
    assert_counts(&said, 38, 0, 2);
    assert_failures(&said);
    let made = outputs(folder.path());
    let meshes = made.keys().filter(|name| !name.ends_with(".fields.json")).count();
    assert_eq!(meshes, 38);
    let report = json_file(&folder.path().join("out/mesh3.obj.report.json"));
    assert_eq!((&report["status"], &report["report"]["level"]), (&json!("done"), &json!(3)));
    let report = json_file(&folder.path().join("out/mesh11.obj.report.json"));
    assert_eq!(report["status"], "failed");

    // Again: nothing to do but the two that failed.
    let (code, said) = batch(folder.path(), &[]);
    assert_eq!(code, Some(1));
    assert_counts(&said, 0, 38, 2);
    // What was changed, taken away or tampered with is done again, and so is what was mended.
    fs::write(folder.path().join("mesh27.usda"), fs::read(root().join("assets/scene.usda")).unwrap())
        .unwrap();
    fs::write(folder.path().join("field5.json"), "{\"edges\": [[0, 1, 2]]}").unwrap();
    fs::remove_file(folder.path().join("out/mesh6.json")).unwrap();
    fs::write(folder.path().join("out/mesh9.glb"), "tampered").unwrap();
    let text = fs::read_to_string(folder.path().join("manifest.json")).unwrap();
    let text = text.replace(
        "\"mesh\":\"mesh27.usda\"",
        "\"options\":[\"--prim\",\"/Scene/Wave\"],\"mesh\":\"mesh27.usda\"",
    );
    fs::write(folder.path().join("manifest.json"), text).unwrap();
    let (code, said) = batch(folder.path(), &[]);
    assert_eq!(code, Some(1));
    assert_counts(&said, 4, 35, 1);
    assert!(outputs(folder.path())["mesh9.glb"].starts_with(b"glTF"));
}

/// Shards together are the whole, whatever their number.
#[test]
fn shards_are_the_whole() {
    let (whole, parts) = (scratch(), scratch());
    make(whole.path());
    make(parts.path());
    batch(whole.path(), &["--jobs", "2"]);
    let mut done = 0;
    for shard in ["1/3", "2/3", "3/3"] {
        let (_, said) = batch(parts.path(), &["--shard", shard]);
        done += said["done"].as_u64().unwrap();
    }
    assert_eq!(done, 38);
    assert!(outputs(whole.path()) == outputs(parts.path()));
}

#[test]
fn a_dask_cluster_makes_the_same() {
    let Some(clients) = clients() else { return };
    let (here, there) = (scratch(), scratch());
    make(here.path());
    make(there.path());
    batch(here.path(), &["--jobs", "2"]);
    let run = Command::new(clients.join("venv/bin/python"))
        .arg(root().join("examples/batch_dask.py"))
        .arg(there.path().join("manifest.json"))
        .args(["--local", "2", "--formwork"])
        .arg(assert_cmd::cargo::cargo_bin("formwork"))
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{stderr}");
    let said: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_counts(&said, 38, 0, 2);
    assert_failures(&said);
    assert!(outputs(here.path()) == outputs(there.path()));
    // And a run on one machine goes on where the cluster stopped.
    let (_, said) = batch(there.path(), &[]);
    assert_counts(&said, 0, 38, 2);
}

#[test]
fn manifests_that_are_wrong() {
    let folder = scratch();
    let refused = |text: &str, more: &[&str], words: &str| {
        fs::write(folder.path().join("m.json"), text).unwrap();
        let run = formwork(folder.path(), &[&["batch", "m.json"], more].concat());
        let said = String::from_utf8(run.stderr).unwrap();
        assert_eq!((run.status.code(), said.lines().count()), (Some(2), 1), "{said}");
        assert!(said.contains(words), "{words} in {said}");
    };
    refused("{", &[], "m.json: EOF");
    refused("{\"assets\": [{\"mesh\": \"a.obj\"}]}", &[], "missing field `output`");
    refused("{\"assets\": [], \"option\": []}", &[], "unknown field `option`");
    let twice = "{\"assets\": [{\"mesh\": \"a.obj\", \"output\": \"o.glb\"}, {\"mesh\": \"b.obj\", \"output\": \"o.glb\"}]}";
    refused(twice, &[], "m.json: assets[1]: another asset writes o.glb too");
    for shard in ["0/2", "3/2", "1", "a/b"] {
        refused("{\"assets\": []}", &["--shard", shard], "write i/N with i from 1 to N");
    }
    refused("{\"assets\": []}", &["--jobs", "0"], "write 1 to 1024");
    let run = formwork(folder.path(), &["batch", "none.json"]);
    assert_eq!(run.status.code(), Some(2));
}
