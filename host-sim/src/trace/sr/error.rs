//! What can be wrong with a `.sr` file.

use std::io;

/// Why a `.sr` file could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SrError {
    /// The file could not be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// It is no ZIP archive, or one whose directory is damaged.
    #[error("not a readable ZIP archive ({0}); the file has been cut short or damaged: save it again")]
    Archive(String),
    /// A ZIP archive of something else.
    #[error("a ZIP archive, but not a sigrok session: it has no `{0}`{hint}", hint = other_archive(.1))]
    NotASession(&'static str, Vec<String>),
    /// More files than any capture has.
    #[error(
        "{0} files in the archive; a capture has at most {max}, which are a tebibyte of samples",
        max = super::archive::ENTRIES
    )]
    TooManyEntries(u64),
    /// A name with a path in it, or one twice, or files that share bytes: made to harm.
    #[error("file `{0}` in the archive {1}; sigrok writes no such archive, and it is not read")]
    Suspicious(String, &'static str),
    /// An encrypted entry, or a compression that sigrok does not use.
    #[error("file `{0}` in the archive is {1}; sigrok stores or deflates: save it again with sigrok")]
    Packing(String, &'static str),
    /// Another version of the format.
    #[error("session format version `{0}`; only version 2 is read: open it in PulseView and save it again")]
    Version(String),
    /// The text in `metadata` is wrong.
    #[error("metadata, line {line}: {problem}")]
    Metadata {
        /// Line, from 1; the last one for what is missing.
        line: usize,
        /// What.
        problem: MetadataProblem,
    },
    /// A piece of the samples is not there.
    #[error("`{0}` is missing among the pieces of the samples; the file is damaged: save it again")]
    MissingPiece(String),
    /// A piece of the samples cannot be inflated, or has another checksum.
    #[error(
        "file `{name}` in the archive, byte {offset} of its samples: {error}; the file is damaged: save it again"
    )]
    Piece {
        /// The piece.
        name: String,
        /// Inflated bytes before.
        offset: u64,
        /// What the archive's reader says.
        error: io::Error,
    },
    /// A piece is not as long as the archive says.
    #[error(
        "file `{name}` in the archive has {found} bytes of samples where the archive says {said}; the file is damaged"
    )]
    Size {
        /// The piece.
        name: String,
        /// Bytes that the archive says.
        said: u64,
        /// Bytes there are, at least.
        found: u64,
    },
    /// The samples end inside one.
    #[error(
        "the samples end with {left} bytes of one that has {unit}; the file has been cut short: save it again"
    )]
    Broken {
        /// Bytes left.
        left: usize,
        /// Bytes of a sample.
        unit: usize,
    },
}

fn other_archive(names: &[String]) -> &'static str {
    if names.iter().any(|name| name == "meta.json") {
        "; it looks like a session of Saleae Logic 2: export the raw data as CSV or binary from there"
    } else {
        ""
    }
}

/// What is wrong with the metadata.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MetadataProblem {
    /// More text than any device needs, or no text at all.
    #[error("not a text of at most 1 MiB")]
    NotText,
    /// A line that is neither a section nor `key=value`.
    #[error("`{0}` is neither [section] nor key=value")]
    Line(String),
    /// A value that cannot be understood.
    #[error("{key}={value} cannot be understood; {expected}")]
    Value {
        /// The key.
        key: String,
        /// Its value.
        value: String,
        /// What would be right.
        expected: &'static str,
    },
    /// A key that is needed.
    #[error("there is no {0} in the section of the device")]
    MissingKey(&'static str),
    /// No device with samples.
    #[error("no [device …] section has a capturefile: the session holds no logic samples")]
    NoDevice,
    /// Several devices with samples.
    #[error("{0} devices with samples; save each of them by itself")]
    SeveralDevices(usize),
    /// A channel that a sample has no bit for.
    #[error("probe{number} has no bit in samples of {unit} bytes")]
    Probe {
        /// Number of the channel, from 1.
        number: u32,
        /// Bytes of a sample.
        unit: usize,
    },
    /// A channel twice.
    #[error("probe{0} is there twice")]
    TwiceProbe(u32),
}
