use std::sync::Arc;

use nalgebra::{Matrix4, Vector3};
use openusd::sdf::{Data, Value};

use super::layer::{Prim, When, is_empty_list, numbers, triples};
use super::{CREASING, Stage, container, xform};
use crate::cochain::Cochain;
use crate::io::error::quote;
use crate::io::{Asset, Form1, Forms, Frame, Frames, IoError, LoadOptions, Positions};
use crate::osd::OsdScheme;
use crate::topology::{
    BoundaryInterpolation, Corner, Crease, CreasingMethod, Descriptor, TriangleSubdivision,
};

/// What is read of a mesh, its tags, forms and transforms apart, or made anew for it.
pub(super) const ATTRIBUTES: [&str; 8] = [
    "points",
    "faceVertexCounts",
    "faceVertexIndices",
    "orientation",
    "subdivisionScheme",
    "extent",
    "normals",
    "doubleSided",
];

/// Names that a message lists.
const MAX_NAMES: usize = 6;

/// Reads a mesh from the contents of a file of any of the three kinds; `name` is used in messages.
///
/// # Errors
/// [`IoError::Content`] with the prim and attribute that are wrong, or the list of meshes if there are
/// several and `options` name none.
pub fn parse(name: &str, bytes: Vec<u8>, options: &LoadOptions) -> Result<Asset, IoError> {
    let stage = |problem: String| IoError::content(name, "stage", problem);
    let (data, package) = container::layer(bytes).map_err(stage)?;
    let mut notes = Vec::new();
    let arcs = arcs(&data);
    if !arcs.is_empty() {
        notes.push(format!(
            "only what the file itself says is read, not what it composes: {}; usdcat --flatten makes one file of it",
            listed(&arcs)
        ));
    }
    let prim = choose(name, &data, options.prim.as_deref(), !arcs.is_empty())?;
    let path = prim.path.to_string();
    let fail = |problem: String| IoError::content(name, &path, problem);

    let when = match options.frames {
        Frames::At(time) => When::At(time),
        _ => When::Rest,
    };
    let descriptor = descriptor(&prim, when).map_err(fail)?;
    let mut asset = Asset {
        positions: positions(&prim, when).map_err(fail)?,
        placement: placement(&prim, when).map_err(fail)?,
        scheme: scheme(&prim, &mut notes).map_err(fail)?,
        forms: forms(&prim, when).map_err(fail)?,
        frames: frames(&prim, options.frames).map_err(fail)?,
        ..Default::default()
    };
    asset.descriptor = Descriptor { num_vertices: asset.positions.len(), ..descriptor };
    if options.frames == Frames::Rest && (prim.times("points").len() > 1 || xform::moves(&prim)) {
        notes.push(format!("{path} moves: one state of it is read; --frames takes its time samples"));
    }
    for name in ["primvars:form0", "primvars:form1", "primvars:form2"] {
        if when == When::Rest && prim.times(name).len() > 1 {
            notes.push(format!("{path}: {name} moves: one state of it is read; --frames takes one time"));
        }
    }
    if let Some(first) = asset.frames.first() {
        asset.positions = first.positions.clone();
    }
    (asset.name, asset.prim, asset.notes) = (name.to_owned(), Some(path.clone()), notes);
    let (prim, descriptor) = (prim.path.clone(), asset.descriptor.clone());
    asset.stage = Some(Arc::new(Stage { data, prim, descriptor, packed: package.len() }));
    Ok(asset)
}

/// What the stage takes from elsewhere: `references of /World/Tree`.
fn arcs(data: &Data) -> Vec<String> {
    const ARCS: [&str; 5] = ["references", "payload", "inheritPaths", "specializes", "variantSetNames"];
    let mut arcs = Vec::new();
    for (path, spec) in data.iter() {
        let found = ARCS.iter().filter(|arc| spec.contains(arc));
        arcs.extend(found.map(|arc| format!("{} of {path}", arc.replace("SetNames", "s"))));
        if let Some(Value::StringVec(layers)) = spec.get("subLayers") {
            arcs.extend(layers.iter().map(|layer| format!("the layer {}", quote(layer))));
        }
    }
    arcs.sort();
    arcs
}

