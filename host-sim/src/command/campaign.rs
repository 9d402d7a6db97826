use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;
use rayon::prelude::*;

use super::{Outcome, progress};
use crate::campaign::{CaseResult, Header, Pictures, Plan, Reliability, Shard, Table, merge, run, write};
use crate::picture;
use crate::report::campaign_junit;

/// Options of `campaign`.
#[derive(Debug, Args)]
pub struct Campaign {
    /// Seeds a class of faults; the profiles take turns
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    seeds: u64,
    /// The first seed
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=1 << 40))]
    seed_base: u64,
    /// Traces without a fault; ten times the seeds if not given
    #[arg(long)]
    clean: Option<u64>,
    /// Classes of faults, with commas; all that show in a trace if not given
    #[arg(long, value_name = "KIND,…", value_delimiter = ',')]
    faults: Vec<String>,
    /// Profiles, with commas; all built-in ones if not given
    #[arg(long, value_name = "PROFILE,…", value_delimiter = ',')]
    profiles: Vec<String>,
    /// A folder of photographs for the sensors to look at, beside the test card
    #[arg(long, value_name = "DIR")]
    pictures: Option<PathBuf>,
    /// Only part I of N
    #[arg(long, value_name = "I/N")]
    shard: Option<String>,
    /// The results, a JSON object a line
    #[arg(short, long, value_name = "RESULTS.jsonl")]
    output: Option<PathBuf>,
    #[command(flatten)]
    tables: Tables,
}

/// Options of `merge`.
#[derive(Debug, Args)]
pub struct Merge {
    /// The shards, in any order
    #[arg(required = true)]
    results: Vec<PathBuf>,
    /// All results in one file, the same as one process writes
    #[arg(short, long, value_name = "RESULTS.jsonl")]
    output: Option<PathBuf>,
    #[command(flatten)]
    tables: Tables,
}

/// What is done with the table.
#[derive(Debug, Args)]
struct Tables {
    /// A text file that holds the tables between their marks; a difference is an error
    #[arg(long, value_name = "FILE.md")]
    table: Option<PathBuf>,
    /// Writes the tables there instead
    #[arg(long, requires = "table")]
    bless: bool,
    /// Prints the curve from score to confidence that these results ask for (`host-sim/src/diagnosis/calibration.rs`)
    #[arg(long)]
    fit: bool,
    /// Writes JUnit XML for a CI: a test case for each class of faults
    #[arg(long, value_name = "FILE.xml")]
    junit: Option<PathBuf>,
}

impl Campaign {
    pub(super) fn run(&self) -> anyhow::Result<Outcome> {
        let mut plan = Plan::new(self.seeds, self.seed_base);
        if !self.faults.is_empty() {
            plan = plan.with_faults(self.faults.iter().map(String::as_str))?;
        }
        if !self.profiles.is_empty() {
            plan.profiles.clone_from(&self.profiles);
        }
        plan.clean = self.clean.unwrap_or(plan.clean);
        let shard: Shard = self.shard.as_deref().map_or(Ok(Shard::WHOLE), str::parse)?;
        if shard != Shard::WHOLE
            && (self.output.is_none() || self.tables.table.is_some() || self.tables.junit.is_some())
        {
            bail!("a shard has no table of its own; write it with `-o RESULTS.jsonl`, then `host-sim merge`");
        }
        let pictures = self.pictures.as_deref().map(Pictures::open).transpose()?.unwrap_or_default();
        let mut cases = Vec::new();
        for number in (0..plan.cases()).filter(|number| shard.holds(*number)) {
            cases.push(plan.case(number)?);
        }
        let bar = progress::cases("campaign", cases.len() as u64);
        let results: Vec<CaseResult> = cases
            .par_iter()
            .map(|case| {
                let result = run(case, &pictures);
                bar.inc(1);
                result
            })
            .collect();
        bar.finish_and_clear();
        let header = Header { campaign: plan, pictures: pictures.checksum(), shard };
        if let Some(output) = &self.output {
            write(output, &header, &results)?;
        }
        if shard == Shard::WHOLE { self.tables.show(&results) } else { Ok(Outcome::Fine) }
    }
}

impl Merge {
    pub(super) fn run(&self) -> anyhow::Result<Outcome> {
        let (header, results) = merge(&self.results)?;
        if let Some(output) = &self.output {
            write(output, &header, &results)?;
        }
        self.tables.show(&results)
    }
}

impl Tables {
    fn show(&self, results: &[CaseResult]) -> anyhow::Result<Outcome> {
        let table = Table::of(results);
        println!("{table}");
        for short in table.shortfalls() {
            println!("short: {short}");
        }
        if let Some(path) = &self.junit {
            picture::write_raw(path, campaign_junit(results, &table.shortfalls())?.as_bytes())?;
        }
        let reliability = Reliability::of(results);
        println!("\n{reliability}");
        if self.fit {
            let curve: Vec<String> =
                reliability.curve().iter().map(|(score, share)| format!("({score:?}, {share:?})")).collect();
            println!("\nconst CURVE: &[(f64, f64)] = &[{}];", curve.join(", "));
        }
        if let Some(path) = &self.table {
            self.compare(path, "campaign", &table.to_string())?;
            self.compare(path, "reliability", &reliability.to_string())?;
        }
        Ok(if table.shortfalls().is_empty() { Outcome::Fine } else { Outcome::Fault })
    }

    /// Holds a table against the one between two marks of a text file, or puts it there.
    fn compare(&self, path: &Path, mark: &str, table: &str) -> anyhow::Result<()> {
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        let (begin, end) = (format!("<!-- {mark} -->"), format!("<!-- end of {mark} -->"));
        let marks = text.split_once(&begin).and_then(|(head, rest)| Some((head, rest.split_once(&end)?)));
        let Some((head, (held, tail))) = marks else {
            bail!("{}: no table between `{begin}` and `{end}`", path.display())
        };
        let table = format!("\n{table}\n");
        if self.bless {
            let blessed = format!("{head}{begin}{table}{end}{tail}");
            return Ok(picture::write_raw(path, blessed.as_bytes())?);
        }
        if held != table {
            bail!(
                "{}: its table of the {mark} is another one; look at the difference, and say --bless if it is better",
                path.display()
            );
        }
        Ok(())
    }
}
