//! What can be wrong with an FST file.

use std::io;

/// Why an FST could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FstError {
    /// The file could not be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The block is wrong.
    #[error("the block at byte {offset}: {problem}")]
    Block {
        /// Where the block begins.
        offset: u64,
        /// What.
        problem: FstProblem,
    },
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FstProblem {
    /// The file as a whole is packed once more.
    #[error("the whole file is packed once more; convert it again without that (vcd2fst without -c)")]
    Wrapped,
    /// The file ends inside a block.
    #[error("the file ends inside it; it has been cut short or its writer has not finished: write it again")]
    Short,
    /// A kind of block that there is not.
    #[error("type {0} is no kind of block; the file is damaged")]
    Kind(u8),
    /// A part that a finished file has.
    #[error(
        "the file ends without its {0}; it has been cut short or its writer has not finished: write it again"
    )]
    Missing(&'static str),
    /// A number that does not fit the others.
    #[error("its {0} cannot be; the file is damaged")]
    Wrong(&'static str),
    /// A packed part that cannot be unpacked, or to another size.
    #[error("its {0} cannot be unpacked; the file is damaged")]
    Packed(&'static str),
    /// More than memory is granted for.
    #[error("its {0} would take more than 256 MiB; dump only the scope of the camera")]
    TooLarge(&'static str),
    /// Time runs backwards.
    #[error("time {to} comes after {from}: time runs backwards; the file is damaged")]
    Backwards {
        /// The time before.
        from: u64,
        /// The time that follows it.
        to: u64,
    },
}
