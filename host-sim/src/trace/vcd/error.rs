//! What can be wrong with a VCD file.

use std::io;

use super::super::names::{MapError, Missing};
use super::blocks::Place;

/// Why a VCD file could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VcdError {
    /// The file could not be read.
    #[error("byte {offset}: {error}")]
    Io {
        /// Bytes read before.
        offset: u64,
        /// The system's error.
        error: io::Error,
    },
    /// The text is not a VCD, or not a whole one.
    #[error("line {} (byte {}): {problem}", .place.line, .place.offset)]
    Text {
        /// Where.
        place: Place,
        /// What.
        problem: Problem,
    },
    /// A wire that is needed is not in the file.
    #[error(transparent)]
    Missing(#[from] Missing),
    /// The map names something that is not in the file.
    #[error(transparent)]
    Map(#[from] MapError),
    /// The pixel clock is there and never has an active edge.
    #[error(
        "`{signal}` has no {edge} edge in the whole file, so there is no sample; \
         check the capture, or name another wire with --map PCLK=…"
    )]
    NoClock {
        /// The signal taken as PCLK.
        signal: String,
        /// The active edge.
        edge: &'static str,
    },
}

/// What is wrong with the text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// A token longer than a block of memory.
    #[error("a word of more than 250,000 characters; this is not a value change dump")]
    TokenTooLong,
    /// The file ends inside a section.
    #[error("the file ends inside `{0}`, before its $end; it has been cut short: export it again")]
    Unclosed(&'static str),
    /// The declarations do not end.
    #[error("the file ends before $enddefinitions; it has been cut short: export it again")]
    NoDefinitions,
    /// Something other than `$…` where a declaration should be.
    #[error(
        "`{0}` where a $ keyword should be; this is not a value change dump, or it has no $enddefinitions"
    )]
    NotAKeyword(String),
    /// A declaration with a missing or wrong part.
    #[error("a {0} that cannot be understood: `{1}`")]
    Declaration(&'static str, String),
    /// More declarations than memory is granted for.
    #[error("more than {0} bytes of declarations; dump only the scope of the camera")]
    TooManyDeclarations(usize),
    /// An `$upscope` without a `$scope`, or scopes too deep.
    #[error("$scope and $upscope do not match, or are more than 256 deep")]
    Scopes,
    /// One identifier for variables of different widths.
    #[error("identifier `{0}` is declared twice with different widths")]
    WidthConflict(String),
    /// A change of something that was not declared.
    #[error("a value for identifier `{0}`, which no $var declares; the file is damaged")]
    UndeclaredId(String),
    /// A change without an identifier.
    #[error("a value without an identifier; the file is damaged or has been cut short")]
    NoId,
    /// A scalar value for a vector or the other way about.
    #[error("`{value}` does not fit identifier `{id}`, declared with {width} bits")]
    ValueWidth {
        /// The value.
        value: String,
        /// The identifier.
        id: String,
        /// Its declared width.
        width: u32,
    },
    /// A character that no value has.
    #[error("`{0}` is neither a value change, a time nor a $ keyword; the file is damaged")]
    NotAChange(String),
    /// `#` without a number that fits 64 bits.
    #[error("`{0}` is not a time; the file is damaged")]
    Time(String),
    /// Time runs backwards.
    #[error("time {to} comes after {from}: time runs backwards; the file is damaged or two are joined")]
    Backwards {
        /// The time before.
        from: u64,
        /// The time that follows it.
        to: u64,
    },
    /// A declaration among the value changes.
    #[error("`{0}` among the value changes; the file is damaged or two are joined")]
    LateKeyword(String),
}
