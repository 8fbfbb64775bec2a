//! What the tests of the C++ API share: an installed Formwork, and a compiler.
#![allow(dead_code)] // each test binary uses its own part

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The folder of the checkout.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// The shared library that cargo made for this run of the tests.
pub fn library() -> PathBuf {
    let library = std::env::current_exe().unwrap().with_file_name("libformwork_capi.so");
    assert!(library.exists(), "cargo made no {}", library.display());
    library
}

/// Runs `scripts/install` with that library.
pub fn install(prefix: &Path, destdir: Option<&Path>) -> Output {
    let mut script = Command::new(root().join("scripts/install"));
    script.env("PREFIX", prefix).env("FORMWORK_LIBRARY", library()).env_remove("DESTDIR");
    script.envs(destdir.map(|folder| ("DESTDIR", folder)));
    script.output().unwrap()
}

/// A fresh folder with Formwork installed in its `prefix`.
pub fn installed() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let prefix = folder.path().join("prefix");
    expect(&install(&prefix, None), "scripts/install");
    (folder, prefix)
}

/// A C++ compiler, with the warnings that our headers must not raise.
pub fn compiler() -> Command {
    let compiler = std::env::var_os("CXX").unwrap_or_else(|| "c++".into());
    let mut command = Command::new(compiler);
    command.args(["-std=c++14", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]);
    command
}

/// Compiles a program of this crate, such as `tests/cpp/evaluate`, against an installed Formwork.
pub fn compile(folder: &Path, prefix: &Path, source: &str, flags: &[&str], libraries: &[&str]) -> PathBuf {
    let source = root().join("capi").join(source).with_extension("cpp");
    let program = folder.join(source.file_stem().unwrap());
    let mut command = compiler();
    command.args(flags).arg("-I").arg(prefix.join("include")).arg("-o").arg(&program);
    command.arg(&source);
    command.arg("-L").arg(prefix.join("lib"));
    if let Some(opensubdiv) = std::env::var_os("OPENSUBDIV_ROOT").map(PathBuf::from) {
        command.arg("-isystem").arg(opensubdiv.join("include")).arg("-L").arg(opensubdiv.join("lib"));
    }
    command.arg("-lformwork").args(libraries).arg("-losdCPU");
    expect(&command.output().unwrap(), &source.display().to_string());
    program
}

/// Runs a program that was linked with an installed Formwork.
pub fn run(program: &Path, prefix: &Path, arguments: &[&Path]) -> Output {
    run_with(program, prefix, arguments, &[])
}

/// [`run`] with more variables in the environment.
pub fn run_with(program: &Path, prefix: &Path, arguments: &[&Path], environment: &[(&str, &str)]) -> Output {
    let mut folders = vec![prefix.join("lib")];
    folders.extend(std::env::var_os("OPENSUBDIV_ROOT").map(|root| Path::new(&root).join("lib")));
    folders.extend(std::env::var_os("LD_LIBRARY_PATH").iter().flat_map(std::env::split_paths));
    let path = std::env::join_paths(folders).unwrap();
    let mut command = Command::new(program);
    command.args(arguments).env("LD_LIBRARY_PATH", path).envs(environment.iter().copied());
    // Idle OpenMP threads would spin, in the way of the other tests.
    command.env("OMP_WAIT_POLICY", "passive").output().unwrap()
}

/// The standard output of a program that must have succeeded.
#[track_caller]
pub fn expect(output: &Output, what: &str) -> String {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{what}: {}\n{stderr}", output.status);
    String::from_utf8(output.stdout.clone()).unwrap()
}
