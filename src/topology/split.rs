use super::{HalfEdge, Mesh};

/// The split of Catmull-Clark (and of bilinear refinement): every face of `n` vertices becomes `n`
/// quads, one for each corner.
///
/// The numbering and the directions are OpenSubdiv's, with `V`, `E`, `F` the counts of the parent and `C` its corners:
///
/// | child | number | |
/// |---|---|---|
/// | vertex of vertex `v` | `v` | |
/// | vertex of face `f` (its centre `p_f`) | `V + f` | |
/// | vertex of edge `e` (its midpoint `m_e`) | `V + F + e` | |
/// | edge of corner `c` ("odd") | `c` | directed `p_f -> m_e`, `e` the edge that leaves the corner |
/// | half of edge `e` at its end `j` ("even") | `C + 2e + j` | directed `m_e -> v` |
/// | face of corner `c` | `c` | |
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QuadSplit {
    num_vertices: usize,
    num_edges: usize,
    num_faces: usize,
    num_corners: usize,
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
    /// `p_f -> m_e`: inside the face of this corner, to the edge that leaves it.
    Odd(u32),
}

impl QuadSplit {
    /// The split of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        QuadSplit {
            num_vertices: mesh.num_vertices(),
            num_edges: mesh.num_edges(),
            num_faces: mesh.num_faces(),
            num_corners: mesh.num_corners(),
        }
    }

    /// The number of child vertices, edges or faces (`k` = 0, 1, 2).
    ///
    /// # Panics
    /// If `k > 2`.
    pub fn num_children(&self, k: usize) -> usize {
        let vertices = self.num_vertices + self.num_edges + self.num_faces;
        [vertices, self.num_corners + 2 * self.num_edges, self.num_corners][k]
    }

    /// The child vertex of a cell.
    #[inline]
    pub fn vertex_of(&self, parent: Parent) -> u32 {
        match parent {
            Parent::Vertex(v) => v,
            Parent::Face(f) => self.num_vertices as u32 + f,
            Parent::Edge(e) => (self.num_vertices + self.num_faces) as u32 + e,
        }
    }

    /// The parent of a child vertex.
    #[inline]
    pub fn vertex_parent(&self, vertex: usize) -> Parent {
        if vertex < self.num_vertices {
            Parent::Vertex(vertex as u32)
        } else if vertex < self.num_vertices + self.num_faces {
            Parent::Face((vertex - self.num_vertices) as u32)
        } else {
            Parent::Edge((vertex - self.num_vertices - self.num_faces) as u32)
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

    /// Whether `child` has the counts and edge directions that this table promises for `parent`. The
    /// faces follow: a face of the child names its edges.
    pub fn describes(&self, parent: &Mesh, child: &Mesh) -> bool {
        (0..3).all(|k| self.num_children(k) == child.num_cells(k))
            && child.edges().iter().enumerate().all(|(i, &ends)| ends == self.child_edge_ends(parent, i))
            && (0..child.num_faces() as u32).all(|c| {
                let corner = parent.corner_vertex(c);
                let centre = self.vertex_of(Parent::Face(parent.corner_face(c)));
                let vertices = child.face_vertices(c);
                let at = vertices.iter().position(|&v| v == corner);
                vertices.len() == 4 && at.is_some_and(|i| vertices[(i + 2) % 4] == centre)
            })
    }

    fn child_edge_ends(&self, parent: &Mesh, edge: usize) -> [u32; 2] {
        match self.edge_parent(edge) {
            ChildEdge::Even(h) => [self.vertex_of(Parent::Edge(h.edge())), parent.tail(h)],
            ChildEdge::Odd(c) => {
                let e = parent.corner_half_edge(c).edge();
                [self.vertex_of(Parent::Face(parent.corner_face(c))), self.vertex_of(Parent::Edge(e))]
            }
        }
    }
}
