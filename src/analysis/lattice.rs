//! The cells of the rings round a vertex, by their places in sectors, and their numbers on any mesh.
//!
//! A sector is what lies between two spokes. Its vertices are lattice points `(i, j)`, `i` counted along its first spoke and
//! `j` along the next one; those with `i = 0` belong to the next sector. Ring `r` of a quad lattice has `max(i, j) = r`, of a
//! triangle lattice `i + j = r`.

use crate::topology::{HalfEdge, Mesh, SplitKind};

/// The rings of one vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lattice {
    pub kind: SplitKind,
    /// The number of sectors: faces at the vertex.
    pub sectors: usize,
    /// Whether they close a circle.
    pub cyclic: bool,
    /// The number of rings of faces.
    pub rings: usize,
}

/// What a cell is, the lattice point `(i, j)` being its corner nearest to both spokes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// The point itself.
    Vertex,
    /// The edge to `(i + 1, j)`.
    AlongI,
    /// The edge to `(i, j + 1)`.
    AlongJ,
    /// The edge from `(i + 1, j)` to `(i, j + 1)`, on triangles.
    Across,
    /// The square up to `(i + 1, j + 1)`, or the triangle with `(i + 1, j)` and `(i, j + 1)`.
    Face,
    /// The triangle `(i + 1, j), (i + 1, j + 1), (i, j + 1)`.
    Beyond,
}

/// A cell by its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    pub sector: usize,
    pub shape: Shape,
    pub i: usize,
    pub j: usize,
}

impl Place {
    pub fn new(sector: usize, shape: Shape, i: usize, j: usize) -> Self {
        Place { sector, shape, i, j }
    }

    /// Whether this is the vertex in the middle.
    pub fn is_centre(self) -> bool {
        self.shape == Shape::Vertex && self.i + self.j == 0
    }

    /// Six times the middle of the cell.
    fn middle(self) -> [usize; 2] {
        let (i, j) = (6 * self.i, 6 * self.j);
        match self.shape {
            Shape::Vertex => [i, j],
            Shape::AlongI => [i + 3, j],
            Shape::AlongJ => [i, j + 3],
            Shape::Across => [i + 3, j + 3],
            Shape::Face => [i + 2, j + 2],
            Shape::Beyond => [i + 4, j + 4],
        }
    }
}

impl Lattice {
    /// The cells of dimension `k`, ring by ring and counter-clockwise in each.
    pub fn cells(&self, k: usize) -> Vec<Place> {
        let shapes: &[Shape] = match (k, self.kind) {
            (0, _) => &[Shape::Vertex],
            (1, SplitKind::Quad) => &[Shape::AlongI, Shape::AlongJ],
            (1, SplitKind::Triangle) => &[Shape::AlongI, Shape::AlongJ, Shape::Across],
            (_, SplitKind::Quad) => &[Shape::Face],
            (_, SplitKind::Triangle) => &[Shape::Face, Shape::Beyond],
        };
        let spokes = if self.cyclic { self.sectors } else { self.sectors + 1 };
        let mut cells = Vec::new();
        for sector in 0..spokes {
            for &shape in shapes {
                for i in 0..=self.rings {
                    for j in 0..=self.rings {
                        let place = Place::new(sector, shape, i, j);
                        // Beyond the last spoke of an open fan there is the spoke only.
                        let on_spoke = j == 0 && matches!(shape, Shape::Vertex | Shape::AlongI);
                        let in_sector = sector < self.sectors || on_spoke;
                        if in_sector && self.contains(place) && self.normal(place) == place {
                            cells.push(place);
                        }
                    }
                }
            }
        }
        cells.sort_by_key(|&place| {
            let [x, y] = place.middle();
            let (radius, angle) = match self.kind {
                SplitKind::Triangle => (x + y, y),
                SplitKind::Quad if x >= y => (x, y),
                SplitKind::Quad => (y, 2 * y - x),
            };
            (radius, place.sector, angle)
        });
        cells
    }

