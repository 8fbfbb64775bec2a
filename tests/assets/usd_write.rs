//! Stages that we wrote, opened with Pixar's library.

use std::fs;
use std::path::Path;

use formwork::io::{Frames, LoadOptions, load};
use serde_json::{Value, json};

use crate::common::clients::{check_usd, clients, python, root};
use crate::common::run::{formwork, object, scratch, succeed};

/// What the check found in the only or the named mesh of a file without errors.
#[track_caller]
fn clean(report: &Value, prim: &str) -> Value {
    assert_eq!(report["errors"], json!([]), "{}", report["file"]);
    report["meshes"][prim].clone()
}

/// Each asset, as a cage and refined, with and without forms.
#[test]
fn every_stage_is_clean() {
    let Some(clients) = clients() else { return };
    let folder = scratch();
    let mut files = Vec::new();
    for name in ["creased_box", "open_polygons", "genus2", "high_valence", "fin", "torus", "gem"] {
        let field = format!("assets/{name}.field.json");
        for levels in ["0", "1", "2"] {
            let out = folder.path().join(format!("{name}{levels}.usda"));
            let mesh = format!("assets/{name}.obj");
            let mut args = vec!["subdivide", &mesh, "-q", "-l", levels, "-o", out.to_str().unwrap()];
            if root().join(&field).exists() {
                args.extend(["--field", &field]);
            }
            succeed(root(), &args);
            files.push(out);
        }
    }
    let files: Vec<&Path> = files.iter().map(|file| file.as_path()).collect();
    let reports = check_usd(clients, &files);
    for report in &reports {
        clean(report, "/Root/surface");
    }
    // A smooth surface has one vector a vertex, a creased one has two sides.
    let interpolation = |i: usize| clean(&reports[i], "/Root/surface")["primvars"]["form1Vector"][1].clone();
    assert_eq!((interpolation(2), interpolation(8)), (json!("faceVarying"), json!("vertex")));
    assert_eq!(clean(&reports[0], "/Root/surface")["scheme"], "catmullClark");
    assert_eq!(clean(&reports[2], "/Root/surface")["scheme"], "none");
}

/// On the limit: exact normals and vectors, in every frame, on both sides of creases.
#[test]
fn limits_are_written_too() {
    let Some(clients) = clients() else { return };
    let folder = scratch();
    let [crate_, wave] = ["box.usda", "wave.usda"].map(|name| folder.path().join(name));
    let field = "assets/creased_box.field.json";
    for levels in ["0", "1"] {
        let out = crate_.to_str().unwrap();
        succeed(
            root(),
            &["limit", "assets/creased_box.obj", "--field", field, "-q", "-l", levels, "-o", out],
        );
        let scene =
            ["limit", "assets/scene.usda", "--prim", "/Scene/Wave", "--frames", "all", "-q", "-l", levels];
        succeed(root(), &[&scene[..], &["-o", wave.to_str().unwrap()]].concat());
        let reports = check_usd(clients, &[&crate_, &wave]);
        let mesh = clean(&reports[0], "/Root/surface");
        assert_eq!(mesh["primvars"]["form1Vector"], json!(["vector3f[]", "faceVarying"]));
        assert_eq!(mesh["scheme"], "none");
        let mesh = clean(&reports[1], "/Scene/Wave");
        assert_eq!((&mesh["samples"], &mesh["scheme"]), (&json!(3), &json!("none")));
        assert_eq!(mesh["primvars"]["form1Vector"], json!(["vector3f[]", "vertex"]));
    }
    // Values are those of the limit: what is written as JSON, to 32 bits.
    let json = folder.path().join("box.json");
    let args = ["limit", "assets/creased_box.obj", "--field", field, "-q", "-l", "1", "-o"];
    succeed(root(), &[&args[..], &[json.to_str().unwrap()]].concat());
    let (exact, read) = (crate::load(&json), crate::load(&crate_));
    let single = |x: f64| f64::from(x as f32);
    assert!(
        exact.positions.values().iter().map(|p| p.map(single)).eq(read.positions.values().iter().copied())
    );
    let (exact, read) = (crate::fields(&exact).form1.unwrap(), crate::fields(&read).form1.unwrap());
    assert!(exact.values().iter().map(|&x| single(x)).eq(read.values().iter().copied()));
}

