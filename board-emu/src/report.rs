//! What came of a run, for people and as JSON.

use std::fmt::{self, Display};

use rigless::session::Session;
use serde::Serialize;

use crate::board::{CameraBoard, Kind};
use crate::cpu::Core;
use crate::dcmi::Counts;
use crate::gaps::{Allowed, Gap, gaps};
use crate::symbols::Symbols;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// The camera had nothing more to show, and all that followed from it was done.
    Done,
    /// The deadline came while things still moved.
    Deadline,
    /// The deadline came, and the image had not switched the camera interface on.
    Dark,
    /// Nothing moved any more while the camera sent into an interface that was switched on.
    Hung,
    /// The image ended the run, with this status.
    Exit(u32),
    /// The user did.
    Interrupted,
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
            gaps: gaps(session, allowed, symbols),
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

    /// The run ended as it should, captured something unless the image itself says that all is well, and met nothing
    /// unexpected.
    #[must_use]
    pub fn is_fine(&self) -> bool {
        let ended = match self.ending {
            Ending::Done | Ending::Deadline => self.words > 0,
            Ending::Exit(status) => status == 0,
            Ending::Dark | Ending::Hung | Ending::Interrupted => false,
        };
        ended && self.core.state != "locked-up" && self.unexpected().next().is_none()
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ended = match self.ending {
            Ending::Done => "done: the camera had nothing more to show".to_owned(),
            Ending::Deadline => "the deadline came".to_owned(),
            Ending::Dark => "the deadline came, and the camera interface was never switched on".to_owned(),
            Ending::Hung => "hung: the camera sends, and nothing moves any more".to_owned(),
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
        if self.words == 0 && self.ending != Ending::Dark {
            writeln!(f, "               nothing was captured: no word left the camera interface")?;
        }
        writeln!(f, "serial         {} bytes", self.serial_bytes)?;
        if self.resets > 0 {
            writeln!(f, "resets         {}", self.resets)?;
        }
        let core = &self.core;
        write!(f, "core           {}", core.state)?;
        if let Some(exception) = &core.handles {
            write!(f, " in the handler of {exception}")?;
        }
        if let Some(at) = &core.at {
            write!(f, " at {at}")?;
        }
        writeln!(f)?;
        if let Some(link) = &core.link {
            writeln!(f, "               LR is {link}")?;
        }
        let by = core.last_access_by.as_deref().unwrap_or("nothing");
        let to = core.last_access_to.as_deref().unwrap_or("no peripheral");
        writeln!(f, "               last touched {to} at {by}")?;
        let unexpected: Vec<_> = self.unexpected().collect();
        writeln!(
            f,
            "gaps           {} expected, {} not",
            self.gaps.len() - unexpected.len(),
            unexpected.len()
        )?;
        for gap in unexpected {
            writeln!(f, "  {gap}")?;
        }
        Ok(())
    }
}
