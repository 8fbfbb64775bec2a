//! The C ABI from a language without headers: Python's ctypes and numpy.

mod common;

use std::path::PathBuf;
use std::process::Command;

use common::{expect, library, root};

#[test]
fn numpy_gets_operators_through_ctypes() {
    let python = std::env::var_os("FORMWORK_PYTHON").map_or(root().join(".venv/bin/python"), PathBuf::from);
    assert!(python.exists(), "no {}: run scripts/setup --test", python.display());
    let script = root().join("examples/ctypes_stencils.py");
    let printed =
        expect(&Command::new(python).arg(script).arg(library()).output().unwrap(), "ctypes_stencils.py");
    let worst: f64 = printed.split_whitespace().last().unwrap().parse().unwrap();
    assert!(printed.starts_with("192 edges from 12") && worst < 1e-14, "{printed}");
}
