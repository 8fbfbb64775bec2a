//! Solids from files and to files: Gmsh and VTK, with meshio on the other side.

use std::fs;
use std::path::Path;

use formwork::cochain::Cochain;
use formwork::io::volume::{self, forms};
use formwork::octet::{Solid, to_grid};

use super::common::clients::{clients, python, root};
use super::common::random;
use super::common::run::{formwork, object, scratch, succeed};

fn asset(name: &str) -> std::path::PathBuf {
    root().join("assets").join(name)
}

fn solid(path: &Path) -> Solid {
    Solid::from_grid(volume::load(path).unwrap()).unwrap()
}

/// A file that is read has the cells it shows, all positive; octahedra come in pairs of pyramids.
#[test]
fn assets_are_read() {
    let ball = solid(&asset("ball.msh"));
    assert_eq!([0, 3].map(|r| ball.complex.num_cells(r)), [125, 384]);
    assert!(ball.notes.is_empty());
    let octets = solid(&asset("octets.vtu"));
    assert_eq!((octets.complex.tets().len(), octets.complex.octs().len()), (8, 1));
    let fields = octets.fields(&octets.forms).unwrap();
    assert_eq!(fields.degrees(), [0, 3]);
    // The octahedron has the sum of its pyramids.
    let expected = (8f64.cos() * 1e4).round() / 1e4 + (9f64.cos() * 1e4).round() / 1e4;
    assert!((fields.form3.unwrap()[8] - expected).abs() < 1e-12);
}

/// What is written is read again: the complex, and all forms to the last digit.
#[test]
fn vtu_round_trip() {
    let folder = scratch();
    let octets = solid(&asset("octets.vtu"));
    let complex = &octets.complex;
    let values = |r: usize| random(complex.num_cells(r), 40 + r as u64);
    let fields = formwork::octet::SolidFields {
        form0: Some(Cochain::new(values(0))),
        form1: Some(Cochain::new(values(1))),
        form2: Some(Cochain::new(values(2))),
        form3: Some(Cochain::new(values(3))),
    };
    let path = folder.path().join("all.vtu");
    volume::save(&path, to_grid(complex, &octets.positions, &fields)).unwrap();
    let again = solid(&path);
    assert_eq!(&again.complex, complex);
    assert_eq!(again.positions, octets.positions);
    assert_eq!(again.fields(&again.forms).unwrap(), fields);
}

