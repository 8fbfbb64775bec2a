use crate::io::error::quote;

/// What is wrong with a line of an OBJ file. Faces and vertices are counted from 0, but an index that a
/// face refers to is given as the file has it, from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum ObjProblem {
    #[error("has a zero byte: this is not a text file, export the mesh as OBJ in ASCII or UTF-8")]
    NotText,
    #[error("vertex {vertex} has {count} coordinates: write x, y and z")]
    TooFewCoordinates { vertex: usize, count: usize },
    #[error("vertex {vertex} has the coordinate {}: write a decimal number such as -1.5", quote(token))]
    NotANumber { vertex: usize, token: String },
    #[error("vertex {vertex} has the coordinate {value}: coordinates must be finite, correct the number")]
    NotFinite { vertex: usize, value: f64 },
    #[error(
        "face {face} refers to {}, which is not a vertex index: write a whole number from 1",
        quote(token)
    )]
    NotAnIndex { face: usize, token: String },
    #[error("face {face} refers to vertex 0: OBJ counts vertices from 1, correct the index")]
    IndexZero { face: usize },
    #[error(
        "face {face} refers to vertex {}, but the file has {count} (counted from 1): correct the index",
        shorten(index)
    )]
    IndexOutOfRange { face: usize, index: String, count: usize },
    #[error(
        "face {face} refers to vertex {} (counted back), but only {count} come before it: correct the index",
        shorten(index)
    )]
    IndexBeforeStart { face: usize, index: String, count: usize },
    #[error("the tag has no name: write it as `t crease 2/1/0 0 1 2.5`")]
    TagWithoutName,
    #[error(
        "tag `{tag}` has the counts {}: write how many integers, numbers and words follow, such as 2/1/0",
        quote(counts)
    )]
    TagCounts { tag: &'static str, counts: String },
    #[error(
        "tag `{tag}` promises {promised} values and has {actual}: correct the counts or complete the line"
    )]
    TagLength { tag: &'static str, promised: u64, actual: usize },
    #[error("tag `{tag}` has the value {} where {expected} belongs: correct it", quote(token))]
    TagValue { tag: &'static str, token: String, expected: &'static str },
    #[error("tag `{tag}` {actual}: it takes {expected}")]
    TagShape { tag: &'static str, actual: String, expected: &'static str },
}

/// A long number says no more than its length.
fn shorten(index: &str) -> String {
    if index.len() <= 24 { index.to_owned() } else { format!("{}...", &index[..20]) }
}