    fn contains(&self, place: Place) -> bool {
        let Place { i, j, .. } = place;
        let [a, b] = match place.shape {
            Shape::Vertex => [i, j],
            Shape::AlongI => [i + 1, j],
            Shape::AlongJ => [i, j + 1],
            Shape::Across => [i + 1, j],
            Shape::Face if self.kind == SplitKind::Triangle => [i + 1, j],
            Shape::Face | Shape::Beyond => [i + 1, j + 1],
        };
        self.ring(a, b) <= self.rings
    }

    /// The ring of a lattice point.
    pub fn ring(&self, i: usize, j: usize) -> usize {
        match self.kind {
            SplitKind::Quad => i.max(j),
            SplitKind::Triangle => i + j,
        }
    }

    /// The one name of a place: what lies on the next spoke belongs to the next sector, the centre to the first.
    pub fn normal(&self, place: Place) -> Place {
        let Place { sector, shape, i, j } = place;
        let next = if self.cyclic { (sector + 1) % self.sectors } else { sector + 1 };
        match (shape, i, j) {
            (Shape::Vertex, 0, 0) => Place::new(0, shape, 0, 0),
            (Shape::Vertex, 0, _) => Place::new(next, shape, j, 0),
            (Shape::AlongJ, 0, _) => Place::new(next, Shape::AlongI, j, 0),
            _ => place,
        }
    }

    /// The cell opposite under the reflection of an open fan, and the sign of its direction or orientation there.
    pub fn mirrored(&self, place: Place) -> (Place, f64) {
        let (shape, sign) = match place.shape {
            Shape::AlongI => (Shape::AlongJ, 1.0),
            Shape::AlongJ => (Shape::AlongI, 1.0),
            Shape::Vertex => (Shape::Vertex, 1.0),
            turned => (turned, -1.0),
        };
        // A spoke is the end of the sector before it, too.
        if place.sector == self.sectors {
            return (self.normal(Place::new(0, place.shape, place.i, 0)), 1.0);
        }
        (self.normal(Place::new(self.sectors - 1 - place.sector, shape, place.j, place.i)), sign)
    }

    /// The ring, from 1, that a face lies in.
    pub fn ring_of_face(&self, face: Place) -> usize {
        1 + match (self.kind, face.shape) {
            (SplitKind::Triangle, Shape::Beyond) => face.i + face.j + 1,
            _ => self.ring(face.i, face.j),
        }
    }

    /// The two vertices of an edge, not yet in their normal form.
    pub fn ends(&self, edge: Place) -> [Place; 2] {
        let Place { sector, i, j, .. } = edge;
        let [a, b] = match edge.shape {
            Shape::AlongI => [(0, 0), (1, 0)],
            Shape::AlongJ => [(0, 0), (0, 1)],
            _ => [(1, 0), (0, 1)],
        };
        [a, b].map(|(p, q)| Place::new(sector, Shape::Vertex, i + p, j + q))
    }

    /// The corners of a face, counter-clockwise from its lattice point.
    pub fn corners(&self, face: Place) -> Vec<Place> {
        let Place { sector, i, j, .. } = face;
        let points: &[(usize, usize)] = match (self.kind, face.shape) {
            (SplitKind::Quad, _) => &[(0, 0), (1, 0), (1, 1), (0, 1)],
            (SplitKind::Triangle, Shape::Beyond) => &[(1, 0), (1, 1), (0, 1)],
            (SplitKind::Triangle, _) => &[(0, 0), (1, 0), (0, 1)],
        };
        let at = |&(a, b): &(usize, usize)| self.normal(Place::new(sector, Shape::Vertex, i + a, j + b));
        points.iter().map(at).collect()
    }
}

/// The lattice found on a mesh: for each sector the corner of each face at its lattice point.
pub struct Walk<'a> {
    mesh: &'a Mesh,
    lattice: Lattice,
    corners: Vec<Vec<u32>>,
}

