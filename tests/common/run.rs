//! Runs the `formwork` binary as a user does.

use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use serde_json::Value;

pub fn fixture(name: &str) -> String {
    format!("{}/tests/fixtures/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// Runs `formwork ARGS` in `folder`.
pub fn formwork(folder: &Path, args: &[&str]) -> Output {
    Command::cargo_bin("formwork").unwrap().args(args).current_dir(folder).output().unwrap()
}

/// Its stdout; it must succeed without a word on stderr.
#[track_caller]
pub fn succeed(folder: &Path, args: &[&str]) -> String {
    let run = formwork(folder, args);
    let stderr = String::from_utf8(run.stderr).unwrap();
    assert_eq!((run.status.code(), stderr.as_str()), (Some(0), ""), "formwork {}", args.join(" "));
    String::from_utf8(run.stdout).unwrap()
}

/// Its stdout as one JSON object.
#[track_caller]
pub fn object(folder: &Path, args: &[&str]) -> Value {
    serde_json::from_str(&succeed(folder, args)).unwrap()
}

#[track_caller]
pub fn json_file(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

pub fn keys(object: &Value) -> Vec<&str> {
    object.as_object().unwrap().keys().map(String::as_str).collect()
}

pub fn numbers(array: &Value) -> Vec<f64> {
    array.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

pub fn scratch() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}
