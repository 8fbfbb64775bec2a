//! The programs of others that our files are held against: `scripts/clients` installs them under the build
//! folder.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use serde_json::Value;

/// Where the clients are; `None`, having said so, if they are not there and a registry cannot be reached.
pub fn clients() -> Option<&'static Path> {
    static FOLDER: OnceLock<Option<PathBuf>> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
        let script = root().join("scripts/clients");
        let run = Command::new(script).env("CARGO_TARGET_DIR", target).output().unwrap();
        let stderr = String::from_utf8_lossy(&run.stderr).into_owned();
        match run.status.code() {
            Some(0) => Some(PathBuf::from(String::from_utf8(run.stdout).unwrap().trim())),
            Some(75) => None,
            _ => panic!("scripts/clients: {}\n{stderr}", run.status),
        }
    });
    if folder.is_none() {
        eprintln!(
            "skipped: PyPI or npm cannot be reached, so usd-core, Dask, gltf-validator and playwright-core are missing"
        );
    }
    folder.as_deref()
}

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Runs a script of `tests/clients`, or any other below the root, with the Python that has the clients.
pub fn python(clients: &Path, script: &str, args: &[&Path]) -> Output {
    Command::new(clients.join("venv/bin/python")).arg(root().join(script)).args(args).output().unwrap()
}

/// Opens stages with Pixar's library: its errors, and what it found, for each.
#[track_caller]
pub fn check_usd(clients: &Path, files: &[&Path]) -> Vec<Value> {
    let run = python(clients, "tests/clients/usd_check.py", files);
    let reports = lines(&run);
    assert_eq!(reports.len(), files.len(), "{}", String::from_utf8_lossy(&run.stderr));
    reports
}

/// Has Khronos' validator look at files.
#[track_caller]
pub fn check_gltf(clients: &Path, files: &[&Path]) -> Vec<Value> {
    let script = root().join("tests/clients/gltf_check.mjs");
    let node = clients.join("venv/bin/node");
    let run =
        Command::new(node).arg(script).arg(clients.join("npm/node_modules")).args(files).output().unwrap();
    let reports = lines(&run);
    assert_eq!(reports.len(), files.len(), "{}", String::from_utf8_lossy(&run.stderr));
    reports
}

/// Works the page of `formwork view` in a browser: what happened, on a desktop and on a telephone, or in a brief look on a
/// desktop.
#[track_caller]
pub fn check_view(clients: &Path, page: &Path, extent: &str) -> Vec<Value> {
    let browser = std::env::var_os("FORMWORK_CHROMIUM").unwrap_or("chromium".into());
    let run = Command::new(clients.join("venv/bin/node"))
        .arg(root().join("tests/clients/view_check.mjs"))
        .arg(clients.join("npm/node_modules"))
        .arg(which(&browser).unwrap_or_else(|| panic!("no {}: run scripts/setup --test", browser.display())))
        .arg(page)
        .arg(extent)
        .args(std::env::var_os("FORMWORK_SHOTS"))
        .output()
        .unwrap();
    let reports = lines(&run);
    let windows = if extent == "brief" { 1 } else { 2 };
    assert_eq!(reports.len(), windows, "{}", String::from_utf8_lossy(&run.stderr));
    reports
}

/// A program, by its path or found on the search path.
fn which(program: &std::ffi::OsStr) -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).map(|folder| folder.join(program)).find(|file| file.is_file())
}

fn lines(run: &Output) -> Vec<Value> {
    let text = String::from_utf8(run.stdout.clone()).unwrap();
    text.lines()
        .filter(|line| line.starts_with('{'))
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}
