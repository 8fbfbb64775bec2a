//! `limit`, `subdivide --limit` and `evaluate`, by what they write.

mod common;

use std::fs;
use std::io::Read;
use std::path::Path;

use common::run::{fixture, json_file, numbers, object, scratch, succeed};
use formwork::cochain::Cochain;
use formwork::hierarchy::Hierarchy;
use formwork::io::{fields, obj};
use formwork::limit::Limit;
use formwork::scheme::Scheme;
use nalgebra::Vector3;
use serde_json::{Value, json};

fn vectors(value: &Value) -> Vec<Vector3<f64>> {
    value.as_array().unwrap().iter().map(|v| Vector3::from_iterator(numbers(v))).collect()
}

/// A field on the cube whose 1-form is the differential of its 0-form.
fn differential(folder: &Path) -> String {
    let cube = obj::read(Path::new(&fixture("cube.obj"))).unwrap();
    let hierarchy = Hierarchy::new(&cube.cage().unwrap(), Scheme::default(), 0).unwrap();
    let x = |v: u32| f64::from(v * v) * 0.1 - f64::from(v);
    let mesh = hierarchy.level(0).mesh();
    let edges: Vec<_> = mesh.edges().iter().map(|&[a, b]| json!([a, b, x(b) - x(a)])).collect();
    let vertices: Vec<_> = (0..8).map(|v| json!([v, x(v)])).collect();
    let path = folder.join("x.json");
    fs::write(&path, json!({"vertices": vertices, "edges": edges, "faces": [[0, 1.0]]}).to_string()).unwrap();
    path.display().to_string()
}

#[test]
fn what_limit_writes_is_the_librarys_limit() {
    let folder = scratch();
    let (cube, field) = (fixture("cube.obj"), fixture("cube.field.json"));
    let out = folder.path().join("out.json");
    succeed(folder.path(), &["limit", &cube, "--field", &field, "--level", "1", "-q", "-o", "out.json"]);
    let written = json_file(&out);

    let asset = obj::read(Path::new(&cube)).unwrap();
    let hierarchy = Hierarchy::new(&asset.cage().unwrap(), Scheme::default(), 1).unwrap();
    let mesh = hierarchy.finest().mesh();
    let forms = fields::read(Path::new(&field), hierarchy.level(0).mesh()).unwrap();
    let (limit, tangents) = Limit::with_tangents(&hierarchy, 1).unwrap();
    let x = hierarchy.subdivide(&asset.positions);
    let c: Cochain<1> = hierarchy.subdivide(&forms.form1.unwrap());
    assert_eq!(vectors(&written["positions"]), limit.apply(mesh, &x).into_values());
    assert_eq!(numbers(&written["form1"]), limit.apply(mesh, &c).into_values());
    let of_pairs = tangents.vectors(mesh, &x, &c);
    let mut bare = 0;
    for (corner, vector) in vectors(&written["corner_vectors"]).into_iter().enumerate() {
        match tangents.pair_of_corner(corner as u32) {
            Some(pair) => assert_eq!(vector, of_pairs[pair]),
            None => bare += 1,
        }
    }
    assert_eq!(bare, 3, "the cube has a sharp corner without sharp edges");
    let (normals, at_vertices) = (vectors(&written["normals"]), vectors(&written["vertex_vectors"]));
    let mut tangential = 0;
    for (normal, vector) in normals.iter().zip(&at_vertices) {
        assert!((normal.norm() - 1.0).abs() < 1e-14);
        tangential += usize::from(normal.dot(vector).abs() < 1e-12 * vector.norm().max(1.0));
    }
    assert_eq!(tangential, mesh.num_vertices() - 1);
    // The cube is symmetric: every normal points away from its centre.
    let positions = vectors(&written["positions"]);
    let centre = positions.iter().sum::<Vector3<f64>>() / positions.len() as f64;
    assert!(positions.iter().zip(&normals).all(|(x, normal)| (x - centre).dot(normal) > 0.0));
    assert!(written.get("face_vectors").is_none());
}

#[test]
fn limit_circulations_of_a_differential_are_differences() {
    let folder = scratch();
    let field = differential(folder.path());
    for level in ["0", "2"] {
        succeed(
            folder.path(),
            &["limit", &fixture("cube.obj"), "--field", &field, "--level", level, "-q", "-o", "out.json"],
        );
        let written = json_file(&folder.path().join("out.json"));
        let (x, c) = (numbers(&written["form0"]), numbers(&written["form1"]));
        for (edge, value) in written["edges"].as_array().unwrap().iter().zip(c) {
            let [a, b] = [0, 1].map(|end| edge[end].as_u64().unwrap() as usize);
            assert!((x[b] - x[a] - value).abs() < 1e-14);
        }
        let flux: f64 = numbers(&written["form2"]).iter().sum();
        assert!((flux - 1.0).abs() < 1e-13);
    }
}

