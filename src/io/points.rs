//! Points on the faces of a cage, as JSON.
//!
//! ```json
//! { "points": [[0, 0.5, 0.25], [4, 2, 0.1, 0.9]] }
//! ```
//!
//! Each entry is `[face, s, t]` or `[face, corner, s, t]`, `s` and `t` measured from that corner of the face; without
//! one from its first. All indices start at 0.

use std::fs;
use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use super::IoError;
use super::error::quote;

/// A point of a points file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// The face.
    pub face: u32,
    /// The corner, if the entry names one.
    pub corner: Option<u32>,
    /// The first parameter.
    pub s: f64,
    /// The second parameter.
    pub t: f64,
}

/// What is wrong with a points file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum PointsProblem {
    #[error("line {line}, column {column}: {reason}: write {{\"points\": [[face, s, t], ..]}} in JSON")]
    Syntax { line: usize, column: usize, reason: String },
    #[error(
        "points[{number}] = {text}: an entry is [face, s, t] or [face, corner, s, t], indices being whole numbers from 0: correct it"
    )]
    Shape { number: usize, text: String },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    points: Vec<Value>,
}

/// Reads points from a file.
///
/// # Errors
/// [`IoError::Read`], or as for [`parse`].
pub fn read(path: &Path) -> Result<Vec<Point>, IoError> {
    let bytes = fs::read(path).map_err(IoError::read(path))?;
    parse(&path.display().to_string(), &bytes)
}

/// Reads points from the contents of a file; `name` is used in messages.
///
/// # Errors
/// [`IoError::Points`], naming the entry.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Vec<Point>, IoError> {
    let fail = |problem| IoError::Points { file: name.to_owned(), problem };
    let file: File = serde_json::from_slice(bytes).map_err(|error| {
        let place = format!(" at line {} column {}", error.line(), error.column());
        let message = error.to_string();
        let reason = message.strip_suffix(&place).unwrap_or(&message).to_owned();
        fail(PointsProblem::Syntax { line: error.line(), column: error.column(), reason })
    })?;
    let shape =
        |number, entry: &Value| fail(PointsProblem::Shape { number, text: quote(&entry.to_string()) });
    let entry = |(number, entry): (usize, &Value)| point(entry).ok_or_else(|| shape(number, entry));
    file.points.iter().enumerate().map(entry).collect()
}

fn point(entry: &Value) -> Option<Point> {
    let entry = entry.as_array()?;
    let index = |value: &Value| value.as_u64().and_then(|index| u32::try_from(index).ok());
    let (corner, s, t) = match entry.as_slice() {
        [_, s, t] => (None, s, t),
        [_, corner, s, t] => (Some(index(corner)?), s, t),
        _ => return None,
    };
    Some(Point { face: index(&entry[0])?, corner, s: s.as_f64()?, t: t.as_f64()? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_with_and_without_a_corner() {
        let points = parse("p", br#"{"points": [[0, 0.5, 0.25], [4, 2, 0.1, 1]]}"#).unwrap();
        let expected = [
            Point { face: 0, corner: None, s: 0.5, t: 0.25 },
            Point { face: 4, corner: Some(2), s: 0.1, t: 1.0 },
        ];
        assert_eq!(points, expected);
    }

    #[test]
    fn bad_entries_are_named() {
        for (bytes, expected) in [
            (&br#"{"points": [[0, 1, 0], [0.5, 0, 0]]}"#[..], "points[1] = `[0.5,0,0]`"),
            (br#"{"points": [[0, 1]]}"#, "points[0] = `[0,1]`"),
            (br#"{"points": [[0, -1, 0, 0]]}"#, "points[0] = `[0,-1,0,0]`"),
            (br#"{"points": [[0, 1, "x"]]}"#, "points[0]"),
            (br#"{"dots": []}"#, "unknown field"),
            (b"{", "line 1"),
        ] {
            let message = parse("p.json", bytes).unwrap_err().to_string();
            assert!(message.starts_with("p.json: ") && message.contains(expected), "{message}");
        }
    }
}
