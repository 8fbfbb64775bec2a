//! What the commands say and how they end, on the happy path; bad input has a file of its own, and so has
//! what is written.

mod common;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use assert_cmd::cargo::cargo_bin;
use common::run::{fixture, formwork, json_file, keys, numbers, object, scratch, succeed};
use serde_json::Value;

#[test]
fn inspect_counts_and_says_what_will_be_done() {
    let folder = scratch();
    let sheet = fixture("sheet.obj");
    let text = String::from_utf8(formwork(folder.path(), &["inspect", &sheet]).stdout).unwrap();
    for words in
        ["vertices      13", "6   (by size: 6 of 4)", "1 loop, 10 edges", "1 without a face", "1 face marked"]
    {
        let words = words.replace("1 without", "1 vertex without");
        assert!(text.contains(&words), "no `{words}` in {text}");
    }
    let report = object(folder.path(), &["inspect", &sheet, "--json"]);
    assert_eq!(report["survey"]["vertices"], 13);
    assert_eq!(report["survey"]["isolated_vertices"], 1);
    assert_eq!(report["survey"]["euler_characteristic"], 1);
    assert_eq!(report["survey"]["genus"], 0);
    assert_eq!((&report["holes"], &report["faces_left_out"]), (&1.into(), &1.into()));
    assert_eq!(report["rules"]["boundary"], "edge-and-corner");
    assert_eq!(report["notes"].as_array().unwrap().len(), 2);

    let report = object(folder.path(), &["inspect", &fixture("cube.obj"), "--json", "--creasing", "chaikin"]);
    assert_eq!(report["creases"], serde_json::json!({ "edges": 4, "infinitely_sharp": 0 }));
    assert_eq!(report["corners"], serde_json::json!({ "vertices": 1, "infinitely_sharp": 1 }));
    assert_eq!(report["rules"]["creasing"], "chaikin");
    // With boundary `none` the faces that touch the boundary are left out, as OpenSubdiv tags them.
    let report = object(folder.path(), &["inspect", &sheet, "--json", "--boundary", "none"]);
    assert_eq!(report["faces_left_out"], 6);
}

#[test]
fn notes_go_to_stderr_unless_quiet() {
    let folder = scratch();
    let sheet = fixture("sheet.obj");
    let run = formwork(folder.path(), &["inspect", &sheet]);
    let stderr = String::from_utf8(run.stderr).unwrap();
    let expected = [
        "formwork: note: ignored: `l` (a line or point element), line 28",
        "formwork: note: ignored: `curv`, line 29",
    ];
    assert_eq!(stderr.lines().collect::<Vec<_>>(), expected);
    succeed(folder.path(), &["inspect", &sheet, "--quiet"]);
}

#[test]
fn collapse_mends_a_pole_and_says_so() {
    let folder = scratch();
    let pole = "v 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\n\
        f 1 1 2 3\nf 1 1 3 4\nf 1 1 4 5\nf 1 1 5 2\nf 5 4 3 2\nf 1 1 2 2\n";
    fs::write(folder.path().join("pole.obj"), pole).unwrap();
    assert_eq!(formwork(folder.path(), &["inspect", "pole.obj"]).status.code(), Some(2));
    let report = object(folder.path(), &["inspect", "pole.obj", "--collapse", "--json"]);
    assert_eq!(report["collapsed"], serde_json::json!({ "reduced": [0, 1, 2, 3], "removed": [5] }));
    assert_eq!(report["survey"]["faces"], 5);
    assert_eq!(
        report["notes"][0],
        "collapsed: 4 faces lost repeated vertices and 1 face with fewer than three left went; the faces after face 5 have lower numbers"
    );
}

#[test]
fn options_change_the_result_as_opensubdiv_defines_them() {
    let folder = scratch();
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    fs::write(folder.path().join("square.obj"), square).unwrap();
    let corner = |options: &[&str]| {
        let args = [&["subdivide", "square.obj", "--levels", "1", "-o", "out.json"], options].concat();
        succeed(folder.path(), &args);
        let mesh = json_file(&folder.path().join("out.json"));
        let next = mesh["face_vertices"][1].as_u64().unwrap() as usize;
        [0, next].map(|v| numbers(&mesh["positions"][v]))
    };
    assert_eq!(corner(&[]), [[0.125, 0.125, 0.0], [0.5, 0.0, 0.0]]);
    assert_eq!(corner(&["--boundary", "edge-and-corner"]), [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]]);
    // The face is turned round, and runs first along what was its last edge.
    assert_eq!(corner(&["--left-handed"]), [[0.125, 0.125, 0.0], [0.0, 0.5, 0.0]]);
}

#[test]
fn validate_prints_a_verdict() {
    let folder = scratch();
    let cube = fixture("cube.obj");
    let text = succeed(folder.path(), &["validate", &cube, "--levels", "2"]);
    let last = text.lines().last().unwrap();
    assert!(
        last.starts_with("Commutation d S = S d: worst deviation ") && last.ends_with("1e-12: OK"),
        "{last}"
    );
    let report =
        object(folder.path(), &["validate", &cube, "--levels", "2", "--json", "--doo-sabin", "original"]);
    assert_eq!(
        keys(&report),
        [
            "command",
            "holds",
            "levels",
            "limit",
            "limit_laws",
            "mesh",
            "notes",
            "scheme",
            "tolerance",
            "worst"
        ]
    );
    assert_eq!(report["holds"], true);
    assert_eq!(report["levels"].as_array().unwrap().len(), 2);
    assert!(report["worst"].as_f64().unwrap() <= 1e-12);
}

