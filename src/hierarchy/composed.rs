//! Operators from one level straight to a later one.
//!
//! What is refined over a face depends on the cells of the faces that share a vertex with it, on every level: its
//! *region*. So the product of two operators need not search for columns. Columns that are in no region together share a
//! place: each row is a short dense sum over places, and in the end the region of the row's face says which column
//! each place stands for. (This is how sparse Jacobians are estimated: Curtis, Powell, Reid, "On the estimation of
//! sparse Jacobian matrices", 1974.)

use std::ops::Range;

use rayon::prelude::*;

use super::Hierarchy;
use crate::scheme::{Scheme, Variant};
use crate::sparse::{Csr, Part, assemble_parts, multiply, row_of};
use crate::topology::{ChildEdge, Mesh, Parent, Split};

/// More places than this and rows are too sparse for dense sums: columns are searched for instead.
const MOST_PLACES: u32 = 96;

/// More faces round one vertex than this and regions are too large.
const MOST_FACES: usize = 32;

/// `S` of `degree` from level `from` to level `to`.
pub fn operator(hierarchy: &Hierarchy, degree: usize, [from, to]: [usize; 2]) -> Csr {
    let step = |level: usize| hierarchy.operator(degree, level);
    let base = hierarchy.level(from).mesh();
    // Modified Loop looks further: an irregular vertex changes the midpoints of the edges round it.
    let far = matches!(hierarchy.scheme(), Scheme::Loop(Variant::ModifiedLoop, _));
    let packing = if to < from + 2 || far { None } else { Packing::new(base, degree) };
    let Some(packing) = packing else {
        return (from + 2..=to).fold(step(from + 1), |product, level| multiply(&step(level), &product));
    };
    let mut owners = Owners::of(base, &packing.regions);
    let mut product = packing.pack(&step(from + 1));
    for level in from + 1..to {
        owners = owners.of_children(hierarchy.level(level - 1).mesh(), hierarchy.refinement(level).split());
        let next = step(level + 1);
        if level + 1 < to {
            product = packing.multiply(&next, &product);
        } else {
            let (parent, split) = (hierarchy.level(level).mesh(), hierarchy.refinement(to).split());
            let region = |row: usize| owners.of_child(degree, parent, split, row);
            return packing.unpack(&next, &product, base.num_cells(degree), region);
        }
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

/// A place for each column, such that the columns of a region have places of their own.
struct Packing {
    regions: Sets,
    place: Vec<u8>,
    places: usize,
}

impl Packing {
    /// Greedily, column by column. `None` if that takes too many places.
    fn new(mesh: &Mesh, degree: usize) -> Option<Packing> {
        let regions = Sets::regions(mesh, degree)?;
        let columns = mesh.num_cells(degree);
        // For each column the regions it is in.
        let mut offsets = vec![0u32; columns + 1];
        regions.cells.iter().for_each(|&cell| offsets[cell as usize + 1] += 1);
        (0..columns).for_each(|i| offsets[i + 1] += offsets[i]);
        let (mut next, mut of) = (offsets.clone(), vec![0u32; regions.cells.len()]);
        for region in 0..regions.len() {
            for &cell in regions.get(region) {
                of[next[cell as usize] as usize] = region as u32;
                next[cell as usize] += 1;
            }
        }
        let (mut taken, mut place, mut places) = (vec![0u128; regions.len()], vec![0u8; columns], 0);
        for column in 0..columns {
            let around = &of[offsets[column] as usize..offsets[column + 1] as usize];
            let free = around.iter().fold(0, |all, &region| all | taken[region as usize]).trailing_ones();
            if free >= MOST_PLACES {
                return None;
            }
            around.iter().for_each(|&region| taken[region as usize] |= 1 << free);
            place[column] = free as u8;
            places = places.max(free as usize + 1);
        }
        Some(Packing { regions, place, places })
    }

    /// A matrix as sums over places, row by row.
    fn pack(&self, matrix: &Csr) -> Vec<f64> {
        let mut sums = vec![0.0; matrix.rows() * self.places];
        sums.par_chunks_mut(self.places).enumerate().with_min_len(1024).for_each(|(i, sums)| {
            let (columns, weights) = row_of(matrix, i);
            for (&column, &weight) in columns.iter().zip(weights) {
                sums[self.place[column as usize] as usize] = weight;
            }
        });
        sums
    }

    /// A row times a packed matrix, added to `sums`.
    #[inline]
    fn add_row(&self, (columns, weights): (&[u32], &[f64]), packed: &[f64], sums: &mut [f64]) {
        for (&column, &weight) in columns.iter().zip(weights) {
            let row = &packed[column as usize * self.places..][..self.places];
            sums.iter_mut().zip(row).for_each(|(sum, x)| *sum += weight * x);
        }
    }

    fn multiply(&self, matrix: &Csr, packed: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; matrix.rows() * self.places];
        let rows = sums.par_chunks_mut(self.places).enumerate().with_min_len(1024);
        rows.for_each(|(i, sums)| self.add_row(row_of(matrix, i), packed, sums));
        sums
    }

    /// The product, each place as the column that it stands for in the region of the row.
    fn unpack(
        &self,
        matrix: &Csr,
        packed: &[f64],
        columns: usize,
        region: impl Fn(usize) -> u32 + Sync,
    ) -> Csr {
        assemble_parts((matrix.rows(), columns), |rows: Range<usize>, part: &mut Part| {
            let mut sums = vec![0.0; self.places];
            for i in rows {
                sums.fill(0.0);
                self.add_row(row_of(matrix, i), packed, &mut sums);
                let region = self.regions.get(region(i) as usize);
                part.push_row(region, |column| sums[self.place[column as usize] as usize]);
            }
        })
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

    fn of_children(&self, parent: &Mesh, split: &Split) -> Self {
        Owners([0, 1, 2].map(|degree| {
            let owner = |child| self.of_child(degree, parent, split, child);
            (0..split.num_children(degree)).into_par_iter().map(owner).collect()
        }))
    }
}