fn listed(names: &[String]) -> String {
    let mut list = names.iter().take(MAX_NAMES).cloned().collect::<Vec<_>>().join(", ");
    if names.len() > MAX_NAMES {
        list += &format!(" and {} more", names.len() - MAX_NAMES);
    }
    list
}

fn choose<'a>(file: &str, data: &'a Data, wanted: Option<&str>, composes: bool) -> Result<Prim<'a>, IoError> {
    let mut meshes = Prim::root(data).descendants();
    meshes.retain(|prim| prim.type_name() == "Mesh");
    let names: Vec<String> = meshes.iter().map(|prim| prim.path.to_string()).collect();
    if let Some(wanted) = wanted {
        return match names.iter().position(|name| name == wanted) {
            Some(i) => Ok(meshes.swap_remove(i)),
            None => {
                let problem = format!("is no mesh of this stage: choose from {}", listed(&names));
                Err(IoError::content(file, &format!("--prim {}", quote(wanted)), problem))
            }
        };
    }
    match meshes.len() {
        1 => Ok(meshes.swap_remove(0)),
        0 if composes => Err(IoError::content(
            file,
            "stage",
            "has no mesh of its own, and what it composes is not read: make one file of it (usdcat --flatten)",
        )),
        0 => Err(IoError::content(file, "stage", "has no mesh: there is no surface to read")),
        _ => {
            let problem = format!("has several meshes: choose one with --prim: {}", listed(&names));
            Err(IoError::content(file, "stage", problem))
        }
    }
}

fn descriptor(prim: &Prim, when: When) -> Result<Descriptor, String> {
    for attribute in ["faceVertexCounts", "faceVertexIndices"] {
        let times = prim.times(attribute);
        let first = times.first().map(|&t| prim.value(attribute, When::At(t)));
        if first.is_some_and(|first| times.iter().any(|&t| prim.value(attribute, When::At(t)) != first)) {
            return Err(format!("{attribute} changes with time: give each topology a mesh of its own"));
        }
    }
    let get = |name| indices(prim, name, when);
    let one_of = |name: &str, choices: &[&'static str]| match prim.token(name) {
        None => Ok(choices[0]),
        Some(token) => choices.iter().copied().find(|&choice| choice == token).ok_or_else(|| {
            format!("{name} is {}, which is not known: choose from {}", quote(&token), choices.join(", "))
        }),
    };
    let boundary = match one_of("interpolateBoundary", &["edgeAndCorner", "edgeOnly", "none"])? {
        "edgeOnly" => BoundaryInterpolation::EdgeOnly,
        "none" => BoundaryInterpolation::None,
        _ => BoundaryInterpolation::EdgeAndCorner,
    };
    let triangles = match one_of("triangleSubdivisionRule", &["catmullClark", "smooth"])? {
        "smooth" => TriangleSubdivision::Smooth,
        _ => TriangleSubdivision::Catmark,
    };
    let creasing = match one_of(CREASING, &["uniform", "chaikin"])? {
        "chaikin" => CreasingMethod::Chaikin,
        _ => CreasingMethod::Uniform,
    };
    let required = |name| get(name)?.ok_or_else(|| format!("{name} is missing: a mesh needs it"));
    Ok(Descriptor {
        num_vertices: 0,
        face_sizes: required("faceVertexCounts")?,
        face_vertices: required("faceVertexIndices")?,
        creases: creases(prim, when)?,
        corners: corners(prim, when)?,
        holes: get("holeIndices")?.unwrap_or_default(),
        boundary,
        creasing,
        triangles,
        left_handed: one_of("orientation", &["rightHanded", "leftHanded"])? == "leftHanded",
    })
}

