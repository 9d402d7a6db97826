//! Sensor, capture, frames: what an image does from power-up on, for ever.

use defmt::{Display2Format, error, info, warn};
use embedded_hal::digital::OutputPin;
use embedded_hal::i2c::I2c;
use embedded_io::{Read, ReadReady, Write};
use firmware::driver::config::Policy;
use firmware::link::packet::Level;
use firmware::port::Registers;
use firmware::sensor::{MODELS, Model, Sensor, SensorError, power_up};

use super::serve::{self, Camera};
use super::ticks::{Clock, Delay};
use crate::capture::{Bench, Ended, Time};
use crate::device::{BoardDevice, SensorRegisters, Window};
use crate::silicon::Mmio;
use crate::stages::Stages;
use crate::station::{Identity, Memory, Station};

/// Words of memory for the stages, whatever they are: QVGA.
pub const STAGES: usize = Stages::memory(320, 240);

/// What a board has for its sensor.
pub struct Board<I2C, R, W, S, T> {
    /// SCCB.
    pub i2c: I2C,
    /// RESET of the sensor.
    pub reset: R,
    /// PWDN of the sensor.
    pub power_down: W,
    /// The sensor's clock, in hertz.
    pub sensor_hz: u32,
    /// Clock of the bus matrix, in hertz.
    pub hclk_hz: u32,
    /// How frames are taken.
    pub policy: Policy,
    /// The serial line on which frames leave.
    pub serial: S,
    /// The serial line on which commands come in.
    pub commands: T,
    /// DCMI's registers, for who looks at them over the line.
    pub registers: Window<Mmio>,
    /// Rate of the line, bits a second.
    pub baud: u32,
}

/// A sensor's registers as the link reaches them.
struct Wired<'i, I2C>(Sensor<&'i mut I2C>);

impl<I2C: I2c> SensorRegisters for Wired<'_, I2C> {
    fn read(&mut self, register: u16) -> Option<u16> {
        self.0.read(register).ok()
    }

    fn write(&mut self, register: u16, value: u16) -> bool {
        self.0.write(register, value).is_ok()
    }

    fn pattern(&mut self, on: bool) -> bool {
        self.0.test_pattern(on, &mut Delay).is_ok()
    }
}

/// The registers through a reference.
struct Lent<'r>(&'r mut Window<Mmio>);

impl Registers for Lent<'_> {
    fn read(&mut self, register: firmware::port::Register) -> u32 {
        self.0.read(register)
    }

    fn write(&mut self, register: firmware::port::Register, value: u32) {
        self.0.write(register, value);
    }
}

/// Brings the sensor up and captures for ever. What fails is logged, with what to check, and tried again.
pub fn run<I2C, R, W, S, T, const N: usize>(
    board: Board<I2C, R, W, S, T>,
    camera: &'static Camera<N>,
    memory: &mut Memory,
    stages: &mut [u32; STAGES],
) -> !
where
    I2C: I2c,
    R: OutputPin,
    W: OutputPin,
    S: Write,
    T: Read + ReadReady,
{
    serve::register(camera);
    let Board { mut i2c, mut reset, mut power_down, serial, mut commands, mut registers, .. } = board;
    let receive = |bytes: &mut [u8]| match commands.read_ready() {
        Ok(true) => commands.read(bytes).unwrap_or(0),
        _ => 0,
    };
    let identity = Identity { session: 1, baud: board.baud };
    let mut station = Station::new(serial, receive, memory, identity);
    let mut clock = Clock::default();
    loop {
        match find(&mut i2c, &mut reset, &mut power_down) {
            Ok((model, sensor)) => {
                let mut device = BoardDevice::new(Lent(&mut registers), Wired(sensor), model);
                let _ = station.announce(&device);
                let mut bench = Bench::new(&mut station, &mut device);
                if let Err(failure) = film(
                    &mut bench,
                    (board.sensor_hz, board.hclk_hz, board.policy),
                    camera,
                    stages,
                    &mut clock,
                ) {
                    error!("{}", Display2Format(&failure));
                    let _ = station.log(Level::Error, clock.now(), &failure);
                }
            }
            Err(failure) => {
                error!("{}", Display2Format(&failure));
                let _ = station.log(Level::Error, clock.now(), &failure);
            }
        }
        // Wires may be moved meanwhile.
        let again = clock.now() + 2_000_000;
        while clock.sleep() < again {}
    }
}

/// Programs the mode that is wanted and captures, until the sensor fails.
fn film<I2C: I2c, S: Write, F: FnMut(&mut [u8]) -> usize, const N: usize>(
    bench: &mut Bench<'_, '_, S, F, Lent<'_>, Wired<'_, I2C>>,
    (sensor_hz, hclk_hz, policy): (u32, u32, Policy),
    camera: &'static Camera<N>,
    stages: &mut [u32; STAGES],
    clock: &mut Clock,
) -> Result<(), SensorError> {
    loop {
        let Some(mode) = bench.device.mode() else { return Err(SensorError::NotFound { tried: 1 }) };
        bench.device.sensor.0.start(mode, &mut Delay)?;
        bench.device.programmed();
        info!("{=str} sends {=str}", bench.device.sensor.0.model().name, mode.name);
        let _ = bench.station.streams(bench.device, u32::MAX);
        let mut config = mode.capture(sensor_hz);
        (config.policy, config.hclk_hz) = (policy, hclk_hz);
        match bench.capture(camera, (mode, &config), stages, clock) {
            Ended::Mode => {}
            Ended::Timeout(timeout) => {
                warn!("{}", Display2Format(&timeout));
                let _ = bench.station.log(Level::Warning, clock.now(), &timeout);
            }
            Ended::Refused(refusal) => {
                error!("{}", Display2Format(&refusal));
                let _ = bench.station.log(Level::Error, clock.now(), &refusal);
                let again = clock.now() + 2_000_000;
                while clock.sleep() < again {}
            }
        }
    }
}

/// Powers the sensor up, and finds which one it is.
fn find<'i, I2C: I2c>(
    i2c: &'i mut I2C,
    reset: &mut impl OutputPin,
    power_down: &mut impl OutputPin,
) -> Result<(&'static Model, Sensor<&'i mut I2C>), SensorError> {
    // The slowest of them to come out of reset.
    let slowest =
        MODELS.iter().max_by_key(|model| model.power.settle).ok_or(SensorError::NotFound { tried: 0 })?;
    power_up(slowest, reset, power_down, &mut Delay)?;
    let sensor = Sensor::detect(i2c, &MODELS).map_err(|(failure, _)| failure)?;
    Ok((sensor.model(), sensor))
}
