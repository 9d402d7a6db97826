//! What a person has to say of an image, `audit.toml` of its package: what the machine code does not tell, and which
//! panics are known, each with its reason.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::Deserialize;

/// All rules of a package. Names are parts of functions' names as the source has them.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Rules {
    /// Files with more of them, seen from this one's folder; a rule of this one comes first.
    pub(super) include: Vec<PathBuf>,
    /// Whom calls by address reach.
    pub(super) indirect: Vec<Indirect>,
    /// How often functions that call each other go round.
    pub(super) recursion: Vec<Recursion>,
    /// Handlers that serve several priorities.
    pub(super) nesting: Vec<Nesting>,
    /// Places that may hold calls of the panic handler.
    pub(super) panic: Vec<Panic>,
}

/// In functions with `from` in their name, a call by address reaches those whose address is taken and whose name has one
/// of `to` in it; none at all if `to` is empty.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq)]
#[serde(deny_unknown_fields)]
pub(super) struct Indirect {
    pub(super) from: String,
    pub(super) to: Vec<String>,
    pub(super) reason: String,
}

/// A cycle through a function with this in its name is gone round so often at most.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq)]
#[serde(deny_unknown_fields)]
pub(super) struct Recursion {
    pub(super) through: String,
    pub(super) depth: u32,
    pub(super) reason: String,
}

/// A handler of that name stands on the stack so often at once.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq)]
#[serde(deny_unknown_fields)]
pub(super) struct Nesting {
    pub(super) handler: String,
    pub(super) times: u32,
    pub(super) reason: String,
}

/// Calls of the panic handler from a source whose path begins so are known.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq)]
#[serde(deny_unknown_fields)]
pub(super) struct Panic {
    pub(super) place: String,
    /// Only calls that have no line, because the compiler joined those of several places.
    #[serde(default)]
    pub(super) joined: bool,
    /// Only in this image; in all of the package if it is not given.
    pub(super) image: Option<String>,
    /// Only in functions with one of these in their names; in all if there is none.
    #[serde(default)]
    pub(super) within: Vec<String>,
    pub(super) reason: String,
}

impl Rules {
    /// The rules of a package, with those of the files that it includes; none if it has no file.
    pub(super) fn read(path: &Path) -> Result<Self> {
        if !path.exists() {
            return Ok(Self::default());
        }
        let text =
            std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
        let mut rules: Self = toml::from_str(&text).with_context(|| path.display().to_string())?;
        let reasons = rules.indirect.iter().map(|rule| &rule.reason);
        let reasons = reasons.chain(rules.recursion.iter().map(|rule| &rule.reason));
        let reasons = reasons.chain(rules.nesting.iter().map(|rule| &rule.reason));
        let mut reasons = reasons.chain(rules.panic.iter().map(|rule| &rule.reason));
        anyhow::ensure!(
            reasons.all(|reason| !reason.trim().is_empty()),
            "{}: a rule has no reason",
            path.display()
        );
        for file in std::mem::take(&mut rules.include) {
            let file = path.with_file_name(file);
            anyhow::ensure!(file.exists(), "{}: there is no {} to include", path.display(), file.display());
            let Self { include: _, indirect, recursion, nesting, panic } = Self::read(&file)?;
            rules.indirect.extend(indirect);
            rules.recursion.extend(recursion);
            rules.nesting.extend(nesting);
            rules.panic.extend(panic);
        }
        Ok(rules)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_of_two_boards_stand_in_one_file() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, text).unwrap();
            path
        };
        let rule = |place: &str| format!("[[panic]]\nplace = '{place}'\nreason = 'known'\n");
        let board = write("board/audit.toml", &format!("include = ['../both/audit.toml']\n{}", rule("own")));
        let missing = Rules::read(&board).unwrap_err().to_string();
        assert!(missing.contains("../both/audit.toml to include"), "{missing}");
        write("both/audit.toml", &rule("both"));
        let rules = Rules::read(&board).unwrap();
        let places: Vec<&str> = rules.panic.iter().map(|rule| rule.place.as_str()).collect();
        assert_eq!(places, ["own", "both"]);
        write("both/audit.toml", "[[panic]]\nplace = 'both'\nreason = ' '\n");
        assert!(Rules::read(&board).unwrap_err().to_string().contains("no reason"));
        assert_eq!(Rules::read(&folder.path().join("none.toml")).unwrap(), Rules::default());
    }
}
