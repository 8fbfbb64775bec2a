//! The C ABI of Formwork, for C++ programs that own an OpenSubdiv refiner and for other languages.
//!
//! `cpp/include/formwork/formwork.h` is made from it by cbindgen (`scripts/header`); the C++ classes beside that
//! header stand on it. All `unsafe` code is in [`abi`]: it turns pointers into slices and handles, and hands over to
//! [`hierarchy`] and [`stencils`], which are safe and use the public API of the library only.
//!
//! Conventions, the same for every function: objects are opaque and freed by the function named after them;
//! arrays belong to the caller, who asks for the counts first; results come through the last parameter; what is
//! returned is a status, and the message of an error is kept for the calling thread. Nothing unwinds into the
//! caller.

#![deny(unsafe_code)]
#![warn(missing_docs)]

#[allow(unsafe_code)]
pub mod abi;
pub mod error;
pub mod hierarchy;
pub mod records;
pub mod stencils;
