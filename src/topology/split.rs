use super::{HalfEdge, Mesh};

/// How the cells of one level become those of the next, and how the children are numbered and directed:
/// as OpenSubdiv does, with `V`, `E`, `F` the counts of the parent and `C` its corners.
///
/// | child | quad split | triangle split | |
/// |---|---|---|---|
/// | vertex of vertex `v` | `v` | `v` | |
/// | vertex of face `f` (its centre `p_f`) | `V + f` | | |
/// | vertex of edge `e` (its midpoint `m_e`) | `V + F + e` | `V + e` | |
/// | edge of corner `c` ("odd") | `c` | `c` | see [`ChildEdge::Odd`] |
/// | half of edge `e` at its end `j` ("even") | `C + 2e + j` | `C + 2e + j` | directed `m_e -> v` |
/// | face of corner `i` of face `f` | its corner | `4f + i` | |
/// | face in the middle of face `f` | | `4f + 3` | |
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Split {
    kind: SplitKind,
    num_vertices: usize,
    num_edges: usize,
    num_faces: usize,
    num_corners: usize,
}

/// The two ways to split faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SplitKind {
    /// A face of `n` vertices becomes `n` quads, one for each corner (Catmull-Clark, bilinear).
    Quad,
    /// A triangle becomes four: one at each corner and one in the middle (Loop).
    Triangle,
}

/// The parent of a child vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parent {
    /// A vertex.
    Vertex(u32),
    /// An edge.
    Edge(u32),
    /// A face.
    Face(u32),
}

/// The place of a child edge in its parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChildEdge {
    /// `m_e -> v`: the half of an edge at the tail `v` of this half-edge.
    Even(HalfEdge),
    /// Inside the face of this corner. Quad split: `p_f -> m_e`, to the edge that leaves the corner.
    /// Triangle split: `m_e -> m_e'`, from the edge that leaves the corner to the one that reaches it.
    Odd(u32),
}

impl Split {
    /// The split of a mesh in one of the two ways.
    ///
    /// # Panics
    /// If a mesh that has other faces than triangles is to be split as triangles.
    pub fn new(kind: SplitKind, mesh: &Mesh) -> Self {
        let split = Split {
            kind,
            num_vertices: mesh.num_vertices(),
            num_edges: mesh.num_edges(),
            num_faces: mesh.num_faces(),
            num_corners: mesh.num_corners(),
        };
        let triangles = || (0..mesh.num_faces() as u32).all(|f| mesh.face_size(f) == 3);
        assert!(kind == SplitKind::Quad || triangles(), "only triangles can be split as triangles");
        split
    }

    /// Which of the two ways.
    pub fn kind(&self) -> SplitKind {
        self.kind
    }

    /// The number of child vertices, edges or faces (`k` = 0, 1, 2).
    ///
    /// # Panics
    /// If `k > 2`.
    pub fn num_children(&self, k: usize) -> usize {
        let edges = self.num_corners + 2 * self.num_edges;
        match self.kind {
            SplitKind::Quad => {
                [self.num_vertices + self.num_faces + self.num_edges, edges, self.num_corners][k]
            }
            SplitKind::Triangle => [self.num_vertices + self.num_edges, edges, 4 * self.num_faces][k],
        }
    }

    /// The number of the first child vertex of an edge: those of the faces come before, if there are any.
    fn first_midpoint(&self) -> usize {
        match self.kind {
            SplitKind::Quad => self.num_vertices + self.num_faces,
            SplitKind::Triangle => self.num_vertices,
        }
    }

    /// The child vertex of a cell.
    ///
    /// # Panics
    /// For a face of the triangle split, which has none.
    #[inline]
    pub fn vertex_of(&self, parent: Parent) -> u32 {
        match parent {
            Parent::Vertex(v) => v,
            Parent::Face(f) => {
                assert!(self.kind == SplitKind::Quad, "a triangle has no child vertex");
                self.num_vertices as u32 + f
            }
            Parent::Edge(e) => self.first_midpoint() as u32 + e,
        }
    }

