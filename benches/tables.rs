//! Building the tables of forms beside OpenSubdiv's own of S0, and what both hold in memory.
//!
//! `cargo bench --bench tables` prints ratios of one run, medians, one thread; `-- 10m` adds 10 million faces, `-- composed`
//! leaves out all but the composed tables. The column "of it" is the part of the hierarchy that is OpenSubdiv's refining, which
//! the ratio "S1+S2" leaves out; "storing" fills memory of the size of the matrices with ones, and does nothing else.

mod common;

use std::hint::black_box;
use std::process::Command;

use common::{paired, surfaces};
use formwork::hierarchy::Hierarchy;
use formwork::memory::filled;
use formwork::osd::Refiner;
use formwork::scheme::Scheme;
use formwork::sparse::Csr;
use formwork::topology::Cage;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let Some(at) = arguments.iter().position(|a| a == "memory") {
        return hold(&arguments[at + 1], &arguments[at + 2], arguments[at + 3].parse().unwrap());
    }
    let large = arguments.iter().any(|a| a == "10m");
    if arguments.iter().any(|a| a == "composed") {
        return all_composed();
    }
    // Comparisons with OpenSubdiv, which has one thread.
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    one.install(|| {
        println!(
            "Per-level tables, one thread, f64, medians; milliseconds, and as ratios to OpenSubdiv's sum"
        );
        println!(
            "{:<20} {:>9} | {:>8} {:>8} | {:>9} {:>8} {:>8} {:>8} | {:>9} {:>9}",
            "mesh", "faces", "refine", "S0", "hierarchy", "of it", "S1, S2", "storing", "S1+S2", "in all"
        );
        for (name, cage, scheme) in surfaces::all(10_000) {
            for levels in [3, 4] {
                per_level(name, &cage, scheme, levels);
            }
        }
    });
    all_composed();
    println!("\nTime per finest face from small to large, one thread, nanoseconds; S1 and S2 of each level");
    one.install(|| {
        for (name, levels) in [("regular quads", 3), ("irregular triangles", 3)] {
            for base in [160, 2_500, 40_000].into_iter().chain(large.then_some(160_000)) {
                per_face(name, base, levels);
            }
        }
    });
    println!("\nPeak memory of a process of its own, bytes per finest face (2.56 M faces)");
    for (name, ..) in surfaces::all(16) {
        let peak = |what: &str| peak(name, what, 4);
        let empty = peak("cage");
        println!(
            "  {name:<20} OpenSubdiv: refiner {:>5.0}, with S0 {:>5.0} · hierarchy {:>5.0}, with a 1-form refined {:>5.0}, with S1 and S2 {:>5.0}",
            peak("refiner") - empty,
            peak("s0") - empty,
            peak("hierarchy") - empty,
            peak("apply") - empty,
            peak("s1s2") - empty,
        );
    }
}

fn refine(cage: &Cage, scheme: Scheme, levels: usize) -> Refiner {
    let split = scheme.split(&cage.descriptor().face_sizes).unwrap();
    let mut refiner = Refiner::new(cage, scheme.opensubdiv(split)).unwrap();
    refiner.refine_uniform(levels).unwrap();
    refiner
}

/// `S1` and `S2` of each level: their rows and entries.
fn matrices(hierarchy: &Hierarchy) -> [usize; 2] {
    let levels = 1..=hierarchy.num_levels();
    let tables: Vec<_> = levels
        .map(|l| {
            let (refinement, parent) = (hierarchy.refinement(l), hierarchy.level(l - 1).mesh());
            (refinement.s1(parent), refinement.s2(parent))
        })
        .collect();
    let (rows, entries) = (|s: &Csr| s.rows(), |s: &Csr| s.nnz());
    let sum = |of: &dyn Fn(&Csr) -> usize| tables.iter().map(|(s1, s2)| of(s1) + of(s2)).sum();
    [sum(&rows), sum(&entries)]
}

/// What no way of building tables of this size can save: memory, filled.
fn store([rows, entries]: [usize; 2]) {
    black_box((filled(1usize, rows), filled(1u32, entries), filled(1f64, entries)));
}

