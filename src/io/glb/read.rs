use std::collections::{BTreeSet, HashSet};
use std::path::Path;

use gltf::accessor::{DataType, Dimensions};
use gltf::mesh::Mode;
use gltf::{Gltf, Node, Primitive, Semantic};
use nalgebra::{Matrix4, Vector3};
use serde::Deserialize;

use super::EXTRAS;
use super::buffers::Buffers;
use super::weld::Soup;
use super::write::fans;
use crate::cochain::Cochain;
use crate::io::error::quote;
use crate::io::{Asset, Form1, Forms, IoError, LoadOptions, json};
use crate::topology::Descriptor;

/// Reads a mesh from the contents of a file, text or binary. `path` is used in messages, and to find the
/// files that a text file names.
///
/// # Errors
/// [`IoError::Content`] with the node and primitive that are wrong, or the list of nodes if there are
/// several with triangles and `options` name none; [`IoError::Read`] for a file beside it.
pub fn parse(path: &Path, bytes: &[u8], options: &LoadOptions) -> Result<Asset, IoError> {
    let name = path.display().to_string();
    let gltf = Gltf::from_slice(bytes).map_err(|error| {
        IoError::content(&name, "glTF", format!("the reader refuses the file ({error}): export it again"))
    })?;
    let placed = placed_nodes(&gltf);
    let (node, placement) = choose(&name, &placed, options.prim.as_deref())?;
    let label = label(node);
    let fail = |problem: String| IoError::content(&name, &label, problem);

    let buffers = Buffers::load(path, &gltf)?;
    let mut notes = Vec::new();
    let soup = soup(&buffers, node, &mut notes).map_err(fail)?;
    let mut asset = match ours(node, &soup, &mut notes) {
        Some(mut asset) => {
            let points = soup.points.iter().map(|p| Vector3::from(p.map(f64::from))).collect();
            asset.descriptor.num_vertices = soup.points.len();
            asset.positions = Cochain::new(points);
            asset
        }
        None => welded(&soup, &mut notes),
    };
    if let Some(v) = asset.positions.values().iter().position(|x| x.iter().any(|x| !x.is_finite())) {
        return Err(fail(format!("vertex {v} has a coordinate that is not finite: correct it")));
    }
    asset.placement = (placement != Matrix4::identity()).then_some(placement);
    if placed.len() > 1 {
        asset.prim = Some(label);
    }
    (asset.name, asset.notes) = (name, notes);
    Ok(asset)
}

/// `node 3 "body"`: names need not be there, nor be different.
fn label(node: &Node) -> String {
    match node.name() {
        Some(name) => format!("node {} {name:?}", node.index()),
        None => format!("node {}", node.index()),
    }
}

/// The nodes of the scene with triangles, and where they stand.
fn placed_nodes(gltf: &Gltf) -> Vec<(Node<'_>, Matrix4<f64>)> {
    let scene = gltf.default_scene().or_else(|| gltf.scenes().next());
    let roots: Vec<Node> = match scene {
        Some(scene) => scene.nodes().collect(),
        None => gltf.nodes().collect(),
    };
    let mut open: Vec<_> = roots.into_iter().rev().map(|node| (node, Matrix4::identity())).collect();
    let (mut seen, mut placed) = (HashSet::new(), Vec::new());
    // A file may claim that a node is its own descendant.
    while let Some((node, above)) = open.pop() {
        if !seen.insert(node.index()) {
            continue;
        }
        let matrix = above * Matrix4::from(node.transform().matrix()).cast::<f64>();
        let children: Vec<_> = node.children().map(|child| (child, matrix)).collect();
        open.extend(children.into_iter().rev());
        let has_triangles = |mesh: gltf::Mesh| mesh.primitives().any(|p| is_surface(&p));
        if node.mesh().is_some_and(has_triangles) {
            placed.push((node, matrix));
        }
    }
    placed
}

fn is_surface(primitive: &Primitive) -> bool {
    matches!(primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)
}

