//! A table as a picture: errors over the size of a cell, both axes logarithmic, as SVG.

use std::fmt::Write;

use super::{Study, Table};

const SIZE: [f64; 2] = [720.0, 480.0];
/// Left, top, right and bottom.
const MARGINS: [f64; 4] = [70.0, 46.0, 230.0, 54.0];
/// Of errors, in the order of the table: told apart with any colour vision.
const COLOURS: [&str; 3] = ["#0072b2", "#d55e00", "#009e73"];

/// The range of some numbers in decades, and a little more.
fn decades(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let logs = values.filter(|x| *x > 0.0 && x.is_finite()).map(f64::log10);
    let [from, to] = logs.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
    if from > to { [-1.0, 0.0] } else { [from - 0.08 * (to - from) - 0.05, to + 0.08 * (to - from) + 0.05] }
}

/// The picture of a study.
pub fn svg(study: &Study, tables: &[Table]) -> String {
    let rows = || tables.iter().flat_map(|table| &table.rows);
    let (xs, ys) =
        (decades(rows().map(|row| row.h)), decades(rows().flat_map(|row| row.errors.iter().copied())));
    let [left, top, right, bottom] = MARGINS;
    let (width, height) = (SIZE[0] - left - right, SIZE[1] - top - bottom);
    let x = |h: f64| left + width * (h.log10() - xs[0]) / (xs[1] - xs[0]);
    let y = |e: f64| top + height * (ys[1] - e.log10()) / (ys[1] - ys[0]);
    let mut out = String::new();
    let mut line = |text: std::fmt::Arguments| writeln!(out, "{text}").expect("a string grows");
    line(format_args!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" width=\"{}\" height=\"{}\" font-family=\"sans-serif\" font-size=\"13\">",
        SIZE[0], SIZE[1], SIZE[0], SIZE[1]
    ));
    line(format_args!("<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>"));
    line(format_args!(
        "<text x=\"{left}\" y=\"26\" font-size=\"16\">{}: error over the size of a cell</text>",
        escaped(&study.name)
    ));
    for k in ys[0].ceil() as i32..=ys[1].floor() as i32 {
        let at = y(10f64.powi(k));
        line(format_args!(
            "<line x1=\"{left}\" y1=\"{at:.1}\" x2=\"{:.1}\" y2=\"{at:.1}\" stroke=\"#dddddd\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">1e{k}</text>",
            left + width,
            left - 8.0,
            at + 4.5
        ));
    }
    let mut sizes: Vec<f64> = rows().map(|row| row.h).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.dedup();
    for h in sizes {
        let at = x(h);
        line(format_args!(
            "<line x1=\"{at:.1}\" y1=\"{top}\" x2=\"{at:.1}\" y2=\"{:.1}\" stroke=\"#dddddd\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">1/{:.0}</text>",
            top + height,
            top + height + 20.0,
            1.0 / h
        ));
    }
    line(format_args!(
        "<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"none\" stroke=\"#444444\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">h</text>",
        left + width / 2.0,
        SIZE[1] - 14.0
    ));
    let mut legend = top + 8.0;
    for (number, table) in tables.iter().enumerate() {
        let dash = if number == 0 { "none" } else { "6 4" };
        for (k, error) in table.errors.iter().enumerate() {
            let colour = COLOURS[k % COLOURS.len()];
            let points: Vec<(f64, f64)> = table
                .rows
                .iter()
                .filter(|row| row.errors[k] > 0.0 && row.errors[k].is_finite())
                .map(|row| (x(row.h), y(row.errors[k])))
                .collect();
            let path: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
            line(format_args!(
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\" stroke-dasharray=\"{dash}\"/>",
                path.join(" ")
            ));
            for (x, y) in &points {
                line(format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"{colour}\"/>"));
            }
            let rate = table.rows.last().and_then(|row| row.rates.get(k).copied().flatten());
            let rate = rate.map_or(String::new(), |rate| format!(", rate {rate:.2}"));
            let at = left + width + 14.0;
            line(format_args!(
                "<line x1=\"{at}\" y1=\"{legend}\" x2=\"{}\" y2=\"{legend}\" stroke=\"{colour}\" stroke-width=\"2\" stroke-dasharray=\"{dash}\"/><text x=\"{}\" y=\"{}\">{error}, {}{rate}</text>",
                at + 26.0,
                at + 33.0,
                legend + 4.5,
                table.cells.name()
            ));
            legend += 22.0;
        }
    }
    line(format_args!("</svg>"));
    out
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