    /// The parent of a child vertex.
    #[inline]
    pub fn vertex_parent(&self, vertex: usize) -> Parent {
        if vertex < self.num_vertices {
            Parent::Vertex(vertex as u32)
        } else if vertex < self.first_midpoint() {
            Parent::Face((vertex - self.num_vertices) as u32)
        } else {
            Parent::Edge((vertex - self.first_midpoint()) as u32)
        }
    }

    /// The half of an edge at the tail of `h`, as a child edge (directed towards that tail).
    #[inline]
    pub fn even_edge(&self, h: HalfEdge) -> u32 {
        self.num_corners as u32 + h.0
    }

    /// The place of a child edge.
    #[inline]
    pub fn edge_parent(&self, edge: usize) -> ChildEdge {
        if edge < self.num_corners {
            ChildEdge::Odd(edge as u32)
        } else {
            ChildEdge::Even(HalfEdge((edge - self.num_corners) as u32))
        }
    }

    /// The child edge at a place.
    #[inline]
    pub fn edge_of(&self, place: ChildEdge) -> u32 {
        match place {
            ChildEdge::Even(h) => self.even_edge(h),
            ChildEdge::Odd(corner) => corner,
        }
    }

    /// The two ends of a child edge, in its direction, as the cells they come from.
    #[inline]
    pub fn edge_ends(&self, parent: &Mesh, place: ChildEdge) -> [Parent; 2] {
        let midpoint = |h: HalfEdge| Parent::Edge(h.edge());
        match place {
            ChildEdge::Even(h) => [midpoint(h), Parent::Vertex(parent.tail(h))],
            ChildEdge::Odd(c) => {
                let leaving = midpoint(parent.corner_half_edge(c));
                match self.kind {
                    SplitKind::Quad => [Parent::Face(parent.corner_face(c)), leaving],
                    SplitKind::Triangle => {
                        [leaving, midpoint(parent.corner_half_edge(parent.previous_corner(c)))]
                    }
                }
            }
        }
    }

    /// The boundary of a child face, counter-clockwise, as places of child edges with the sign in which they
    /// are run. It begins at the vertex of the parent's corner, for a triangle in the middle opposite to the
    /// first corner.
    #[inline]
    pub fn face_boundary(&self, parent: &Mesh, child: usize, mut visit: impl FnMut(ChildEdge, f64)) {
        if self.kind == SplitKind::Triangle && child % 4 == 3 {
            // From the midpoint of the edge before corner i to that of the edge after.
            let first = parent.corners(child as u32 / 4).start;
            return [2, 0, 1].iter().for_each(|i| visit(ChildEdge::Odd(first + i), -1.0));
        }
        let corner = self.parent_corner(parent, child);
        let previous = parent.previous_corner(corner);
        visit(ChildEdge::Even(parent.corner_half_edge(corner)), -1.0);
        match self.kind {
            SplitKind::Quad => {
                visit(ChildEdge::Odd(corner), -1.0);
                visit(ChildEdge::Odd(previous), 1.0);
            }
            SplitKind::Triangle => visit(ChildEdge::Odd(corner), 1.0),
        }
        visit(ChildEdge::Even(parent.corner_half_edge(previous).twin()), 1.0);
    }

    /// The child faces beside a child edge: two or, on a boundary, one. Of an edge that is not manifold its faces are not
    /// known, and there is none.
    pub fn faces_beside(&self, parent: &Mesh, place: ChildEdge) -> impl Iterator<Item = u32> {
        let at = |corner| self.face_at(parent, corner);
        let faces = match (place, self.kind) {
            (ChildEdge::Even(h), _) => {
                let right = parent.left_corner(h.twin()).map(|corner| parent.next_corner(corner));
                [parent.left_corner(h).map(at), right.map(at)]
            }
            (ChildEdge::Odd(corner), SplitKind::Quad) => {
                [Some(at(corner)), Some(at(parent.next_corner(corner)))]
            }
            (ChildEdge::Odd(corner), SplitKind::Triangle) => {
                [Some(at(corner)), Some(4 * parent.corner_face(corner) + 3)]
            }
        };
        faces.into_iter().flatten()
    }

