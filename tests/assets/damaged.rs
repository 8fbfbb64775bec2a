//! Files that are cut off, changed or nonsense: an error each time, no panic, no more memory than a good
//! file takes.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::clients::{clients, python, root};
use crate::common::run::{formwork, scratch, succeed};

/// The address space that reading a small file may take, in KiB: stacks of threads and the program itself are
/// most of it.
const ADDRESS_SPACE_KIB: u64 = 400 << 10;

/// A good file of each format: the mesh of `creased_box` with a form. The binary stages need Pixar's
/// library.
fn good_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for extension in ["obj", "json", "glb", "gltf", "usda"] {
        let out = folder.join(format!("good.{extension}"));
        let args =
            ["subdivide", "assets/creased_box.obj", "--field", "assets/creased_box.field.json", "-l", "0"];
        succeed(root(), &[&args[..], &["-o", out.to_str().unwrap()]].concat());
        files.push(out);
    }
    if let Some(clients) = clients() {
        for extension in ["usdc", "usdz"] {
            let out = folder.join(format!("good.{extension}"));
            let script = folder.join("turn.py");
            fs::write(
                &script,
                "import sys\nfrom pxr import Sdf, UsdUtils\na, b = sys.argv[1:]\n\
                 if b.endswith('usdz'): assert UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(a), b)\n\
                 else: assert Sdf.Layer.FindOrOpen(a).Export(b)\n",
            )
            .unwrap();
            let from = folder.join(if extension == "usdz" { "good.usdc" } else { "good.usda" });
            let run = python(clients, script.to_str().unwrap(), &[&from, &out]);
            assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
            files.push(out);
        }
    }
    files
}

/// Runs `formwork inspect FILE` with bounded memory and time; its exit code and what it said.
fn inspect(file: &Path) -> (Option<i32>, String) {
    let binary = assert_cmd::cargo::cargo_bin("formwork");
    let limits = format!("ulimit -v {ADDRESS_SPACE_KIB}; exec timeout 60 \"$0\" inspect \"$1\"");
    let run = Command::new("bash")
        .args(["-c", &limits])
        .args([&binary, file])
        .env("RAYON_NUM_THREADS", "2")
        .output()
        .unwrap();
    (run.status.code(), String::from_utf8_lossy(&run.stderr).into_owned())
}

#[track_caller]
fn assert_refused(file: &Path, what: &str) {
    let (code, said) = inspect(file);
    assert_eq!((code, said.lines().count()), (Some(2), 1), "{what}: {said}");
    assert!(said.starts_with("formwork: ") && !said.contains("panicked"), "{what}: {said}");
}

/// Each format, cut at 50 places.
#[test]
fn files_that_are_cut_off() {
    let folder = scratch();
    for good in good_files(folder.path()) {
        let (code, said) = inspect(&good);
        assert_eq!(code, Some(0), "{}: {said}", good.display());
        let bytes = fs::read(&good).unwrap();
        let extension = good.extension().unwrap().to_str().unwrap();
        let bad = folder.path().join(format!("bad.{extension}"));
        if extension == "gltf" {
            fs::copy(good.with_extension("bin"), bad.with_extension("bin")).unwrap();
        }
        // An OBJ has no end mark: cut between lines it may be a whole smaller mesh. Its faces refer to
        // vertices that come before, so it is cut within its vertices and in the middle of lines.
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let end = if extension == "obj" { text.find("\nf ").unwrap() } else { bytes.len() - 2 };
        for i in 0..50 {
            let cut = end * i / 50;
            fs::write(&bad, &bytes[..cut]).unwrap();
            assert_refused(&bad, &format!("{extension} cut at {cut} of {}", bytes.len()));
        }
        if extension == "gltf" {
            fs::write(&bad, text.replace("good.bin", "bad.bin")).unwrap();
            let numbers = fs::read(good.with_extension("bin")).unwrap();
            for i in 0..50 {
                fs::write(bad.with_extension("bin"), &numbers[..numbers.len() * i / 50]).unwrap();
                assert_refused(&bad, &format!("bin cut at {i}/50"));
            }
        }
    }
}

/// Bytes changed at random: an error or, where it only hit a number, a mesh; never anything else.
#[test]
fn files_with_changed_bytes() {
    let folder = scratch();
    let mut state = 1u64;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for good in good_files(folder.path()) {
        let bytes = fs::read(&good).unwrap();
        let extension = good.extension().unwrap().to_str().unwrap();
        let bad = folder.path().join(format!("bad.{extension}"));
        if extension == "gltf" {
            fs::copy(good.with_extension("bin"), bad.with_extension("bin")).unwrap();
        }
        // The tables of a binary stage are at its end, and a package has its directory there.
        let binary = extension.starts_with("usd") && extension != "usda";
        for round in 0..if binary { 150 } else { 40 } {
            let mut changed = bytes.clone();
            for _ in 0..1 + round % 4 {
                let at = match round % 3 {
                    0 if binary => bytes.len() - 1 - random(bytes.len().min(2000)),
                    _ => random(bytes.len()),
                };
                changed[at] = [0xff, 0x00, 0x80, random(256) as u8][random(4)];
            }
            fs::write(&bad, &changed).unwrap();
            let (code, said) = inspect(&bad);
            assert!(matches!(code, Some(0 | 2)), "{extension}, round {round}: {code:?} {said}");
            assert!(!said.contains("panicked"), "{extension}, round {round}: {said}");
            if code == Some(2) {
                let errors = said.lines().filter(|line| !line.starts_with("formwork: note: "));
                assert_eq!(errors.count(), 1, "{extension}, round {round}: {said}");
            }
        }
    }
}

