use super::readout::{Readout, Silent};
use super::registers::Registers;
use super::{CHIPS, Chip};

/// How a sensor is mounted: what of it does not stand in its registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mounting {
    /// Its input clock, in hertz; 0 if there is none.
    pub input_hz: u32,
    /// Data wires that are connected: 8 or 10, the uppermost ones.
    pub wires: u32,
    /// The monochrome part, where the sensor exists as one.
    pub monochrome: bool,
}

/// A sensor on an I2C bus, with registers that matter.
///
/// The bus side is byte by byte, [`start`](Self::start), [`write`](Self::write), [`read`](Self::read) and
/// [`stop`](Self::stop), so that any model of an I2C controller can drive it; [`VirtualBus`](super::VirtualBus) does so
/// for `embedded-hal`. The pin side is [`readout`](Self::readout).
#[derive(Clone, Debug)]
pub struct VirtualSensor {
    chip: &'static Chip,
    mounting: Mounting,
    registers: Registers,
    transfer: Transfer,
    /// The register that the next byte goes to or comes from.
    pointer: u16,
    bank: u8,
    /// The half of a register of 16 bits that has been written.
    half: Option<u8>,
}

/// Where in a transfer the bus is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Transfer {
    /// Between stop and start, or another's turn.
    Idle,
    /// So many bytes of the address have come.
    Address(u8),
    /// Data is being written.
    Writing,
    /// Data is being read; whether the next byte is the lower one of two.
    Reading { lower: bool },
}

impl VirtualSensor {
    /// The sensors' names.
    pub fn names() -> impl Iterator<Item = &'static str> {
        CHIPS.iter().map(|chip| chip.name)
    }

    /// A sensor of this name after power-up.
    #[must_use]
    pub fn new(name: &str, mounting: Mounting) -> Option<Self> {
        let chip = CHIPS.iter().find(|chip| chip.name == name)?;
        Some(Self {
            chip,
            mounting,
            registers: Registers::new(chip),
            transfer: Transfer::Idle,
            pointer: 0,
            bank: 0,
            half: None,
        })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.chip.name
    }

    /// Its address, 7 bits.
    #[must_use]
    pub fn address(&self) -> u8 {
        self.chip.address
    }

    /// How it is mounted.
    #[must_use]
    pub fn mounting(&self) -> Mounting {
        self.mounting
    }

    /// Its registers.
    #[must_use]
    pub fn registers(&self) -> &Registers {
        &self.registers
    }

    /// Writes a register as a bus master would.
    pub fn poke(&mut self, register: u16, value: u16) {
        self.store(register, value);
    }

    /// What comes out on its pins.
    ///
    /// # Errors
    /// [`Silent`] if nothing does.
    pub fn readout(&self) -> Result<Readout, Silent> {
        if self.mounting.input_hz == 0 {
            return Err(Silent::NoClock);
        }
        (self.chip.decode)(&self.registers, &self.mounting)
    }

    /// A start, or a repeated one, and the address of 7 bits. Whether it acknowledges.
    pub fn start(&mut self, address: u8, read: bool) -> bool {
        let repeated = self.transfer != Transfer::Idle;
        self.half = None;
        self.transfer = match () {
            () if address != self.chip.address || self.mounting.input_hz == 0 => Transfer::Idle,
            () if repeated && !self.chip.layout.repeated_start => Transfer::Idle,
            () if read => Transfer::Reading { lower: false },
            () => Transfer::Address(0),
        };
        self.transfer != Transfer::Idle
    }

    /// A byte from the master. Whether it is acknowledged.
    pub fn write(&mut self, byte: u8) -> bool {
        let layout = self.chip.layout;
        match self.transfer {
            Transfer::Idle | Transfer::Reading { .. } => return false,
            Transfer::Address(come) => {
                self.pointer = if come == 0 { u16::from(byte) } else { self.pointer << 8 | u16::from(byte) };
                let come = come + 1;
                self.transfer =
                    if come == layout.address_bytes { Transfer::Writing } else { Transfer::Address(come) };
            }
            Transfer::Writing if layout.data_bytes == 2 => match self.half.take() {
                None => self.half = Some(byte),
                Some(high) => {
                    self.store(self.pointer, u16::from_be_bytes([high, byte]));
                    self.pointer = self.pointer.wrapping_add(1);
                }
            },
            Transfer::Writing => {
                let register = self.banked(self.pointer);
                if layout.bank_select.is_some_and(|select| u16::from(select) == self.pointer) {
                    self.bank = byte;
                } else {
                    self.store(register, u16::from(byte));
                }
                self.pointer = self.pointer.wrapping_add(1);
            }
        }
        true
    }

    /// A byte to the master; 0xFF, the idle bus, if it is not being read.
    pub fn read(&mut self) -> u8 {
        let Transfer::Reading { lower } = self.transfer else { return 0xFF };
        let wide = self.chip.layout.data_bytes == 2;
        let value = match self.chip.layout.bank_select {
            Some(select) if u16::from(select) == self.pointer => u16::from(self.bank),
            _ => self.registers.get(self.banked(self.pointer)),
        };
        let [high, low] = value.to_be_bytes();
        if wide && !lower {
            self.transfer = Transfer::Reading { lower: true };
            return high;
        }
        self.transfer = Transfer::Reading { lower: false };
        self.pointer = self.pointer.wrapping_add(1);
        low
    }

    /// A stop.
    pub fn stop(&mut self) {
        self.transfer = Transfer::Idle;
        self.half = None;
    }

    fn banked(&self, register: u16) -> u16 {
        match self.chip.layout.bank_select {
            Some(_) => u16::from_be_bytes([self.bank, register.to_be_bytes()[1]]),
            None => register,
        }
    }

    fn store(&mut self, register: u16, value: u16) {
        if (self.chip.resets)(register, value) {
            self.registers = Registers::new(self.chip);
            self.bank = 0;
        } else if !self.chip.read_only.contains(&register) {
            self.registers.set(register, value);
        }
    }
}
