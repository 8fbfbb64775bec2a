use std::io::{Cursor, Read};
use std::thread;

use openusd::sdf::Data;
use openusd::{usda, usdc};
use zip::{CompressionMethod, ZipArchive};

use super::{crate_check, text};

/// Brackets of a text file nested deeper than this are refused: the parser calls itself for each.
const MAX_DEPTH: usize = 256;
/// Room for that.
const STACK: usize = 64 << 20;

/// The name of the thread that reads stages. The reader panics on some damaged files; that becomes an error
/// like any other, and a program may want its panic hook to be silent about this thread.
pub const READER_THREAD: &str = "formwork-usd-reader";

/// The root layer of a file, and what the other files in its package are called.
pub(super) fn layer(bytes: Vec<u8>) -> Result<(Data, Vec<String>), String> {
    if !bytes.starts_with(b"PK\x03\x04") {
        return Ok((root_layer(bytes)?, Vec::new()));
    }
    let refused = |error: &dyn std::fmt::Display| {
        format!("the package cannot be unpacked ({error}): it is damaged, export it again")
    };
    let size = bytes.len() as u64;
    let mut package = ZipArchive::new(Cursor::new(bytes)).map_err(|error| refused(&error))?;
    // The first file is the root layer, so the specification says.
    let root = {
        let mut first = package.by_index(0).map_err(|error| refused(&error))?;
        if first.compression() != CompressionMethod::Stored || first.size() > size {
            return Err("the package is compressed, which usdz files are not: export it again".to_owned());
        }
        let mut root = Vec::new();
        first.by_ref().take(size).read_to_end(&mut root).map_err(|error| refused(&error))?;
        root
    };
    if root.starts_with(b"PK\x03\x04") {
        return Err("the package holds another package, which is not read: unpack it".to_owned());
    }
    let others = package.file_names().skip(1).map(str::to_owned).collect();
    Ok((root_layer(root)?, others))
}

fn root_layer(bytes: Vec<u8>) -> Result<Data, String> {
    let binary = bytes.starts_with(usdc::MAGIC);
    if binary {
        crate_check::check(&bytes)?;
    } else {
        check_text(&bytes)?;
    }
    let read = move || match binary {
        true => {
            let data = Data::from_abstract(&usdc::CrateData::open(Cursor::new(bytes), true)?)?;
            Ok(text::as_text_says(data))
        }
        false => usda::parse(std::str::from_utf8(&bytes)?),
    };
    let reader = thread::Builder::new().name(READER_THREAD.to_owned()).stack_size(STACK).spawn(read);
    let reader = reader.map_err(|error| format!("no thread to read it with ({error}): try again"))?;
    match reader.join() {
        Ok(Ok(data)) => Ok(data),
        Ok(Err(error)) => {
            let chain: Vec<String> = error.chain().map(|cause| cause.to_string()).collect();
            let reason = chain.join(": ");
            let reason: String = reason.split_whitespace().collect::<Vec<_>>().join(" ");
            let reason: String = reason.chars().take(200).collect();
            Err(format!("the USD reader refuses it ({reason}): it is damaged, export it again"))
        }
        Err(_) => Err("the USD reader gives up on it: it is damaged, export it again".to_owned()),
    }
}

/// What the text parser must not see: it looks for no header, and has no limit to its recursion.
fn check_text(bytes: &[u8]) -> Result<(), String> {
    if !bytes.starts_with(b"#usda ") {
        return Err("is no USD file: it starts neither as text, binary nor package".to_owned());
    }
    let (mut depth, mut i) = (0usize, 0);
    while i < bytes.len() {
        match bytes[i] {
            b'#' => i += bytes[i..].iter().position(|&b| b == b'\n').unwrap_or(bytes.len() - i),
            quote @ (b'"' | b'\'') => i = end_of_string(bytes, i, quote),
            b'@' => i += 1 + bytes[i + 1..].iter().position(|&b| b == b'@').unwrap_or(0),
            b'{' | b'(' | b'[' => depth += 1,
            b'}' | b')' | b']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > MAX_DEPTH {
            let line = 1 + bytes[..i].iter().filter(|&&b| b == b'\n').count();
            return Err(format!("line {line}: brackets are nested more than {MAX_DEPTH} deep: flatten it"));
        }
        i += 1;
    }
    if depth > 0 {
        return Err("is cut off: some brackets are not closed, export it again".to_owned());
    }
    Ok(())
}

/// The last byte of the string that starts at `start`; the end of the file if it is not closed.
fn end_of_string(bytes: &[u8], start: usize, quote: u8) -> usize {
    let long = bytes[start..].starts_with(&[quote; 3]);
    let close: &[u8] = if long { &[quote; 3] } else { &[quote] };
    let mut i = start + close.len();
    while i < bytes.len() && !bytes[i..].starts_with(close) {
        i += if bytes[i] == b'\\' { 2 } else { 1 };
    }
    i + close.len() - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_in_strings_and_comments_do_not_count() {
        let text = b"#usda 1.0\n# (((\n( doc = \"\"\"[[\\\"\"\"\" )\ndef \"a{\" { string s = '\\'[' }\n";
        assert_eq!(check_text(text), Ok(()));
        assert!(check_text(b"#usda 1.0\ndef \"a\" {").unwrap_err().contains("cut off"));
        let deep = format!("#usda 1.0\n{}", "(\n".repeat(300));
        assert!(check_text(deep.as_bytes()).unwrap_err().contains("line 258: brackets"));
    }
}
