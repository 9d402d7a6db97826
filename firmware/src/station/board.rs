//! What a device has besides capture, as the host may reach it.

use crate::link::Parameter;
use crate::link::packet::Status;
use crate::port::Registers;

/// A board: the registers of its camera interface, and whatever else it lets the host see and set. Registers alone are one.
pub trait Board {
    /// The registers of the camera interface.
    fn registers(&mut self) -> &mut dyn Registers;

    /// A parameter of the board's own, from 0 on without a gap; the host numbers them behind the station's.
    fn parameter(&self, _number: u16) -> Option<Parameter<'_>> {
        None
    }

    /// Sets one of them; the value is in its range.
    ///
    /// # Errors
    /// The status of the reply; so for all of these.
    fn set_parameter(&mut self, _number: u16, _value: i32) -> Result<(), Status> {
        Err(Status::Unsupported)
    }

    /// Reads a register of the sensor.
    #[expect(clippy::missing_errors_doc, reason = "as for `set_parameter`")]
    fn read_sensor(&mut self, _register: u32) -> Result<u32, Status> {
        Err(Status::Unsupported)
    }

    /// Writes a register of the sensor.
    #[expect(clippy::missing_errors_doc, reason = "as for `set_parameter`")]
    fn write_sensor(&mut self, _register: u32, _value: u32) -> Result<(), Status> {
        Err(Status::Unsupported)
    }
}

impl<R: Registers> Board for R {
    fn registers(&mut self) -> &mut dyn Registers {
        self
    }
}
