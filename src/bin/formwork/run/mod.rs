//! What the commands do, one module each. Every one returns an [`Outcome`]; `main` prints it.

pub mod basis;
pub mod batch;
pub mod charmap;
pub mod decompose;
pub mod design;
pub mod evaluate;
pub mod inspect;
pub mod masses;
pub mod operators;
pub mod solve;
pub mod spectrum;
pub mod stencil;
pub mod streamlines;
pub mod study;
pub mod subdivide;
mod to_limit;
pub mod validate;
pub mod view;
pub mod volume;

use indicatif::{ProgressBar, ProgressFinish, ProgressStyle};
use serde_json::{Value, json};

/// What a command has to say, once it is done.
pub struct Outcome {
    /// For people.
    pub text: String,
    /// For programs: an object.
    pub json: Value,
    /// What was passed over in the input, one sentence each.
    pub notes: Vec<String>,
    /// Whether every law that was measured holds, or every asset of a batch went well.
    pub holds: bool,
}

impl Outcome {
    /// The object with the notes in it.
    pub fn to_json(&self) -> Value {
        let mut object = self.json.clone();
        object["notes"] = json!(self.notes);
        object
    }
}

/// A bar on stderr, if `shown` and stderr is a terminal; it moves as levels are finished, and goes when it is
/// dropped.
fn progress_bar(shown: bool, levels: usize, doing: &'static str) -> ProgressBar {
    // Each level has four times the faces of the one before, and takes as much longer.
    progress_bar_of(shown, work(levels), doing)
}

/// A bar of so much work.
fn progress_bar_of(shown: bool, work: u64, doing: &'static str) -> ProgressBar {
    if !shown {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(work).with_finish(ProgressFinish::AndClear);
    if let Ok(style) = ProgressStyle::with_template("{msg} [{bar:30}] {elapsed}") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_message(doing);
    bar.enable_steady_tick(std::time::Duration::from_millis(100));
    bar
}

/// The work of levels 0 to `level`, level 0 counting 1.
fn work(level: usize) -> u64 {
    ((1 << (2 * level + 2)) - 1) / 3
}

/// `1234567` -> `1 234 567`.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// `1 face`, `2 faces`: a count and what it counts.
fn count(number: usize, thing: &str) -> String {
    let plural = match thing {
        "vertex" => "vertices".to_owned(),
        "tetrahedron" => "tetrahedra".to_owned(),
        "octahedron" => "octahedra".to_owned(),
        _ => format!("{thing}s"),
    };
    format!("{} {}", grouped(number), if number == 1 { thing } else { &plural })
}

/// The size of a file, for a message.
fn size_of(path: &std::path::Path) -> String {
    match std::fs::metadata(path).map(|data| data.len()) {
        Err(_) => String::new(),
        Ok(bytes) if bytes < 10_000 => format!(" ({bytes} bytes)"),
        Ok(bytes) if bytes < 10_000_000 => format!(" ({} kB)", bytes / 1000),
        Ok(bytes) => format!(" ({} MB)", bytes / 1_000_000),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped_and_counted() {
        assert_eq!([0, 999, 1000, 1234567].map(grouped), ["0", "999", "1 000", "1 234 567"]);
        assert_eq!(
            (count(1, "vertex"), count(2, "vertex")),
            ("1 vertex".to_owned(), "2 vertices".to_owned())
        );
        assert_eq!([0, 1, 2].map(work), [1, 5, 21]);
    }
}
