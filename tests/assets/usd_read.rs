//! Stages that Pixar's library wrote, read back.

use std::fs;
use std::path::{Path, PathBuf};

use formwork::hierarchy::Hierarchy;
use formwork::io::{Frames, LoadOptions, load};
use formwork::osd::{OsdScheme, Refiner};
use formwork::scheme::Scheme;
use formwork::sparse::max_difference;
use formwork::topology::{BoundaryInterpolation, Cage, Corner, Crease, Descriptor, TriangleSubdivision};
use nalgebra::Matrix4;
use serde_json::{Value, json};

use crate::common::SAME_WEIGHTS;
use crate::common::clients::{clients, python};
use crate::common::meshes::{cut_grid, grid};
use crate::common::run::scratch;
use crate::common::shapes::shapes;

/// A cage of polygons with every tag that USD knows.
fn tagged() -> Descriptor {
    let mut d = cut_grid(5, 4, false, &[7, 1, 7, 7, 2, 7, 3, 7, 7, 1, 7, 7, 7, 0, 7, 7, 2, 7, 7, 7]);
    let edge = |d: &Descriptor, corner: usize| [d.face_vertices[corner], d.face_vertices[corner + 1]];
    d.creases = vec![
        Crease { vertices: edge(&d, 0), sharpness: 2.5 },
        Crease { vertices: edge(&d, 1), sharpness: 0.75 },
        Crease { vertices: edge(&d, 12), sharpness: 10.0 },
    ];
    d.corners = vec![Corner { vertex: 7, sharpness: 1.25 }, Corner { vertex: 0, sharpness: 10.0 }];
    d.holes = vec![3, 8];
    d.boundary = BoundaryInterpolation::EdgeOnly;
    d.triangles = TriangleSubdivision::Smooth;
    d
}

/// Positions that no two vertices share, exact in 32 bits.
fn points(d: &Descriptor, time: f64) -> Vec<[f64; 3]> {
    (0..d.num_vertices).map(|v| [v as f64, (v * v % 7) as f64 / 4.0, time * v as f64 / 8.0]).collect()
}

/// The mesh as `usd_write.py` wants it.
fn describe(path: &str, d: &Descriptor, frames: &[f64]) -> Value {
    json!({
        "path": path,
        "frames": frames.iter().map(|&time| points(d, time)).collect::<Vec<_>>(),
        "face_sizes": d.face_sizes,
        "face_vertices": d.face_vertices,
        "creases": d.creases.iter().map(|c| (c.vertices[0], c.vertices[1], c.sharpness)).collect::<Vec<_>>(),
        "corners": d.corners.iter().map(|c| (c.vertex, c.sharpness)).collect::<Vec<_>>(),
        "holes": d.holes,
        "left_handed": d.left_handed,
        "boundary": match d.boundary {
            BoundaryInterpolation::None => "none",
            BoundaryInterpolation::EdgeOnly => "edge-only",
            BoundaryInterpolation::EdgeAndCorner => "edge-and-corner",
        },
        "triangles": if d.triangles == TriangleSubdivision::Smooth { "smooth" } else { "catmark" },
    })
}

