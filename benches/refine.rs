//! Building and applying the operators of forms, beside OpenSubdiv's own tables and evaluator.
//!
//! `cargo bench` prints criterion's figures for one step, then three tables: the cascade of three levels
//! as ratios to OpenSubdiv in the same run, the time per face at three sizes, and the peak memory.

mod common;

use std::hint::black_box;

use common::surfaces::irregular;
use common::{RUNS, meshes, paired, peak_memory};
use criterion::Criterion;
use formwork::cochain::Cochain;
use formwork::hierarchy::Hierarchy;
use formwork::osd::{OsdScheme, Refiner};
use formwork::scheme::Scheme;
use formwork::topology::Cage;

fn main() {
    let mut criterion = Criterion::default().sample_size(10).configure_from_args();
    one_step(&mut criterion);
    criterion.final_summary();

    println!(
        "\nThree levels, 10k -> 640k faces; medians of {RUNS}, in milliseconds, and as ratios to OpenSubdiv"
    );
    for (name, cage) in [("regular", regular(100)), ("irregular", irregular(90))] {
        cascade(name, &cage);
    }
    println!("\nTime per finest face at three sizes, three levels, irregular; nanoseconds");
    println!("{:>12} {:>10} {:>16} {:>12}", "faces", "hierarchy", "S0, S1, S2", "apply S1");
    for side in [28, 90, 180] {
        per_face(&irregular(side));
    }
    if let Some(peak) = peak_memory() {
        println!("\npeak memory of this process: {} MiB", peak >> 20);
    }
}

fn regular(side: u32) -> Cage {
    Cage::new(meshes::grid(side, side, false)).unwrap()
}

fn one_step(criterion: &mut Criterion) {
    let cage = irregular(90);
    let hierarchy = Hierarchy::new(&cage, Scheme::default(), 2).unwrap();
    let form = hierarchy.refine(1, &random_form(&hierarchy));
    let mut group = criterion.benchmark_group("one step, 40k -> 160k faces");
    group.bench_function("S0, S1, S2 as matrices", |b| b.iter(|| hierarchy.operators(2)));
    let s1 = hierarchy.operators(2).s1;
    group.bench_function("apply S1 by form (A)", |b| b.iter(|| hierarchy.refine(2, &form)));
    group.bench_function("apply S1 as a matrix", |b| b.iter(|| formwork::sparse::apply(&s1, form.values())));
    group.finish();
}

fn random_form(hierarchy: &Hierarchy) -> Cochain<1> {
    Cochain::new((0..hierarchy.level(0).mesh().num_edges()).map(|e| (e as f64 * 0.37).sin()).collect())
}

fn cascade(name: &str, cage: &Cage) {
    let refine = || {
        let mut refiner = Refiner::new(cage, OsdScheme::Catmark).unwrap();
        refiner.refine_uniform(3).unwrap();
        refiner
    };
    let build = || Hierarchy::new(cage, Scheme::default(), 3).unwrap();
    let (refiner, hierarchy) = (refine(), build());
    let table = refiner.float_stencil_table().unwrap();
    let values = vec![1.0f32; cage.descriptor().num_vertices];
    let mut out = vec![0.0f32; table.num_stencils()];
    let x = Cochain::<0>::new(vec![1.0; values.len()]);
    let c = random_form(&hierarchy);
    let density = Cochain::<2>::new(vec![1.0; hierarchy.level(0).mesh().num_faces()]);

    let [osd_refine, osd_table, osd_apply, built, matrices, s0, s1, s2] = paired([
        &mut || drop(black_box(refine())),
        &mut || drop(black_box(refiner.float_stencil_table().unwrap())),
        &mut || table.evaluate(&values, 1, black_box(&mut out)).unwrap(),
        &mut || drop(black_box(build())),
        &mut || drop(black_box((1..=3).map(|level| hierarchy.operators(level)).collect::<Vec<_>>())),
        &mut || drop(black_box(hierarchy.subdivide(&x))),
        &mut || drop(black_box(hierarchy.subdivide(&c))),
        &mut || drop(black_box(hierarchy.subdivide(&density))),
    ]);
    let osd_build = osd_refine + osd_table;
    println!(
        "{name}: {} -> {} faces",
        hierarchy.level(0).mesh().num_faces(),
        hierarchy.finest().mesh().num_faces()
    );
    let line = |what: &str, time: f64, than: f64| println!("  {what:<54} {time:>8.1} {:>7.2}x", time / than);
    line("OpenSubdiv: refine", osd_refine, osd_build);
    line("OpenSubdiv: refine + StencilTableFactory (S0)", osd_build, osd_build);
    line("formwork: hierarchy (OpenSubdiv's refine included)", built, osd_build);
    line("formwork: hierarchy + S0, S1, S2 of each level", built + matrices, osd_build);
    line("OpenSubdiv: CpuEvaluator, S0, one f32 a vertex", osd_apply, osd_apply);
    line("formwork: 0-form, f64, level by level", s0, osd_apply);
    line("formwork: 1-form, f64, level by level", s1, osd_apply);
    line("formwork: 2-form, f64, level by level", s2, osd_apply);
}

fn per_face(cage: &Cage) {
    let hierarchy = Hierarchy::new(cage, Scheme::default(), 3).unwrap();
    let c = random_form(&hierarchy);
    let times = paired([
        &mut || drop(black_box(Hierarchy::new(cage, Scheme::default(), 3).unwrap())),
        &mut || drop(black_box((1..=3).map(|level| hierarchy.operators(level)).collect::<Vec<_>>())),
        &mut || drop(black_box(hierarchy.subdivide(&c))),
    ]);
    let faces = hierarchy.finest().mesh().num_faces();
    let [hierarchy, matrices, apply] = times.map(|ms| ms * 1e6 / faces as f64);
    println!("{faces:>12} {hierarchy:>10.0} {matrices:>16.0} {apply:>12.1}");
}
