//! Every way to get it wrong ends in one clear line, exit code 2 and no file: the real binary is run on
//! each of these.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use assert_cmd::Command;

/// A cube: 8 vertices on lines 1 to 8, 6 faces on lines 9 to 14, 12 edges.
const CUBE: &str = "\
v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1
f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 7 8\n";

/// Runs `formwork ARGS` in a folder with these files; asserts that it complains in one line that has all
/// of `words` in it, and leaves the folder as it was.
#[track_caller]
fn refused(files: &[(&str, &[u8])], args: &[&str], words: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    for (name, contents) in files {
        fs::write(folder.path().join(name), contents).unwrap();
    }
    fs::create_dir(folder.path().join("folder")).unwrap();
    let before = listing(folder.path());
    let run = Command::cargo_bin("formwork").unwrap().args(args).current_dir(&folder).output().unwrap();
    let stderr = String::from_utf8(run.stderr).unwrap();
    let context = format!("formwork {}: {stderr}", args.join(" "));
    assert_eq!(run.status.code(), Some(2), "{context}");
    assert!(run.stdout.is_empty(), "{context}");
    assert_eq!(stderr.lines().count(), 1, "{context}");
    assert!(stderr.starts_with("formwork: ") && stderr.ends_with('\n'), "{context}");
    for word in words {
        assert!(stderr.contains(word), "no `{word}` in {context}");
    }
    assert_eq!(listing(folder.path()), before, "{context}");
    for (name, contents) in files {
        assert_eq!(fs::read(folder.path().join(name)).unwrap(), *contents, "{context}");
    }
}

