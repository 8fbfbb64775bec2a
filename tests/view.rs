//! What is shown: the numbers behind it, the page in a browser, the picture.

mod common;

use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use common::clients::{check_view, clients, root};
use common::run::{object, scratch, succeed};
use common::{EXACT, random};
use formwork::cochain::Cochain;
use formwork::hierarchy::Hierarchy;
use formwork::io::fields::Fields;
use formwork::io::{self, Asset, LoadOptions};
use formwork::limit::{LimitSurface, SurfacePoint};
use formwork::nalgebra::Vector3;
use formwork::scheme::{BoundaryRule, Scheme, Variant};
use formwork::view::{Layers, Options, Picture, Up, View};
use serde_json::Value;

type Vec3 = Vector3<f64>;

fn asset(name: &str) -> Asset {
    io::load(&root().join("assets").join(name), &LoadOptions::default()).unwrap()
}

fn edges(asset: &Asset, scheme: Scheme) -> usize {
    Hierarchy::new(&asset.cage().unwrap(), scheme, 0).unwrap().level(0).mesh().num_edges()
}

fn form1(values: Vec<f64>) -> Fields {
    Fields { form1: Some(Cochain::new(values)), ..Fields::default() }
}

fn view(asset: &Asset, scheme: Scheme, fields: &Fields, options: &Options) -> View {
    View::new(&asset.cage().unwrap(), scheme, &asset.positions, fields, options).unwrap()
}

fn few(levels: usize) -> Options {
    Options { levels, lines: 60, arrows: 20, ..Options::default() }
}

const LOOP: Scheme = Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);

/// Every corner of the cage's faces, against evaluation at that corner: another way to the same limit, which knows the
/// two sides of a crease by the face that it is asked in.
#[test]
fn vertices_have_the_position_the_normal_and_the_vector_of_their_side() {
    let meshes =
        [("torus.obj", Scheme::default()), ("creased_box.obj", Scheme::default()), ("gem.obj", LOOP)];
    for (name, scheme) in meshes {
        let asset = asset(name);
        let fields = form1(random(edges(&asset, scheme), 7));
        let shown = view(&asset, scheme, &fields, &few(0));
        let surface = LimitSurface::new(&asset.cage().unwrap(), scheme).unwrap();
        let (x, c) = (surface.refine(&asset.positions), surface.refine(fields.form1.as_ref().unwrap()));
        let level = &shown.levels[0];
        let (mut compared, mut sides) = (0, 0);
        for (face, vertices) in level.faces().enumerate() {
            for (corner, &v) in vertices.iter().enumerate() {
                let vertex = &level.vertices[v as usize];
                let point = SurfacePoint { face: face as u32, corner: corner as u32, s: 0.0, t: 0.0 };
                let there = surface.evaluate_vectors(&x, &c, &[point]).unwrap()[0];
                assert!((vertex.position - there.position.value).norm() < 1e-11, "{name}: {point:?}");
                let [a, b] = there.position.derivatives;
                let Some(normal) = a.cross(&b).try_normalize(1e-9).filter(|n| n.norm().is_finite()) else {
                    continue; // no tangent plane
                };
                assert!((vertex.normal - normal).norm() < 1e-7, "{name}: {point:?} {vertex:?} {normal}");
                let length = there.vector.norm();
                assert!((vertex.values[1] - length).abs() < 1e-7 * (1.0 + length), "{name}: {point:?}");
                compared += 1;
            }
        }
        for (v, vertex) in level.vertices.iter().enumerate() {
            let same = |w: &&formwork::view::Vertex| w.position == vertex.position;
            sides += usize::from(level.vertices[..v].iter().find(same).is_some());
        }
        assert!(compared > 50, "{name}: {compared} corners compared");
        assert_eq!(sides > 0, name == "creased_box.obj", "{name}: {sides} vertices for second sides");
    }
}

