use formwork::analysis::{self, Eigenvalue, Ring, Symmetry};
use serde_json::{Value, json};

use super::Outcome;
use crate::Failure;
use crate::args::{Spectrum, scheme_name};

pub fn run(args: &Spectrum) -> Result<Outcome, Failure> {
    let faces = usize::from(args.valence);
    let ring = Ring::new(args.vertex.scheme(), faces, args.vertex.boundary, 2)?;
    let spectrum = analysis::Spectrum::new(&ring)?;
    let [vertices, edges, ring_faces] = [0, 1, 2].map(|k| ring.num_cells(k));
    let name = scheme_name(ring.scheme());
    let place = if ring.is_boundary() { "boundary vertex" } else { "vertex" };
    let mut text = format!(
        "{name}, {place} of {faces} faces, two rings: {vertices} vertices, {edges} edges, {ring_faces} faces\n"
    );
    text += &format!("\nS0, {vertices} eigenvalues\n");
    for group in groups(spectrum.s0.iter().map(|e| (e, ""))) {
        text += &group;
    }
    let [exact, of_faces, rest] = spectrum.counts();
    text += &format!("\nS1, {edges} eigenvalues: {exact} exact, {of_faces} of faces, {rest} rest\n");
    let parts = spectrum.s1.iter().map(|e| (&e.eigenvalue, part(e.exact, e.faces, e.rest)));
    for group in groups(parts) {
        text += &group;
    }
    text += &format!("\nS2, {ring_faces} eigenvalues\n");
    for group in groups(spectrum.s2.iter().map(|e| (e, ""))) {
        text += &group;
    }
    text += &format!("\nS1 is S0 without 1, S2 and {rest} others, within {:.1e}\n", spectrum.mismatch);

    let json = json!({
        "command": "spectrum",
        "scheme": name,
        "valence": faces,
        "boundary": ring.is_boundary(),
        "rings": ring.rings(),
        "cells": [vertices, edges, ring_faces],
        "s0": spectrum.s0.iter().map(object).collect::<Vec<_>>(),
        "s1": spectrum.s1.iter().map(|e| {
            let mut value = object(&e.eigenvalue);
            (value["exact"], value["faces"], value["rest"]) = (json!(e.exact), json!(e.faces), json!(e.rest));
            value
        }).collect::<Vec<_>>(),
        "s2": spectrum.s2.iter().map(object).collect::<Vec<_>>(),
        "s1_counts": { "exact": exact, "faces": of_faces, "rest": rest },
        "s1_mismatch": spectrum.mismatch,
    });
    Ok(Outcome { text, json, notes: Vec::new(), holds: true })
}

/// What an eigenvalue of `S1` comes from.
fn part(exact: usize, faces: usize, rest: usize) -> &'static str {
    match (exact, faces, rest) {
        (_, 0, 0) => "exact",
        (0, _, 0) => "faces",
        (_, _, 0) => "exact and faces",
        _ => "rest",
    }
}

fn object(e: &Eigenvalue) -> Value {
    let (kind, mode) = match e.symmetry {
        Symmetry::Mode(m) => ("mode", json!(m)),
        Symmetry::Even => ("even", Value::Null),
        Symmetry::Odd => ("odd", Value::Null),
    };
    json!({
        "value": e.value.re,
        "imaginary": e.value.im,
        "symmetry": kind,
        "mode": mode,
        "multiplicity": e.multiplicity,
        "eigenvectors": e.eigenvectors,
    })
}

/// A line for each run of equal values with the same remark: the value, how often, the modes.
fn groups<'a>(values: impl Iterator<Item = (&'a Eigenvalue, &'static str)>) -> Vec<String> {
    let values: Vec<_> = values.collect();
    let same = |a: &(&Eigenvalue, &str), b: &(&Eigenvalue, &str)| {
        (a.0.value - b.0.value).norm() < 1e-10 && a.1 == b.1
    };
    let line = |run: &[(&Eigenvalue, &'static str)]| {
        let (e, remark) = run[0];
        let times: usize = run.iter().map(|(e, _)| e.multiplicity).sum();
        let eigenvectors: usize = run.iter().map(|(e, _)| e.eigenvectors).sum();
        let mut remarks = vec![symmetries(run)];
        remarks.extend((!remark.is_empty()).then(|| remark.to_owned()));
        remarks.extend((eigenvectors < times).then(|| format!("defective: {eigenvectors} eigenvectors")));
        format!("  {:<22} x {times:<3}  {}\n", number(e), remarks.join(", "))
    };
    values.chunk_by(same).map(line).collect()
}

fn symmetries(run: &[(&Eigenvalue, &str)]) -> String {
    let mut names: Vec<String> = Vec::new();
    let mut modes: Vec<usize> = Vec::new();
    for (e, _) in run {
        match e.symmetry {
            Symmetry::Mode(m) => modes.push(m),
            Symmetry::Even => names.push("even".to_owned()),
            Symmetry::Odd => names.push("odd".to_owned()),
        }
    }
    modes.sort_unstable();
    modes.dedup();
    for run in modes.chunk_by(|a, b| a + 1 == *b) {
        names.push(match run {
            [m] => m.to_string(),
            [a, .., b] => format!("{a}-{b}"),
            [] => continue,
        });
    }
    let word = if modes.is_empty() {
        ""
    } else if modes.len() == 1 {
        "mode "
    } else {
        "modes "
    };
    format!("{word}{}", names.join(", "))
}

/// Ten digits, and the fraction if it is one of a small power of two.
fn number(e: &Eigenvalue) -> String {
    let (re, im) = (e.value.re, e.value.im);
    if im.abs() > 1e-10 {
        return format!("{re:.10} {im:+.10}i");
    }
    let fraction = (0..=8).map(|p| 1u32 << p).find_map(|d| {
        let n = (re * f64::from(d)).round();
        ((re - n / f64::from(d)).abs() < 1e-12 && n != 0.0 && (re - re.round()).abs() > 1e-9)
            .then(|| format!(" = {n}/{d}"))
    });
    let shown = if re.abs() < 5e-11 { 0.0 } else { re };
    format!("{shown:.10}{}", fraction.unwrap_or_default())
}
