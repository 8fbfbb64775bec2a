use formwork::cochain::Cochain;
use formwork::fem::{Elements, Quadrature, stiffness};
use formwork::io::{npz, petsc};
use formwork::limit::LimitSurface;
use serde_json::json;

use super::{Outcome, count, progress_bar, size_of};
use crate::Failure;
use crate::args::{Masses, scheme_name};
use crate::job::{Job, check_outputs, format_of};

pub fn run(args: &Masses) -> Result<Outcome, Failure> {
    let format = format_of(&args.output, &["npz", "petsc"])?;
    let job = Job::settle(&args.common)?;
    check_outputs(&[&args.common.mesh], std::slice::from_ref(&args.output))?;

    let bar = progress_bar(job.progress, 1, "integrating");
    let level = usize::from(args.level);
    let surface = LimitSurface::with_levels(&job.cage, job.scheme, level)?;
    let hierarchy = surface.hierarchy();
    let elements = Elements::new(&surface, &job.asset.positions, &Quadrature::new(hierarchy.split_kind()));
    let complex = elements.complex(level);
    let mesh = hierarchy.level(level).mesh();
    let k = [0, 1].map(|k| stiffness(complex.mass(k + 1), complex.d(k)));
    let matrices = [
        ("d0", complex.d(0)),
        ("d1", complex.d(1)),
        ("M0", complex.mass(0)),
        ("M1", complex.mass(1)),
        ("M2", complex.mass(2)),
        ("K0", &k[0]),
        ("K1", &k[1]),
    ];
    let refine = |mut positions: Cochain<0, _>| {
        for l in 1..=level {
            positions = hierarchy.refine(l, &positions);
        }
        positions
    };
    let positions = refine(job.asset.positions.clone());
    bar.set_message("writing ");
    if format == "petsc" {
        let along = [0, 1, 2].map(|axis| {
            let x: Cochain<0> = Cochain::new(positions.values().iter().map(|p| p[axis]).collect());
            x.exterior_derivative(mesh).into_values()
        });
        let mut objects: Vec<petsc::Object> =
            matrices.iter().map(|(_, matrix)| petsc::Object::Matrix(matrix)).collect();
        objects.extend(along.iter().map(|x| petsc::Object::Vector(x)));
        petsc::write(&args.output, &objects)?;
    } else {
        let sizes: Vec<u32> = (0..mesh.num_faces() as u32).map(|f| mesh.face_size(f) as u32).collect();
        let edges = mesh.edges().concat();
        let shapes = [mesh.num_faces(), mesh.num_corners(), mesh.num_vertices()].map(|n| [n]);
        let pairs = [mesh.num_edges(), 2];
        let mut arrays: Vec<(&str, &[usize], npz::Array)> =
            matrices.iter().map(|(name, matrix)| (*name, &[][..], npz::Array::Matrix(matrix))).collect();
        arrays.push(("edges", &pairs, npz::Array::Indices(&edges)));
        arrays.push(("face_sizes", &shapes[0], npz::Array::Indices(&sizes)));
        arrays.push(("face_vertices", &shapes[1], npz::Array::Indices(mesh.corner_vertices())));
        arrays.push(("positions", &shapes[2], npz::Array::Vectors(positions.values())));
        npz::write_arrays(&args.output, &arrays)?;
    }
    drop(bar);

    let cells = [
        count(mesh.num_vertices(), "vertex"),
        count(mesh.num_edges(), "edge"),
        count(mesh.num_faces(), "face"),
    ];
    let entries = matrices.map(|(name, matrix)| (name, matrix.nnz()));
    let text = format!(
        "{}, level {level}: {}, area {}\nwrote {}{}\n",
        job.asset.label(),
        cells.join(", "),
        complex.area(),
        args.output.display(),
        size_of(&args.output)
    );
    let json = json!({
        "command": "masses",
        "mesh": job.asset.name,
        "scheme": scheme_name(job.scheme),
        "level": level,
        "vertices": mesh.num_vertices(),
        "edges": mesh.num_edges(),
        "faces": mesh.num_faces(),
        "area": complex.area(),
        "entries": entries.into_iter().collect::<std::collections::BTreeMap<_, _>>(),
        "written": [args.output.display().to_string()],
    });
    Ok(Outcome { text, json, notes: job.asset.notes.clone(), holds: true })
}
