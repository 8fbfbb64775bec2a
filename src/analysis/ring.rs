//! The rings round a vertex with the operators that map them to themselves.

use nalgebra::DMatrix;

use super::AnalysisError;
use super::lattice::{Lattice, Place, Walk};
use super::symmetry::{Block, blocks};
use crate::hierarchy::{Hierarchy, HierarchyError};
use crate::limit::{block, dense};
use crate::scheme::Scheme;
use crate::topology::{Cage, Descriptor, SplitKind};

/// The most faces round a vertex, and the most rings.
const MOST_FACES: usize = 64;
const MOST_RINGS: usize = 8;

/// The rings of faces round one vertex, all else being regular, with `S0`, `S1` and `S2` from these rings to those round
/// the same vertex on the next level.
///
/// Cells are numbered ring by ring, counter-clockwise in each; vertex 0 is the one in the middle and vertex 1 the end of the
/// first spoke, at a boundary vertex a boundary edge. Edges are directed away from the middle or counter-clockwise. Two
/// rings are all that the limit on the faces of the vertex depends on.
pub struct Ring {
    scheme: Scheme,
    lattice: Lattice,
    descriptor: Descriptor,
    places: [Vec<Place>; 3],
    operators: [DMatrix<f64>; 3],
}

impl Ring {
    /// The rings round a vertex with `faces` faces, inside the surface or on its boundary, with the crease rule there.
    ///
    /// [`Scheme::Whitney`] is taken on triangles; on quads it is [`Scheme::Bilinear`].
    ///
    /// # Errors
    /// If there is no such vertex, or OpenSubdiv fails.
    pub fn new(scheme: Scheme, faces: usize, boundary: bool, rings: usize) -> Result<Self, AnalysisError> {
        let fewest = if boundary { 1 } else { 3 };
        if !(fewest..=MOST_FACES).contains(&faces) {
            return Err(AnalysisError::Valence { faces, most: MOST_FACES });
        }
        if !(2..=MOST_RINGS).contains(&rings) {
            return Err(AnalysisError::Rings { rings, most: MOST_RINGS });
        }
        let kind = match scheme {
            Scheme::Catmark(_) | Scheme::Bilinear => SplitKind::Quad,
            Scheme::Loop(..) | Scheme::Whitney => SplitKind::Triangle,
        };
        let lattice = Lattice { kind, sectors: faces, cyclic: !boundary, rings };
        // One ring more, so that all vertices of the rings have their faces.
        let descriptor = disk(Lattice { rings: rings + 1, ..lattice });
        let cage = Cage::new(descriptor.clone()).map_err(HierarchyError::from)?;
        let hierarchy = Hierarchy::new(&cage, scheme, 1)?;
        let (parent, child) = (hierarchy.level(0).mesh(), hierarchy.level(1).mesh());
        let fan = parent.fans(0).next().expect("the vertex in the middle has faces").corners;
        let first = fan.iter().position(|&c| parent.head(parent.corner_half_edge(c)) == 1);
        let first = first.expect("vertex 1 is a neighbour");
        let start: Vec<u32> = (0..faces).map(|s| fan[(first + s) % faces]).collect();
        let split = hierarchy.refinement(1).split();
        let below: Vec<u32> = start.iter().map(|&c| split.corner_at(parent, c)).collect();

        let places = [0, 1, 2].map(|k| lattice.cells(k));
        let [from, to] = [Walk::new(parent, lattice, &start), Walk::new(child, lattice, &below)];
        let operators = hierarchy.operators(1);
        let matrices = [&operators.s0, &operators.s1, &operators.s2];
        let operators = [0, 1, 2].map(|k| {
            let signed = |walk: &Walk| -> Vec<_> { places[k].iter().map(|&p| walk.signed(p)).collect() };
            dense(&block(matrices[k], &signed(&from), &signed(&to)))
        });
        Ok(Ring { scheme, lattice, descriptor, places, operators })
    }

    /// The scheme.
    pub fn scheme(&self) -> Scheme {
        self.scheme
    }

    /// The number of faces at the vertex.
    pub fn faces(&self) -> usize {
        self.lattice.sectors
    }

    /// Whether the vertex is on the boundary.
    pub fn is_boundary(&self) -> bool {
        !self.lattice.cyclic
    }

    /// The number of rings.
    pub fn rings(&self) -> usize {
        self.lattice.rings
    }

    /// How faces are split: quads, or triangles.
    pub fn split_kind(&self) -> SplitKind {
        self.lattice.kind
    }

    /// The number of cells of dimension `k` in the rings.
    ///
    /// # Panics
    /// If `k > 2`.
    pub fn num_cells(&self, k: usize) -> usize {
        self.places[k].len()
    }

    /// `S0`, `S1` or `S2` on the rings, square.
    ///
    /// # Panics
    /// If `k > 2`.
    pub fn operator(&self, k: usize) -> &DMatrix<f64> {
        &self.operators[k]
    }

    /// The same, split by the symmetry of the rings.
    ///
    /// # Panics
    /// If `k > 2`.
    pub fn blocks(&self, k: usize) -> Vec<Block> {
        blocks(&self.lattice, &self.places[k], &self.operators[k])
    }

    /// The cage: these rings and one more. Its first vertices and faces are theirs.
    pub fn descriptor(&self) -> &Descriptor {
        &self.descriptor
    }

    /// The two vertices of each edge of the rings, in its direction.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let at = |place: Place| {
            let place = self.lattice.normal(place);
            self.places[0].iter().position(|&p| p == place).expect("the rings have both ends") as u32
        };
        let ends = |&edge: &Place| self.lattice.ends(edge).map(at);
        self.places[1].iter().map(ends).collect()
    }

    /// The ring, from 1, that a face lies in.
    ///
    /// # Panics
    /// If there is no such face.
    pub fn ring_of_face(&self, face: usize) -> usize {
        self.lattice.ring_of_face(self.places[2][face])
    }

    /// The number of vertices of the first `rings` rings, the one in the middle included.
    pub fn num_vertices_to(&self, rings: usize) -> usize {
        self.places[0].iter().filter(|p| self.lattice.ring(p.i, p.j) <= rings).count()
    }

    pub(super) fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    pub(super) fn places(&self, k: usize) -> &[Place] {
        &self.places[k]
    }
}

/// A disk of these rings.
fn disk(lattice: Lattice) -> Descriptor {
    let vertices = lattice.cells(0);
    let number =
        |place: Place| vertices.iter().position(|&p| p == place).expect("a corner is a vertex") as u32;
    let faces: Vec<Vec<u32>> =
        lattice.cells(2).into_iter().map(|f| lattice.corners(f).into_iter().map(number).collect()).collect();
    Descriptor {
        num_vertices: vertices.len(),
        face_sizes: faces.iter().map(|face| face.len() as u32).collect(),
        face_vertices: faces.concat(),
        ..Default::default()
    }
}
