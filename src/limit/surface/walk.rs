//! From a cochain's values round a face down to the coefficients at a point.

use super::super::frame::Frame;
use super::super::tables::Table;
use super::super::vertex::VertexTable;
use super::LimitSurface;
use crate::cochain::Value;
use crate::sparse::Csr;

/// Where the descent to an irregular vertex gives up: within 1e-13 of it in the parameters.
const MAX_DEPTH: usize = 44;

/// And the descent of a 0-form to a boundary or crease where a scheme's own rule leaves no polynomials: what is left
/// decays like 2^-depth, while the differences that its derivatives are made of drown in rounding.
const ROUGH_DEPTH: usize = 24;

/// The most faces that are remembered: the children of a face of the cage, two levels down.
const MOST_TREES: usize = 16;

/// What the limit is at a point.
pub enum Found<'a> {
    /// A polynomial, the point in its frame.
    Patch(Frame),
    /// An irregular vertex.
    Vertex(&'a VertexTable),
}

/// Finds what a cochain is at points, and remembers what it met on the way: points near each other, one after
/// another, share all work but that on the point itself. What is found does not depend on what was before.
pub struct Walk<'a, T> {
    surface: &'a LimitSurface,
    form: &'a [T],
    degree: usize,
    trees: Vec<Tree<T>>,
}

/// A face with those of its descendants that have been visited, the face itself first.
struct Tree<T> {
    face: u32,
    /// What was taken off all values of a 0-form: the limit at the face's irregular vertex. Near it they differ by
    /// little, and that little would drown in rounding.
    centre: Option<T>,
    /// The first `len` are in use, the others keep their memory.
    nodes: Vec<Node<T>>,
    len: usize,
}

struct Node<T> {
    /// The table of the face, `None` where `values` are the coefficients of a polynomial.
    table: Option<u32>,
    values: Vec<T>,
    /// The numbers of the children, then that of the polynomial over these values; 0 if not visited.
    below: [u32; 5],
}

const POLYNOMIAL: usize = 4;

/// The maps of one degree from a face with a table down to a point, and what the limit is there: the way that
/// [`Walk::find`] takes, without values.
pub fn descent<'a>(
    surface: &'a LimitSurface,
    number: usize,
    mut frame: Frame,
    degree: usize,
) -> (Vec<&'a Csr>, Found<'a>) {
    let kind = surface.hierarchy.split_kind();
    let (mut steps, mut at) = (Vec::new(), Some(number));
    while let Some(number) = at {
        let table = surface.tables.get(number);
        if let Some(vertex) = table.vertex.as_ref().filter(|_| is_at_vertex(&frame)) {
            return (steps, Found::Vertex(vertex));
        }
        if steps.len() < deepest(table, degree) && !table.children.is_empty() {
            let (number, below) = frame.descend(kind);
            let child = &table.children[number];
            frame = below.turned(kind, child.turn);
            at = child.table;
            steps.push(&child.maps[degree]);
        } else if let Some(rows) = &table.polynomial {
            at = None;
            steps.push(&rows[degree]);
        } else {
            unreachable!("only the way to an irregular vertex has no end")
        }
    }
    (steps, Found::Patch(frame))
}

/// How many steps are taken below a face before its polynomial takes over.
fn deepest(table: &Table, degree: usize) -> usize {
    let rough = table.polynomial.is_some() && degree == 0;
    if rough { ROUGH_DEPTH } else { MAX_DEPTH }
}

impl<'a, T: Value> Walk<'a, T> {
    /// Walks with a cochain of the finest level.
    ///
    /// # Panics
    /// If it is one of another level.
    pub fn new(surface: &'a LimitSurface, degree: usize, form: &'a [T]) -> Self {
        let hierarchy = surface.hierarchy();
        let num_cells = hierarchy.finest().mesh().num_cells(degree);
        assert_eq!(form.len(), num_cells, "a cochain of another level");
        let descendants = 4usize.checked_pow(hierarchy.num_levels() as u32).unwrap_or(MOST_TREES);
        let tree = || Tree { face: u32::MAX, centre: None, nodes: Vec::new(), len: 0 };
        let trees = std::iter::repeat_with(tree).take(descendants.min(MOST_TREES)).collect();
        Walk { surface, form, degree, trees }
    }

