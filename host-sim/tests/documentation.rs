//! The pages of the project: each link leads somewhere, and each command of `host-sim` is one that it takes.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Component, Path, PathBuf};

use clap::{Command as Parser, Subcommand as _};
use host_sim::command::Command;
use host_sim::profile::Profile;

/// All pages, by their path from the top: those at the top, those of `docs/`, and those of packages.
fn pages() -> BTreeMap<PathBuf, String> {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut pages = BTreeMap::new();
    for folder in ["", "docs", "inspector", "tests", "bench", "fuzz"] {
        for entry in std::fs::read_dir(top.join(folder)).into_iter().flatten() {
            let name = entry.unwrap().file_name();
            let path = Path::new(folder).join(name);
            if path.extension().is_some_and(|extension| extension == "md") {
                pages.insert(path.clone(), std::fs::read_to_string(top.join(path)).unwrap());
            }
        }
    }
    assert!(pages.len() > 20, "{pages:?}");
    pages
}

/// The lines of a page with whether each stands in a block of code; the fences are left out.
fn lines(page: &str) -> impl Iterator<Item = (bool, &str)> {
    let mut in_code = false;
    page.lines().filter_map(move |line| {
        let is_fence = line.trim_start().starts_with("```");
        in_code ^= is_fence;
        (!is_fence).then_some((in_code, line))
    })
}

/// The targets of a line's links and pictures.
fn links(line: &str) -> impl Iterator<Item = &str> {
    line.split("](").skip(1).filter_map(|rest| rest.split([')', ' ']).next())
}

/// The names by which the headings of a page can be linked to, as GitHub makes them.
fn anchors(page: &str) -> Vec<String> {
    let mut anchors: Vec<String> = Vec::new();
    for (_, line) in lines(page).filter(|(in_code, _)| !in_code) {
        let Some(heading) = line.strip_prefix('#').map(|rest| rest.trim_start_matches('#')) else { continue };
        let Some(text) = heading.strip_prefix(' ') else { continue };
        let kept = text.trim().to_lowercase();
        let kept = kept.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        let name: String = kept.map(|c| if c == ' ' { '-' } else { c }).collect();
        let same = anchors.iter().filter(|other| **other == name).count();
        anchors.push(if same == 0 { name } else { format!("{name}-{same}") });
    }
    anchors
}

/// A path without `..` within it.
fn tidy(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut so_far, part| {
        if part != Component::ParentDir || !so_far.pop() {
            so_far.push(part);
        }
        so_far
    })
}

#[test]
fn links_lead_somewhere() {
    let (top, pages) = (Path::new(env!("CARGO_MANIFEST_DIR")).join(".."), pages());
    let mut wrong = Vec::new();
    for (path, page) in &pages {
        for (_, line) in lines(page).filter(|(in_code, _)| !in_code) {
            for link in links(line).filter(|link| !link.contains("://")) {
                let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
                let target = match file {
                    "" => path.clone(),
                    _ => tidy(&path.parent().unwrap_or(Path::new("")).join(file)),
                };
                let named = pages.get(&target).map(|page| anchors(page));
                let is_there = top.join(&target).exists()
                    && (anchor.is_empty()
                        || named.is_some_and(|named| named.iter().any(|name| name == anchor)));
                if !is_there {
                    wrong.push(format!("{}: {link}", path.display()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "links that lead nowhere: {wrong:#?}");
}

/// The words of a command as a shell would part them; what follows two blanks, a pipe or a `#` is left out.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    let mut characters = line.chars().peekable();
    while let Some(character) = characters.next() {
        match (quote, character) {
            (Some(open), _) if character == open => quote = None,
            (None, '\'' | '"') => {
                quote = Some(character);
                word.get_or_insert_default();
            }
            (None, '|' | '#') => break,
            (None, ' ') => {
                words.extend(word.take());
                if characters.peek() == Some(&' ') {
                    break;
                }
            }
            (_, '\\') if quote != Some('\'') => word.get_or_insert_default().extend(characters.next()),
            _ => word.get_or_insert_default().push(character),
        }
    }
    words.extend(word);
    words
}

#[test]
fn commands_are_parted_as_by_a_shell() {
    let parted = words(r#"host-sim process "a b.png" --op 'gray|box' x\|y        what it does"#);
    assert_eq!(parted, ["host-sim", "process", "a b.png", "--op", "gray|box", "x|y"]);
}

#[test]
fn commands_are_taken() {
    const CALLS: [&str; 3] = ["host-sim ", "cargo sim ", "cargo run --release -p host-sim -- "];
    let parser = Command::augment_subcommands(Parser::new("host-sim"));
    let (mut count, mut wrong) = (0, Vec::new());
    for (path, page) in pages() {
        for (_, line) in lines(&page).filter(|(in_code, _)| *in_code) {
            let line = line.trim().trim_start_matches("- run: ");
            // A line with an ellipsis, or with what may be left out, is a pattern.
            let Some(call) = CALLS.iter().find_map(|call| line.strip_prefix(call)) else { continue };
            if call.contains('…') || call.contains(" [") {
                continue;
            }
            let words = words(call);
            count += 1;
            let arguments =
                std::iter::once("host-sim").chain(words.iter().map(String::as_str)).map(OsString::from);
            if let Err(error) = parser.clone().try_get_matches_from(arguments) {
                wrong.push(format!("{}: {call}: {error}", path.display()));
            }
            let names = words.iter().zip(words.iter().skip(1)).filter(|(option, _)| *option == "--profile");
            for (_, name) in names.filter(|(_, name)| *name != "auto" && !name.ends_with(".toml")) {
                if let Err(error) = Profile::find(name) {
                    wrong.push(format!("{}: {call}: {error}", path.display()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "commands that host-sim does not take: {wrong:#?}");
    assert!(count > 30, "only {count} commands were found");
}
