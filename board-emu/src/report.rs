//! What came of a run, for people and as JSON, and what of the part was expected to be missing.

use std::fmt::{self, Display};
use std::path::Path;

use anyhow::{Context, Result};
use rigless::session::Session;
use serde::{Deserialize, Serialize};

use crate::board::{CameraBoard, Kind};
use crate::dcmi::Counts;
use crate::run::{LastAccess, QUIET};
use crate::symbols::Symbols;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// The camera had nothing more to show, and all that followed from it was done.
    Done,
    /// The deadline came while things still moved.
    Deadline,
    /// Nothing moved any more while the camera sent into an interface that was switched on.
    Hung,
    /// The image ended the run, with this status.
    Exit(u32),
    /// The user did.
    Interrupted,
}

/// What the core was doing at the end.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Core {
    /// `asleep`, `polling` a peripheral, or `computing` without touching one.
    pub state: &'static str,
    /// The last access to a peripheral: the instruction and its function.
    pub last_access_by: Option<String>,
    /// The peripheral's address.
    pub last_access_to: Option<String>,
    /// When that was, in virtual nanoseconds.
    pub last_access_at: Option<u64>,
}

impl Core {
    pub(crate) fn of(
        ending: Ending,
        idle: bool,
        last: Option<LastAccess>,
        now: u64,
        symbols: &Symbols,
    ) -> Self {
        let polls = last.is_some_and(|last| last.at + QUIET / 2 > now);
        let state = match (idle, ending == Ending::Hung && polls) {
            (true, _) => "asleep",
            (false, true) => "polling",
            (false, false) => "computing",
        };
        Self {
            state,
            last_access_by: last.map(|last| symbols.describe(last.program_counter)),
            last_access_to: last.map(|last| format!("{:#010x}", last.address)),
            last_access_at: last.map(|last| last.at),
        }
    }
}

/// An access that the emulated part did not answer as the chip would.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Gap {
    /// `unmapped`, `refused`, `unimplemented`, `unrouted`, or `told`: a broken rule of the manual.
    pub kind: &'static str,
    /// Where: the address, or the instance and register.
    pub place: String,
    /// What of it.
    pub detail: String,
    /// The allow-list expects it.
    pub expected: bool,
}

/// Gaps that an image is known to meet, by kind and the start of their place.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Allowed {
    /// Entries such as `unimplemented PWR.` or `told USART3.`.
    #[serde(default)]
    pub allow: Vec<Entry>,
}

/// One of them.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// The kind of gap.
    pub kind: String,
    /// What its place begins with.
    pub place: String,
    /// Why that is all right.
    pub reason: String,
}

impl Allowed {
    /// From a TOML file of `[[allow]]` tables with `kind`, `place` and `reason`.
    ///
    /// # Errors
    /// If it cannot be read or says something else.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        toml::from_str(&text).with_context(|| path.display().to_string())
    }

    /// The list that comes with a board: what the emulator leaves out of the part and start-up code touches.
    ///
    /// # Panics
    /// If the list, which is part of the program, is malformed; a test reads it.
    #[must_use]
    pub fn of(board: Kind) -> Self {
        let text = match board {
            Kind::Stm32h743 => include_str!("../allowed/stm32h743.toml"),
            Kind::Stm32f429 => include_str!("../allowed/stm32f429.toml"),
        };
        toml::from_str(text).expect("the list is part of the program")
    }

    fn expects(&self, kind: &str, place: &str) -> bool {
        self.allow.iter().any(|entry| entry.kind == kind && place.starts_with(&entry.place))
    }
}

/// What came of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The board.
    pub board: &'static str,
    /// How it ended.
    pub ending: Ending,
    /// Virtual time, in nanoseconds.
    pub virtual_nanos: u64,
    /// Instructions that the core retired.
    pub instructions: u64,
    /// Wall-clock time, in seconds.
    pub seconds: f64,
    /// Pixel clocks that the camera sent.
    pub pixel_clocks: u64,
    /// Words that were taken out of the camera interface.
    pub words: u64,
    /// Interrupts of the camera interface.
    pub interrupts: u64,
    /// Frames that the camera interface saw the end of.
    pub frames: u64,
    /// Overruns of its FIFO.
    pub overruns: u64,
    /// Resets of the part, but the first.
    pub resets: usize,
    /// What the core was doing at the end.
    pub core: Core,
    /// What the emulated part did not answer as the chip would.
    pub gaps: Vec<Gap>,
    /// Bytes from the serial port.
    pub serial_bytes: usize,
    /// The bytes themselves.
    #[serde(skip)]
    pub serial: Vec<u8>,
    /// What the image printed by semihosting.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub console: String,
}

