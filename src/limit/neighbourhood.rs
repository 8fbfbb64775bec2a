//! The cells round a vertex and round a face, numbered the same way wherever the same configuration occurs.

use crate::osd::{Rule, Tags};
use crate::scheme::sector::{Place, place};
use crate::topology::{HalfEdge, Mesh};

/// Cells of a mesh in an order of their own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cells {
    /// Vertices.
    pub vertices: Vec<u32>,
    /// Edges, each in the direction in which it is counted here.
    pub edges: Vec<HalfEdge>,
    /// Faces.
    pub faces: Vec<u32>,
}

impl Cells {
    /// The cells of each degree with their signs.
    pub fn signed(&self) -> [Vec<(u32, f64)>; 3] {
        let plain = |cells: &[u32]| cells.iter().map(|&cell| (cell, 1.0)).collect();
        let edges = self.edges.iter().map(|h| (h.edge(), h.sign())).collect();
        [plain(&self.vertices), edges, plain(&self.faces)]
    }
}

/// What surrounds a corner up to the nearest sharp edges, on a settled level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Configuration {
    /// The rule of the vertex.
    pub rule: Rule,
    /// Whether nothing cuts the faces off: they close a circle. A dart's circle begins at its sharp edge.
    pub cyclic: bool,
    /// The number of faces.
    pub faces: u32,
    /// The place of the corner's own face among them; 0 where the circle may begin anywhere.
    pub position: u32,
    /// Whether creases pass the face at both its other corners without following its edges, as they do in the
    /// middle of a triangle with two sharp edges.
    pub pinched: bool,
}

impl Configuration {
    /// Faces round a vertex, with nothing else near.
    pub fn new(rule: Rule, cyclic: bool, faces: u32, position: u32) -> Self {
        Configuration { rule, cyclic, faces, position, pinched: false }
    }

    /// The same at the first position.
    pub fn anywhere(self) -> Self {
        Configuration { position: 0, ..self }
    }
}

/// The configuration of a corner from which the surroundings of its face can be told, and the corners of its
/// vertex that belong to it.
pub fn around_face(mesh: &Mesh, tags: &Tags, corner: u32) -> (Configuration, Vec<u32>) {
    let (mut found, corners) = around_corner(mesh, tags, corner);
    let (a, b) = (mesh.next_corner(corner), mesh.previous_corner(corner));
    found.pinched = is_passed(mesh, tags, a) && is_passed(mesh, tags, b);
    (found, corners)
}

/// Whether a crease passes a triangle at a corner, without following its edges.
fn is_passed(mesh: &Mesh, tags: &Tags, corner: u32) -> bool {
    mesh.face_size(mesh.corner_face(corner)) == 3
        && tags.vertex_rule[mesh.corner_vertex(corner) as usize] == Rule::Crease
        && around_corner(mesh, tags, corner).0 == Configuration::new(Rule::Crease, false, 3, 1)
}

/// The configuration of a corner and the corners of its vertex that belong to it, counter-clockwise.
pub fn around_corner(mesh: &Mesh, tags: &Tags, corner: u32) -> (Configuration, Vec<u32>) {
    let (fan, position) = mesh.fan_of_corner(corner);
    let rule = tags.vertex_rule[mesh.corner_vertex(corner) as usize];
    let is_sharp =
        |i: usize| tags.edge_sharpness[mesh.corner_half_edge(fan.corners[i]).edge() as usize] > 0.0;
    let k = fan.corners.len();
    let rotated = |start: usize, n: usize| (0..n).map(|i| fan.corners[(start + i) % k]).collect();
    match place(fan, position, |i| !rule.is_smooth() && is_sharp(i)) {
        Place::Smooth { position } => {
            let start = match rule {
                Rule::Dart => (0..k).find(|&i| is_sharp(i)).unwrap_or(position),
                _ => position,
            };
            let position = ((position + k - start) % k) as u32;
            (Configuration::new(rule, true, k as u32, position), rotated(start, k))
        }
        Place::Sector { start, faces, spoke } => {
            let configuration = Configuration::new(rule, false, faces as u32, spoke as u32);
            (configuration, rotated(start, faces))
        }
    }
}

