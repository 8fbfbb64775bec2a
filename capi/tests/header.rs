//! The C header that is checked in is the one that cbindgen makes of this crate. `scripts/header` writes it anew.

use std::fs;
use std::path::Path;
use std::process::Command;

#[test]
fn the_header_is_that_of_the_crate() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let header = here.join("../cpp/include/formwork/formwork.h");
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap().join("header");
    let run = Command::new(env!("CARGO"))
        .args(["run", "--quiet", "--locked", "--manifest-path"])
        .arg(here.join("header/Cargo.toml"))
        .arg("--target-dir")
        .arg(target)
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let (made, kept) = (String::from_utf8(run.stdout).unwrap(), fs::read_to_string(&header).unwrap());
    assert!(made == kept, "{} is out of date: run scripts/header", header.display());
}
