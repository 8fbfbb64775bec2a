//! Matrices of the smooth forms in files: PETSc's binary format read back by a reader of its own, and NumPy's archive against
//! it.

mod common;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use common::run::{fixture, scratch, succeed};
use formwork::fem::{Elements, Quadrature, stiffness};
use formwork::io::{LoadOptions, load};
use formwork::limit::LimitSurface;
use formwork::scheme::Scheme;
use formwork::sparse::Csr;

/// What a PETSc file holds, by the words of its manual: big-endian, matrices 1211216, vectors 1211214.
#[derive(Debug)]
enum Object {
    Matrix { shape: (usize, usize), lengths: Vec<usize>, columns: Vec<usize>, entries: Vec<f64> },
    Vector(Vec<f64>),
}

fn read(path: &Path) -> Vec<Object> {
    let bytes = fs::read(path).unwrap();
    let mut rest = &bytes[..];
    fn ints(rest: &mut &[u8], n: usize) -> Vec<usize> {
        let (head, tail) = rest.split_at(4 * n);
        *rest = tail;
        head.chunks_exact(4).map(|b| i32::from_be_bytes(b.try_into().unwrap()) as usize).collect()
    }
    fn floats(rest: &mut &[u8], n: usize) -> Vec<f64> {
        let (head, tail) = rest.split_at(8 * n);
        *rest = tail;
        head.chunks_exact(8).map(|b| f64::from_be_bytes(b.try_into().unwrap())).collect()
    }
    let mut objects = Vec::new();
    while !rest.is_empty() {
        objects.push(match ints(&mut rest, 1)[0] {
            1_211_216 => {
                let head = ints(&mut rest, 3);
                let lengths = ints(&mut rest, head[0]);
                let columns = ints(&mut rest, head[2]);
                let entries = floats(&mut rest, head[2]);
                Object::Matrix { shape: (head[0], head[1]), lengths, columns, entries }
            }
            1_211_214 => {
                let n = ints(&mut rest, 1)[0];
                Object::Vector(floats(&mut rest, n))
            }
            other => panic!("no object of PETSc's begins with {other}"),
        });
    }
    objects
}

#[test]
fn petsc_files_hold_the_matrices() {
    let folder = scratch();
    let mesh = format!("{}/assets/torus.obj", env!("CARGO_MANIFEST_DIR"));
    succeed(folder.path(), &["masses", &mesh, "--level", "1", "-o", "torus.petsc"]);
    let objects = read(&folder.path().join("torus.petsc"));
    assert_eq!(objects.len(), 10);

    let asset = load(Path::new(&mesh), &LoadOptions::default()).unwrap();
    let surface = LimitSurface::with_levels(&asset.cage().unwrap(), Scheme::default(), 1).unwrap();
    let elements =
        Elements::new(&surface, &asset.positions, &Quadrature::new(surface.hierarchy().split_kind()));
    let complex = elements.complex(1);
    let k = [0, 1].map(|k| stiffness(complex.mass(k + 1), complex.d(k)));
    let expected: [&Csr; 7] =
        [complex.d(0), complex.d(1), complex.mass(0), complex.mass(1), complex.mass(2), &k[0], &k[1]];
    for (found, matrix) in objects.iter().zip(expected) {
        let Object::Matrix { shape, lengths, columns, entries } = found else { panic!("not a matrix") };
        assert_eq!(*shape, matrix.shape());
        let rows: Vec<usize> = matrix.outer_iterator().map(|row| row.nnz()).collect();
        assert_eq!(*lengths, rows);
        assert!(columns.iter().zip(matrix.indices()).all(|(a, b)| *a == *b as usize));
        assert_eq!(entries, matrix.data());
    }
    // The differentials of the coordinates: edges of the refined control mesh.
    let mesh = surface.hierarchy().level(1).mesh();
    let positions = surface.hierarchy().refine(1, &asset.positions);
    for (axis, object) in objects[7..].iter().enumerate() {
        let Object::Vector(values) = object else { panic!("not a vector") };
        let along =
            mesh.edges().iter().map(|&[a, b]| positions[b as usize][axis] - positions[a as usize][axis]);
        assert!(values.len() == mesh.num_edges() && values.iter().zip(along).all(|(x, y)| *x == y));
    }
}

/// The example reads the file and solves with it, here without PETSc.
#[test]
fn the_petsc_example_solves() {
    let folder = scratch();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mesh = root.join("assets/torus.obj").display().to_string();
    succeed(folder.path(), &["masses", &mesh, "--level", "1", "-o", "torus.petsc"]);
    let python = std::env::var_os("FORMWORK_PYTHON").map_or(root.join(".venv/bin/python"), PathBuf::from);
    assert!(python.exists(), "no {}: run scripts/setup --test", python.display());
    let run = Command::new(python)
        .arg(root.join("examples/petsc_ams.py"))
        .args(["torus.petsc", "--scipy"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let report: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(report["converged"], true);
    assert!(report["residual"].as_f64().unwrap() < 1e-9 && report["unknowns"] == 1024, "{report}");
}

#[test]
fn masses_refuse_other_formats() {
    let folder = scratch();
    let run = common::run::formwork(folder.path(), &["masses", &fixture("cube.obj"), "-o", "cube.mtx"]);
    assert_eq!(run.status.code(), Some(2));
    let message = String::from_utf8(run.stderr).unwrap();
    assert!(message.contains("cube.mtx") && message.contains(".npz, .petsc"), "{message}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
