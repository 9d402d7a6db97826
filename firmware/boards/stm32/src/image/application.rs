//! Sensor, capture, frames: what an image does from power-up on, for ever.

use core::fmt::Display;

use defmt::{Display2Format, error, info, warn};
use embedded_hal::digital::OutputPin;
use embedded_hal::i2c::I2c;
use firmware::driver::config::Policy;
use firmware::link::packet::Level;
use firmware::sensor::{MODELS, Model, Sensor, SensorError, power_up};
use firmware::station::{Identity, Memory, Stages, Station, Wire};

use super::serve::{self, Camera};
use super::ticks::{self, Delay};
use crate::capture::{Account, Ended, capture};
use crate::device::{CameraBoard, NO_PICTURE, SensorRegisters, Window, picture};
use crate::silicon::Mmio;

/// Words of memory for the stages, whatever they are: QVGA.
pub const STAGES: usize = Stages::memory(320, 240);

/// Microseconds from a failure to the next try.
const AGAIN: u64 = 2_000_000;

/// What a board has for its sensor.
pub struct Parts<I2C, R, W, S> {
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
    /// The serial line on which frames leave and commands come in.
    pub serial: S,
    /// Rate of the line, bits a second.
    pub baud: u32,
    /// DCMI's registers, for who looks at them over the line.
    pub registers: Window<Mmio>,
}

/// A sensor's registers as the link reaches them.
struct Wired<I2C> {
    i2c: I2C,
    model: Option<&'static Model>,
}

impl<I2C: I2c> Wired<I2C> {
    fn sensor(&mut self) -> Option<Sensor<&mut I2C>> {
        Some(Sensor::new(&mut self.i2c, self.model?))
    }
}

impl<I2C: I2c> SensorRegisters for Wired<I2C> {
    fn read(&mut self, register: u16) -> Option<u16> {
        self.sensor()?.read(register).ok()
    }

    fn write(&mut self, register: u16, value: u16) -> bool {
        self.sensor().is_some_and(|mut sensor| sensor.write(register, value).is_ok())
    }

    fn pattern(&mut self, on: bool) -> bool {
        self.sensor().is_some_and(|mut sensor| sensor.test_pattern(on, &mut Delay).is_ok())
    }
}

/// The device on the line.
type Device<'m, I2C, S> = Station<'m, S, CameraBoard<Window<Mmio>, Wired<I2C>>>;

/// Brings the sensor up and captures for ever. What fails is logged, with what to check, and tried again.
pub fn run<I2C, R, W, S, const N: usize>(
    parts: Parts<I2C, R, W, S>,
    camera: &'static Camera<N>,
    memory: &mut Memory,
    stages: &mut [u32; STAGES],
) -> !
where
    I2C: I2c,
    R: OutputPin,
    W: OutputPin,
    S: Wire,
{
    serve::register(camera);
    let Parts { i2c, mut reset, mut power_down, sensor_hz, hclk_hz, policy, serial, baud, registers } = parts;
    let board = CameraBoard::new(registers, Wired { i2c, model: None });
    let identity = Identity { name: "camif", session: 1, baud };
    let lent = (serial, memory, &mut stages[..]);
    let mut station = Station::new(lent, (board, NO_PICTURE, 0), identity, ticks::microseconds);
    let mut account = Account::default();
    loop {
        let sensor = &mut station.control.board.sensor;
        let failure = match find(&mut sensor.i2c, &mut reset, &mut power_down) {
            Ok(model) => {
                sensor.model = Some(model);
                station.control.board.found(model);
                station.rename(model.name);
                film(&mut station, (sensor_hz, hclk_hz, policy), camera, &mut account)
            }
            Err(failure) => failure,
        };
        error!("{}", Display2Format(&failure));
        tell(&mut station, Level::Error, &failure);
        // Wires may be moved meanwhile.
        rest(&mut station);
    }
}

/// Programs the mode that is wanted and captures, until the sensor fails.
fn film<I2C: I2c, S: Wire, const N: usize>(
    station: &mut Device<'_, I2C, S>,
    (sensor_hz, hclk_hz, policy): (u32, u32, Policy),
    camera: &'static Camera<N>,
    account: &mut Account,
) -> SensorError {
    let mut announced = false;
    loop {
        let board = &mut station.control.board;
        let (Some(mode), Some(mut sensor)) = (board.mode(), board.sensor.sensor()) else {
            return SensorError::NotFound { tried: 0 };
        };
        if let Err(failure) = sensor.start(mode, &mut Delay) {
            return failure;
        }
        info!("{=str} sends {=str}", sensor.model().name, mode.name);
        board.programmed();
        station.control.show(picture(mode));
        if !announced {
            let _ = station.announce();
            announced = true;
        }
        let mut config = mode.capture(sensor_hz);
        (config.policy, config.hclk_hz) = (policy, hclk_hz);
        match capture(station, camera, &config, account, &mut ticks::sleep) {
            Ended::Mode => {}
            Ended::Timeout(timeout) => {
                warn!("{}", Display2Format(&timeout));
                tell(station, Level::Warning, &timeout);
            }
            Ended::Refused(refusal) => {
                error!("{}", Display2Format(&refusal));
                tell(station, Level::Error, &refusal);
                rest(station);
            }
        }
    }
}

/// Says it on the line as well.
fn tell<I2C: I2c, S: Wire>(station: &mut Device<'_, I2C, S>, level: Level, what: &dyn Display) {
    let _ = station.log(level, format_args!("{what}"));
}

/// Answers commands for a while.
fn rest<I2C: I2c, S: Wire>(station: &mut Device<'_, I2C, S>) {
    let again = ticks::microseconds() + AGAIN;
    while ticks::sleep() < again {
        let _ = station.serve();
    }
}

/// Powers the sensor up, and finds which one it is.
fn find<I2C: I2c>(
    i2c: &mut I2C,
    reset: &mut impl OutputPin,
    power_down: &mut impl OutputPin,
) -> Result<&'static Model, SensorError> {
    // The slowest of them to come out of reset.
    let slowest =
        MODELS.iter().max_by_key(|model| model.power.settle).ok_or(SensorError::NotFound { tried: 0 })?;
    power_up(slowest, reset, power_down, &mut Delay)?;
    let sensor = Sensor::detect(i2c, &MODELS).map_err(|(failure, _)| failure)?;
    Ok(sensor.model())
}