/// The numbers of an array in an archive, whatever its shape.
fn array(path: &Path, name: &str) -> Vec<f64> {
    let mut npz = npyz::npz::NpzArchive::open(path).unwrap();
    let array = npz.by_name(name).unwrap().unwrap_or_else(|| panic!("no {name}"));
    array.into_vec::<f64>().unwrap()
}

#[test]
fn all_formats_say_the_same() {
    let folder = scratch();
    let (cube, field) = (fixture("cube.obj"), fixture("cube.field.json"));
    for name in ["out.json", "out.npz", "out.obj", "out.glb"] {
        succeed(folder.path(), &["limit", &cube, "--field", &field, "--level", "1", "-q", "-o", name]);
    }
    let path = |name: &str| folder.path().join(name);
    let written = json_file(&path("out.json"));
    for (key, name) in [
        ("positions", "positions"),
        ("normals", "normals"),
        ("form0", "values"),
        ("form1", "circulations"),
        ("form2", "fluxes"),
        ("vertex_vectors", "vertex_vectors"),
        ("corner_vectors", "corner_vectors"),
    ] {
        let flat: Vec<f64> = match &written[key][0] {
            Value::Array(_) => vectors(&written[key]).iter().flat_map(|v| [v.x, v.y, v.z]).collect(),
            _ => numbers(&written[key]),
        };
        assert_eq!(array(&path("out.npz"), name), flat, "{key}");
    }
    let mut text = String::new();
    fs::File::open(path("out.obj")).unwrap().read_to_string(&mut text).unwrap();
    let normals = text.lines().filter_map(|line| line.strip_prefix("vn "));
    let normals: Vec<Vector3<f64>> = normals
        .map(|line| Vector3::from_iterator(line.split(' ').map(|x| x.parse::<f64>().unwrap())))
        .collect();
    assert_eq!(normals, vectors(&written["normals"]));
    // subdivide --limit is the same thing.
    succeed(
        folder.path(),
        &["subdivide", &cube, "--field", &field, "-l", "1", "--limit", "-q", "-o", "same.glb"],
    );
    assert_eq!(fs::read(path("same.glb")).unwrap(), fs::read(path("out.glb")).unwrap());
}

#[test]
fn evaluate_says_what_the_surface_is() {
    let folder = scratch();
    let field = differential(folder.path());
    fs::write(folder.path().join("p.json"), r#"{"points": [[0, 0.25, 0.5], [5, 2, 0.1, 1], [3, 0, 0]]}"#)
        .unwrap();
    let cube = fixture("cube.obj");
    let report = object(
        folder.path(),
        &["evaluate", &cube, "--field", &field, "--points", "p.json", "-o", "out.json", "--json"],
    );
    assert_eq!(report["points"], 3);
    let written = json_file(&folder.path().join("out.json"));
    assert_eq!(written["points"], json!([[0, 0, 0.25, 0.5], [5, 2, 0.1, 1.0], [3, 0, 0.0, 0.0]]));
    let [s, t, v] = ["tangents_s", "tangents_t", "vector"].map(|key| vectors(&written[key]));
    for i in 0..3 {
        let components = numbers(&written["form1"][i]);
        assert!((v[i].dot(&s[i]) - components[0]).abs() < 1e-12);
        assert!((v[i].dot(&t[i]) - components[1]).abs() < 1e-12);
    }
    // A differential has no curl; at the irregular vertex that is not defined.
    assert!(written["curl"][0].as_f64().unwrap().abs() < 1e-12);
    assert!(written["curl"][2].is_null() && written["form2"][2].is_null());

    succeed(folder.path(), &["evaluate", &cube, "--field", &field, "--points", "p.json", "-o", "out.npz"]);
    let flat: Vec<f64> = vectors(&written["positions"]).iter().flat_map(|v| [v.x, v.y, v.z]).collect();
    assert_eq!(array(&folder.path().join("out.npz"), "positions"), flat);
    assert!(array(&folder.path().join("out.npz"), "curl")[2].is_nan());
}

#[test]
fn points_per_face() {
    let folder = scratch();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    // Polygons have points at every corner, triangles of Loop's schemes a grid of their own.
    for (asset, expected) in [("assets/open_polygons.obj", None), ("assets/gem.obj", Some(9))] {
        let mesh = root.join(asset).display().to_string();
        succeed(folder.path(), &["evaluate", &mesh, "--per-face", "3", "-o", "out.json"]);
        let written = json_file(&folder.path().join("out.json"));
        let asset = obj::read(Path::new(&mesh)).unwrap();
        let sizes = &asset.descriptor.face_sizes;
        let each = |&size: &u32| expected.unwrap_or(if size == 4 { 9 } else { 9 * size as usize });
        assert_eq!(written["positions"].as_array().unwrap().len(), sizes.iter().map(each).sum::<usize>());
        assert!(vectors(&written["positions"]).iter().all(|x| x.norm().is_finite()));
    }
}
