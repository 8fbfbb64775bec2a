//! What the commands write, read back: fields, OBJ, JSON, GLB and NumPy archives.

mod common;

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use assert_cmd::Command;
use common::run::{fixture, json_file, keys, numbers, object, scratch, succeed};
use formwork::cochain::Cochain;
use formwork::hierarchy::Hierarchy;
use formwork::io::{fields, obj};
use formwork::scheme::Scheme;
use gltf::Semantic;
use gltf::mesh::Mode;
use nalgebra::Vector3;

/// A 0-form and its differential go in; what comes out is again a 0-form and its differential.
#[test]
fn the_differential_survives_from_file_to_file() {
    let folder = scratch();
    let x = [0.3, -1.0, 2.0, 0.7, 0.1, 0.9, -0.4, 1.6];
    let edges =
        [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (4, 7), (0, 4), (5, 1), (2, 6), (3, 7)];
    let form = serde_json::json!({
        "vertices": x.iter().enumerate().collect::<Vec<_>>(),
        "edges": edges.iter().map(|&(a, b)| (a, b, x[b] - x[a])).collect::<Vec<_>>(),
    });
    fs::write(folder.path().join("form.json"), form.to_string()).unwrap();
    let out = folder.path().join("out.json");
    succeed(
        folder.path(),
        &["subdivide", &fixture("cube.obj"), "--field", "form.json", "-l", "2", "-o", "out.json"],
    );
    let mesh = json_file(&out);
    assert_eq!(
        keys(&mesh),
        ["edges", "face_sizes", "face_vectors", "face_vertices", "form0", "form1", "level", "positions"]
    );
    let (x, c) = (numbers(&mesh["form0"]), numbers(&mesh["form1"]));
    let counts = ["positions", "edges", "face_sizes"].map(|key| mesh[key].as_array().unwrap().len());
    assert_eq!((counts, x.len(), c.len()), ([98, 192, 96], 98, 192));
    for (edge, value) in mesh["edges"].as_array().unwrap().iter().zip(c) {
        let [a, b] = [0, 1].map(|end| edge[end].as_u64().unwrap() as usize);
        assert!((x[b] - x[a] - value).abs() < 1e-14);
    }
}

#[test]
fn obj_and_its_forms_read_back_to_the_same_bits() {
    let folder = scratch();
    let (cube, field) = (fixture("cube.obj"), fixture("cube.field.json"));
    let report =
        object(folder.path(), &["subdivide", &cube, "--field", &field, "-l", "2", "-o", "out.obj", "--json"]);
    assert_eq!(report["written"], serde_json::json!(["out.obj", "out.fields.json"]));
    assert_eq!(report["forms"], serde_json::json!([0, 1, 2]));

    // What the library computes from the same input.
    let asset = obj::read(Path::new(&cube)).unwrap();
    let hierarchy = Hierarchy::new(&asset.cage().unwrap(), Scheme::default(), 2).unwrap();
    let given = fields::read(Path::new(&field), hierarchy.level(0).mesh()).unwrap();
    let (mesh, form1) = (hierarchy.finest().mesh(), hierarchy.subdivide(&given.form1.unwrap()));

    let written = obj::read(&folder.path().join("out.obj")).unwrap();
    assert_eq!(written.positions, hierarchy.subdivide(&asset.positions));
    assert_eq!(written.descriptor.face_vertices, mesh.corner_vertices());
    let reread = Hierarchy::new(&written.cage().unwrap(), Scheme::default(), 0).unwrap();
    let reread = reread.level(0).mesh();
    let forms = fields::read(&folder.path().join("out.fields.json"), reread).unwrap();
    assert_eq!(forms.form0, given.form0.map(|form| hierarchy.subdivide(&form)));
    assert_eq!(forms.form2, given.form2.map(|form| hierarchy.subdivide(&form)));
    // The edges of a file's mesh are numbered by its faces: compare them by their ends.
    let reread_form1: Cochain<1> = forms.form1.unwrap();
    for (e, &[a, b]) in mesh.edges().iter().enumerate() {
        assert_eq!(reread_form1.along(reread.find_half_edge(a, b).unwrap()), form1[e]);
    }
    let vectors = json_file(&folder.path().join("out.fields.json"))["face_vectors"].as_array().unwrap().len();
    assert_eq!(vectors, mesh.num_faces());

    // Level 0 of what was written is what was written.
    let again = |from: &str, to: &str| {
        let field = from.replace(".obj", ".fields.json");
        succeed(folder.path(), &["subdivide", from, "--field", &field, "-l", "0", "-o", to]);
        [to.to_owned(), to.replace(".obj", ".fields.json")]
            .map(|name| fs::read(folder.path().join(name)).unwrap())
    };
    assert!(again("out.obj", "a.obj") == again("a.obj", "b.obj"));
    assert_eq!(
        fs::read(folder.path().join("a.obj")).unwrap(),
        fs::read(folder.path().join("out.obj")).unwrap()
    );
}

