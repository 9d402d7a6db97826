use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::case::CaseResult;
use super::plan::{Plan, Shard};
use crate::picture::{PictureError, write_raw};

/// The first line of a result file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// The plan.
    pub campaign: Plan,
    /// Checksum of the photographs.
    pub pictures: u32,
    /// Which part of it the file holds.
    pub shard: Shard,
}

/// Why results could not be read or merged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResultsError {
    /// A file that cannot be read.
    #[error("{}: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: std::io::Error,
    },
    /// A file that cannot be written.
    #[error(transparent)]
    Write(#[from] PictureError),
    /// A line that is no result.
    #[error("{}: line {line}: {error}; give files that `host-sim campaign` wrote", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What the parser says.
        error: serde_json::Error,
    },
    /// Cases that the file should hold and does not, or holds twice or without being asked to.
    #[error("{}: case {case} is {what}; run that shard again", path.display())]
    Case {
        /// The file.
        path: PathBuf,
        /// The case.
        case: u64,
        /// What is wrong.
        what: &'static str,
    },
    /// Shards of different campaigns.
    #[error("{}: another campaign than {}; merge the shards of one", path.display(), first.display())]
    Differs {
        /// The file.
        path: PathBuf,
        /// The first file.
        first: PathBuf,
    },
    /// A shard that is there twice.
    #[error("{}: shard {}/{} is there already, in {}; leave one out", path.display(), shard.index, shard.count, first.display())]
    Duplicate {
        /// The file.
        path: PathBuf,
        /// The shard.
        shard: Shard,
        /// The file that has it.
        first: PathBuf,
    },
    /// Shards that are not there.
    #[error("shards {missing} of {count} are missing; give them as well")]
    Missing {
        /// Which, as a list.
        missing: String,
        /// Of how many.
        count: u64,
    },
}

/// Writes results, under a temporary name first. Cases are put in order.
///
/// # Errors
/// [`ResultsError::Write`].
pub fn write(path: &Path, header: &Header, results: &[CaseResult]) -> Result<(), ResultsError> {
    let mut ordered: Vec<&CaseResult> = results.iter().collect();
    ordered.sort_by_key(|result| result.case);
    let mut text = json(header);
    for result in ordered {
        text.push('\n');
        text.push_str(&json(result));
    }
    text.push('\n');
    Ok(write_raw(path, text.as_bytes())?)
}

fn json<T: Serialize>(value: &T) -> String {
    // Numbers, texts and lists always have a form in JSON.
    serde_json::to_string(value).unwrap_or_default()
}

/// Reads a result file, and checks that it holds the cases of its shard, each once.
///
/// # Errors
/// [`ResultsError`] with the file and the line or case.
pub fn read(path: &Path) -> Result<(Header, Vec<CaseResult>), ResultsError> {
    let text =
        fs::read_to_string(path).map_err(|error| ResultsError::Read { path: path.to_owned(), error })?;
    let wrong = |line: usize| move |error| ResultsError::Line { path: path.to_owned(), line, error };
    let mut lines = text.lines();
    let header: Header = serde_json::from_str(lines.next().unwrap_or_default()).map_err(wrong(1))?;
    let mut results = BTreeMap::new();
    let case_error = |case, what| ResultsError::Case { path: path.to_owned(), case, what };
    for (number, line) in lines.enumerate() {
        let result: CaseResult = serde_json::from_str(line).map_err(wrong(number + 2))?;
        let case = result.case;
        if !header.shard.holds(case) || case >= header.campaign.cases() {
            return Err(case_error(case, "not of this shard"));
        }
        if results.insert(case, result).is_some() {
            return Err(case_error(case, "there twice"));
        }
    }
    let missing =
        (0..header.campaign.cases()).find(|case| header.shard.holds(*case) && !results.contains_key(case));
    match missing {
        Some(case) => Err(case_error(case, "missing")),
        None => Ok((header, results.into_values().collect())),
    }
}

/// Joins all shards of a campaign.
///
/// # Errors
/// [`ResultsError`] if a file is wrong, a shard is missing or there twice, or they are of different campaigns.
pub fn merge(paths: &[PathBuf]) -> Result<(Header, Vec<CaseResult>), ResultsError> {
    let mut whole: Option<(Header, PathBuf)> = None;
    let mut shards: BTreeMap<Shard, PathBuf> = BTreeMap::new();
    let mut all = Vec::new();
    for path in paths {
        let (header, results) = read(path)?;
        let shard = header.shard;
        let (first, first_path) = whole.get_or_insert_with(|| (header.clone(), path.clone()));
        if *first != (Header { shard: first.shard, ..header }) || first.shard.count != shard.count {
            return Err(ResultsError::Differs { path: path.clone(), first: first_path.clone() });
        }
        if let Some(first) = shards.insert(shard, path.clone()) {
            return Err(ResultsError::Duplicate { path: path.clone(), shard, first });
        }
        all.extend(results);
    }
    let Some((mut header, _)) = whole else {
        return Err(ResultsError::Missing { missing: "all".to_owned(), count: 1 });
    };
    let count = header.shard.count;
    let missing: Vec<String> = (1..=count)
        .filter(|&index| !shards.contains_key(&Shard { index, count }))
        .map(|index| index.to_string())
        .collect();
    if !missing.is_empty() {
        return Err(ResultsError::Missing { missing: missing.join(", "), count });
    }
    header.shard = Shard::WHOLE;
    all.sort_by_key(|result| result.case);
    Ok((header, all))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::{Pictures, run};

    fn shard_file(folder: &Path, plan: &Plan, index: u64, count: u64) -> PathBuf {
        let (shard, pictures) = (Shard { index, count }, Pictures::default());
        let results: Vec<_> = (0..plan.cases())
            .filter(|case| shard.holds(*case))
            .map(|case| run(&plan.case(case).unwrap(), &pictures))
            .collect();
        let path = folder.join(format!("{index}-of-{count}.jsonl"));
        write(&path, &Header { campaign: plan.clone(), pictures: 0, shard }, &results).unwrap();
        path
    }

    #[test]
    fn any_number_of_shards_gives_the_same_bytes_and_a_wrong_set_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let plan = Plan { clean: 2, ..Plan::new(2, 5).with_faults(["stuck-bit", "short-line"]).unwrap() };
        let whole = fs::read(shard_file(folder.path(), &plan, 1, 1)).unwrap();
        for count in [2, 3, 6] {
            let mut paths: Vec<_> = (1..=count).map(|i| shard_file(folder.path(), &plan, i, count)).collect();
            paths.reverse();
            let (header, results) = merge(&paths).unwrap();
            let merged = folder.path().join("merged.jsonl");
            write(&merged, &header, &results).unwrap();
            assert_eq!(fs::read(&merged).unwrap(), whole, "{count} shards");
        }
        let half = |index| shard_file(folder.path(), &plan, index, 2);
        let error = |paths: &[PathBuf]| merge(paths).unwrap_err().to_string();
        assert!(error(&[half(1)]).contains("shards 2 of 2 are missing"));
        assert!(error(&[half(1), half(1)]).contains("there already"));
        let other = shard_file(folder.path(), &Plan { seed_base: 6, ..plan.clone() }, 2, 2);
        let moved = folder.path().join("other.jsonl");
        fs::rename(other, &moved).unwrap();
        assert!(error(&[half(1), moved]).contains("another campaign"));
        let cut = folder.path().join("cut.jsonl");
        let text = String::from_utf8(whole).unwrap();
        fs::write(&cut, text.lines().take(3).collect::<Vec<_>>().join("\n")).unwrap();
        assert!(error(&[cut]).contains("missing; run that shard again"));
    }
}
