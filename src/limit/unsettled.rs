//! `K0` and `K1` where a level is not settled: polygons and semi-sharp features are cut out with their
//! surroundings, refined once, and pulled back by `K0 = R0 (H0 + K0' S1)`, `K1 = R1 (H1 + K1' S2)`; again and
//! again until nothing unsettled is left. Only what lies near a feature is refined, so the cost grows with its
//! length, not with the area of the surface.

use super::settled::Settled;
use super::tangents::{self, Collection, LimitTangents, Pulled};
use crate::hierarchy::{Hierarchy, HierarchyError, Level};
use crate::osd::{Rules, Tags};
use crate::scheme::{FaceRows, Scheme};
use crate::sparse::{Csr, Row, assemble, row_of};
use crate::topology::{
    BoundaryInterpolation, Cage, Corner, Crease, Descriptor, HalfEdge, Mesh, Parent, SplitKind,
};

/// After how many levels a cage has no semi-sharp feature and no face but those of the split.
///
/// # Errors
/// If the scheme does not take the cage.
pub fn levels_to_settle(cage: &Cage, scheme: Scheme) -> Result<usize, HierarchyError> {
    let d = cage.descriptor();
    let kind = scheme.split(&d.face_sizes)?;
    let sharpness = d.creases.iter().map(|c| c.sharpness).chain(d.corners.iter().map(|c| c.sharpness));
    // It falls by one a level, under Chaikin's rule by at least one from the largest.
    let most = sharpness.filter(|&s| s < super::INFINITE).fold(0.0, f32::max).ceil() as usize;
    let most = if FaceRows::of(scheme).is_some() { most } else { 0 }; // nothing decays in Whitney schemes
    let polygons = kind == SplitKind::Quad && d.face_sizes.iter().any(|&size| size != 4);
    Ok(most.max(usize::from(polygons)))
}

/// The cells whose rows are wanted.
pub struct Wanted {
    vertices: Vec<bool>,
    edges: Vec<bool>,
}

/// The two tables of (B).
#[derive(Clone, Debug)]
pub struct Tables {
    /// `(|V|, |E|)`.
    pub k0: Csr,
    /// `(|E|, |F|)`.
    pub k1: Csr,
}

/// What is known of the limit on a level.
pub struct Known {
    /// `K0` and `K1`.
    pub tables: Tables,
    /// The tangents at the vertices, if they were asked for.
    pub tangents: Option<LimitTangents>,
}

/// The limit on a level, or the wanted rows of it. `options` says how semi-sharp features decay.
pub fn solve(
    scheme: Scheme,
    options: &Descriptor,
    level: &Level,
    wanted: Option<&Wanted>,
    with_tangents: bool,
) -> Result<Known, HierarchyError> {
    let (mesh, tags) = (level.mesh(), level.tags());
    let (rules, rows) = (Rules::settled(tags), FaceRows::of(scheme));
    let settled = Settled::new(mesh, tags, &rules, scheme, rows.as_ref())?;
    let is_settled: Vec<bool> = (0..mesh.num_vertices() as u32).map(|v| settled.is_settled(v)).collect();
    let wants_vertex = |v: usize| wanted.is_none_or(|wanted| wanted.vertices[v]);
    let wants_edge = |e: usize| wanted.is_none_or(|wanted| wanted.edges[e]);
    let edge_is_settled = |e: usize| mesh.edges()[e].iter().all(|&v| is_settled[v as usize]);

    let open = Wanted {
        vertices: (0..mesh.num_vertices()).map(|v| wants_vertex(v) && !is_settled[v]).collect(),
        edges: (0..mesh.num_edges()).map(|e| wants_edge(e) && !edge_is_settled(e)).collect(),
    };
    let piece = match open.vertices.contains(&true) || open.edges.contains(&true) {
        true => Some(Piece::new(scheme, options, level, &open, with_tangents)?),
        false => None,
    };
    let k0 = assemble((mesh.num_vertices(), mesh.num_edges()), |v, row| match &piece {
        Some(piece) if open.vertices[v] => piece.add_k0_row(mesh, v, row),
        _ if wants_vertex(v) => settled.k0(v as u32, row),
        _ => {}
    });
    let k1 = assemble((mesh.num_edges(), mesh.num_faces()), |e, row| match &piece {
        Some(piece) if open.edges[e] => piece.add_k1_row(e, row),
        _ if wants_edge(e) => settled.k1(HalfEdge::new(e as u32, true), row),
        _ => {}
    });
    let kind = scheme.split(&options.face_sizes)?;
    let collection = Collection { kind, scheme, mesh, tags, rules: &rules };
    let pulled = piece.as_ref().and_then(|piece| {
        let tangents = piece.tangents.as_ref()?;
        Some(Pulled { tangents, corner: &piece.corner, edges: &piece.edges })
    });
    let tangents = match with_tangents {
        true => Some(collection.tangents(wants_vertex, |v| open.vertices[v], pulled)?),
        false => None,
    };
    Ok(Known { tables: Tables { k0, k1 }, tangents })
}

