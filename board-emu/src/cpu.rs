//! What the core is doing: its registers at a stop, and the words for them.
//!
//! The emulator hands its core's registers out as part of the state that it saves: `R0` to `R15`, the flags, and what
//! follows, as variable-length integers (postcard). The version of the emulator is pinned, and a test holds this reading to
//! an image whose place is known.

use serde::Serialize;

use crate::report::Ending;
use crate::run::{LastAccess, QUIET};
use crate::symbols::Symbols;

/// Registers of the core.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Registers {
    /// LR.
    pub link: u64,
    /// The address of the next instruction.
    pub program_counter: u64,
    /// The exception that is handled; 0 in thread mode.
    pub exception: u64,
    /// A fault came in a fault's handler: nothing runs any more.
    pub locked_up: bool,
    /// WFI or WFE, and nothing came since.
    pub sleeping: bool,
}

/// Places of the registers in the saved state, in integers from its beginning.
const LINK: usize = 14;
const PROGRAM_COUNTER: usize = 15;
const EXCEPTION: usize = 24;
const LOCKED_UP: usize = 62;
const SLEEPING: usize = 63;

impl Registers {
    /// Out of the emulator's saved state; `None` if it is shorter than that.
    #[must_use]
    pub fn read(mut saved: &[u8]) -> Option<Self> {
        // The core's own state stands first, behind its length.
        integer(&mut saved)?;
        let mut values = [0; SLEEPING + 1];
        for value in &mut values {
            *value = integer(&mut saved)?;
        }
        Some(Self {
            link: values[LINK] & !1,
            program_counter: values[PROGRAM_COUNTER],
            exception: values[EXCEPTION],
            locked_up: values[LOCKED_UP] != 0,
            sleeping: values[SLEEPING] != 0,
        })
    }
}

/// Takes an integer of seven bits a byte, the lowest first.
fn integer(bytes: &mut &[u8]) -> Option<u64> {
    let mut value = 0_u64;
    for shift in (0..64).step_by(7) {
        let (&byte, rest) = bytes.split_first()?;
        *bytes = rest;
        value |= u64::from(byte & 0x7F) << shift;
        if byte & 0x80 == 0 {
            return Some(value);
        }
    }
    None
}

/// The exception's name (Armv7-M Architecture Reference Manual, B1.5.2).
fn exception_name(number: u64) -> String {
    match number {
        2 => "NMI".into(),
        3 => "HardFault".into(),
        4 => "MemManage".into(),
        5 => "BusFault".into(),
        6 => "UsageFault".into(),
        11 => "SVCall".into(),
        12 => "DebugMonitor".into(),
        14 => "PendSV".into(),
        15 => "SysTick".into(),
        16.. => format!("interrupt {}", number - 16),
        _ => format!("exception {number}"),
    }
}

/// What the core was doing at the end.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Core {
    /// `asleep`, `polling` a peripheral, `computing` without touching one, or `locked-up` by a fault in a fault's handler.
    pub state: &'static str,
    /// The next instruction and its function.
    pub at: Option<String>,
    /// What LR holds, if it lies in a function: often, but not always, who called that function.
    pub link: Option<String>,
    /// The exception whose handler runs; `None` outside of handlers.
    pub handles: Option<String>,
    /// The last access to a peripheral: the instruction and its function.
    pub last_access_by: Option<String>,
    /// The peripheral's address.
    pub last_access_to: Option<String>,
    /// When that was, in virtual nanoseconds.
    pub last_access_at: Option<u64>,
}

impl Core {
    pub(crate) fn of(
        ending: Ending,
        registers: Option<Registers>,
        idle: bool,
        last: Option<LastAccess>,
        now: u64,
        symbols: &Symbols,
    ) -> Self {
        let polls = last.is_some_and(|last| last.at + QUIET / 2 > now);
        let state = match registers {
            Some(Registers { locked_up: true, .. }) => "locked-up",
            _ if idle || registers.is_some_and(|registers| registers.sleeping) => "asleep",
            _ if ending == Ending::Hung && polls => "polling",
            _ => "computing",
        };
        let link = registers.filter(|registers| symbols.name(registers.link).is_some());
        let exception = registers.map(|registers| registers.exception).filter(|&number| number != 0);
        Self {
            state,
            at: registers.map(|registers| symbols.describe(registers.program_counter)),
            link: link.map(|registers| symbols.describe(registers.link)),
            handles: exception.map(exception_name),
            last_access_by: last.map(|last| symbols.describe(last.program_counter)),
            last_access_to: last.map(|last| format!("{:#010x}", last.address)),
            last_access_at: last.map(|last| last.at),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn registers_stand_where_the_emulator_saves_them() {
        let mut saved = vec![0xC8, 0x01];
        for place in 0..=SLEEPING {
            match place {
                LINK => saved.extend([0xB5, 0x80, 0x80, 0x40]),
                PROGRAM_COUNTER => saved.extend([0x80, 0x82, 0x80, 0x40]),
                EXCEPTION => saved.push(3),
                SLEEPING => saved.push(1),
                _ => saved.push(0),
            }
        }
        let registers = Registers::read(&saved).unwrap();
        let expected = Registers {
            link: 0x0800_0034,
            program_counter: 0x0800_0100,
            exception: 3,
            locked_up: false,
            sleeping: true,
        };
        assert_eq!(registers, expected);
        assert_eq!(exception_name(registers.exception), "HardFault");
        assert_eq!(exception_name(94), "interrupt 78");
        assert_eq!(Registers::read(&saved[..saved.len() - 1]), None);
    }
}
