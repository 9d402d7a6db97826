//! Why a wait ended without a frame: the cause, worked out from what was seen meanwhile.
//!
//! ```text
//! nothing at all ─────────────► NoClock        frames end damaged ─► Overrun, ShortFrame, Damaged
//! lines, but no frame's end ──► NoVsync        words don't move ───► DmaStalled
//! ```
//!
//! Time is counted in the caller's own ticks and passed in; nothing here keeps a clock.

use core::fmt;

use super::verdict::Outcome;
use crate::camif::registers::Status;

/// What was seen since capture was started, or since the last frame that was handed out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Evidence {
    /// Frame ends on the wires.
    pub vsyncs: u32,
    /// Line ends on the wires; stays 0 where line interrupts are off.
    pub lines: u32,
    /// The level of HSYNC was seen to change.
    pub hsync_moves: bool,
    /// The level of VSYNC was seen to change.
    pub vsync_moves: bool,
    /// The DMA moved at least a word.
    pub words_moved: bool,
    /// Words of the frame in progress that have reached memory.
    pub words: u32,
    /// Words that a frame has.
    pub words_expected: u32,
    /// A word waits in the FIFO.
    pub fifo_not_empty: bool,
    /// Overruns of the FIFO.
    pub overruns: u32,
    /// Frames that ended damaged.
    pub damaged: u32,
    /// What was wrong with the last of them.
    pub last_damage: Option<Outcome>,
    /// Capture waits for a free buffer.
    pub no_buffer: bool,
    /// Capture is not running: it was not started or asked for, or it was stopped.
    pub stopped: bool,
    /// The DMA refused to start again.
    pub refused: bool,
    /// Levels of HSYNC and VSYNC when last looked at.
    levels: Option<(bool, bool)>,
}

impl Evidence {
    /// Nothing seen yet of frames of so many words.
    pub(super) fn expecting(words: u32) -> Self {
        Self { words_expected: words, ..Self::default() }
    }

    /// Takes note of the pins.
    pub(super) fn look(&mut self, status: Status) {
        let levels = (status.hsync(), status.vsync());
        if let Some(before) = self.levels.replace(levels) {
            self.hsync_moves |= levels.0 != before.0;
            self.vsync_moves |= levels.1 != before.1;
        }
        self.fifo_not_empty = status.fifo_not_empty();
    }

    /// A frame ended damaged.
    pub(super) fn damage(&mut self, outcome: Outcome) {
        self.damaged = self.damaged.saturating_add(1);
        self.last_damage = Some(outcome);
    }

    /// The most likely cause of the wait.
    #[must_use]
    pub fn cause(&self) -> Cause {
        let silent = self.vsyncs == 0 && self.lines == 0 && !self.words_moved;
        match *self {
            Self { refused: true, .. } => Cause::Refused,
            Self { stopped: true, .. } => Cause::Stopped,
            Self { no_buffer: true, .. } => Cause::NoBuffer,
            // Overruns without a word moved: the bus did not slow down, it stands still.
            Self { overruns: 1.., words_moved: false, .. }
            | Self { last_damage: Some(Outcome::DmaStalled), .. } => Cause::DmaStalled,
            Self { last_damage: Some(Outcome::Overrun), overruns, .. } => Cause::Overrun { overruns },
            Self { last_damage: Some(Outcome::Short { expected }), .. } => Cause::ShortFrame { expected },
            Self { last_damage: Some(outcome), .. } => Cause::Damaged(outcome),
            Self { fifo_not_empty: true, words_moved: false, .. } => Cause::DmaStalled,
            Self { hsync_moves: false, vsync_moves: false, .. } if silent => Cause::NoClock,
            Self { vsyncs: 0, words_moved: false, .. } => Cause::NoVsync,
            Self { vsyncs: 0..=1, words, words_expected, .. } => {
                Cause::Unfinished { words, expected: words_expected }
            }
            // Frame after frame passes on the wires, and nothing of them comes in.
            Self { words_moved: false, .. } => Cause::NoData,
            Self { words, words_expected, .. } => Cause::Unfinished { words, expected: words_expected },
        }
    }
}

