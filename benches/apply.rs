//! Applying S1: without storing it, as a matrix, composed, and by OpenSubdiv's evaluator.
//!
//! `cargo bench --bench apply` prints ratios of one run, medians. Bandwidth counts each input value read once and
//! each output value written once, and nothing else, and is held against the triad `a = b + s c` of the same run.

mod common;

use std::hint::black_box;

use common::{paired, surfaces};
use formwork::cochain::{Cochain, Quantity};
use formwork::hierarchy::{Hierarchy, Workspace};
use formwork::memory::filled;
use formwork::nalgebra::SVector;
use formwork::osd::FloatStencilTable;
use formwork::sparse::{Csr, dot, row_of};
use rayon::prelude::*;

fn main() {
    println!("{} threads; medians", rayon::current_num_threads());
    println!("\nOne level of S1, the last of four from 10k faces: million child edges a second");
    for (name, cage, scheme) in surfaces::all(10_000) {
        one_level(name, &Hierarchy::new(&cage, scheme, 4).unwrap());
    }
    println!("\nThe same level of regular quads by type of value");
    let (_, cage, scheme) = surfaces::all(10_000).into_iter().next().unwrap();
    let hierarchy = Hierarchy::new(&cage, scheme, 4).unwrap();
    width::<f64>("f64", &hierarchy);
    width::<f32>("f32", &hierarchy);
    width::<SVector<f64, 3>>("3 f64", &hierarchy);
    width::<SVector<f32, 3>>("3 f32", &hierarchy);
    width::<SVector<f64, 8>>("8 f64", &hierarchy);
    width::<SVector<f32, 8>>("8 f32", &hierarchy);
    println!("\nFour levels from 10k faces, milliseconds");
    for (name, cage, scheme) in surfaces::all(10_000) {
        cascade(name, &Hierarchy::new(&cage, scheme, 4).unwrap());
    }
    println!("\nOne level from small to large, nanoseconds per child edge");
    for base in [160, 2_500, 10_000, 40_000] {
        for (name, cage, scheme) in surfaces::all(base) {
            let hierarchy = Hierarchy::new(&cage, scheme, 4).unwrap();
            let (time, edges) = kernel::<f64>(&hierarchy);
            println!("  {name:<20} {edges:>9} child edges {:>6.2}", time * 1e6 / edges as f64);
        }
    }
}

/// Values on the last level but one.
fn values<T: Quantity>(hierarchy: &Hierarchy) -> Cochain<1, T> {
    let edges = hierarchy.level(hierarchy.num_levels() - 1).mesh().num_edges();
    let mut value = Cochain::new(filled(T::zero(), edges));
    // Not all alike, and not zero, of any type.
    let form = surfaces::form::<f64>(hierarchy);
    let form = (1..hierarchy.num_levels()).fold(form, |form, l| hierarchy.refine(l, &form));
    for e in 0..edges {
        value[e] = T::one().scale(form[e]);
    }
    value
}

/// The time of the last level by the kernel, in milliseconds, and its child edges.
fn kernel<T: Quantity>(hierarchy: &Hierarchy) -> (f64, usize) {
    let level = hierarchy.num_levels();
    let (c, mut out, mut workspace) = (values::<T>(hierarchy), Cochain::new(Vec::new()), Workspace::new());
    hierarchy.refine_into(level, &c, &mut out, &mut workspace);
    let [time] = paired([&mut || hierarchy.refine_into(level, &c, black_box(&mut out), &mut workspace)]);
    (time, out.len())
}

