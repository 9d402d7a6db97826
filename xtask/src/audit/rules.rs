//! What a person has to say of an image, `audit.toml` of its package: what the machine code does not tell, and which
//! panics are known, each with its reason.

use std::path::Path;

use anyhow::{Context, Result};
use serde::Deserialize;

/// All rules of a package. Names are parts of functions' names as the source has them.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Rules {
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
    /// The rules of a package; none if it has no file.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Self::default()),
            Err(error) => return Err(error).with_context(|| format!("cannot read {}", path.display())),
        };
        let rules: Self = toml::from_str(&text).with_context(|| path.display().to_string())?;
        let reasons = rules.indirect.iter().map(|rule| &rule.reason);
        let reasons = reasons.chain(rules.recursion.iter().map(|rule| &rule.reason));
        let mut reasons = reasons.chain(rules.nesting.iter().map(|rule| &rule.reason));
        anyhow::ensure!(
            reasons.all(|reason| !reason.trim().is_empty())
                && rules.panic.iter().all(|rule| !rule.reason.trim().is_empty()),
            "{}: a rule has no reason",
            path.display()
        );
        Ok(rules)
    }
}