#[test]
fn geometry_alone_has_no_forms() {
    let folder = scratch();
    let args = |out| ["subdivide", "cube.obj", "--levels", "1", "-o", out];
    fs::copy(fixture("cube.obj"), folder.path().join("cube.obj")).unwrap();
    for out in ["out.obj", "out.json", "out.glb"] {
        succeed(folder.path(), &args(out));
    }
    assert!(!folder.path().join("out.fields.json").exists());
    assert_eq!(
        keys(&json_file(&folder.path().join("out.json"))),
        ["edges", "face_sizes", "face_vertices", "level", "positions"]
    );
    let glb = Glb::read(&folder.path().join("out.glb"));
    assert_eq!(glb.node_names(), ["surface"]);
    assert!(glb.primitive("surface").get(&Semantic::Extras("FORM1".into())).is_none());
}

/// The forms `x` and `dx` on a flat sheet with a hole.
fn sheet_with_dx(folder: &Path) {
    let asset = obj::read(Path::new(&fixture("sheet.obj"))).unwrap();
    let hierarchy = Hierarchy::new(&asset.cage().unwrap(), Scheme::default(), 0).unwrap();
    let x = Cochain::<0>::new(asset.positions.values().iter().map(|p| p.x).collect());
    let mesh = hierarchy.level(0).mesh();
    let dx = x.exterior_derivative(mesh);
    let edges: Vec<_> = mesh.edges().iter().enumerate().map(|(e, &[a, b])| (a, b, dx[e])).collect();
    let vertices: Vec<_> = x.values().iter().enumerate().collect();
    let field = serde_json::json!({ "edges": edges, "vertices": vertices, "faces": [[4, 3], [5, 1]] });
    fs::write(folder.join("dx.json"), field.to_string()).unwrap();
}

#[test]
fn holes_are_left_out_of_everything_that_is_written() {
    let folder = scratch();
    sheet_with_dx(folder.path());
    let sheet = fixture("sheet.obj");
    let write = |out| {
        let args = ["subdivide", &sheet, "--field", "dx.json", "-l", "1", "-o", out, "--json"];
        object(folder.path(), &args)
    };
    let report = write("out.json");
    assert_eq!((&report["faces"], &report["faces_left_out"]), (&20.into(), &4.into()));
    let mesh = json_file(&folder.path().join("out.json"));
    assert_eq!(mesh["positions"].as_array().unwrap().len(), 13 + 17 + 6);
    let form2 = numbers(&mesh["form2"]);
    let lengths = ["face_sizes", "face_vectors", "form2"].map(|key| mesh[key].as_array().unwrap().len());
    assert_eq!(lengths, [20, 20, 20]);
    // Twice the 17 edges of the sheet and four in each face; four lie inside the hole, and two at its outer
    // side have no other face.
    assert_eq!(mesh["edges"].as_array().unwrap().len(), 34 + 24 - 4 - 2);
    assert_eq!(mesh["form1"].as_array().unwrap().len(), 34 + 24 - 4 - 2);
    let used: Vec<u64> =
        mesh["face_vertices"].as_array().unwrap().iter().map(|v| v.as_u64().unwrap()).collect();
    assert_eq!(used.len(), 80);
    for edge in mesh["edges"].as_array().unwrap() {
        let [a, b] = [0, 1].map(|end| edge[end].as_u64().unwrap());
        let on = |face: &[u64]| {
            (0..4).any(|i| [face[i], face[(i + 1) % 4]] == [a, b] || [face[(i + 1) % 4], face[i]] == [a, b])
        };
        assert!(used.chunks(4).any(on), "edge {a} {b} has no face");
    }
    // Values are compact: the last four belong to the face after the hole.
    assert!(form2[16..].iter().sum::<f64>() > 0.5, "{form2:?}");

    write("out.obj");
    let written = obj::read(&folder.path().join("out.obj")).unwrap();
    assert_eq!((written.descriptor.face_sizes.len(), written.positions.len()), (20, 36));
    let reread = Hierarchy::new(&written.cage().unwrap(), Scheme::default(), 0).unwrap();
    let forms = fields::read(&folder.path().join("out.fields.json"), reread.level(0).mesh()).unwrap();
    assert_eq!(forms.form2.unwrap().values(), form2);
}

