//! Nothing hidden: what an image can do beside what it is meant to, read from its machine code.
//!
//! | module | what lives there |
//! |---|---|
//! | `program` | an image as functions |
//! | `code` | whom a function calls, and how deep it takes the stack |
//! | `rules` | what the code does not tell, in `audit.toml` of a board package |
//! | `panics` | who calls the panic handler |
//! | `stack` | the bound on the stack |
//! | `unsafes` | `unsafe` in the sources, counted |
//!
//! The images are those that are flashed and run, not others built for the purpose.

mod program;
mod code;
mod rules;
mod panics;
mod stack;
mod unsafes;

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result};

use crate::boards::{self, Image};
use crate::snapshot::{self, Findings, Tolerance};
use crate::toolchain::Toolchain;

use code::{Reader, Summary};
use panics::Site;
use program::Program;
use rules::Rules;
use stack::{Bound, Graph};

/// Of the stack's memory, what the bound may take at most.
const SHARE: (u32, u32) = (3, 4);

#[derive(clap::Args)]
pub(crate) struct Options {
    /// Board packages; all of them if none is named
    packages: Vec<String>,
    /// Build the images once more with `-Z emit-stack-sizes`, and hold what is read from the code to what that says
    #[arg(long)]
    with_compiler: bool,
    /// Take what comes out as right
    #[arg(long)]
    bless: bool,
    /// Show every call of the panic handler and the deepest way
    #[arg(long, short)]
    verbose: bool,
}

/// What is found in an image.
struct Audit {
    sites: Vec<Site>,
    bound: Bound,
    available: u32,
    unclear: Vec<String>,
}

/// Audits the sources and all images. True if nothing is wrong.
pub(crate) fn run(options: &Options) -> Result<bool> {
    let toolchain = Toolchain::find()?;
    let mut good = unsafes::check(options.bless)?;
    // Frames as the compiler has them: a section that is not loaded, in images of their own.
    let flags: &[&str] = if options.with_compiler { &["-Zemit-stack-sizes"] } else { &[] };
    for image in boards::build_with(&toolchain, &options.packages, flags)? {
        let findings = check(&image, &toolchain, options)?;
        for line in findings.failures.iter().chain(&findings.notes) {
            println!("  {line}");
        }
        good &= findings.failures.is_empty();
    }
    Ok(good)
}

/// The bound on an image's stack; `None` if something is unclear, which [`run`] tells.
pub(crate) fn stack_bound(image: &Image) -> Result<Option<u32>> {
    let audit = audit(image, &rules(image)?)?;
    Ok(audit.unclear.is_empty().then(|| audit.bound.total()))
}

fn rules(image: &Image) -> Result<Rules> {
    Rules::read(&boards::folder().join(&image.package).join("audit.toml"))
}

fn audit(image: &Image, rules: &Rules) -> Result<Audit> {
    let bytes = std::fs::read(&image.elf).with_context(|| format!("cannot read {}", image.elf.display()))?;
    let program = Program::parse(&bytes).with_context(|| image.elf.display().to_string())?;
    let reader = Reader::new()?;
    let mut summaries: BTreeMap<u32, Summary> = BTreeMap::new();
    for function in program.functions() {
        summaries.insert(function.place.start, reader.summary(&program, function)?);
    }
    let mut unclear = Vec::new();
    for (address, summary) in &summaries {
        let said = program.said.get(address).copied().unwrap_or(0);
        if said > summary.frame {
            let name = program.function_at(*address).map_or("?", |function| &function.name);
            unclear.push(format!("{name}: {} bytes were found, the compiler says {said}", summary.frame));
        }
    }
    if !program.said.is_empty() {
        println!("{}: the compiler's word on {} functions compared", image.name, program.said.len());
    }
    let sites = panics::sites(&image.elf, &program, &summaries)?;
    let mut graph = Graph::new(&program, &summaries, rules);
    let bound = graph.bound(rules);
    let available = program.stack.end.saturating_sub(program.stack.start);
    unclear.append(&mut graph.unclear);
    Ok(Audit { sites, bound, available, unclear })
}

fn check(image: &Image, toolchain: &Toolchain, options: &Options) -> Result<Findings> {
    let rules = rules(image)?;
    let audit = audit(image, &rules)?;
    let (bound, mut findings) = (&audit.bound, Findings::default());
    let (mut known, mut unknown) = (BTreeMap::<&str, u32>::new(), 0);
    for site in &audit.sites {
        let fits = |rule: &&rules::Panic| {
            site.place.starts_with(&rule.place)
                && (!rule.joined || site.line.is_none())
                && rule.image.as_ref().is_none_or(|name| *name == image.name)
                && (rule.within.is_empty() || rule.within.iter().any(|name| site.function.contains(name)))
        };
        let shown = format!(
            "{}:{} in {} calls {}",
            site.place,
            site.line.map_or("?".to_owned(), |line| line.to_string()),
            site.function,
            site.calls
        );
        if options.verbose {
            println!("    {shown}");
        }
        match rules.panic.iter().find(fits) {
            Some(_) => *known.entry(&site.place).or_default() += 1,
            None => {
                unknown += 1;
                findings.failures.push(format!("may panic, and no rule allows it: {shown}"));
            }
        }
    }
    if options.verbose {
        for (name, bytes) in &bound.deepest {
            println!("    {bytes:6} {name}");
        }
        for (name, bytes) in &bound.handlers {
            println!("    {bytes:6} interrupt: {name}");
        }
    }
    println!(
        "{}: {} calls of the panic handler that a rule allows, {unknown} others; stack at most {} bytes ({} and {} of \
         interrupts) of {}",
        image.name,
        known.values().sum::<u32>(),
        bound.total(),
        bound.main,
        bound.interrupts(),
        audit.available
    );
    findings.failures.extend(audit.unclear.iter().map(|line| format!("no bound on the stack: {line}")));
    if u64::from(bound.total()) * u64::from(SHARE.1) > u64::from(audit.available) * u64::from(SHARE.0) {
        findings.failures.push(format!("the stack may take more than {}/{} of its memory", SHARE.0, SHARE.1));
    }
    let numbers: Vec<(String, f64)> =
        known.iter().map(|(place, &count)| (format!("panic calls in {place}"), f64::from(count))).collect();
    let stack = [
        ("stack of main".to_owned(), f64::from(bound.main)),
        ("stack of interrupts".to_owned(), f64::from(bound.interrupts())),
    ];
    let path = |extension: &str| snapshot_path(image, extension);
    let compiler = &toolchain.version;
    if options.bless {
        snapshot::bless_numbers(&path("panics"), compiler, &numbers)?;
        snapshot::bless_numbers(&path("stack"), compiler, &stack)?;
        return Ok(findings);
    }
    let numbers = numbers.into_iter().collect();
    snapshot::compare_numbers(&path("panics"), compiler, &numbers, Tolerance::EXACT, &mut findings)?;
    let tolerance = Tolerance { relative: 0.05, absolute: 64.0 };
    let stack = stack.into_iter().collect();
    snapshot::compare_numbers(&path("stack"), compiler, &stack, tolerance, &mut findings)?;
    Ok(findings)
}

fn snapshot_path(image: &Image, extension: &str) -> std::path::PathBuf {
    let folder: &Path = &boards::folder();
    folder.join(&image.package).join("snapshots").join(format!("{}.{extension}", image.name))
}
