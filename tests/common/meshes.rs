//! Meshes that tests build: grids, fans, and random polygon meshes with random features.

use formwork::topology::{
    BoundaryInterpolation, Cage, Corner, Crease, CreasingMethod, Descriptor, TriangleSubdivision,
};
use proptest::prelude::*;

/// Polygons on `num_vertices` vertices.
pub fn polygons(num_vertices: usize, faces: &[Vec<u32>]) -> Descriptor {
    Descriptor {
        num_vertices,
        face_sizes: faces.iter().map(|face| face.len() as u32).collect(),
        face_vertices: faces.concat(),
        ..Default::default()
    }
}

/// `nx` by `ny` quads; vertex `(i, j)` is `i + j * columns`. A torus has `nx` columns and `ny` rows of
/// vertices, an open grid one more of each.
pub fn grid(nx: u32, ny: u32, torus: bool) -> Descriptor {
    let (columns, rows) = if torus { (nx, ny) } else { (nx + 1, ny + 1) };
    let at = |i: u32, j: u32| i % columns + (j % rows) * columns;
    let faces: Vec<_> = (0..nx * ny)
        .map(|f| {
            let (i, j) = (f % nx, f / nx);
            vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
        })
        .collect();
    polygons((columns * rows) as usize, &faces)
}

/// A smooth vertex 0 with faces of the given sizes round it: `w_i = 1 + i`, then for each face the vertices
/// between `w_i` and `w_{i+1}`; face `i` is `0, w_i, .., w_{i+1}`.
pub fn fan(sizes: &[u32]) -> Descriptor {
    let k = sizes.len() as u32;
    let mut next = 1 + k;
    let faces: Vec<Vec<u32>> = sizes
        .iter()
        .enumerate()
        .map(|(i, &size)| {
            let between: Vec<u32> = (next..next + size - 3).collect();
            next += size - 3;
            [vec![0, 1 + i as u32], between, vec![1 + (i as u32 + 1) % k]].concat()
        })
        .collect();
    polygons(next as usize, &faces)
}

/// A random polygon mesh: a grid, open or closed, some cells of which are cut into triangles, merged into
/// hexagons, or missing; with random creases, corners, holes and options. Irregular vertices touch.
pub fn random_cage() -> impl Strategy<Value = Cage> {
    let shape = (3u32..6, 3u32..6, any::<bool>());
    shape.prop_flat_map(|(nx, ny, torus)| {
        let cells = (nx * ny) as usize;
        let sharpness = prop_oneof![Just(10.0f32), 0.0f32..4.0, Just(1.0f32)];
        (
            proptest::collection::vec(0u8..8, cells),
            proptest::collection::vec((any::<prop::sample::Index>(), sharpness.clone()), 0..12),
            proptest::collection::vec((any::<prop::sample::Index>(), sharpness), 0..4),
            proptest::collection::vec(any::<prop::sample::Index>(), 0..3),
            (0usize..3, any::<bool>(), any::<bool>(), any::<bool>()),
        )
            .prop_map(move |(cuts, creases, corners, holes, options)| {
                decorate(cut_grid(nx, ny, torus, &cuts), &creases, &corners, &holes, options)
            })
    })
}

/// A torus of `2 nx ny` triangles: the cells of a grid, all cut along the same diagonal. Every vertex has
/// valence 6: the neighbours of `(i, j)` are `(+-1, 0)`, `(0, +-1)`, `(-1, 1)` and `(1, -1)`.
pub fn hexagonal_torus(nx: u32, ny: u32) -> Descriptor {
    let quads = grid(nx, ny, true);
    let halves =
        quads.face_vertices.chunks_exact(4).flat_map(|c| [vec![c[0], c[1], c[3]], vec![c[1], c[2], c[3]]]);
    polygons(quads.num_vertices, &halves.collect::<Vec<_>>())
}

/// A vertex 0 with `k` triangles round it, a full turn or open; triangle `i` is `0, 1 + i, 2 + i`.
pub fn triangle_fan(k: u32, cyclic: bool) -> Descriptor {
    let last = if cyclic { k } else { k + 1 };
    let faces: Vec<_> = (0..k).map(|i| vec![0, 1 + i, 1 + (i + 1) % last]).collect();
    polygons(1 + last as usize, &faces)
}

/// Two cones of `k` triangles on a common rim: a closed surface with vertices of valence `k` and 4.
pub fn bipyramid(k: u32) -> Descriptor {
    let rim = |i: u32| 2 + i % k;
    let faces: Vec<_> =
        (0..k).flat_map(|i| [vec![0, rim(i), rim(i + 1)], vec![1, rim(i + 1), rim(i)]]).collect();
    polygons(2 + k as usize, &faces)
}

