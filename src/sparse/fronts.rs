use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use rayon::prelude::*;

/// The fronts of a factor: runs of columns with the same rows below them, in a tree, so that branches can be solved side by
/// side. Whatever the number of threads, the sums are the same to the bit.
pub struct Fronts {
    list: Vec<Front>,
    /// For each front, for each row below its columns, its place in the parent: in its columns, then in its rows below.
    places: Vec<u32>,
    roots: Vec<u32>,
}

struct Front {
    /// The first column of its branch, its own first, and the one after its last.
    first: usize,
    begin: usize,
    end: usize,
    /// Where its rows start in `places`, and how many there are.
    rows: usize,
    num_rows: usize,
    /// Where its entries start: column by column, the square at the top first.
    values: usize,
    children: Vec<u32>,
    /// The entries of its branch.
    weight: usize,
}

/// Where the diagonal is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diagonal {
    /// Half of it on either side, `L L'`.
    Shared,
    /// In the middle, `L D L'`: that of `L` is 1, and `D` is stored in its place.
    Apart,
}

/// Branches with fewer entries than this are not worth another thread.
const SMALL: usize = 200_000;

impl Fronts {
    /// The tree of a factor's pattern; `None` if its branches are no runs of columns.
    pub fn new(pattern: &SymbolicSupernodalCholesky<usize>) -> Option<Self> {
        let n = pattern.n_supernodes();
        let (begin, end) = (pattern.supernode_begin(), pattern.supernode_end());
        let rows_of =
            |s: usize| &pattern.row_idx()[pattern.col_ptr_for_row_idx()[s]..][..pattern.nnz_per_super()[s]];
        let mut fronts = Fronts { list: Vec::with_capacity(n), places: Vec::new(), roots: Vec::new() };
        for s in 0..n {
            fronts.list.push(Front {
                first: begin[s],
                begin: begin[s],
                end: end[s],
                rows: 0,
                num_rows: rows_of(s).len(),
                values: pattern.col_ptr_for_val()[s],
                children: Vec::new(),
                weight: (end[s] - begin[s]) * (end[s] - begin[s] + rows_of(s).len()),
            });
        }
        let mut place = vec![u32::MAX; pattern.nrows()];
        for s in 0..n {
            fronts.list[s].rows = fronts.places.len();
            // Children come before parents; branches are runs of columns that lie side by side.
            let mut next = begin[s];
            for &child in fronts.list[s].children.iter().rev() {
                let child = &fronts.list[child as usize];
                if child.end != next {
                    return None;
                }
                next = child.first;
            }
            fronts.list[s].first = next;
            let Some(&lowest) = rows_of(s).iter().min() else {
                fronts.roots.push(s as u32);
                continue;
            };
            let parent = begin[..n].partition_point(|&b| b <= lowest) - 1;
            if parent <= s {
                return None;
            }
            let weight = fronts.list[s].weight;
            fronts.list[parent].children.push(s as u32);
            fronts.list[parent].weight += weight;
            let columns = end[parent] - begin[parent];
            let rows = rows_of(parent);
            rows.iter().enumerate().for_each(|(i, &row)| place[row] = (columns + i) as u32);
            for &row in rows_of(s) {
                let at = match (begin[parent]..end[parent]).contains(&row) {
                    true => (row - begin[parent]) as u32,
                    false => place[row],
                };
                fronts.places.push(at);
            }
            rows.iter().for_each(|&row| place[row] = u32::MAX);
            if fronts.places[fronts.list[s].rows..].contains(&u32::MAX) {
                return None;
            }
        }
        let covered: usize =
            fronts.roots.iter().map(|&s| &fronts.list[s as usize]).map(|f| f.end - f.first).sum();
        (covered == pattern.nrows()).then_some(fronts)
    }

    /// `L L' x = b` or `L D L' x = b` in place.
    pub fn solve(&self, values: &[f64], diagonal: Diagonal, x: &mut [f64]) {
        let branches = self.branches(&self.roots, 0, x);
        branches.into_par_iter().for_each(|(s, own)| {
            self.forward(values, diagonal, s, own);
            self.backward(values, diagonal, s, own, &[]);
        });
    }

