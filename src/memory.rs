//! Where large arrays lie.
//!
//! The first touch of fresh memory costs more than anything that is computed here: a page fault for each 4 KiB.
//! Where the system has pages of 2 MiB for those who ask (`madvise`, the setting of most Linux systems), it is a
//! third of that.

use rayon::prelude::*;

/// The second bridge to C++: one call, which the standard library does not have.
#[cxx::bridge(namespace = "formwork")]
#[allow(unsafe_code)]
mod ffi {
    // SAFETY: advice about a range of addresses changes no value and frees nothing, whatever the range.
    unsafe extern "C++" {
        include!("cpp/memory.h");

        fn prefer_huge_pages(address: usize, bytes: usize);
    }
}

/// Arrays below this, in bytes, stay where they are.
const LARGE: usize = 4 << 20;

/// An empty vector with room for `capacity` values, on huge pages as [`on_huge_pages`] says.
pub fn with_capacity<T>(capacity: usize) -> Vec<T> {
    on_huge_pages(Vec::with_capacity(capacity))
}

/// `len` zeros, or what a type has in their place, on huge pages as [`on_huge_pages`] says.
pub fn zeros<T: Clone + Default>(len: usize) -> Vec<T> {
    on_huge_pages(vec![T::default(); len])
}

/// `len` times a value, on huge pages as [`on_huge_pages`] says.
pub fn filled<T: Clone>(value: T, len: usize) -> Vec<T> {
    let mut vector = with_capacity(len);
    vector.resize(len, value);
    vector
}

/// Collects as [`ParallelIterator::collect`], on huge pages as [`on_huge_pages`] says.
pub fn collect<T: Send>(values: impl IndexedParallelIterator<Item = T>) -> Vec<T> {
    let mut vector = with_capacity(values.len());
    values.collect_into_vec(&mut vector);
    vector
}

/// The same vector, on huge pages if it is large and the system has them. It pays before the memory is touched:
/// `vec![0; n]` and `Vec::with_capacity(n)` do not touch it.
pub fn on_huge_pages<T>(vector: Vec<T>) -> Vec<T> {
    let bytes = vector.capacity() * size_of::<T>();
    if bytes >= LARGE {
        ffi::prefer_huge_pages(vector.as_ptr() as usize, bytes);
    }
    vector
}

/// [`Vec::resize`], on huge pages as [`on_huge_pages`] says if it needs more room.
pub fn resize<T: Clone>(vector: &mut Vec<T>, len: usize, value: T) {
    if vector.capacity() < len {
        *vector = filled(value, len);
    } else {
        vector.resize(len, value);
    }
}