fn listing(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

/// A mesh that every command must refuse alike; all are given a chance to write something.
#[track_caller]
fn bad_mesh(mesh: impl AsRef<[u8]>, words: &[&str]) {
    let mesh = mesh.as_ref();
    let mut words = words.to_vec();
    words.push("bad.obj: ");
    refused(&[("bad.obj", mesh)], &["subdivide", "bad.obj", "-o", "out.glb"], &words);
    refused(&[("bad.obj", mesh)], &["inspect", "bad.obj", "--json"], &words);
}

/// The cube with one line replaced or, beyond line 14, added.
fn cube_with(line: usize, text: &str) -> String {
    let mut lines: Vec<&str> = CUBE.lines().collect();
    match lines.get_mut(line - 1) {
        Some(old) => *old = text,
        None => lines.push(text),
    }
    lines.join("\n") + "\n"
}

#[track_caller]
fn bad_line(line: usize, text: &str, words: &[&str]) {
    let place = format!("bad.obj: line {line}: ");
    let words: Vec<&str> = words.iter().copied().chain([place.as_str()]).collect();
    bad_mesh(cube_with(line, text), &words);
}

#[track_caller]
fn bad_field(field: &str, words: &[&str]) {
    let words: Vec<&str> = words.iter().copied().chain(["field.json: "]).collect();
    let files = [("cube.obj", CUBE.as_bytes()), ("field.json", field.as_bytes())];
    for out in ["out.glb", "out.obj"] {
        refused(&files, &["subdivide", "cube.obj", "--field", "field.json", "-o", out], &words);
    }
}

#[track_caller]
fn bad_arguments(args: &[&str], words: &[&str]) {
    let field = "{\"edges\": [[0, 1, 1]]}";
    refused(&[("cube.obj", CUBE.as_bytes()), ("cube.fields.json", field.as_bytes())], args, words);
}

#[test]
fn files_that_are_no_mesh() {
    bad_arguments(&["inspect", "none.obj"], &["none.obj: no such file: check the path"]);
    bad_arguments(&["inspect", "folder"], &["folder: is a directory"]);
    bad_arguments(&["inspect", "cube.obj/x.obj"], &["cube.obj/x.obj: a part of the path is a file"]);
    bad_arguments(&["inspect", "a\nb.obj"], &["a\\nb.obj: no such file"]);
    bad_mesh("", &["the mesh has no vertices: give it some"]);
    bad_mesh("# nothing\n\n", &["no vertices"]);
    bad_mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\n", &["the mesh has no faces: "]);
    bad_mesh("solid cube\n  facet normal 0 0 1\n", &["no vertices"]);
    bad_mesh(b"glTF\x02\0\0\0", &["line 1: has a zero byte", "export the mesh as OBJ"]);
    let utf16: Vec<u8> = CUBE.encode_utf16().flat_map(u16::to_le_bytes).collect();
    bad_mesh([b"\xff\xfe", &utf16[..]].concat(), &["has a zero byte", "UTF-8"]);
}

#[test]
fn coordinates() {
    bad_line(3, "v 1 1", &["vertex 2 has 2 coordinates: write x, y and z"]);
    bad_line(3, "v", &["vertex 2 has 0 coordinates"]);
    bad_line(3, "v 1,5 1 0", &["vertex 2 has the coordinate `1,5`: write a decimal number"]);
    bad_line(3, "v 1 nan 0", &["vertex 2 has the coordinate NaN: coordinates must be finite"]);
    bad_line(3, "v 1 1 -inf", &["vertex 2 has the coordinate -inf"]);
    bad_line(3, "v 1 1e999 0", &["vertex 2 has the coordinate inf"]);
    bad_line(3, "v 1 \x1b[31m 0", &["`\\u{1b}[31m`"]);
}

#[test]
fn faces() {
    bad_line(12, "f 3 4 8 0", &["face 3 refers to vertex 0: OBJ counts vertices from 1"]);
    bad_line(12, "f 3 4 8 9", &["face 3 refers to vertex 9, but the file has 8", "correct the index"]);
    bad_line(12, "f 3 4 8 -9", &["face 3 refers to vertex -9 (counted back), but only 8 come before"]);
    bad_line(12, "f 3 4 8 1000000000", &["face 3 refers to vertex 1000000000,"]);
    bad_line(12, "f 3 4 8 99999999999999999999", &["face 3 refers to vertex 99999999999999999999,"]);
    bad_line(12, "f 3 4 8 -99999999999999999999", &["face 3 refers to vertex -99999999999999999999"]);
    bad_line(
        12,
        &format!("f 3 4 8 {}", "9".repeat(100_000)),
        &["face 3 refers to vertex 99999999999999999999..."],
    );
    bad_line(12, "f 3 4 8 seven", &["face 3 refers to `seven`, which is not a vertex index"]);
    bad_line(12, "f 3 4 //8 7", &["face 3 refers to `//8`"]);
    bad_line(12, "f 3 4", &["face 3 has 2 vertices: a face needs at least 3"]);
    bad_line(12, "f 3", &["face 3 has 1 vertices"]);
    bad_line(12, "f", &["face 3 has 0 vertices"]);
    bad_line(12, "f 3 4 4 8", &["face 3 has vertex 3 more than once", "--collapse"]);
    bad_line(12, "f 3 4 8 3 7", &["face 3 has vertex 2 more than once"]);
    // The last line of a file that was cut off.
    bad_mesh(CUBE.trim_end().trim_end_matches(" 7 8"), &["bad.obj: line 14: face 5 has 2 vertices"]);
    // --collapse does not hide what is not a collapsed face.
    for face in ["f 3 4 8 3 7", "f 3 4"] {
        let mesh = cube_with(12, face);
        refused(
            &[("bad.obj", mesh.as_bytes())],
            &["inspect", "--collapse", "bad.obj"],
            &["bad.obj: line 12: face 3 has "],
        );
    }
    let polygon: String = (1..=65_536).map(|i| format!("v {i} 0 0\n")).collect();
    let face: String = (1..=65_536).map(|i| format!(" {i}")).collect();
    bad_mesh(format!("{polygon}f{face}\n"), &["line 65537: face 0 has 65536 vertices", "at most 65535"]);
}

#[test]
fn tags() {
    bad_line(15, "t crease 2/1/0 0 2 2", &["crease 0 runs from vertex 0 to vertex 2, which no face has"]);
    bad_line(15, "t crease 2/1/0 0 8 2", &["crease 0 refers to vertex 8, but there are 8"]);
    bad_line(15, "t crease 4/2/0 0 1 1 2 2 -1", &["crease 1 has sharpness -1: it must be a number"]);
    bad_line(15, "t crease 2/1/0 0 1 nan", &["crease 0 has sharpness NaN"]);
    bad_line(15, "t crease 2/1/0 0 1 1e99", &["crease 0 has sharpness inf"]);
    bad_line(15, "t crease 2/1/0 0 1", &["tag `crease` promises 3 values and has 2"]);
    bad_line(15, "t crease 2/1/0 0 1 2 3 4", &["tag `crease` promises 3 values and has 5"]);
    bad_line(15, "t crease 4294967295/4294967295/4294967295 0", &["promises 12884901885 values and has 1"]);
    bad_line(15, "t crease 99999999999/1/0 0 1 2", &["tag `crease` has the counts `99999999999/1/0`"]);
    bad_line(15, "t crease -2/1/0 0 1 2", &["tag `crease` has the counts `-2/1/0`"]);
    bad_line(15, "t crease 3/1/0 0 1 2 2", &["tag `crease` has 3 integers", "it takes pairs of vertices"]);
    bad_line(15, "t corner 1/1/0 8 2", &["corner 0 refers to vertex 8"]);
    bad_line(15, "t corner 1/1/0 -1 2", &["tag `corner` has the value `-1` where an index from 0"]);
    bad_line(15, "t hole 2/0/0 0 6", &["hole 1 refers to face 6, but there are 6"]);
    bad_line(15, "t hole 1/0/0 4294967296", &["tag `hole` has the value `4294967296`"]);
    bad_line(
        15,
        "t interpolateboundary 1/0/0 7",
        &["tag `interpolateboundary` says 7: it takes one integer"],
    );
    bad_line(15, "t creasemethod 0/0/1 soft", &["says `soft`: it takes one word: normal or chaikin"]);
    bad_line(15, "t smoothtriangles 0/0/0", &["tag `smoothtriangles` has no values"]);
    bad_line(15, "t", &["the tag has no name"]);
}

#[test]
fn fields() {
    let edge = |entry: &str| format!("{{\"edges\": [[0, 1, 1], {entry}]}}");
    bad_field(&edge("[0, 2, 0.5]"), &["edges[1] = [0,2,0.5]: no edge joins vertices 0 and 2"]);
    bad_field(&edge("[1, 1, 0.5]"), &["edges[1] = [1,1,0.5]: no edge joins"]);
    bad_field(
        &edge("[1, 0, 2]"),
        &["edges[1] = [1,0,2]: the edge between 1 and 0 has a value already, from entry 0"],
    );
    bad_field(
        &edge("[0, 8, 1]"),
        &["edges[1] = [0,8,1]: 8 is not the index of a vertex, of which there are 8"],
    );
    bad_field(&edge("[-1, 0, 1]"), &["-1 is not the index of a vertex"]);
    bad_field(&edge("[1.0, 0, 1]"), &["1.0 is not the index of a vertex"]);
    bad_field(&edge("[99999999999999999999, 0, 1]"), &["is not the index of a vertex"]);
    bad_field(&edge("[1, 2]"), &["edges[1] = [1,2]: an entry is [a, b, value], three numbers"]);
    bad_field(&edge("[1, 2, 3, 4]"), &["edges[1]", "three numbers"]);
    bad_field(&edge("[1, 2, \"3\"]"), &["edges[1] = [1,2,\"3\"]: an entry is"]);
    bad_field(&edge("[1, 2, null]"), &["edges[1]", "three numbers"]);
    bad_field(&edge("7"), &["edges[1] = 7: an entry is"]);
    bad_field(&edge("[1, 2, NaN]"), &["line 1, column ", "NaN"]);
    bad_field(&edge("[1, 2, 1e999]"), &["line 1, column ", "number out of range"]);
    bad_field(&format!("{{\"edges\": [{:?}]}}", "x".repeat(5000)), &["edges[0] = ", "..."]);
    bad_field("{\"vertices\": [[8, 1]]}", &["vertices[0] = [8,1]: 8 is not the index of a vertex"]);
    bad_field(
        "{\"vertices\": [[2, 1], [3, 1], [2, 1]]}",
        &["vertices[2] = [2,1]: vertex 2 has a value already"],
    );
    bad_field(
        "{\"faces\": [[6, 1]]}",
        &["faces[0] = [6,1]: 6 is not the index of a face, of which there are 6"],
    );
    bad_field("{\"faces\": [[0, 1, 2]]}", &["faces[0]", "two numbers"]);
    bad_field("{\"edge\": []}", &["unknown field `edge`"]);
    bad_field("{\"edges\": [], \"edges\": []}", &["duplicate field `edges`"]);
    bad_field("{\"edges\": 3}", &["line 1, column ", "expected a sequence"]);
    bad_field("{}", &["holds no form: give it \"edges\""]);
    bad_field("{\"edges\": null}", &["holds no form"]);
    bad_field("[[0, 1, 2]]", &["line 1, column "]);
    bad_field("", &["line 1, column 0: EOF"]);
    bad_field("{\"edges\": [[0, 1, 1]", &["line 1, column ", "EOF"]);
    bad_field(&"[".repeat(100_000), &["line 1, column "]);
    bad_arguments(
        &["subdivide", "cube.obj", "--field", "none.json", "-o", "a.glb"],
        &["none.json: no such file"],
    );
    bad_arguments(
        &["subdivide", "cube.obj", "--field", "folder", "-o", "a.glb"],
        &["folder: is a directory"],
    );
}

#[test]
fn points() {
    let bad = |points: &str, words: &[&str]| {
        let files: [(&str, &[u8]); 2] = [("cube.obj", CUBE.as_bytes()), ("p.json", points.as_bytes())];
        refused(&files, &["evaluate", "cube.obj", "--points", "p.json", "-o", "out.npz"], words);
    };
    bad("{", &["p.json: line 1", "write {\"points\""]);
    bad(r#"{"points": [[0, 0.5]]}"#, &["p.json: points[0] = `[0,0.5]`", "correct it"]);
    bad(r#"{"points": [[0, 0, 0], [6, 0, 0]]}"#, &["p.json: points[1]: there is no face 6", "0 to 5"]);
    bad(r#"{"points": [[0, 4, 0, 0]]}"#, &["p.json: points[0]: face 0 has no corner 4"]);
    bad(r#"{"points": [[0, 1.5, 0]]}"#, &["p.json: points[0]: (s, t) = (1.5, 0) is outside face 0"]);
    let pentagon = "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5\n";
    let files: [(&str, &[u8]); 2] =
        [("p.obj", pentagon.as_bytes()), ("p.json", br#"{"points": [[0, 0.5, 0.5]]}"#)];
    let words = ["p.json: points[0]: face 0 has 5 corners", "write [0, corner, s, t]"];
    refused(&files, &["evaluate", "p.obj", "--points", "p.json", "-o", "out.json"], &words);
}

#[test]
fn outputs() {
    let refuse = |out: &str, words: &[&str]| {
        bad_arguments(&["subdivide", "cube.obj", "--field", "cube.fields.json", "-o", out], words);
    };
    refuse(
        "out.stl",
        &["out.stl: has the extension .stl", "choose .obj, .json, .glb, .gltf, .usda, .usd, .npz"],
    );
    refuse("out", &["out: has no extension", "choose .obj, .json, .glb, .gltf, .usda, .usd"]);
    refuse("cube.obj", &["cube.obj: the output would replace the input cube.obj: choose another name"]);
    refuse("out.usdc", &["out.usdc: has the extension .usdc, which is not written here", "usdcat"]);
    refuse("folder/../cube.obj", &["would replace the input cube.obj"]);
    refuse("cube.fields.json", &["would replace the input cube.fields.json"]);
    refuse("none/out.glb", &["none/out.glb: its directory does not exist: create it first"]);
    refuse("cube.obj/out.glb", &["cube.obj/out.glb: a part of the path is a file"]);
    // The second file of `-o X.obj` counts too.
    let files = [("cage.obj", CUBE.as_bytes()), ("cube.fields.json", b"{\"faces\": [[0, 1]]}")];
    refused(
        &files,
        &["subdivide", "cage.obj", "--field", "cube.fields.json", "-o", "cube.obj"],
        &["cube.fields.json: the output would replace the input cube.fields.json"],
    );
    bad_arguments(&["operators", "cube.obj", "-o", "out.glb"], &["has the extension .glb", "choose .npz"]);
    bad_arguments(&["operators", "cube.obj", "-o", "none/out.npz"], &["its directory does not exist"]);
}

#[test]
fn an_output_that_is_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cube.obj"), CUBE).unwrap();
    fs::create_dir(folder.path().join("out.glb")).unwrap();
    let mut command = Command::cargo_bin("formwork").unwrap();
    let run = command.args(["subdivide", "cube.obj", "-o", "out.glb"]).current_dir(&folder).output().unwrap();
    let stderr = String::from_utf8(run.stderr).unwrap();
    assert_eq!(
        (run.status.code(), stderr.as_str()),
        (Some(2), "formwork: out.glb: is a directory: name a file in it\n")
    );
    assert_eq!(listing(&folder.path().join("out.glb")).len(), 0);
    assert_eq!(listing(folder.path()).len(), 2);
}

#[test]
fn arguments() {
    let out = ["-o", "out.glb"];
    let subdivide = |more: &[&'static str]| [&["subdivide", "cube.obj"], &out[..], more].concat();
    bad_arguments(&subdivide(&["--levels", "99"]), &["'99'", "--levels", "0..=15"]);
    bad_arguments(&subdivide(&["--levels", "-1"]), &["-1", "--help"]);
    bad_arguments(&subdivide(&["--levels", "two"]), &["'two'", "--levels"]);
    bad_arguments(&subdivide(&["--prim", "/A"]), &["cube.obj: --prim: a file of this format holds one mesh"]);
    bad_arguments(&subdivide(&["--frames", "all"]), &["cube.obj: --frames: only USD files have frames"]);
    bad_arguments(&subdivide(&["--frames", "1-2"]), &["'1-2'", "--frames", "1:24"]);
    bad_arguments(&["inspect", "cube.stl"], &["cube.stl: no such file"]);
    bad_arguments(&["inspect", "cube.fields.json"], &["cube.fields.json: line 1, column ", "not a mesh"]);
    bad_arguments(&subdivide(&["--boundary", "open"]), &["'open'", "none, edge-only, edge-and-corner"]);
    bad_arguments(&subdivide(&["--fields", "x"]), &["'--fields'", "'--field'"]);
    bad_arguments(&["subdivide", "cube.obj"], &["--output <OUT>", "--help"]);
    bad_arguments(&["validate", "cube.obj", "--levels", "0"], &["1..=15"]);
    bad_arguments(
        &["operators", "cube.obj", "--scheme", "sqrt3", "-o", "a.npz"],
        &["'sqrt3'", "catmark", "modified-loop"],
    );
    bad_arguments(&["refine", "cube.obj"], &["'refine'"]);
    bad_arguments(&["inspect"], &["<MESH>"]);
    bad_arguments(&["inspect", "cube.obj", "other.obj"], &["'other.obj'"]);
}

#[test]
fn what_does_not_fit() {
    for args in [
        &["subdivide", "cube.obj", "--levels", "15", "-o", "out.glb"][..],
        &["operators", "cube.obj", "--levels", "15", "-o", "out.npz"],
        &["validate", "cube.obj", "--levels", "15", "--json"],
    ] {
        bad_arguments(args, &["level 15 is too large", "ask for fewer levels"]);
    }
    let huge = CUBE.replace("v 1 1 1", "v 1 1 1e300");
    let subdivide = |out| ["subdivide", "bad.obj", "-o", out];
    refused(
        &[("bad.obj", huge.as_bytes())],
        &subdivide("out.glb"),
        &["out.glb: a value is too large for the 32-bit"],
    );
    // The largest differences that there are, and beyond.
    let stretch = |line: &str| match line.starts_with('v') {
        true => line.replace('0', "-1.7e308").replace(" 1", " 1.7e308") + "\n",
        false => line.to_owned() + "\n",
    };
    let overflowing: String = CUBE.lines().map(stretch).collect();
    refused(
        &[("bad.obj", overflowing.as_bytes())],
        &subdivide("out.json"),
        &["the position of vertex", "is not finite after refinement", "scale the input down"],
    );
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nt interpolateboundary 1/0/0 0\n";
    for out in ["out.glb", "out.json", "out.obj"] {
        refused(
            &[("bad.obj", square.as_bytes())],
            &["subdivide", "bad.obj", "--levels", "1", "-o", out],
            &["no face is left to write", "boundary rule"],
        );
    }
}

#[test]
fn what_cannot_be_shown() {
    let cube: &[(&str, &[u8])] = &[("cube.obj", CUBE.as_bytes())];
    refused(cube, &["view", "cube.obj"], &["--output", "--png"]);
    refused(cube, &["view", "cube.obj", "-o", "cube.htm"], &["cube.htm", ".htm", "choose .html"]);
    refused(cube, &["view", "cube.obj", "--png", "cube.jpg"], &["cube.jpg", "choose .png"]);
    refused(cube, &["view", "cube.obj", "--png", "folder/none/cube.png"], &["folder/none/cube.png"]);
    refused(
        cube,
        &["view", "cube.obj", "-o", "c.html", "--form", "1"],
        &["cube.obj", "no 1-form", "give one"],
    );
    refused(cube, &["view", "cube.obj", "-o", "c.html", "--form", "3"], &["3", "--form"]);
    refused(cube, &["view", "cube.obj", "-o", "c.html", "--show", "hair"], &["hair", "strokes"]);
    refused(cube, &["view", "cube.obj", "-o", "c.html", "--levels", "14"], &["cube.obj"]);
    for size in ["800", "0x10", "800x", "-1x20", "5000x5000", "99999999999x16"] {
        let size = format!("--size={size}");
        refused(cube, &["view", "cube.obj", "--png", "c.png", &size], &["--size", "1400x1000"]);
    }
    refused(cube, &["view", "cube.obj", "-o", "c.html", "--balance"], &["--spec"]);
    refused(cube, &["view", "cube.obj", "-o", "c.html", "--spec", "none.json"], &["none.json"]);
    refused(
        cube,
        &["view", "cube.obj", "-o", "c.html", "--field", "a", "--spec", "b"],
        &["--field", "--spec"],
    );
    let spec: &[(&str, &[u8])] =
        &[("cube.obj", CUBE.as_bytes()), ("s.json", b"{\"vortices\": [{\"face\": 2, \"strength\": 1}]}")];
    refused(
        spec,
        &["view", "cube.obj", "-o", "c.html", "--spec", "s.json"],
        &["s.json", "vortices", "balance"],
    );
    let hole: &[(&str, &[u8])] =
        &[("hole.obj", b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nt hole 1/0/0 0\n")];
    refused(hole, &["view", "hole.obj", "-o", "c.html"], &["hole.obj", "holes"]);
    let far: &[(&str, &[u8])] =
        &[("far.obj", b"v 1e308 0 0\nv -1e308 0 0\nv 1e308 1e308 0\nv 0 -1e308 0\nf 1 2 3 4\n")];
    refused(far, &["view", "far.obj", "-o", "c.html"], &["far.obj"]);
}
