//! `make install`, and programs built against what it put there: the example by pkg-config and by CMake.

mod common;

use std::fs;
use std::path::Path;
use std::process::Command;

use common::{compiler, expect, install, installed, root, run};

const EXAMPLE: &str = "examples/cpp/one_form.cpp";

/// The example says what it found, and fails by itself if it is not exact.
fn assert_example(program: &Path, prefix: &Path) {
    let printed = expect(&run(program, prefix, &[]), EXAMPLE);
    assert!(
        printed.starts_with("3072 refined edges; slope of the height and refined slope differ by "),
        "{printed}"
    );
}

#[test]
fn the_example_by_pkg_config() {
    let (folder, prefix) = installed();
    let mut pkg_config = Command::new("pkg-config");
    pkg_config.env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig")).args(["--cflags", "--libs", "formwork"]);
    let flags = expect(&pkg_config.output().expect("run scripts/setup --test"), "pkg-config");
    let program = folder.path().join("one_form");
    let mut command = compiler();
    command.arg(root().join(EXAMPLE)).args(flags.split_whitespace()).arg("-o").arg(&program);
    expect(&command.output().unwrap(), EXAMPLE);
    assert_example(&program, &prefix);
}

/// The C++ of README.md, which shows the inside of a function.
#[test]
fn the_readme_compiles() {
    let (folder, prefix) = installed();
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let (_, rest) = readme.split_once("```cpp\n").unwrap();
    let (shown, _) = rest.split_once("```").unwrap();
    let (includes, body): (Vec<&str>, Vec<&str>) = shown.lines().partition(|line| line.starts_with('#'));
    let source = folder.path().join("readme.cpp");
    let text = format!(
        "{}\n#include <opensubdiv/osd/cpuEvaluator.h>\n#include <opensubdiv/osd/cpuVertexBuffer.h>\n\
         using namespace OpenSubdiv;\n\
         void Readme(Far::TopologyRefiner *refiner, Osd::CpuVertexBuffer *src, Osd::BufferDescriptor srcDesc,\n\
         Osd::CpuVertexBuffer *dst, Osd::BufferDescriptor dstDesc) {{\n{}\n}}\n",
        includes.join("\n"),
        body.join("\n")
    );
    fs::write(&source, text).unwrap();
    let mut command = compiler();
    command.args(["-fsyntax-only", "-I"]).arg(prefix.join("include")).arg(&source);
    expect(&command.output().unwrap(), "the C++ of README.md");
}

#[test]
fn the_example_by_cmake() {
    let (folder, prefix) = installed();
    let build = folder.path().join("build");
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(root().join("examples/cpp")).arg("-B").arg(&build);
    configure.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display()));
    expect(&configure.output().expect("run scripts/setup --test"), "cmake");
    expect(&Command::new("cmake").arg("--build").arg(&build).output().unwrap(), "cmake --build");
    // CMake leaves the way to the libraries in the program.
    let printed = expect(&Command::new(build.join("one_form")).output().unwrap(), EXAMPLE);
    assert!(printed.starts_with("3072 refined edges"), "{printed}");

    let other = folder.path().join("other");
    fs::create_dir(&other).unwrap();
    let project =
        "cmake_minimum_required(VERSION 3.16)\nproject(p CXX)\nfind_package(Formwork 0.2 REQUIRED)\n";
    fs::write(other.join("CMakeLists.txt"), project).unwrap();
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(&other).arg("-B").arg(other.join("build"));
    configure.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display()));
    assert!(!configure.output().unwrap().status.success(), "0.1 is not compatible with 0.2");
}

#[test]
fn destdir_goes_before_the_prefix_and_into_no_file() {
    let folder = tempfile::tempdir().unwrap();
    expect(&install(Path::new("/opt/formwork"), Some(folder.path())), "scripts/install");
    let under = |path: &str| folder.path().join("opt/formwork").join(path);
    for file in [
        "include/formwork/formwork.h",
        "include/formwork/formStencilTable.h",
        "lib/libformwork.so",
        "lib/cmake/Formwork/FormworkConfig.cmake",
    ] {
        assert!(under(file).exists(), "{file}");
    }
    let pc = fs::read_to_string(under("lib/pkgconfig/formwork.pc")).unwrap();
    assert!(pc.starts_with("prefix=/opt/formwork\n"), "{pc}");
    for file in ["lib/pkgconfig/formwork.pc", "lib/cmake/Formwork/FormworkConfig.cmake"] {
        let text = fs::read_to_string(under(file)).unwrap();
        assert!(!text.contains(folder.path().to_str().unwrap()) && !text.contains('@'), "{text}");
    }
}

#[test]
fn a_relative_prefix_is_refused() {
    let run = install(Path::new("here"), None);
    assert_eq!(run.status.code(), Some(1));
    assert_eq!(
        String::from_utf8_lossy(&run.stderr),
        "install: PREFIX is here: give a path that starts with /\n"
    );
}

#[test]
fn headers_stand_alone_in_c_and_cpp() {
    let (folder, prefix) = installed();
    for header in fs::read_dir(prefix.join("include/formwork")).unwrap() {
        let name = header.unwrap().file_name().into_string().unwrap();
        let source = folder.path().join("alone.cpp");
        fs::write(&source, format!("#include <formwork/{name}>\n#include <formwork/{name}>\n")).unwrap();
        let mut command = compiler();
        command.args(["-Wconversion", "-fsyntax-only", "-I"]).arg(prefix.join("include")).arg(&source);
        expect(&command.output().unwrap(), &name);
    }
    let source = folder.path().join("alone.c");
    fs::write(
        &source,
        "#include <formwork/formwork.h>\nint main(void) { return (int)formwork_last_error()[0]; }\n",
    )
    .unwrap();
    let mut command = Command::new("cc");
    command.args([
        "-std=c11",
        "-Wall",
        "-Wextra",
        "-Wpedantic",
        "-Wstrict-prototypes",
        "-Werror",
        "-fsyntax-only",
    ]);
    command.arg("-I").arg(prefix.join("include")).arg(&source);
    expect(&command.output().unwrap(), "formwork.h in C");
}
