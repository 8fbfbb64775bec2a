//! `formwork solve`: what it says and writes, and how it refuses.

mod common;

use std::fs;

use common::meshes::hexagonal_torus;
use common::run::{formwork, json_file, numbers, object, scratch, succeed};
use serde_json::json;

fn asset(name: &str) -> String {
    format!("{}/assets/{name}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn eigenforms_are_counted_and_shown() {
    let folder = scratch();
    let problem = asset("eigenforms.problem.json");
    let args = ["solve", &asset("torus.obj"), "--problem", &problem, "--level", "0", "-o", "eigen.json"];
    let report = object(folder.path(), &[&args[..], &["--json"]].concat());
    assert_eq!((&report["zeros"], &report["betti"], &report["shown"]), (&2.into(), &2.into(), &2.into()));
    let values = numbers(&report["eigenvalues"]);
    assert!(values.len() == 6 && values.windows(2).all(|w| w[0] <= w[1]) && values[2] > 0.01, "{values:?}");
    assert_eq!(report["forms"], json!([1]));
    let text = succeed(folder.path(), &args);
    assert!(text.contains("of which 2 are 0 (Betti number 2)") && text.contains("shown"), "{text}");
    let written = json_file(&folder.path().join("eigen.json"));
    assert!(written["edges"].as_array().is_some_and(|edges| !edges.is_empty()), "{written}");
}

#[test]
fn solutions_report_what_they_are() {
    let folder = scratch();
    let args = [
        "solve",
        &asset("genus2.obj"),
        "--problem",
        &asset("genus2.problem.json"),
        "--field",
        &asset("genus2.field.json"),
        "--level",
        "0",
        "-o",
        "w.json",
        "--json",
    ];
    let report = object(folder.path(), &args);
    assert!(report["residual"].as_f64().unwrap() < 1e-10, "{report}");
    // The angle round a window is closed and goes round it.
    let aside = numbers(&report["harmonic_part"]);
    assert!(aside.len() == 4 && aside.iter().any(|x| x.abs() > 0.01), "{aside:?}");
    assert!(report["condition"].as_f64().unwrap() > 1.0);

    let mut args = args.map(str::to_owned);
    args[3] = asset("diffusion.problem.json");
    let report = object(folder.path(), &args.each_ref().map(|x| x.as_str()));
    let norm = |key: &str| report["norm"][key].as_f64().unwrap();
    assert!(norm("after") < norm("before") && norm("after") > 0.0, "{report}");
}

/// Poisson's problem by factors and by conjugate gradients.
#[test]
fn solvers_agree() {
    let folder = scratch();
    let vertices =
        fs::read_to_string(asset("genus2.obj")).unwrap().lines().filter(|l| l.starts_with("v ")).count();
    let data: Vec<(usize, f64)> = (0..vertices).map(|i| (i, 1.0 + (i as f64).sin())).collect();
    fs::write(folder.path().join("f.json"), json!({ "vertices": data }).to_string()).unwrap();
    let solve = |solver: &str| {
        fs::write(folder.path().join("p.json"), json!({"problem": "poisson", "solver": solver}).to_string())
            .unwrap();
        let output = format!("{solver}.json");
        let genus2 = asset("genus2.obj");
        let args = [
            "solve",
            &genus2,
            "--problem",
            "p.json",
            "--field",
            "f.json",
            "--level",
            "0",
            "-o",
            &output,
            "--json",
        ];
        let report = object(folder.path(), &args);
        assert!(report["residual"].as_f64().unwrap() < 1e-11, "{report}");
        assert!(report["condition"].as_f64().unwrap() > 10.0, "{report}");
        let aside = numbers(&report["harmonic_part"]);
        assert!(aside.len() == 1, "{report}");
        let written = json_file(&folder.path().join(output));
        (aside[0].abs(), numbers(&written["form0"]))
    };
    let ((a, direct), (b, iterated)) = (solve("direct"), solve("iterative"));
    assert!((a - b).abs() < 1e-10 * a, "{a} {b}");
    let most = direct.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let off = direct.iter().zip(&iterated).fold(0.0f64, |off, (a, b)| off.max((a - b).abs()));
    assert!(direct.len() == vertices && most > 0.1 && off < 1e-9 * most, "{off:e} {most}");
}

/// Regular triangles, whose edge and face forms are dependent.
#[test]
fn dependent_bases_are_solved_with() {
    let folder = scratch();
    let d = hexagonal_torus(7, 6);
    let turn = |i: u32, n: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
    let mut obj = String::new();
    for v in 0..42 {
        let (a, b) = (turn(v % 7, 7), turn(v / 7, 6));
        let r = 3.0 + b.cos();
        obj += &format!("v {} {} {}\n", r * a.cos(), r * a.sin(), b.sin());
    }
    for face in d.face_vertices.chunks_exact(3) {
        obj += &format!("f {} {} {}\n", face[0] + 1, face[1] + 1, face[2] + 1);
    }
    fs::write(folder.path().join("torus.obj"), obj).unwrap();
    for (degree, zeros) in [(0, 1), (1, 2), (2, 1)] {
        let problem = json!({"problem": "eigenforms", "degree": degree, "count": 4});
        fs::write(folder.path().join("p.json"), problem.to_string()).unwrap();
        for level in ["0", "1"] {
            let args = ["--scheme", "loop", "--level", level, "-o", "out.json", "--json"];
            let args = [&["solve", "torus.obj", "--problem", "p.json"], &args[..]].concat();
            let report = object(folder.path(), &args);
            assert_eq!(
                (&report["zeros"], &report["betti"]),
                (&zeros.into(), &zeros.into()),
                "{degree}: {report}"
            );
        }
    }
}

#[test]
fn bad_problems_are_told_in_one_line() {
    let folder = scratch();
    let torus = asset("torus.obj");
    let cases = [
        ("{\"problem\": \"plateau\"}", "unknown variant `plateau`"),
        ("{\"problem\": \"poisson\",}", "line 1, column 23"),
        (
            "{\"problem\": \"diffusion\", \"degree\": 0, \"solver\": \"iterative\"}",
            "\"solver\": belongs to another",
        ),
        ("{\"problem\": \"poisson\", \"degree\": 1}", "ask for hodge-laplace"),
        ("{\"problem\": \"hodge-laplace\"}", "\"degree\": is missing"),
        ("{\"problem\": \"hodge-laplace\", \"degree\": 3}", "degree 0, 1 and 2"),
        ("{\"problem\": \"hodge-laplace\", \"degree\": 1, \"count\": 2}", "\"count\": belongs to another"),
        ("{\"problem\": \"eigenforms\", \"degree\": 1, \"count\": 0}", "from 1 to 200"),
        ("{\"problem\": \"eigenforms\", \"degree\": 1, \"count\": 2, \"show\": 2}", "below \"count\""),
        ("{\"problem\": \"diffusion\", \"degree\": 1}", "\"step\": is missing"),
        ("{\"problem\": \"diffusion\", \"degree\": 1, \"step\": -1}", "positive"),
        ("{\"problem\": \"poisson\"}", "there is no 0-form to work on"),
    ];
    for (spec, words) in cases {
        fs::write(folder.path().join("p.json"), spec).unwrap();
        let run = formwork(folder.path(), &["solve", &torus, "--problem", "p.json", "-o", "out.json"]);
        let message = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(2), "{spec}: {message}");
        assert!(message.contains(words) && message.trim_end().lines().count() == 1, "{spec}: {message}");
        assert!(!folder.path().join("out.json").exists());
    }
}