/// The surroundings of the open cells, as a cage of their own, with the rows of the open cells.
struct Piece {
    /// For each vertex and edge of the whole its row in `k0` and `k1`.
    vertex: Vec<u32>,
    edge: Vec<u32>,
    /// For each corner of the whole its corner in the piece, if it is there.
    corner: Vec<u32>,
    /// For each edge of the piece the same one of the whole, and each face.
    edges: Vec<HalfEdge>,
    faces: Vec<u32>,
    k0: Csr,
    k1: Csr,
    tangents: Option<LimitTangents>,
}

const OUTSIDE: u32 = u32::MAX;

impl Piece {
    fn new(
        scheme: Scheme,
        options: &Descriptor,
        level: &Level,
        open: &Wanted,
        with_tangents: bool,
    ) -> Result<Self, HierarchyError> {
        let mesh = level.mesh();
        let faces = surroundings(mesh, open);
        let mut vertex = vec![OUTSIDE; mesh.num_vertices()];
        for &v in faces.iter().flat_map(|&f| mesh.face_vertices(f)) {
            vertex[v as usize] = 0;
        }
        let inside = (0..mesh.num_vertices() as u32).filter(|&v| vertex[v as usize] == 0);
        let vertices: Vec<u32> = inside.collect();
        for (i, &v) in vertices.iter().enumerate() {
            vertex[v as usize] = i as u32;
        }
        let cage = cage(options, mesh, level.tags(), &faces, &vertices, &vertex);
        let hierarchy = Hierarchy::new(&cage, scheme, 1)?;
        let (parent, child) = (hierarchy.level(0).mesh(), hierarchy.level(1));

        let mut corner = vec![OUTSIDE; mesh.num_corners()];
        let mut edge = vec![OUTSIDE; mesh.num_edges()];
        let mut edges = vec![HalfEdge::new(0, true); parent.num_edges()];
        let corners = faces.iter().flat_map(|&f| mesh.corners(f));
        for (here, there) in (0..parent.num_corners() as u32).zip(corners) {
            corner[there as usize] = here;
            let (here, there) = (parent.corner_half_edge(here), mesh.corner_half_edge(there));
            edge[there.edge() as usize] = here.edge();
            edges[here.edge() as usize] = if here.sign() > 0.0 { there } else { there.twin() };
        }

        let refinement = hierarchy.refinement(1);
        let split = refinement.split();
        let halves = |e: u32| {
            let h = HalfEdge::new(e, true);
            [(split.even_edge(h), -1.0), (split.even_edge(h.twin()), 1.0)]
        };
        let is_open_vertex = |i: usize| open.vertices[vertices[i] as usize];
        let is_open_edge = |i: usize| open.edges[edges[i].edge() as usize];
        let child_mesh = child.mesh();
        let mut wanted = Wanted {
            vertices: vec![false; child_mesh.num_vertices()],
            edges: vec![false; child_mesh.num_edges()],
        };
        for i in (0..parent.num_vertices()).filter(|&i| is_open_vertex(i)) {
            wanted.vertices[split.vertex_of(Parent::Vertex(i as u32)) as usize] = true;
        }
        for i in (0..parent.num_edges()).filter(|&i| is_open_edge(i)) {
            halves(i as u32).iter().for_each(|&(half, _)| wanted.edges[half as usize] = true);
        }
        let finer = solve(scheme, cage.descriptor(), child, Some(&wanted), with_tangents)?;
        let tangents = finer.tangents.as_ref().map(|finer| {
            let below = |c| split.corner_at(parent, c);
            tangents::pull_back(finer, parent, below, |edge, weight, row| {
                refinement.add_s1_row(parent, edge, weight, row);
            })
        });

        let finer = finer.tables;
        let homotopy = refinement.homotopy();
        let k0 = assemble((parent.num_vertices(), parent.num_edges()), |i, row| {
            if is_open_vertex(i) {
                let child = Parent::Vertex(i as u32);
                let vertex = split.vertex_of(child) as usize;
                homotopy.add_h0_row(parent, split, child, 1.0, row);
                let (columns, weights) = row_of(&finer.k0, vertex);
                for (&e, &weight) in columns.iter().zip(weights) {
                    refinement.add_s1_row(parent, e as usize, weight, row);
                }
            }
        });
        let k1 = assemble((parent.num_edges(), parent.num_faces()), |i, row| {
            for (half, sign) in halves(i as u32).into_iter().filter(|_| is_open_edge(i)) {
                homotopy.add_h1_row(parent, split, split.edge_parent(half as usize), sign, row);
                let (columns, weights) = row_of(&finer.k1, half as usize);
                for (&f, &weight) in columns.iter().zip(weights) {
                    refinement.add_s2_row(parent, f as usize, sign * weight, row);
                }
            }
        });
        Ok(Piece { vertex, edge, corner, edges, faces, k0, k1, tangents })
    }