/// Why no frame came in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cause {
    /// Neither data nor any movement on the sync wires.
    NoClock,
    /// Lines, but no end of a frame.
    NoVsync,
    /// Frames pass on the wires without data.
    NoData,
    /// Frames end before all their bytes have come.
    ShortFrame {
        /// Bytes configured.
        expected: u32,
    },
    /// Data waits in the FIFO, and the DMA does not fetch it.
    DmaStalled,
    /// The FIFO overran.
    Overrun {
        /// How often.
        overruns: u32,
    },
    /// Frames came in, and all were damaged in another way.
    Damaged(Outcome),
    /// A frame is on its way: the deadline was shorter than a frame.
    Unfinished {
        /// Words that have come.
        words: u32,
        /// Words of a frame.
        expected: u32,
    },
    /// All buffers are in the consumer's hands.
    NoBuffer,
    /// Capture is not running.
    Stopped,
    /// The DMA refused to start again.
    Refused,
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoClock => write!(
                f,
                "no pixel clock: neither data nor sync edges came; check the sensor's power, its clock and reset, and the pins' alternate function"
            ),
            Self::NoVsync => {
                write!(f, "lines came, but no end of a frame; check the VSYNC wire and its polarity")
            }
            Self::NoData => write!(
                f,
                "frames passed without data; check the polarity of HSYNC and VSYNC, the clock edge and the crop window"
            ),
            Self::ShortFrame { expected } => write!(
                f,
                "frames end before their {expected} bytes have come; check the sensor's window, the polarity of HSYNC and the frame's configured size"
            ),
            Self::DmaStalled => write!(
                f,
                "data waits in the FIFO and the DMA does not fetch it; check the DMA's request line, its enable bit and the bus"
            ),
            Self::Overrun { overruns } => write!(
                f,
                "the FIFO overran {overruns} times; raise the DMA's priority, use a shorter burst or lower the pixel clock"
            ),
            Self::Damaged(outcome) => write!(f, "all frames came damaged; the last: {outcome}"),
            Self::Unfinished { words, expected } => {
                write!(f, "a frame is on its way with {words} of {expected} words; wait longer")
            }
            Self::NoBuffer => write!(f, "capture waits for a buffer, and all are leased; drop one"),
            Self::Stopped => write!(f, "capture is not running; start it, or ask for a snapshot"),
            Self::Refused => write!(f, "the DMA refused to start again; stop and start to see why"),
        }
    }
}

/// A wait that ended at its deadline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timeout {
    /// Why.
    pub cause: Cause,
    /// What was seen.
    pub evidence: Evidence,
}

impl Timeout {
    pub(super) fn new(evidence: Evidence) -> Self {
        Self { cause: evidence.cause(), evidence }
    }
}

impl fmt::Display for Timeout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no frame in time: {}", self.cause)
    }
}

impl core::error::Error for Timeout {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cause_follows_the_evidence() {
        let none = Evidence { words_expected: 16, ..Evidence::default() };
        let short = Outcome::Short { expected: 64 };
        let cases = [
            (none, Cause::NoClock),
            (Evidence { hsync_moves: true, ..none }, Cause::NoVsync),
            (Evidence { lines: 9, ..none }, Cause::NoVsync),
            (Evidence { vsyncs: 5, lines: 9, ..none }, Cause::NoData),
            (Evidence { vsyncs: 1, ..none }, Cause::Unfinished { words: 0, expected: 16 }),
            (Evidence { words: 7, words_moved: true, ..none }, Cause::Unfinished { words: 7, expected: 16 }),
            (Evidence { fifo_not_empty: true, ..none }, Cause::DmaStalled),
            (Evidence { overruns: 2, last_damage: Some(Outcome::Overrun), ..none }, Cause::DmaStalled),
            (
                Evidence { overruns: 2, last_damage: Some(Outcome::Overrun), words_moved: true, ..none },
                Cause::Overrun { overruns: 2 },
            ),
            (
                Evidence { last_damage: Some(short), words_moved: true, ..none },
                Cause::ShortFrame { expected: 64 },
            ),
            (
                Evidence { last_damage: Some(Outcome::SyncError), vsyncs: 3, ..none },
                Cause::Damaged(Outcome::SyncError),
            ),
            (Evidence { no_buffer: true, vsyncs: 3, ..none }, Cause::NoBuffer),
            (Evidence { stopped: true, ..none }, Cause::Stopped),
        ];
        for (evidence, cause) in cases {
            assert_eq!(evidence.cause(), cause, "{evidence:?}");
        }
    }

    #[test]
    fn a_wire_moves_when_two_looks_differ() {
        let mut evidence = Evidence::default();
        evidence.look(Status::default().with_hsync(true));
        assert!(!evidence.hsync_moves, "one look shows no movement");
        evidence.look(Status::default());
        assert!(evidence.hsync_moves && !evidence.vsync_moves);
    }
}
