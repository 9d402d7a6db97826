//! What was blessed, and how a run compares with it.
//!
//! | file | holds | compared |
//! |---|---|---|
//! | `NAME.out` | the messages of a run | exactly |
//! | `NAME.size` | flash and RAM | may not grow by more than 2 % and 256 bytes |
//! | `NAME.cost` | numbers that a run measured | none may rise at all: counting is exact |
//! | `NAME.stack` | the bound on the stack | may not grow by more than 5 % and 64 bytes |
//! | `NAME.panics` | calls of the panic handler, by source | none may rise at all |
//!
//! Sizes and costs are a compiler's as well as ours: they stand under its name, `# rustc 1.96.0`, and those of a compiler
//! that nobody has blessed with are not compared.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Context, Result};

/// What a comparison found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Findings {
    /// Worse than what was blessed.
    pub(crate) failures: Vec<String>,
    /// Better, or not comparable.
    pub(crate) notes: Vec<String>,
}

/// Numbers by their names.
pub(crate) type Numbers = BTreeMap<String, f64>;

/// How much a number may rise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tolerance {
    pub(crate) relative: f64,
    pub(crate) absolute: f64,
}

impl Tolerance {
    /// Not at all.
    pub(crate) const EXACT: Self = Self { relative: 0.0, absolute: 0.0 };
}

/// Compares lines exactly.
pub(crate) fn compare_lines(path: &Path, lines: &[String], findings: &mut Findings) -> Result<()> {
    let Some(blessed) = read(path)? else {
        findings.failures.push(format!("{} is not there: bless", path.display()));
        return Ok(());
    };
    let mut expected = blessed.lines();
    for (index, line) in lines.iter().enumerate() {
        let wanted = expected.next();
        if wanted != Some(line.as_str()) {
            let wanted = wanted.unwrap_or("nothing more");
            findings.failures.push(format!("line {}: `{line}`, blessed was `{wanted}`", index + 1));
            return Ok(());
        }
    }
    if let Some(wanted) = expected.next() {
        findings.failures.push(format!("ends before `{wanted}`"));
    }
    Ok(())
}

/// Compares numbers that may fall but not rise.
pub(crate) fn compare_numbers(
    path: &Path,
    compiler: &str,
    numbers: &Numbers,
    tolerance: Tolerance,
    findings: &mut Findings,
) -> Result<()> {
    let Some(text) = read(path)? else {
        if !numbers.is_empty() {
            findings.failures.push(format!("{} is not there: bless", path.display()));
        }
        return Ok(());
    };
    let Some(blessed) = sections(&text).remove(compiler) else {
        findings.notes.push(format!("nobody has blessed {} with {compiler}: not compared", path.display()));
        return Ok(());
    };
    let blessed: Numbers = blessed.into_iter().collect();
    for (name, &number) in numbers {
        let Some(&before) = blessed.get(name) else {
            findings.failures.push(format!("{name} is new, {number}: bless"));
            continue;
        };
        let allowed = before * (1.0 + tolerance.relative) + tolerance.absolute;
        if number > allowed {
            findings.failures.push(format!("{name} rose from {before} to {number}"));
        } else if number < before {
            findings.notes.push(format!("{name} fell from {before} to {number}: bless"));
        }
    }
    for name in blessed.keys().filter(|name| !numbers.contains_key(*name)) {
        findings.failures.push(format!("{name} is gone"));
    }
    Ok(())
}

/// Says so, once and aloud, if sizes and costs of this compiler cannot be compared because nobody has blessed with it.
pub(crate) fn say_if_unblessed(folder: &Path, compiler: &str) -> Result<()> {
    let mut known = BTreeSet::new();
    for entry in std::fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "size") {
            known.extend(sections(&read(&path)?.unwrap_or_default()).into_keys());
        }
    }
    if !known.contains(compiler) {
        let known: Vec<_> = known.iter().map(String::as_str).collect();
        println!(
            "NOTE: sizes and costs are NOT compared: they were blessed with {}, and this is {compiler}. CAMIF_RUSTC names \
             another compiler.",
            known.join(" and ")
        );
    }
    Ok(())
}