/// meshio's own files, every kind that it writes, are read; what we write opens in meshio with its data.
#[test]
fn meshio_agrees() {
    let Some(clients) = clients() else { return };
    let folder = scratch();
    let run = python(clients, "tests/clients/volume_write.py", &[folder.path()]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let first = solid(&folder.path().join("vtu_binary.vtu"));
    for name in [
        "vtu_ascii.vtu",
        "vtu_plain.vtu",
        "msh4_ascii.msh",
        "msh4_binary.msh",
        "msh2_ascii.msh",
        "msh2_binary.msh",
    ] {
        let other = solid(&folder.path().join(name));
        assert_eq!(other.complex, first.complex, "{name}");
        let worst =
            first.positions.values().iter().zip(other.positions.values()).map(|(a, b)| (a - b).norm());
        assert!(worst.fold(0.0, f64::max) < 1e-9, "{name}");
    }
    assert_eq!(first.forms.vertices.as_ref().unwrap().len(), first.complex.num_cells(0));
    // One that cannot be read says so in a line.
    let lzma = volume::load(&folder.path().join("vtu_lzma.vtu")).unwrap_err().to_string();
    assert!(lzma.contains("vtu_lzma.vtu") && lzma.contains("uncompressed or with zlib"), "{lzma}");

    let ours = folder.path().join("ours.vtu");
    let (ball, field) = (asset("ball.msh"), asset("ball.field.json"));
    let args = [
        "volume",
        "subdivide",
        ball.to_str().unwrap(),
        "--field",
        field.to_str().unwrap(),
        "-l",
        "1",
        "-o",
        "ours.vtu",
    ];
    let report = object(folder.path(), &[&args[..], &["--json"]].concat());
    let read = python(clients, "tests/clients/volume_read.py", &[&ours]);
    assert!(read.status.success(), "{}", String::from_utf8_lossy(&read.stderr));
    let found: serde_json::Value = serde_json::from_slice(&read.stdout).unwrap();
    assert_eq!(found["points"], report["vertices"]);
    assert_eq!(found["cells"]["line"], report["edges"]);
    assert_eq!(found["cells"]["tetra"], report["tetrahedra"]);
    assert_eq!(found["cells"]["pyramid"], 2 * report["octahedra"].as_u64().unwrap());
    assert_eq!(found["finite"]["form1"], serde_json::json!({ "line": report["edges"] }));
    let vectors = &found["finite"]["form1Vector"];
    assert_eq!(
        (&vectors["tetra"], &vectors["pyramid"]),
        (&found["cells"]["tetra"], &found["cells"]["pyramid"])
    );
    // The sum of the circulations, as numpy adds them.
    let solid = self::solid(&ball);
    let fields = solid.fields(&forms::read(&field).unwrap()).unwrap();
    let fine = formwork::octet::Linear::default().refine(&solid.complex, &fields.form1.unwrap());
    let sum: f64 = fine.values().iter().sum();
    assert!((found["sum"].as_f64().unwrap() - sum).abs() < 1e-9);
}

#[test]
fn damaged_files_are_refused_in_one_line() {
    let folder = scratch();
    let text = fs::read_to_string(asset("octets.vtu")).unwrap();
    let cases: [(&str, String, &str); 12] = [
        ("cut.vtu", text[..600].to_owned(), "cut.vtu: "),
        ("kind.vtu", text.replace("10 10 10", "12 10 10"), "Hexahedron"),
        ("point.vtu", text.replace("0 0 0 0 0 2", "0 0 nan 0 0 2"), "point 0"),
        ("lonely.vtu", text.replace("NumberOfCells=\"10\"", "NumberOfCells=\"9\""), "lonely.vtu: "),
        ("solid.stl", "solid".into(), "choose .msh, .vtu"),
        ("flat.msh", msh(&["0 0 0", "1 0 0", "0 1 0", "1 1 0"], &["1 2 3 4"]), "cell 0 is flat"),
        (
            "twice.msh",
            msh(&["0 0 0", "1 0 0", "0 1 0", "0 0 1"], &["1 2 3 4", "2 3 4 1"]),
            "cell 1 has the vertices of cell 0",
        ),
        ("same.msh", msh(&["0 0 0", "1 0 0", "0 1 0", "0 0 1"], &["1 2 3 3"]), "names vertex 2 twice"),
        ("none.msh", msh(&["0 0 0"], &[]), "holds no tetrahedra"),
        (
            "crowd.msh",
            msh(&["0 0 0", "1 0 0", "0 1 0", "0 0 1", "0 0 2", "0 0 -1"], &["1 2 3 4", "1 2 3 5", "1 3 2 6"]),
            "has more than two cells",
        ),
        ("old.msh", "$MeshFormat\n1 0 8\n".into(), "write it as version 4.1 or 2.2"),
        ("empty.msh", String::new(), "is no Gmsh file"),
    ];
    for (name, contents, words) in cases {
        fs::write(folder.path().join(name), contents).unwrap();
        let run = formwork(folder.path(), &["volume", "subdivide", name, "-o", "out.vtu"]);
        let stderr = String::from_utf8(run.stderr).unwrap();
        assert_eq!((run.status.code(), stderr.lines().count()), (Some(2), 1), "{name}: {stderr}");
        assert!(stderr.contains(words) && stderr.starts_with("formwork: "), "{name}: {stderr}");
        assert!(!folder.path().join("out.vtu").exists());
    }
}

fn msh(points: &[&str], tets: &[&str]) -> String {
    let nodes: String = points.iter().zip(1..).map(|(p, i)| format!("{i} {p}\n")).collect();
    let elements: String = tets.iter().zip(1..).map(|(t, i)| format!("{i} 4 2 0 1 {t}\n")).collect();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n{nodes}$EndNodes\n$Elements\n{}\n{elements}$EndElements\n",
        points.len(),
        tets.len()
    )
}

