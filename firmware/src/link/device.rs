//! What a device does for each command: the seam between the link and a board, an emulator or a simulator.

use core::fmt;

use super::format::Choice;
use super::packet::Status;
use super::request::Resend;
use crate::port::Registers;

/// A number that the host may set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameter<'a> {
    /// Its name, with the unit: `exposure (lines)`.
    pub name: &'a str,
    /// What it is.
    pub value: i32,
    /// The least that it may be.
    pub least: i32,
    /// The greatest that it may be.
    pub greatest: i32,
}

/// A device, as the host sees it. What a device can't do is left to the defaults, which say so.
///
/// Nothing here sends: a device takes note of what it is to do, and does it between commands.
pub trait Device {
    /// Captures until it is told to stop.
    ///
    /// # Errors
    /// The status of the reply; so for all of these.
    fn start(&mut self) -> Result<(), Status>;

    /// Stops after what is on its way.
    #[expect(clippy::missing_errors_doc, reason = "as for `start`")]
    fn stop(&mut self) -> Result<(), Status>;

    /// Captures so many frames, one or more, and stops.
    #[expect(clippy::missing_errors_doc, reason = "as for `start`")]
    fn snapshot(&mut self, frames: u16) -> Result<(), Status>;

    /// Turns streams on (bit *s* for stream *s*) and all others off; returns those that are on.
    #[expect(clippy::missing_errors_doc, reason = "as for `start`")]
    fn select_streams(&mut self, _on: u32) -> Result<u32, Status> {
        Err(Status::Unsupported)
    }

    /// Chooses the encoding of a stream, or of all.
    #[expect(clippy::missing_errors_doc, reason = "as for `start`")]
    fn choose_encoding(&mut self, _stream: Option<u8>, _choice: Choice) -> Result<(), Status> {
        Err(Status::Unsupported)
    }

    /// Makes a stream by this pipeline from now on. `text` gets the pipeline as understood, or what is wrong with it.
    #[expect(clippy::missing_errors_doc, reason = "as for `start`")]
    fn choose_stages(
        &mut self,
        _stream: u8,
        _pipeline: &str,
        _text: &mut dyn fmt::Write,
    ) -> Result<(), Status> {
        Err(Status::Unsupported)
    }

    /// A parameter by its number; they are numbered from 0 without a gap.
    fn parameter(&self, _number: u16) -> Option<Parameter<'_>> {
        None
    }

    /// Sets a parameter; the value is in its range.
    #[expect(clippy::missing_errors_doc, reason = "as for `start`")]
    fn set_parameter(&mut self, _number: u16, _value: i32) -> Result<(), Status> {
        Err(Status::Unsupported)
    }

    /// The registers of the camera interface.
    fn registers(&mut self) -> &mut dyn Registers;

    /// Reads a register of the sensor.
    #[expect(clippy::missing_errors_doc, reason = "as for `start`")]
    fn read_sensor(&mut self, _register: u32) -> Result<u32, Status> {
        Err(Status::Unsupported)
    }

    /// Writes a register of the sensor.
    #[expect(clippy::missing_errors_doc, reason = "as for `start`")]
    fn write_sensor(&mut self, _register: u32, _value: u32) -> Result<(), Status> {
        Err(Status::Unsupported)
    }

    /// Sends lines again, soon; returns how many will come.
    #[expect(clippy::missing_errors_doc, reason = "as for `start`")]
    fn resend(&mut self, _lines: &Resend) -> Result<u16, Status> {
        Err(Status::Unsupported)
    }
}