impl Report {
    pub(crate) fn new(
        kind: Kind,
        session: &Session<CameraBoard>,
        counts: Counts,
        ending: Ending,
        core: Core,
        allowed: &Allowed,
        symbols: &Symbols,
    ) -> Self {
        let mut gaps = Vec::new();
        let mut add = |kind: &'static str, place: String, detail: String| {
            let expected = allowed.expects(kind, &place);
            gaps.push(Gap { kind, place, detail, expected });
        };
        for gap in session.unmapped() {
            add("unmapped", format!("{:#010x}", gap.address), symbols.describe(gap.program_counter));
        }
        for (address, fault) in session.refused() {
            add("refused", format!("{address:#010x}"), fault.to_string());
        }
        for gap in session.unimplemented().values() {
            let by = symbols.describe(gap.program_counter);
            let detail = format!("{} reads, {} writes, first by {by}", gap.reads, gap.writes);
            add("unimplemented", format!("{}.{}", gap.instance, gap.register), detail);
        }
        for (instance, number) in session.unrouted() {
            add("unrouted", format!("{instance}.{number}"), "the core has no such line".into());
        }
        for told in session.told() {
            add("told", format!("{}.{}", told.instance, told.register), told.reason.into());
        }
        Self {
            board: kind.name(),
            ending,
            virtual_nanos: 0,
            instructions: 0,
            seconds: 0.0,
            pixel_clocks: counts.clocks,
            words: counts.words,
            interrupts: counts.interrupts,
            frames: counts.frames,
            overruns: counts.overruns,
            resets: session.resets().len(),
            core,
            gaps,
            serial_bytes: 0,
            serial: Vec::new(),
            console: String::new(),
        }
    }

    pub(crate) fn timed(self, virtual_nanos: u64, instructions: u64, seconds: f64) -> Self {
        Self { virtual_nanos, instructions, seconds, ..self }
    }

    pub(crate) fn with_output(self, serial: Vec<u8>, console: Vec<u8>) -> Self {
        let console = String::from_utf8_lossy(&console).into_owned();
        Self { serial_bytes: serial.len(), serial, console, ..self }
    }

    /// Gaps that nobody expects.
    pub fn unexpected(&self) -> impl Iterator<Item = &Gap> {
        self.gaps.iter().filter(|gap| !gap.expected)
    }

    /// The run ended as it should and met nothing unexpected.
    #[must_use]
    pub fn is_fine(&self) -> bool {
        let ended = matches!(self.ending, Ending::Done | Ending::Deadline | Ending::Exit(0));
        ended && self.unexpected().next().is_none()
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ended = match self.ending {
            Ending::Done => "done: the camera had nothing more to show".to_owned(),
            Ending::Deadline => "the deadline came".to_owned(),
            Ending::Hung => "hung: the camera sends, and nothing moves".to_owned(),
            Ending::Exit(status) => format!("the image ended it with status {status}"),
            Ending::Interrupted => "interrupted".to_owned(),
        };
        writeln!(f, "board          {}", self.board)?;
        writeln!(f, "ended          {ended}")?;
        let (milliseconds, millions) = (self.virtual_nanos as f64 / 1e6, self.instructions as f64 / 1e6);
        let seconds = self.seconds;
        writeln!(
            f,
            "time           {milliseconds:.1} ms, {millions:.1} million instructions, in {seconds:.1} s"
        )?;
        writeln!(
            f,
            "camera         {} clocks, {} words, {} frames",
            self.pixel_clocks, self.words, self.frames
        )?;
        writeln!(f, "interrupts     {}", self.interrupts)?;
        writeln!(f, "overruns       {}", self.overruns)?;
        writeln!(f, "serial         {} bytes", self.serial_bytes)?;
        if self.resets > 0 {
            writeln!(f, "resets         {}", self.resets)?;
        }
        let core = &self.core;
        let by = core.last_access_by.as_deref().unwrap_or("nothing");
        let to = core.last_access_to.as_deref().unwrap_or("no peripheral");
        writeln!(f, "core           {}; last touched {to} at {by}", core.state)?;
        let unexpected: Vec<_> = self.unexpected().collect();
        writeln!(
            f,
            "gaps           {} expected, {} not",
            self.gaps.len() - unexpected.len(),
            unexpected.len()
        )?;
        for gap in unexpected {
            writeln!(f, "  {:<13} {}: {}", gap.kind, gap.place, gap.detail)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lists_that_come_along_are_well_formed() {
        for board in [Kind::Stm32h743, Kind::Stm32f429] {
            for entry in Allowed::of(board).allow {
                assert!(!entry.reason.is_empty() && !entry.place.is_empty(), "{entry:?}");
            }
        }
    }
}
