use super::DesignError;
use super::boundary::{Condition, boundary_loops};
use crate::topology::{HalfEdge, Mesh};

const NONE: u32 = u32::MAX;

/// A tree of vertices, a cotree of faces, and the edges that are in neither: the generators of the first cohomology,
/// absolute at tangential boundary loops and relative to those where the field is normal.
///
/// There are `2g` on a closed surface of genus `g`; `2g + b - 1` with `b` boundary loops that all have the same
/// condition, `2g + b - 2` if both occur.
///
/// Source: Eppstein, "Dynamic generators of topologically embedded graphs", SODA 2003; with all loops of the second
/// kind taken for one root of the tree, and all of the first for one root of the cotree.
#[derive(Clone, Debug)]
pub struct Homology {
    loops: Vec<Vec<HalfEdge>>,
    conditions: Vec<Condition>,
    /// Vertices and edges of normal loops.
    fixed: [Vec<bool>; 2],
    /// For each vertex the half-edge to its parent, none at roots.
    up: Vec<Option<HalfEdge>>,
    /// For each vertex the number of its component, and for each component whether a normal loop grounds it.
    component: Vec<u32>,
    grounded: Vec<bool>,
    /// The faces, parents first, each with its half-edge towards its parent, none at roots.
    order: Vec<(u32, Option<HalfEdge>)>,
    /// For each face the number of its root, if nothing can leave its component.
    closed: Vec<u32>,
    num_closed: usize,
    generators: Vec<u32>,
}

impl Homology {
    /// The trees of a mesh. `conditions` are those of the boundary loops in the order of [`boundary_loops`]; those that
    /// are not given are tangential.
    ///
    /// # Errors
    /// If the mesh is not a manifold along an edge, or there are fewer loops than conditions.
    pub fn new(mesh: &Mesh, conditions: &[Condition]) -> Result<Self, DesignError> {
        let loops = boundary_loops(mesh)?;
        if conditions.len() > loops.len() {
            return Err(DesignError::NoLoop { number: loops.len(), count: loops.len() });
        }
        let mut conditions = conditions.to_vec();
        conditions.resize(loops.len(), Condition::Tangential);
        let mut fixed = [vec![false; mesh.num_vertices()], vec![false; mesh.num_edges()]];
        let normal = loops.iter().zip(&conditions).filter(|(_, c)| **c == Condition::Normal);
        for &h in normal.flat_map(|(ring, _)| ring) {
            fixed[0][mesh.tail(h) as usize] = true;
            fixed[1][h.edge() as usize] = true;
        }
        let mut homology = Homology {
            loops,
            conditions,
            fixed,
            up: vec![None; mesh.num_vertices()],
            component: vec![NONE; mesh.num_vertices()],
            grounded: Vec::new(),
            order: Vec::with_capacity(mesh.num_faces()),
            closed: vec![NONE; mesh.num_faces()],
            num_closed: 0,
            generators: Vec::new(),
        };
        let mut used = homology.fixed[1].clone();
        homology.grow_tree(mesh, &mut used);
        homology.grow_cotree(mesh, &mut used);
        homology.generators = (0..mesh.num_edges() as u32).filter(|&e| !used[e as usize]).collect();
        Ok(homology)
    }

    fn grow_tree(&mut self, mesh: &Mesh, used: &mut [bool]) {
        self.number_components(mesh);
        // Breadth first from the normal loops, then from the lowest vertex of each component without.
        let mut seen = self.fixed[0].clone();
        let mut queue: Vec<u32> = (0..mesh.num_vertices() as u32).filter(|&v| seen[v as usize]).collect();
        let mut at = 0;
        for root in 0..=mesh.num_vertices() as u32 {
            while at < queue.len() {
                let v = queue[at];
                at += 1;
                for &h in mesh.vertex_half_edges(v) {
                    let w = mesh.head(h) as usize;
                    if !std::mem::replace(&mut seen[w], true) {
                        used[h.edge() as usize] = true;
                        self.up[w] = Some(h.twin());
                        queue.push(w as u32);
                    }
                }
            }
            if (root as usize) < mesh.num_vertices() && !std::mem::replace(&mut seen[root as usize], true) {
                queue.push(root);
            }
        }
    }

    fn number_components(&mut self, mesh: &Mesh) {
        for root in 0..mesh.num_vertices() {
            if self.component[root] != NONE {
                continue;
            }
            let number = self.grounded.len() as u32;
            self.component[root] = number;
            let (mut stack, mut grounded) = (vec![root as u32], false);
            while let Some(v) = stack.pop() {
                grounded |= self.fixed[0][v as usize];
                for &h in mesh.vertex_half_edges(v) {
                    let w = mesh.head(h);
                    if self.component[w as usize] == NONE {
                        self.component[w as usize] = number;
                        stack.push(w);
                    }
                }
            }
            self.grounded.push(grounded);
        }
    }

