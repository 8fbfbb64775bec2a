//! Where large arrays lie.
//!
//! The first touch of fresh memory, a page fault for each 4 KiB, costs as much as what is computed to fill it. Where the
//! system has pages of 2 MiB for those who ask (`madvise`, the setting of most Linux systems), there are 512 times fewer.
//! The column "storing" of `cargo bench --bench tables` is what is left. How results get there at all: `Stores`.

use std::marker::PhantomData;

use rayon::prelude::*;

/// The second bridge to C++: calls that the standard library does not have.
#[cxx::bridge(namespace = "formwork")]
#[allow(unsafe_code)]
mod ffi {
    // SAFETY: advice about a range of addresses changes no value and frees nothing, whatever the range.
    unsafe extern "C++" {
        include!("cpp/memory.h");

        fn prefer_huge_pages(address: usize, bytes: usize);
        unsafe fn store_past_caches(to: *mut u8, from: *const u8, bytes: usize);
        fn finish_stores();
    }
}

/// Arrays below this, in bytes, stay where they are.
const LARGE: usize = 1 << 20;

/// Arrays from here on, in bytes, are mappings of their own (`DEFAULT_MMAP_THRESHOLD_MAX` of glibc).
const MAPPED: usize = 32 << 20;

/// An empty vector with room for `capacity` values, on huge pages as [`on_huge_pages`] says.
pub fn with_capacity<T>(capacity: usize) -> Vec<T> {
    on_huge_pages(Vec::with_capacity(capacity))
}

/// `len` zeros, or what a type has in their place, on huge pages as [`on_huge_pages`] says. Where memory is fresh, what is
/// never written is never touched.
pub fn zeros<T: Clone + Default>(len: usize) -> Vec<T> {
    on_huge_pages(vec![T::default(); len])
}

/// [`zeros`] that are all to be written over. The allocator clears what it has used before by itself, before the system can
/// be asked for huge pages; only what is so large that it always comes from the system is left untouched.
pub fn zeros_to_fill<T: Clone + Default>(len: usize) -> Vec<T> {
    match len * size_of::<T>() < MAPPED {
        true => filled(T::default(), len),
        false => zeros(len),
    }
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
    prefer_huge_pages(vector.as_ptr() as usize, bytes);
    vector
}

/// Asks for huge pages under `bytes` bytes from an address on, if they are many and the system has them. It pays before
/// they are touched. No value is changed, whatever lies there.
pub fn prefer_huge_pages(address: usize, bytes: usize) {
    if bytes >= LARGE {
        ffi::prefer_huge_pages(address, bytes);
    }
}

/// Makes a vector `len` long whose values will all be written: until then they are `value`, or what was there. If it
/// needs more room, that is on huge pages as [`on_huge_pages`] says.
pub fn reuse<T: Clone>(vector: &mut Vec<T>, len: usize, value: T) {
    if vector.capacity() < len {
        *vector = filled(value, len);
    } else {
        vector.resize(len, value);
    }
}

/// [`Vec::append`]; if that needs more room, on huge pages as [`on_huge_pages`] says.
pub fn append<T>(to: &mut Vec<T>, from: &mut Vec<T>) {
    if to.capacity() - to.len() < from.len() {
        to.reserve(from.len());
        *to = on_huge_pages(std::mem::take(to));
    }
    to.append(from);
}

/// Arrays from here on, in bytes, do not stay in the caches until somebody reads them.
const BEYOND_CACHES: usize = 16 << 20;

/// Stores that go past the caches.
///
/// A usual store fetches the line that it goes to, even if all of that is to be written over; and what a kernel loads waits
/// behind such stores. Kernels therefore compute parts of large arrays in small ones, and store these.
pub(crate) struct Stores {
    /// Until all is finished only the thread that stores is sure to see it.
    alone: PhantomData<*const ()>,
}

impl Stores {
    /// Runs `body`, which writes parts of an array of `bytes` bytes, by these stores if it is large. When this returns all
    /// threads see them.
    pub fn to_array_of<R>(bytes: usize, body: impl FnOnce(Option<&Stores>) -> R) -> R {
        match bytes < BEYOND_CACHES {
            true => body(None),
            false => body(Some(&Stores { alone: PhantomData })),
        }
    }

    /// [`slice::copy_from_slice`].
    ///
    /// # Panics
    /// If the lengths differ.
    #[inline]
    pub fn copy<T: Copy>(&self, to: &mut [T], from: &[T]) {
        assert_eq!(to.len(), from.len(), "slices of different lengths");
        // SAFETY: both slices have as many bytes; one that may be written overlaps no other; what may be copied may be
        // copied byte by byte.
        #[allow(unsafe_code)]
        unsafe {
            ffi::store_past_caches(to.as_mut_ptr().cast(), from.as_ptr().cast(), size_of_val(from));
        }
    }
}

impl Drop for Stores {
    fn drop(&mut self) {
        ffi::finish_stores();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_stored_is_seen_whatever_its_place_and_size() {
        let from: Vec<f32> = (0..103).map(|i| i as f32).collect();
        // Everywhere between two lines, and of every length up to several vectors.
        for (start, len) in (0..20).flat_map(|start| (0..50).map(move |len| (start, len))) {
            let mut to = vec![-1.0; 103];
            Stores::to_array_of(BEYOND_CACHES, |stores| {
                stores.unwrap().copy(&mut to[start..start + len], &from[3..3 + len])
            });
            let seen = std::thread::scope(|scope| scope.spawn(|| to.clone()).join().unwrap());
            let expected = (0..103).map(|i| match i {
                i if i < start || i >= start + len => -1.0,
                i => from[3 + i - start],
            });
            assert!(seen.into_iter().eq(expected), "{len} from {start} on");
        }
        assert!(Stores::to_array_of(BEYOND_CACHES - 1, |stores| stores.is_none()));
    }

    #[test]
    #[should_panic(expected = "slices of different lengths")]
    fn what_is_stored_must_fit() {
        Stores::to_array_of(BEYOND_CACHES, |stores| stores.unwrap().copy(&mut [0; 3], &[0; 4]));
    }

    #[test]
    fn values_are_those_of_the_standard_librarys_vectors() {
        let len = LARGE / size_of::<u32>() + 5;
        assert_eq!(zeros::<u32>(len), vec![0; len]);
        assert_eq!(zeros_to_fill::<u32>(len), vec![0; len]);
        assert_eq!(zeros_to_fill::<u32>(MAPPED / 4), vec![0; MAPPED / 4]);
        assert_eq!(filled(7u32, len), vec![7; len]);
        assert_eq!(collect((0..len).into_par_iter()), (0..len).collect::<Vec<_>>());
        let numbers: Vec<u32> = (0..len as u32).collect();
        assert_eq!(on_huge_pages(numbers.clone()), numbers);
        let (mut to, mut from) = (vec![1, 2], numbers.clone());
        append(&mut to, &mut from);
        assert_eq!((&to[..2], &to[2..], from.len()), (&[1, 2][..], &numbers[..], 0));
        reuse(&mut to, 1, 9);
        assert_eq!(to, [1]);
        reuse(&mut to, 4, 9);
        assert_eq!(to, [1, 9, 9, 9]);
        on_huge_pages(Vec::<u32>::new());
        on_huge_pages(vec![(); len]);
    }
}
