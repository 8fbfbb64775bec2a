//! glTF files of ours before Khronos' validator, and files of others read.

use std::fs;
use std::path::{Path, PathBuf};

use formwork::io::{LoadOptions, SaveOptions, Surface, fields::Fields, load, save};
use formwork::topology::Descriptor;
use nalgebra::Vector3;
use serde_json::{Value, json};

use crate::common::clients::{check_gltf, clients, root};
use crate::common::run::{formwork, scratch, succeed};

#[test]
fn every_file_is_valid() {
    let Some(clients) = clients() else { return };
    let folder = scratch();
    let mut files: Vec<PathBuf> = Vec::new();
    for name in ["creased_box", "open_polygons", "genus2", "high_valence", "fin", "torus", "gem"] {
        let field = format!("assets/{name}.field.json");
        for (levels, extension) in [("0", "glb"), ("1", "gltf"), ("2", "glb")] {
            let out = folder.path().join(format!("{name} {levels}.{extension}"));
            let mesh = format!("assets/{name}.obj");
            let mut args = vec!["subdivide", &mesh, "-q", "-l", levels, "-o", out.to_str().unwrap()];
            if root().join(&field).exists() {
                args.extend(["--field", &field, "--tangents"]);
            }
            succeed(root(), &args);
            files.push(out);
        }
    }
    let limit = folder.path().join("limit.glb");
    let field = "assets/creased_box.field.json";
    let args = ["limit", "assets/creased_box.obj", "--field", field, "-q", "-l", "1", "--tangents", "-o"];
    succeed(root(), &[&args[..], &[limit.to_str().unwrap()]].concat());
    files.push(limit);
    let files: Vec<&Path> = files.iter().map(|file| file.as_path()).collect();
    for report in check_gltf(clients, &files) {
        assert_eq!((&report["numErrors"], &report["numWarnings"]), (&json!(0), &json!(0)), "{report}");
    }
    // The validator must see what is wrong.
    let bad = folder.path().join("bad.gltf");
    let text = fs::read_to_string(files[1]).unwrap();
    fs::write(&bad, text.replacen("\"count\":", "\"count\":1", 1)).unwrap();
    assert_ne!(check_gltf(clients, &[&bad])[0]["numErrors"], 0);
}

/// A file of another program: two primitives, seams, a scale and a turn above, a point of another kind.
fn foreign(folder: &Path, change: impl Fn(&mut Value)) -> PathBuf {
    let corners: [[f32; 3]; 7] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        // The second primitive repeats two corners of the first.
        [1.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
        [2.0, 0.5, 1.0],
    ];
    let mut bytes: Vec<u8> = corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    bytes.extend([1u8, 2, 0, 0]);
    fs::write(folder.join("numbers 1.bin"), &bytes).unwrap();
    let view =
        |offset: usize, length: usize| json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
    let mut file = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [
            { "name": "above", "scale": [2, 2, 2], "children": [1, 2] },
            { "name": "body", "mesh": 0, "translation": [0, 0, 5] },
            { "name": "dust", "mesh": 1 },
        ],
        "meshes": [
            { "primitives": [
                { "attributes": { "POSITION": 0 }, "indices": 2 },
                { "attributes": { "POSITION": 1 }, "indices": 3, "mode": 4 },
                { "attributes": { "POSITION": 0 }, "mode": 0 },
            ] },
            { "primitives": [{ "attributes": { "POSITION": 0 }, "mode": 0 }] },
        ],
        "buffers": [{ "uri": "numbers%201.bin", "byteLength": bytes.len() }],
        "bufferViews": [view(0, 48), view(48, 36), view(84, 12), view(96, 3)],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3", "min": [1, 0, 0], "max": [2, 1, 1] },
            { "bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR" },
            { "bufferView": 3, "componentType": 5121, "count": 3, "type": "SCALAR" },
        ],
    });
    change(&mut file);
    let path = folder.join("foreign.gltf");
    fs::write(&path, file.to_string()).unwrap();
    path
}

#[test]
fn primitives_are_welded_and_placed() {
    let folder = scratch();
    let path = foreign(folder.path(), |_| ());
    let mut asset = load(&path, &LoadOptions::default()).unwrap();
    assert_eq!(asset.descriptor.face_vertices, [0, 1, 2, 0, 2, 3, 1, 4, 2]);
    assert_eq!((asset.positions.len(), asset.prim.as_deref(), asset.scheme), (5, None, None));
    assert_eq!(asset.notes, ["ignored: primitive 2 (points or lines)"]);
    asset.bake(formwork::io::Format::Obj);
    assert_eq!(asset.positions[4], Vector3::new(4.0, 1.0, 12.0));
    // Triangles are refined by Loop's scheme.
    let report = succeed(folder.path(), &["inspect", "foreign.gltf", "-q"]);
    assert!(report.contains("scheme loop"), "{report}");
}

