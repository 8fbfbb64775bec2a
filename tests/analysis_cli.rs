//! `spectrum`, `stencil`, `charmap` and `basis` as a user runs them.

mod common;

use std::fs;

use common::run::{formwork, object, scratch, succeed};

#[test]
fn spectrum_says_what_is_exact() {
    let folder = scratch();
    let report = object(folder.path(), &["spectrum", "--scheme", "modified-loop", "-k", "7", "--json"]);
    assert_eq!(report["cells"], serde_json::json!([22, 49, 28]));
    assert_eq!(report["s1_counts"], serde_json::json!({ "exact": 21, "faces": 28, "rest": 0 }));
    let subdominant = &report["s0"][1];
    assert!((subdominant["value"].as_f64().unwrap() - 0.5).abs() < 1e-14);
    assert_eq!((&subdominant["mode"], &subdominant["multiplicity"]), (&1.into(), &2.into()));
    let total = |list: &str| -> u64 {
        report[list].as_array().unwrap().iter().map(|e| e["multiplicity"].as_u64().unwrap()).sum()
    };
    assert_eq!([total("s0"), total("s1"), total("s2")], [22, 49, 28]);

    let text = succeed(folder.path(), &["spectrum", "--scheme", "catmark", "--valence", "5"]);
    for line in
        ["0.5499883545           x 2    mode 1\n", "x 5    modes 0-2, exact", "30 exact, 20 of faces, 0 rest"]
    {
        assert!(text.contains(line), "no `{line}` in {text}");
    }
    let text = succeed(folder.path(), &["spectrum", "--scheme", "loop", "--valence", "4", "--boundary"]);
    assert!(text.contains("defective: ") && text.contains("x 1    odd"), "{text}");
}

/// The published regular stencils, times 32 and 64.
#[test]
fn stencils_are_rows_of_the_operators() {
    let folder = scratch();
    let weights = |args: &[&str], factor: f64| -> Vec<f64> {
        let report = object(folder.path(), &[&["stencil", "--json"], args].concat());
        let terms = report["terms"].as_array().unwrap();
        terms.iter().map(|t| (t["weight"].as_f64().unwrap() * factor * 1e4).round() / 1e4).collect()
    };
    let even = weights(&["--scheme", "loop", "-k", "6", "--edge", "0-1"], 32.0);
    assert_eq!(even, [8.0, 2.0, -1.0, -2.0, -1.0, 2.0, -1.0, -1.0, 1.0, 1.0]);
    let against = weights(&["--scheme", "loop", "-k", "6", "--edge", "1-0"], 32.0);
    assert_eq!(against, even.iter().map(|w| -w).collect::<Vec<_>>());
    let mut even = weights(&["--scheme", "catmark", "-k", "4", "--edge", "0-1"], 64.0);
    even.sort_by(f64::total_cmp);
    assert_eq!(even, [-6.0, -1.0, -1.0, 3.0, 3.0, 18.0]);
    let mut face = weights(&["--scheme", "catmark", "-k", "4", "--degree", "2"], 64.0);
    face.sort_by(f64::total_cmp);
    assert_eq!(face, [1.0, 3.0, 3.0, 9.0]);
    let text = succeed(folder.path(), &["stencil", "--scheme", "loop", "-k", "6", "--edge", "0-1"]);
    assert!(text.starts_with("loop, valence 6: row of S1 of edge 0-1, times 32\n"), "{text}");
}