fn indices(prim: &Prim, name: &str, when: When) -> Result<Option<Vec<u32>>, String> {
    let Some(value) = prim.value(name, when) else { return Ok(None) };
    let integers = match value {
        Value::IntVec(integers) => integers,
        value if is_empty_list(&value) => Vec::new(),
        _ => return Err(format!("{name} is not of type int[]: give it that type")),
    };
    let negative = integers.iter().position(|&i| i < 0);
    match negative {
        Some(i) => Err(format!("{name}[{i}] is {}: indices start at 0, correct it", integers[i])),
        None => Ok(Some(integers.into_iter().map(|i| i as u32).collect())),
    }
}

fn floats(prim: &Prim, name: &str, when: When) -> Result<Option<Vec<f64>>, String> {
    let Some(value) = prim.value(name, when) else { return Ok(None) };
    match numbers(&value) {
        Some(numbers) => Ok(Some(numbers)),
        None if is_empty_list(&value) => Ok(Some(Vec::new())),
        None => Err(format!("{name} is not of type float[]: give it that type")),
    }
}

/// Chains of vertices, with one sharpness each, or one for each edge of each.
fn creases(prim: &Prim, when: When) -> Result<Vec<Crease>, String> {
    let vertices = indices(prim, "creaseIndices", when)?.unwrap_or_default();
    let lengths = indices(prim, "creaseLengths", when)?.unwrap_or_default();
    let sharpness = floats(prim, "creaseSharpnesses", when)?.unwrap_or_default();
    if let Some(i) = lengths.iter().position(|&n| n < 2) {
        return Err(format!("creaseLengths[{i}] is {}: a crease has two vertices or more", lengths[i]));
    }
    let total: u64 = lengths.iter().map(|&n| u64::from(n)).sum();
    if total != vertices.len() as u64 {
        let found = vertices.len();
        return Err(format!(
            "creaseLengths add up to {total}, but creaseIndices has {found} entries: make them agree"
        ));
    }
    let edges = vertices.len() - lengths.len();
    let of_edge = sharpness.len() == edges;
    if !of_edge && sharpness.len() != lengths.len() {
        return Err(format!(
            "creaseSharpnesses has {} entries: give it {} (one a crease) or {edges} (one an edge)",
            sharpness.len(),
            lengths.len()
        ));
    }
    let mut creases = Vec::with_capacity(edges);
    let mut rest = vertices.as_slice();
    for (i, &length) in lengths.iter().enumerate() {
        let (chain, tail) = rest.split_at(length as usize);
        rest = tail;
        for pair in chain.windows(2) {
            let at = if of_edge { creases.len() } else { i };
            creases.push(Crease { vertices: [pair[0], pair[1]], sharpness: sharpness[at] as f32 });
        }
    }
    Ok(creases)
}

fn corners(prim: &Prim, when: When) -> Result<Vec<Corner>, String> {
    let vertices = indices(prim, "cornerIndices", when)?.unwrap_or_default();
    let sharpness = floats(prim, "cornerSharpnesses", when)?.unwrap_or_default();
    if vertices.len() != sharpness.len() {
        return Err(format!(
            "cornerIndices has {} entries and cornerSharpnesses {}: make them agree",
            vertices.len(),
            sharpness.len()
        ));
    }
    let corner = |(vertex, sharpness)| Corner { vertex, sharpness: sharpness as f32 };
    Ok(vertices.into_iter().zip(sharpness).map(corner).collect())
}

fn positions(prim: &Prim, when: When) -> Result<Positions, String> {
    let value = prim.value("points", when).ok_or("points is missing: a mesh needs it")?;
    let points = match triples(&value) {
        Some(points) => points,
        None if is_empty_list(&value) => Vec::new(),
        None => return Err("points is not of type point3f[]: give it that type".to_owned()),
    };
    match points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
        Some(i) => Err(format!("points[{i}] is not finite: correct it")),
        None => Ok(Cochain::new(points.into_iter().map(Vector3::from).collect())),
    }
}