fn choose<'a, 'g>(
    file: &str,
    placed: &'a [(Node<'g>, Matrix4<f64>)],
    prim: Option<&str>,
) -> Result<(&'a Node<'g>, Matrix4<f64>), IoError> {
    let list = || {
        let mut names: Vec<String> = placed.iter().take(8).map(|(node, _)| label(node)).collect();
        if placed.len() > 8 {
            names.push(format!("{} more", placed.len() - 8));
        }
        names.join(", ")
    };
    let found: Vec<_> = match prim {
        None => placed.iter().collect(),
        Some(prim) => placed
            .iter()
            .filter(|(node, _)| node.name() == Some(prim) || node.index().to_string() == prim)
            .collect(),
    };
    match (&found[..], prim) {
        ([(node, matrix)], _) => Ok((node, *matrix)),
        (_, None) if placed.is_empty() => {
            Err(IoError::content(file, "scene", "has no node with triangles: there is no surface to read"))
        }
        ([], Some(prim)) => {
            let problem = format!("no node with triangles has this name or number: choose from {}", list());
            Err(IoError::content(file, &format!("--prim {}", quote(prim)), problem))
        }
        _ => Err(IoError::content(
            file,
            "scene",
            format!(
                "has several nodes with triangles: choose one with --prim, by name or number: {}",
                list()
            ),
        )),
    }
}

/// Gathers the triangles of a node's primitives.
fn soup(buffers: &Buffers, node: &Node, notes: &mut Vec<String>) -> Result<Soup, String> {
    let mesh = node.mesh().ok_or("has no mesh")?;
    let mut soup = Soup { form0: Some(Vec::new()), form1: Some(Vec::new()), ..Default::default() };
    let mut passed_over = HashSet::new();
    for primitive in mesh.primitives() {
        let fail = |problem: String| format!("primitive {}: {problem}", primitive.index());
        if !is_surface(&primitive) {
            passed_over.insert(format!("primitive {} (points or lines)", primitive.index()));
            continue;
        }
        add_primitive(buffers, &primitive, &mut soup, &mut passed_over).map_err(fail)?;
        if primitive.morph_targets().len() > 0 {
            passed_over.insert("morph targets".to_owned());
        }
    }
    if node.skin().is_some() {
        passed_over.insert("the skin: the mesh is read in its rest pose".to_owned());
    }
    // Our own files are given a material when they are written.
    if extras_text(node).is_some() {
        passed_over.remove("the material");
    }
    if !passed_over.is_empty() {
        let mut list: Vec<String> = passed_over.into_iter().collect();
        list.sort();
        notes.push(format!("ignored: {}", list.join(", ")));
    }
    Ok(soup)
}

fn add_primitive(
    buffers: &Buffers,
    primitive: &Primitive,
    soup: &mut Soup,
    passed_over: &mut HashSet<String>,
) -> Result<(), String> {
    let first = u32::try_from(soup.points.len()).map_err(|_| "too many vertices: split the mesh")?;
    let accessor = primitive.get(&Semantic::Positions).ok_or("has no POSITION: export the file again")?;
    soup.points.extend(buffers.items::<[f32; 3]>(accessor, &[DataType::F32], Dimensions::Vec3)?);
    let count = soup.points.len() as u32 - first;

    let indices: Vec<u32> = match primitive.indices() {
        None => (0..count).collect(),
        Some(accessor) => match accessor.data_type() {
            DataType::U8 => {
                buffers.items::<u8>(accessor, &[DataType::U8], Dimensions::Scalar)?.map(u32::from).collect()
            }
            DataType::U16 => {
                buffers.items::<u16>(accessor, &[DataType::U16], Dimensions::Scalar)?.map(u32::from).collect()
            }
            _ => buffers.items::<u32>(accessor, &[DataType::U32], Dimensions::Scalar)?.collect(),
        },
    };
    if let Some(i) = indices.iter().position(|&i| i >= count) {
        return Err(format!("index {i} is {}, but there are {count} vertices: correct it", indices[i]));
    }
    if primitive.mode() == Mode::Triangles && !indices.len().is_multiple_of(3) {
        return Err(format!("has {} indices, which are no triangles: export the file again", indices.len()));
    }
    let triangles: Vec<[u32; 3]> = match primitive.mode() {
        Mode::Triangles => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        Mode::TriangleFan => {
            let spokes = indices.get(1..).unwrap_or_default();
            spokes.windows(2).map(|pair| [indices[0], pair[0], pair[1]]).collect()
        }
        // Every other triangle of a strip is listed the other way round.
        _ => {
            let turned =
                |(i, t): (usize, &[u32])| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
            indices.windows(3).enumerate().map(turned).collect()
        }
    };
    soup.triangles.extend(triangles.into_iter().flatten().map(|i| first + i));

    let form = |name: &str| primitive.get(&Semantic::Extras(name.into()));
    soup.form0 = match (soup.form0.take(), form("FORM0")) {
        (Some(mut values), Some(accessor)) => {
            values.extend(buffers.items::<f32>(accessor, &[DataType::F32], Dimensions::Scalar)?);
            (values.len() == soup.points.len()).then_some(values)
        }
        _ => None,
    };
    soup.form1 = match (soup.form1.take(), form("FORM1")) {
        (Some(mut vectors), Some(accessor)) => {
            vectors.extend(buffers.items::<[f32; 3]>(accessor, &[DataType::F32], Dimensions::Vec3)?);
            (vectors.len() == soup.points.len()).then_some(vectors)
        }
        _ => None,
    };
    if primitive.material().index().is_some() {
        passed_over.insert("the material".to_owned());
    }
    for (semantic, _) in primitive.attributes() {
        let used = match &semantic {
            Semantic::Positions | Semantic::Normals | Semantic::Tangents => true,
            Semantic::Extras(name) => name == "FORM0" || name == "FORM1",
            _ => false,
        };
        if !used {
            passed_over.insert(format!("the attribute {}", semantic.to_string()));
        }
    }
    Ok(())
}

