//! The regular lattice of tetrahedra and octahedra, and the homotopy of its smoothing kernel.
//!
//! Vertices are the points of Z^3 with an even sum, edges join those at distance `sqrt 2`. Every odd point is the
//! centre of an octahedron, every unit cube holds a tetrahedron on its even corners.

use std::collections::BTreeMap;

/// A point of Z^3.
pub(super) type Point = [i32; 3];

/// A cell of the lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Cell {
    /// By the lowest corner of its cube.
    Tet(Point),
    /// By its centre.
    Oct(Point),
}

/// Triangles with ascending vertices, and how often each is counted.
pub(super) type Triangles = BTreeMap<[Point; 3], i32>;
/// Cells, positively oriented, and how often each is counted.
pub(super) type Cells = BTreeMap<Cell, i32>;

pub(super) fn plus(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[k] + b[k])
}

pub(super) fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[k] - b[k])
}

pub(super) fn dot(a: Point, b: Point) -> i32 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

/// `det(a, b, c)`.
pub(super) fn det(a: Point, b: Point, c: Point) -> i32 {
    dot(a, [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]])
}

fn is_even(p: Point) -> bool {
    (p[0] + p[1] + p[2]) % 2 == 0
}

/// The steps to the twelve neighbours.
pub(super) fn steps() -> impl Iterator<Item = Point> + Clone {
    points(-1, 1).filter(|&p| dot(p, p) == 2)
}

/// The six unit vectors.
pub(super) fn units() -> impl Iterator<Item = Point> + Clone {
    points(-1, 1).filter(|&p| dot(p, p) == 1)
}

/// All points of a cube.
pub(super) fn points(low: i32, high: i32) -> impl Iterator<Item = Point> + Clone {
    (low..=high).flat_map(move |x| (low..=high).flat_map(move |y| (low..=high).map(move |z| [x, y, z])))
}

impl Cell {
    /// The vertices: the four even corners of the cube, or the centre plus x, y, z, minus x, y, z.
    pub fn vertices(self) -> Vec<Point> {
        match self {
            Cell::Tet(n) => points(0, 1).map(|p| plus(n, p)).filter(|&p| is_even(p)).collect(),
            Cell::Oct(n) => {
                let axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
                axes.iter().map(|&a| plus(n, a)).chain(axes.iter().map(|&a| minus(n, a))).collect()
            }
        }
    }

    /// The cells beyond its faces. An octahedron's lie at the eight cubes round its centre.
    pub fn neighbours(self) -> Vec<Cell> {
        match self {
            Cell::Tet(n) => {
                points(0, 1).map(|p| plus(n, p)).filter(|&p| !is_even(p)).map(Cell::Oct).collect()
            }
            Cell::Oct(n) => points(-1, 0).map(|p| Cell::Tet(plus(n, p))).collect(),
        }
    }

    /// The triangles of the boundary with ascending vertices, and whether that is outward (1) or inward (-1).
    pub fn boundary(self) -> Vec<([Point; 3], i32)> {
        let inside: Point = match self {
            Cell::Tet(n) => plus(plus(n, n), [1, 1, 1]),
            Cell::Oct(n) => plus(n, n),
        };
        let triangle = |face: Vec<Point>| {
            let [a, b, c] = [face[0], face[1], face[2]];
            let out = minus(plus(a, a), inside);
            ([a, b, c], det(minus(b, a), minus(c, a), out).signum())
        };
        let own = self.vertices();
        self.neighbours()
            .into_iter()
            .map(|beyond| {
                let other = beyond.vertices();
                let mut face: Vec<Point> = own.iter().copied().filter(|p| other.contains(p)).collect();
                face.sort_unstable();
                triangle(face)
            })
            .collect()
    }
}

fn add_triangle(chain: &mut Triangles, vertices: [Point; 3], weight: i32) {
    let mut sorted = vertices;
    sorted.sort_unstable();
    let [a, b, c] = sorted;
    let even = [[a, b, c], [b, c, a], [c, a, b]].contains(&vertices);
    *chain.entry(sorted).or_default() += if even { weight } else { -weight };
}