#[test]
fn glb_holds_the_surface_its_field_and_arrows() {
    let folder = scratch();
    sheet_with_dx(folder.path());
    let args = ["subdivide", &fixture("sheet.obj"), "--field", "dx.json", "-l", "2", "-o", "out.glb", "-q"];
    succeed(folder.path(), &args);
    let glb = Glb::read(&folder.path().join("out.glb"));
    assert_eq!(glb.node_names(), ["surface", "form1 arrows"]);

    let surface = glb.primitive("surface");
    assert_eq!(surface.mode(), Mode::Triangles);
    let positions = glb.vectors(&surface, Semantic::Positions);
    assert_eq!(positions.len(), 118);
    let indices = glb.indices(&surface);
    assert_eq!(indices.len(), 3 * 2 * (96 - 16));
    // The hole is one square of six, and the sheet has not shrunk: its corners are sharp.
    let area: f32 = indices
        .chunks(3)
        .map(|t| (positions[t[1]] - positions[t[0]]).cross(&(positions[t[2]] - positions[t[0]])).z / 2.0)
        .sum();
    assert!((area - 5.0).abs() < 1e-5, "{area}");
    for normal in glb.vectors(&surface, Semantic::Normals) {
        assert_eq!(normal, Vector3::z());
    }
    // On a flat surface the vector of dx is the unit vector along x, wherever there is a face.
    let used: std::collections::HashSet<usize> = indices.iter().copied().collect();
    let form0 = glb.accessor(&surface, Semantic::Extras("FORM0".into()));
    assert_eq!((form0.count(), form0.dimensions()), (118, gltf::accessor::Dimensions::Scalar));
    let vectors = glb.vectors(&surface, Semantic::Extras("FORM1".into()));
    assert_eq!(vectors.len(), 118);
    for (v, vector) in vectors.iter().enumerate().filter(|(v, _)| used.contains(v)) {
        assert!((vector - Vector3::x()).norm() < 1e-6, "vertex {v}: {vector}");
    }
    let bounds = surface.bounding_box();
    assert_eq!(
        (bounds.min, bounds.max),
        ([0.0, 0.0, 0.0], [9.0, 9.0, 9.0]),
        "the vertex without a face stays"
    );

    let arrows = glb.primitive("form1 arrows");
    assert_eq!(arrows.mode(), Mode::Lines);
    let points = glb.vectors(&arrows, Semantic::Positions);
    assert_eq!((points.len(), glb.indices(&arrows).len()), (4 * 80, 6 * 80));
    for arrow in points.chunks(4) {
        let shaft = arrow[1] - arrow[0];
        assert!((shaft.normalize() - Vector3::x()).norm() < 1e-5, "{shaft}");
        assert!((0.1..=0.25).contains(&shaft.norm()), "{shaft}: cells are about a quarter wide");
        let middle = (arrow[0] + arrow[1]) / 2.0;
        assert!(!((1.05..1.95).contains(&middle.x) && middle.y > 1.05), "{middle} is in the hole");
    }
}

/// A GLB file with the few things that are asked of it.
struct Glb {
    document: gltf::Document,
    buffer: Vec<u8>,
}