/// The check must see what is wrong, or it says nothing.
#[test]
fn the_check_sees_errors() {
    let Some(clients) = clients() else { return };
    let folder = scratch();
    let out = folder.path().join("torus.usda");
    succeed(root(), &["subdivide", "assets/torus.obj", "-l", "1", "-o", out.to_str().unwrap()]);
    let good = fs::read_to_string(&out).unwrap();
    for (from, to, error) in [
        ("faceVertexIndices = [0, ", "faceVertexIndices = [99999, ", "out of range"),
        ("upAxis = \"Y\"", "", "no upAxis"),
        ("normal3f[] normals = [", "normal3f[] normals = [(0, 0, 1), ", "normals"),
        ("float3[] extent = [", "float3[] extent = [(0, 0, 0), ", "extent"),
    ] {
        assert!(good.contains(from), "{from}");
        let bad = folder.path().join("bad.usda");
        fs::write(&bad, good.replace(from, to)).unwrap();
        let report = &check_usd(clients, &[&bad])[0];
        assert!(report["errors"].to_string().contains(error), "{error}: {report}");
    }
}

/// A stage of two meshes: one is refined with its frames, then the other; the rest stays.
#[test]
fn a_scene_is_refined_in_place() {
    let Some(clients) = clients() else { return };
    let folder = scratch();
    let [wave, both] = ["wave.usda", "both.usda"].map(|name| folder.path().join(name));
    let scene = root().join("assets/scene.usda");
    let report = object(
        folder.path(),
        &[
            "subdivide",
            scene.to_str().unwrap(),
            "--prim",
            "/Scene/Wave",
            "--frames",
            "all",
            "-o",
            "wave.usda",
            "--json",
        ],
    );
    assert_eq!((&report["frames"], &report["forms"]), (&json!([1.0, 2.0, 3.0]), &json!([1])));
    let report = object(
        folder.path(),
        &["subdivide", "wave.usda", "--prim", "/Scene/Crate", "-l", "2", "-o", "both.usda", "--json"],
    );
    assert_eq!(report["notes"], json!(["/Scene/Crate: interpolated linearly within each face: primvars:st"]));
    let reports = check_usd(clients, &[&wave, &both]);
    assert_eq!(clean(&reports[0], "/Scene/Crate")["scheme"], "catmullClark");
    let mesh = clean(&reports[1], "/Scene/Wave");
    assert_eq!(
        (&mesh["scheme"], &mesh["samples"], &mesh["faces"]),
        (&json!("none"), &json!(3), &json!(24 * 64))
    );
    assert_eq!(clean(&reports[1], "/Scene/Crate")["faces"], 5 * 16);
    // Colours and the subset of the lid follow the faces; the hole is gone.
    let script = folder.path().join("look.py");
    fs::write(
        &script,
        "import sys, json\nfrom pxr import Usd, UsdGeom\nstage = Usd.Stage.Open(sys.argv[1])\n\
         prim = stage.GetPrimAtPath('/Scene/Crate')\n\
         colours = UsdGeom.PrimvarsAPI(prim).GetPrimvar('displayColor').Get()\n\
         lid = UsdGeom.Subset(stage.GetPrimAtPath('/Scene/Crate/lid')).GetIndicesAttr().Get()\n\
         print(json.dumps([[list(c) for c in colours], list(lid)]))\n",
    )
    .unwrap();
    let run = python(clients, script.to_str().unwrap(), &[&both]);
    let found: Value = serde_json::from_slice(&run.stdout).unwrap();
    let given = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1]];
    let colours: Vec<Value> = given.iter().flat_map(|c| vec![json!(c.map(f64::from)); 16]).collect();
    assert_eq!(found[0], json!(colours));
    assert_eq!(found[1], json!((16..32).chain(48..64).collect::<Vec<u32>>()));
    // Without a name it is not clear which mesh is meant.
    assert_eq!(formwork(folder.path(), &["inspect", "both.usda"]).status.code(), Some(2));
}

