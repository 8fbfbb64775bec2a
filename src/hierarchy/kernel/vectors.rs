//! Kernels compiled for the vectors of newer processors.

use pulp::{Arch, Simd, WithSimd};

/// A part of a kernel. Its `run` and all that it calls must be `#[inline(always)]`: what stays a call is compiled for the
/// oldest processors.
pub trait Part {
    fn run(self);
}

/// Runs a part as compiled for the vectors that this processor has. Sums and products are rounded one by one on all of
/// them, so that no digit depends on it.
pub fn run(part: impl Part) {
    struct Op<P>(P);
    impl<P: Part> WithSimd for Op<P> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            self.0.run();
        }
    }
    Arch::new().dispatch(Op(part));
}