impl Glb {
    fn read(path: &Path) -> Self {
        let bytes = fs::read(path).unwrap();
        assert_eq!(bytes.len() % 4, 0);
        let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
        Glb { document, buffer: blob.unwrap() }
    }

    fn node_names(&self) -> Vec<&str> {
        self.document.default_scene().unwrap().nodes().map(|node| node.name().unwrap()).collect()
    }

    fn primitive(&self, node: &str) -> gltf::Primitive<'_> {
        let node = self.document.nodes().find(|n| n.name() == Some(node)).unwrap();
        node.mesh().unwrap().primitives().next().unwrap()
    }

    fn accessor<'a>(&'a self, primitive: &gltf::Primitive<'a>, semantic: Semantic) -> gltf::Accessor<'a> {
        primitive.get(&semantic).unwrap_or_else(|| panic!("no attribute {semantic:?}"))
    }

    fn vectors(&self, primitive: &gltf::Primitive, semantic: Semantic) -> Vec<Vector3<f32>> {
        let accessor = primitive.get(&semantic).unwrap_or_else(|| panic!("no attribute {semantic:?}"));
        let vectors = gltf::accessor::Iter::<[f32; 3]>::new(accessor, |_| Some(&self.buffer[..])).unwrap();
        vectors.map(Vector3::from).collect()
    }

    fn indices(&self, primitive: &gltf::Primitive) -> Vec<usize> {
        let reader = primitive.reader(|_| Some(&self.buffer[..]));
        reader.read_indices().unwrap().into_u32().map(|i| i as usize).collect()
    }
}

type Rows = Vec<HashMap<usize, f64>>;
type Archive = npyz::npz::NpzArchive<std::io::BufReader<fs::File>>;

/// An array of an archive and its shape.
fn array<T: npyz::Deserialize>(npz: &mut Archive, name: &str) -> (Vec<T>, Vec<u64>) {
    let array = npz.by_name(name).unwrap().unwrap_or_else(|| panic!("no array {name}"));
    let shape = array.shape().to_vec();
    (array.into_vec().unwrap(), shape)
}

/// Reads a matrix of an archive; checks that the parts fit together.
fn matrix(npz: &mut Archive, name: &str) -> Rows {
    let (shape, _) = array::<i64>(npz, &format!("{name}_shape"));
    let (offsets, _) = array::<i64>(npz, &format!("{name}_indptr"));
    let (indices, _) = array::<i32>(npz, &format!("{name}_indices"));
    let (data, _) = array::<f64>(npz, &format!("{name}_data"));
    assert_eq!((shape.len(), offsets.len() as i64, indices.len()), (2, shape[0] + 1, data.len()), "{name}");
    assert!(indices.iter().all(|&column| i64::from(column) < shape[1]), "{name}");
    let entry = |i: usize| (indices[i] as usize, data[i]);
    offsets.windows(2).map(|ends| (ends[0] as usize..ends[1] as usize).map(entry).collect()).collect()
}

fn product(a: &Rows, b: &Rows) -> HashMap<(usize, usize), f64> {
    let mut sum = HashMap::new();
    for (i, row) in a.iter().enumerate() {
        for (&j, &x) in row {
            for (&k, &y) in &b[j] {
                *sum.entry((i, k)).or_insert(0.0) += x * y;
            }
        }
    }
    sum
}

fn assert_same(a: &HashMap<(usize, usize), f64>, b: &HashMap<(usize, usize), f64>) {
    for place in a.keys().chain(b.keys()) {
        let [x, y] = [a, b].map(|m| m.get(place).copied().unwrap_or(0.0));
        assert!((x - y).abs() < 1e-13, "{place:?}: {x} and {y}");
    }
}

