//! Tables in OpenSubdiv's evaluators, in a C++ program that owns its refiner, against what the library computes from
//! the same cage without tables. The program runs under AddressSanitizer.

mod common;
#[path = "../../tests/common/meshes.rs"]
#[allow(dead_code)]
mod meshes;
#[path = "../../tests/common/shapes.rs"]
#[allow(dead_code)]
mod shapes;

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use common::{compile, expect, install, run};
use formwork::cochain::Cochain;
use formwork::hierarchy::Hierarchy;
use formwork::limit::{Limit, LimitTangents};
use formwork::scheme::{BoundaryRule, DooSabin, Scheme, Variant};
use formwork::topology::{
    BoundaryInterpolation, Cage, Corner, Crease, CreasingMethod, Descriptor, TriangleSubdivision,
};
use meshes::{cut_grid, fan, grid, polygons, triangle_fan};

/// Single precision: the rounding of weights, values and sums, of numbers around 1.
const SINGLE: f64 = 2e-6;
/// Double precision: the order of the terms of a sum.
const DOUBLE: f64 = 2e-14;

/// The program, built with AddressSanitizer, and the prefix that it was linked with.
static PROGRAM: LazyLock<(PathBuf, PathBuf)> = LazyLock::new(|| {
    // Tests may run in processes of their own; the first of them builds.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("evaluators");
    let (prefix, program) = (folder.join("prefix"), folder.join("evaluate"));
    fs::create_dir_all(&folder).unwrap();
    let lock = fs::File::create(folder.join("lock")).unwrap();
    lock.lock().unwrap();
    let changed = |path: &Path| fs::metadata(path).and_then(|data| data.modified()).ok();
    let headers = fs::read_dir(common::root().join("cpp/include/formwork")).unwrap();
    let sources = headers.map(|entry| entry.unwrap().path()).chain([
        common::root().join("capi/tests/cpp/evaluate.cpp"),
        common::root().join("capi/tests/cpp/readArray.h"),
        common::root().join("scripts/install"),
        common::library(),
    ]);
    if changed(&program) < sources.filter_map(|source| changed(&source)).max() {
        expect(&install(&prefix, None), "scripts/install");
        let flags = ["-O1", "-g", "-fsanitize=address", "-fno-omit-frame-pointer"];
        compile(&folder, &prefix, "tests/cpp/evaluate", &flags, &[]);
    }
    (program, prefix)
});

fn evaluate(arguments: &[&Path]) -> String {
    let (program, prefix) = &*PROGRAM;
    expect(&run(program, prefix, arguments), "evaluate")
}

/// OpenSubdiv's number of the scheme that a scheme of forms goes with.
fn number(scheme: Scheme) -> u32 {
    match scheme {
        Scheme::Catmark(DooSabin::Thesis) => 1,
        Scheme::Loop(Variant::Loop, BoundaryRule::Reflect) => 2,
        Scheme::Bilinear => 0,
        other => panic!("{other:?} is none of OpenSubdiv's"),
    }
}

fn random(len: usize, seed: u64) -> Vec<f64> {
    let wave = |i: usize| ((i as f64 + 1.0) * (0.618 + 0.1 * seed as f64)).sin();
    (0..len).map(wave).collect()
}