#[test]
fn what_is_wrong_is_named() {
    let folder = scratch();
    let refused = |change: &dyn Fn(&mut Value), words: &[&str]| {
        foreign(folder.path(), change);
        let run = formwork(folder.path(), &["inspect", "foreign.gltf"]);
        let said = String::from_utf8(run.stderr).unwrap();
        assert_eq!((run.status.code(), said.lines().count()), (Some(2), 1), "{said}");
        assert!(words.iter().all(|word| said.contains(word)), "{words:?} in {said}");
    };
    refused(&|f| f["buffers"][0]["byteLength"] = json!(1000), &["buffer 0: has 100 bytes where 1000 belong"]);
    refused(
        &|f| f["accessors"][0]["count"] = json!(5),
        &["node 1 \"body\": primitive 0: accessor 0", "beyond"],
    );
    refused(&|f| f["accessors"][0]["count"] = json!(0), &["accessor 0"]);
    refused(&|f| f["accessors"][0]["count"] = json!(u64::MAX), &["accessor 0"]);
    refused(&|f| f["accessors"][2]["count"] = json!(5), &["primitive 0: has 5 indices"]);
    refused(
        &|f| f["accessors"][2]["componentType"] = json!(5126),
        &["accessor 2 has numbers of another kind"],
    );
    refused(&|f| f["bufferViews"][3]["byteOffset"] = json!(94), &["primitive 1: index 0 is 3"]);
    refused(&|f| f["bufferViews"][0]["buffer"] = json!(7), &["glTF: the reader refuses the file"]);
    refused(&|f| f["buffers"][0]["uri"] = json!("none.bin"), &["none.bin: no such file"]);
    refused(&|f| f["buffers"][0]["uri"] = json!("data:x;base64,!"), &["buffer 0: has a data URI"]);
    refused(&|f| f["buffers"][0]["uri"] = json!("http://x/y"), &["buffer 0: is at `http://x/y`"]);
    refused(&|f| f["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]), &["KHR_draco"]);
    refused(&|f| f["meshes"][1] = f["meshes"][0].clone(), &["choose one with --prim", "node 2 \"dust\""]);
    refused(&|f| f["meshes"][0] = f["meshes"][1].clone(), &["scene: has no node with triangles"]);
    // A node that is its own child does not go on for ever.
    foreign(folder.path(), |f| f["nodes"][1]["children"] = json!([0]));
    assert_eq!(formwork(folder.path(), &["inspect", "foreign.gltf", "-q"]).status.code(), Some(0));
    foreign(folder.path(), |f| f["meshes"][1] = f["meshes"][0].clone());
    for prim in ["dust", "2"] {
        let said = succeed(folder.path(), &["inspect", "foreign.gltf", "--prim", prim, "-q"]);
        assert!(said.contains("vertices      5"), "{said}");
    }
}

/// A 0-form and a tangent field as attributes, from a program that knows nothing of our extras.
#[test]
fn forms_are_read_from_attributes() {
    let folder = scratch();
    let square = Descriptor {
        num_vertices: 4,
        face_sizes: vec![3, 3],
        face_vertices: vec![0, 1, 2, 0, 2, 3],
        ..Default::default()
    };
    let mut asset = crate::load(&root().join("assets/gem.obj"));
    asset.descriptor = square;
    let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    asset.positions = formwork::cochain::Cochain::new(corners.map(Vector3::from).to_vec());
    let mesh = crate::level0(&asset);
    // dx + 3 dy: constant on the flat square, so that reading vectors gives the same circulations.
    let f = formwork::cochain::Cochain::<0>::new(corners.map(|p| p[0] + 3.0 * p[1]).to_vec());
    let fields = Fields { form1: Some(f.exterior_derivative(&mesh)), form0: Some(f), form2: None };
    let surface = Surface::new(0, &mesh, &asset.positions, &fields, &[false; 2]).unwrap();
    let path = folder.path().join("square.gltf");
    save(&path, &surface, SaveOptions::default()).unwrap();
    // Where the node stands does not matter to a 1-form.
    let mut text = fs::read_to_string(&path).unwrap().replace("\"formwork\"", "\"other\"");
    text = text.replacen("\"name\":\"surface\"", "\"scale\":[2,3,4],\"name\":\"surface\"", 2);
    fs::write(&path, text).unwrap();
    let mut read = crate::load(&path);
    read.bake(formwork::io::Format::Obj);
    assert_eq!(read.positions[2], Vector3::new(4.0, 3.0, 0.0));
    assert!(read.notes[1].contains("_FORM1"), "{:?}", read.notes);
    let read = crate::fields(&read);
    assert_eq!(read.form0, fields.form0);
    for (a, b) in read.form1.unwrap().values().iter().zip(fields.form1.unwrap().values()) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

/// Another program may move the triangles and keep our extras.
#[test]
fn extras_that_do_not_fit_are_not_used() {
    let folder = scratch();
    let path = folder.path().join("torus.gltf");
    succeed(root(), &["subdivide", "assets/torus.obj", "-l", "0", "-o", path.to_str().unwrap()]);
    assert_eq!(crate::load(&path).descriptor.face_sizes.len(), 128);
    let bin = folder.path().join("torus.bin");
    let mut bytes = fs::read(&bin).unwrap();
    let indices = 2 * 128 * 12; // positions and normals come first
    bytes[indices..indices + 12].rotate_left(4);
    fs::write(&bin, bytes).unwrap();
    let asset = crate::load(&path);
    assert_eq!(asset.descriptor.face_sizes.len(), 256);
    assert!(asset.notes[0].contains("the mesh was changed"), "{:?}", asset.notes);
}