/// Takes numbers as right for this compiler; those of others stay.
pub(crate) fn bless_numbers(path: &Path, compiler: &str, numbers: &[(String, f64)]) -> Result<()> {
    let text = read(path)?.unwrap_or_default();
    let mut sections = sections(&text);
    sections.insert(compiler.to_owned(), numbers.to_vec());
    let mut text = String::new();
    for (compiler, numbers) in sections {
        text += &format!("# {compiler}\n");
        text.extend(numbers.iter().map(|(name, number)| format!("{name} {number}\n")));
    }
    bless(path, &text)
}

/// Each compiler's numbers, in the order of the file.
fn sections(text: &str) -> BTreeMap<String, Vec<(String, f64)>> {
    let mut sections: BTreeMap<String, Vec<(String, f64)>> = BTreeMap::new();
    let mut compiler = "nobody";
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("# ") {
            compiler = name;
            sections.entry(compiler.to_owned()).or_default();
        } else if let Some((name, number)) = line.rsplit_once(' ')
            && let Ok(number) = number.parse()
        {
            sections.entry(compiler.to_owned()).or_default().push((name.to_owned(), number));
        }
    }
    sections
}

fn read(path: &Path) -> Result<Option<String>> {
    match std::fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error).with_context(|| format!("cannot read {}", path.display())),
    }
}

/// Writes a file whole or not at all; nothing if it stands there already.
pub(crate) fn bless(path: &Path, text: &str) -> Result<()> {
    if read(path)?.as_deref() == Some(text) {
        return Ok(());
    }
    let folder = path.parent().context("a snapshot lies in a folder")?;
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let temporary = path.with_extension("temporary");
    std::fs::write(&temporary, text).with_context(|| format!("cannot write {}", temporary.display()))?;
    std::fs::rename(&temporary, path).with_context(|| format!("cannot write {}", path.display()))?;
    println!("  blessed {}", path.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE_PER_CENT: Tolerance = Tolerance { relative: 0.01, absolute: 0.0 };

    fn numbers(pairs: &[(&str, f64)]) -> Vec<(String, f64)> {
        pairs.iter().map(|&(name, number)| (name.to_owned(), number)).collect()
    }

    fn found(blessed: &[(&str, f64)], compiler: &str, now: &[(&str, f64)]) -> (usize, usize) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.cost");
        bless_numbers(&path, "rustc 2", &numbers(&[("canny", 1.0)])).unwrap();
        bless_numbers(&path, "rustc 1", &numbers(blessed)).unwrap();
        let mut findings = Findings::default();
        let now = numbers(now).into_iter().collect();
        compare_numbers(&path, compiler, &now, ONE_PER_CENT, &mut findings).unwrap();
        (findings.failures.len(), findings.notes.len())
    }

    #[test]
    fn a_number_may_fall_but_not_rise() {
        let blessed = [("gaussian 3 × 3", 20.5), ("canny", 100.0)];
        let found = |now: &[_]| found(&blessed, "rustc 1", now);
        assert_eq!(found(&[("gaussian 3 × 3", 20.5), ("canny", 101.0)]), (0, 0));
        assert_eq!(found(&[("gaussian 3 × 3", 20.5), ("canny", 101.1)]), (1, 0));
        assert_eq!(found(&[("gaussian 3 × 3", 19.0), ("canny", 100.0)]), (0, 1));
        assert_eq!(found(&[("canny", 100.0)]), (1, 0), "one is gone");
        assert_eq!(found(&[("gaussian 3 × 3", 1.0), ("canny", 1.0), ("new", 1.0)]), (1, 2));
    }

    #[test]
    fn each_compiler_has_its_own_numbers() {
        assert_eq!(found(&[("canny", 9.0)], "rustc 2", &[("canny", 1.0)]), (0, 0));
        assert_eq!(found(&[("canny", 9.0)], "rustc 2", &[("canny", 2.0)]), (1, 0));
        assert_eq!(
            found(&[("canny", 9.0)], "rustc 3", &[("canny", 100.0)]),
            (0, 1),
            "nobody has blessed with it"
        );
    }

    #[test]
    fn lines_are_compared_one_by_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.out");
        let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
        let failures = |now: &str| {
            let mut findings = Findings::default();
            compare_lines(&path, &lines(now), &mut findings).unwrap();
            findings.failures.len()
        };
        assert_eq!(failures("a\nb"), 1, "nothing was blessed");
        bless(&path, "a\nb\n").unwrap();
        assert_eq!(failures("a\nb"), 0);
        assert_eq!(failures("a\nc"), 1);
        assert_eq!(failures("a"), 1);
        assert_eq!(failures("a\nb\nc"), 1);
    }
}