/// Every example in every help text, run as it stands but for where it writes.
#[test]
fn the_examples_in_the_help_run() {
    let folder = scratch();
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let mut examples = 0;
    for command in [
        &["--help"][..],
        &["inspect", "--help"],
        &["subdivide", "--help"],
        &["limit", "--help"],
        &["evaluate", "--help"],
        &["design", "--help"],
        &["decompose", "--help"],
        &["streamlines", "--help"],
        &["view", "--help"],
        &["operators", "--help"],
        &["solve", "--help"],
        &["masses", "--help"],
        &["validate", "--help"],
        &["study", "--help"],
        &["spectrum", "--help"],
        &["stencil", "--help"],
        &["charmap", "--help"],
        &["basis", "--help"],
        &["batch", "--help"],
        &["volume", "--help"],
        &["volume", "inspect", "--help"],
        &["volume", "subdivide", "--help"],
        &["volume", "validate", "--help"],
        &["volume", "slice", "--help"],
    ] {
        let help = succeed(&root, command).replace("\\\n", " ");
        let lines = help.lines().map(str::trim).filter(|line| line.starts_with("formwork "));
        for line in lines {
            let out = |word: &str| folder.path().join(word).display().to_string();
            let words: Vec<&str> = line.split_whitespace().skip(1).collect();
            let args: Vec<String> = words
                .iter()
                .enumerate()
                .map(|(i, word)| {
                    if i > 0 && ["-o", "--png"].contains(&words[i - 1]) {
                        out(word)
                    } else {
                        (*word).to_owned()
                    }
                })
                .collect();
            // A batch writes where its manifest says: in a copy of the assets.
            let place = if words[0] == "batch" { copy_of_assets(folder.path()) } else { root.clone() };
            let run = formwork(&place, &args.iter().map(String::as_str).collect::<Vec<_>>());
            assert!(run.status.success(), "{line}: {}", String::from_utf8_lossy(&run.stderr));
            examples += 1;
        }
    }
    assert!(examples >= 15, "{examples} examples found");
}

fn copy_of_assets(folder: &Path) -> PathBuf {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    fs::create_dir_all(folder.join("assets")).unwrap();
    for entry in fs::read_dir(root.join("assets")).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, folder.join("assets").join(path.file_name().unwrap())).unwrap();
    }
    folder.to_owned()
}

/// The default is Loop for triangles and Catmull-Clark for the rest; each scheme keeps its laws.
#[test]
fn schemes_are_chosen_by_name_or_by_the_mesh() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let scheme = |args: &[&str]| {
        let answer: Value = serde_json::from_str(&succeed(&root, args)).unwrap();
        answer["rules"]["scheme"].as_str().unwrap().to_owned()
    };
    assert_eq!(scheme(&["inspect", "assets/gem.obj", "--json"]), "loop");
    assert_eq!(scheme(&["inspect", "assets/torus.obj", "--json"]), "catmark");
    assert_eq!(scheme(&["inspect", "assets/gem.obj", "--scheme", "catmark", "--json"]), "catmark");
    for name in ["catmark", "loop", "modified-loop", "whitney", "bilinear"] {
        let table = succeed(&root, &["validate", "assets/gem.obj", "--scheme", name]);
        assert!(table.trim_end().ends_with("OK"), "{name}: {table}");
    }
    for rule in ["reflect", "thesis", "dct"] {
        succeed(&root, &["validate", "assets/gem.obj", "--half-box", rule, "-l", "1"]);
    }
    let folder = scratch();
    let out = folder.path().join("gem.npz").display().to_string();
    succeed(&root, &["operators", "assets/gem.obj", "--scheme", "modified-loop", "-o", &out]);
    let out = folder.path().join("gem.glb").display().to_string();
    succeed(&root, &["subdivide", "assets/gem.obj", "--scheme", "loop", "-o", &out]);

    let refused = formwork(&root, &["validate", "assets/torus.obj", "--scheme", "loop"]);
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2));
    assert!(message.contains("assets/torus.obj: line ") && message.contains("triangles only"), "{message}");
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let mut child = std::process::Command::new(cargo_bin("formwork"))
        .args(["validate", &fixture("cube.obj"), "--levels", "3"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let run = child.wait_with_output().unwrap();
    assert_eq!((run.status.code(), run.stderr.len()), (Some(0), 0));
}

#[test]
fn help_and_version_are_answers() {
    let folder = scratch();
    assert!(succeed(folder.path(), &["--help"]).contains("Exit codes: 0 fine, 2 "));
    assert_eq!(
        succeed(folder.path(), &["--version"]).trim(),
        format!("formwork {}", env!("CARGO_PKG_VERSION"))
    );
    assert_eq!(formwork(folder.path(), &[]).status.code(), Some(2));
}
