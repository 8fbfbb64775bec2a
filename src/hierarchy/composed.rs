//! Operators from one level straight to a later one.
//!
//! What is refined over a face depends on the cells of the faces that share a vertex with it, on every level: its
//! *region*. So the product of two operators need not search for columns: each row is a short dense sum over the
//! region of a face that it lies over. Most rows meet rows over the same face, whose sums are aligned with theirs.

use rayon::prelude::*;

use super::Hierarchy;
use super::rows::{self, Rows, Terms};
use crate::scheme::{Scheme, Variant};
use crate::sparse::{Csr, assemble_parts, front, multiply};
use crate::topology::{ChildEdge, Mesh, Parent, Split};

/// More faces round one vertex than this and regions are too large: columns are searched for instead.
const MOST_FACES: usize = 32;

/// `S` of `degree` from level `from` to level `to`.
pub fn operator(hierarchy: &Hierarchy, degree: usize, [from, to]: [usize; 2]) -> Csr {
    let step = |level: usize| hierarchy.operator(degree, level);
    let base = hierarchy.level(from).mesh();
    // Modified Loop looks further: an irregular vertex changes the midpoints of the edges round it.
    let far = matches!(hierarchy.scheme(), Scheme::Loop(Variant::ModifiedLoop, _));
    let regions = if to < from + 2 || far { None } else { Sets::regions(base, degree) };
    let Some(regions) = regions else {
        return (from + 2..=to).fold(step(from + 1), |product, level| multiply(&step(level), &product));
    };
    let mut owners = Owners::of(base, &regions);
    let mut product = Product::identity(&regions, &owners.0[degree]);
    for level in from + 1..=to {
        let (parent, refinement) = (hierarchy.level(level - 1).mesh(), hierarchy.refinement(level));
        let (left, columns) = (rows::rows(refinement, parent, degree), base.num_cells(degree));
        let next =
            |owners| Multiplication { regions: &regions, columns, left: &*left, right: &product, owners };
        if level == to {
            return next(owners.of_children(parent, refinement.split(), degree)).matrix();
        }
        owners = Owners([0, 1, 2].map(|degree| owners.of_children(parent, refinement.split(), degree)));
        product = next(owners.0[degree].clone()).product();
    }
    unreachable!("the last level is among those")
}

/// Sets of cells, one after the other, each ascending.
struct Sets {
    offsets: Vec<u32>,
    cells: Vec<u32>,
}

impl Sets {
    fn get(&self, set: usize) -> &[u32] {
        &self.cells[self.offsets[set] as usize..self.offsets[set + 1] as usize]
    }

    fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// The region of each face, then one of its own for each isolated vertex; `None` if they are too large.
    fn regions(mesh: &Mesh, degree: usize) -> Option<Sets> {
        let corners_of = |v: u32| mesh.fans(v).flat_map(|fan| fan.corners);
        let vertices = 0..mesh.num_vertices() as u32;
        if vertices.clone().any(|v| corners_of(v).count() > MOST_FACES) {
            return None;
        }
        let region = |f: u32| {
            let mut cells = Vec::new();
            for &v in mesh.face_vertices(f) {
                for face in corners_of(v).map(|&c| mesh.corner_face(c)) {
                    match degree {
                        0 => cells.extend_from_slice(mesh.face_vertices(face)),
                        1 => cells.extend(mesh.face_half_edges(face).iter().map(|h| h.edge())),
                        _ => cells.push(face),
                    }
                }
            }
            cells.sort_unstable();
            cells.dedup();
            cells
        };
        let mut sets: Vec<Vec<u32>> = (0..mesh.num_faces() as u32).into_par_iter().map(region).collect();
        sets.extend(isolated(mesh).map(|v| if degree == 0 { vec![v] } else { Vec::new() }));
        let mut offsets = vec![0];
        for set in &sets {
            offsets.push(offsets[offsets.len() - 1] + set.len() as u32);
        }
        Some(Sets { offsets, cells: sets.concat() })
    }
}

fn isolated(mesh: &Mesh) -> impl Iterator<Item = u32> {
    (0..mesh.num_vertices() as u32).filter(|&v| mesh.fans(v).len() == 0)
}

/// Rows as sums over the regions of faces.
struct Product {
    /// For each row its region, and where its sums begin.
    owners: Vec<u32>,
    starts: Vec<usize>,
    sums: Vec<f64>,
}

impl Product {
    /// Of these regions, all zero.
    fn zeros(regions: &Sets, owners: &[u32]) -> Self {
        let mut starts = Vec::with_capacity(owners.len() + 1);
        starts.push(0);
        let mut end = 0;
        starts.extend(owners.iter().map(|&owner| {
            end += regions.get(owner as usize).len();
            end
        }));
        Product { owners: owners.to_vec(), starts, sums: vec![0.0; end] }
    }

    /// Whose rows have 1 in their own column.
    fn identity(regions: &Sets, owners: &[u32]) -> Self {
        let mut rows = Product::zeros(regions, owners);
        for (row, &owner) in owners.iter().enumerate() {
            let place = regions.get(owner as usize).binary_search(&(row as u32));
            rows.sums[rows.starts[row] + place.expect("a cell is in its own region")] = 1.0;
        }
        rows
    }

