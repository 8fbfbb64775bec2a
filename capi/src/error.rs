//! Statuses, messages, and the wall that nothing unwinds through.

use std::cell::RefCell;
use std::ffi::{CStr, CString};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What a call came to.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormworkStatus {
    /// It did what it says.
    Ok = 0,
    /// The arguments are at fault, or the mesh; `formwork_last_error` says how, and what to do.
    InvalidArgument = 1,
    /// Formwork itself is at fault; `formwork_last_error` says where. Please report it.
    Internal = 2,
}

/// The message for an argument, a mesh or a refiner that cannot be used.
#[derive(Debug)]
pub struct Invalid(pub String);

/// Any error of the library: what reaches the user of the C ABI is its message.
impl<E: std::error::Error> From<E> for Invalid {
    fn from(error: E) -> Self {
        Invalid(error.to_string())
    }
}

thread_local! {
    static LAST: RefCell<CString> = RefCell::default();
}

/// The message of the last call on this thread that failed; empty if none did.
pub fn last() -> *const std::ffi::c_char {
    LAST.with_borrow(|message| CStr::as_ptr(message))
}

/// Runs a call, keeps the message if it fails, and lets no panic through.
pub fn guard(call: impl FnOnce() -> Result<(), Invalid>) -> FormworkStatus {
    // What a call leaves behind when it panics is not used again: results are written last.
    let (status, message) = match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(())) => return FormworkStatus::Ok,
        Ok(Err(Invalid(message))) => (FormworkStatus::InvalidArgument, message),
        Err(panic) => {
            let said = panic.downcast_ref::<String>().cloned();
            let said = said.or_else(|| panic.downcast_ref::<&str>().map(|&text| text.to_owned()));
            (FormworkStatus::Internal, format!("internal error: {}", said.unwrap_or_default()))
        }
    };
    let message = CString::new(message.replace('\0', " ")).unwrap_or_default();
    LAST.with_borrow_mut(|last| *last = message);
    status
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_a_status() {
        assert_eq!(guard(|| Err(Invalid("no\0".into()))), FormworkStatus::InvalidArgument);
        LAST.with_borrow(|message| assert_eq!(message.as_c_str(), c"no "));
        assert_eq!(guard(|| panic!("row {}", 3)), FormworkStatus::Internal);
        LAST.with_borrow(|message| assert_eq!(message.as_c_str(), c"internal error: row 3"));
        assert_eq!(guard(|| Ok(())), FormworkStatus::Ok);
        LAST.with_borrow(|message| assert!(!message.is_empty(), "kept until the next failure"));
    }
}
