use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::I2c;

use super::bus::RegisterBus;
use super::error::SensorError;
use super::model::{Mode, Model};
use super::table::{Step, Table};

/// A sensor on its bus.
#[derive(Debug)]
pub struct Sensor<I2C> {
    bus: RegisterBus<I2C>,
    model: &'static Model,
}

impl<I2C: I2c> Sensor<I2C> {
    /// A sensor of this model; nothing is sent yet.
    pub fn new(i2c: I2C, model: &'static Model) -> Self {
        Self { bus: RegisterBus::new(i2c, model), model }
    }

    /// Looks which of these models is there, and takes the first that is. Their addresses differ, so asking for one does
    /// nothing to another.
    ///
    /// # Errors
    /// [`SensorError::NotFound`] if none answers, [`SensorError::WrongIdentity`] of the last that answered as another
    /// sensor, or how the bus failed; and the bus itself.
    pub fn detect(mut i2c: I2C, models: &[&'static Model]) -> Result<Self, (SensorError, I2C)> {
        let mut reason = SensorError::NotFound { tried: models.len() };
        for &model in models {
            let mut sensor = Self::new(i2c, model);
            match sensor.identify() {
                Ok(()) => return Ok(sensor),
                Err(SensorError::NoAnswer { .. }) => {}
                Err(error) => reason = error,
            }
            i2c = sensor.release();
        }
        Err((reason, i2c))
    }

    /// The model.
    pub fn model(&self) -> &'static Model {
        self.model
    }

    /// The bus.
    pub fn release(self) -> I2C {
        self.bus.release()
    }

    /// Checks that it is the sensor expected.
    ///
    /// # Errors
    /// [`SensorError::WrongIdentity`], or how the bus failed.
    pub fn identify(&mut self) -> Result<(), SensorError> {
        for identity in self.model.identity {
            let found = self.bus.read(identity.register)?;
            if !identity.accepted.contains(&found) {
                let expected = identity.accepted.first().copied().unwrap_or(0);
                let (sensor, register) = (self.model.name, identity.register);
                return Err(SensorError::WrongIdentity { sensor, register, expected, found });
            }
        }
        Ok(())
    }

    /// Takes all registers to their reset values.
    ///
    /// # Errors
    /// How the bus failed.
    pub fn reset(&mut self, delay: &mut impl DelayNs) -> Result<(), SensorError> {
        self.run(&self.model.reset, delay)?;
        self.bus.forget_bank();
        Ok(())
    }

    /// Identifies and resets it and programs a mode: frames come from now on. The first ones may be badly exposed.
    ///
    /// # Errors
    /// [`SensorError`] with the step at which it failed.
    pub fn start(&mut self, mode: &Mode, delay: &mut impl DelayNs) -> Result<(), SensorError> {
        self.identify()?;
        self.reset(delay)?;
        self.run(&self.model.base, delay)?;
        self.run(&mode.table, delay)
    }

    /// Sends the test pattern instead of what the lens sees, or no longer.
    ///
    /// # Errors
    /// [`SensorError`] with the step at which it failed.
    pub fn test_pattern(&mut self, on: bool, delay: &mut impl DelayNs) -> Result<(), SensorError> {
        self.run(if on { &self.model.pattern_on } else { &self.model.pattern_off }, delay)
    }

    /// Carries a table out, and reads each register back.
    ///
    /// # Errors
    /// [`SensorError::NotHeld`] with the step, or how the bus failed.
    pub fn run(&mut self, table: &Table, delay: &mut impl DelayNs) -> Result<(), SensorError> {
        for (number, step) in table.steps.iter().enumerate() {
            let (register, mask, written) = match *step {
                Step::Wait { microseconds } => {
                    delay.delay_us(microseconds);
                    continue;
                }
                Step::Command { register, value } => {
                    self.bus.write(register, value)?;
                    continue;
                }
                Step::Write { register, value } => (register, u16::MAX, value),
                Step::Update { register, mask, value } => {
                    let before = self.bus.read(register)?;
                    (register, mask, before & !mask | value & mask)
                }
            };
            self.bus.write(register, written)?;
            let found = self.bus.read(register)?;
            if (found ^ written) & mask != 0 {
                let (sensor, table) = (self.model.name, table.name);
                return Err(SensorError::NotHeld { sensor, table, step: number, register, written, found });
            }
        }
        Ok(())
    }

    /// Reads a register.
    ///
    /// # Errors
    /// How the bus failed.
    pub fn read(&mut self, register: u16) -> Result<u16, SensorError> {
        self.bus.read(register)
    }

    /// Writes a register.
    ///
    /// # Errors
    /// How the bus failed.
    pub fn write(&mut self, register: u16, value: u16) -> Result<(), SensorError> {
        self.bus.write(register, value)
    }
}
