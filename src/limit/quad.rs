//! The grids of quads whose surroundings are regular, or regular up to a boundary or crease.

use std::collections::HashMap;

use super::neighbourhood::{Cells, Configuration};
use crate::sparse::{Csr, assemble};
use crate::topology::Mesh;

/// One combination of cells, all of them listed.
type Combination = Vec<f64>;

/// The grids of a face, over its cells: 16, 24 and 9 rows, as [`super::patch`] wants them. Beyond a sharp edge there is a
/// layer of phantoms: `x_{-1} = 2 x_0 - x_1` for vertices and the edges along it, while the edges across it and
/// the faces repeat.
pub fn grids(mesh: &Mesh, cells: &Cells, configuration: Configuration) -> [Csr; 3] {
    let place = coordinates(cells, configuration);
    let unit = |n: usize, i: usize, sign: f64| {
        let mut unit = vec![0.0; n];
        unit[i] = sign;
        Some(unit)
    };
    let mut vertices: Vec<Option<Combination>> = vec![None; 16];
    for (i, v) in cells.vertices.iter().enumerate() {
        let [x, y] = place[v];
        vertices[4 * y + x] = unit(cells.vertices.len(), i, 1.0);
    }
    // Edges along s are 4 rows of 3, those along t 3 rows of 4.
    let (mut along_s, mut along_t) = (vec![None; 12], vec![None; 12]);
    for (i, &h) in cells.edges.iter().enumerate() {
        let (from, to) = (place[&mesh.tail(h)], place[&mesh.head(h)]);
        let sign = if from < to { 1.0 } else { -1.0 };
        let [x, y] = from.min(to);
        match from[1] == to[1] {
            true => along_s[3 * y + x] = unit(cells.edges.len(), i, sign),
            false => along_t[4 * y + x] = unit(cells.edges.len(), i, sign),
        }
    }
    let mut faces = vec![None; 9];
    for (i, &f) in cells.faces.iter().enumerate() {
        let [x, y] = mesh.face_vertices(f).iter().map(|v| place[v]).min().expect("a face has vertices");
        faces[3 * y + x] = unit(cells.faces.len(), i, 1.0);
    }

    for (axis, missing) in [(0, vertices[4].is_none()), (1, vertices[1].is_none())] {
        if missing {
            fill(&mut vertices, [4, 4], axis, extend);
            fill(&mut along_s, [3, 4], axis, if axis == 0 { repeat } else { extend });
            fill(&mut along_t, [4, 3], axis, if axis == 0 { extend } else { repeat });
            fill(&mut faces, [3, 3], axis, repeat);
        }
    }
    let rows = |rows: Vec<Option<Combination>>, columns: usize| {
        assemble((rows.len(), columns), |i, row| {
            let weights = rows[i].as_ref().expect("the grid is full");
            weights.iter().enumerate().filter(|(_, w)| **w != 0.0).for_each(|(j, &w)| row.add(j as u32, w));
        })
    };
    [
        rows(vertices, cells.vertices.len()),
        rows([along_s, along_t].concat(), cells.edges.len()),
        rows(faces, cells.faces.len()),
    ]
}

fn extend(first: &[f64], second: &[f64]) -> Combination {
    first.iter().zip(second).map(|(a, b)| 2.0 * a - b).collect()
}

fn repeat(first: &[f64], _: &[f64]) -> Combination {
    first.to_vec()
}

/// Fills the first layer of a grid of `size` along an axis from the next two, where those are there.
fn fill(
    grid: &mut [Option<Combination>],
    size: [usize; 2],
    axis: usize,
    rule: fn(&[f64], &[f64]) -> Combination,
) {
    for across in 0..size[1 - axis] {
        let at = |layer: usize| if axis == 0 { size[0] * across + layer } else { size[0] * layer + across };
        if let (Some(first), Some(second)) = (&grid[at(1)], &grid[at(2)]) {
            grid[at(0)] = Some(rule(first, second));
        }
    }
}

/// The grids of a quad of the bilinear scheme, over its vertices, its edges and itself: the B-splines of a grid
/// that goes on linearly on all sides are linear.
pub fn whitney() -> [Csr; 3] {
    // Linear extension from the two middle layers, and repetition.
    let extend = [[2.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 2.0]];
    let at = |x: usize, y: usize| [0, 1, 3, 2][x + 2 * y];
    let vertices = assemble((16, 4), |i, row| {
        for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            row.add(at(x, y), extend[i % 4][x] * extend[i / 4][y]);
        }
    });
    // The edges run round the face: the third and the fourth against the axes.
    let edges = assemble((24, 4), |i, row| {
        let layer = if i < 12 { extend[i / 3] } else { extend[(i - 12) % 4] };
        let [near, far] = if i < 12 { [(0, 1.0), (2, -1.0)] } else { [(3, -1.0), (1, 1.0)] };
        row.add(near.0, near.1 * layer[0]);
        row.add(far.0, far.1 * layer[1]);
    });
    [vertices, edges, assemble((9, 1), |_, row| row.add(0, 1.0))]
}

/// The place of each vertex in the grid, the face being the middle cell.
fn coordinates(cells: &Cells, c: Configuration) -> HashMap<u32, [usize; 2]> {
    // The spokes in steps from the one along s.
    let spoke = |i: u32| {
        let turn = (i as i32 - c.position as i32).rem_euclid(4);
        [[1, 0], [0, 1], [-1, 0], [0, -1]][turn as usize]
    };
    let mut offsets = vec![[0, 0]];
    for i in 0..c.faces {
        let (w, next) = (spoke(i), spoke(i + 1));
        offsets.extend([w, [w[0] + next[0], w[1] + next[1]]]);
    }
    if !c.cyclic {
        offsets.push(spoke(c.faces));
    }
    offsets.extend([[2, 0], [2, 1], [2, 2], [1, 2], [0, 2]]);
    let begins_sharp = !c.cyclic;
    if !(begins_sharp && c.position == 0) {
        offsets.push([2, -1]);
    }
    if !(begins_sharp && c.position + 1 == c.faces) {
        offsets.push([-1, 2]);
    }
    let place = |[x, y]: [i32; 2]| [(x + 1) as usize, (y + 1) as usize];
    cells.vertices.iter().copied().zip(offsets.into_iter().map(place)).collect()
}
