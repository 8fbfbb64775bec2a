use std::collections::BTreeMap;

use formwork::hierarchy::{Hierarchy, Level};
use formwork::io::Positions;
use formwork::scheme::Scheme;
use formwork::topology::{BoundaryInterpolation, Descriptor, Survey};
use nalgebra::Vector3;
use serde_json::json;

use super::{Outcome, count, grouped};
use crate::Failure;
use crate::args::{BOUNDARY, BOUNDARY_RULES, CREASING, DOO_SABIN, Inspect, TRIANGLES, name_of, scheme_name};
use crate::job::Job;

/// OpenSubdiv's infinite sharpness.
const INFINITE: f32 = 10.0;

pub fn run(args: &Inspect) -> Result<Outcome, Failure> {
    let job = Job::settle(&args.common)?;
    let hierarchy = Hierarchy::new(&job.cage, job.scheme, 0)?;
    let level = hierarchy.level(0);
    let survey = Survey::of(level.mesh());
    let d = &job.asset.descriptor;
    let (creases, corners) = sharp(d);
    let mut holes = d.holes.clone();
    holes.sort_unstable();
    holes.dedup();
    let treatment = treatment(&job, level, &survey, holes.len());
    let (low, high) = extent(&job.asset.positions);
    let rules = [
        ("boundary", name_of(BOUNDARY, d.boundary)),
        ("creasing", name_of(CREASING, d.creasing)),
        ("triangles", name_of(TRIANGLES, d.triangles)),
        ("doo_sabin", name_of(DOO_SABIN, args.common.doo_sabin)),
        ("half_box", name_of(BOUNDARY_RULES, args.common.half_box)),
        ("scheme", scheme_name(job.scheme)),
    ];

    let sharp = |sharp: &Sharp, thing| match sharp.total {
        0 => "none".to_owned(),
        total => format!("{}, {} infinitely sharp", count(total, thing), grouped(sharp.infinite)),
    };
    let genus = survey.genus.map_or("not defined".to_owned(), |genus| genus.to_string());
    let boundary = match survey.boundary_edges {
        0 => "none (closed)".to_owned(),
        edges => format!("{}, {}", count(survey.boundary_loops, "loop"), count(edges, "edge")),
    };
    let non_manifold = match (survey.non_manifold_edges, survey.non_manifold_vertices) {
        (0, 0) => "none".to_owned(),
        (edges, vertices) => format!("{}, {}", count(edges, "edge"), count(vertices, "vertex")),
    };
    let rows = [
        ("vertices", with_detail(survey.vertices, "by valence", &survey.valences)),
        ("edges", grouped(survey.edges)),
        ("faces", with_detail(survey.faces, "by size", &survey.face_sizes)),
        ("components", grouped(survey.components)),
        ("Euler", format!("{}, genus {genus}", survey.euler_characteristic)),
        ("boundary", boundary),
        ("non-manifold", non_manifold),
        ("creases", sharp(&creases, "edge")),
        ("corners", sharp(&corners, "vertex")),
        ("holes", if holes.is_empty() { "none".to_owned() } else { count(holes.len(), "face") }),
        ("extent", format!("{} to {}", point(&low), point(&high))),
        ("rules", rules.map(|(rule, name)| format!("{} {name}", rule.replace('_', "-"))).join(", ")),
    ];
    let mut text = format!("{}\n\n", job.asset.label());
    for (name, value) in &rows {
        text += &format!("{name:<14}{value}\n");
    }
    text += "\nWhat will be done\n";
    for sentence in &treatment {
        text += &format!("- {sentence}\n");
    }

    let json = json!({
        "command": "inspect",
        "mesh": job.asset.name,
        "survey": survey,
        "creases": { "edges": creases.total, "infinitely_sharp": creases.infinite },
        "corners": { "vertices": corners.total, "infinitely_sharp": corners.infinite },
        "holes": holes.len(),
        "faces_left_out": level.tags().face_hole.iter().filter(|&&hole| hole).count(),
        "extent": [<[f64; 3]>::from(low), <[f64; 3]>::from(high)],
        "rules": rules.into_iter().collect::<BTreeMap<_, _>>(),
        "left_handed": d.left_handed,
        "collapsed": { "reduced": job.collapse.reduced, "removed": job.collapse.removed },
        "treatment": treatment,
    });
    Ok(Outcome { text, json, notes: job.asset.notes, holds: true })
}

/// How many elements are sharp at all, and how many infinitely.
struct Sharp {
    total: usize,
    infinite: usize,
}

