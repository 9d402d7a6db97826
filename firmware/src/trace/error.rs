//! What can be wrong with a `.camt` file.

use core::fmt;

/// Why reading stopped: what, and at which byte of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Error<E> {
    /// The file could not be read.
    Io {
        /// Byte of the file at which the read began.
        offset: u64,
        /// The reader's own error.
        error: E,
    },
    /// The file was read and is not a whole, undamaged trace.
    File {
        /// Byte of the file at which the header or chunk in question begins.
        offset: u64,
        /// What is wrong with it.
        problem: Problem,
    },
}

/// What is wrong with a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Problem {
    /// It does not begin with `CAMT`.
    Magic,
    /// A version that this reader does not know.
    Version {
        /// The version of the file.
        found: u8,
    },
    /// The header's checksum is right, its content is not.
    Header,
    /// The file ends where a header, a chunk or END should be.
    Truncated,
    /// A chunk longer than the format allows.
    ChunkLength {
        /// Bytes of payload it claims.
        found: u16,
    },
    /// Content and checksum disagree.
    Damaged,
    /// A chunk type that this reader does not know and may not skip.
    UnknownChunk {
        /// The type's byte.
        code: u8,
    },
    /// A chunk where it may not stand.
    Order,
    /// The profile is not UTF-8 or longer than 64 KiB.
    Profile,
    /// A record that the format does not know, or one that runs past its chunk.
    Record,
    /// A sample wider than the bus.
    Sample {
        /// The sample.
        value: u16,
    },
    /// The chunk's clock number does not follow: a chunk is missing, doubled or misplaced.
    Clock {
        /// The clock that should come next.
        expected: u64,
        /// The clock that the chunk begins with.
        found: u64,
    },
    /// INDEX or END do not agree with the rest.
    Index,
    /// There is no such mark.
    NoMark {
        /// Marks in the file.
        marks: u64,
    },
    /// An earlier call failed; the reader must be rewound or made anew.
    Stopped,
}

impl Problem {
    pub(super) const fn at<E>(self, offset: u64) -> Error<E> {
        Error::File { offset, problem: self }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Magic => f.write_str("not a .camt trace (it should begin with CAMT)"),
            Self::Version { found } => {
                write!(f, "format version {found}, and this reader knows 1; read it with a newer release")
            }
            Self::Header => {
                f.write_str("the header holds values that version 1 does not allow; make the trace again")
            }
            Self::Truncated => f.write_str("the file ends here without END; copy or record it again"),
            Self::ChunkLength { found } => {
                write!(
                    f,
                    "a chunk claims {found} bytes, more than the format allows; copy or record the file again"
                )
            }
            Self::Damaged => {
                f.write_str("the checksum does not fit the content; copy or record the file again")
            }
            Self::UnknownChunk { code } => {
                write!(
                    f,
                    "a chunk of unknown type 0x{code:02X} that may not be skipped; read it with a newer release"
                )
            }
            Self::Order => f.write_str("a chunk stands where it may not; make the trace again"),
            Self::Profile => f.write_str(
                "the profile is not UTF-8 text of at most 64 KiB; make the trace again with a shorter one",
            ),
            Self::Record => {
                f.write_str("a record is malformed; the program that wrote the trace has a fault")
            }
            Self::Sample { value } => write!(
                f,
                "sample 0x{value:04X} is wider than the bus; the program that wrote the trace has a fault"
            ),
            Self::Clock { expected, found } => write!(
                f,
                "clock {found} comes where {expected} should: chunks are missing or out of order; \
                 copy or record the file again"
            ),
            Self::Index => {
                f.write_str("index and content disagree; play the trace from its start, or make it again")
            }
            Self::NoMark { marks } => {
                write!(f, "the trace has {marks} marks, counted from 0; ask for one of them")
            }
            Self::Stopped => {
                f.write_str("reading stopped at an earlier error; rewind or open the trace again")
            }
        }
    }
}

impl<E: fmt::Display> fmt::Display for Error<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io { offset, error } => write!(f, "byte {offset}: {error}"),
            Self::File { offset, problem } => write!(f, "byte {offset}: {problem}"),
        }
    }
}

impl<E: fmt::Debug + fmt::Display> core::error::Error for Error<E> {}
