use std::io;
use std::path::Path;

use openusd::sdf::{Data, ListOp, SpecType, Specifier, Value};
use openusd::tf::Token;
use openusd::usda::TextWriter;

use crate::io::{IoError, atomic};

/// Writes a layer as text.
///
/// # Errors
/// [`IoError::Content`] if something in it cannot be said as text; [`IoError::Write`].
pub(super) fn write(path: &Path, mut data: Data) -> Result<(), IoError> {
    pixars_way(&mut data);
    let mut refused = None;
    let result = atomic::write(path, |out| {
        TextWriter::write(&data, out).map_err(|error| {
            error.downcast::<io::Error>().unwrap_or_else(|error| {
                refused = Some(error.to_string());
                io::Error::other("refused")
            })
        })
    });
    match refused {
        None => result,
        Some(reason) => Err(IoError::content(
            &path.display().to_string(),
            "stage",
            format!("something on it cannot be written as text ({reason}): remove it from the input"),
        )),
    }
}

/// The crate's writer leaves out the brackets of a list of one item, and Pixar's reader insists on them
/// where the items are tokens, paths or numbers. As plain lists, under a name that has the operation in it,
/// they come out right.
///
/// It also says that a relationship is uniform, as binary files do; they always are, and the word is not
/// allowed.
fn pixars_way(data: &mut Data) {
    let paths: Vec<_> = data.iter().map(|(path, _)| path.clone()).collect();
    for path in paths {
        let Some(spec) = data.spec_mut(&path) else { continue };
        if spec.ty == SpecType::Relationship {
            spec.remove("variability");
        }
        let fields = std::mem::take(&mut spec.fields);
        spec.fields = fields.into_iter().flat_map(|(name, value)| bracketed(name, value)).collect();
    }
}

fn bracketed(name: String, value: Value) -> Vec<(String, Value)> {
    // What the text calls them.
    let keyword = match name.as_str() {
        "inheritPaths" => "inherits",
        "variantSetNames" => "variantSets",
        // Statements of their own, which are written right.
        "targetPaths" | "connectionPaths" => return vec![(name, value)],
        name => name,
    };
    match value {
        Value::TokenListOp(op) => lists(keyword, op, Value::TokenVec),
        Value::StringListOp(op) => lists(keyword, op, Value::StringVec),
        Value::PathListOp(op) => lists(keyword, op, Value::PathVec),
        Value::IntListOp(op) => lists(keyword, op, Value::IntVec),
        Value::Int64ListOp(op) => lists(keyword, op, Value::Int64Vec),
        Value::UIntListOp(op) => lists(keyword, op, Value::UintVec),
        Value::UInt64ListOp(op) => lists(keyword, op, Value::Uint64Vec),
        value => vec![(name, value)],
    }
}

fn lists<T: Default + Clone + PartialEq>(
    name: &str,
    op: ListOp<T>,
    list: fn(Vec<T>) -> Value,
) -> Vec<(String, Value)> {
    if op.explicit {
        return vec![(name.to_owned(), list(op.explicit_items))];
    }
    let operations = [
        ("delete", op.deleted_items),
        ("add", op.added_items),
        ("prepend", op.prepended_items),
        ("append", op.appended_items),
        ("reorder", op.ordered_items),
    ];
    let said = operations.into_iter().filter(|(_, items)| !items.is_empty());
    said.map(|(operation, items)| (format!("{operation} {name}"), list(items))).collect()
}

/// The crate's text parser leaves escapes in strings as they stand, and its writer writes strings as they
/// stand. So a layer from a binary file has its strings escaped when it is read, as if it were from text.
pub(super) fn as_text_says(mut data: Data) -> Data {
    let paths: Vec<_> = data.iter().map(|(path, _)| path.clone()).collect();
    for path in paths {
        let Some(spec) = data.spec_mut(&path) else { continue };
        // Where a binary file does not say, a prim is an `over`; the writer would make it a `def`.
        if spec.ty == SpecType::Prim && !spec.contains("specifier") {
            spec.add("specifier", Value::Specifier(Specifier::Over));
        }
        spec.fields.iter_mut().for_each(|(_, value)| escape(value));
    }
    data
}

fn escape(value: &mut Value) {
    let text = |text: &mut String| {
        if text.contains(['\\', '"']) {
            *text = text.replace('\\', "\\\\").replace('"', "\\\"");
        }
    };
    let token = |token: &mut Token| {
        if token.as_str().contains(['\\', '"']) {
            let mut escaped = token.as_str().to_owned();
            text(&mut escaped);
            *token = Token::from(escaped);
        }
    };
    match value {
        Value::String(string) => text(string),
        Value::StringVec(strings) => strings.iter_mut().for_each(text),
        Value::Token(name) => token(name),
        Value::TokenVec(names) => names.iter_mut().for_each(token),
        Value::Dictionary(entries) => entries.values_mut().for_each(escape),
        Value::TimeSamples(samples) => samples.iter_mut().for_each(|(_, value)| escape(value)),
        Value::ValueVec(values) => values.iter_mut().for_each(escape),
        _ => {}
    }
}