/// Creases and corners. An element named twice counts once, with its later value.
fn sharp(d: &Descriptor) -> (Sharp, Sharp) {
    let tally = |values: Vec<f32>| Sharp {
        total: values.iter().filter(|&&s| s > 0.0).count(),
        infinite: values.iter().filter(|&&s| s >= INFINITE).count(),
    };
    let creases: BTreeMap<[u32; 2], f32> = d
        .creases
        .iter()
        .map(|crease| {
            let [a, b] = crease.vertices;
            ([a.min(b), a.max(b)], crease.sharpness)
        })
        .collect();
    let corners: BTreeMap<u32, f32> = d.corners.iter().map(|c| (c.vertex, c.sharpness)).collect();
    (tally(creases.into_values().collect()), tally(corners.into_values().collect()))
}

/// `24   (by size: 20 of 4, 4 of 5)`.
fn with_detail(total: usize, by: &str, counts: &[(usize, usize)]) -> String {
    let shown = counts.iter().take(12).map(|(key, number)| format!("{} of {key}", grouped(*number)));
    let mut shown: Vec<String> = shown.collect();
    if counts.len() > shown.len() {
        shown.push(format!("{} more kinds", counts.len() - shown.len()));
    }
    format!("{}   ({by}: {})", grouped(total), shown.join(", "))
}

fn extent(positions: &Positions) -> (Vector3<f64>, Vector3<f64>) {
    let fold = |choose: fn(&Vector3<f64>, &Vector3<f64>) -> Vector3<f64>| {
        let points = positions.values().iter().copied();
        points.reduce(|a, b| choose(&a, &b)).unwrap_or_default()
    };
    (fold(|a, b| a.inf(b)), fold(|a, b| a.sup(b)))
}

fn point(x: &Vector3<f64>) -> String {
    format!("({}, {}, {})", x.x, x.y, x.z)
}

/// One sentence for each thing about this cage that refinement handles in a way of its own.
fn treatment(job: &Job, level: &Level, survey: &Survey, holes: usize) -> Vec<String> {
    let mut sentences = Vec::new();
    let mut say = |number: usize, sentence: String| {
        if number > 0 {
            sentences.push(sentence);
        }
    };
    let n_gons: usize =
        survey.face_sizes.iter().filter(|(size, _)| *size != 4).map(|(_, number)| number).sum();
    let reduced = job.collapse.reduced.len() + job.collapse.removed.len();
    say(
        reduced,
        format!(
            "{} collapsed: {} kept with fewer vertices, {} dropped.",
            count(reduced, "face"),
            job.collapse.reduced.len(),
            job.collapse.removed.len()
        ),
    );
    let quad_split = matches!(job.scheme, Scheme::Catmark(_) | Scheme::Bilinear);
    say(
        if quad_split { n_gons } else { 0 },
        format!("{} of other than four corners: on level 1, a quad for each corner.", count(n_gons, "face")),
    );
    say(
        survey.non_manifold_edges,
        format!(
            "{} non-manifold (three or more faces, or two that run the same way): infinitely sharp, and nothing smooths across.",
            count(survey.non_manifold_edges, "edge")
        ),
    );
    say(
        survey.non_manifold_vertices,
        format!(
            "{} non-manifold: OpenSubdiv's sharp rules hold there, and each fan of faces is refined by itself.",
            count(survey.non_manifold_vertices, "vertex")
        ),
    );
    say(
        survey.isolated_vertices,
        format!("{} without a face: carried along unchanged.", count(survey.isolated_vertices, "vertex")),
    );
    say(
        survey.boundary_edges,
        match job.asset.descriptor.boundary {
            BoundaryInterpolation::None => {
                "Boundary `none`: faces that touch the boundary are refined, and left out of what is written.".into()
            }
            BoundaryInterpolation::EdgeOnly => {
                "Boundary `edge-only`: boundary edges are sharp creases; their corners are rounded.".into()
            }
            BoundaryInterpolation::EdgeAndCorner => {
                "Boundary `edge-and-corner`: boundary edges are sharp creases; boundary vertices of one face stay put.".into()
            }
        },
    );
    say(
        holes,
        format!(
            "{} marked as holes: refined with the rest, left out of what is written.",
            count(holes, "face")
        ),
    );
    let left_out = level.tags().face_hole.iter().filter(|&&hole| hole).count();
    say(
        usize::from(left_out == survey.faces),
        "Every face is left out on level 0: nothing could be written unrefined.".into(),
    );
    say(
        usize::from(job.asset.descriptor.left_handed),
        "Left-handed: every face is turned round, its first vertex staying first.".into(),
    );
    if sentences.is_empty() {
        sentences.push("Closed and manifold: nothing out of the ordinary.".to_owned());
    }
    sentences
}
