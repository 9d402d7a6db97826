//! A sensor's registers over I2C.
//!
//! OmniVision's SCCB is I2C but for two things (SCCB Specification 2.2, §3.2): the ninth bit is "don't care", which their
//! sensors drive as an acknowledge all the same, and there is no repeated start. So a read is two transmissions, each with
//! its own stop: the register's address, then its data. Aptina's two-wire interface takes the repeated start of I2C.

use embedded_hal::i2c::{Error as _, I2c};

use super::error::{Access, SensorError};
use super::model::Model;

/// How registers are reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Addressing {
    /// Addresses and data of 8 bits.
    Byte,
    /// The same in banks: the upper byte of a [`Step`](super::table::Step)'s register is the bank, which is written to
    /// the register `select` before the first access and whenever it changes.
    Banked {
        /// The bank's register, which is in all banks.
        select: u8,
    },
    /// Addresses of 16 bits, data of 8.
    Word,
    /// Addresses of 8 bits, data of 16; reads with a repeated start.
    ByteWithWord,
}

/// The registers of one sensor.
#[derive(Debug)]
pub struct RegisterBus<I2C> {
    i2c: I2C,
    model: &'static Model,
    bank: Option<u8>,
}

impl<I2C: I2c> RegisterBus<I2C> {
    /// The registers of a sensor of this model on this bus.
    pub fn new(i2c: I2C, model: &'static Model) -> Self {
        Self { i2c, model, bank: None }
    }

    /// The bus.
    pub fn release(self) -> I2C {
        self.i2c
    }

    /// Forgets which bank is selected: after a reset.
    pub fn forget_bank(&mut self) {
        self.bank = None;
    }

    /// Reads a register.
    ///
    /// # Errors
    /// [`SensorError::NoAnswer`] or [`SensorError::Bus`].
    pub fn read(&mut self, register: u16) -> Result<u16, SensorError> {
        self.select(register)?;
        let address = self.model.address;
        let [high, low] = register.to_be_bytes();
        let mut data = [0; 2];
        let read = match self.model.addressing {
            Addressing::Byte | Addressing::Banked { .. } => {
                self.i2c.write(address, &[low]).and_then(|()| self.i2c.read(address, &mut data[1..]))
            }
            Addressing::Word => {
                self.i2c.write(address, &[high, low]).and_then(|()| self.i2c.read(address, &mut data[1..]))
            }
            Addressing::ByteWithWord => self.i2c.write_read(address, &[low], &mut data),
        };
        match read {
            Ok(()) => Ok(u16::from_be_bytes(data)),
            Err(error) => Err(self.failed(Access::Read { register }, &error)),
        }
    }

    /// Writes a register. Of a register of 8 bits the lower byte of `value` is written.
    ///
    /// # Errors
    /// [`SensorError::NoAnswer`] or [`SensorError::Bus`].
    pub fn write(&mut self, register: u16, value: u16) -> Result<(), SensorError> {
        self.select(register)?;
        let [high, low] = register.to_be_bytes();
        let [data_high, data_low] = value.to_be_bytes();
        let written = match self.model.addressing {
            Addressing::Byte | Addressing::Banked { .. } => {
                self.i2c.write(self.model.address, &[low, data_low])
            }
            Addressing::Word => self.i2c.write(self.model.address, &[high, low, data_low]),
            Addressing::ByteWithWord => self.i2c.write(self.model.address, &[low, data_high, data_low]),
        };
        written.map_err(|error| self.failed(Access::Write { register, value }, &error))
    }

    fn select(&mut self, register: u16) -> Result<(), SensorError> {
        let Addressing::Banked { select } = self.model.addressing else { return Ok(()) };
        let [bank, _] = register.to_be_bytes();
        if self.bank != Some(bank) {
            let access = Access::Write { register: u16::from(select), value: u16::from(bank) };
            let selected = self.i2c.write(self.model.address, &[select, bank]);
            selected.map_err(|error| self.failed(access, &error))?;
            self.bank = Some(bank);
        }
        Ok(())
    }

    fn failed(&mut self, access: Access, error: &I2C::Error) -> SensorError {
        use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
        self.bank = None;
        let (sensor, address) = (self.model.name, self.model.address);
        match error.kind() {
            // Many controllers can't tell what was not acknowledged; nearly always it is the address.
            ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address | NoAcknowledgeSource::Unknown) => {
                SensorError::NoAnswer { sensor, address, access }
            }
            kind => SensorError::Bus { sensor, address, access, kind },
        }
    }
}