#[test]
fn operators_commute_as_read_from_the_archive() {
    let folder = scratch();
    let report =
        object(folder.path(), &["operators", &fixture("cube.obj"), "-l", "2", "-o", "out.npz", "--json"]);
    assert_eq!((&report["levels"], &report["written"]), (&2.into(), &serde_json::json!(["out.npz"])));
    let path = folder.path().join("out.npz");
    let mut npz = npyz::npz::NpzArchive::open(&path).unwrap();
    let mut names: Vec<String> = npz.array_names().map(str::to_owned).collect();
    names.retain(|name| name.starts_with("l0/"));
    assert_eq!(names.len(), 3 + 2 * 4, "level 0 has no operators: {names:?}");
    for l in 1..=2u32 {
        let mut read = |level: u32, name: &str| matrix(&mut npz, &format!("l{level}/{name}"));
        let [d0, d1] = ["d0", "d1"].map(|d| read(l - 1, d));
        let [fine_d0, fine_d1, s0, s1, s2] = ["d0", "d1", "S0", "S1", "S2"].map(|m| read(l, m));
        assert_same(&product(&fine_d0, &s0), &product(&s1, &d0));
        assert_same(&product(&fine_d1, &s1), &product(&s2, &d1));
        let rows: Vec<f64> = s0.iter().map(|row| row.values().sum()).collect();
        assert!(rows.iter().all(|sum| (sum - 1.0).abs() < 1e-14));

        let (edges, shape) = array::<i32>(&mut npz, &format!("l{l}/edges"));
        assert_eq!(shape, [12 * 4u64.pow(l), 2]);
        for (row, ends) in fine_d0.iter().zip(edges.chunks(2)) {
            assert_eq!((row[&(ends[0] as usize)], row[&(ends[1] as usize)]), (-1.0, 1.0));
        }
        // A vertex over a face has the mean of its corners, the first row of the parents' meaning.
        let (kinds, _) = array::<u8>(&mut npz, &format!("l{l}/vertex_parent_kind"));
        let (parents, _) = array::<i32>(&mut npz, &format!("l{l}/vertex_parent_index"));
        let counts = [0, 1, 2].map(|kind| kinds.iter().filter(|&&k| k == kind).count());
        assert_eq!(counts, if l == 1 { [8, 12, 6] } else { [26, 48, 24] });
        let (sizes, _) = array::<i32>(&mut npz, &format!("l{l}/face_sizes"));
        assert!(sizes.iter().all(|&size| size == 4) && sizes.len() == s2.len());
        let (corners, _) = array::<i32>(&mut npz, &format!("l{}/face_vertices", l - 1));
        for v in (0..kinds.len()).filter(|&v| kinds[v] == 2) {
            let face = &corners[4 * parents[v] as usize..][..4];
            assert!(face.iter().all(|&corner| s0[v][&(corner as usize)] == 0.25));
        }
    }
    // The same input gives the same bytes.
    succeed(folder.path(), &["operators", &fixture("cube.obj"), "-l", "2", "-o", "again.npz"]);
    assert!(fs::read(path).unwrap() == fs::read(folder.path().join("again.npz")).unwrap());
}

/// The reader that the help shows, run by a Python that has SciPy: `scripts/setup --test` makes one.
#[test]
fn the_scipy_reader_in_the_help_works() {
    let python = Path::new(env!("CARGO_MANIFEST_DIR")).join(".venv/bin/python");
    if !python.exists() {
        eprintln!("skipped: there is no {}; scripts/setup --test makes it", python.display());
        return;
    }
    let folder = scratch();
    let help = succeed(folder.path(), &["operators", "--help"]);
    let start = help.find("  def matrix").unwrap();
    let reader: Vec<&str> = help[start..].lines().take(3).map(|line| &line[2..]).collect();
    let script = format!(
        "import numpy, scipy.sparse\n{}\nnpz = numpy.load('out.npz')\n\
         d0, s0, s1, fine = (matrix(npz, name) for name in ('l0/d0', 'l1/S0', 'l1/S1', 'l1/d0'))\n\
         assert s0.shape == (26, 8), s0.shape\n\
         assert abs(fine @ s0 - s1 @ d0).max() < 1e-14\n",
        reader.join("\n")
    );
    succeed(folder.path(), &["operators", &fixture("cube.obj"), "-o", "out.npz"]);
    let run = Command::new(python).args(["-c", &script]).current_dir(&folder).output().unwrap();
    assert!(run.status.success(), "{script}\n{}", String::from_utf8_lossy(&run.stderr));
}
