//! The registers of a DMA stream as numbers: RM0090 §10.5, RM0433 ch. 16. Both controllers have the same.

use firmware::port::{Burst, DmaEvents, DmaMode, Transfer};

/// EN of CR.
pub const ENABLE: u32 = 1;
/// CT of CR: target 1 is in use.
pub const CURRENT_TARGET: u32 = 1 << 19;

const TRANSFER_ERROR_INTERRUPT: u32 = 1 << 2;
const HALF_INTERRUPT: u32 = 1 << 3;
const COMPLETE_INTERRUPT: u32 = 1 << 4;
const CIRCULAR: u32 = 1 << 8;
const MEMORY_INCREMENT: u32 = 1 << 10;
const PERIPHERAL_WORD: u32 = 0b10 << 11;
const MEMORY_WORD: u32 = 0b10 << 13;
const VERY_HIGH_PRIORITY: u32 = 0b11 << 16;
const DOUBLE_BUFFER: u32 = 1 << 18;
const MEMORY_BURST_OF_FOUR: u32 = 0b01 << 23;

/// FCR: the FIFO, full before it is emptied; no interrupt on its errors. A burst of four words needs the whole of it (§10.3.11).
pub const FIFO: u32 = 1 << 2 | 0b11;

/// Flags of one stream, at bit 0.
pub const FLAGS: u32 = 0b11_1101;
const DIRECT_MODE_ERROR: u32 = 1 << 2;
const TRANSFER_ERROR: u32 = 1 << 3;
const HALF: u32 = 1 << 4;
const COMPLETE: u32 = 1 << 5;

/// Registers of a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream {
    /// The controller's base.
    pub dma: u32,
    /// 0 to 7.
    pub number: u32,
}

impl Stream {
    const fn register(self, offset: u32) -> u32 {
        self.dma + 0x10 + 0x18 * self.number + offset
    }

    /// SxCR.
    #[must_use]
    pub const fn control(self) -> u32 {
        self.register(0x00)
    }

    /// SxNDTR.
    #[must_use]
    pub const fn count(self) -> u32 {
        self.register(0x04)
    }

    /// SxPAR.
    #[must_use]
    pub const fn peripheral(self) -> u32 {
        self.register(0x08)
    }

    /// SxM0AR and SxM1AR.
    #[must_use]
    pub const fn memory(self, target: usize) -> u32 {
        self.register(0x0C + 4 * (target as u32 & 1))
    }

    /// SxFCR.
    #[must_use]
    pub const fn fifo(self) -> u32 {
        self.register(0x14)
    }

    /// LISR or HISR.
    #[must_use]
    pub const fn status(self) -> u32 {
        self.dma + if self.number < 4 { 0x00 } else { 0x04 }
    }

    /// LIFCR or HIFCR.
    #[must_use]
    pub const fn clear(self) -> u32 {
        self.status() + 0x08
    }

    /// Where in those this stream's flags stand.
    #[must_use]
    pub const fn shift(self) -> u32 {
        [0, 6, 16, 22][self.number as usize % 4]
    }

    /// What this stream's flags say.
    #[must_use]
    pub const fn events(self, status: u32) -> DmaEvents {
        let flags = status >> self.shift();
        DmaEvents {
            half: flags & HALF != 0,
            complete: flags & COMPLETE != 0,
            error: flags & (TRANSFER_ERROR | DIRECT_MODE_ERROR) != 0,
            line_words: 0,
        }
    }

    /// What clears these flags.
    #[must_use]
    pub const fn clearing(self, events: DmaEvents) -> u32 {
        let mut flags = 0;
        if events.half {
            flags |= HALF;
        }
        if events.complete {
            flags |= COMPLETE;
        }
        if events.error {
            flags |= TRANSFER_ERROR | DIRECT_MODE_ERROR;
        }
        flags << self.shift()
    }
}

/// CR for a transfer, without EN. `aligned`: both targets stand on 16 bytes, so that no burst crosses 1 KiB (§10.3.11).
#[must_use]
pub fn control(transfer: Transfer, aligned: bool, channel: u32) -> u32 {
    let mut control = TRANSFER_ERROR_INTERRUPT
        | COMPLETE_INTERRUPT
        | MEMORY_INCREMENT
        | PERIPHERAL_WORD
        | MEMORY_WORD
        | VERY_HIGH_PRIORITY
        | channel << 25;
    if transfer.half_interrupt {
        control |= HALF_INTERRUPT;
    }
    match transfer.mode {
        DmaMode::Single => {}
        DmaMode::Circular => control |= CIRCULAR,
        // Double-buffer mode is circular by itself (§10.3.9); the manual has CIRC be set as well.
        DmaMode::Double => control |= DOUBLE_BUFFER | CIRCULAR,
    }
    if aligned && transfer.burst == Burst::Four && transfer.words.is_multiple_of(4) {
        control |= MEMORY_BURST_OF_FOUR;
    }
    control
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRANSFER: Transfer = Transfer {
        words: 400,
        mode: DmaMode::Double,
        burst: Burst::Four,
        line_by_line: false,
        half_interrupt: false,
    };

    #[test]
    fn registers_stand_where_the_manuals_have_them() {
        let stream = Stream { dma: 0x4002_6400, number: 1 };
        assert_eq!(stream.control(), 0x4002_6428);
        assert_eq!(stream.count(), 0x4002_642C);
        assert_eq!(stream.peripheral(), 0x4002_6430);
        assert_eq!([0, 1].map(|target| stream.memory(target)), [0x4002_6434, 0x4002_6438]);
        assert_eq!(stream.fifo(), 0x4002_643C);
        assert_eq!((stream.status(), stream.clear(), stream.shift()), (0x4002_6400, 0x4002_6408, 6));
        let stream = Stream { dma: 0x4002_6400, number: 7 };
        assert_eq!((stream.status(), stream.clear(), stream.shift()), (0x4002_6404, 0x4002_640C, 22));
        assert_eq!(stream.control(), 0x4002_64B8);
    }

    #[test]
    fn a_frame_by_double_buffer_in_bursts() {
        // CHSEL 1, MBURST INCR4, DBM, PL very high, MSIZE and PSIZE word, MINC, CIRC, TCIE, TEIE.
        assert_eq!(control(TRANSFER, true, 1), 0x0287_5514);
        assert_eq!(control(TRANSFER, false, 0), 0x0007_5514, "single words where a burst could cross 1 KiB");
        let single = Transfer { mode: DmaMode::Single, half_interrupt: true, words: 401, ..TRANSFER };
        assert_eq!(control(single, true, 0), 0x0003_541C);
    }

    #[test]
    fn flags_are_told_and_cleared_in_their_place() {
        for number in 0..8 {
            let stream = Stream { dma: 0, number };
            for bits in 0..64 {
                let events = stream.events(bits << stream.shift());
                assert_eq!(events.half, bits & 1 << 4 != 0);
                assert_eq!(events.complete, bits & 1 << 5 != 0);
                assert_eq!(events.error, bits & 0b1100 != 0);
                assert_eq!(stream.events(!(FLAGS << stream.shift())), DmaEvents::default());
                assert_eq!(stream.events(stream.clearing(events)), events);
            }
        }
    }
}
