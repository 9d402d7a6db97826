//! A register table: what is done to a sensor's registers, step by step.

/// One step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Writes a register, which must read back as written.
    Write {
        /// The register.
        register: u16,
        /// Its value.
        value: u16,
    },
    /// Changes some bits of a register and leaves the others; it must read back so.
    Update {
        /// The register.
        register: u16,
        /// The bits to change.
        mask: u16,
        /// Their values.
        value: u16,
    },
    /// Writes a register that does not keep what is written: a reset, a bit that clears itself.
    Command {
        /// The register.
        register: u16,
        /// What is written.
        value: u16,
    },
    /// Waits.
    Wait {
        /// How long.
        microseconds: u32,
    },
}

/// [`Step::Write`].
#[must_use]
pub const fn write(register: u16, value: u16) -> Step {
    Step::Write { register, value }
}

/// [`Step::Update`].
#[must_use]
pub const fn update(register: u16, mask: u16, value: u16) -> Step {
    Step::Update { register, mask, value }
}

/// [`Step::Command`].
#[must_use]
pub const fn command(register: u16, value: u16) -> Step {
    Step::Command { register, value }
}

/// [`Step::Wait`].
#[must_use]
pub const fn wait(microseconds: u32) -> Step {
    Step::Wait { microseconds }
}

/// A table and its name, which errors tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Table {
    /// What errors call it.
    pub name: &'static str,
    /// The steps, in order.
    pub steps: &'static [Step],
}

impl Table {
    /// A table.
    #[must_use]
    pub const fn new(name: &'static str, steps: &'static [Step]) -> Self {
        Self { name, steps }
    }
}