/// Primvars that say where each vertex and corner is, on a left-handed mesh and on triangles: refined, they
/// must say where the refined ones are. The bilinear scheme makes linear interpolation exact.
#[test]
fn other_primvars_are_refined_along() {
    let folder = scratch();
    let quads = ("4, 4", "0, 3, 4, 1, 1, 4, 5, 2", "leftHanded");
    let triangles = ("3, 3, 3", "0, 1, 3, 1, 4, 3, 1, 2, 4", "rightHanded");
    let points = ["(0, 0, 0)", "(1, 0, 0.5)", "(2, 0, 0)", "(0, 1, 0)", "(1, 1.5, 0)", "(2, 1, 1)"];
    for (scheme, (counts, indices, orientation)) in
        [("bilinear", quads), ("catmark", quads), ("whitney", triangles), ("loop", triangles)]
    {
        let at = |i: &str| points[i.trim().parse::<usize>().unwrap()];
        let corners: Vec<&str> = indices.split(',').map(at).collect();
        let primvar = |name: &str, values: &[&str], interpolation: &str| {
            let values = values.join(", ");
            format!("float3[] primvars:{name} = [{values}] ( interpolation = \"{interpolation}\" )\n")
        };
        let stage = format!(
            "#usda 1.0\ndef Mesh \"m\" {{\nint[] faceVertexCounts = [{counts}]\n\
             int[] faceVertexIndices = [{indices}]\npoint3f[] points = [{}]\n\
             uniform token orientation = \"{orientation}\"\n{}{}{}{}int[] primvars:shared:indices = [{indices}]\n\
             int[] primvars:bones = [1, 2, 3, 4, 5, 6] ( interpolation = \"vertex\" )\n}}\n",
            points.join(", "),
            primvar("smooth", &points, "vertex"),
            primvar("linear", &points, "varying"),
            primvar("corner", &corners, "faceVarying"),
            primvar("shared", &points, "faceVarying"),
        );
        fs::write(folder.path().join("in.usda"), stage).unwrap();
        let mut args =
            vec!["subdivide", "in.usda", "--scheme", scheme, "-l", "2", "-o", "out.usda", "--json"];
        if scheme == "catmark" {
            args.push("--limit"); // vertices of every kind go to the limit
        }
        let report = object(folder.path(), &args);
        let notes = [
            "/m: interpolated linearly within each face: primvars:corner, primvars:shared",
            "/m: not refined and therefore left out: primvars:bones",
        ];
        assert_eq!(json!(report["notes"].as_array().unwrap()[..2]), json!(notes), "{scheme}");
        let data = openusd::usda::read_file(folder.path().join("out.usda")).unwrap();
        let default = |name: &str| {
            let path = openusd::sdf::path(format!("/m.{name}")).unwrap();
            data.spec(&path).unwrap_or_else(|| panic!("{name}")).get("default").unwrap().clone()
        };
        let vectors = |name: &str| default(name).try_as_vec_3f_vec().unwrap();
        let points = vectors("points");
        assert_eq!(vectors("primvars:smooth"), points, "{scheme}");
        if ["bilinear", "whitney"].contains(&scheme) {
            assert_eq!(vectors("primvars:linear"), points, "{scheme}");
            let indices = default("faceVertexIndices").try_as_int_vec().unwrap();
            let corners: Vec<_> = indices.iter().map(|&i| points[i as usize]).collect();
            assert_eq!(vectors("primvars:corner"), corners, "{scheme}");
        }
        assert_eq!(vectors("primvars:shared"), vectors("primvars:corner"), "{scheme}");
    }
}