    fn grow_cotree(&mut self, mesh: &Mesh, used: &mut [bool]) {
        let mut seen = vec![false; mesh.num_faces()];
        // What is beyond the tangential loops is one root; then the lowest face of what is left.
        for e in 0..mesh.num_edges() as u32 {
            if mesh.is_boundary_edge(e) && !used[e as usize] {
                let h = HalfEdge::new(e, true);
                let h = if mesh.left_corner(h).is_some() { h } else { h.twin() };
                let face = mesh.corner_face(mesh.left_corner(h).expect("one side has a face"));
                if !std::mem::replace(&mut seen[face as usize], true) {
                    used[e as usize] = true;
                    self.order.push((face, Some(h)));
                }
            }
        }
        let mut at = 0;
        for root in 0..=mesh.num_faces() as u32 {
            while at < self.order.len() {
                let (face, _) = self.order[at];
                at += 1;
                for &h in mesh.face_half_edges(face) {
                    let Some(corner) = mesh.left_corner(h.twin()) else { continue };
                    let next = mesh.corner_face(corner);
                    if !used[h.edge() as usize] && !std::mem::replace(&mut seen[next as usize], true) {
                        used[h.edge() as usize] = true;
                        self.order.push((next, Some(h.twin())));
                        self.closed[next as usize] = self.closed[face as usize];
                    }
                }
            }
            if (root as usize) < mesh.num_faces() && !std::mem::replace(&mut seen[root as usize], true) {
                self.closed[root as usize] = self.num_closed as u32;
                self.num_closed += 1;
                self.order.push((root, None));
            }
        }
    }

    /// The boundary loops.
    pub fn loops(&self) -> &[Vec<HalfEdge>] {
        &self.loops
    }

    /// What the field does at each loop.
    pub fn conditions(&self) -> &[Condition] {
        &self.conditions
    }

    /// Whether a vertex is on a loop where the field is normal: potentials are 0 there.
    pub fn is_fixed_vertex(&self, v: u32) -> bool {
        self.fixed[0][v as usize]
    }

    /// Whether an edge is on such a loop: fields are 0 along it.
    pub fn is_fixed_edge(&self, e: u32) -> bool {
        self.fixed[1][e as usize]
    }

    /// The number of a vertex's component; `None` if a normal loop grounds it, so that nothing has to balance there.
    pub fn balancing_component(&self, v: u32) -> Option<usize> {
        let component = self.component[v as usize] as usize;
        (!self.grounded[component]).then_some(component)
    }

    /// The number of components, grounded ones included.
    pub fn num_components(&self) -> usize {
        self.grounded.len()
    }

    /// The number of the component of a face, among those where curl has to balance: those without a tangential loop.
    pub fn closed_component(&self, face: u32) -> Option<usize> {
        Some(self.closed[face as usize] as usize).filter(|&root| root != NONE as usize)
    }

    /// The number of components where curl has to balance.
    pub fn num_closed_components(&self) -> usize {
        self.num_closed
    }

    /// The edges that are in neither tree: the first Betti number of them.
    pub fn generators(&self) -> &[u32] {
        &self.generators
    }

    /// The closed path of a generator, through its edge: the harmonic form with coefficient 1 at it, and 0 at the others,
    /// has circulation 1 round it and 0 round the others. Between normal loops it is an arc from loop to loop.
    pub fn cycle(&self, mesh: &Mesh, generator: usize) -> Vec<HalfEdge> {
        let e = HalfEdge::new(self.generators[generator], true);
        let path = |from: u32| {
            let step = |&h: &HalfEdge| self.up[mesh.head(h) as usize];
            std::iter::successors(self.up[from as usize], step).collect::<Vec<HalfEdge>>()
        };
        let (mut back, mut forth) = (path(mesh.tail(e)), path(mesh.head(e)));
        while back.last().is_some() && back.last() == forth.last() {
            back.pop();
            forth.pop();
        }
        let mut cycle: Vec<HalfEdge> = back.into_iter().rev().map(HalfEdge::twin).collect();
        cycle.push(e);
        cycle.extend(forth);
        cycle
    }

    /// A cochain with `d1 c = curl`, and given values on the generators: 0 on the tree and on normal loops. On components
    /// where curl has to balance, and does not, all is left to one face.
    ///
    /// # Panics
    /// If there is not one value for each face and each generator.
    pub fn with_curl(&self, mesh: &Mesh, curl: &[f64], generators: &[f64]) -> Vec<f64> {
        assert_eq!(curl.len(), mesh.num_faces(), "a 2-cochain of another mesh");
        assert_eq!(generators.len(), self.generators.len(), "coefficients of another mesh");
        let mut c = vec![0.0; mesh.num_edges()];
        self.generators.iter().zip(generators).for_each(|(&e, &x)| c[e as usize] = x);
        // Children before parents: all edges of a face are known but the one towards its parent.
        for &(face, up) in self.order.iter().rev() {
            if let Some(up) = up {
                let round: f64 =
                    mesh.face_half_edges(face).iter().map(|h| h.sign() * c[h.edge() as usize]).sum();
                c[up.edge() as usize] = up.sign() * (curl[face as usize] - round);
            }
        }
        c
    }

    /// The transpose of [`Homology::with_curl`] in `curl`: for a functional on cochains, what each face's curl counts.
    pub(super) fn of_curl(&self, mesh: &Mesh, functional: &[f64]) -> Vec<f64> {
        let (mut b, mut y) = (functional.to_vec(), vec![0.0; mesh.num_faces()]);
        for &(face, up) in &self.order {
            if let Some(up) = up {
                let x = up.sign() * b[up.edge() as usize];
                y[face as usize] = x;
                for h in mesh.face_half_edges(face).iter().filter(|h| h.edge() != up.edge()) {
                    b[h.edge() as usize] -= h.sign() * x;
                }
            }
        }
        y
    }
}