/// Pointwise densities are approached quadratically.
#[test]
fn densities_are_those_of_the_two_form() {
    let asset = asset("torus.obj");
    let scheme = Scheme::default();
    let cage = asset.cage().unwrap();
    let faces = cage.descriptor().face_sizes.len();
    let fields = Fields { form2: Some(Cochain::new(random(faces, 3))), ..Fields::default() };
    let shown = view(&asset, scheme, &fields, &few(4));
    assert_eq!((shown.degree, shown.forms.each_ref().map(Option::is_some)), (Some(2), [false, false, true]));
    let surface = LimitSurface::new(&cage, scheme).unwrap();
    let (x, c) = (surface.refine(&asset.positions), surface.refine(fields.form2.as_ref().unwrap()));
    // The exact density at each vertex of the cage, looked up on every level by its position.
    let points: Vec<SurfacePoint> =
        (0..faces as u32).map(|face| SurfacePoint { face, corner: 0, s: 0.0, t: 0.0 }).collect();
    let densities = surface.evaluate_2(&c, &points).unwrap();
    let jets = surface.evaluate_0(&x, &points).unwrap();
    let error = |level: &formwork::view::Level| {
        let worst = densities.iter().zip(&jets).map(|(density, jet)| {
            let near = |v: &&formwork::view::Vertex| (v.position - jet.value).norm() < 1e-9;
            let vertex = level.vertices.iter().find(near).expect("a vertex of the cage stays one");
            let [a, b] = jet.derivatives;
            (vertex.values[2] - density / a.cross(&b).norm()).abs()
        });
        worst.fold(0.0, f64::max)
    };
    let errors: Vec<f64> = shown.levels[2..].iter().map(error).collect();
    assert!(errors.windows(2).all(|pair| pair[0] > 3.0 * pair[1]), "{errors:?}");
    assert!(errors[2] < 0.05, "{errors:?}");
}

#[test]
fn missing_forms_are_derived() {
    let asset = asset("genus2.obj");
    let cage = asset.cage().unwrap();
    let hierarchy = Hierarchy::new(&cage, Scheme::default(), 0).unwrap();
    let mesh = hierarchy.level(0).mesh();
    let height = Cochain::<0>::new(asset.positions.values().iter().map(|p| p.x + 0.3 * p.y * p.z).collect());
    let given = Fields { form0: Some(height.clone()), ..Fields::default() };
    let a = view(&asset, Scheme::default(), &given, &few(1));
    assert_eq!(
        a.forms.each_ref().map(|f| f.as_ref().unwrap().name),
        ["0-form", "gradient of the 0-form", "curl of the 1-form"]
    );
    // From its gradient, the 0-form comes back but for a constant; neither has a curl.
    let slope = Fields { form1: Some(height.exterior_derivative(mesh)), ..Fields::default() };
    let b = view(&asset, Scheme::default(), &slope, &few(1));
    assert_eq!(b.forms[0].as_ref().unwrap().name, "potential of the exact part");
    let value = |view: &View, v: usize| view.levels[1].vertices[v].values;
    let constant = value(&a, 0)[0] - value(&b, 0)[0];
    for v in 0..a.levels[1].vertices.len() {
        assert!((value(&a, v)[0] - value(&b, v)[0] - constant).abs() < 1e-9);
        assert!((value(&a, v)[1] - value(&b, v)[1]).abs() < 1e-12);
        assert!(value(&a, v)[2].abs() < 1e-10);
    }
    // And a scale of 0 has two ends.
    let [low, high] = a.forms[2].as_ref().unwrap().scale;
    assert!(low < high);
    // Nothing given, nothing shown; what is not there is refused.
    let none = view(&asset, Scheme::default(), &Fields::default(), &few(1));
    assert!(none.forms.iter().all(Option::is_none) && none.degree.is_none() && none.strokes.is_empty());
    let options = Options { degree: Some(1), ..few(1) };
    let refused = View::new(&cage, Scheme::default(), &asset.positions, &Fields::default(), &options);
    assert!(refused.unwrap_err().to_string().contains("no 1-form"));
}

