//! The building's floors (ARCHITECTURE.md): every import in `src` points down, or left on its own floor.
//!
//! The sources are read as tokens, not compiled: each `crate::x`, `crate::{x, ..}` and each `super::` that
//! climbs to the crate's root names a top-level module, and that module must come earlier in [`FLOORS`].

use std::fs;
use std::path::{Path, PathBuf};

/// The floors from the ground up; a module may use those of lower floors and those on its left.
const FLOORS: &[&[&str]] = &[
    &["memory", "sparse", "symbol", "topology", "osd"], // 0
    &["cochain", "field", "io"],                        // 1
    &["scheme"],                                        // 2
    &["hierarchy", "octet"],                            // 3
    &["limit"],                                         // 4
    &["laws", "analysis", "fem", "design"],             // 5
    &["view"],                                          // 6
];

/// Longest source file, in lines. Long tests live in `tests/`, or in a `tests.rs` of their module.
const MAX_LINES: usize = 400;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Every Rust file under a folder, with its text.
fn sources(folder: &Path) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            found.push((path, text));
        }
    }
    found
}

fn rank(module: &str) -> Option<usize> {
    FLOORS.iter().flat_map(|floor| floor.iter()).position(|&m| m == module)
}

/// The module path of a file under `src`: `topology/mod.rs` is `[topology]`, `io/obj.rs` is `[io, obj]`.
fn module_of(file: &Path) -> Vec<String> {
    let mut path: Vec<String> =
        file.with_extension("").iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if path.last().is_some_and(|last| last == "mod" || last == "lib") {
        path.pop();
    }
    path
}

/// Identifiers, `::` and single characters of Rust source, without comments, literals and lifetimes.
fn tokens(source: &str) -> Vec<String> {
    let chars: Vec<char> = source.chars().collect();
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    let is_word = |c: char| c == '_' || c.is_alphanumeric();
    let (mut tokens, mut i) = (Vec::new(), 0);
    while i < chars.len() {
        let start = i;
        let mut raw = i + 1;
        while at(raw) == '#' {
            raw += 1;
        }
        if at(i) == '/' && at(i + 1) == '/' {
            while i < chars.len() && at(i) != '\n' {
                i += 1;
            }
        } else if at(i) == '/' && at(i + 1) == '*' {
            let mut depth = 0;
            loop {
                match (at(i), at(i + 1)) {
                    ('/', '*') => (depth, i) = (depth + 1, i + 2),
                    ('*', '/') => (depth, i) = (depth - 1, i + 2),
                    _ => i += 1,
                }
                if depth == 0 || i >= chars.len() {
                    break;
                }
            }
        } else if at(i) == 'r' && at(raw) == '"' {
            let hashes = raw - i - 1;
            i = raw + 1;
            while i < chars.len() && !(at(i) == '"' && (1..=hashes).all(|k| at(i + k) == '#')) {
                i += 1;
            }
            i += 1 + hashes;
        } else if at(i) == '"' {
            i += 1;
            while i < chars.len() && at(i) != '"' {
                i += if at(i) == '\\' { 2 } else { 1 };
            }
            i += 1;
        } else if at(i) == '\'' && (at(i + 1) == '\\' || at(i + 2) == '\'') {
            i += if at(i + 1) == '\\' { 3 } else { 2 };
            while i < chars.len() && at(i) != '\'' {
                i += 1;
            }
            i += 1;
        } else if is_word(at(i)) {
            while is_word(at(i)) {
                i += 1;
            }
            tokens.push(chars[start..i].iter().collect());
        } else if at(i) == ':' && at(i + 1) == ':' {
            tokens.push("::".into());
            i += 2;
        } else {
            if !at(i).is_whitespace() {
                tokens.push(at(i).into());
            }
            i += 1;
        }
    }
    tokens
}

/// The first names of what follows a path's `::`: one name, or those of a braced group.
fn first_names(tokens: &[String]) -> Vec<String> {
    if tokens.first().is_none_or(|t| t != "{") {
        return tokens.first().cloned().into_iter().collect();
    }
    let (mut names, mut depth) = (Vec::new(), 0);
    for (i, token) in tokens.iter().enumerate() {
        match token.as_str() {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ if depth == 1 && (tokens[i - 1] == "," || tokens[i - 1] == "{") => names.push(token.clone()),
            _ => {}
        }
        if depth == 0 {
            break;
        }
    }
    names
}

/// The top-level names that a module's source uses, by `crate::` or by enough `super::`.
fn imports(module: &[String], source: &str) -> Vec<String> {
    let tokens = tokens(source);
    let is = |i: usize, text: &str| tokens.get(i).is_some_and(|t| t == text);
    let (mut used, mut depth, mut inline, mut i) = (Vec::new(), 0, Vec::new(), 0);
    while i < tokens.len() {
        match tokens[i].as_str() {
            "{" => depth += 1,
            "}" => {
                depth -= 1;
                if inline.last() == Some(&depth) {
                    inline.pop();
                }
            }
            "mod" if is(i + 2, "{") => inline.push(depth),
            "crate" if is(i + 1, "::") => used.extend(first_names(&tokens[i + 2..])),
            "super" if is(i + 1, "::") => {
                let mut climbed = 1;
                while is(i + 2, "super") && is(i + 3, "::") {
                    (climbed, i) = (climbed + 1, i + 2);
                }
                if climbed == module.len() + inline.len() {
                    used.extend(first_names(&tokens[i + 2..]));
                }
            }
            _ => {}
        }
        i += 1;
    }
    used
}