impl<'a> Walk<'a> {
    /// Walks from the corners of the vertex in the middle, one a sector, counter-clockwise.
    ///
    /// # Panics
    /// If the mesh does not continue as the lattice does.
    pub fn new(mesh: &'a Mesh, lattice: Lattice, start: &[u32]) -> Self {
        let mut walk = Walk { mesh, lattice, corners: Vec::new() };
        for &start in start {
            let n = lattice.rings;
            let mut corners = vec![u32::MAX; n * n];
            for i in 0..n {
                corners[i * n] = if i == 0 { start } else { walk.step(corners[(i - 1) * n], true) };
                for j in (1..n).filter(|&j| lattice.kind == SplitKind::Quad || i + j < n) {
                    corners[i * n + j] = walk.step(corners[i * n + j - 1], false);
                }
            }
            walk.corners.push(corners);
        }
        walk
    }

    fn turn(&self, corner: u32, steps: usize) -> u32 {
        (0..steps).fold(corner, |c, _| self.mesh.next_corner(c))
    }

    /// The corner, beyond the edge that leaves a corner, at that edge's far end.
    fn beyond(&self, corner: u32) -> u32 {
        let twin = self.mesh.corner_half_edge(corner).twin();
        self.mesh.left_corner(twin).expect("the rings lie inside the mesh")
    }

    /// From the corner of a lattice point to that of the next one along `i` or `j`.
    fn step(&self, corner: u32, along_i: bool) -> u32 {
        let from = match self.lattice.kind {
            SplitKind::Quad => corner,
            SplitKind::Triangle => self.beyond(self.turn(corner, 1)),
        };
        match along_i {
            true => self.turn(self.beyond(self.turn(from, 1)), 1),
            false => self.beyond(self.turn(from, 2)),
        }
    }

    fn corner(&self, sector: usize, i: usize, j: usize) -> u32 {
        self.corners[sector][i * self.lattice.rings + j]
    }

    /// The half-edge of an edge.
    fn half_edge(&self, place: Place) -> HalfEdge {
        let Place { sector, shape, i, j } = place;
        let n = self.lattice.rings;
        if sector == self.lattice.sectors {
            return self.half_edge(Place::new(sector - 1, Shape::AlongJ, j, i));
        }
        let leaving = |i, j, steps| self.mesh.corner_half_edge(self.turn(self.corner(sector, i, j), steps));
        let last = if self.lattice.kind == SplitKind::Quad { 3 } else { 2 };
        match shape {
            Shape::AlongI if j < n => leaving(i, j, 0),
            Shape::AlongI => leaving(i, j - 1, 2).twin(),
            Shape::AlongJ if i < n => leaving(i, j, last).twin(),
            Shape::AlongJ => leaving(i - 1, j, 1),
            _ => leaving(i, j, 1),
        }
    }

    /// A cell's number with the sign of its direction on the mesh.
    pub fn signed(&self, place: Place) -> (u32, f64) {
        let Place { sector, shape, i, j } = place;
        let head = |edge: Place| self.mesh.head(self.half_edge(edge));
        match shape {
            Shape::Vertex if i + j == 0 => (self.mesh.corner_vertex(self.corner(0, 0, 0)), 1.0),
            Shape::Vertex if i > 0 => (head(Place::new(sector, Shape::AlongI, i - 1, j)), 1.0),
            Shape::Vertex => (head(Place::new(sector, Shape::AlongJ, i, j - 1)), 1.0),
            Shape::Face => (self.mesh.corner_face(self.corner(sector, i, j)), 1.0),
            Shape::Beyond => {
                (self.mesh.corner_face(self.beyond(self.turn(self.corner(sector, i, j), 1))), 1.0)
            }
            _ => {
                let h = self.half_edge(place);
                (h.edge(), h.sign())
            }
        }
    }
}
