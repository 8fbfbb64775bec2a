//! Many assets, each in a process of its own, so that whatever one does leaves the others alone.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use formwork::io::{atomic, companion};
use indicatif::ProgressBar;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::{Outcome, count};
use crate::Failure;
use crate::args::Batch;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Manifest {
    /// Options of `formwork subdivide`, for every asset.
    #[serde(default)]
    options: Vec<String>,
    assets: Vec<Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    mesh: PathBuf,
    output: PathBuf,
    field: Option<PathBuf>,
    /// More options, for this asset.
    #[serde(default)]
    options: Vec<String>,
}

/// What is written beside each output.
#[derive(Serialize, Deserialize)]
struct Report {
    mesh: PathBuf,
    output: PathBuf,
    /// `done` or `failed`.
    status: String,
    /// SHA-256 of everything that decides the outcome.
    inputs: String,
    /// The files written, each with its SHA-256.
    written: Vec<(PathBuf, String)>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
    /// What `formwork subdivide --json` said.
    #[serde(skip_serializing_if = "Option::is_none")]
    report: Option<Value>,
    seconds: f64,
}

enum Done {
    Now(Report),
    Before(Report),
}

pub fn run(args: &Batch) -> Result<Outcome, Failure> {
    let name = args.manifest.display();
    let text =
        fs::read(&args.manifest).map_err(|error| format!("{name}: cannot be read ({error}): check it"))?;
    let manifest: Manifest = serde_json::from_slice(&text).map_err(|error| {
        format!("{name}: {error}: write {{\"assets\": [{{\"mesh\": .., \"output\": ..}}, ..]}}")
    })?;
    let mut outputs = HashSet::new();
    for (i, entry) in manifest.assets.iter().enumerate() {
        if !outputs.insert(&entry.output) {
            let output = entry.output.display();
            return Err(format!(
                "{name}: assets[{i}]: another asset writes {output} too: choose another name"
            )
            .into());
        }
    }
    let folder = args.manifest.parent().unwrap_or(Path::new("")).to_owned();
    let (shard, shards) = args.shard;
    let mine: Vec<&Entry> = manifest.assets.iter().skip(shard - 1).step_by(shards).collect();

    let bar = match args.quiet || args.json {
        true => ProgressBar::hidden(),
        false => ProgressBar::new(mine.len() as u64),
    };
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..args.jobs.min(mine.len()) {
            scope.spawn(|| {
                loop {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    let Some(entry) = mine.get(i) else { break };
                    let asset = Asset { folder: &folder, entry, common: &manifest.options, jobs: args.jobs };
                    let result = asset.process();
                    bar.inc(1);
                    if let Ok(mut done) = done.lock() {
                        done.push((i, result));
                    }
                }
            });
        }
    });
    bar.finish_and_clear();
    let mut done = done.into_inner().unwrap_or_default();
    done.sort_by_key(|(i, _)| *i);
    Ok(outcome(args, &done))
}

fn outcome(args: &Batch, done: &[(usize, Done)]) -> Outcome {
    let (mut unchanged, mut failures, mut text) = (0, Vec::new(), String::new());
    for (_, done) in done {
        let report = match done {
            Done::Now(report) => report,
            Done::Before(report) => {
                unchanged += 1;
                report
            }
        };
        if let Some(error) = &report.error {
            text += &format!("failed: {error}\n");
            failures.push(json!({ "mesh": report.mesh, "output": report.output, "error": error }));
        }
    }
    let (shard, shards) = args.shard;
    let good = done.len() - failures.len() - unchanged;
    text += &format!(
        "{}, shard {shard} of {shards}: {good} done, {unchanged} unchanged, {} failed\n",
        count(done.len(), "asset"),
        failures.len()
    );
    let json = json!({
        "command": "batch",
        "manifest": args.manifest.display().to_string(),
        "shard": format!("{shard}/{shards}"),
        "assets": done.len(),
        "done": good,
        "unchanged": unchanged,
        "failed": failures.len(),
        "failures": failures,
    });
    Outcome { text, json, notes: Vec::new(), holds: failures.is_empty() }
}

/// An entry and what it takes to process it.
struct Asset<'a> {
    /// Paths are relative to the folder of the manifest.
    folder: &'a Path,
    entry: &'a Entry,
    common: &'a [String],
    jobs: usize,
}