/// The extras of a node, if ours may be among them.
fn extras_text<'a>(node: &Node<'a>) -> Option<&'a str> {
    node.extras().as_ref().map(|extras| extras.get()).filter(|text| text.contains(EXTRAS))
}

/// What our extras say, if there are some and they fit the triangles: another program may have changed
/// those and kept the extras.
fn ours(node: &Node, soup: &Soup, notes: &mut Vec<String>) -> Option<Asset> {
    #[derive(Deserialize)]
    struct Extras {
        #[serde(rename = "formwork")]
        ours: Option<json::File>,
    }
    let text = extras_text(node)?;
    let mut refuse = |why: String| {
        notes.push(format!("ignored: the extras of formwork, as {why}; the triangles are read instead"));
        None
    };
    let file = match serde_json::from_str::<Extras>(text) {
        Ok(extras) => extras.ours?,
        Err(error) => return refuse(json::reason(&error)),
    };
    let sizes = file
        .face_sizes
        .iter()
        .try_fold(0usize, |sum, &n| if n < 3 { None } else { sum.checked_add(n as usize) });
    if sizes != Some(file.face_vertices.len()) {
        return refuse("their faces are no polygons".to_owned());
    }
    let mut rest = file.face_vertices.as_slice();
    let faces: Vec<&[u32]> = file
        .face_sizes
        .iter()
        .map(|&n| {
            let (face, tail) = rest.split_at(n as usize);
            rest = tail;
            face
        })
        .collect();
    let holes: HashSet<u32> = file.tags.iter().flat_map(|tags| tags.holes.iter().copied()).collect();
    let drawn =
        faces.iter().enumerate().filter(|(f, _)| !holes.contains(&(*f as u32))).map(|(_, &face)| face);
    if fans(drawn) != soup.triangles {
        return refuse("the mesh was changed after they were written".to_owned());
    }
    file.into_asset().map_or_else(refuse, Some)
}

fn welded(soup: &Soup, notes: &mut Vec<String>) -> Asset {
    let welded = soup.weld();
    if welded.unused > 0 {
        notes.push(format!("ignored: {} vertices that no triangle uses", welded.unused));
    }
    if welded.degenerate > 0 {
        notes.push(format!(
            "ignored: {} triangles with two corners at the same place; the faces after them have lower numbers",
            welded.degenerate
        ));
    }
    if welded.form1.is_some() {
        notes.push(
            "the 1-form is read from the vectors of _FORM1: along each edge the mean of both ends".to_owned(),
        );
    }
    let descriptor = Descriptor {
        num_vertices: welded.positions.len(),
        face_sizes: vec![3; welded.triangles.len() / 3],
        face_vertices: welded.triangles.clone(),
        ..Default::default()
    };
    let form1 = welded.form1.as_ref().map(|vectors| {
        let sides =
            descriptor.face_vertices.chunks_exact(3).flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]);
        let edges: BTreeSet<[u32; 2]> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        let along = |[a, b]: [u32; 2]| {
            let [i, j] = [a as usize, b as usize];
            let circulation =
                (vectors[i] + vectors[j]).dot(&(welded.positions[j] - welded.positions[i])) / 2.0;
            ([a, b], circulation)
        };
        Form1::Edges(edges.into_iter().map(along).collect())
    });
    let forms = Forms { form0: welded.form0, form1, form2: None };
    Asset { descriptor, positions: Cochain::new(welded.positions), forms, ..Default::default() }
}