    fn get(&self, row: u32) -> &[f64] {
        &self.sums[self.starts[row as usize]..self.starts[row as usize + 1]]
    }
}

/// Runs that are long enough to be done by themselves.
const RUN: usize = 4096;

/// Of rows over the regions of a level with rows over them.
struct Multiplication<'a> {
    regions: &'a Sets,
    columns: usize,
    left: &'a dyn Rows,
    right: &'a Product,
    /// The regions of the rows of the product.
    owners: Vec<u32>,
}

/// What rows of a product need one after the other.
struct Scratch {
    terms: Terms,
    region: Option<u32>,
    /// For each column its position in the region; for those that are not in it, that after all others.
    place: Vec<u32>,
    sums: Vec<f64>,
}

impl Multiplication<'_> {
    fn scratch(&self) -> Scratch {
        Scratch { terms: Terms::default(), region: None, place: vec![0; self.columns], sums: Vec::new() }
    }

    /// A row of the product, over its region.
    #[inline]
    fn row<'s>(&self, row: usize, scratch: &'s mut Scratch) -> &'s [f64] {
        let Scratch { terms, region: current, place, sums } = scratch;
        let owner = self.owners[row];
        let region = self.regions.get(owner as usize);
        if *current != Some(owner) {
            // What is in no region together with these has cancelled, to rounding: it goes nowhere.
            let last = current.replace(owner).map(|last| self.regions.get(last as usize));
            match last {
                Some(last) => last.iter().for_each(|&column| place[column as usize] = u32::MAX),
                None => place.fill(u32::MAX),
            }
            region.iter().zip(0..).for_each(|(&column, i)| place[column as usize] = i);
        }
        sums.clear();
        sums.resize(region.len() + 1, 0.0);
        let (beyond, sums) = (region.len() as u32, &mut sums[..]);
        let (columns, weights) = self.left.get(row, terms);
        for (&column, &weight) in columns.iter().zip(weights) {
            let (other, values) = (self.right.owners[column as usize], self.right.get(column));
            if other == owner {
                sums.iter_mut().zip(values).for_each(|(sum, x)| *sum += weight * x);
            } else {
                for (&column, &x) in self.regions.get(other as usize).iter().zip(values) {
                    sums[place[column as usize].min(beyond) as usize] += weight * x;
                }
            }
        }
        &sums[..region.len()]
    }

    fn product(&self) -> Product {
        let mut product = Product::zeros(self.regions, &self.owners);
        let (starts, mut rest) = (&product.starts, &mut product.sums[..]);
        let runs = (0..self.owners.len()).step_by(RUN).map(|first| {
            let end = (first + RUN).min(self.owners.len());
            (first..end, front(&mut rest, starts[end] - starts[first]))
        });
        let runs: Vec<_> = runs.collect();
        runs.into_par_iter().for_each(|(rows, mut sums)| {
            let mut scratch = self.scratch();
            for i in rows {
                let row = self.row(i, &mut scratch);
                front(&mut sums, row.len()).copy_from_slice(row);
            }
        });
        product
    }

    fn matrix(&self) -> Csr {
        let shape = (self.owners.len(), self.columns);
        assemble_parts(
            shape,
            || self.scratch(),
            |scratch, rows, part| {
                for i in rows {
                    part.push_row(self.regions.get(self.owners[i] as usize), self.row(i, scratch));
                }
            },
        )
    }
}

/// For each cell of a level a region that its row is in: that of the face it is over, or of one beside it.
struct Owners([Vec<u32>; 3]);

impl Owners {
    fn of(mesh: &Mesh, regions: &Sets) -> Self {
        let faces = mesh.num_faces() as u32;
        let (mut vertices, mut edges) = (vec![0; mesh.num_vertices()], vec![0; mesh.num_edges()]);
        for f in 0..faces {
            mesh.face_vertices(f).iter().for_each(|&v| vertices[v as usize] = f);
            mesh.face_half_edges(f).iter().for_each(|h| edges[h.edge() as usize] = f);
        }
        isolated(mesh).zip(faces..regions.len() as u32).for_each(|(v, own)| vertices[v as usize] = own);
        Owners([vertices, edges, (0..faces).collect()])
    }

    #[inline]
    fn of_child(&self, degree: usize, parent: &Mesh, split: &Split, child: usize) -> u32 {
        let [vertices, edges, faces] = &self.0;
        match degree {
            0 => match split.vertex_parent(child) {
                Parent::Vertex(v) => vertices[v as usize],
                Parent::Edge(e) => edges[e as usize],
                Parent::Face(f) => faces[f as usize],
            },
            1 => match split.edge_parent(child) {
                ChildEdge::Odd(corner) => faces[parent.corner_face(corner) as usize],
                ChildEdge::Even(h) => edges[h.edge() as usize],
            },
            _ => faces[split.face_parent(parent, child) as usize],
        }
    }

    /// Those of the children of a dimension.
    fn of_children(&self, parent: &Mesh, split: &Split, degree: usize) -> Vec<u32> {
        let owner = |child| self.of_child(degree, parent, split, child);
        (0..split.num_children(degree)).into_par_iter().map(owner).collect()
    }
}
