//! What README.md and the pages in docs/ show, run: their commands, then the README's SciPy reader on what they
//! wrote. The Rust examples are documentation tests.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The code blocks of README.md in a language.
fn blocks(language: &str) -> Vec<String> {
    blocks_of(&fs::read_to_string(root().join("README.md")).unwrap(), language)
}

/// The code blocks of a page in a language.
fn blocks_of(page: &str, language: &str) -> Vec<String> {
    let mut blocks = Vec::new();
    let mut rest = page;
    while let Some(start) = rest.find("\n```") {
        let (tag, body) = rest[start + 4..].split_once('\n').unwrap();
        let end = body.find("```").unwrap();
        if tag == language {
            blocks.push(body[..end].to_owned());
        }
        rest = &body[end + 3..];
    }
    blocks
}

/// A folder in which the commands of the README can run: the assets are there.
fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("assets")).unwrap();
    for entry in fs::read_dir(root().join("assets")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            fs::copy(&path, folder.path().join("assets").join(path.file_name().unwrap())).unwrap();
        }
    }
    folder
}

fn run(program: &Path, arguments: &[&str], folder: &Path) -> String {
    let output = Command::new(program).args(arguments).current_dir(folder).output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{} {arguments:?}: {}\n{stderr}", program.display(), output.status);
    String::from_utf8(output.stdout).unwrap()
}

/// Runs each `formwork` line of the README; returns the number of lines.
fn run_commands(folder: &Path) -> usize {
    run_lines(&blocks("sh"), folder)
}

/// Runs each `formwork` line of some blocks; returns the number of lines.
fn run_lines(blocks: &[String], folder: &Path) -> usize {
    let blocks = blocks.concat();
    let commands: Vec<&str> = blocks.lines().filter_map(|line| line.strip_prefix("formwork ")).collect();
    for command in &commands {
        let arguments: Vec<&str> = command.split_whitespace().collect();
        run(Path::new(env!("CARGO_BIN_EXE_formwork")), &arguments, folder);
    }
    commands.len()
}

/// The pages of the book, by name, in the order of its summary.
fn pages() -> Vec<(String, String)> {
    let folder = root().join("docs/src");
    let summary = fs::read_to_string(folder.join("SUMMARY.md")).unwrap();
    let names = summary.split("](").skip(1).map(|rest| rest.split(')').next().unwrap().to_owned());
    names.map(|name| (name.clone(), fs::read_to_string(folder.join(name)).unwrap())).collect()
}

/// Every page of the book is in its summary, its commands run where the README's do, and its Rust examples are
/// documentation tests.
#[test]
fn the_book_runs() {
    let pages = pages();
    // What the README shows too is run there.
    let known = blocks("sh").concat();
    let library = fs::read_to_string(root().join("src/lib.rs")).unwrap();
    let mut commands = 0;
    for (name, text) in &pages {
        let folder = workplace();
        let shell = blocks_of(text, "sh");
        let stray = shell.iter().flat_map(|block| block.lines()).find(|line| !line.starts_with("formwork "));
        assert_eq!(stray, None, "{name}: a line that is not run");
        let new: Vec<String> = shell
            .concat()
            .lines()
            .filter(|line| !known.lines().any(|same| same == *line))
            .map(|line| format!("{line}\n"))
            .collect();
        run_lines(&new, folder.path());
        commands += shell.concat().lines().count();
        let tested = library.contains(&format!("docs/src/{name}"));
        assert_eq!(tested, text.contains("```rust"), "{name}: its Rust examples in src/lib.rs");
        for language in text.split("\n```").skip(1).step_by(2).map(|rest| rest.lines().next().unwrap()) {
            assert!(["sh", "rust", "text", "json"].contains(&language), "{name}: a block of `{language}`");
        }
        for link in text.split("](").skip(1).map(|rest| rest.split([')', '#']).next().unwrap()) {
            let is_file =
                link.is_empty() || link.starts_with("http") || root().join("docs/src").join(link).exists();
            assert!(is_file, "{name} links to {link}, which is not there");
        }
    }
    assert!(commands >= 30, "{commands} commands");
    let written = fs::read_dir(root().join("docs/src")).unwrap();
    let files = written.filter(|f| f.as_ref().unwrap().path().extension().is_some_and(|e| e == "md")).count();
    assert_eq!(files, pages.len() + 1, "a page is not in SUMMARY.md");
    for page in ["from-opensubdiv.md", "from-usd.md", "from-a-paper.md"] {
        let (_, text) = pages.iter().find(|(name, _)| name == page).unwrap();
        assert!(!blocks_of(text, "sh").is_empty(), "{page} ends in a running example");
    }
}

#[test]
fn commands_run() {
    let folder = workplace();
    assert!(run_commands(folder.path()) >= 4);
    assert_eq!(&fs::read(folder.path().join("box.glb")).unwrap()[..4], b"glTF");
}

/// The line that README.md quotes is one that the command still ends with, but for its rounding error.
#[test]
fn the_number_is_printed() {
    let printed = run(
        Path::new(env!("CARGO_BIN_EXE_formwork")),
        &["validate", "assets/creased_box.obj", "--levels", "3"],
        root(),
    );
    // The number is the word before the comma.
    let without_number = |line: &str| -> Vec<String> {
        line.split_whitespace().filter(|word| !word.ends_with(',')).map(str::to_owned).collect()
    };
    let last = printed.lines().last().unwrap();
    let quoted = blocks("text");
    let quoted = quoted[0].trim();
    assert_eq!(without_number(last), without_number(quoted), "\nprinted: {last}\nREADME: {quoted}");
}

#[test]
fn scipy_reads_the_operators() {
    let python = std::env::var_os("FORMWORK_PYTHON").map_or(root().join(".venv/bin/python"), PathBuf::from);
    assert!(python.exists(), "no {}: run scripts/setup --test", python.display());
    let folder = workplace();
    let commands = blocks("sh").concat();
    let writes = commands.lines().filter(|line| line.starts_with("formwork operators "));
    assert_eq!(run_lines(&writes.map(|line| format!("{line}\n")).collect::<Vec<_>>(), folder.path()), 1);
    let reader = &blocks("python")[0];
    // The same laws on each level, and the shapes that --help promises.
    let checks = "
for l in (1, 2):
    before = [matrix(npz, f'l{l - 1}/{m}') for m in ('d0', 'd1')]
    after = [matrix(npz, f'l{l}/{m}') for m in ('d0', 'd1')]
    S = [matrix(npz, f'l{l}/S{k}') for k in (0, 1, 2)]
    for k in (0, 1):
        assert abs(after[k] @ S[k] - S[k + 1] @ before[k]).max() < 1e-12, (l, k)
    assert abs(S[2].sum(axis=0) - 1).max() < 1e-12
    assert npz[f'l{l}/edges'].shape == (S[1].shape[0], 2)
    assert npz[f'l{l}/face_sizes'].sum() == len(npz[f'l{l}/face_vertices'])
    kinds = numpy.bincount(npz[f'l{l}/vertex_parent_kind'], minlength=3)
    assert tuple(kinds) == (before[0].shape[1], before[0].shape[0], before[1].shape[0])
    assert len(npz[f'l{l}/vertex_parent_index']) == S[0].shape[0]
";
    let printed = run(&python, &["-c", &format!("{reader}{checks}")], folder.path());
    let deviation: f64 = printed.trim().parse().unwrap();
    assert!(deviation < 1e-12, "the README's reader printed {deviation}");
}