/// Twice the surface that edge `p -> q` sweeps when it moves by `step`: its boundary is the moved edge less the edge
/// less the paths of its ends.
fn swept_by_edge(chain: &mut Triangles, [p, q]: [Point; 2], step: Point, weight: i32) {
    let (moved_p, moved_q) = (plus(p, step), plus(q, step));
    let direction = minus(q, p);
    let mut add = |triangle, weight| add_triangle(chain, triangle, weight);
    match dot(direction, step) {
        1 => {
            add([p, moved_p, q], 2 * weight);
            add([moved_p, moved_q, q], 2 * weight);
        }
        -1 => {
            add([p, moved_p, moved_q], 2 * weight);
            add([p, moved_q, q], 2 * weight);
        }
        0 => {
            // A square of an octahedron: half of each pyramid on it. Twice the centre is p + moved q.
            let round = [p, moved_p, moved_q, q];
            for apex in [1, -1] {
                let out = det_axis(direction, step);
                let apex: Point = std::array::from_fn(|k| (p[k] + moved_q[k]) / 2 + apex * out[k]);
                (0..4).for_each(|k| add([apex, round[k], round[(k + 1) % 4]], weight));
            }
        }
        _ => {}
    }
}

/// The unit vector across two steps at a right angle.
fn det_axis(a: Point, b: Point) -> Point {
    units().find(|&u| dot(u, a) == 0 && dot(u, b) == 0).expect("steps at a right angle lie in a square")
}

/// Twice the volume that a triangle sweeps when it moves by `step`: the one chain of cells whose boundary is the
/// moved triangle less the triangle less what its sides sweep.
fn swept_by_triangle(chain: &mut Cells, [a, b, c]: [Point; 3], step: Point, weight: i32) {
    let mut surface = Triangles::new();
    add_triangle(&mut surface, [a, b, c].map(|p| plus(p, step)), 2);
    add_triangle(&mut surface, [a, b, c], -2);
    for side in [[a, b], [b, c], [c, a]] {
        swept_by_edge(&mut surface, side, step, -1);
    }
    surface.retain(|_, count| *count != 0);
    // How often the surface is wound round a cell: 0 outside, and known beyond a face that is known within.
    let bound = |choose: fn(i32, i32) -> i32| -> Point {
        let points = surface.keys().flatten().copied();
        points.reduce(|p, q| std::array::from_fn(|k| choose(p[k], q[k]))).unwrap_or(a)
    };
    let (low, high) = (minus(bound(i32::min), [2, 2, 2]), plus(bound(i32::max), [1, 1, 1]));
    let outside = Cell::Tet(low);
    let mut wound = BTreeMap::from([(outside, 0)]);
    let mut queue = vec![outside];
    while let Some(cell) = queue.pop() {
        for (neighbour, (triangle, sign)) in cell.neighbours().into_iter().zip(cell.boundary()) {
            let (Cell::Tet(n) | Cell::Oct(n)) = neighbour;
            let near = (0..3).all(|k| (low[k]..=high[k]).contains(&n[k]));
            if near && !wound.contains_key(&neighbour) {
                let crossed = surface.get(&triangle).copied().unwrap_or(0) * sign;
                wound.insert(neighbour, wound[&cell] - crossed);
                queue.push(neighbour);
            }
        }
    }
    for (cell, count) in wound {
        *chain.entry(cell).or_default() += weight * count;
    }
}

/// The denominator of [`edge_homotopy`] and [`triangle_homotopy`].
pub(super) const DENOMINATOR: i32 = 384;

/// Calls `sweep(offset, step, weight)` for every step that the kernel `C` is made of: once to each of the
/// neighbours, 1/16, and to the vertices opposite in an octahedron by way of the four between, 1/192 each.
fn sweeps(mut sweep: impl FnMut(Point, Point, i32)) {
    steps().for_each(|step| sweep([0, 0, 0], step, DENOMINATOR / 32));
    for unit in units() {
        for first in steps().filter(|&step| dot(step, unit) == 1) {
            let second = minus(plus(unit, unit), first);
            sweep([0, 0, 0], first, DENOMINATOR / 384);
            sweep(first, second, DENOMINATOR / 384);
        }
    }
}

/// `h` of an edge, a chain of triangles: `(K1 F)(e) = F(h e) / 384`.
///
/// `C - I = d K + K d` on all cochains of the lattice, where `C` takes 1/8 of a cell itself, 1/16 of each of its twelve
/// translates to a neighbour and 1/48 of each of the six to the opposite vertex of an octahedron. `K` is put together
/// from sweeps: moving a cell by a step, `T - I = d K + K d` with `(K F)(e) = F(` what `e` sweeps `)`.
pub(super) fn edge_homotopy(edge: [Point; 2]) -> Triangles {
    let mut chain = Triangles::new();
    sweeps(|offset, step, weight| swept_by_edge(&mut chain, edge.map(|p| plus(p, offset)), step, weight));
    chain.retain(|_, count| *count != 0);
    chain
}