    /// What the limit is at a point of a face of the finest level, and its coefficients, or its values on the cells
    /// of the vertex and more.
    pub fn find(&mut self, face: u32, mut frame: Frame) -> (Found<'a>, &[T]) {
        let (surface, degree) = (self.surface, self.degree);
        let kind = surface.hierarchy.split_kind();
        let slot = face as usize % self.trees.len();
        if self.trees[slot].face != face {
            self.plant(slot, face);
        }
        let tree = &mut self.trees[slot];
        let mut at = 0;
        for depth in 0.. {
            let Some(number) = tree.nodes[at].table else { break };
            let table = surface.tables.get(number as usize);
            if let Some(vertex) = table.vertex.as_ref().filter(|_| is_at_vertex(&frame)) {
                return (Found::Vertex(vertex), &tree.nodes[at].values);
            }
            if depth < deepest(table, degree) && !table.children.is_empty() {
                let (number, below) = frame.descend(kind);
                let child = &table.children[number];
                frame = below.turned(kind, child.turn);
                at = tree.below(at, number, child.table.map(|table| table as u32), &child.maps[degree]);
            } else if let Some(rows) = &table.polynomial {
                at = tree.below(at, POLYNOMIAL, None, &rows[degree]);
            } else {
                unreachable!("only the way to an irregular vertex has no end")
            }
        }
        (Found::Patch(frame), &tree.nodes[at].values)
    }

    /// What has to be added to the values found on a face, those of a 0-form next to an irregular vertex.
    pub fn centre(&self, face: u32) -> Option<T> {
        self.trees[face as usize % self.trees.len()].centre
    }

    /// Begins a tree anew with the values round a face.
    fn plant(&mut self, slot: usize, face: u32) {
        let tree = &mut self.trees[slot];
        (tree.face, tree.len) = (face, 0);
        let patch = self.surface.patches[face as usize];
        let root = tree.add(Some(patch.table));
        let table = self.surface.tables.get(patch.table as usize);
        let sizes = table.sizes;
        let start = patch.cells as usize + sizes[..self.degree].iter().sum::<usize>();
        let cells = &self.surface.cells[start..start + sizes[self.degree]];
        let (form, values) = (self.form, &mut tree.nodes[root].values);
        match self.degree {
            1 => values.extend(cells.iter().map(|&h| {
                let x = form[(h >> 1) as usize];
                if h & 1 == 0 { x } else { x * -1.0 }
            })),
            _ => values.extend(cells.iter().map(|&cell| form[cell as usize])),
        }
        let vertex = table.vertex.as_ref().filter(|_| self.degree == 0);
        tree.centre = vertex.map(|vertex| vertex.limit(values).0);
        if let Some(centre) = tree.centre {
            values.iter_mut().for_each(|x| *x = *x - centre);
        }
    }
}

/// Whether a point is as near to the corner of its frame as evaluation goes.
fn is_at_vertex(frame: &Frame) -> bool {
    frame.point.iter().all(|&x| x.abs() < 0.5f64.powi(MAX_DEPTH as i32))
}

impl<T: Value> Tree<T> {
    /// A node without values.
    fn add(&mut self, table: Option<u32>) -> usize {
        if self.len == self.nodes.len() {
            self.nodes.push(Node { table, values: Vec::new(), below: [0; 5] });
        }
        let node = &mut self.nodes[self.len];
        (node.table, node.below) = (table, [0; 5]);
        node.values.clear();
        self.len += 1;
        self.len - 1
    }

    /// A node below another, made by `map` if it has not been visited.
    #[inline]
    fn below(&mut self, at: usize, place: usize, table: Option<u32>, map: &Csr) -> usize {
        match self.nodes[at].below[place] {
            0 => self.visit(at, place, table, map),
            known => known as usize,
        }
    }

    fn visit(&mut self, at: usize, place: usize, table: Option<u32>, map: &Csr) -> usize {
        let new = self.add(table);
        self.nodes[at].below[place] = new as u32;
        let (before, after) = self.nodes.split_at_mut(new);
        let (x, y) = (&before[at].values, &mut after[0].values);
        let (rows, columns, weights) = (map.indptr(), map.indices(), map.data());
        let zero = x[0] * 0.0;
        y.extend(rows.raw_storage().windows(2).map(|row| {
            let mut sum = zero;
            for (&j, &weight) in columns[row[0]..row[1]].iter().zip(&weights[row[0]..row[1]]) {
                sum = sum + x[j as usize] * weight;
            }
            sum
        }));
        new
    }
}
