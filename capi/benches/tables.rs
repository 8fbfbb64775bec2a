//! What a C++ program that owns a refiner waits for tables of forms, beside OpenSubdiv's own of S0, and what they hold.
//!
//! `cargo bench -p formwork-capi` prints medians of one run, one thread: `Far::StencilTable` on either side, in single and
//! in double precision. "refine" and "S0" are OpenSubdiv's; "read" is a `FormRefiner` of the refined mesh, and "S1, S2"
//! their tables of each level.

#[path = "../../benches/common/mod.rs"]
mod benches;
#[path = "../tests/common/mod.rs"]
mod common;

use std::fmt::{Display, Write};
use std::fs;
use std::path::Path;

use benches::surfaces;
use common::{compile, expect, installed, run_with};
use formwork::scheme::Scheme;
use formwork::topology::Descriptor;

fn main() {
    let (folder, prefix) = installed();
    let build = |name: &str, flags: &[&str]| {
        let flags = [&["-O2", "-DNDEBUG"], flags].concat();
        let program = compile(folder.path(), &prefix, "benches/cpp/tables", &flags, &[]);
        let named = folder.path().join(name);
        fs::rename(program, &named).unwrap();
        named
    };
    let precisions = [("float", build("float", &[])), ("double", build("double", &["-DDOUBLE"]))];
    let meshes = surfaces::all(10_000).map(|(name, cage, scheme)| {
        let file = folder.path().join(name);
        fs::write(&file, write(cage.descriptor(), scheme)).unwrap();
        (name, file)
    });
    let measure = |program: &Path, mesh: &Path, levels: usize, what: &str| -> Vec<f64> {
        let levels = levels.to_string();
        let arguments = [mesh, Path::new(&levels), Path::new(what)];
        let output = run_with(program, &prefix, &arguments, &[("RAYON_NUM_THREADS", "1")]);
        expect(&output, "tables").split_whitespace().map(|number| number.parse().unwrap()).collect()
    };
    println!("Tables of each level, one thread, medians; milliseconds, and as ratios to OpenSubdiv's sum");
    println!("{:<27} {:>6} | {:>8} {:>8} | {:>8} {:>8} |", "", "levels", "refine", "S0", "read", "S1, S2");
    for (precision, program) in &precisions {
        for (name, mesh) in &meshes {
            for levels in [3, 4] {
                let [refine, s0, read, forms] = measure(program, mesh, levels, "time")[..] else {
                    panic!("four times")
                };
                println!(
                    "{name:<20} {precision:<6} {levels:>6} | {refine:>8.0} {s0:>8.0} | {read:>8.0} {forms:>8.0} | {:.2}x",
                    (read + forms) / (refine + s0)
                );
            }
        }
    }
    println!("\nPeak memory of a process, bytes per finest face (4 levels, 2.56 M faces)");
    for (precision, program) in &precisions {
        for (name, mesh) in &meshes {
            let peak = |what: &str| measure(program, mesh, 4, what)[0];
            let empty = peak("none");
            let [refiner, s0, forms] = ["refiner", "s0", "forms"].map(|what| (peak(what) - empty) / 2.56e6);
            println!(
                "{name:<20} {precision:<6} | refiner {refiner:>5.0}, with S0 {s0:>5.0} | with S1 and S2 instead {forms:>5.0}"
            );
        }
    }
}

/// The mesh as the program reads it.
fn write(d: &Descriptor, scheme: Scheme) -> String {
    let mut text = String::new();
    let scheme = if matches!(scheme, Scheme::Loop(..)) { 2 } else { 1 };
    write!(text, "{} {scheme}", d.num_vertices).unwrap();
    array(&mut text, &d.face_sizes);
    array(&mut text, &d.face_vertices);
    array(&mut text, &d.creases.iter().flat_map(|crease| crease.vertices).collect::<Vec<_>>());
    array(&mut text, &d.creases.iter().map(|crease| crease.sharpness).collect::<Vec<_>>());
    text
}

fn array<T: Display>(text: &mut String, values: &[T]) {
    write!(text, "\n{}", values.len()).unwrap();
    values.iter().for_each(|value| write!(text, " {value}").unwrap());
}