fn placement(prim: &Prim, when: When) -> Result<Option<Matrix4<f64>>, String> {
    let matrix = xform::placement(prim, when)?;
    if matrix.iter().any(|x| !x.is_finite()) {
        return Err("its transforms are not finite: correct them".to_owned());
    }
    Ok(Some(matrix).filter(|matrix| *matrix != Matrix4::identity()))
}

fn scheme(prim: &Prim, notes: &mut Vec<String>) -> Result<Option<OsdScheme>, String> {
    match prim.token("subdivisionScheme").as_deref() {
        None | Some("catmullClark") => Ok(Some(OsdScheme::Catmark)),
        Some("loop") => Ok(Some(OsdScheme::Loop)),
        Some("bilinear") => Ok(Some(OsdScheme::Bilinear)),
        Some("none") => {
            notes.push(format!(
                "{} is a mesh of polygons (subdivisionScheme none), refined all the same",
                prim.path
            ));
            Ok(None)
        }
        Some(other) => Err(format!(
            "subdivisionScheme is {}, which is not known: choose from catmullClark, loop, bilinear, none",
            quote(other)
        )),
    }
}

fn forms(prim: &Prim, when: When) -> Result<Forms, String> {
    Ok(Forms {
        form0: form(prim, 0, "vertex", when)?,
        form1: form(prim, 1, "faceVarying", when)?.map(Form1::Corners),
        form2: form(prim, 2, "uniform", when)?,
    })
}

fn form(prim: &Prim, degree: usize, expected: &str, when: When) -> Result<Option<Vec<f64>>, String> {
    let name = format!("primvars:form{degree}");
    let Some(values) = floats(prim, &name, when)? else { return Ok(None) };
    let interpolation = match prim.attribute(&name).and_then(|spec| spec.get("interpolation")) {
        Some(Value::Token(token)) => token.as_str(),
        _ => "constant",
    };
    if interpolation != expected {
        return Err(format!("{name} has the interpolation {}: it must be {expected}", quote(interpolation)));
    }
    let Some(indices) = indices(prim, &format!("{name}:indices"), when)? else { return Ok(Some(values)) };
    let value = |(i, &index): (usize, &u32)| {
        values.get(index as usize).copied().ok_or_else(|| {
            format!("{name}:indices[{i}] is {index}, but there are {} values: correct it", values.len())
        })
    };
    indices.iter().enumerate().map(value).collect::<Result<_, _>>().map(Some)
}

fn frames(prim: &Prim, frames: Frames) -> Result<Vec<Frame>, String> {
    let times = match frames {
        Frames::Rest => return Ok(Vec::new()),
        Frames::At(time) => vec![time],
        Frames::All => prim.times("points"),
        Frames::Range(first, last) => {
            prim.times("points").into_iter().filter(|t| (first..=last).contains(t)).collect()
        }
    };
    if times.is_empty() {
        return Err("points has no time samples there: leave --frames out or give one time".to_owned());
    }
    let frame = |&time: &f64| {
        let when = When::At(time);
        let here = |problem: String| format!("at time {time}: {problem}");
        Ok(Frame {
            time,
            positions: positions(prim, when).map_err(here)?,
            placement: placement(prim, when).map_err(here)?,
        })
    };
    let frames: Vec<Frame> = times.iter().map(frame).collect::<Result<_, String>>()?;
    let count = frames[0].positions.len();
    match frames.iter().find(|frame| frame.positions.len() != count) {
        Some(frame) => Err(format!(
            "points has {} entries at time {} and {count} at time {}: make them agree",
            frame.positions.len(),
            frame.time,
            times[0]
        )),
        None => Ok(frames),
    }
}
