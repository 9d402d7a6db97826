use core::fmt;

/// What was wrong with a picture, a buffer or a parameter: what was expected and what was got.
///
/// Every fallible call of the crate checks once, at the edge, and returns this.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Error {
    /// A picture or line without pixels.
    ZeroSize {
        /// Pixels a line.
        width: usize,
        /// Lines.
        height: usize,
    },
    /// A stride shorter than a line.
    Stride {
        /// Pixels from the start of a line to the start of the next.
        stride: usize,
        /// Pixels a line.
        width: usize,
    },
    /// A buffer of the wrong length, in elements of its own type.
    BufferLength {
        /// The buffer's name in the call.
        name: &'static str,
        /// Elements needed.
        expected: usize,
        /// Elements given.
        got: usize,
    },
    /// Two pictures that must be of one size, in pixels.
    SizeMismatch {
        /// Width and height needed.
        expected: (usize, usize),
        /// Width and height given.
        got: (usize, usize),
    },
    /// A parameter outside its range.
    Parameter {
        /// The parameter's name in the call.
        name: &'static str,
        /// The value given (in the parameter's own unit).
        got: i64,
        /// The values that are right, in words.
        allowed: &'static str,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::ZeroSize { width, height } => {
                write!(f, "a picture of {width} × {height} pixels has no pixels")
            }
            Self::Stride { stride, width } => {
                write!(f, "a stride of {stride} pixels is shorter than a line of {width}")
            }
            Self::BufferLength { name, expected, got } => {
                write!(f, "`{name}` holds {got} elements, {expected} are needed")
            }
            Self::SizeMismatch { expected, got } => write!(
                f,
                "a picture of {} × {} pixels where {} × {} is needed",
                got.0, got.1, expected.0, expected.1
            ),
            Self::Parameter { name, got, allowed } => {
                write!(f, "`{name}` is {got}; it must be {allowed}")
            }
        }
    }
}

impl core::error::Error for Error {}
