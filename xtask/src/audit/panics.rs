//! Who calls the panic handler, and from which line of which source.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use addr2line::Loader;
use anyhow::{Result, anyhow};

use super::code::Summary;
use super::program::Program;
use crate::top;

/// A call that ends in the panic handler.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Site {
    /// Source: a path in this repository, or a crate's name.
    pub(super) place: String,
    /// Line, if the debug information has one.
    pub(super) line: Option<u32>,
    /// The function that it is in, after inlining.
    pub(super) function: String,
    /// What it calls.
    pub(super) calls: String,
}

/// The handler, as compilers name it.
const HANDLER: &str = "rust_begin_unwind";

/// Every call from outside of the panic machinery into it. There is none if the image has no panic handler.
pub(super) fn sites(elf: &Path, program: &Program, summaries: &BTreeMap<u32, Summary>) -> Result<Vec<Site>> {
    let name = |address: u32| program.function_at(address).map_or("?", |function| function.name.as_str());
    let mut machinery: BTreeSet<u32> = program
        .functions()
        .filter(|function| function.name.ends_with(HANDLER))
        .map(|function| function.place.start)
        .collect();
    loop {
        let more: Vec<u32> = summaries
            .iter()
            .filter(|(address, summary)| {
                !machinery.contains(address)
                    && is_machinery(name(**address))
                    && summary.calls.iter().any(|(_, target)| machinery.contains(target))
            })
            .map(|(&address, _)| address)
            .collect();
        if more.is_empty() {
            break;
        }
        machinery.extend(more);
    }
    let loader =
        Loader::new(elf).map_err(|error| anyhow!("debug information of {}: {error}", elf.display()))?;
    let mut sites = Vec::new();
    for (address, summary) in summaries.iter().filter(|(address, _)| !machinery.contains(address)) {
        for &(at, target) in summary.calls.iter().filter(|(_, target)| machinery.contains(target)) {
            let (place, line) = source(&loader, at, name(*address))?;
            sites.push(Site {
                place,
                line,
                function: name(*address).to_owned(),
                calls: name(target).to_owned(),
            });
        }
    }
    sites.sort();
    Ok(sites)
}

/// A function of `core` that does nothing but panic.
fn is_machinery(name: &str) -> bool {
    name.starts_with("core::") && (name.contains("panic") || name.contains("_fail"))
}

/// Crates whose functions panic for what their caller does.
const STANDARD: [&str; 5] = ["core", "alloc", "compiler_builtins", "critical-section", "embedded-io"];

/// The innermost source that the instruction comes from, other than those of [`STANDARD`].
fn source(loader: &Loader, at: u32, function: &str) -> Result<(String, Option<u32>)> {
    let mut frames = loader.find_frames(u64::from(at)).map_err(|error| anyhow!("{at:#x}: {error}"))?;
    while let Some(frame) = frames.next().map_err(|error| anyhow!("{at:#x}: {error}"))? {
        let Some(location) = frame.location else { continue };
        let Some(file) = location.file else { continue };
        let line = location.line.filter(|&line| line != 0);
        let place = place(file, &top());
        if !STANDARD.contains(&place.as_str()) {
            return Ok((place, line));
        }
    }
    // Inlined without a trace of where: the function's own crate.
    Ok((function.trim_start_matches('<').split(':').next().unwrap_or("?").to_owned(), None))
}

/// A path in the repository, or the name of a crate.
fn place(file: &str, top: &Path) -> String {
    let parts: Vec<&str> = file.split('/').collect();
    let after = |name: &str, skip: usize| {
        parts.iter().position(|&part| part == name).and_then(|at| parts.get(at + skip)).copied()
    };
    let unversioned = |name: &str| {
        let end = name.char_indices().find(|&(at, _)| {
            let rest = &name[at..];
            rest.starts_with('-') && rest[1..].starts_with(|digit: char| digit.is_ascii_digit())
        });
        end.map_or(name, |(at, _)| &name[..at]).to_owned()
    };
    if let Some(name) = after("registry", 3) {
        return unversioned(name);
    }
    if let Some(name) = after("library", 1) {
        return name.to_owned();
    }
    // What a crate's build script made: `…/build/NAME-HASH/out/…`.
    if let (true, Some(name)) = (parts.contains(&"out"), after("build", 1)) {
        return name.rsplit_once('-').map_or(name, |(name, _)| name).to_owned();
    }
    let path = Path::new(file);
    path.strip_prefix(top).unwrap_or(path).display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_paths_here_and_names_of_crates_elsewhere() {
        let place = |file| place(file, Path::new("/w"));
        assert_eq!(place("/w/firmware/src/link/stuffing.rs"), "firmware/src/link/stuffing.rs");
        assert_eq!(
            place("/home/u/.cargo/registry/src/index-1/embassy-stm32-0.6.0/src/rcc.rs"),
            "embassy-stm32"
        );
        assert_eq!(place("/usr/lib/rustlib/src/rust/library/core/src/cell.rs"), "core");
        let made = "/w/firmware/boards/target/t/release/build/embassy-stm32-f23/out/_generated.rs";
        assert_eq!(place(made), "embassy-stm32");
    }

    #[test]
    fn what_only_panics_is_told_by_its_name() {
        for name in [
            "core::panicking::panic_fmt",
            "core::option::unwrap_failed",
            "core::cell::panic_already_borrowed",
        ] {
            assert!(is_machinery(name), "{name}");
        }
        assert!(!is_machinery("core::fmt::write") && !is_machinery("firmware::driver::failed"));
    }
}