/// Nonsense of special kinds.
#[test]
fn files_that_are_something_else() {
    let folder = scratch();
    let refused = |name: &str, bytes: &[u8], words: &str| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        let run = formwork(folder.path(), &["subdivide", name, "-o", "out.usda"]);
        let said = String::from_utf8(run.stderr).unwrap();
        assert_eq!((run.status.code(), said.lines().count()), (Some(2), 1), "{name}: {said}");
        assert!(said.contains(words), "{name}: {said}");
        assert!(!folder.path().join("out.usda").exists());
    };
    let usda = |body: &str| format!("#usda 1.0\n{body}").into_bytes();
    for name in ["a.usda", "a.usdc", "a.usdz", "a.usd"] {
        refused(name, b"", "is no USD file");
        refused(name, b"v 0 0 0\nf 1 2 3\n", "is no USD file");
    }
    refused("a.glb", b"#usda 1.0\n", "glTF: the reader refuses the file");
    refused("a.gltf", "[".repeat(100_000).as_bytes(), "glTF: the reader refuses the file");
    refused("a.json", "[".repeat(100_000).as_bytes(), "a.json: line 1, column ");
    refused("a.json", b"{\"edges\": [[0, 1, 2]]}", "this is not a mesh");
    refused("a.usda", &usda("def Mesh \"m\" {"), "is cut off");
    refused("a.usda", &usda(&"def \"a\" {\n".repeat(100_000)), "brackets are nested more than 256 deep");
    refused("a.usda", &usda("\u{fffd}"), "the USD reader refuses it");
    refused("a.usda", &[&usda("def \"m\" ")[..], b"\xff\xfe"].concat(), "the USD reader refuses it");
    refused("a.usda", &usda(""), "has no mesh: there is no surface");
    refused("a.usda", &usda("def \"m\" ( references = @x.usda@ ) {}\n"), "usdcat --flatten");
    refused("a.usdc", b"PXR-USDC\0\x08\0\0\0\0\0\0\xff\xff\xff\xff\xff\xff\xff\xff", "reach beyond the file");
    refused("a.usdc", b"PXR-USDC\0\x04\0\0\0\0\0\0\x20\0\0\0\0\0\0\0", "of version 0.4.0");
    refused("a.usdz", b"PK\x03\x04aaaaaaaa", "the package cannot be unpacked");

    let mesh = |attributes: &str| usda(&format!("def Mesh \"m\" {{\n{attributes}\n}}\n"));
    let square = "int[] faceVertexCounts = [4]\nint[] faceVertexIndices = [0, 1, 2, 3]\n\
        point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]\n";
    let with = |more: &str| mesh(&format!("{square}{more}"));
    refused("a.usda", &mesh("int[] faceVertexCounts = [4]"), "/m: faceVertexIndices is missing");
    refused("a.usda", &mesh(&square.replace(", 3]", ", -3]")), "/m: faceVertexIndices[3] is -3");
    refused("a.usda", &mesh(&square.replace(", 3]", ", 9]")), "a.usda: /m: face 0 refers to vertex 9");
    refused("a.usda", &mesh(&square.replace(", 3]", "]")), "/m: the faces ask for 4 vertex indices and 3");
    refused("a.usda", &mesh(&square.replace("(1, 1, 0)", "(1, inf, 0)")), "/m: points[2] is not finite");
    refused(
        "a.usda",
        &mesh(&square.replace("int[] faceVertexC", "float[] faceVertexC")),
        "not of type int[]",
    );
    refused(
        "a.usda",
        &with("int[] creaseIndices = [0, 1]\nint[] creaseLengths = [3]"),
        "creaseLengths add up",
    );
    refused("a.usda", &with("int[] creaseIndices = [0]\nint[] creaseLengths = [1]"), "creaseLengths[0] is 1");
    refused(
        "a.usda",
        &with("int[] creaseIndices = [0, 1]\nint[] creaseLengths = [2]\nfloat[] creaseSharpnesses = [1, 2]"),
        "creaseSharpnesses has 2 entries",
    );
    refused(
        "a.usda",
        &with("int[] creaseIndices = [0, 2]\nint[] creaseLengths = [2]\nfloat[] creaseSharpnesses = [1]"),
        "/m: crease 0 runs from vertex 0 to vertex 2, which no face has",
    );
    refused(
        "a.usda",
        &with("int[] cornerIndices = [0]"),
        "cornerIndices has 1 entries and cornerSharpnesses 0",
    );
    refused("a.usda", &with("int[] holeIndices = [1]"), "/m: hole 0 refers to face 1");
    refused(
        "a.usda",
        &with("uniform token subdivisionScheme = \"butterfly\""),
        "subdivisionScheme is `butterfly`",
    );
    refused("a.usda", &with("uniform token subdivisionScheme = \"loop\""), "triangles only");
    refused("a.usda", &with("uniform token orientation = \"left\""), "orientation is `left`");
    refused(
        "a.usda",
        &with("float[] primvars:form1 = [1, 2, 3, 4]"),
        "form1 has the interpolation `constant`",
    );
    refused(
        "a.usda",
        &with("float[] primvars:form1 = [1, 2, 3] ( interpolation = \"faceVarying\" )"),
        "/m: form1 has 3 values: give it 4",
    );
    refused(
        "a.usda",
        &with("uniform token[] xformOpOrder = [\"xformOp:twist\"]\ndouble xformOp:twist = 3"),
        "/m: xformOp:twist is no transform",
    );
    let moving = "int[] faceVertexIndices.timeSamples = { 1: [0, 1, 2, 3], 2: [1, 2, 3, 0] }\n";
    let changing = square.replace("int[] faceVertexIndices = [0, 1, 2, 3]\n", moving);
    refused("a.usda", &mesh(&changing), "faceVertexIndices changes with time");
}
