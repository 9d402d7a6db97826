//! What an exercise is, and what it tells.

use algos_nostd::image::Error;
use crc::{CRC_32_ISO_HDLC, Crc, Digest, Table};

use crate::space::Workspace;

static CRC32: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// What the work is counted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A pixel of the picture.
    Pixel,
    /// A pixel that is drawn.
    Drawn,
    /// A line segment.
    Segment,
    /// A point of a curve or polygon.
    Point,
    /// A colour of the histogram.
    Color,
    /// A byte of pixels that is sent.
    Byte,
    /// A call.
    Call,
}

impl Unit {
    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pixel => "pixel",
            Self::Drawn => "pixel drawn",
            Self::Segment => "segment",
            Self::Point => "point",
            Self::Color => "colour",
            Self::Byte => "byte",
            Self::Call => "call",
        }
    }
}

/// An algorithm and how it is run.
#[derive(Clone, Copy, Debug)]
pub struct Exercise {
    /// Its name.
    pub name: &'static str,
    /// What its work is counted in.
    pub unit: Unit,
    /// Runs it: sets it up, starts the clock, works, stops the clock, and makes the checksum.
    pub run: fn(&mut Workspace, &mut dyn Clock) -> Result<Done, Error>,
}

/// Counts what the work takes.
pub trait Clock {
    /// The work begins.
    fn start(&mut self);
    /// The work has ended.
    fn stop(&mut self);
}

/// For whom the results are enough.
impl Clock for () {
    fn start(&mut self) {}
    fn stop(&mut self) {}
}

/// What an exercise did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Done {
    /// Units of work.
    pub units: u32,
    /// CRC-32 of the results, little-endian.
    pub checksum: u32,
}

impl Done {
    /// So many units, and results as bytes.
    pub(crate) fn new(units: usize, results: &[u8]) -> Self {
        Self { units: units as u32, checksum: CRC32.checksum(results) }
    }

    /// So many units, and results that `feed` gives a number at a time.
    pub(crate) fn of(units: usize, feed: impl FnOnce(&mut Results)) -> Self {
        let mut results = Results(CRC32.digest());
        feed(&mut results);
        Self { units: units as u32, checksum: results.0.finalize() }
    }
}

/// Results on their way into a checksum.
pub(crate) struct Results(Digest<'static, u32, Table<1>>);

impl Results {
    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    pub(crate) fn numbers(&mut self, numbers: impl IntoIterator<Item = i64>) {
        for number in numbers {
            self.0.update(&number.to_le_bytes());
        }
    }
}
