//! UART 0 of the board, CMSDK's (Arm DDI0479, 4.3): polled.

use core::convert::Infallible;

const DATA: *mut u32 = 0x4000_4000 as *mut u32;
const STATE: *mut u32 = 0x4000_4004 as *mut u32;
const CONTROL: *mut u32 = 0x4000_4008 as *mut u32;
const DIVIDER: *mut u32 = 0x4000_4010 as *mut u32;

/// STATE: the transmitter's byte has not left.
const SENDING: u32 = 1 << 0;
/// STATE: a byte was received.
const RECEIVED: u32 = 1 << 1;

/// The serial line, both ways.
#[derive(Debug)]
pub struct Uart(());

impl Uart {
    /// Switches it on, as fast as it goes: 25 MHz / 16. (QEMU has no rate, only a limit.)
    #[must_use]
    pub fn start() -> Self {
        // SAFETY: UART 0's registers by the boards' memory map, written whole; nobody else uses it.
        unsafe { DIVIDER.write_volatile(16) };
        // SAFETY: as above; enables transmitter and receiver, no interrupts.
        unsafe { CONTROL.write_volatile(0b11) };
        Self(())
    }

    fn state() -> u32 {
        // SAFETY: as in `start`; reading has no effect.
        unsafe { STATE.read_volatile() }
    }
}

impl embedded_io::ErrorType for Uart {
    type Error = Infallible;
}

impl embedded_io::Write for Uart {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for &byte in bytes {
            while Self::state() & SENDING != 0 {}
            // SAFETY: as in `start`; the transmitter has room.
            unsafe { DATA.write_volatile(byte.into()) };
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        while Self::state() & SENDING != 0 {}
        Ok(())
    }
}

impl embedded_io::ReadReady for Uart {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(Self::state() & RECEIVED != 0)
    }
}

impl embedded_io::Read for Uart {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        let mut count = 0;
        for place in bytes {
            // The first one is waited for, as the trait has it.
            while Self::state() & RECEIVED == 0 {
                if count > 0 {
                    return Ok(count);
                }
            }
            // SAFETY: as in `start`; takes the byte that was received.
            *place = unsafe { DATA.read_volatile() } as u8;
            count += 1;
        }
        Ok(count)
    }
}