/// Faces that a collapse drops take what the stage says of faces by number along, rather than shifting it.
#[test]
fn a_collapse_leaves_no_stale_numbers() {
    let folder = scratch();
    let stage = "#usda 1.0\ndef Mesh \"m\" {\nint[] faceVertexCounts = [4, 4, 4]\n\
        int[] faceVertexIndices = [0, 0, 1, 1, 0, 1, 2, 3, 1, 4, 5, 2]\n\
        point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (2, 1, 0)]\n\
        float[] primvars:heat = [1, 2, 3] ( interpolation = \"uniform\" )\n\
        def GeomSubset \"s\" { int[] indices = [1] }\n}\n";
    fs::write(folder.path().join("in.usda"), stage).unwrap();
    for levels in ["0", "1"] {
        let args = ["subdivide", "in.usda", "--collapse", "-l", levels, "-o", "out.usda", "--json"];
        let notes = object(folder.path(), &args)["notes"].to_string();
        assert!(notes.contains("left out: primvars:heat, the faces of /m/s"), "{notes}");
        let text = fs::read_to_string(folder.path().join("out.usda")).unwrap();
        assert!(!text.contains("heat") && text.contains("int[] indices = []"), "{text}");
    }
}

/// Topology is refined once for all frames; each is what it is alone, to the bit.
#[test]
fn frames_together_are_frames_alone() {
    let folder = scratch();
    let scene = root().join("assets/scene.usda").display().to_string();
    let subdivide = |frames: &str, out: &str| {
        let args =
            ["subdivide", &scene, "--prim", "/Scene/Wave", "-l", "2", "-q", "--frames", frames, "-o", out];
        succeed(folder.path(), &args);
    };
    let positions = |x: &formwork::io::Positions| -> Vec<[f32; 3]> {
        x.values().iter().map(|p| [p.x as f32, p.y as f32, p.z as f32]).collect()
    };
    subdivide("all", "all.usda");
    subdivide("2:9", "late.usda");
    let read = |name: &str| {
        let options = LoadOptions { prim: Some("/Scene/Wave".to_owned()), frames: Frames::All };
        load(&folder.path().join(name), &options).unwrap().frames
    };
    let all = read("all.usda");
    assert_eq!(all.len(), 3);
    for frame in &all {
        subdivide(&frame.time.to_string(), "one.json");
        let alone = load(&folder.path().join("one.json"), &LoadOptions::default()).unwrap();
        assert_eq!(positions(&frame.positions), positions(&alone.positions), "{}", frame.time);
    }
    assert_ne!(all[0].positions, all[1].positions);
    assert_eq!(read("late.usda"), all[1..]);
}

/// Everything outside the mesh's own attributes: 439 fields of every kind that a layer has.
#[test]
fn what_is_not_refined_stays() {
    let Some(clients) = clients() else { return };
    let folder = scratch();
    for extension in ["usda", "usdc"] {
        let rich = folder.path().join(format!("rich.{extension}"));
        let run = python(clients, "tests/clients/usd_rich.py", &[&rich]);
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        for levels in ["0", "1"] {
            let out = folder.path().join(format!("{extension}{levels}.usda"));
            succeed(
                folder.path(),
                &["subdivide", rich.to_str().unwrap(), "-q", "-l", levels, "-o", out.to_str().unwrap()],
            );
            let run = python(clients, "tests/clients/usd_rich.py", &[&rich, &out, Path::new("/World/Mesh")]);
            let said = String::from_utf8_lossy(&run.stdout);
            assert!(run.status.success(), "{said}{}", String::from_utf8_lossy(&run.stderr));
            assert!(said.contains("439 fields"), "{said}");
        }
    }
}
