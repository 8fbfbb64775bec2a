//! What the benchmarks share.
#![allow(dead_code)] // each benchmark uses its own part

use std::time::{Duration, Instant};

#[path = "../../tests/common/meshes.rs"]
pub mod meshes;
pub mod surfaces;

/// The fewest rounds that count; short ones are repeated until they have taken this long together.
pub const RUNS: usize = 5;
const ENOUGH: Duration = Duration::from_millis(500);
const MOST_RUNS: usize = 101;

/// Times the tasks in turn, over and over, so that a drift of the machine meets all alike; medians in
/// milliseconds. The first round does not count: in it memory is touched and threads are started.
pub fn paired<const N: usize>(mut tasks: [&mut dyn FnMut(); N]) -> [f64; N] {
    let mut times = [const { Vec::new() }; N];
    let mut round = |times: &mut [Vec<Duration>; N]| {
        for (task, times) in tasks.iter_mut().zip(times) {
            let start = Instant::now();
            task();
            times.push(start.elapsed());
        }
    };
    round(&mut [const { Vec::new() }; N]);
    let start = Instant::now();
    while times[0].len() < RUNS || (start.elapsed() < ENOUGH && times[0].len() < MOST_RUNS) {
        round(&mut times);
    }
    times.map(|mut times: Vec<Duration>| {
        times.sort_unstable();
        times[times.len() / 2].as_secs_f64() * 1e3
    })
}

/// Numbers that look random, below a bound.
pub struct Random(u32);

impl Random {
    pub fn new() -> Self {
        Random(1)
    }

    pub fn below(&mut self, bound: u32) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) % bound
    }

    /// From 0 to 1.
    pub fn unit(&mut self) -> f64 {
        f64::from(self.below(1 << 24)) / f64::from(1 << 24)
    }
}

/// The most memory that this process has held.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().trim_end_matches("kB").trim().parse::<u64>().ok().map(|kib| kib << 10)
}
