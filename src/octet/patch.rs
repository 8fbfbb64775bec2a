//! Where a complex is combinatorially the lattice: walks from a cell through its neighbours, in step with a fixed
//! piece of the lattice.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::OnceLock;

use super::NONE;
use super::complex::{Complex, is_even};
use super::lattice::{
    Cell, DENOMINATOR, Point, det, edge_homotopy, minus, plus, steps, triangle_homotopy, units,
};

/// A piece of the lattice that hangs together, in the order of a walk from its first cell, a tetrahedron.
#[derive(Debug)]
struct Patch {
    /// The first four are the vertices of the first cell.
    points: Vec<Point>,
    cells: Vec<Step>,
}

/// A cell of a patch, reached from an earlier one.
#[derive(Debug)]
struct Step {
    from: usize,
    is_oct: bool,
    /// Its vertices as numbers in the patch's points, in the order of [`Cell::vertices`].
    vertices: Vec<usize>,
    /// Those of the face it is entered through.
    shared: [usize; 3],
}

/// What a walk needs of a complex.
pub(super) struct Ground<'a> {
    pub complex: &'a Complex,
    pub cells_of_triangles: &'a [[u32; 2]],
}

/// The most points and cells of a patch.
const MAX: usize = 64;

/// A patch laid on a complex: the vertex at each of its points, the cell in the place of each of its cells.
struct Laid {
    vertices: [u32; MAX],
    cells: [u32; MAX],
}

impl Patch {
    fn new(first: [Point; 4], wanted: &BTreeSet<Cell>) -> Self {
        let start = Cell::Tet([0, 1, 2].map(|k| first.iter().map(|p| p[k]).min().unwrap_or(0)));
        // The shortest ways from the first cell, and of those what leads to a wanted one.
        let mut before = BTreeMap::from([(start, start)]);
        let mut queue = VecDeque::from([start]);
        while let Some(cell) = queue.pop_front() {
            for next in cell.neighbours() {
                let (Cell::Tet(n) | Cell::Oct(n)) = next;
                if n.iter().all(|x| x.abs() <= 6) && !before.contains_key(&next) {
                    before.insert(next, cell);
                    queue.push_back(next);
                }
            }
        }
        let mut ways = vec![start];
        for &cell in wanted {
            let mut way = vec![cell];
            while let Some(&last) = way.last().filter(|&cell| !ways.contains(cell)) {
                way.push(before[&last]);
            }
            way.pop();
            ways.extend(way.into_iter().rev());
        }
        let mut patch = Patch { points: first.to_vec(), cells: Vec::new() };
        for &cell in &ways {
            let from = before[&cell];
            let vertices = cell.vertices();
            let other = from.vertices();
            let shared: Vec<usize> =
                vertices.iter().filter(|p| other.contains(p)).map(|&p| patch.number(p)).collect();
            let vertices = vertices.iter().map(|&p| patch.number(p)).collect();
            let from = ways.iter().position(|&c| c == from).unwrap_or(0);
            let (is_oct, shared) = (matches!(cell, Cell::Oct(_)), [shared[0], shared[1], shared[2]]);
            patch.cells.push(Step { from, is_oct, vertices, shared });
        }
        assert!(patch.cells.len() <= MAX && patch.points.len() <= MAX, "a patch has outgrown its arrays");
        patch
    }

    fn number(&mut self, point: Point) -> usize {
        self.points.iter().position(|&p| p == point).unwrap_or_else(|| {
            self.points.push(point);
            self.points.len() - 1
        })
    }