/// The mesh and its forms, as the program reads them.
fn write(d: &Descriptor, scheme: Scheme, hierarchy: &Hierarchy) -> String {
    let mut text = String::new();
    let levels = hierarchy.num_levels();
    let boundary = match d.boundary {
        BoundaryInterpolation::None => 0,
        BoundaryInterpolation::EdgeOnly => 1,
        BoundaryInterpolation::EdgeAndCorner => 2,
    };
    let creasing = u8::from(d.creasing == CreasingMethod::Chaikin);
    let triangles = u8::from(d.triangles == TriangleSubdivision::Smooth);
    let (scheme, left) = (number(scheme), u8::from(d.left_handed));
    writeln!(text, "{} {levels} {scheme} {boundary} {creasing} {triangles} {left}", d.num_vertices).unwrap();
    let mut array = |values: Vec<String>| writeln!(text, "{} {}", values.len(), values.join(" ")).unwrap();
    array(d.face_sizes.iter().map(u32::to_string).collect());
    array(d.face_vertices.iter().map(u32::to_string).collect());
    array(d.creases.iter().flat_map(|c| c.vertices).map(|v| v.to_string()).collect());
    array(d.creases.iter().map(|c| c.sharpness.to_string()).collect());
    array(d.corners.iter().map(|c| c.vertex.to_string()).collect());
    array(d.corners.iter().map(|c| c.sharpness.to_string()).collect());
    array(d.holes.iter().map(u32::to_string).collect());
    for degree in 0..3 {
        for level in 0..=levels {
            let values = form(hierarchy, degree, level);
            let values: Vec<String> = values.iter().map(f64::to_string).collect();
            writeln!(text, "{degree} {level} {} {}", values.len(), values.join(" ")).unwrap();
        }
    }
    text
}

fn form(hierarchy: &Hierarchy, degree: usize, level: usize) -> Vec<f64> {
    random(hierarchy.level(level).mesh().num_cells(degree), (3 * level + degree) as u64)
}

fn refined<const K: usize>(hierarchy: &Hierarchy, from: usize, to: usize) -> Cochain<K> {
    let form = Cochain::new(form(hierarchy, K, from));
    (from + 1..=to).fold(form, |form, level| hierarchy.refine(level, &form))
}

/// The pairs of tangents at the vertices, or at the corners, of a level.
fn pairs(
    hierarchy: &Hierarchy,
    level: usize,
    tangents: &LimitTangents,
    at: &str,
) -> Vec<(u32, Option<usize>)> {
    let mesh = hierarchy.level(level).mesh();
    let corners = (0..mesh.num_corners() as u32).map(|c| (mesh.corner_vertex(c), tangents.pair_of_corner(c)));
    match at {
        "corners" => corners.collect(),
        "vertices" => {
            let first =
                |v| mesh.fans(v).flat_map(|fan| fan.corners).find_map(|&c| tangents.pair_of_corner(c));
            (0..mesh.num_vertices() as u32).map(|v| (v, first(v))).collect()
        }
        other => panic!("at {other}"),
    }
}

/// What a line of results should say, computed without tables; `limits` are those of each level.
fn expected(
    hierarchy: &Hierarchy,
    limits: &[(Limit, LimitTangents)],
    [what, degree, from, to]: [&str; 4],
) -> Vec<f64> {
    let [degree, from, to] = [degree, from, to].map(|word| word.parse().unwrap());
    let (limit, tangents) = &limits[to];
    let mesh = hierarchy.level(to).mesh();
    match (what.split_once('@'), what, degree) {
        (None, "refine", 0) => refined::<0>(hierarchy, from, to).into_values(),
        (None, "refine", 1) => refined::<1>(hierarchy, from, to).into_values(),
        (None, "refine", 2) => refined::<2>(hierarchy, from, to).into_values(),
        (None, "limit", 0) => limit.apply(mesh, &refined::<0>(hierarchy, from, to)).into_values(),
        (None, "limit", 1) => limit.apply(mesh, &refined::<1>(hierarchy, from, to)).into_values(),
        (None, "limit", 2) => limit.apply(mesh, &refined::<2>(hierarchy, from, to)).into_values(),
        (None, "signs", 2) => {
            (0..mesh.num_corners() as u32).map(|c| mesh.corner_half_edge(c).sign()).collect()
        }
        (Some((what, at)), _, _) => {
            let points = pairs(hierarchy, to, tangents, at);
            let values = refined::<0>(hierarchy, from, to);
            let along = match what {
                "vector" => tangents.along(&refined::<1>(hierarchy, from, to)),
                _ => tangents.along(&values.exterior_derivative(mesh)),
            };
            let along = |pair: Option<usize>| pair.map_or([0.0; 2], |pair| along[pair]);
            let limits = limit.apply(mesh, &values);
            match what {
                "value" => points.iter().map(|&(v, _)| limits[v as usize]).collect(),
                "du" => points.iter().map(|&(_, pair)| along(pair)[0]).collect(),
                "dv" => points.iter().map(|&(_, pair)| along(pair)[1]).collect(),
                "vector" => points.iter().flat_map(|&(_, pair)| along(pair)).collect(),
                other => panic!("results of {other}"),
            }
        }
        other => panic!("results of {other:?}"),
    }
}