    /// The corner of the parent at which a child face lies.
    ///
    /// # Panics
    /// May panic for a triangle in the middle of its parent, which lies at none.
    #[inline]
    pub fn parent_corner(&self, parent: &Mesh, child: usize) -> u32 {
        match self.kind {
            SplitKind::Quad => child as u32,
            SplitKind::Triangle => parent.corners(child as u32 / 4).start + child as u32 % 4,
        }
    }

    /// The parent of a child face.
    #[inline]
    pub fn face_parent(&self, mesh: &Mesh, face: usize) -> u32 {
        match self.kind {
            SplitKind::Quad => mesh.corner_face(face as u32),
            SplitKind::Triangle => face as u32 / 4,
        }
    }

    /// The child face at a corner.
    #[inline]
    pub fn face_at(&self, mesh: &Mesh, corner: u32) -> u32 {
        match self.kind {
            SplitKind::Quad => corner,
            SplitKind::Triangle => {
                let face = mesh.corner_face(corner);
                4 * face + (corner - mesh.corners(face).start)
            }
        }
    }

    /// The child corner at the vertex of a corner.
    #[inline]
    pub fn corner_at(&self, mesh: &Mesh, corner: u32) -> u32 {
        let place = corner - mesh.corners(mesh.corner_face(corner)).start;
        match self.kind {
            // OpenSubdiv turns the children of quads alike, and begins those of other faces at the vertex.
            SplitKind::Quad if mesh.face_size(mesh.corner_face(corner)) == 4 => 4 * corner + place,
            SplitKind::Quad => 4 * corner,
            SplitKind::Triangle => 3 * self.face_at(mesh, corner) + place,
        }
    }

    /// The corner of the triangle in the middle opposite to a corner of its parent: at the midpoint of the
    /// edge that the parent's corner does not touch.
    ///
    /// # Panics
    /// In the quad split, which has no face in the middle.
    #[inline]
    pub fn middle_corner(&self, mesh: &Mesh, corner: u32) -> u32 {
        assert!(self.kind == SplitKind::Triangle, "no face in the middle of a quad split");
        let face = mesh.corner_face(corner);
        3 * (4 * face + 3) + (corner - mesh.corners(face).start)
    }

    /// Whether `child` has the counts and edge directions that this table promises for `parent`, and
    /// the corners of its faces lie there.
    pub fn describes(&self, parent: &Mesh, child: &Mesh) -> bool {
        (0..3).all(|k| self.num_children(k) == child.num_cells(k))
            && child.edges().iter().enumerate().all(|(i, &ends)| {
                ends == self.edge_ends(parent, self.edge_parent(i)).map(|end| self.vertex_of(end))
            })
            && (0..parent.num_corners() as u32).all(|c| {
                let e = parent.corner_half_edge(c).edge();
                let vertices = child.face_vertices(self.face_at(parent, c));
                let next = |v: u32| {
                    let at = vertices.iter().position(|&w| w == v)?;
                    Some(vertices[(at + 1) % vertices.len()])
                };
                next(parent.corner_vertex(c)) == Some(self.vertex_of(Parent::Edge(e)))
                    && child.corner_vertex(self.corner_at(parent, c)) == parent.corner_vertex(c)
                    && (self.kind == SplitKind::Quad || {
                        let opposite = parent.corner_half_edge(parent.next_corner(c)).edge();
                        let middle = child.corner_vertex(self.middle_corner(parent, c));
                        middle == self.vertex_of(Parent::Edge(opposite))
                    })
            })
    }
}
