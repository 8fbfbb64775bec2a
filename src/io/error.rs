use std::io;
use std::path::{Path, PathBuf};

use super::fields::FieldsProblem;
use super::obj::ObjProblem;
use super::points::PointsProblem;
use crate::topology::TopologyError;

/// Why a file could not be read or written. The message is one line: file, place, problem, remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum IoError {
    #[error("{}: {}", path.display(), reading(source))]
    Read { path: PathBuf, source: io::Error },
    #[error("{}: {}", path.display(), writing(source))]
    Write { path: PathBuf, source: io::Error },
    #[error("{file}: line {line}: {problem}")]
    Obj { file: String, line: usize, problem: ObjProblem },
    #[error("{file}: the OBJ reader refuses the file ({reason}): export it again as plain OBJ")]
    ObjRefused { file: String, reason: String },
    #[error("{file}: {problem}")]
    Fields { file: String, problem: FieldsProblem },
    #[error("{file}: {problem}")]
    Points { file: String, problem: PointsProblem },
    #[error("{}", topology(file, *line, source))]
    Topology { file: String, line: Option<usize>, source: TopologyError },
    #[error("{file}: {place}: {problem}")]
    Content { file: String, place: String, problem: String },
    #[error("{}: {}: choose {choice}{hint}", path.display(), unknown(path, use_))]
    Format { path: PathBuf, use_: &'static str, choice: String, hint: &'static str },
    #[error(
        "no face is left to write: every face is a hole or, with the boundary rule `none`, touches the boundary; choose another boundary rule or refine further"
    )]
    NothingToWrite,
    #[error("{what} {index} is not finite after refinement: the values overflow, scale the input down")]
    Overflow { what: &'static str, index: usize },
    #[error("{}: {limit}", path.display())]
    FormatLimit { path: PathBuf, limit: &'static str },
}

impl IoError {
    pub(crate) fn read(path: &Path) -> impl FnOnce(io::Error) -> IoError {
        let path = path.to_owned();
        move |source| IoError::Read { path, source }
    }

    /// Something in a file of many parts: `place` is a prim path, an attribute, a node.
    pub(crate) fn content(file: &str, place: &str, problem: impl Into<String>) -> IoError {
        IoError::Content { file: file.to_owned(), place: place.to_owned(), problem: problem.into() }
    }

    pub(crate) fn write(path: &Path) -> impl FnOnce(io::Error) -> IoError {
        let path = path.to_owned();
        move |source| IoError::Write { path, source }
    }
}

fn unknown(path: &Path, use_: &str) -> String {
    match path.extension() {
        None => "has no extension".to_owned(),
        Some(extension) => {
            let extension = extension.to_string_lossy().to_lowercase();
            format!("has the extension .{extension}, which is not {use_} here")
        }
    }
}

fn topology(file: &str, line: Option<usize>, error: &TopologyError) -> String {
    match (line, error.element()) {
        (Some(line), _) => format!("{file}: line {line}: {error} (numbers start at 0)"),
        (None, Some(_)) => format!("{file}: {error} (numbers start at 0)"),
        (None, None) => format!("{file}: {error}"),
    }
}

fn reading(error: &io::Error) -> String {
    use io::ErrorKind as Kind;
    match error.kind() {
        Kind::NotFound => "no such file: check the path".into(),
        Kind::IsADirectory => "is a directory: name a file in it".into(),
        Kind::NotADirectory => "a part of the path is a file, not a directory: check the path".into(),
        Kind::PermissionDenied => "may not be read: ask its owner for permission".into(),
        _ => format!("cannot be read ({error}): check the file"),
    }
}

fn writing(error: &io::Error) -> String {
    use io::ErrorKind as Kind;
    match error.kind() {
        Kind::NotFound => "its directory does not exist: create it first".into(),
        Kind::IsADirectory => "is a directory: name a file in it".into(),
        Kind::NotADirectory => "a part of the path is a file, not a directory: check the path".into(),
        Kind::PermissionDenied | Kind::ReadOnlyFilesystem => {
            "its directory may not be written to: choose another place".into()
        }
        Kind::StorageFull | Kind::QuotaExceeded => {
            "the disk is full: make room or choose another place".into()
        }
        _ => format!("cannot be written ({error}): choose another place"),
    }
}

/// At most 40 characters of what a file says, quoted, for a message: a line may be megabytes long, or
/// hold characters that move the cursor.
pub(crate) fn quote(text: &str) -> String {
    let mut start: String = text.chars().take(40).collect();
    if start.len() < text.len() {
        start.push_str("...");
    }
    format!("`{}`", start.escape_debug())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_are_short_and_printable() {
        assert_eq!(quote("1,5"), "`1,5`");
        assert_eq!(quote("a\u{1b}[2J"), "`a\\u{1b}[2J`");
        assert_eq!(quote(&"x".repeat(1000)), format!("`{}...`", "x".repeat(40)));
    }
}