/// What is drawn along the field: as fast as the field is, and along the surface.
#[test]
fn strokes_and_arrows_follow_the_field() {
    let asset = asset("torus.obj");
    let fields = form1(random(edges(&asset, Scheme::default()), 1));
    let shown = view(&asset, Scheme::default(), &fields, &few(2));
    assert!(shown.strokes.len() > 50 && shown.arrows.len() == 20);
    let fastest = shown.forms[1].as_ref().unwrap().scale[1];
    let mut checked = 0;
    for stroke in &shown.strokes {
        assert!(stroke.times.windows(2).all(|pair| pair[0] < pair[1]));
        for i in 1..stroke.points.len() {
            let speed =
                (stroke.points[i] - stroke.points[i - 1]).norm() / (stroke.times[i] - stroke.times[i - 1]);
            let own = (stroke.speeds[i] + stroke.speeds[i - 1]) / 2.0;
            if own > 0.1 * fastest {
                assert!((speed - own).abs() < 1e-9 * own, "{speed} {own}");
                checked += 1;
            }
        }
    }
    assert!(checked > 500);
    for arrow in &shown.arrows {
        assert!(arrow.vector.dot(&arrow.normal).abs() < EXACT * 1e2 * arrow.vector.norm());
        assert!((arrow.normal.norm() - 1.0).abs() < EXACT);
    }
}

#[test]
fn up_is_z() {
    let asset = asset("gem.obj");
    let z = view(&asset, LOOP, &Fields::default(), &few(1));
    let y = view(&asset, LOOP, &Fields::default(), &Options { up: Up::Y, ..few(1) });
    for (a, b) in z.levels[1].vertices.iter().zip(&y.levels[1].vertices) {
        let turned = |p: Vec3| Vec3::new(p.x, -p.z, p.y);
        assert!(
            (turned(a.position) - b.position).norm() < 1e-14 && (turned(a.normal) - b.normal).norm() < 1e-12
        );
    }
}

