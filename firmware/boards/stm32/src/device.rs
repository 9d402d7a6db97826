//! What the host may see and set on a board: registers, the sensor, its mode, the deadline of a frame.

use firmware::link::Parameter;
use firmware::link::packet::{Meaning, Status};
use firmware::port::{Register, Registers};
use firmware::sensor::{Mode, Model};
use firmware::station::{Board, Picture};

use crate::chip::Chip;
use crate::silicon::Silicon;

/// DCMI's registers for those who look on: the driver has them too, and the DMA's for itself.
#[derive(Debug)]
pub struct Window<S> {
    silicon: S,
    base: u32,
}

impl<S: Silicon> Window<S> {
    /// Of the DCMI of this chip.
    pub fn new(silicon: S, chip: &Chip) -> Self {
        Self { silicon, base: chip.dcmi }
    }
}

impl<S: Silicon> Registers for Window<S> {
    fn read(&mut self, register: Register) -> u32 {
        // What stands above DR is not DCMI's.
        if register > Register::Data { 0 } else { self.silicon.read(self.base + register.offset()) }
    }

    fn write(&mut self, register: Register, value: u32) {
        if register <= Register::Data {
            self.silicon.write(self.base + register.offset(), value);
        }
    }
}

/// The sensor's registers.
pub trait SensorRegisters {
    /// Reads one; `None` if the bus failed, or no sensor is known yet.
    fn read(&mut self, register: u16) -> Option<u16>;
    /// Writes one; false if that failed.
    fn write(&mut self, register: u16, value: u16) -> bool;
    /// Sends the test pattern, or no longer; false if that failed.
    fn pattern(&mut self, on: bool) -> bool;
}

/// The parameters that the host may set, by their numbers behind the station's own.
const DEADLINE: u16 = 0;
const MODE: u16 = 1;
const PATTERN: u16 = 2;

/// The modes of a sensor that a board captures: QVGA on eight wires.
pub fn modes(model: &'static Model) -> impl Iterator<Item = &'static Mode> {
    use firmware::camif::registers::BusWidth;
    model.modes.iter().filter(|mode| mode.width == 320 && mode.bus_width == BusWidth::Bits8)
}

/// The pictures of a mode, as the link has them.
#[must_use]
pub fn picture(mode: &Mode) -> Picture {
    Picture {
        name: mode.name,
        width: mode.width as u16,
        height: mode.height as u16,
        format: firmware::link::Format::Pixels(mode.format),
        meaning: Meaning { bayer: mode.bayer, ..Meaning::default() },
    }
}

/// What is announced before a sensor has been found.
pub const NO_PICTURE: Picture = Picture {
    name: "no sensor yet",
    width: 320,
    height: 240,
    format: firmware::link::Format::GRAY8,
    meaning: Meaning::DEFAULT,
};

/// A board with a camera, as the host sees it.
#[derive(Debug)]
pub struct CameraBoard<R, X> {
    registers: R,
    /// The sensor.
    pub sensor: X,
    model: Option<&'static Model>,
    /// The mode of the sensor, by its place among [`modes`].
    mode: i32,
    deadline_ms: i32,
    pattern: i32,
}

impl<R, X> CameraBoard<R, X> {
    /// A board whose sensor is not known yet.
    pub fn new(registers: R, sensor: X) -> Self {
        Self { registers, sensor, model: None, mode: 0, deadline_ms: 500, pattern: 0 }
    }

    /// This sensor has been found; its first mode is wanted if it is another than before.
    pub fn found(&mut self, model: &'static Model) {
        if self.model.is_none_or(|before| before.name != model.name) {
            self.mode = 0;
        }
        self.model = Some(model);
    }

    /// The mode that is wanted; `None` as long as no sensor is known.
    pub fn mode(&self) -> Option<&'static Mode> {
        modes(self.model?).nth(usize::try_from(self.mode).unwrap_or(0))
    }

    /// Milliseconds that a frame may take.
    pub fn deadline_ms(&self) -> u32 {
        self.deadline_ms.unsigned_abs()
    }

    /// The sensor was programmed anew.
    pub fn programmed(&mut self) {
        self.pattern = 0;
    }
}

impl<R: Registers, X: SensorRegisters> Board for CameraBoard<R, X> {
    fn registers(&mut self) -> &mut dyn Registers {
        &mut self.registers
    }

    fn parameter(&self, number: u16) -> Option<Parameter<'_>> {
        let last = self.model.map_or(0, |model| modes(model).count().saturating_sub(1)) as i32;
        let (name, value, least, greatest) = match number {
            DEADLINE => ("deadline of a frame (ms)", self.deadline_ms, 50, 10_000),
            MODE => ("mode (its number; the stream's name says which)", self.mode, 0, last),
            PATTERN => ("test pattern (0 off, 1 on)", self.pattern, 0, 1),
            _ => return None,
        };
        Some(Parameter { name, value, least, greatest })
    }

    fn set_parameter(&mut self, number: u16, value: i32) -> Result<(), Status> {
        match number {
            DEADLINE => self.deadline_ms = value,
            MODE => self.mode = value,
            _ if self.sensor.pattern(value != 0) => self.pattern = value,
            _ => return Err(Status::Failed),
        }
        Ok(())
    }

    fn read_sensor(&mut self, register: u32) -> Result<u32, Status> {
        let register = u16::try_from(register).map_err(|_| Status::NoRegister)?;
        self.sensor.read(register).map(u32::from).ok_or(Status::Failed)
    }

    fn write_sensor(&mut self, register: u32, value: u32) -> Result<(), Status> {
        let register = u16::try_from(register).map_err(|_| Status::NoRegister)?;
        let value = u16::try_from(value).map_err(|_| Status::OutOfRange)?;
        if self.sensor.write(register, value) { Ok(()) } else { Err(Status::Failed) }
    }
}
