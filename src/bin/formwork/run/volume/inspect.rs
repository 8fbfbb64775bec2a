use std::collections::BTreeMap;

use formwork::octet::{Complex, field};
use serde_json::json;

use super::load;
use crate::Failure;
use crate::args::volume::InspectVolume;
use crate::run::{Outcome, count, grouped};

pub fn run(args: &InspectVolume) -> Result<Outcome, Failure> {
    let solid = load(&args.common.mesh)?;
    let complex = &solid.complex;
    let volumes = field::volumes(complex, &solid.positions);
    let volume: f64 = volumes.iter().sum();
    let [least, most] = [f64::min as fn(f64, f64) -> f64, f64::max]
        .map(|choose| volumes.iter().copied().reduce(choose).unwrap_or(0.0));
    let survey = survey(complex);
    let [v, e, t, c] = [0, 1, 2, 3].map(|r| complex.num_cells(r) as i64);
    let euler = v - e + t - c;
    let valences = survey.inner_valences.iter().map(|(n, number)| format!("{} of {n}", grouped(*number)));
    let valences: Vec<String> = valences.take(12).collect();
    let forms = [
        solid.forms.vertices.is_some(),
        solid.forms.edges.is_some(),
        solid.forms.triangles.is_some(),
        solid.forms.cells.is_some(),
    ];
    let forms: Vec<usize> = (0..4).filter(|&r| forms[r]).collect();
    let named: Vec<String> = forms.iter().map(|r| format!("{r}-form")).collect();
    let inner = match survey.inner_valences.is_empty() {
        true => "none".to_owned(),
        false => format!("{}   (by cells round them: {})", grouped(survey.inner_edges), valences.join(", ")),
    };
    let next = [0, 1, 2, 3].map(|r| complex.num_children(r));
    let rows = [
        ("vertices", grouped(v as usize)),
        ("edges", grouped(e as usize)),
        ("triangles", grouped(t as usize)),
        ("tetrahedra", grouped(complex.tets().len())),
        ("octahedra", grouped(complex.octs().len())),
        ("Euler", euler.to_string()),
        ("boundary", count(survey.boundary_triangles, "triangle")),
        ("inner edges", inner),
        ("volume", format!("{volume}, cells from {least:.3e} to {most:.3e}")),
        ("forms", if named.is_empty() { "none".to_owned() } else { named.join(", ") }),
        (
            "level 1",
            format!("{} vertices, {} edges, {} triangles, {} cells", next[0], next[1], next[2], next[3]),
        ),
    ];
    let mut text = format!("{}\n", args.common.mesh.display());
    for (name, value) in rows {
        text += &format!("{name:<12}  {value}\n");
    }
    let json = json!({
        "command": "volume inspect",
        "mesh": args.common.mesh.display().to_string(),
        "vertices": v,
        "edges": e,
        "triangles": t,
        "tetrahedra": complex.tets().len(),
        "octahedra": complex.octs().len(),
        "euler_characteristic": euler,
        "boundary_triangles": survey.boundary_triangles,
        "inner_edges": survey.inner_edges,
        "inner_valences": survey.inner_valences,
        "volume": volume,
        "forms": forms,
    });
    Ok(Outcome { text, json, notes: solid.notes, holds: true })
}

struct Survey {
    boundary_triangles: usize,
    inner_edges: usize,
    /// How many inner edges have how many cells round them.
    inner_valences: BTreeMap<usize, usize>,
}

fn survey(complex: &Complex) -> Survey {
    let mut cells = vec![0; complex.num_cells(2)];
    for cell in 0..complex.num_cells(3) as u32 {
        complex.cell_faces(cell).iter().for_each(|face| cells[face.triangle() as usize] += 1);
    }
    let (mut valence, mut outer) = (vec![0; complex.num_cells(1)], vec![false; complex.num_cells(1)]);
    for (sides, &cells) in complex.triangles().iter().zip(&cells) {
        for side in sides {
            valence[side.edge() as usize] += 1;
            outer[side.edge() as usize] |= cells < 2;
        }
    }
    let mut inner_valences = BTreeMap::new();
    for (&valence, _) in valence.iter().zip(&outer).filter(|(_, outer)| !**outer) {
        *inner_valences.entry(valence).or_default() += 1;
    }
    Survey {
        boundary_triangles: cells.iter().filter(|&&cells| cells == 1).count(),
        inner_edges: inner_valences.values().sum(),
        inner_valences,
    }
}