/// A mesh, the scheme of its forms, and a number of levels.
struct Case(String, Descriptor, Scheme, usize);

fn case(name: &str, d: Descriptor, scheme: Scheme, levels: usize) -> Case {
    Case(name.to_owned(), d, scheme, levels)
}

/// Has meshes evaluated, by one process, and compares every number.
fn compare(cases: &[Case]) {
    let folder = tempfile::tempdir().unwrap();
    let (mut files, mut hierarchies) = (Vec::new(), Vec::new());
    for (i, Case(_, d, scheme, levels)) in cases.iter().enumerate() {
        let hierarchy = Hierarchy::new(&Cage::new(d.clone()).unwrap(), *scheme, *levels).unwrap();
        files.push(folder.path().join(i.to_string()));
        fs::write(&files[i], write(d, *scheme, &hierarchy)).unwrap();
        hierarchies.push(hierarchy);
    }
    let files: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    let printed = evaluate(&files);
    let printed: Vec<&str> = printed.split_terminator("end\n").collect();
    assert_eq!(printed.len(), cases.len());
    for ((Case(name, ..), hierarchy), printed) in cases.iter().zip(&hierarchies).zip(printed) {
        compare_one(name, hierarchy, printed);
    }
}

fn compare_one(name: &str, hierarchy: &Hierarchy, printed: &str) {
    let levels = hierarchy.num_levels();
    let limits: Vec<_> = (0..=levels).map(|l| Limit::with_tangents(hierarchy, l).unwrap()).collect();
    let mut worst = [0.0f64; 2];
    for line in printed.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let (title, values) = (words[..5].join(" "), &words[6..]);
        let values: Vec<f64> = values.iter().map(|word| word.parse().unwrap()).collect();
        let expected = expected(hierarchy, &limits, [words[0], words[2], words[3], words[4]]);
        assert_eq!((values.len(), Ok(values.len())), (expected.len(), words[5].parse()), "{name}: {title}");
        let precise = usize::from(words[1].starts_with("double"));
        // Tangents have any length.
        let scale = expected.iter().fold(1.0f64, |most, x| most.max(x.abs()));
        let tolerance = [SINGLE, DOUBLE][precise] * scale;
        for (i, (found, expected)) in values.iter().zip(&expected).enumerate() {
            let difference = (found - expected).abs();
            assert!(difference <= tolerance, "{name}: {title}: {i} is {found}, not {expected}");
            worst[precise] = worst[precise].max(difference / scale);
        }
    }
    let lines = printed.lines().count();
    let refining = 3 * (8 * levels + levels * (levels + 1) / 2);
    assert_eq!(lines, refining + (3 * 2 + 2 * (3 + 3 + 3 + 2) + 1) * (levels + 1), "{name}");
    println!("{name}: {lines} results, largest differences {:.1e} single, {:.1e} double", worst[0], worst[1]);
}

fn crease(a: u32, b: u32, sharpness: f32) -> Crease {
    Crease { vertices: [a, b], sharpness }
}

