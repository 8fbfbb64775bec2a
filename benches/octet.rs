//! What refining a solid costs: three levels of a mesh of tetrahedra, at three sizes, and smoothing.
//!
//! `cargo bench --bench octet` prints, for bars of cubes of six tetrahedra each, the time of building the levels and of
//! refining forms of every degree, per fine cell, and the peak memory of the process so far. The largest has 105 456
//! tetrahedra; `cargo bench --bench octet -- 10000` stops at that many.

use std::hint::black_box;
use std::time::Instant;

use formwork::cochain::Cochain;
use formwork::octet::{Boundary, Complex, Hierarchy, Scheme};

const LEVELS: usize = 3;

fn main() {
    let limit = std::env::args().filter_map(|word| word.parse().ok()).next().unwrap_or(usize::MAX);
    println!(
        "{:>8} {:>7} {:>12} {:>12} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9}",
        "tets",
        "scheme",
        "fine cells",
        "fine edges",
        "build s",
        "0-form s",
        "1-form s",
        "2-form s",
        "3-form s",
        "ns/cell",
        "peak MiB"
    );
    for size in [6, 12, 26] {
        let complex = grid(size);
        if complex.tets().len() <= limit {
            run(complex, Scheme::default(), "linear");
        }
    }
    for size in [4, 8] {
        let complex = grid(size);
        if complex.tets().len() <= limit {
            run(complex, Scheme { smoothing: Some(Boundary::Loop), ..Scheme::default() }, "smooth");
        }
    }
}

fn run(complex: Complex, scheme: Scheme, name: &str) {
    let tets = complex.tets().len();
    let start = Instant::now();
    let hierarchy = Hierarchy::new(complex, scheme, LEVELS).unwrap();
    let build = start.elapsed().as_secs_f64();
    let times =
        [degree::<0>(&hierarchy), degree::<1>(&hierarchy), degree::<2>(&hierarchy), degree::<3>(&hierarchy)];
    let fine = hierarchy.finest();
    let total = build + times.iter().sum::<f64>();
    println!(
        "{tets:>8} {name:>7} {:>12} {:>12} {build:>9.3} {:>9.3} {:>9.3} {:>9.3} {:>9.3} {:>10.0} {:>9}",
        fine.num_cells(3),
        fine.num_cells(1),
        times[0],
        times[1],
        times[2],
        times[3],
        total * 1e9 / fine.num_cells(3) as f64,
        peak_memory().map_or("?".to_owned(), |bytes| (bytes >> 20).to_string())
    );
}

fn degree<const K: usize>(hierarchy: &Hierarchy) -> f64 {
    let coarse = hierarchy.level(0).num_cells(K);
    let form = Cochain::<K>::new((0..coarse).map(|i| ((i * 7919) % 1013) as f64 / 1013.0).collect());
    let start = Instant::now();
    black_box(hierarchy.subdivide(&form));
    start.elapsed().as_secs_f64()
}

/// `size` x `size` x `size` cubes, each of six tetrahedra round its diagonal.
fn grid(size: u32) -> Complex {
    let n = size + 1;
    let mut tets = Vec::new();
    for [x, y, z] in (0..size).flat_map(|x| (0..size).flat_map(move |y| (0..size).map(move |z| [x, y, z]))) {
        for order in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]] {
            let mut at = [x, y, z];
            let mut path = [(x * n + y) * n + z; 4];
            for (k, axis) in order.into_iter().enumerate() {
                at[axis] += 1;
                path[k + 1] = (at[0] * n + at[1]) * n + at[2];
            }
            tets.push(path);
        }
    }
    Complex::new((n * n * n) as usize, tets, vec![]).unwrap()
}

/// The peak of this process's memory, where the system says so.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().trim_end_matches("kB").trim().parse::<u64>().ok()? << 10)
}