#[test]
fn forms_that_do_not_fit_are_named() {
    let folder = scratch();
    let ball = asset("ball.msh");
    for (text, words) in [
        ("{\"edges\": [[0, 1, 1.0], [0, 124, 2.0]]}", "edges, entry 1: [0, 124] is no edge"),
        ("{\"edges\": [[0, 1, 1.0], [1, 0, 2.0]]}", "the same edge is listed twice"),
        ("{\"triangles\": [[0, 1, 900, 1.0]]}", "is no triangle"),
        ("{\"cells\": [[384, 1.0]]}", "is no cell"),
        ("{\"vertices\": [[125, 1.0]]}", "is no vertex"),
        ("{\"edges\": [[0, 1]]}", "line 1, column"),
        ("{\"faces\": [[0, 1]]}", "unknown field `faces`"),
        ("{}", "holds no form"),
    ] {
        fs::write(folder.path().join("f.json"), text).unwrap();
        let args = ["volume", "subdivide", ball.to_str().unwrap(), "--field", "f.json", "-o", "out.vtu"];
        let run = formwork(folder.path(), &args);
        let stderr = String::from_utf8(run.stderr).unwrap();
        assert_eq!((run.status.code(), stderr.lines().count()), (Some(2), 1), "{stderr}");
        assert!(stderr.contains(words) && stderr.contains("f.json"), "{words}: {stderr}");
    }
    let run = formwork(folder.path(), &["volume", "slice", ball.to_str().unwrap(), "-o", "a.png"]);
    assert!(String::from_utf8(run.stderr).unwrap().contains("give one with --field"));
}

/// The commands say what they did.
#[test]
fn volume_commands() {
    let root = root();
    let report = object(root, &["volume", "inspect", "assets/ball.msh", "--json"]);
    assert_eq!((&report["tetrahedra"], &report["euler_characteristic"]), (&384.into(), &1.into()));
    let text = succeed(root, &["volume", "validate", "assets/octets.vtu", "--smooth", "-l", "2"]);
    let last = text.lines().last().unwrap();
    assert!(
        last.starts_with("Commutation d S = S d: worst deviation ") && last.ends_with("1e-12: OK"),
        "{text}"
    );
    let folder = scratch();
    let out = folder.path().join("slice.png");
    let args = [
        "volume",
        "slice",
        "assets/ball.msh",
        "--field",
        "assets/ball.field.json",
        "-l",
        "1",
        "--size",
        "128",
        "-o",
    ];
    let report = object(root, &[&args[..], &[out.to_str().unwrap(), "--json"]].concat());
    // The ball covers about pi/4 of the picture, 5 % of whose width are left free.
    let part = report["pixels"].as_f64().unwrap() / (128.0 * 128.0);
    assert!((0.6..0.8).contains(&part), "{part}");
    let picture = tiny_skia::Pixmap::load_png(&out).unwrap();
    let colours: std::collections::BTreeSet<[u8; 3]> =
        picture.pixels().iter().map(|p| [p.red(), p.green(), p.blue()]).collect();
    assert!(picture.width() == 128 && colours.len() > 500, "{} colours", colours.len());
    let bad = formwork(root, &["volume", "validate", "assets/octets.vtu", "--c", "3.5"]);
    assert_eq!(bad.status.code(), Some(2));
    assert!(String::from_utf8(bad.stderr).unwrap().contains("from -7 to 1"));
}