/// Has Pixar's library write a stage.
fn write(clients: &Path, folder: &Path, name: &str, stage: &Value) -> PathBuf {
    let (spec, out) = (folder.join("stage.json"), folder.join(name));
    fs::write(&spec, stage.to_string()).unwrap();
    let run = python(clients, "tests/clients/usd_write.py", &[&spec, &out]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    out
}

/// S0 of each of two levels against OpenSubdiv, which is fed what went to Pixar's library.
fn assert_same_surface(read: &Cage, fed: &Descriptor, name: &str) {
    let fed = Cage::new(fed.clone()).unwrap();
    let hierarchy = Hierarchy::new(read, Scheme::default(), 2).unwrap();
    let mut refiner = Refiner::new(&fed, OsdScheme::Catmark).unwrap();
    refiner.refine_uniform(2).unwrap();
    for level in 1..=2 {
        let difference = max_difference(&hierarchy.operators(level).s0, &refiner.stencils(level).unwrap());
        assert!(difference <= SAME_WEIGHTS, "{name}, level {level}: {difference}");
    }
}

#[test]
fn every_tag_in_each_kind_of_file() {
    let Some(clients) = clients() else { return };
    let folder = scratch();
    for left_handed in [false, true] {
        let d = Descriptor { left_handed, ..tagged() };
        for extension in ["usda", "usdc", "usdz"] {
            let name = format!("stage{}.{extension}", u8::from(left_handed));
            let stage = json!({ "meshes": [describe("/World/Mesh", &d, &[1.0])] });
            let asset = load(&write(clients, folder.path(), &name, &stage), &LoadOptions::default()).unwrap();
            assert_eq!(asset.descriptor, d, "{name}");
            assert_eq!(
                (asset.prim.as_deref(), asset.scheme),
                (Some("/World/Mesh"), Some(OsdScheme::Catmark))
            );
            let read: Vec<[f64; 3]> = asset.positions.values().iter().map(|&p| p.into()).collect();
            assert_eq!(read, points(&d, 1.0), "{name}");
            assert_eq!(asset.notes, [""; 0], "{name}");
            assert_same_surface(&asset.cage().unwrap(), &d, &name);
        }
    }
}

/// OpenSubdiv's own regression shapes, through a stage.
#[test]
fn the_shapes_of_opensubdiv() {
    let (Some(clients), Some(shapes)) = (clients(), shapes("catmark")) else { return };
    let folder = scratch();
    // USD has one way for creases to decay.
    let shapes: Vec<_> = shapes.iter().filter(|shape| !shape.name.contains("chaikin")).collect();
    let meshes: Vec<Value> = shapes
        .iter()
        .map(|shape| describe(&format!("/World/{}", shape.name), &shape.descriptor(), &[1.0]))
        .collect();
    let path = write(clients, folder.path(), "shapes.usdc", &json!({ "meshes": meshes }));
    for shape in &shapes {
        let prim = Some(format!("/World/{}", shape.name));
        let asset = load(&path, &LoadOptions { prim, ..Default::default() }).unwrap();
        // Where two creases meet, the script joins them to one chain; the edges are the same.
        assert_eq!(asset.descriptor, shape.descriptor(), "{}", shape.name);
        if let Ok(cage) = asset.cage() {
            assert_same_surface(&cage, &shape.descriptor(), &shape.name);
        }
    }
    assert!(shapes.len() > 50);
}

#[test]
fn two_meshes_and_three_frames() {
    let Some(clients) = clients() else { return };
    let folder = scratch();
    let (still, moving) = (tagged(), grid(3, 2, false));
    let meshes =
        [describe("/World/Still", &still, &[1.0]), describe("/World/Moving", &moving, &[1.0, 2.0, 4.0])];
    let path = write(clients, folder.path(), "two.usdc", &json!({ "meshes": meshes }));

    let message = load(&path, &LoadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("two.usdc: stage: has several meshes"), "{message}");
    assert!(message.contains("--prim: /World/Still, /World/Moving"), "{message}");
    let read = |prim: &str, frames| {
        load(&path, &LoadOptions { prim: Some(prim.to_owned()), frames }).map_err(|error| error.to_string())
    };
    assert_eq!(read("/World/Still", Frames::Rest).unwrap().descriptor, still);
    let message = read("/World/None", Frames::Rest).unwrap_err();
    assert!(message.contains("--prim `/World/None`: is no mesh of this stage"), "{message}");
    let message = read("/World/Still", Frames::All).unwrap_err();
    assert!(message.contains("points has no time samples"), "{message}");

    let at = |time: f64| points(&moving, time);
    let same = |positions: &formwork::io::Positions, expected: Vec<[f64; 3]>| {
        assert_eq!(positions.values().iter().map(|&p| p.into()).collect::<Vec<[f64; 3]>>(), expected);
    };
    let all = read("/World/Moving", Frames::All).unwrap();
    assert_eq!(all.frames.iter().map(|f| f.time).collect::<Vec<_>>(), [1.0, 2.0, 3.0]);
    for (frame, height) in all.frames.iter().zip([1.0, 2.0, 4.0]) {
        same(&frame.positions, at(height));
    }
    let range = read("/World/Moving", Frames::Range(2.0, 9.0)).unwrap();
    assert_eq!(range.frames.len(), 2);
    same(&range.positions, at(2.0));
    // Halfway between the second and the third sample.
    same(&read("/World/Moving", Frames::At(2.5)).unwrap().positions, at(3.0));
    let rest = read("/World/Moving", Frames::Rest).unwrap();
    same(&rest.positions, at(1.0));
    assert!(rest.notes[0].contains("/World/Moving moves"), "{:?}", rest.notes);
}

/// The transforms of a prim, by Pixar's own arithmetic: the world matrix of the reference is asked of it.
#[test]
fn transforms_place_the_mesh() {
    let Some(clients) = clients() else { return };
    let folder = scratch();
    let mut mesh = describe("/World/Mesh", &grid(2, 2, false), &[1.0]);
    mesh["xform"] = json!([
        ["translate", [1.0, 2.0, 3.0]],
        ["rotateXYZ", [10.0, 20.0, 30.0]],
        ["rotateZXY", [-40.0, 15.0, 5.0]],
        ["orient", [0.5, 0.1, -0.3, 0.2]],
        ["rotateY", 35.0],
        ["scale", [1.0, -2.0, 0.5]],
        ["transform", [[1, 0.25, 0, 0], [0, 1, 0, 0], [0.5, 0, 1, 0], [7, 8, 9, 1]]],
    ]);
    let path = write(clients, folder.path(), "placed.usda", &json!({ "meshes": [mesh] }));
    let script = folder.path().join("world.py");
    fs::write(
        &script,
        "import sys, json\nfrom pxr import Usd, UsdGeom\nstage = Usd.Stage.Open(sys.argv[1])\n\
         m = UsdGeom.XformCache().GetLocalToWorldTransform(stage.GetPrimAtPath('/World/Mesh'))\n\
         print(json.dumps([x for row in m for x in row]))\n",
    )
    .unwrap();
    let run = python(clients, script.to_str().unwrap(), &[&path]);
    let theirs: Vec<f64> = serde_json::from_slice(&run.stdout).unwrap();
    let theirs = Matrix4::from_column_slice(&theirs);
    let mut asset = load(&path, &LoadOptions::default()).unwrap();
    let ours = asset.placement.unwrap();
    assert!((ours - theirs).abs().max() < 1e-12, "{ours}{theirs}");
    // It mirrors: baked, the faces turn round so that the outside stays outside.
    let before = asset.positions[5];
    asset.bake(formwork::io::Format::Obj);
    assert!(asset.descriptor.left_handed);
    let there = theirs.transform_point(&before.into()).coords;
    assert!((asset.positions[5] - there).norm() < 1e-12);
    // In glTF, metres with Y up: the unit of this stage is a centimetre.
    let mut asset = load(&path, &LoadOptions::default()).unwrap();
    asset.bake(formwork::io::Format::Glb);
    assert!((asset.positions[5] - there / 100.0).norm() < 1e-12);
    let mesh = describe("/World/Mesh", &grid(2, 2, false), &[1.0]);
    let stage = json!({ "up": "Z", "unit": 2.0, "meshes": [mesh] });
    let mut asset = load(&write(clients, folder.path(), "up.usda", &stage), &LoadOptions::default()).unwrap();
    let before = asset.positions[5];
    asset.bake(formwork::io::Format::Glb);
    assert_eq!(<[f64; 3]>::from(asset.positions[5]), [2.0 * before.x, 2.0 * before.z, -2.0 * before.y]);
}

#[test]
fn forms_are_read_and_checked() {
    let Some(clients) = clients() else { return };
    let folder = scratch();
    // Two quads side by side; the edge between them runs up in the first and down in the second.
    let d = grid(2, 1, false);
    let read = |values: [f64; 8], left_handed| {
        let mut mesh = describe("/World/Mesh", &Descriptor { left_handed, ..d.clone() }, &[1.0]);
        mesh["form0"] = json!([0.5, 1, 2, 3, 4, 5]);
        mesh["form1"] = json!(values);
        mesh["form2"] = json!([6, -7]);
        let path = write(clients, folder.path(), "forms.usda", &json!({ "meshes": [mesh] }));
        load(&path, &LoadOptions::default()).unwrap()
    };
    let [a, b] = [d.face_vertices[1], d.face_vertices[2]];
    // The values run from corner to corner in the order of the file, however that turns.
    for left_handed in [false, true] {
        let asset = read([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, -2.0], left_handed);
        let mesh = crate::level0(&asset);
        let fields = asset.fields(&mesh).unwrap();
        assert_eq!(fields.form0.unwrap().values(), [0.5, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(fields.form2.unwrap().values(), [6.0, -7.0]);
        let form1 = fields.form1.unwrap();
        let value = |a, b| form1.along(mesh.find_half_edge(a, b).unwrap());
        let found = [value(a, b), value(b, a), value(0, 1), value(d.face_vertices[3], 0)];
        assert_eq!(found, [2.0, -2.0, 1.0, 4.0], "left-handed: {left_handed}");
    }

    let asset = read([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 2.0], false);
    let error = asset.fields(&crate::level0(&asset)).unwrap_err().to_string();
    assert!(error.contains("forms.usda: /World/Mesh: form1 has "), "{error}");
    assert!(error.contains(&format!("from vertex {a} to vertex {b}")) && error.contains("face 1"), "{error}");
}