/// The faces of these corners of one vertex `v`, with their edges and vertices: `v`; then for each face, from
/// its spoke `v -> w_i` on, the spoke and the other edges but the last, counter-clockwise, and their ends;
/// then the last spoke, if the faces do not close a circle.
pub fn fan_cells(mesh: &Mesh, corners: &[u32], cyclic: bool) -> Cells {
    let mut cells = Cells { vertices: vec![mesh.corner_vertex(corners[0])], ..Default::default() };
    for &corner in corners {
        let mut c = corner;
        for _ in 2..=mesh.face_size(mesh.corner_face(corner)) - 1 {
            let h = mesh.corner_half_edge(c);
            cells.edges.push(h);
            cells.vertices.push(mesh.head(h));
            c = mesh.next_corner(c);
        }
        cells.edges.push(mesh.corner_half_edge(c));
        // The head of that edge is the end of the next spoke.
        cells.faces.push(mesh.corner_face(corner));
    }
    if !cyclic {
        let last = mesh.corner_half_edge(mesh.previous_corner(corners[corners.len() - 1])).twin();
        cells.edges.push(last);
        cells.vertices.push(mesh.head(last));
    }
    cells
}

/// The faces that meet the face of a corner, as far as they matter to it: those of the corner's configuration
/// (`corners`, see [`fan_cells`]), then those beyond the edges that do not touch the corner's vertex. No sharp
/// edge is crossed outside the configuration, and nothing is taken beyond corners that are passed by creases.
///
/// On quads, with the face `(v, a, q, b)` in the unit square of a lattice, the further faces lie at (1, 0),
/// (1, 1), (0, 1), then (1, -1) unless `v -> a` is sharp, then (-1, 1) unless `v -> b` is. On triangles
/// `(v, a, b)` they are the one across `a -> b` and the next round `a` and round `b`; then, unless `v -> a` is
/// sharp, two more round `a`, and likewise round `b`.
///
/// # Panics
/// If one of these edges has no face on its other side.
pub fn patch_cells(mesh: &Mesh, configuration: Configuration, corners: &[u32]) -> Cells {
    let mut cells = fan_cells(mesh, corners, configuration.cyclic);
    let position = configuration.position;
    // A dart's sharp edge does not cut its circle, but it goes on beyond its other end.
    let begins_sharp = !configuration.cyclic || configuration.rule == Rule::Dart;
    let first_is_sharp = begins_sharp && position == 0;
    let last_is_sharp = begins_sharp && position + 1 == configuration.faces;
    let corner = corners[position as usize];
    let mut outer = Outer { mesh, cells: &mut cells };
    let a = mesh.next_corner(corner);
    match mesh.face_size(mesh.corner_face(corner)) {
        4 => {
            let q = mesh.next_corner(a);
            let right = outer.across(a);
            let top = outer.across(q);
            outer.add(right, &[2, 3], &[(1, true), (2, true), (3, false)]);
            let diagonal = outer.across(outer.step(right, 3));
            outer.add(diagonal, &[2, 3], &[(1, true), (2, false)]);
            outer.add(top, &[3], &[(1, true), (2, false), (3, false)]);
            if !first_is_sharp {
                let below = outer.across(outer.step(right, 1));
                outer.add(below, &[3], &[(2, true), (3, true)]);
            }
            if !last_is_sharp {
                let left = outer.across(outer.step(top, 3));
                outer.add(left, &[2], &[(1, false), (2, false)]);
            }
        }
        _ => {
            let opposite = outer.across(a); // b a .
            outer.add(opposite, &[2], &[(1, true), (2, false)]);
            if configuration.pinched {
                return cells;
            }
            let near_a = outer.across(outer.step(opposite, 1)); // . a .
            outer.add(near_a, &[2], &[(1, true), (2, true)]);
            let near_b = outer.across(outer.step(opposite, 2)); // b . .
            outer.add(near_b, &[2], &[(1, true), (2, false)]);
            if !first_is_sharp {
                let next = outer.across(outer.step(near_a, 1));
                outer.add(next, &[2], &[(1, true), (2, true)]);
                let last = outer.across(outer.step(next, 1));
                outer.add(last, &[], &[(2, true)]);
            }
            if !last_is_sharp {
                let next = outer.across(outer.step(near_b, 2));
                outer.add(next, &[2], &[(1, true), (2, false)]);
                let last = outer.across(outer.step(next, 2));
                outer.add(last, &[], &[(1, true)]);
            }
        }
    }
    cells
}

