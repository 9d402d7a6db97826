//! `unsafe` in the sources of the repository, counted by what it marks. That each has its argument is clippy's to check:
//! `undocumented_unsafe_blocks` is an error in every workspace.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};
use proc_macro2::{TokenStream, TokenTree};

use crate::snapshot::{self, Findings};
use crate::top;

/// Folders that hold no sources of ours.
const SKIPPED: [&str; 4] = ["target", ".git", "node_modules", ".venv"];

/// Counts, and compares with what was blessed. True if nothing changed.
pub(super) fn check(bless: bool) -> Result<bool> {
    let mut lines = Vec::new();
    let mut total = 0;
    for path in sources(&top())? {
        let text =
            std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let counts = count(&text).with_context(|| path.display().to_string())?;
        if !counts.is_empty() {
            let shown = path.strip_prefix(top()).unwrap_or(&path).display().to_string();
            let kinds: Vec<_> = counts.iter().map(|(kind, number)| format!("{number} {kind}")).collect();
            total += counts.values().sum::<u32>();
            lines.push(format!("{shown}: {}", kinds.join(", ")));
        }
    }
    println!("unsafe: {total} in {} files", lines.len());
    let snapshot = top().join("docs/unsafe.txt");
    if bless {
        snapshot::bless(&snapshot, &lines.iter().map(|line| format!("{line}\n")).collect::<String>())?;
        return Ok(true);
    }
    let mut findings = Findings::default();
    snapshot::compare_lines(&snapshot, &lines, &mut findings)?;
    for line in &findings.failures {
        println!("  unsafe in the sources changed: {line}");
    }
    Ok(findings.failures.is_empty())
}

/// All sources below a folder, in order.
fn sources(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let entries = std::fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))?;
    let mut entries: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    entries.sort();
    for path in entries {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if path.is_dir() && !path.is_symlink() {
            if !SKIPPED.contains(&&*name) {
                found.extend(sources(&path)?);
            }
        } else if name.ends_with(".rs") {
            found.push(path);
        }
    }
    Ok(found)
}

/// Counts `unsafe` by the word that follows it.
fn count(text: &str) -> Result<BTreeMap<&'static str, u32>> {
    let tokens: TokenStream = text.parse().map_err(|error| anyhow!("cannot be read: {error}"))?;
    let mut counts = BTreeMap::new();
    count_in(tokens, &mut counts);
    Ok(counts)
}

fn count_in(tokens: TokenStream, counts: &mut BTreeMap<&'static str, u32>) {
    let mut tokens = tokens.into_iter().peekable();
    while let Some(token) = tokens.next() {
        match token {
            TokenTree::Group(group) => count_in(group.stream(), counts),
            TokenTree::Ident(word) if word == "unsafe" => {
                let kind = match tokens.peek() {
                    Some(TokenTree::Ident(next)) if next == "impl" => "impl",
                    Some(TokenTree::Ident(next)) if next == "fn" || next == "extern" => "fn",
                    Some(TokenTree::Ident(next)) if next == "trait" => "trait",
                    Some(TokenTree::Group(group)) if group.delimiter() == proc_macro2::Delimiter::Brace => {
                        "block"
                    }
                    _ => "attribute",
                };
                *counts.entry(kind).or_default() += 1;
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_counted_and_not_what_only_speaks_of_them() {
        let text = r##"
            //! unsafe in a comment
            #![forbid(unsafe_code)]
            #[unsafe(no_mangle)]
            unsafe extern "C" fn f() { let _ = "unsafe { }"; unsafe { g() } }
            unsafe impl Sync for X {}
        "##;
        let counts = count(text).unwrap();
        assert_eq!(counts, [("attribute", 1), ("block", 1), ("fn", 1), ("impl", 1)].into());
    }
}