#[test]
fn quads_with_every_feature() {
    let creased = |creasing, boundary| Descriptor {
        creases: vec![crease(0, 1, 0.4), crease(1, 2, 2.5), crease(7, 8, 10.0), crease(8, 9, 1.0)],
        corners: vec![Corner { vertex: 13, sharpness: 1.5 }, Corner { vertex: 17, sharpness: 10.0 }],
        holes: vec![3],
        creasing,
        boundary,
        ..grid(4, 4, false)
    };
    use BoundaryInterpolation as B;
    let scheme = Scheme::default();
    compare(&[
        case("uniform creases", creased(CreasingMethod::Uniform, B::EdgeOnly), scheme, 2),
        case("chaikin creases", creased(CreasingMethod::Chaikin, B::EdgeAndCorner), scheme, 2),
        case("no boundary", creased(CreasingMethod::Uniform, B::None), scheme, 1),
        case("torus", grid(4, 4, true), scheme, 3),
        case("left-handed", Descriptor { left_handed: true, ..fan(&[4; 5]) }, scheme, 2),
    ]);
}

#[test]
fn polygons_and_what_is_not_manifold() {
    let scheme = Scheme::default();
    let mixed = Descriptor { triangles: TriangleSubdivision::Smooth, ..fan(&[3, 4, 5, 6, 3]) };
    let page = |i: u32| vec![vec![0, 1, 4 + 3 * i, 3 + 3 * i], vec![1, 2, 5 + 3 * i, 4 + 3 * i]];
    let book = polygons(12, &(0..3).flat_map(page).collect::<Vec<_>>());
    compare(&[
        case("polygons", mixed.clone(), scheme, 2),
        case("polygons, bilinear", mixed, Scheme::Bilinear, 2),
        case("cut grid", cut_grid(4, 3, true, &[0, 1, 2, 0, 1, 0, 2, 1, 0, 1, 1, 0]), scheme, 2),
        case("book", book, scheme, 1),
        case(
            "isolated vertices",
            Descriptor { num_vertices: 6, ..polygons(4, &[vec![0, 1, 2, 3]]) },
            scheme,
            1,
        ),
    ]);
}

#[test]
fn triangles() {
    let scheme = Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);
    let creased = Descriptor {
        creases: vec![crease(0, 1, 1.5), crease(0, 3, 10.0)],
        corners: vec![Corner { vertex: 2, sharpness: 2.0 }],
        ..triangle_fan(5, false)
    };
    compare(&[
        case("closed fan", triangle_fan(7, true), scheme, 2),
        case("creased fan", creased, scheme, 2),
        case("level 0 alone", triangle_fan(6, true), scheme, 0),
    ]);
}

#[test]
fn a_mesh_of_production() {
    let asset = formwork::io::obj::read(&common::root().join("assets/creased_box.obj")).unwrap();
    let cage = asset.cage().unwrap();
    compare(&[case("creased_box", cage.descriptor().clone(), Scheme::default(), 2)]);
}

#[test]
fn opensubdivs_shapes() {
    let loop_ = Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);
    let mut cases = Vec::new();
    for (name, scheme) in [("catmark", Scheme::default()), ("loop", loop_), ("bilinear", Scheme::Bilinear)] {
        for shape in shapes::shapes(name).into_iter().flatten() {
            let d = shape.descriptor();
            // The larger shapes print a lot and hold no more features. A few repeat a vertex in a face.
            if d.face_sizes.len() <= 100 && Cage::new(d.clone()).is_ok() {
                cases.push(case(&shape.name, d, scheme, 1));
            }
        }
    }
    compare(&cases);
    println!("{} shapes compared", cases.len());
}

#[test]
fn misuse_is_an_exception_with_the_message() {
    let printed = evaluate(&[Path::new("--errors")]);
    let expected = include_str!("cpp/errors.txt");
    for (printed, expected) in printed.lines().zip(expected.lines()) {
        assert_eq!(printed, expected);
    }
    assert_eq!(printed.lines().count(), expected.lines().count());
}
