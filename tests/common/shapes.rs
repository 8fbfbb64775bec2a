use std::path::PathBuf;

use formwork::topology::{
    BoundaryInterpolation, Corner, Crease, CreasingMethod, Descriptor, TriangleSubdivision,
};
use serde::Deserialize;

/// One of OpenSubdiv's regression shapes, as the folder `OPENSUBDIV_SHAPES` holds it.
#[derive(Deserialize)]
pub struct Shape {
    pub name: String,
    pub scheme: String,
    left_handed: bool,
    boundary: String,
    creasing: String,
    triangle_subdivision: String,
    verts: Vec<[f64; 3]>,
    nverts_per_face: Vec<u32>,
    face_verts: Vec<u32>,
    creases: Vec<(u32, u32, f32)>,
    corners: Vec<(u32, f32)>,
    holes: Vec<u32>,
}

impl Shape {
    pub fn descriptor(&self) -> Descriptor {
        Descriptor {
            num_vertices: self.verts.len(),
            face_sizes: self.nverts_per_face.clone(),
            face_vertices: self.face_verts.clone(),
            creases: self
                .creases
                .iter()
                .map(|&(a, b, sharpness)| Crease { vertices: [a, b], sharpness })
                .collect(),
            corners: self.corners.iter().map(|&(vertex, sharpness)| Corner { vertex, sharpness }).collect(),
            holes: self.holes.clone(),
            boundary: match self.boundary.as_str() {
                "none" => BoundaryInterpolation::None,
                "edge_only" => BoundaryInterpolation::EdgeOnly,
                "edge_and_corner" => BoundaryInterpolation::EdgeAndCorner,
                other => panic!("{}: boundary {other}", self.name),
            },
            creasing: match self.creasing.as_str() {
                "uniform" => CreasingMethod::Uniform,
                "chaikin" => CreasingMethod::Chaikin,
                other => panic!("{}: creasing {other}", self.name),
            },
            triangles: match self.triangle_subdivision.as_str() {
                "catmark" => TriangleSubdivision::Catmark,
                "smooth" => TriangleSubdivision::Smooth,
                other => panic!("{}: triangle subdivision {other}", self.name),
            },
            left_handed: self.left_handed,
        }
    }
}

/// The shapes of one scheme, by name; `None`, having said so, if the folder is absent.
pub fn shapes(scheme: &str) -> Option<Vec<Shape>> {
    let Some(folder) = std::env::var_os("OPENSUBDIV_SHAPES").map(PathBuf::from).filter(|f| f.is_dir()) else {
        eprintln!("skipped: OPENSUBDIV_SHAPES does not name a folder of shapes");
        return None;
    };
    let mut shapes: Vec<Shape> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .map(|path| serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap())
        .filter(|shape: &Shape| shape.scheme == scheme)
        .collect();
    shapes.sort_by(|a, b| a.name.cmp(&b.name));
    assert!(!shapes.is_empty(), "the folder of shapes has none of scheme {scheme}");
    Some(shapes)
}