/// A random triangle mesh: a grid with cells cut along random diagonals or missing, then new vertices put
/// into random triangles, over and over, so that valences from 3 up lie side by side; random features.
pub fn random_triangles() -> impl Strategy<Value = Cage> {
    (3u32..5, 3u32..5, any::<bool>()).prop_flat_map(|(nx, ny, torus)| {
        let sharpness = prop_oneof![Just(10.0f32), 0.0f32..4.0, Just(1.0f32)];
        (
            proptest::collection::vec(
                prop_oneof![1 => Just(0u8), 4 => Just(1u8), 4 => Just(2u8)],
                (nx * ny) as usize,
            ),
            proptest::collection::vec(any::<prop::sample::Index>(), 0..24),
            proptest::collection::vec((any::<prop::sample::Index>(), sharpness.clone()), 0..8),
            proptest::collection::vec((any::<prop::sample::Index>(), sharpness), 0..4),
            (0usize..3, any::<bool>(), any::<bool>()),
        )
            .prop_map(
                move |(cuts, insertions, creases, corners, (boundary, chaikin, left_handed))| {
                    let mut d = cut_grid(nx, ny, torus, &cuts);
                    for index in insertions {
                        let face = index.index(d.face_sizes.len());
                        insert_vertex(&mut d, face);
                    }
                    decorate(d, &creases, &corners, &[], (boundary, chaikin, false, left_handed))
                },
            )
    })
}

/// Puts a vertex into a triangle.
fn insert_vertex(d: &mut Descriptor, face: usize) {
    let new = d.num_vertices as u32;
    let [a, b, c] = [0, 1, 2].map(|i| d.face_vertices[3 * face + i]);
    d.num_vertices += 1;
    d.face_vertices[3 * face + 2] = new;
    d.face_vertices.extend([b, c, new, c, a, new]);
    d.face_sizes.extend([3, 3]);
}

/// A grid with each cell treated as its number says: 0 missing, 1 and 2 cut along a diagonal, 3 merged
/// with its right neighbour if that is whole, else left whole.
pub fn cut_grid(nx: u32, ny: u32, torus: bool, cuts: &[u8]) -> Descriptor {
    let base = grid(nx, ny, torus);
    let mut cells: Vec<Option<[u32; 4]>> =
        base.face_vertices.chunks_exact(4).map(|c| Some([c[0], c[1], c[2], c[3]])).collect();
    let mut faces = Vec::new();
    for f in 0..cells.len() {
        let Some([a, b, c, d]) = cells[f].take() else { continue };
        match cuts[f] {
            0 => {}
            1 => faces.extend([vec![a, b, c], vec![a, c, d]]),
            2 => faces.extend([vec![a, b, d], vec![b, c, d]]),
            3 if (f + 1) % nx as usize != 0 && cuts[f + 1] > 3 => {
                let [_, e, g, _] = cells[f + 1].take().unwrap();
                faces.push(vec![a, b, e, g, c, d]);
            }
            _ => faces.push(vec![a, b, c, d]),
        }
    }
    if faces.is_empty() {
        faces.push(vec![0, 1, 2]);
    }
    polygons(base.num_vertices, &faces)
}

fn decorate(
    mut d: Descriptor,
    creases: &[(prop::sample::Index, f32)],
    corners: &[(prop::sample::Index, f32)],
    holes: &[prop::sample::Index],
    (boundary, chaikin, smooth_triangles, left_handed): (usize, bool, bool, bool),
) -> Cage {
    let first_corner: Vec<usize> = d
        .face_sizes
        .iter()
        .scan(0, |next, &size| {
            *next += size as usize;
            Some(*next - size as usize)
        })
        .collect();
    for (index, sharpness) in creases {
        let corner = index.index(d.face_vertices.len());
        let face = first_corner.partition_point(|&first| first <= corner) - 1;
        let next = if corner + 1 < first_corner[face] + d.face_sizes[face] as usize {
            corner + 1
        } else {
            first_corner[face]
        };
        let vertices = [d.face_vertices[corner], d.face_vertices[next]];
        d.creases.push(Crease { vertices, sharpness: *sharpness });
    }
    for (index, sharpness) in corners {
        d.corners.push(Corner { vertex: index.index(d.num_vertices) as u32, sharpness: *sharpness });
    }
    d.holes = holes.iter().map(|index| index.index(d.face_sizes.len()) as u32).collect();
    d.boundary =
        [BoundaryInterpolation::None, BoundaryInterpolation::EdgeOnly, BoundaryInterpolation::EdgeAndCorner]
            [boundary];
    d.creasing = if chaikin { CreasingMethod::Chaikin } else { CreasingMethod::Uniform };
    d.triangles = if smooth_triangles { TriangleSubdivision::Smooth } else { TriangleSubdivision::Catmark };
    d.left_handed = left_handed;
    Cage::new(d).unwrap()
}
