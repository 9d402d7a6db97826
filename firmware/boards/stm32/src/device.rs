//! What the link's commands do on a board: take note of what is wanted, which [`capture`](crate::capture) then does.

use core::fmt;

use firmware::driver::verdict::Statistics;
use firmware::link::packet::{State, Status};
use firmware::link::{Choice, Device, Parameter, Resend};
use firmware::port::{Register, Registers};
use firmware::sensor::{Mode, Model};

use crate::chip::Chip;
use crate::silicon::Silicon;
use crate::stages::Stages;

/// The frames as captured.
pub const RAW: u8 = 0;
/// What the stages make of them.
pub const VISION: u8 = 1;
/// How many streams there are.
pub const STREAMS: u8 = 2;

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
    /// Reads one; `None` if the bus failed.
    fn read(&mut self, register: u16) -> Option<u16>;
    /// Writes one; false if the bus failed.
    fn write(&mut self, register: u16, value: u16) -> bool;
    /// Sends the test pattern, or no longer; false if the bus failed.
    fn pattern(&mut self, on: bool) -> bool;
}

/// The parameters that the host may set, by their numbers.
const DEADLINE: u16 = 0;
const MODE: u16 = 1;
const PATTERN: u16 = 2;

/// The modes of a sensor that a board captures: QVGA on eight wires.
pub fn modes(model: &'static Model) -> impl Iterator<Item = &'static Mode> {
    use firmware::camif::registers::BusWidth;
    model.modes.iter().filter(|mode| mode.width == 320 && mode.bus_width == BusWidth::Bits8)
}

/// A board as the host sees it.
#[derive(Debug)]
pub struct BoardDevice<R, X> {
    registers: R,
    /// The sensor.
    pub sensor: X,
    model: &'static Model,
    /// What it is doing.
    pub state: State,
    /// Frames of a snapshot that are still to come.
    pub left: u16,
    /// Streams that are on.
    pub on: u32,
    /// How each is to be encoded.
    pub choices: [Choice; STREAMS as usize],
    /// What makes the second stream.
    pub stages: Stages,
    /// The mode of the sensor, by its place among [`modes`].
    pub mode: i32,
    /// Milliseconds that a frame may take.
    pub deadline_ms: i32,
    pattern: i32,
    /// Streams of which something has changed: a bit each.
    pub changed: u32,
    /// Lines that are wanted again.
    pub again: Option<Resend>,
    /// The frame that is held, by its number on the link, and its lines.
    pub held: Option<(u32, u16)>,
    /// What became of all frames since the start.
    pub statistics: Statistics,
    /// Why the last wait ended without a frame, as the link has it.
    pub cause: u8,
}

impl<R: Registers, X: SensorRegisters> BoardDevice<R, X> {
    /// A device that captures from power-up on, with the raw stream.
    pub fn new(registers: R, sensor: X, model: &'static Model) -> Self {
        Self {
            registers,
            sensor,
            model,
            state: State::Running,
            left: 0,
            on: 1 << RAW,
            choices: [Choice::Sender; STREAMS as usize],
            stages: Stages::START,
            mode: 0,
            deadline_ms: 500,
            pattern: 0,
            changed: 0,
            again: None,
            held: None,
            statistics: Statistics::default(),
            cause: 0,
        }
    }

    /// The sensor, after which the device is called on the line.
    pub fn model(&self) -> &'static Model {
        self.model
    }

    /// The mode that is wanted.
    pub fn mode(&self) -> Option<&'static Mode> {
        modes(self.model).nth(usize::try_from(self.mode).unwrap_or(0))
    }

    /// The sensor was programmed anew.
    pub fn programmed(&mut self) {
        self.pattern = 0;
    }

    /// This stream is on.
    pub fn is_on(&self, stream: u8) -> bool {
        self.on >> stream & 1 != 0
    }
}

impl<R: Registers, X: SensorRegisters> Device for BoardDevice<R, X> {
    fn start(&mut self) -> Result<(), Status> {
        self.state = State::Running;
        Ok(())
    }

    fn stop(&mut self) -> Result<(), Status> {
        self.state = State::Stopped;
        Ok(())
    }

    fn snapshot(&mut self, frames: u16) -> Result<(), Status> {
        (self.state, self.left) = (State::Snapshot, frames);
        Ok(())
    }

    fn select_streams(&mut self, on: u32) -> Result<u32, Status> {
        if on >> STREAMS != 0 {
            return Err(Status::NoStream);
        }
        self.changed |= self.on ^ on;
        self.on = on;
        Ok(on)
    }

    fn choose_encoding(&mut self, stream: Option<u8>, choice: Choice) -> Result<(), Status> {
        match stream {
            Some(stream) => {
                *self.choices.get_mut(usize::from(stream)).ok_or(Status::NoStream)? = choice;
                self.changed |= 1 << stream;
            }
            None => {
                self.choices = [choice; STREAMS as usize];
                self.changed = (1 << STREAMS) - 1;
            }
        }
        Ok(())
    }

    fn choose_stages(&mut self, stream: u8, pipeline: &str, text: &mut dyn fmt::Write) -> Result<(), Status> {
        match stream {
            // The raw frames are made by no pipeline.
            RAW if pipeline.is_empty() => return Ok(()),
            RAW => {
                let _ = write!(text, "stream {RAW} is the frame as captured; stream {VISION} takes stages");
                return Err(Status::Unsupported);
            }
            VISION => {}
            _ => return Err(Status::NoStream),
        }
        match Stages::read(pipeline) {
            Ok(stages) => {
                (self.stages, self.changed) = (stages, self.changed | 1 << VISION);
                let _ = write!(text, "{stages}");
                Ok(())
            }
            Err(error) => {
                let _ = write!(text, "{error}");
                Err(Status::OutOfRange)
            }
        }
    }

    fn parameter(&self, number: u16) -> Option<Parameter<'_>> {
        let last = modes(self.model).count().saturating_sub(1) as i32;
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
            MODE => (self.mode, self.changed) = (value, (1 << STREAMS) - 1),
            _ if self.sensor.pattern(value != 0) => self.pattern = value,
            _ => return Err(Status::Failed),
        }
        Ok(())
    }

    fn registers(&mut self) -> &mut dyn Registers {
        &mut self.registers
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

    fn resend(&mut self, lines: &Resend) -> Result<u16, Status> {
        if lines.stream >= STREAMS {
            return Err(Status::NoStream);
        }
        // What the stages made is not kept.
        let (sequence, height) = self.held.filter(|_| lines.stream == RAW).ok_or(Status::Gone)?;
        if lines.sequence != sequence {
            return Err(Status::Gone);
        }
        let count = lines.count.min(height.saturating_sub(lines.first));
        self.again = Some(Resend { count, ..*lines });
        Ok(count)
    }
}
