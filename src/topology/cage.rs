use std::fmt;

use super::Descriptor;

/// The largest polygon that OpenSubdiv takes.
pub const MAX_FACE_SIZE: usize = 65_535;

/// The largest number of faces round a vertex: beyond it OpenSubdiv's weights overflow (it squares the
/// valence in 32 bits).
pub const MAX_VALENCE: usize = 46_340;

/// A checked control cage: the only thing that may cross to OpenSubdiv, which crashes on much of what
/// is refused here.
///
/// Invariants: at least one vertex and one face; every face has 3 to [`MAX_FACE_SIZE`] vertices, all in
/// range, none repeated within the face; creases name edges, corners vertices and holes faces that
/// exist; sharpnesses are finite and not negative; no vertex has more than [`MAX_VALENCE`] faces; all
/// counts fit 31 bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Cage(Descriptor);

impl Cage {
    /// Checks a descriptor.
    ///
    /// # Errors
    /// The first invariant that does not hold, naming the element.
    pub fn new(descriptor: Descriptor) -> Result<Self, TopologyError> {
        check_counts(&descriptor)?;
        check_faces(&descriptor)?;
        check_tags(&descriptor)?;
        Ok(Cage(descriptor))
    }

    /// The checked data.
    pub fn descriptor(&self) -> &Descriptor {
        &self.0
    }
}

/// The part of the input that an error is about. Numbers start at 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    /// A face of the cage.
    Face(u32),
    /// A vertex of the cage.
    Vertex(u32),
    /// An entry of [`Descriptor::creases`].
    Crease(usize),
    /// An entry of [`Descriptor::corners`].
    Corner(usize),
    /// An entry of [`Descriptor::holes`].
    Hole(usize),
}

impl fmt::Display for Element {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Element::Face(i) => write!(out, "face {i}"),
            Element::Vertex(i) => write!(out, "vertex {i}"),
            Element::Crease(i) => write!(out, "crease {i}"),
            Element::Corner(i) => write!(out, "corner {i}"),
            Element::Hole(i) => write!(out, "hole {i}"),
        }
    }
}

/// Why a descriptor is not a control cage. Numbers start at 0; every message ends with the remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum TopologyError {
    #[error("the mesh has no vertices: give it some")]
    NoVertices,
    #[error("the mesh has no faces: a surface needs at least one polygon")]
    NoFaces,
    #[error("{count} {what} are more than OpenSubdiv can number (2^31 - 1): split the mesh")]
    TooMany { what: &'static str, count: usize },
    #[error(
        "the faces ask for {expected} vertex indices and {actual} are given: make face_sizes and face_vertices agree"
    )]
    FaceSizeSum { expected: usize, actual: usize },
    #[error("face {face} has {size} vertices: a face needs at least 3, remove it or complete it")]
    FaceTooSmall { face: u32, size: u32 },
    #[error("face {face} has {size} vertices: OpenSubdiv takes at most {MAX_FACE_SIZE}, split it")]
    FaceTooLarge { face: u32, size: u32 },
    #[error("face {face} refers to vertex {vertex}, but there are {num_vertices} vertices (0 to {}): correct the index", num_vertices - 1)]
    VertexOutOfRange { face: u32, vertex: u32, num_vertices: usize },
    #[error(
        "face {face} has vertex {vertex} more than once: --collapse drops a repetition of neighbours, anything else must be remodelled"
    )]
    RepeatedVertex { face: u32, vertex: u32 },
    #[error(
        "vertex {vertex} has {valence} faces: OpenSubdiv's weights hold up to {MAX_VALENCE}, split the fan"
    )]
    ValenceTooLarge { vertex: u32, valence: usize },
    #[error("{element} refers to {target} {index}, but there are {count}: correct the index")]
    TagOutOfRange { element: Element, target: &'static str, index: u32, count: usize },
    #[error("crease {crease} runs from vertex {} to vertex {}, which no face has as an edge: remove it or correct the vertices", vertices[0], vertices[1])]
    CreaseNotAnEdge { crease: usize, vertices: [u32; 2] },
    #[error("{element} has sharpness {value}: it must be a number from 0 (smooth) to 10 (infinitely sharp)")]
    Sharpness { element: Element, value: f32 },
}

impl TopologyError {
    /// The element that the error is about, so that a reader can name its place in the file.
    pub fn element(&self) -> Option<Element> {
        use TopologyError as E;
        match *self {
            E::FaceTooSmall { face, .. }
            | E::FaceTooLarge { face, .. }
            | E::VertexOutOfRange { face, .. }
            | E::RepeatedVertex { face, .. } => Some(Element::Face(face)),
            E::ValenceTooLarge { vertex, .. } => Some(Element::Vertex(vertex)),
            E::CreaseNotAnEdge { crease, .. } => Some(Element::Crease(crease)),
            E::TagOutOfRange { element, .. } | E::Sharpness { element, .. } => Some(element),
            E::NoVertices | E::NoFaces | E::TooMany { .. } | E::FaceSizeSum { .. } => None,
        }
    }
}