#[test]
fn charmaps_are_reported_one_by_one() {
    let folder = scratch();
    let report =
        object(folder.path(), &["charmap", "--scheme", "catmark", "-k", "3:6", "--samples", "16", "--json"]);
    let maps = report["maps"].as_array().unwrap();
    assert_eq!(maps.len(), 4);
    for map in maps {
        assert_eq!(map["injective_as_sampled"], true);
        let k = map["valence"].as_u64().unwrap();
        assert_eq!(map["samples"].as_u64().unwrap(), k * (17 * 17 - 8 * 8));
    }
    // A valence without a map does not hide the others.
    let args = ["charmap", "--boundary", "-k", "3:5", "--samples", "8"];
    let run = formwork(folder.path(), &args);
    let (out, notes) = (String::from_utf8(run.stdout).unwrap(), String::from_utf8(run.stderr).unwrap());
    assert_eq!(run.status.code(), Some(0));
    assert!(notes.starts_with("formwork: note: valence 4: there is no characteristic map"), "{notes}");
    assert!(out.contains("yes, as sampled") && out.trim_end().ends_with("no"), "{out}");
}

#[test]
fn pictures_are_complete_files() {
    let folder = scratch();
    for args in [
        &["charmap", "--scheme", "loop", "-k", "5"][..],
        &["basis", "--scheme", "catmark", "-k", "3", "--edge", "1-0"],
        &["basis", "--scheme", "modified-loop", "-k", "4", "--degree", "2", "--boundary"],
        &["stencil", "--scheme", "catmark", "-k", "5", "--degree", "0"],
    ] {
        for name in ["a.svg", "a.PNG"] {
            succeed(folder.path(), &[args, &["-o", name]].concat());
            let file = fs::read(folder.path().join(name)).unwrap();
            if name == "a.svg" {
                let text = String::from_utf8(file).unwrap();
                assert!(text.starts_with("<svg xmlns") && text.ends_with("</svg>\n"), "{args:?}");
                assert!(!text.contains("NaN") && !text.contains("inf"), "{args:?}");
                assert!(text.contains("<path d=\"M") && text.contains("</text>"), "{args:?}");
            } else {
                let picture = tiny_skia::Pixmap::decode_png(&file).unwrap();
                let dark = picture.pixels().iter().filter(|p| p.red() < 128).count();
                assert!(dark > 500, "{args:?}: {dark} dark pixels");
            }
        }
    }
    // The form of an edge read backwards has the opposite sign.
    let range = |edge: &str| {
        let args = ["basis", "--scheme", "loop", "-k", "5", "--edge", edge, "-o", "b.svg", "--json"];
        let report = object(folder.path(), &args);
        [0, 1].map(|i| report["parts"][0]["range"][i].as_f64().unwrap())
    };
    let ([a, b], [c, d]) = (range("0-1"), range("1-0"));
    assert_eq!([a, b], [-d, -c]);
    assert!(b > 0.3);
}

#[test]
fn what_cannot_be_drawn_is_one_line() {
    let folder = scratch();
    for (args, words) in [
        (&["spectrum", "-k", "2"][..], "from 3 to 64 faces"),
        (&["spectrum", "-k", "65"], "65"),
        (&["charmap", "-k", "7:3"], "write one number from 1 to 64, or two as 3:16"),
        (&["charmap", "-k", "5", "-o", "a.jpg"], "a.jpg: has the extension .jpg"),
        (&["charmap", "-k", "4", "--boundary"], "no characteristic map"),
        (&["basis", "-k", "5", "-o", "a.svg", "--edge", "0-99"], "--edge 0-99: there is no such edge"),
        (&["basis", "-k", "5", "-o", "a.svg", "--edge", "x"], "write the numbers of its two vertices as 0-1"),
        (
            &["basis", "-k", "5", "-o", "a.svg", "--degree", "0", "--edge", "0-1"],
            "--edge names a cell of degree 1",
        ),
        (&["stencil", "-k", "5", "--degree", "2", "--cell", "20"], "choose 0 to 19"),
        (&["stencil", "-k", "5", "-o", "there/is/none.svg"], "there/is/none.svg"),
    ] {
        let run = formwork(folder.path(), args);
        let message = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(2), "{args:?}: {message}");
        assert!(message.contains(words) && message.lines().count() == 1, "{args:?}: {message}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is written");
}