fn words(text: &Value) -> Vec<u16> {
    let bytes = STANDARD.decode(text.as_str().unwrap()).unwrap();
    bytes.chunks(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect()
}

fn data_of(page: &str) -> Value {
    let (_, rest) = page.split_once("id=\"data\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

/// The page holds the numbers of the view, to 16 bits, and nothing of it is elsewhere.
#[test]
fn the_page_holds_the_view() {
    let asset = asset("open_polygons.obj");
    let fields = form1(random(edges(&asset, Scheme::default()), 5));
    let shown = view(&asset, Scheme::default(), &fields, &few(2));
    let page = shown.page("</script> & {{data}}.obj");
    assert!(page.contains("<title>&lt;/script> &amp; {{data}}.obj"));
    // The name of a kind of element is an address that nobody looks up.
    let without_names = page.replace("http://www.w3.org/1999/xhtml", "");
    for foreign in ["http://", "https://", "<link rel=\"stylesheet\"", " src=\"", "import("] {
        let place = without_names.find(foreign);
        let around = place.map(|i| &without_names[i.saturating_sub(60)..i + 60]);
        assert!(around.is_none(), "{around:?}");
    }
    assert!(page.contains("Permission is hereby granted") && page.contains("default-src 'none'"));
    let data = data_of(&page);
    assert_eq!(data["name"], "</script> & {{data}}.obj");
    assert_eq!(data["levels"].as_array().unwrap().len(), 3);
    let [low, high] = shown.bounds;
    for (level, packed) in shown.levels.iter().zip(data["levels"].as_array().unwrap()) {
        let indices: Vec<u32> = words(&packed["indices"]).into_iter().map(u32::from).collect();
        assert_eq!(indices, level.face_vertices);
        assert_eq!(
            packed["size"].is_null(),
            level.face_sizes.iter().any(|&size| size != level.face_sizes[0])
        );
        let (positions, normals) = (words(&packed["positions"]), words(&packed["normals"]));
        assert_eq!(positions.len(), 3 * level.vertices.len());
        for (v, vertex) in level.vertices.iter().enumerate() {
            for k in 0..3 {
                let position = low[k] + (high[k] - low[k]) * f64::from(positions[3 * v + k]) / 65535.0;
                assert!((position - vertex.position[k]).abs() <= (high[k] - low[k]) / 131_000.0 + 1e-15);
                let normal = f64::from(normals[3 * v + k] as i16) / 32767.0;
                assert!((normal - vertex.normal[k]).abs() <= 1.0 / 65_000.0);
            }
            for degree in 0..3 {
                let [from, to] = shown.forms[degree].as_ref().unwrap().range;
                let part = f64::from(words(&packed["values"][degree])[v]) / 65535.0;
                assert!((from + (to - from) * part - vertex.values[degree]).abs() <= (to - from) / 131_000.0);
            }
        }
    }
    let points: usize = shown.strokes.iter().map(|stroke| stroke.points.len()).sum();
    assert_eq!(words(&data["strokes"]["points"]).len(), 6 * points);
}

/// Must show: under 3 MB for a surface of 10 000 vertices with its field and all coarser levels.
#[test]
fn a_page_is_small() {
    let folder = scratch();
    let page = folder.path().join("page.html");
    let args =
        ["view", "assets/genus2.obj", "--field", "assets/genus2.field.json", "--levels", "4", "--json", "-o"];
    let report = object(root(), &[&args[..], &[page.to_str().unwrap()]].concat());
    assert!(report["vertices"].as_u64().unwrap() >= 10_000, "{report}");
    assert_eq!(report["strokes"].as_u64(), Some(1400));
    let bytes = fs::metadata(&page).unwrap().len();
    assert!(bytes < 3_000_000, "{bytes} bytes");
}

fn painted(view: &View) -> Picture {
    view.picture([320, 240]).unwrap()
}

#[test]
fn a_picture_shows_what_is_asked_for_and_is_the_same_on_any_number_of_threads() {
    let asset = asset("creased_box.obj");
    let fields = form1(random(edges(&asset, Scheme::default()), 2));
    let mut shown = view(&asset, Scheme::default(), &fields, &few(2));
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let all = pool(1).install(|| painted(&shown));
    assert_eq!(pool(3).install(|| painted(&shown)), all);
    assert_eq!((all.width, all.height, all.pixels.len()), (320, 240, 320 * 240));

    let red =
        |picture: &Picture| picture.pixels.iter().filter(|[r, g, b]| *r > 150 && *g < 90 && *b < 90).count();
    let differ = |a: &Picture, b: &Picture| a.pixels.iter().zip(&b.pixels).filter(|(a, b)| a != b).count();
    shown.layers = Layers { creases: true, ..Layers::NONE };
    let creases = painted(&shown);
    shown.layers = Layers::NONE;
    let bare = painted(&shown);
    assert!(red(&creases) > 50 && red(&bare) == 0, "{} {}", red(&creases), red(&bare));
    for layer in 0..3 {
        shown.layers = Layers { strokes: layer == 0, arrows: layer == 1, cage: layer == 2, ..Layers::NONE };
        let with = painted(&shown);
        assert!(differ(&with, &bare) > 200, "layer {layer}");
    }
    shown.layers = Layers::NONE;
    for degree in [0, 2] {
        shown.degree = Some(degree);
        assert!(differ(&painted(&shown), &bare) > 5000, "degree {degree}");
    }
    // White in the corners, and the middle is not.
    assert_eq!((bare.pixels[0], bare.pixels[319]), ([255; 3], [255; 3]));
    assert_ne!(bare.pixels[120 * 320 + 160], [255; 3]);
    assert!(shown.picture([15, 100]).is_err() && shown.picture([100_000, 100_000]).is_err());
    assert_eq!(&all.encode_png().unwrap()[..4], b"\x89PNG");
}

/// A sphere hides what is behind it: the near side is lit as its own normal says.
#[test]
fn the_near_side_is_painted() {
    let asset = asset("torus.obj");
    let mut shown = view(&asset, Scheme::default(), &Fields::default(), &few(3));
    shown.layers = Layers::NONE;
    let picture = painted(&shown);
    // The same with its triangles in another order: nearness decides, not the order.
    let level = shown.levels.last_mut().unwrap();
    let faces: Vec<Vec<u32>> = level.faces().map(<[u32]>::to_vec).collect();
    level.face_vertices = faces.iter().rev().flatten().copied().collect();
    let other = painted(&shown);
    let differ = picture.pixels.iter().zip(&other.pixels);
    let differ = differ.filter(|(a, b)| (0..3).any(|k| a[k].abs_diff(b[k]) > 2)).count();
    assert!(differ < 20, "{differ} pixels depend on the order");
    // The hole of the torus is seen through: between its middle and the rim the ground shows.
    let ground = picture.pixels.iter().filter(|pixel| **pixel == [255; 3]).count();
    assert!((20_000..70_000).contains(&ground), "{ground}");
}

#[track_caller]
fn healthy(report: &Value, expect: &[&str]) {
    let name = &report["window"];
    assert_eq!(report["errors"], serde_json::json!([]), "{name}");
    assert_eq!(report["requests"], serde_json::json!([]), "{name}");
    assert!(report["covered"]["part"].as_f64().unwrap() > 0.15, "{report}");
    assert!(report["covered"]["colours"].as_u64().unwrap() > 200, "{report}");
    let changed =
        |step: &str| report["changed"][step].as_f64().unwrap_or_else(|| panic!("no {step} in {report}"));
    for step in expect {
        assert!(changed(step) > 0.0004, "{name}: {step} changed {} of the picture", changed(step));
    }
    for step in ["paused", "calm"] {
        assert_eq!(changed(step), 0.0, "{name}: {step}");
    }
    assert_eq!(report["outside"], serde_json::json!([]), "{name}");
    assert_eq!((&report["scrolls"], &report["unnamed"]), (&false.into(), &0.into()), "{name}");
    assert!(report["smallest"].as_f64().unwrap() >= 12.0, "{report}");
    assert_eq!(report["saved"], "box.png");
}

/// Must show: in headless Chromium a page loads without errors and without any request, shows something, and drags, keys
/// and switches change it, at 1280 x 800 and at 390 x 844. With `FORMWORK_SHOTS=folder` screenshots stay there.
#[test]
fn a_page_lives_in_a_browser() {
    let Some(clients) = clients() else { return };
    let folder = scratch();
    fs::copy(root().join("assets/creased_box.obj"), folder.path().join("box.obj")).unwrap();
    let page = folder.path().join("box.html");
    let args = ["view", "box.obj", "--levels", "2", "--lines", "400", "-o", "box.html", "--field"];
    let field = root().join("assets/creased_box.field.json");
    succeed(folder.path(), &[&args[..], &[field.to_str().unwrap()]].concat());
    let steps = [
        "flowing",
        "key-space",
        "drag",
        "key-arrow",
        "key-plus",
        "key-reset",
        "form-2",
        "form-0",
        "form-none",
        "form-1",
        "switch-strokes",
        "switch-arrows",
        "switch-zeros",
        "switch-creases",
        "switch-cage",
        "switch-mesh",
        "level",
        "key-level",
        "theme",
        "help",
    ];
    for report in check_view(clients, &page, "full") {
        healthy(&report, &steps);
        println!("{report}");
    }
    // The check must see what is wrong.
    broken(clients, folder.path(), &fs::read_to_string(&page).unwrap());
}

fn broken(clients: &Path, folder: &Path, page: &str) {
    let blank = page.replace("renderer.render(scene, camera);", "");
    let blank = blank.replace("<body>", "<body><img src=\"http://127.0.0.1:9/x.png\" alt=\"\">");
    let blank = blank.replace("img-src data: blob:", "img-src *");
    assert_ne!(blank, page);
    let path = folder.join("broken.html");
    fs::write(&path, blank).unwrap();
    for report in check_view(clients, &path, "brief") {
        assert_ne!(report["requests"], serde_json::json!([]));
        assert_ne!(report["errors"], serde_json::json!([]));
        assert!(report["covered"]["part"].as_f64().unwrap() < 0.01, "{report}");
        assert_eq!(report["changed"]["drag"], 0.0);
    }
}
