//! Compiles the C++ side of the bridge and links OpenSubdiv.
//!
//! OpenSubdiv is looked for under `OPENSUBDIV_ROOT` (its `include` and `lib` folders), else where the
//! compiler looks by itself. Debian's package has neither a pkg-config file nor a working CMake file, so
//! the library is linked by name.

use std::env;
use std::path::PathBuf;
use std::process::exit;

fn main() {
    println!("cargo:rerun-if-env-changed=OPENSUBDIV_ROOT");
    let bridges = ["src/osd/bridge.rs", "src/memory.rs"];
    let sources = ["cpp/refiner.cpp", "cpp/evaluate.cpp", "cpp/bfr.cpp", "cpp/memory.cpp"];
    let headers = ["cpp/refiner.h", "cpp/bfr.h", "cpp/memory.h"];
    for file in ["build.rs"].iter().chain(&bridges).chain(&headers).chain(&sources) {
        println!("cargo:rerun-if-changed={file}");
    }

    let root = env::var_os("OPENSUBDIV_ROOT").map(PathBuf::from);
    let mut build = cxx_build::bridges(bridges);
    build.files(sources).include(".").std("c++17");
    // OpenSubdiv's headers hold assertions that its release library was built without.
    build.define("NDEBUG", None);
    let include = root.as_ref().map(|root| root.join("include"));
    if let Some(include) = &include {
        build.include(include);
    }

    let version = "opensubdiv/version.h";
    let searched: Vec<PathBuf> = match &include {
        Some(include) => vec![include.clone()],
        None => ["/usr/include", "/usr/local/include"].map(PathBuf::from).into(),
    };
    if !searched.iter().any(|folder| folder.join(version).exists()) && env::var_os("CPATH").is_none() {
        eprintln!(
            "OpenSubdiv 3.5 or later was not found: no {version} in {searched:?}.\n\
             On Debian or Ubuntu: apt-get install libosd-dev g++ (or run scripts/setup).\n\
             Elsewhere: build it and set OPENSUBDIV_ROOT to the folder that holds its include and lib."
        );
        exit(1);
    }
    if let Some(root) = &root {
        println!("cargo:rustc-link-search=native={}", root.join("lib").display());
    }
    build.compile("formwork-osd");
    println!("cargo:rustc-link-lib=dylib=osdCPU");
}
