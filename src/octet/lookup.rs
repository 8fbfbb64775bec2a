//! Cells found by their vertices, in linear time and without hashing: a bucket for each lowest vertex.

/// Cells of `N` vertices, found by their vertices in any order.
pub(super) struct Lookup<const N: usize> {
    offsets: Vec<u32>,
    /// Sorted vertices and the cell's number, ascending in each bucket.
    cells: Vec<([u32; N], u32)>,
}

impl<const N: usize> Lookup<N> {
    /// Files the cells. The error is a pair of cells with the same vertices.
    pub fn new(num_vertices: usize, cells: &[[u32; N]]) -> Result<Self, [usize; 2]> {
        let sorted = cells.iter().map(|&cell| ascending(cell)).zip(0..);
        let (offsets, mut filed) = bucket(num_vertices, sorted);
        for pair in offsets.windows(2) {
            let bucket = &mut filed[pair[0] as usize..pair[1] as usize];
            bucket.sort_unstable();
            if let Some(twins) = bucket.windows(2).find(|pair| pair[0].0 == pair[1].0) {
                return Err([twins[0].1 as usize, twins[1].1 as usize]);
            }
        }
        Ok(Lookup { offsets, cells: filed })
    }

    /// The number of the cell with these vertices.
    pub fn find(&self, vertices: [u32; N]) -> Option<u32> {
        let vertices = ascending(vertices);
        let [start, end] = [0, 1].map(|i| self.offsets[vertices[0] as usize + i] as usize);
        let bucket = &self.cells[start..end];
        bucket.binary_search_by(|(cell, _)| cell.cmp(&vertices)).ok().map(|i| bucket[i].1)
    }

    /// Each cell once, its vertices ascending, in lexicographic order.
    pub fn distinct(num_vertices: usize, cells: impl Iterator<Item = [u32; N]> + Clone) -> Vec<[u32; N]> {
        let (offsets, mut filed) = bucket(num_vertices, cells.map(|cell| (ascending(cell), ())));
        let mut distinct = Vec::new();
        for pair in offsets.windows(2) {
            let bucket = &mut filed[pair[0] as usize..pair[1] as usize];
            bucket.sort_unstable();
            let start = distinct.len();
            for &(cell, ()) in &*bucket {
                if distinct.len() == start || distinct.last() != Some(&cell) {
                    distinct.push(cell);
                }
            }
        }
        distinct
    }
}

/// Sorts by first vertex: bucket `v` is `filed[offsets[v]..offsets[v + 1]]`.
fn bucket<const N: usize, T: Copy>(
    num_vertices: usize,
    cells: impl Iterator<Item = ([u32; N], T)> + Clone,
) -> (Vec<u32>, Vec<([u32; N], T)>) {
    let mut offsets = vec![0u32; num_vertices + 1];
    for (cell, _) in cells.clone() {
        offsets[cell[0] as usize + 1] += 1;
    }
    for v in 0..num_vertices {
        offsets[v + 1] += offsets[v];
    }
    let mut next = offsets.clone();
    let mut filed: Vec<_> = match cells.clone().next() {
        Some(any) => vec![any; offsets[num_vertices] as usize],
        None => Vec::new(),
    };
    for cell in cells {
        let slot = &mut next[cell.0[0] as usize];
        filed[*slot as usize] = cell;
        *slot += 1;
    }
    (offsets, filed)
}

fn ascending<const N: usize>(mut vertices: [u32; N]) -> [u32; N] {
    vertices.sort_unstable();
    vertices
}
