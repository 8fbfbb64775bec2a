//! From format to format and back: topology, tags and values are what they were.

use std::fs;
use std::path::Path;

use formwork::io::{Asset, fields};
use formwork::topology::Descriptor;

use crate::common::clients::root;
use crate::common::run::{scratch, succeed};
use crate::{level0, load};

const ASSETS: [&str; 7] = ["creased_box", "open_polygons", "genus2", "high_valence", "fin", "torus", "gem"];

/// Turns one format into another.
#[track_caller]
fn turn(folder: &Path, from: &str, to: &str, more: &[&str]) {
    let args = [&["subdivide", from, "-l", "0", "-q", "-o", to], more].concat();
    succeed(folder, &args);
}

fn single(x: f64) -> f64 {
    f64::from(x as f32)
}

/// Positions in 32 bits, topology and tags as they are.
#[track_caller]
fn assert_same(read: &Asset, given: &Asset, name: &str) {
    let mut expected: Descriptor = given.descriptor.clone();
    if expected.left_handed && !read.descriptor.left_handed {
        turn_faces(&mut expected);
    }
    assert_eq!(read.descriptor, expected, "{name}");
    let rounded = given.positions.values().iter().map(|p| p.map(single));
    assert!(read.positions.values().iter().map(|p| p.map(single)).eq(rounded), "{name}");
}

fn turn_faces(d: &mut Descriptor) {
    let mut rest = d.face_vertices.as_mut_slice();
    for &size in &d.face_sizes {
        let (face, tail) = rest.split_at_mut(size as usize);
        face[1..].reverse();
        rest = tail;
    }
    d.left_handed = false;
}

/// Random numbers on every cell, exact in 32 bits: a fields file.
fn field_of(asset: &Asset, folder: &Path) -> String {
    let mesh = level0(asset);
    let mut state = 7u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / 65536.0 - 128.0
    };
    let vertices: Vec<(usize, f64)> = (0..mesh.num_vertices()).map(|v| (v, next())).collect();
    let edges: Vec<(u32, u32, f64)> = mesh.edges().iter().map(|&[a, b]| (a, b, next())).collect();
    let faces: Vec<(usize, f64)> = (0..mesh.num_faces()).map(|f| (f, next())).collect();
    let text = serde_json::json!({ "vertices": vertices, "edges": edges, "faces": faces }).to_string();
    let path = folder.join("field.json");
    fs::write(&path, text).unwrap();
    path.display().to_string()
}

#[test]
fn obj_to_each_format_and_back() {
    let folder = scratch();
    for name in ASSETS {
        let obj = root().join(format!("assets/{name}.obj")).display().to_string();
        let given = load(Path::new(&obj));
        let field = field_of(&given, folder.path());
        let mesh = level0(&given);
        let values = fields::read(Path::new(&field), &mesh).unwrap();
        for extension in ["usda", "glb", "gltf", "json"] {
            let [first, second] = ["first", "second"].map(|n| format!("{n}.{extension}"));
            turn(folder.path(), &obj, &first, &["--field", &field]);
            turn(folder.path(), &first, &second, &[]);
            turn(folder.path(), &second, "back.obj", &[]);
            let at = |name: &str| folder.path().join(name);
            for file in [&first, &second] {
                let read = load(&at(file));
                assert_same(&read, &given, file);
                assert_eq!(crate::fields(&read), values, "{name}: {file}");
                assert_eq!(read.notes, [""; 0], "{name}: {file}");
            }
            let back = load(&at("back.obj"));
            assert_same(&back, &given, "back.obj");
            assert_eq!(fields::read(&at("back.fields.json"), &level0(&back)).unwrap(), values, "{name}");
        }
    }
}

/// A left-handed mesh with every tag, a transform and companions on its stage.
#[test]
fn usd_to_usd_and_back() {
    let folder = scratch();
    let scene = root().join("assets/scene.usda").display().to_string();
    let prim = ["--prim", "/Scene/Crate"];
    let read = |name: &str| {
        let options = formwork::io::LoadOptions { prim: Some(prim[1].to_owned()), ..Default::default() };
        formwork::io::load(&folder.path().join(name), &options).unwrap()
    };
    fs::copy(&scene, folder.path().join("scene.usda")).unwrap();
    let given = read("scene.usda");
    assert!(given.descriptor.left_handed && given.placement.is_some());
    let field = field_of(&given, folder.path());
    turn(folder.path(), "scene.usda", "one.usda", &[&prim[..], &["--field", &field]].concat());
    turn(folder.path(), "one.usda", "two.usda", &prim);
    let values = fields::read(Path::new(&field), &level0(&given)).unwrap();
    for name in ["one.usda", "two.usda"] {
        let read = read(name);
        assert_same(&read, &given, name);
        assert_eq!((read.scheme, read.placement), (given.scheme, given.placement));
        assert_eq!(crate::fields(&read), values, "{name}");
    }
    // Text that was written once is written the same again.
    let text = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(text("one.usda"), text("two.usda"));

    // Out of the stage: turned to counter-clockwise faces, in the space of the stage.
    turn(folder.path(), "one.usda", "out.obj", &prim);
    let out = load(&folder.path().join("out.obj"));
    let mut placed = given.clone();
    placed.bake(formwork::io::Format::Obj);
    assert_same(&out, &placed, "out.obj");
    assert!(placed.notes[0].starts_with("left behind in "), "{:?}", placed.notes);
    for what in ["primvars:st", "material:binding", "/Scene/Crate/lid", "4 other prims"] {
        assert!(placed.notes[0].contains(what), "{what} in {:?}", placed.notes);
    }
    let forms = fields::read(&folder.path().join("out.fields.json"), &level0(&out)).unwrap();
    assert_eq!((forms.form0, forms.form2), (values.form0.clone(), values.form2.clone()));
    let (before, after) = (level0(&given), level0(&out));
    for (e, &[a, b]) in before.edges().iter().enumerate() {
        let there = forms.form1.as_ref().unwrap().along(after.find_half_edge(a, b).unwrap());
        assert_eq!(there, values.form1.as_ref().unwrap()[e]);
    }
}

/// Refined meshes are written and read back too.
#[test]
fn refined_glb_to_glb() {
    let folder = scratch();
    let obj = root().join("assets/creased_box.obj").display().to_string();
    let field = root().join("assets/creased_box.field.json").display().to_string();
    succeed(folder.path(), &["subdivide", &obj, "--field", &field, "-l", "2", "-o", "a.glb"]);
    succeed(folder.path(), &["subdivide", &obj, "--field", &field, "-l", "2", "-o", "a.json"]);
    turn(folder.path(), "a.glb", "b.glb", &[]);
    let at = |name: &str| load(&folder.path().join(name));
    let (exact, a, b) = (at("a.json"), at("a.glb"), at("b.glb"));
    assert_same(&a, &exact, "a.glb");
    // What is read is a cage: it has no tags, and says so.
    assert_same(&b, &a, "b.glb");
    assert_eq!(crate::fields(&a), crate::fields(&exact));
    assert_eq!(crate::fields(&b), crate::fields(&exact));
}
