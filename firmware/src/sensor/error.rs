use core::fmt;

use embedded_hal::{digital, i2c};

/// What was being done to a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Reading it.
    Read {
        /// The register.
        register: u16,
    },
    /// Writing it.
    Write {
        /// The register.
        register: u16,
        /// What was written.
        value: u16,
    },
}

impl fmt::Display for Access {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Read { register } => write!(f, "reading register {register:#04x}"),
            Self::Write { register, value } => write!(f, "writing {value:#04x} to register {register:#04x}"),
        }
    }
}

/// Why a sensor was not brought up; displayed with what to check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SensorError {
    /// Nobody acknowledges the address.
    NoAnswer {
        /// The sensor expected.
        sensor: &'static str,
        /// Its address, 7 bits.
        address: u8,
        /// What was being done.
        access: Access,
    },
    /// The transfer failed in another way.
    Bus {
        /// The sensor.
        sensor: &'static str,
        /// Its address, 7 bits.
        address: u8,
        /// What was being done.
        access: Access,
        /// How it failed.
        kind: i2c::ErrorKind,
    },
    /// It is another sensor.
    WrongIdentity {
        /// The sensor expected.
        sensor: &'static str,
        /// The register that tells.
        register: u16,
        /// What it holds in the sensor expected.
        expected: u16,
        /// What it holds.
        found: u16,
    },
    /// A register does not hold what was written.
    NotHeld {
        /// The sensor.
        sensor: &'static str,
        /// The table.
        table: &'static str,
        /// The step of the table, counted from 0.
        step: usize,
        /// The register.
        register: u16,
        /// What was written.
        written: u16,
        /// What was read.
        found: u16,
    },
    /// None of the models that were tried is there.
    NotFound {
        /// How many were tried.
        tried: usize,
    },
    /// A pin could not be set.
    Pin {
        /// Which.
        name: &'static str,
        /// Why.
        kind: digital::ErrorKind,
    },
}

impl fmt::Display for SensorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoAnswer { sensor, address, access } => write!(
                f,
                "no {sensor} answers at address {address:#04x} ({access}); check its supplies, that its clock runs, that reset is high and power-down low, SDA and SCL and their pull-ups"
            ),
            Self::Bus { sensor, address, access, kind } => write!(
                f,
                "the bus failed while {access} of {sensor} at address {address:#04x}: {kind}; check the pull-ups of SDA and SCL, their length and the bus clock (100 kHz is slow enough for all)"
            ),
            Self::WrongIdentity { sensor, register, expected, found } => write!(
                f,
                "this is no {sensor}: register {register:#04x} holds {found:#04x}, not {expected:#04x}; {}",
                match found {
                    0 | 0xFF | 0xFFFF =>
                        "all bits alike means that nobody drives SDA: check the wire and that the sensor's clock runs",
                    _ => "check which sensor the module has",
                }
            ),
            Self::NotHeld { sensor, table, step, register, written, found } => write!(
                f,
                "register {register:#04x} of {sensor} holds {found:#04x} after {written:#04x} was written (step {step} of table `{table}`); check that the sensor's clock is steady and its supplies do not sag, and that it is not held in reset"
            ),
            Self::NotFound { tried } => write!(
                f,
                "none of the {tried} sensors known answers; check the sensor's supplies, that its clock runs, that reset is high and power-down low, SDA and SCL and their pull-ups"
            ),
            Self::Pin { name, kind } => write!(f, "the {name} pin cannot be set: {kind}"),
        }
    }
}

impl core::error::Error for SensorError {}