fn per_level(name: &str, cage: &Cage, scheme: Scheme, levels: usize) {
    let refiner = refine(cage, scheme, levels);
    let hierarchy = Hierarchy::new(cage, scheme, levels).unwrap();
    let size = matrices(&hierarchy);
    let [osd_refine, lean, osd_tables, built, tables, storing] = paired([
        &mut || drop(black_box(refine(cage, scheme, levels))),
        &mut || {
            let split = scheme.split(&cage.descriptor().face_sizes).unwrap();
            let mut refiner = Refiner::new(cage, scheme.opensubdiv(split)).unwrap();
            refiner.refine_uniform_without_last_edges(levels).unwrap();
            black_box(refiner);
        },
        &mut || {
            black_box(refiner.build_per_level_tables().unwrap());
        },
        &mut || drop(black_box(Hierarchy::new(cage, scheme, levels).unwrap())),
        &mut || {
            black_box(matrices(&hierarchy));
        },
        &mut || store(size),
    ]);
    let osd = osd_refine + osd_tables;
    let faces = hierarchy.refinement(levels).split().num_children(2);
    println!(
        "{name:<20} {faces:>9} | {osd_refine:>8.0} {osd_tables:>8.0} | {built:>9.0} {lean:>8.0} {tables:>8.0} {storing:>8.0} | {:>8.2}x {:>8.2}x",
        (built - lean + tables) / osd,
        (built + tables) / osd
    );
}

fn all_composed() {
    println!("\nComposed tables S0, S1, S2 of level 4, all threads; seconds");
    for (name, cage, scheme) in surfaces::all(10_000) {
        composed(name, &cage, scheme);
    }
}

fn composed(name: &str, cage: &Cage, scheme: Scheme) {
    let build = || Hierarchy::new(cage, scheme, 4).unwrap().composed_operators(4);
    let operators = build();
    let nnz = [&operators.s0, &operators.s1, &operators.s2].map(|s| s.nnz() as f64 / 1e6);
    drop(operators);
    let [time] = paired([&mut || drop(black_box(build()))]);
    println!(
        "  {name:<20} {:>6.2} s, refining included; entries {:.1} + {:.1} + {:.1} million; peak {:.2} GB",
        time / 1e3,
        nnz[0],
        nnz[1],
        nnz[2],
        peak(name, "composed", 4) * 2.56e6 / 1e9
    );
}

fn per_face(name: &str, base: usize, levels: usize) {
    let (_, cage, scheme) = surfaces::all(base).into_iter().find(|surface| surface.0 == name).unwrap();
    let hierarchy = Hierarchy::new(&cage, scheme, levels).unwrap();
    let size = matrices(&hierarchy);
    let [built, tables, storing] = paired([
        &mut || drop(black_box(Hierarchy::new(&cage, scheme, levels).unwrap())),
        &mut || {
            black_box(matrices(&hierarchy));
        },
        &mut || store(size),
    ]);
    let faces = hierarchy.refinement(levels).split().num_children(2);
    let per_face = |ms: f64| ms * 1e6 / faces as f64;
    println!(
        "  {name:<20} {faces:>9} faces: hierarchy {:>5.0}, S1 and S2 {:>5.0}, storing as much {:>5.0}",
        per_face(built),
        per_face(tables),
        per_face(storing)
    );
}

/// Builds one thing and prints the peak of this process.
fn hold(name: &str, what: &str, levels: usize) {
    let (_, cage, scheme) = surfaces::all(10_000).into_iter().find(|surface| surface.0 == name).unwrap();
    match what {
        "cage" => {}
        "refiner" => drop(black_box(refine(&cage, scheme, levels))),
        "s0" => {
            black_box(refine(&cage, scheme, levels).build_per_level_tables().unwrap());
        }
        "hierarchy" => drop(black_box(Hierarchy::new(&cage, scheme, levels).unwrap())),
        "apply" => {
            let hierarchy = Hierarchy::new(&cage, scheme, levels).unwrap();
            drop(black_box(hierarchy.subdivide(&surfaces::form::<f64>(&hierarchy))));
        }
        "s1s2" => {
            black_box(matrices(&Hierarchy::new(&cage, scheme, levels).unwrap()));
        }
        "composed" => {
            drop(black_box(Hierarchy::new(&cage, scheme, levels).unwrap().composed_operators(levels)))
        }
        _ => unreachable!("nothing else is asked for"),
    }
    println!("{}", common::peak_memory().unwrap_or(0));
}

/// The peak, in bytes per face of 2.56 million, of a process that builds one thing.
fn peak(name: &str, what: &str, levels: usize) -> f64 {
    let me = std::env::current_exe().unwrap();
    let output = Command::new(me).args(["memory", name, what, &levels.to_string()]).output().unwrap();
    String::from_utf8(output.stdout).unwrap().trim().parse::<f64>().unwrap() / 2.56e6
}
