use std::path::PathBuf;

/// What is wrong with a profile: the place, what was expected and what to do.
///
/// Lines count from 1.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ProfileError {
    /// The text is not TOML.
    #[error("line {line}: {message}")]
    Syntax {
        /// Where.
        line: usize,
        /// What the TOML parser says.
        message: String,
    },
    /// A key (or section) that profiles do not have.
    #[error("line {line}: unknown key `{key}` in {section}; did you mean {nearest}?")]
    UnknownKey {
        /// Where.
        line: usize,
        /// `[bus]`, or `the top level`.
        section: String,
        /// The key as written.
        key: String,
        /// The right key nearest to it, with its section if that is another one.
        nearest: String,
    },
    /// A key that has no default is not there.
    #[error("[{section}] lacks `{key}`: {allowed}")]
    Missing {
        /// The section without its brackets.
        section: &'static str,
        /// The key.
        key: &'static str,
        /// The values that are right, in words.
        allowed: String,
    },
    /// A value of the wrong type, say text for a number.
    #[error("line {line}: `{key}` is {got}; it must be {allowed}")]
    Type {
        /// Where.
        line: usize,
        /// The key.
        key: &'static str,
        /// The type given.
        got: String,
        /// The values that are right, in words.
        allowed: String,
    },
    /// A number outside its range.
    #[error("{}`{key}` is {got}; it must be {allowed}", line_prefix(*.line))]
    Range {
        /// Where; `None` if the profile was not read from text.
        line: Option<usize>,
        /// The key.
        key: &'static str,
        /// The number given.
        got: String,
        /// The values that are right, in words.
        allowed: String,
    },
    /// A word that is none of the words of its key.
    #[error("line {line}: `{key}` is \"{got}\"; did you mean \"{nearest}\"? It must be {allowed}")]
    Word {
        /// Where.
        line: usize,
        /// The key.
        key: &'static str,
        /// The word given.
        got: String,
        /// The right word nearest to it.
        nearest: &'static str,
        /// The words that are right.
        allowed: String,
    },
    /// Values that are right alone and wrong together.
    #[error("{what}; {remedy}")]
    Conflict {
        /// What does not fit.
        what: String,
        /// What to change.
        remedy: String,
    },
    /// Neither a built-in profile nor a file.
    #[error(
        "no profile is called `{name}` and there is no such file; did you mean `{nearest}`? Built in are {known}"
    )]
    Unknown {
        /// The name given.
        name: String,
        /// The built-in profile nearest to it.
        nearest: &'static str,
        /// All built-in profiles.
        known: String,
    },
    /// A file that can't be read.
    #[error("{}: {message}; check the path, or name a built-in profile such as `vga-rgb888`", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        message: String,
    },
    /// A fault in a file.
    #[error("{}: {error}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// The fault.
        error: Box<ProfileError>,
    },
}

fn line_prefix(line: Option<usize>) -> String {
    line.map(|line| format!("line {line}: ")).unwrap_or_default()
}