    /// The columns of branches that lie side by side from column `from` on.
    fn branches<'a>(&self, list: &[u32], from: usize, mut x: &'a mut [f64]) -> Vec<(u32, &'a mut [f64])> {
        let mut at = from;
        let mut branches = Vec::with_capacity(list.len());
        for &s in list {
            let end = self.list[s as usize].end;
            let (own, rest) = x.split_at_mut(end - at);
            branches.push((s, own));
            (x, at) = (rest, end);
        }
        branches
    }

    /// Solves with `L` on a branch; what that takes off the rows below it, nothing if all is 0.
    fn forward(&self, values: &[f64], diagonal: Diagonal, s: u32, own: &mut [f64]) -> Vec<f64> {
        let front = &self.list[s as usize];
        let (below, mine) = own.split_at_mut(front.begin - front.first);
        let branches = self.branches(&front.children, front.first, below);
        let updates = self.map(front, branches, |(child, own)| self.forward(values, diagonal, child, own));
        let columns = mine.len();
        let mut update = Vec::new();
        for (&child, from_child) in front.children.iter().zip(&updates) {
            let child = &self.list[child as usize];
            for (&place, x) in self.places[child.rows..].iter().zip(from_child) {
                match (place as usize).checked_sub(columns) {
                    None => mine[place as usize] += x,
                    Some(row) => {
                        if update.is_empty() {
                            update.resize(front.num_rows, 0.0);
                        }
                        update[row] += x;
                    }
                }
            }
        }
        let height = columns + front.num_rows;
        for j in 0..columns {
            if mine[j] == 0.0 {
                continue;
            }
            let column = &values[front.values + j * height..][..height];
            if diagonal == Diagonal::Shared {
                mine[j] /= column[j];
            }
            let x = mine[j];
            mine[j + 1..].iter_mut().zip(&column[j + 1..columns]).for_each(|(y, l)| *y -= l * x);
            if update.is_empty() {
                update.resize(front.num_rows, 0.0);
            }
            update.iter_mut().zip(&column[columns..]).for_each(|(y, l)| *y -= l * x);
        }
        update
    }

    /// Solves with `L'` on a branch, from the values at the rows below it.
    fn backward(&self, values: &[f64], diagonal: Diagonal, s: u32, own: &mut [f64], above: &[f64]) {
        let front = &self.list[s as usize];
        let (below, mine) = own.split_at_mut(front.begin - front.first);
        let columns = mine.len();
        let height = columns + front.num_rows;
        for j in (0..columns).rev() {
            let column = &values[front.values + j * height..][..height];
            let sum = inner(&column[j + 1..columns], &mine[j + 1..]) + inner(&column[columns..], above);
            mine[j] = match diagonal {
                Diagonal::Shared => (mine[j] - sum) / column[j],
                Diagonal::Apart => mine[j] / column[j] - sum,
            };
        }
        let mine = &*mine;
        let branches = self.branches(&front.children, front.first, below);
        self.map(front, branches, |(child, own)| {
            let rows = &self.list[child as usize];
            let places = &self.places[rows.rows..][..rows.num_rows];
            let at = |&place: &u32| match (place as usize).checked_sub(columns) {
                None => mine[place as usize],
                Some(row) => above[row],
            };
            self.backward(values, diagonal, child, own, &places.iter().map(at).collect::<Vec<_>>());
        });
    }

    /// Does the same for all children of a front, side by side if they are large.
    fn map<'a, R: Send>(
        &self,
        front: &Front,
        branches: Vec<(u32, &'a mut [f64])>,
        work: impl Fn((u32, &'a mut [f64])) -> R + Send + Sync,
    ) -> Vec<R> {
        match front.weight > SMALL && branches.len() > 1 {
            true => branches.into_par_iter().map(work).collect(),
            false => branches.into_iter().map(work).collect(),
        }
    }
}

/// In eight sums, which a processor adds side by side.
fn inner(a: &[f64], b: &[f64]) -> f64 {
    let (chunks, others) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = chunks.remainder().iter().zip(others.remainder()).map(|(x, y)| x * y).sum();
    let mut sums = [0.0; 8];
    for (x, y) in chunks.zip(others) {
        for k in 0..8 {
            sums[k] += x[k] * y[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}