/// What is wrong with a file's imports, if anything.
fn violations(file: &Path, source: &str) -> Vec<String> {
    let module = module_of(file);
    let Some(own) = module.first() else { return Vec::new() }; // lib.rs only declares the modules
    let Some(floor) = rank(own) else { return vec![format!("{own} has no floor in tests/layering.rs")] };
    imports(&module, source)
        .into_iter()
        .filter(|used| used != own)
        .filter(|used| rank(used).is_none_or(|r| r > floor))
        .map(|used| format!("{} uses {used}, which is not below it", file.display()))
        .collect()
}

fn library() -> Vec<(PathBuf, String)> {
    let src = root().join("src");
    sources(&src)
        .into_iter()
        .map(|(path, text)| (path.strip_prefix(&src).unwrap().to_path_buf(), text))
        .filter(|(path, _)| !path.starts_with("bin"))
        .collect()
}

#[test]
fn imports_point_down() {
    let found: Vec<String> = library().iter().flat_map(|(file, text)| violations(file, text)).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn upward_imports_are_seen() {
    let bad = |file: &str, source: &str| violations(Path::new(file), source).len();
    assert_eq!(bad("topology/mesh.rs", "use crate::sparse::Csr;"), 0);
    assert_eq!(bad("topology/mesh.rs", "use crate::{sparse::Csr, osd::{Level, a::b}, scheme};"), 2);
    assert_eq!(bad("io/obj.rs", "fn f(h: &crate::hierarchy::Hierarchy) {}"), 1);
    assert_eq!(bad("sparse.rs", "use super::topology::Mesh;"), 1);
    assert_eq!(bad("io/obj.rs", "use super::super::scheme;"), 1);
    assert_eq!(bad("io/obj.rs", "use super::glb::Scene; use super::super::cochain::Cochain;"), 0);
    assert_eq!(bad("sparse.rs", "mod tests { use super::*; fn f() { super::super::laws::measure(); } }"), 1);
    assert_eq!(
        bad("sparse.rs", "// crate::laws\n/* crate::laws */ \"crate::laws\"; r#\"\"crate::laws\"#; '\"';"),
        0
    );
    assert_eq!(bad("sparse.rs", "const A: &'static str = \"\"; const Q: char = '\\''; use crate::laws;"), 1);
    assert_eq!(bad("sparse.rs", "use crate::Hierarchy;"), 1, "a re-export at the root hides its floor");
    assert_eq!(bad("cellar.rs", ""), 1, "a module without a floor");
}

/// The command line is a user of the library like any other: its own modules and `formwork::`, no file of
/// the library taken in by path. (The C ABI cannot be anything else: it is a crate of its own.)
#[test]
fn the_roof_uses_the_public_api() {
    for (path, text) in sources(&root().join("src")) {
        let tokens = tokens(&text);
        let by_path = tokens.windows(3).any(|t| t[0] == "#" && t[1] == "[" && t[2] == "path");
        assert!(!by_path, "{} takes in a module by path", path.display());
        if path.starts_with(root().join("src/bin")) {
            let bridged = tokens.windows(2).any(|t| t[0] == "cxx" || (t[0] == "include" && t[1] == "!"));
            assert!(!bridged, "{} reaches past the library", path.display());
        } else {
            let above = tokens.iter().any(|t| t == "clap" || t == "indicatif");
            assert!(!above, "{} does the command line's work", path.display());
        }
    }
}

/// Three bridges: down to OpenSubdiv, down to the system's memory, and up to the programs that call the C ABI.
#[test]
fn unsafe_code_stays_in_the_bridges() {
    for (path, text) in sources(&root().join("src")).into_iter().chain(sources(&root().join("capi/src"))) {
        let bridges = ["src/osd/bridge.rs", "src/memory.rs", "capi/src/abi.rs", "capi/src/abi/stencils.rs"];
        let is_bridge = bridges.iter().any(|bridge| path.ends_with(bridge));
        assert!(is_bridge || !tokens(&text).iter().any(|t| t == "unsafe"), "unsafe in {}", path.display());
    }
}

#[test]
fn files_are_short() {
    for (path, text) in sources(&root().join("src")).into_iter().chain(sources(&root().join("capi/src"))) {
        let lines = text.lines().count();
        let is_test = path.ends_with("tests.rs");
        assert!(is_test || lines <= MAX_LINES, "{} has {lines} lines: split it", path.display());
    }
}

#[test]
fn the_architecture_names_every_module() {
    let lib = fs::read_to_string(root().join("src/lib.rs")).unwrap();
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let declared: Vec<String> =
        tokens(&lib).windows(3).filter(|t| t[0] == "mod" && t[2] == ";").map(|t| t[1].clone()).collect();
    assert!(!declared.is_empty());
    for module in &declared {
        assert!(rank(module).is_some(), "{module} has no floor in tests/layering.rs");
        assert!(text.contains(&format!("`{module}`")), "ARCHITECTURE.md does not name `{module}`");
    }
    for module in FLOORS.iter().flat_map(|floor| floor.iter()) {
        assert!(declared.iter().any(|m| m == module), "floor module {module} is not in src/lib.rs");
    }
}