    fn add_k0_row(&self, mesh: &Mesh, v: usize, row: &mut Row) {
        if mesh.vertex_half_edges(v as u32).is_empty() {
            return; // an isolated vertex stays
        }
        let (columns, weights) = row_of(&self.k0, self.vertex[v] as usize);
        for (&e, &weight) in columns.iter().zip(weights) {
            let h = self.edges[e as usize];
            row.add(h.edge(), weight * h.sign());
        }
    }

    fn add_k1_row(&self, e: usize, row: &mut Row) {
        let here = self.edge[e];
        let sign = self.edges[here as usize].sign();
        let (columns, weights) = row_of(&self.k1, here as usize);
        for (&f, &weight) in columns.iter().zip(weights) {
            row.add(self.faces[f as usize], sign * weight);
        }
    }
}

/// The faces that meet the faces round the open cells, ascending: the rules of a vertex can be told only
/// where all its edges are.
fn surroundings(mesh: &Mesh, open: &Wanted) -> Vec<u32> {
    let mut near = open.vertices.clone();
    for (e, _) in open.edges.iter().enumerate().filter(|(_, open)| **open) {
        mesh.edges()[e].iter().for_each(|&v| near[v as usize] = true);
    }
    let touching = |near: &[bool]| -> Vec<u32> {
        let touches = |&f: &u32| mesh.face_vertices(f).iter().any(|&v| near[v as usize]);
        (0..mesh.num_faces() as u32).filter(touches).collect()
    };
    for f in touching(&near.clone()) {
        mesh.face_vertices(f).iter().for_each(|&v| near[v as usize] = true);
    }
    touching(&near)
}

fn cage(
    options: &Descriptor,
    mesh: &Mesh,
    tags: &Tags,
    faces: &[u32],
    vertices: &[u32],
    number: &[u32],
) -> Cage {
    let mut seen = vec![false; mesh.num_edges()];
    let mut creases = Vec::new();
    for h in faces.iter().flat_map(|&f| mesh.face_half_edges(f)) {
        let e = h.edge() as usize;
        if !std::mem::replace(&mut seen[e], true) && tags.edge_sharpness[e] > 0.0 {
            let vertices = mesh.edges()[e].map(|v| number[v as usize]);
            creases.push(Crease { vertices, sharpness: tags.edge_sharpness[e] });
        }
    }
    let sharpness = |i: usize| tags.vertex_sharpness[vertices[i] as usize];
    let corners = (0..vertices.len()).filter(|&i| sharpness(i) > 0.0);
    Cage::new(Descriptor {
        num_vertices: vertices.len(),
        face_sizes: faces.iter().map(|&f| mesh.face_size(f) as u32).collect(),
        face_vertices: faces
            .iter()
            .flat_map(|&f| mesh.face_vertices(f).iter().map(|&v| number[v as usize]))
            .collect(),
        creases,
        corners: corners.map(|i| Corner { vertex: i as u32, sharpness: sharpness(i) }).collect(),
        // The tags of the level say what the boundary does; holes do not matter.
        holes: Vec::new(),
        boundary: BoundaryInterpolation::EdgeOnly,
        creasing: options.creasing,
        triangles: options.triangles,
        left_handed: false,
    })
    .expect("a piece of a mesh is a cage")
}