impl Asset<'_> {
    fn process(&self) -> Done {
        let start = Instant::now();
        let inputs = self.inputs();
        let report_path = self.report_path();
        let before: Option<Report> =
            fs::read(&report_path).ok().and_then(|text| serde_json::from_slice(&text).ok());
        if let Some(before) = before.filter(|before| self.is_current(before, &inputs)) {
            return Done::Before(before);
        }
        let mut report = Report {
            mesh: self.entry.mesh.clone(),
            output: self.entry.output.clone(),
            status: "done".to_owned(),
            inputs,
            written: Vec::new(),
            error: None,
            report: None,
            seconds: 0.0,
        };
        match self.subdivide() {
            Ok(said) => {
                for path in said["written"].as_array().into_iter().flatten().filter_map(Value::as_str) {
                    let path = PathBuf::from(path);
                    let hash = hash_of(&self.folder.join(&path)).unwrap_or_default();
                    report.written.push((path, hash));
                }
                report.report = Some(said);
            }
            Err(error) => {
                report.status = "failed".to_owned();
                report.error = Some(error);
            }
        }
        report.seconds = start.elapsed().as_secs_f64();
        let write = || -> Result<(), Failure> {
            let text = serde_json::to_vec_pretty(&report)?;
            Ok(atomic::write(&report_path, |out| std::io::Write::write_all(out, &text))?)
        };
        if let Err(error) = write() {
            report.status = "failed".to_owned();
            report.error.get_or_insert(format!("{}: no report: {error}", self.entry.mesh.display()));
        }
        Done::Now(report)
    }

    fn report_path(&self) -> PathBuf {
        let mut name = self.folder.join(&self.entry.output).into_os_string();
        name.push(".report.json");
        name.into()
    }

    /// Whether nothing has changed since a report was written.
    fn is_current(&self, before: &Report, inputs: &str) -> bool {
        let as_written =
            |(path, hash): &(PathBuf, String)| hash_of(&self.folder.join(path)).as_ref() == Some(hash);
        before.status == "done"
            && before.inputs == inputs
            && before.written.first().is_some_and(|(path, _)| *path == self.entry.output)
            && before.written.iter().all(as_written)
    }

    /// A hash of this program's version, the options, and the contents of the files that are read.
    fn inputs(&self) -> String {
        let mut hash = Sha256::new();
        let mut add = |part: &[u8]| {
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part);
        };
        add(env!("CARGO_PKG_VERSION").as_bytes());
        for option in self.options() {
            add(option.as_bytes());
        }
        let files =
            [Some(self.entry.mesh.clone()), companion(&self.entry.mesh, false), self.entry.field.clone()];
        for file in files.into_iter().flatten() {
            // What cannot be read is reported by the process that needs it.
            add(hash_of(&self.folder.join(file)).unwrap_or_default().as_bytes());
        }
        hex(&hash.finalize())
    }

    fn options(&self) -> impl Iterator<Item = &String> {
        self.common.iter().chain(&self.entry.options)
    }

    /// Runs `formwork subdivide` on the entry. What it said, or why it failed.
    fn subdivide(&self) -> Result<Value, String> {
        let fail = |what: String| format!("{}: {what}", self.entry.mesh.display());
        if let Some(parent) = self.folder.join(&self.entry.output).parent() {
            fs::create_dir_all(parent).map_err(|error| fail(format!("{}: {error}", parent.display())))?;
        }
        let program = std::env::current_exe().map_err(|error| fail(error.to_string()))?;
        let mut command = Command::new(program);
        if self.folder != Path::new("") {
            command.current_dir(self.folder);
        }
        command.args(["subdivide", "--json", "-o"]).arg(&self.entry.output);
        if let Some(field) = &self.entry.field {
            command.arg("--field").arg(field);
        }
        command.args(self.options()).arg("--").arg(&self.entry.mesh);
        if self.jobs > 1 && std::env::var_os("RAYON_NUM_THREADS").is_none() {
            let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
            command.env("RAYON_NUM_THREADS", (cores / self.jobs).max(1).to_string());
        }
        let run = command.output().map_err(|error| fail(format!("no process ({error})")))?;
        let stderr = String::from_utf8_lossy(&run.stderr);
        match run.status.code() {
            Some(0) => serde_json::from_slice(&run.stdout).map_err(|error| fail(error.to_string())),
            Some(2) => {
                let said = stderr.lines().last().unwrap_or_default();
                let said = said.strip_prefix("formwork: ").unwrap_or(said).to_owned();
                let named = said.contains(&*self.entry.mesh.to_string_lossy());
                Err(if named { said } else { fail(said) })
            }
            _ => Err(fail(format!(
                "the process ended with {}: {}",
                run.status,
                stderr.lines().last().unwrap_or("it said nothing")
            ))),
        }
    }
}

fn hash_of(path: &Path) -> Option<String> {
    let mut hash = Sha256::new();
    std::io::copy(&mut fs::File::open(path).ok()?, &mut hash).ok()?;
    Some(hex(&hash.finalize()))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
