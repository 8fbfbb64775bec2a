//! What a C++ program that owns a refiner waits for tables of forms, beside OpenSubdiv's own of S0, and what they hold.
//!
//! `cargo bench -p formwork-capi` prints medians, one thread: `Far::StencilTable` on either side, in single and in double
//! precision. "refine" and "S0" are a program without Formwork; "read" is a `FormRefiner` of the refined mesh and "S1, S2"
//! the tables of each level, in a program that refines as well. Both are run three times, in turn: the first mesh of a
//! program, for which memory is fresh, and the same mesh again, for which it is there.

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
    let columns = format!("{:>7} {:>6} {:>6} {:>7}", "refine", "S0", "read", "S1, S2");
    println!("{:<27} {:>6} | first: {columns}         | again: {columns}", "", "levels");
    for (precision, program) in &precisions {
        for (name, mesh) in &meshes {
            for levels in [3, 4] {
                let mut runs = [const { Vec::new() }; 8];
                for _ in 0..3 {
                    let time = |what: &str| measure(program, mesh, levels, what);
                    let (s0, forms) = (time("time-s0"), time("time-forms"));
                    let [first, again] = [0, 1].map(|i| [s0[i], s0[2 + i], forms[2 + i], forms[4 + i]]);
                    runs.iter_mut().zip([first, again].concat()).for_each(|(runs, time)| runs.push(time));
                }
                let times = runs.map(|mut times: Vec<f64>| {
                    times.sort_by(f64::total_cmp);
                    times[1]
                });
                print!("{name:<20} {precision:<6} {levels:>6}");
                for times in times.chunks(4) {
                    let [refine, s0, read, forms] = times[..] else { unreachable!("four columns") };
                    let ratio = (read + forms) / (refine + s0);
                    print!(" |        {refine:>7.0} {s0:>6.0} {read:>6.0} {forms:>7.0}  {ratio:.2}x");
                }
                println!();
            }
        }
    }
    println!("\nPeak memory of a process, bytes per finest face (4 levels, 2.56 M faces)");
    for (precision, program) in &precisions {
        for (name, mesh) in &meshes {
            let peak = |what: &str| measure(program, mesh, 4, what)[0];
            let empty = peak("memory-none");
            let of = ["memory-refiner", "memory-s0", "memory-forms"];
            let [refiner, s0, forms] = of.map(|what| (peak(what) - empty) / 2.56e6);
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