fn check_counts(d: &Descriptor) -> Result<(), TopologyError> {
    if d.num_vertices == 0 {
        return Err(TopologyError::NoVertices);
    }
    if d.face_sizes.is_empty() {
        return Err(TopologyError::NoFaces);
    }
    // Edges are at most as many as face corners, so these two bound every count of the cage.
    for (what, count) in [("vertices", d.num_vertices), ("face corners", d.face_vertices.len())] {
        if count > i32::MAX as usize {
            return Err(TopologyError::TooMany { what, count });
        }
    }
    let expected = d.face_sizes.iter().map(|&n| n as usize).sum();
    let actual = d.face_vertices.len();
    if expected != actual {
        return Err(TopologyError::FaceSizeSum { expected, actual });
    }
    Ok(())
}

fn check_faces(d: &Descriptor) -> Result<(), TopologyError> {
    let num_vertices = d.num_vertices;
    let mut valence = vec![0usize; num_vertices];
    let mut last_face = vec![u32::MAX; num_vertices];
    let mut rest = d.face_vertices.as_slice();
    for (face, &size) in d.face_sizes.iter().enumerate() {
        let face = face as u32;
        if size < 3 {
            return Err(TopologyError::FaceTooSmall { face, size });
        }
        if size as usize > MAX_FACE_SIZE {
            return Err(TopologyError::FaceTooLarge { face, size });
        }
        let (vertices, tail) = rest.split_at(size as usize);
        rest = tail;
        for &vertex in vertices {
            let v = vertex as usize;
            if v >= num_vertices {
                return Err(TopologyError::VertexOutOfRange { face, vertex, num_vertices });
            }
            if last_face[v] == face {
                return Err(TopologyError::RepeatedVertex { face, vertex });
            }
            last_face[v] = face;
            valence[v] += 1;
        }
    }
    match valence.iter().position(|&k| k > MAX_VALENCE) {
        Some(v) => Err(TopologyError::ValenceTooLarge { vertex: v as u32, valence: valence[v] }),
        None => Ok(()),
    }
}

fn check_tags(d: &Descriptor) -> Result<(), TopologyError> {
    let (vertices, faces) = (("vertex", d.num_vertices), ("face", d.face_sizes.len()));
    let in_range = |element, index: u32, (target, count): (&'static str, usize)| {
        if (index as usize) < count {
            Ok(())
        } else {
            Err(TopologyError::TagOutOfRange { element, target, index, count })
        }
    };
    let is_sharpness = |element, value: f32| {
        if value.is_finite() && value >= 0.0 {
            Ok(())
        } else {
            Err(TopologyError::Sharpness { element, value })
        }
    };

    if !d.creases.is_empty() {
        let edges = EdgeLookup::new(d.num_vertices, &d.face_sizes, &d.face_vertices);
        for (i, crease) in d.creases.iter().enumerate() {
            for v in crease.vertices {
                in_range(Element::Crease(i), v, vertices)?;
            }
            if !edges.contains(crease.vertices) {
                return Err(TopologyError::CreaseNotAnEdge { crease: i, vertices: crease.vertices });
            }
            is_sharpness(Element::Crease(i), crease.sharpness)?;
        }
    }
    for (i, corner) in d.corners.iter().enumerate() {
        in_range(Element::Corner(i), corner.vertex, vertices)?;
        is_sharpness(Element::Corner(i), corner.sharpness)?;
    }
    for (i, &hole) in d.holes.iter().enumerate() {
        in_range(Element::Hole(i), hole, faces)?;
    }
    Ok(())
}

/// Answers whether two vertices share an edge, for data that has no edges yet: for each vertex, the
/// higher-numbered ends of its edges. Built in linear time; vertices out of range are passed over.
pub(super) struct EdgeLookup {
    offsets: Vec<usize>,
    higher: Vec<u32>,
}

impl EdgeLookup {
    pub(super) fn new(num_vertices: usize, face_sizes: &[u32], face_vertices: &[u32]) -> Self {
        let for_each_edge = |visit: &mut dyn FnMut(u32, u32)| {
            let mut offset = 0;
            for &size in face_sizes {
                let end = (offset + size as usize).min(face_vertices.len());
                let face = &face_vertices[offset..end];
                offset = end;
                for (i, &a) in face.iter().enumerate() {
                    let b = face[(i + 1) % face.len()];
                    if (a.max(b) as usize) < num_vertices {
                        visit(a.min(b), a.max(b));
                    }
                }
            }
        };
        let mut offsets = vec![0usize; num_vertices + 1];
        for_each_edge(&mut |low, _| offsets[low as usize + 1] += 1);
        for v in 0..num_vertices {
            offsets[v + 1] += offsets[v];
        }
        let mut next = offsets.clone();
        let mut higher = vec![0; offsets[num_vertices]];
        for_each_edge(&mut |low, high| {
            higher[next[low as usize]] = high;
            next[low as usize] += 1;
        });
        EdgeLookup { offsets, higher }
    }