/// `h` of a triangle, a chain of cells: `(K2 F)(t) = F(h t) / 384`.
pub(super) fn triangle_homotopy(triangle: [Point; 3]) -> Cells {
    let mut chain = Cells::new();
    sweeps(|offset, step, weight| {
        swept_by_triangle(&mut chain, triangle.map(|p| plus(p, offset)), step, weight);
    });
    chain.retain(|_, count| *count != 0);
    chain
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORIGIN: Point = [0, 0, 0];
    const EDGE: [Point; 2] = [ORIGIN, [1, 1, 0]];
    const TRIANGLE: [Point; 3] = [[1, 1, 0], [1, 0, 1], [0, 1, 1]];

    fn add_edge(chain: &mut BTreeMap<[Point; 2], i32>, [a, b]: [Point; 2], weight: i32) {
        let (key, weight) = if a < b { ([a, b], weight) } else { ([b, a], -weight) };
        *chain.entry(key).or_default() += weight;
    }

    /// `C` as a list of translations with numerators over the denominator.
    fn kernel() -> Vec<(Point, i32)> {
        let neighbours = steps().map(|step| (step, DENOMINATOR / 16));
        let opposite = units().map(|unit| (plus(unit, unit), DENOMINATOR / 48));
        neighbours.chain(opposite).chain([(ORIGIN, DENOMINATOR / 8)]).collect()
    }

    #[test]
    fn every_cell_is_outward_from_one_side_of_each_face() {
        for cell in [Cell::Tet(ORIGIN), Cell::Tet([1, 0, 0]), Cell::Oct([1, 0, 0])] {
            for ((triangle, sign), neighbour) in cell.boundary().into_iter().zip(cell.neighbours()) {
                assert!(neighbour.boundary().contains(&(triangle, -sign)));
            }
        }
    }

    /// `C - I = d K + K d`, exactly: on an edge `d(h e) + h(d e)`, with the paths of its ends as `h`.
    #[test]
    fn the_homotopy_of_an_edge_ends_at_the_kernel() {
        let chain = edge_homotopy(EDGE);
        assert_eq!(chain.len(), 76);
        let mut left = BTreeMap::new();
        for ([a, b, c], weight) in chain {
            [[a, b], [b, c], [c, a]].into_iter().for_each(|edge| add_edge(&mut left, edge, weight));
        }
        for (end, sign) in [(EDGE[1], 1), (EDGE[0], -1)] {
            sweeps(|offset, step, weight| {
                let from = plus(end, offset);
                add_edge(&mut left, [from, plus(from, step)], 2 * sign * weight);
            });
        }
        for (translation, weight) in kernel() {
            add_edge(&mut left, EDGE.map(|p| plus(p, translation)), -weight);
        }
        add_edge(&mut left, EDGE, DENOMINATOR);
        assert!(left.values().all(|&count| count == 0), "{left:?}");
    }

    #[test]
    fn the_homotopy_of_a_triangle_ends_at_the_kernel() {
        let chain = triangle_homotopy(TRIANGLE);
        assert_eq!(chain.len(), 26);
        let mut left = Triangles::new();
        for (cell, weight) in chain {
            cell.boundary().into_iter().for_each(|(face, sign)| add_triangle(&mut left, face, sign * weight));
        }
        let [a, b, c] = TRIANGLE;
        for side in [[a, b], [b, c], [c, a]] {
            for (face, weight) in edge_homotopy(side) {
                add_triangle(&mut left, face, weight);
            }
        }
        for (translation, weight) in kernel() {
            add_triangle(&mut left, TRIANGLE.map(|p| plus(p, translation)), -weight);
        }
        add_triangle(&mut left, TRIANGLE, DENOMINATOR);
        assert!(left.values().all(|&count| count == 0), "{left:?}");
    }

    /// On cells `C - I = K d` with nothing beyond: the cells that a cell's faces sweep.
    #[test]
    fn the_homotopy_moves_cells() {
        for cell in [Cell::Tet(ORIGIN), Cell::Oct([1, 0, 0])] {
            let mut left = Cells::new();
            for (face, sign) in cell.boundary() {
                for (swept, weight) in triangle_homotopy(face) {
                    *left.entry(swept).or_default() += sign * weight;
                }
            }
            for (translation, weight) in kernel() {
                let moved = match cell {
                    Cell::Tet(n) => Cell::Tet(plus(n, translation)),
                    Cell::Oct(n) => Cell::Oct(plus(n, translation)),
                };
                *left.entry(moved).or_default() -= weight;
            }
            *left.entry(cell).or_default() += DENOMINATOR;
            assert!(left.values().all(|&count| count == 0), "{left:?}");
        }
    }
}
