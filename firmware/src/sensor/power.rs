use core::convert::Infallible;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, OutputPin};

use super::error::SensorError;
use super::model::Model;

/// A pin that the module does not bring out, or that is tied to its resting level.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoPin;

impl ErrorType for NoPin {
    type Error = Infallible;
}

impl OutputPin for NoPin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// Powers a sensor up: its clock must run and its supplies stand already.
///
/// ```text
/// power_down ‾‾‾‾‾‾\_______________________
///      reset ______________/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾
///                  │◄ low ►│◄ settle ►│ first access
/// ```
///
/// All four sensors agree on the levels: RESETB (RESET#, `RESET_BAR`) is active low, and PWDN (STANDBY) active high.
///
/// # Errors
/// [`SensorError::Pin`].
pub fn power_up(
    model: &Model,
    reset: &mut impl OutputPin,
    power_down: &mut impl OutputPin,
    delay: &mut impl DelayNs,
) -> Result<(), SensorError> {
    fn pin<E: embedded_hal::digital::Error>(name: &'static str) -> impl Fn(E) -> SensorError {
        move |error| SensorError::Pin { name, kind: error.kind() }
    }
    power_down.set_high().map_err(pin("power-down"))?;
    reset.set_low().map_err(pin("reset"))?;
    delay.delay_us(model.power.reset_low);
    power_down.set_low().map_err(pin("power-down"))?;
    delay.delay_us(model.power.reset_low);
    reset.set_high().map_err(pin("reset"))?;
    delay.delay_us(model.power.settle);
    Ok(())
}
