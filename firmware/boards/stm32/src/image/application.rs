//! Sensor, capture, frames: what an image does from power-up on, for ever.

use defmt::{Display2Format, error, info, warn};
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;
use embedded_hal::i2c::I2c;
use embedded_io::Write;
use firmware::camif::registers::BusWidth;
use firmware::driver::Config;
use firmware::driver::config::Policy;
use firmware::sensor::{MODELS, Mode, Model, Sensor, SensorError, power_up};

use super::serve::{self, Camera};
use super::ticks::{self, Delay};
use crate::output::{self, Output};

/// Time that a frame may take: the slowest sensor sends 15 a second, and the first one is exposed.
const DEADLINE_MS: u32 = 500;

/// What a board has for its sensor.
pub struct Board<I2C, R, W, S> {
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
}

/// Brings the sensor up and captures for ever. What fails is logged, with what to check, and tried again.
pub fn run<I2C: I2c, R: OutputPin, W: OutputPin, S: Write, const N: usize>(
    mut board: Board<I2C, R, W, S>,
    camera: &'static Camera<N>,
) -> ! {
    serve::register(camera);
    let mut memory = [0; output::MEMORY];
    let mut session = 0_u32;
    loop {
        session = session.wrapping_add(1);
        match bring_up(&mut board) {
            Ok((model, mode)) => {
                info!("{=str} sends {=str}", model.name, mode.name);
                let mut config = mode.capture(board.sensor_hz);
                (config.policy, config.hclk_hz) = (board.policy, board.hclk_hz);
                let mut output = Output::new(&mut board.serial, &mut memory);
                if output.announce(model, mode, session).is_err() {
                    warn!("the serial line takes nothing");
                }
                capture(camera, &config, mode, &mut output);
            }
            Err(failure) => error!("{}", Display2Format(&failure)),
        }
        Delay.delay_ms(2_000);
    }
}

/// The mode that is captured: QVGA on eight wires.
fn mode_of(model: &'static Model) -> Option<&'static Mode> {
    model.modes.iter().find(|mode| mode.width == 320 && mode.bus_width == BusWidth::Bits8)
}

/// Powers the sensor up, finds which one it is, and programs it.
fn bring_up<I2C: I2c, R: OutputPin, W: OutputPin, S>(
    board: &mut Board<I2C, R, W, S>,
) -> Result<(&'static Model, &'static Mode), SensorError> {
    // The slowest of them to come out of reset.
    let slowest =
        MODELS.iter().max_by_key(|model| model.power.settle).ok_or(SensorError::NotFound { tried: 0 })?;
    power_up(slowest, &mut board.reset, &mut board.power_down, &mut Delay)?;
    let mut sensor = Sensor::detect(&mut board.i2c, &MODELS).map_err(|(failure, _)| failure)?;
    let model = sensor.model();
    let mode = mode_of(model).ok_or(SensorError::NotFound { tried: MODELS.len() })?;
    sensor.start(mode, &mut Delay)?;
    Ok((model, mode))
}

/// Captures until a frame is overdue.
fn capture<S: Write, const N: usize>(
    camera: &'static Camera<N>,
    config: &Config,
    mode: &Mode,
    output: &mut Output<'_, S>,
) {
    if let Err(refusal) = camera.start(config) {
        error!("{}", Display2Format(&refusal));
        return;
    }
    loop {
        camera.trigger();
        let started = ticks::now();
        let idle = || {
            cortex_m::asm::wfi();
            u64::from(ticks::now().wrapping_sub(started))
        };
        match camera.wait_frame(u64::from(DEADLINE_MS), idle) {
            Ok(frame) => {
                let verdict = frame.verdict();
                info!(
                    "frame {=u32}: {=u32} bytes, CRC-32 {=u32:08x}, {}",
                    verdict.sequence,
                    verdict.bytes,
                    frame.crc32(),
                    Display2Format(&verdict.outcome)
                );
                let captured_us = u64::from(ticks::now()) * 1_000;
                if output.frame(mode, frame.bytes(), verdict, captured_us).is_err() {
                    warn!("the serial line takes nothing");
                }
            }
            Err(timeout) => {
                warn!("{}", Display2Format(&timeout));
                camera.stop();
                return;
            }
        }
    }
}