fn one_level(name: &str, hierarchy: &Hierarchy) {
    let level = hierarchy.num_levels();
    let parent = hierarchy.level(level - 1).mesh();
    let s1 = hierarchy.refinement(level).s1(parent);
    let table = FloatStencilTable::of(&s1).unwrap();
    let c = values::<f64>(hierarchy);
    let single: Vec<f32> = c.values().iter().map(|&x| x as f32).collect();
    let (mut out, mut workspace) = (Cochain::new(Vec::new()), Workspace::new());
    let mut product = vec![0.0; s1.rows()];
    let mut osd = vec![0.0f32; s1.rows()];
    let triad_length = 20_000_000;
    let (mut a, b, d) = (filled(0.0, triad_length), filled(1.0, triad_length), filled(2.0, triad_length));
    let [triad, kernel, csr, evaluator] = paired([
        &mut || {
            a.par_iter_mut()
                .zip(&b)
                .zip(&d)
                .with_min_len(4096)
                .for_each(|((a, b), c): ((&mut f64, _), _)| *a = b + 3.0 * c);
            black_box(&mut a);
        },
        &mut || hierarchy.refine_into(level, &c, black_box(&mut out), &mut workspace),
        &mut || apply_into(&s1, c.values(), black_box(&mut product)),
        &mut || table.evaluate(&single, 1, black_box(&mut osd)).unwrap(),
    ]);
    let rate = |ms: f64| s1.rows() as f64 / ms / 1e3;
    let gb = |bytes: usize, ms: f64| bytes as f64 / ms / 1e6;
    let (moved, roof) = (gb(8 * (s1.cols() + s1.rows()), kernel), gb(24 * triad_length, triad));
    println!(
        "  {name:<20} {:>9} child edges: kernel {:>5.0} ({moved:.1} of {roof:.1} GB/s, {:.0} %), matrix {:>5.0}, CpuEvaluator (f32, one thread) {:>5.0}: {:.1}x",
        s1.rows(),
        rate(kernel),
        100.0 * moved / roof,
        rate(csr),
        rate(evaluator),
        evaluator / kernel
    );
}

/// The matrix applied into memory that is there.
fn apply_into(matrix: &Csr, x: &[f64], out: &mut [f64]) {
    let rows = out.par_iter_mut().enumerate().with_min_len(1024);
    rows.for_each(|(row, out)| *out = dot(row_of(matrix, row), x).unwrap_or(0.0));
}

fn width<T: Quantity>(name: &str, hierarchy: &Hierarchy) {
    let (time, edges) = kernel::<T>(hierarchy);
    let bytes = size_of::<T>() as f64 * 1.25 * edges as f64;
    println!(
        "  {name:<6} {:>6.0} million child edges a second, {:>5.1} GB/s",
        edges as f64 / time / 1e3,
        bytes / time / 1e6
    );
}

fn cascade(name: &str, hierarchy: &Hierarchy) {
    let c = surfaces::form::<f64>(hierarchy);
    let mut levels = vec![Cochain::new(Vec::new()); 5];
    levels[0] = c.clone();
    let mut workspace = Workspace::new();
    let mut by_kernel = || {
        for level in 1..=4 {
            let (from, to) = levels.split_at_mut(level);
            hierarchy.refine_into(level, &from[level - 1], black_box(&mut to[0]), &mut workspace);
        }
    };
    by_kernel();
    let matrices: Vec<Csr> =
        (1..=4).map(|l| hierarchy.refinement(l).s1(hierarchy.level(l - 1).mesh())).collect();
    let mut products: Vec<Vec<f64>> = matrices.iter().map(|s1| vec![0.0; s1.rows()]).collect();
    let mut by_matrices = || {
        let mut from = c.values();
        for (s1, to) in matrices.iter().zip(&mut products) {
            apply_into(s1, from, to);
            from = to;
        }
        black_box(from);
    };
    let mut workspace_of_one = Workspace::new();
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let mut alone = vec![Cochain::new(Vec::new()); 5];
    alone[0] = c.clone();
    let mut by_one_thread = || {
        for level in 1..=4 {
            let (from, to) = alone.split_at_mut(level);
            one.install(|| {
                hierarchy.refine_into(level, &from[level - 1], black_box(&mut to[0]), &mut workspace_of_one)
            });
        }
    };
    by_one_thread();
    let composed = hierarchy.composed_operators(4).s1;
    let mut straight = vec![0.0; composed.rows()];
    let [kernel, one_thread, csr, composed] =
        paired([&mut by_kernel, &mut by_one_thread, &mut by_matrices, &mut || {
            apply_into(&composed, c.values(), black_box(&mut straight))
        }]);
    println!(
        "  {name:<20} kernel {kernel:>6.1} (one thread {one_thread:>6.1}), matrices level by level {csr:>6.1}, composed matrix {composed:>6.1}"
    );
}