    pub(super) fn contains(&self, [a, b]: [u32; 2]) -> bool {
        let (low, high) = (a.min(b) as usize, a.max(b));
        low + 1 < self.offsets.len() && self.higher[self.offsets[low]..self.offsets[low + 1]].contains(&high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::{Corner, Crease};

    /// Two quads side by side: 0 1 2 3 and 1 4 5 2, and an isolated vertex 6.
    fn strip() -> Descriptor {
        Descriptor {
            num_vertices: 7,
            face_sizes: vec![4, 4],
            face_vertices: vec![0, 1, 2, 3, 1, 4, 5, 2],
            ..Default::default()
        }
    }

    fn refused(change: impl Fn(&mut Descriptor)) -> TopologyError {
        let mut d = strip();
        change(&mut d);
        Cage::new(d).unwrap_err()
    }

    #[test]
    fn each_invariant_is_checked() {
        use TopologyError as E;
        assert!(Cage::new(strip()).is_ok());
        assert_eq!(refused(|d| d.num_vertices = 0), E::NoVertices);
        assert_eq!(refused(|d| d.face_sizes.clear()), E::NoFaces);
        assert_eq!(refused(|d| d.face_vertices.truncate(7)), E::FaceSizeSum { expected: 8, actual: 7 });
        assert_eq!(
            refused(|d| (d.face_sizes[0], d.face_sizes[1]) = (2, 6)),
            E::FaceTooSmall { face: 0, size: 2 }
        );
        assert_eq!(
            refused(|d| d.face_vertices[6] = 7),
            E::VertexOutOfRange { face: 1, vertex: 7, num_vertices: 7 }
        );
        assert_eq!(refused(|d| d.face_vertices[2] = 0), E::RepeatedVertex { face: 0, vertex: 0 });
        let crease = |a, b, sharpness| Crease { vertices: [a, b], sharpness };
        assert_eq!(
            refused(|d| d.creases.push(crease(0, 2, 1.0))),
            E::CreaseNotAnEdge { crease: 0, vertices: [0, 2] }
        );
        assert!(matches!(refused(|d| d.creases.push(crease(0, 9, 1.0))), E::TagOutOfRange { index: 9, .. }));
        assert!(matches!(refused(|d| d.creases.push(crease(1, 0, -1.0))), E::Sharpness { .. }));
        assert!(matches!(refused(|d| d.creases.push(crease(1, 0, f32::NAN))), E::Sharpness { .. }));
        assert!(matches!(
            refused(|d| d.corners.push(Corner { vertex: 7, sharpness: 1.0 })),
            E::TagOutOfRange { element: Element::Corner(0), .. }
        ));
        assert!(matches!(refused(|d| d.holes.push(2)), E::TagOutOfRange { element: Element::Hole(0), .. }));
    }

    #[test]
    fn valence_and_face_size_are_bounded() {
        let k = MAX_VALENCE as u32 + 1;
        let fan = Descriptor {
            num_vertices: k as usize + 1,
            face_sizes: vec![3; k as usize],
            face_vertices: (0..k).flat_map(|i| [0, 1 + i, 1 + (i + 1) % k]).collect(),
            ..Default::default()
        };
        assert!(matches!(Cage::new(fan), Err(TopologyError::ValenceTooLarge { vertex: 0, .. })));
        let n = MAX_FACE_SIZE as u32 + 1;
        let polygon = Descriptor {
            num_vertices: n as usize,
            face_sizes: vec![n],
            face_vertices: (0..n).collect(),
            ..Default::default()
        };
        assert!(matches!(Cage::new(polygon), Err(TopologyError::FaceTooLarge { face: 0, .. })));
    }

    #[test]
    fn collapse_turns_pole_quads_into_triangles_and_keeps_tags_on_their_elements() {
        let mut d = strip();
        d.num_vertices = 9;
        d.face_sizes = vec![4, 4, 4];
        d.face_vertices = vec![8, 8, 0, 0, 0, 1, 2, 2, 1, 4, 5, 2];
        d.holes = vec![0, 2];
        d.creases =
            vec![Crease { vertices: [8, 0], sharpness: 1.0 }, Crease { vertices: [2, 1], sharpness: 2.0 }];
        let report = d.collapse();
        assert_eq!((report.removed, report.reduced, report.kept), (vec![0], vec![1], vec![1, 2]));
        assert_eq!(d.face_sizes, [3, 4]);
        assert_eq!(d.face_vertices, [0, 1, 2, 1, 4, 5, 2]);
        assert_eq!(d.holes, [1]);
        assert_eq!(d.creases, [Crease { vertices: [2, 1], sharpness: 2.0 }]);
        assert!(Cage::new(d).is_ok());
    }
}