    /// Lays the patch with its first cell on a tetrahedron whose vertices are given in the order of the first four
    /// points; `None` where the complex is not like the lattice.
    fn lay(&self, ground: &Ground, tet: u32, corners: [u32; 4]) -> Option<Laid> {
        let complex = ground.complex;
        let mut laid = Laid { vertices: [NONE; MAX], cells: [NONE; MAX] };
        laid.vertices[..4].copy_from_slice(&corners);
        laid.cells[0] = tet;
        for (place, step) in self.cells.iter().enumerate().skip(1) {
            let shared = step.shared.map(|p| laid.vertices[p]);
            let side = face_with(complex, laid.cells[step.from], shared)?;
            let [a, b] = ground.cells_of_triangles[side as usize];
            let cell = if a == laid.cells[step.from] { b } else { a };
            if cell == NONE || (cell as usize >= complex.tets().len()) != step.is_oct {
                return None;
            }
            let own = complex.cell_vertices(cell);
            for (k, &p) in step.vertices.iter().enumerate() {
                let vertex = match step.is_oct {
                    // The octahedron's vertices come in opposite pairs, here as in the complex.
                    true => match own.iter().position(|v| shared.contains(v) && laid.vertices[p] == *v) {
                        Some(_) => continue,
                        None => {
                            let opposite = laid.vertices[step.vertices[(k + 3) % 6]];
                            own[(own.iter().position(|&v| v == opposite)? + 3) % 6]
                        }
                    },
                    false if step.shared.contains(&p) => continue,
                    false => *own.iter().find(|v| !shared.contains(v))?,
                };
                if laid.vertices[p] == NONE {
                    laid.vertices[p] = vertex;
                } else if laid.vertices[p] != vertex {
                    return None;
                }
            }
            laid.cells[place] = cell;
        }
        Some(laid)
    }
}

/// The triangle of a cell with these vertices.
fn face_with(complex: &Complex, cell: u32, vertices: [u32; 3]) -> Option<u32> {
    let own = complex.cell_vertices(cell);
    let face = match own.len() {
        4 => own.iter().position(|v| !vertices.contains(v))?,
        _ => vertices.iter().try_fold(0, |face, v| {
            let i = own.iter().position(|own| own == v)?;
            Some(face | usize::from(i >= 3) << (i % 3))
        })?,
    };
    Some(complex.cell_faces(cell)[face].triangle())
}

/// The homotopy of the lattice, ready to be laid on a complex.
#[derive(Debug)]
pub(super) struct Homotopy {
    edge: Patch,
    /// For each triangle a cell of the patch that it is a face of, its points, and its weight.
    edge_terms: Vec<(usize, [usize; 3], f64)>,
    triangle: Patch,
    /// For each cell of the patch its weight.
    triangle_terms: Vec<f64>,
}