/// Cells under collection beyond the fan.
struct Outer<'a> {
    mesh: &'a Mesh,
    cells: &'a mut Cells,
}

impl Outer<'_> {
    /// The corner, on the other side of the edge that leaves `corner`, at that edge's far end.
    fn across(&self, corner: u32) -> u32 {
        let twin = self.mesh.corner_half_edge(corner).twin();
        self.mesh.left_corner(twin).expect("a smooth edge has two faces")
    }

    fn step(&self, corner: u32, steps: usize) -> u32 {
        (0..steps).fold(corner, |c, _| self.mesh.next_corner(c))
    }

    /// Adds the face of a corner: its vertices so many steps on, and its edges so many steps on, along the
    /// face or against it.
    fn add(&mut self, corner: u32, vertices: &[usize], edges: &[(usize, bool)]) {
        for &steps in vertices {
            let c = self.step(corner, steps);
            self.cells.vertices.push(self.mesh.corner_vertex(c));
        }
        for &(steps, along) in edges {
            let h = self.mesh.corner_half_edge(self.step(corner, steps));
            self.cells.edges.push(if along { h } else { h.twin() });
        }
        self.cells.faces.push(self.mesh.corner_face(corner));
    }
}

/// The corner of the face of `corner` from which its surroundings can be told: all irregular vertices and sharp edges that
/// the face touches are at this corner's vertex, but for creases from there along its two edges. `None` if there
/// is no such corner, because features are not far enough apart; the first counter-clockwise from `corner` on if
/// there are several.
pub fn origin(mesh: &Mesh, tags: &Tags, is_plain: impl Fn(u32) -> bool, corner: u32) -> Option<u32> {
    let face = mesh.corner_face(corner);
    let size = mesh.face_size(face);
    let straight = if size == 3 { 3 } else { 2 };
    let is_sharp = |c: u32| tags.edge_sharpness[mesh.corner_half_edge(c).edge() as usize] > 0.0;
    // Whether nothing but a crease along the edge to the origin disturbs the vertex of a corner.
    let is_calm = |c: u32, edge_is_sharp: bool, before: bool| {
        if !edge_is_sharp {
            return is_plain(mesh.corner_vertex(c));
        }
        let (found, _) = around_corner(mesh, tags, c);
        let position = if before { 0 } else { straight - 1 };
        found == Configuration::new(Rule::Crease, false, straight, position)
    };
    let mut corners = std::iter::successors(Some(corner), |&c| Some(mesh.next_corner(c))).take(size);
    corners.find(|&v| {
        let (a, b) = (mesh.next_corner(v), mesh.previous_corner(v));
        let far: Vec<u32> = mesh.corners(face).filter(|c| ![v, a, b].contains(c)).collect();
        let mut beyond = far.iter().copied().chain([a]);
        let pinched = is_plain(mesh.corner_vertex(v)) && is_passed(mesh, tags, a) && is_passed(mesh, tags, b);
        (pinched || is_calm(a, is_sharp(v), false) && is_calm(b, is_sharp(b), true))
            && far.iter().all(|&c| is_plain(mesh.corner_vertex(c)))
            && beyond.all(|c| !is_sharp(c))
    })
}
