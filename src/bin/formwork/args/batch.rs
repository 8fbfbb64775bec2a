use std::path::PathBuf;

pub const HELP: &str = "\
The manifest; paths are relative to its folder:
  {\"options\": [\"--levels\", \"2\"],
   \"assets\": [{\"mesh\": \"a.obj\", \"output\": \"out/a.usda\"},
              {\"mesh\": \"b.usdc\", \"output\": \"out/b.glb\", \"field\": \"b.json\",
               \"options\": [\"--prim\", \"/World/B\"]}]}
Options are those of `formwork subdivide`, first for all assets, then for one.

Each asset is a process of its own: one that fails leaves the others alone. For
each output X there is a report X.report.json. An asset whose files, options and
outputs are as its report says is not done again, so a run that was stopped goes
on where it was. Exit code 1: some assets failed, and are named.

Examples:
  formwork batch assets/batch.json
  formwork batch assets/batch.json --shard 2/2 --jobs 2 --json";

#[derive(Debug, clap::Args)]
pub struct Batch {
    /// What to do, as JSON
    #[arg(value_name = "MANIFEST.json")]
    pub manifest: PathBuf,
    /// Only the i-th of N parts, i from 1 to N: one each for N machines
    #[arg(long, value_name = "i/N", default_value = "1/1", value_parser = shard)]
    pub shard: (usize, usize),
    /// How many assets at a time
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = jobs)]
    pub jobs: usize,
    /// Print one JSON object on stdout
    #[arg(long)]
    pub json: bool,
    /// No progress bar
    #[arg(long, short)]
    pub quiet: bool,
}

/// `2/5`.
fn shard(typed: &str) -> Result<(usize, usize), String> {
    let parts = typed.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    parts.filter(|&(i, n)| 1 <= i && i <= n).ok_or_else(|| "write i/N with i from 1 to N".to_owned())
}

fn jobs(typed: &str) -> Result<usize, String> {
    typed.parse().ok().filter(|jobs| (1..=1024).contains(jobs)).ok_or_else(|| "write 1 to 1024".to_owned())
}
