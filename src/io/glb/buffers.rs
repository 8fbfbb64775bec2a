use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::{STANDARD, STANDARD_NO_PAD};
use gltf::accessor::{DataType, Dimensions, Item, Iter};
use gltf::buffer::Source;
use gltf::{Accessor, Gltf};

use crate::io::IoError;
use crate::io::error::quote;

/// The numbers of a document.
pub(super) struct Buffers(Vec<Vec<u8>>);

impl Buffers {
    /// Gathers them: from the file itself, from data URIs, from files beside it.
    pub(super) fn load(path: &Path, gltf: &Gltf) -> Result<Self, IoError> {
        let name = path.display().to_string();
        let load = |buffer: gltf::Buffer| {
            let fail =
                |problem: &str| Err(IoError::content(&name, &format!("buffer {}", buffer.index()), problem));
            let bytes = match buffer.source() {
                Source::Bin => match &gltf.blob {
                    Some(blob) => blob.clone(),
                    None => return fail("has no data: the binary chunk is missing, export the file again"),
                },
                Source::Uri(uri) => match uri.strip_prefix("data:") {
                    Some(data) => match data.split_once(";base64,").map(|(_, text)| decode(text)) {
                        Some(Some(bytes)) => bytes,
                        _ => return fail("has a data URI that is not base64: export the file again"),
                    },
                    None if uri.contains("://") => {
                        return fail(&format!("is at {}: fetch it and name the file", quote(uri)));
                    }
                    None => {
                        let beside = path.with_file_name("").join(percent_decoded(uri));
                        std::fs::read(&beside).map_err(IoError::read(&beside))?
                    }
                },
            };
            if bytes.len() < buffer.length() {
                let problem = format!("has {} bytes where {} belong", bytes.len(), buffer.length());
                return fail(&format!("{problem}: the file is cut off, export it again"));
            }
            Ok(bytes)
        };
        Ok(Buffers(gltf.buffers().map(load).collect::<Result<_, _>>()?))
    }

    /// The items of an accessor of a given shape.
    ///
    /// # Errors
    /// What is wrong with the accessor, in words.
    pub(super) fn items<'s, T: Item>(
        &'s self,
        accessor: Accessor<'s>,
        types: &[DataType],
        dimensions: Dimensions,
    ) -> Result<Iter<'s, T>, String> {
        let index = accessor.index();
        let fail = |problem: &str| Err(format!("accessor {index} {problem}"));
        if !types.contains(&accessor.data_type()) || accessor.dimensions() != dimensions {
            return fail("has numbers of another kind than belong there: export the file again");
        }
        if accessor.sparse().is_some() {
            return fail("is sparse, which is not read here: export the file without sparse accessors");
        }
        let Some(view) = accessor.view() else {
            return fail("has no buffer view: export the file again");
        };
        let (count, size) = (accessor.count(), accessor.size());
        let stride = view.stride().unwrap_or(size);
        // What the crate takes for granted.
        let end = count
            .checked_sub(1)
            .and_then(|last| last.checked_mul(stride)?.checked_add(size)?.checked_add(accessor.offset()));
        let view_end = view.offset().checked_add(view.length());
        let buffer = self.0.get(view.buffer().index()).map_or(0, Vec::len);
        let inside = end.is_some_and(|end| end <= view.length()) && view_end.is_some_and(|end| end <= buffer);
        if stride < size || !inside {
            return fail("is empty or reaches beyond its buffer: export the file again");
        }
        let bytes = |buffer: gltf::Buffer| self.0.get(buffer.index()).map(Vec::as_slice);
        match Iter::new(accessor, bytes) {
            Some(items) => Ok(items),
            None => fail("reaches beyond its buffer: export the file again"),
        }
    }
}

fn decode(text: &str) -> Option<Vec<u8>> {
    STANDARD.decode(text).or_else(|_| STANDARD_NO_PAD.decode(text)).ok()
}

/// `%20` -> a space.
fn percent_decoded(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let hex = tail.get(..2).and_then(|hex| std::str::from_utf8(hex).ok());
        match hex.filter(|_| first == b'%').and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            None => {
                bytes.push(first);
                rest = tail;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
