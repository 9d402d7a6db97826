use super::Chip;

/// A register file: addresses of 16 bits, of which a banked sensor's upper byte is the bank.
#[derive(Clone, Debug)]
pub struct Registers {
    values: Vec<u16>,
}

impl Registers {
    pub(super) fn new(chip: &Chip) -> Self {
        let mut values = vec![0; 1 << 16];
        for &(register, value) in chip.reset_values {
            values[usize::from(register)] = value;
        }
        Self { values }
    }

    /// The register's value.
    #[must_use]
    pub fn get(&self, register: u16) -> u16 {
        self.values[usize::from(register)]
    }

    pub(super) fn set(&mut self, register: u16, value: u16) {
        self.values[usize::from(register)] = value;
    }

    /// Whether a bit is set.
    pub(super) fn bit(&self, register: u16, bit: u32) -> bool {
        self.get(register) >> bit & 1 == 1
    }

    /// Some bits, from `low` up.
    pub(super) fn bits(&self, register: u16, low: u32, count: u32) -> u32 {
        u32::from(self.get(register)) >> low & ((1 << count) - 1)
    }

    /// Two registers as one number, the first its upper byte.
    pub(super) fn pair(&self, high: u16) -> u32 {
        u32::from(self.get(high)) << 8 | u32::from(self.get(high.wrapping_add(1)))
    }
}
