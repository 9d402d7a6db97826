//! Stretches to an FST, by the crate `fst-writer`: a wire for the clock, for each sync signal and for each line of the bus.

use std::io::{Seek, Write};

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;
use fst_writer::{
    FstBodyWriter, FstFileType, FstHeaderWriter, FstInfo, FstScopeType, FstSignalId, FstSignalType,
    FstVarDirection, FstVarType, FstWriteError as Refused,
};

use super::super::halves::{Halves, HalvesError, each};
use super::super::vcd::VcdWriterOptions;

/// Clocks of a section: some megabytes of memory while it is made.
const SECTION: u64 = 1 << 17;

/// Why an FST could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FstWriteError {
    /// The output failed.
    #[error(transparent)]
    Output(#[from] Refused),
    /// What is to be written has no levels.
    #[error(transparent)]
    Halves(#[from] HalvesError),
}

/// Writes an FST in picoseconds. After an error the output is not a whole one.
pub struct FstWriter<W: Write + Seek> {
    body: FstBodyWriter<W>,
    wires: Vec<FstSignalId>,
    halves: Halves,
    before: Option<u32>,
}

impl<W: Write + Seek> std::fmt::Debug for FstWriter<W> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("FstWriter").field("halves", &self.halves).finish_non_exhaustive()
    }
}

impl<W: Write + Seek> FstWriter<W> {
    /// Writes the header. Of the options, those of the layout of a VCD do not matter.
    ///
    /// # Errors
    /// If the options have no levels over time, or the output fails.
    pub fn new(out: W, options: &VcdWriterOptions) -> Result<Self, FstWriteError> {
        let halves = Halves::new(options)?;
        let info = FstInfo {
            start_time: 0,
            timescale_exponent: -12,
            version: "camif".to_owned(),
            date: String::new(),
            file_type: FstFileType::Verilog,
        };
        let mut header = FstHeaderWriter::new(out, &info)?;
        header.scope("camera", "", FstScopeType::Module)?;
        let mut wires = Vec::new();
        for name in halves.names() {
            let (bit, implicit) = (FstSignalType::bit_vec(1), FstVarDirection::Implicit);
            wires.push(header.var(name, bit, FstVarType::Wire, implicit, None)?);
        }
        header.up_scope()?;
        Ok(Self { body: header.finish()?, wires, halves, before: None })
    }

    fn levels(&mut self, (time, levels): (u64, u32)) -> Result<(), Refused> {
        self.body.time_change(time)?;
        let changed = self.before.replace(levels).map_or(u32::MAX, |before| before ^ levels);
        for (wire, &id) in self.wires.iter().enumerate().filter(|(wire, _)| changed >> wire & 1 != 0) {
            self.body.signal_change(id, if levels >> wire & 1 == 0 { b"0" } else { b"1" })?;
        }
        Ok(())
    }

    /// Writes the last change, and gives the output back with the number of clocks.
    ///
    /// # Errors
    /// The output's.
    pub fn finish(mut self) -> Result<(W, u64), FstWriteError> {
        self.levels(self.halves.rest())?;
        Ok((self.body.finish()?, self.halves.clocks))
    }
}

impl<W: Write + Seek> StretchSink for FstWriter<W> {
    type Error = FstWriteError;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), FstWriteError> {
        each(samples, |value| {
            let [first, second] = self.halves.clock(sync, value)?;
            self.levels(first)?;
            self.levels(second)?;
            if self.halves.clocks.is_multiple_of(SECTION) {
                self.body.flush()?;
            }
            Ok(())
        })
    }
}
