use std::collections::BTreeMap;

use super::lines::logical_lines;
use super::{ObjProblem, tags};
use crate::io::SourceLines;
use crate::io::error::quote;
use crate::topology::Descriptor;

/// Lines that are passed over without a word: they carry nothing that subdivision uses.
const SILENT: [&str; 7] = ["vt", "vn", "o", "g", "s", "usemtl", "mtllib"];

/// The notes name this many kinds of unknown lines; a file of another format may have thousands.
const MAX_NOTES: usize = 6;

/// What is left of a file for the OBJ parser, and what was taken out of it.
#[derive(Default)]
pub(super) struct Filtered {
    /// The `v` and `f` lines, in order, nothing but coordinates and position indices in them.
    pub stream: String,
    /// Options, creases, corners and holes.
    pub descriptor: Descriptor,
    /// Where everything stood. Line `i` among the `v` lines of the stream is `source.vertices[i]`, and so
    /// for the faces.
    pub source: SourceLines,
    pub notes: Vec<String>,
}

/// Reduces a file to what is used. The parser that reads the numbers would tear the mesh apart at every
/// group and material, tell corners with different texture coordinates apart, and stop at comments
/// after values.
pub(super) fn filter(bytes: &[u8]) -> Result<Filtered, (usize, ObjProblem)> {
    if let Some(at) = bytes.iter().position(|&b| b == 0) {
        return Err((logical_lines(&bytes[..at + 1]).count(), ObjProblem::NotText));
    }
    let mut filtered = Filtered::default();
    let mut ignored = Ignored::default();
    for (number, text) in logical_lines(bytes) {
        let mut words = text.split_whitespace();
        let line = number as u32;
        match words.next() {
            None => {}
            Some("v") => {
                let count = words.clone().count();
                filtered.element("v", words.take(3));
                filtered.source.vertices.push(line);
                if count == 4 {
                    ignored.add("v weight", line);
                }
            }
            Some("f") => {
                filtered.element("f", words.map(position_index));
                filtered.source.faces.push(line);
            }
            Some("t") => {
                let read = tags::read(words, line, &mut filtered.descriptor, &mut filtered.source);
                if let Some(tag) = read.map_err(|problem| (number, problem))? {
                    ignored.add(&format!("t {tag}"), line);
                }
            }
            Some(word) if SILENT.contains(&word) => {}
            Some(word) => ignored.add(word, line),
        }
    }
    filtered.notes = ignored.notes();
    Ok(filtered)
}

impl Filtered {
    fn element<'a>(&mut self, directive: &str, tokens: impl Iterator<Item = &'a str>) {
        self.stream.push_str(directive);
        for token in tokens {
            self.stream.push(' ');
            self.stream.push_str(token);
        }
        self.stream.push('\n');
    }
}

/// `7/1/3` -> `7`. A corner without a position (`//3`) stays whole: it is no index, and must not vanish.
fn position_index(corner: &str) -> &str {
    match corner.split('/').next() {
        Some(index) if !index.is_empty() => index,
        _ => corner,
    }
}

/// Lines that are passed over: for each kind how many, and the first.
#[derive(Default)]
struct Ignored(BTreeMap<String, (usize, u32)>);

impl Ignored {
    fn add(&mut self, kind: &str, line: u32) {
        self.0.entry(kind.to_owned()).or_insert((0, line)).0 += 1;
    }

    fn notes(self) -> Vec<String> {
        let mut kinds: Vec<_> = self.0.into_iter().collect();
        kinds.sort_by_key(|&(_, (_, first))| first);
        let more = kinds.len().saturating_sub(MAX_NOTES);
        let mut notes: Vec<String> = kinds
            .iter()
            .take(MAX_NOTES)
            .map(|(kind, (count, first))| {
                let times = if *count == 1 { String::new() } else { format!(" and {} more", count - 1) };
                let what = match (kind.as_str(), kind.strip_prefix("t ")) {
                    ("v weight", _) => "the fourth value of a `v` line (a weight)".to_owned(),
                    ("l" | "p", _) => format!("`{kind}` (a line or point element)"),
                    (_, Some(tag)) => format!("the tag {}", quote(tag)),
                    _ => quote(kind),
                };
                format!("ignored: {what}, line {first}{times}")
            })
            .collect();
        if more > 0 {
            notes.push(format!("ignored: {more} more kinds of lines; is this an OBJ file?"));
        }
        notes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_positions_and_indices_stay() {
        let text =
            b"o box\nv 0 0 0 1 0 0\nvt 0 0\n  v 1 0 0 1 # w\ng a\nf 1/1/1 2//2 -1/3\nusemtl m\nf //1 2";
        let filtered = filter(text).ok().unwrap();
        assert_eq!(filtered.stream, "v 0 0 0\nv 1 0 0\nf 1 2 -1\nf //1 2\n");
        assert_eq!((filtered.source.vertices, filtered.source.faces), (vec![2, 4], vec![6, 8]));
        assert_eq!(filtered.notes, ["ignored: the fourth value of a `v` line (a weight), line 4"]);
    }

    #[test]
    fn what_is_ignored_is_said() {
        let filtered = filter(b"l 1 2\nl 2 3\ncurv 0 1\nt rootname 0/0/1 x\n").ok().unwrap();
        assert_eq!(
            filtered.notes,
            [
                "ignored: `l` (a line or point element), line 1 and 1 more",
                "ignored: `curv`, line 3",
                "ignored: the tag `rootname`, line 4",
            ]
        );
        let noise: String = ('a'..='m').map(|c| format!("x{c}\n")).collect();
        let notes = filter(noise.as_bytes()).ok().unwrap().notes;
        assert_eq!((notes.len(), notes[6].contains("7 more kinds")), (7, true));
    }

    #[test]
    fn binary_files_are_recognised() {
        assert_eq!(filter(b"glTF\n\x02\0\0").err(), Some((2, ObjProblem::NotText)));
    }
}