impl Homotopy {
    /// The one there is.
    pub fn get() -> &'static Homotopy {
        static HOMOTOPY: OnceLock<Homotopy> = OnceLock::new();
        HOMOTOPY.get_or_init(Homotopy::new)
    }

    fn new() -> Self {
        // The first cell's vertices; the edge is from the first to the second, the triangle opposite the first.
        let first: [Point; 4] = [[0, 0, 0], [1, 1, 0], [1, 0, 1], [0, 1, 1]];
        let chain = edge_homotopy([first[0], first[1]]);
        let stars = [first[0], first[1]].into_iter().flat_map(star);
        let wanted = chain.keys().map(|&t| tet_of(t)).chain(stars).collect();
        let mut edge = Patch::new(first, &wanted);
        let cells: Vec<Vec<usize>> = edge.cells.iter().map(|step| step.vertices.clone()).collect();
        let edge_terms = chain.into_iter().map(|(triangle, weight)| {
            let numbers = triangle.map(|p| edge.number(p));
            let cell = cells.iter().position(|v| numbers.iter().all(|n| v.contains(n)));
            (cell.expect("the patch has the cells of its triangles"), numbers, ratio(weight))
        });
        let edge_terms = edge_terms.collect();

        let chain = triangle_homotopy([first[1], first[2], first[3]]);
        let triangle = Patch::new(first, &chain.keys().copied().collect());
        let weight = |step: &Step| {
            let vertices = |cell: &Cell| cell.vertices();
            let own: Vec<Point> = step.vertices.iter().map(|&n| triangle.points[n]).collect();
            chain.iter().find(|(cell, _)| vertices(cell) == own).map_or(0.0, |(_, &weight)| ratio(weight))
        };
        let triangle_terms = triangle.cells.iter().map(weight).collect();
        Homotopy { edge, edge_terms, triangle, triangle_terms }
    }

    /// Calls `emit(triangle, weight)` for the terms of `K1` at the edge from `corners[0]` to `corners[1]` of a
    /// tetrahedron; false, without a call, where the complex is not like the lattice.
    pub fn edge_row(
        &self,
        ground: &Ground,
        tet: u32,
        corners: [u32; 4],
        mut emit: impl FnMut(u32, f64),
    ) -> bool {
        let Some(laid) = self.edge.lay(ground, tet, corners) else { return false };
        for &(cell, points, weight) in &self.edge_terms {
            let vertices = points.map(|p| laid.vertices[p]);
            if let Some(t) = face_with(ground.complex, laid.cells[cell], vertices) {
                let along = is_even(ground.complex.triangle_vertices(t), vertices);
                emit(t, if along { weight } else { -weight });
            }
        }
        true
    }

    /// Calls `emit(cell, weight)` for the terms of `K2` at the triangle `corners[1..]` of a tetrahedron, in that
    /// order; false, without a call, where the complex is not like the lattice.
    pub fn triangle_row(
        &self,
        ground: &Ground,
        tet: u32,
        corners: [u32; 4],
        mut emit: impl FnMut(u32, f64),
    ) -> bool {
        let Some(laid) = self.triangle.lay(ground, tet, corners) else { return false };
        for ((step, &weight), &cell) in self.triangle.cells.iter().zip(&self.triangle_terms).zip(&laid.cells)
        {
            if weight != 0.0 {
                // The order in which the complex stores the cell, on the points of the lattice.
                let own = ground.complex.cell_vertices(cell);
                let place = |i: usize| {
                    let k = step.vertices.iter().position(|&p| laid.vertices[p] == own[i]);
                    self.triangle.points[step.vertices[k.unwrap_or(0)]]
                };
                let turn = match own.len() {
                    4 => det(minus(place(1), place(0)), minus(place(2), place(0)), minus(place(3), place(0))),
                    _ => det(minus(place(0), place(3)), minus(place(1), place(4)), minus(place(2), place(5))),
                };
                emit(cell, weight * f64::from(turn.signum()));
            }
        }
        true
    }
}

fn ratio(numerator: i32) -> f64 {
    f64::from(numerator) / f64::from(DENOMINATOR)
}

/// The fourteen cells at a vertex.
fn star(vertex: Point) -> Vec<Cell> {
    let cells = steps().chain(units()).flat_map(|step| {
        let centre = plus(vertex, step);
        Cell::Oct(centre).neighbours().into_iter().chain([Cell::Oct(centre)]).collect::<Vec<_>>()
    });
    let at_vertex: BTreeSet<Cell> = cells
        .filter(|cell| match cell {
            Cell::Oct(n) => (n[0] + n[1] + n[2]) % 2 != 0,
            Cell::Tet(_) => true,
        })
        .filter(|cell| cell.vertices().contains(&vertex))
        .collect();
    at_vertex.into_iter().collect()
}

/// The tetrahedron of a triangle.
fn tet_of(triangle: [Point; 3]) -> Cell {
    let low = [0, 1, 2].map(|k| triangle.iter().map(|p| p[k]).min().unwrap_or(0));
    Cell::Tet(low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_has_eight_tetrahedra_and_six_octahedra() {
        let cells = star([0, 0, 0]);
        assert_eq!(cells.iter().filter(|cell| matches!(cell, Cell::Tet(_))).count(), 8);
        assert_eq!(cells.len(), 14);
    }

    #[test]
    fn patches_are_walked_from_neighbour_to_neighbour() {
        let homotopy = Homotopy::new();
        for patch in [&homotopy.edge, &homotopy.triangle] {
            for (i, step) in patch.cells.iter().enumerate().skip(1) {
                assert!(step.from < i && patch.cells[step.from].is_oct != step.is_oct);
            }
        }
        assert_eq!(homotopy.triangle_terms.iter().filter(|&&w| w != 0.0).count(), 26);
    }
}
