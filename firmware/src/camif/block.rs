//! The block's state, and one pixel clock of it.

use super::bus::Bus;
use super::dma::BurstDma;
use super::embedded::Decoder;
use super::fifo::{Fifo, Packer};
use super::part::Part;
use super::pins::{Edge, Pins, Sync};
use super::registers::{Control, CropSize, CropStart, Events, Extension, SyncCodes};
use super::selection::Selection;

/// The camera interface: registers, synchronisation, FIFO and burst DMA.
///
/// Pure: its time is the pixel clock, its memory is what was lent to it, and it is a function of its calls.
#[derive(Debug, PartialEq, Eq)]
pub struct Camif<'m> {
    pub(super) part: Part,
    pub(super) bus: Bus,
    /// Bus time in pixel clocks; goes on when the pixel clock stands still.
    pub(super) clock: u64,

    pub(super) control: Control,
    pub(super) extension: Extension,
    pub(super) raised: Events,
    pub(super) enabled_events: Events,
    pub(super) codes: SyncCodes,
    pub(super) unmask: SyncCodes,
    pub(super) crop_start: CropStart,
    pub(super) crop_size: CropSize,
    pub(super) line_bytes: u32,
    pub(super) frame_bytes: u32,
    pub(super) frame_lines: u32,

    /// Levels at the last clock; unknown since ENABLE.
    pub(super) levels: Option<Sync>,
    pub(super) decoder: Decoder,
    /// Inside a frame, captured or not.
    pub(super) in_frame: bool,
    /// Inside a line of a frame: clocks are counted.
    pub(super) in_line: bool,
    /// This frame goes to memory.
    pub(super) capturing: bool,
    /// CAPTURE was cleared by software during a frame: it reads 1 until the frame ends.
    stopping: bool,
    /// Frames that started since CAPTURE was set, for FCRC.
    pub(super) frames_started: u32,
    /// What this frame takes.
    pub(super) frame_selection: Selection,
    /// What this line takes.
    pub(super) selection: Selection,
    /// Line of the frame, from 0.
    pub(super) line: u32,
    /// Clock of the line, from 0.
    pub(super) x: u32,
    /// Bytes taken of this line.
    pub(super) bytes_in_line: u32,
    pub(super) bytes_before_line: u32,
    pub(super) lines_taken: u32,

    /// Masks a sample to the bus width.
    pub(super) data_mask: u32,
    /// Bits of a sample in memory: 8 or 16.
    pub(super) sample_bits: u32,
    pub(super) packer: Packer,
    pub(super) fifo: Fifo,

    pub(super) dma: BurstDma<'m>,
    /// Clock at which the pending request is granted; [`NEVER`] without one.
    pub(super) grant_at: u64,
    /// Requests made so far.
    pub(super) requests: u64,
    /// A request that was withdrawn still holds the bus until then.
    pub(super) bus_busy_until: u64,
}

/// No request is pending.
pub(super) const NEVER: u64 = u64::MAX;

/// Levels of the block's interrupt lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Interrupts {
    /// MIS is not 0.
    pub camif: bool,
    /// A flag of the DMA is set and enabled.
    pub dma: bool,
}

impl Interrupts {
    /// At least one line is active.
    #[must_use]
    pub fn any(self) -> bool {
        self.camif || self.dma
    }

    /// A line is active that was not before.
    #[must_use]
    pub(super) fn rose_since(self, before: Self) -> bool {
        (self.camif && !before.camif) || (self.dma && !before.dma)
    }
}

impl Camif<'_> {
    /// A block as it is after reset, on this part's abilities and this bus.
    #[must_use]
    pub fn new(part: Part, bus: Bus) -> Self {
        let control = Control::new_with_raw_value(0);
        let (crop_start, crop_size) = (CropStart::new_with_raw_value(0), CropSize::new_with_raw_value(0));
        Self {
            part,
            bus,
            clock: 0,
            control,
            extension: Extension::new_with_raw_value(0),
            raised: Events::new_with_raw_value(0),
            enabled_events: Events::new_with_raw_value(0),
            codes: SyncCodes::new_with_raw_value(0),
            unmask: SyncCodes::new_with_raw_value(0),
            crop_start,
            crop_size,
            line_bytes: 0,
            frame_bytes: 0,
            frame_lines: 0,
            levels: None,
            decoder: Decoder::default(),
            in_frame: false,
            in_line: false,
            capturing: false,
            stopping: false,
            frames_started: 0,
            frame_selection: Selection::NOTHING,
            selection: Selection::NOTHING,
            line: 0,
            x: 0,
            bytes_in_line: 0,
            bytes_before_line: 0,
            lines_taken: 0,
            data_mask: 0xFF,
            sample_bits: 8,
            packer: Packer::default(),
            fifo: Fifo::default(),
            dma: BurstDma::default(),
            grant_at: NEVER,
            requests: 0,
            bus_busy_until: 0,
        }
    }

    /// Levels of the interrupt lines.
    #[must_use]
    #[inline]
    pub fn interrupts(&self) -> Interrupts {
        let camif = self.raised.raw_value() & self.enabled_events.raw_value() != 0;
        Interrupts { camif, dma: self.dma.interrupt() }
    }

    /// The bus, to change its latency between calls.
    pub fn bus_mut(&mut self) -> &mut Bus {
        &mut self.bus
    }

    /// Requests that the DMA has made of the bus since the block was made.
    #[must_use]
    pub fn requests(&self) -> u64 {
        self.requests
    }

    /// Words in the FIFO.
    #[must_use]
    pub fn fifo_level(&self) -> usize {
        self.fifo.len()
    }

    /// An edge of the pixel clock: the pins are sampled if it is the one that PCKPOL selects.
    pub fn clock_edge(&mut self, edge: Edge, pins: Pins) {
        if self.control.sample_on_rising() == (edge == Edge::Rising) {
            self.step(pins);
        }
    }

    /// One pixel clock, with the pins as they are at its active edge.
    #[inline]
    pub fn step(&mut self, pins: Pins) {
        self.clock += 1;
        if self.grant_at <= self.clock {
            self.grant();
        }
        if self.control.enable() {
            if self.control.embedded_sync() {
                self.embedded(pins);
            } else {
                if self.levels != Some(pins.sync) {
                    self.sync_changed(pins.sync);
                }
                if self.in_line {
                    self.sample(u32::from(pins.data));
                }
            }
        }
        self.request();
    }

    /// Bus time passes while the pixel clock stands still.
    pub fn elapse(&mut self, clocks: u64) {
        let end = self.clock + clocks;
        self.request();
        while self.grant_at <= end {
            self.clock = self.clock.max(self.grant_at);
            self.grant();
            self.request();
        }
        self.clock = end;
    }

    /// Holds the capture side in reset, as ENABLE = 0 does.
    pub(super) fn reset_capture(&mut self) {
        self.levels = None;
        self.decoder = Decoder::default();
        self.in_frame = false;
        self.in_line = false;
        self.selection = Selection::NOTHING;
        self.stop_capturing();
        self.empty();
    }

    /// CAPTURE was written.
    pub(super) fn set_capture(&mut self, capture: bool) {
        if capture {
            self.stopping = false;
            if !self.control.capture() {
                self.frames_started = 0;
            }
            self.control.set_capture(true);
        } else if self.capturing {
            self.stopping = true;
        } else {
            self.control.set_capture(false);
        }
    }

    /// The pending request is granted: a burst moves.
    fn grant(&mut self) {
        self.grant_at = NEVER;
        // The request made last is the one that is granted.
        if self.bus.error.is_some() && self.bus.error == self.requests.checked_sub(1) {
            return self.dma.fail();
        }
        let burst = self.dma.burst_words();
        // A whole burst before the next event goes in one piece.
        if !self.fifo.holds_last()
            && self.fifo.len() as u32 >= burst
            && self.dma.words_before_event() >= burst
            && let Some(window) = self.dma.window(burst as usize)
        {
            for place in window {
                if let Some((word, _)) = self.fifo.pop() {
                    *place = word;
                }
            }
            self.dma.remaining -= burst;
            return;
        }
        for _ in 0..burst {
            let Some((word, last)) = self.fifo.pop() else { break };
            self.dma.store(word, last);
            if last {
                break;
            }
        }
    }

    /// A burst is due: enough words wait, or the last of a line or frame.
    #[inline]
    pub(super) fn wants_bus(&self) -> bool {
        self.dma.is_due(self.fifo.pressure())
    }

    /// Asks for the bus, if a burst is due and no request is pending.
    #[inline]
    fn request(&mut self) {
        if self.grant_at == NEVER && self.wants_bus() {
            let delay = self.bus.delay(self.requests);
            self.requests += 1;
            self.grant_at = (self.clock + 1 + u64::from(delay)).max(self.bus_busy_until);
        }
    }

    /// An incomplete word goes to the FIFO, padded with zeros.
    pub(super) fn pad(&mut self) {
        if let Some(word) = self.packer.flush()
            && !self.fifo.push(word)
        {
            self.overrun();
        }
    }

    #[inline]
    pub(super) fn sample(&mut self, data: u32) {
        let x = self.x;
        self.x = x.wrapping_add(1);
        if !self.selection.takes_clock(x) {
            return;
        }
        self.bytes_in_line += self.sample_bits / 8;
        if let Some(word) = self.packer.push(data & self.data_mask, self.sample_bits)
            && !self.fifo.push(word)
        {
            self.overrun();
        }
    }

    fn overrun(&mut self) {
        self.raised.set_overrun(true);
        if self.control.snapshot() {
            self.control.set_capture(false);
        }
        self.lose_frame();
    }

    /// Empties the FIFO and waits for the next frame start.
    pub(super) fn lose_frame(&mut self) {
        self.empty();
        self.selection = Selection::NOTHING;
        self.frame_selection = Selection::NOTHING;
        self.stop_capturing();
    }

    pub(super) fn stop_capturing(&mut self) {
        self.capturing = false;
        if core::mem::take(&mut self.stopping) {
            self.control.set_capture(false);
        }
    }

    fn empty(&mut self) {
        self.packer.clear();
        self.fifo.clear();
        self.withdraw_request();
    }

    /// Takes a pending request back; the bus is not free any sooner for it.
    pub(super) fn withdraw_request(&mut self) {
        if self.grant_at != NEVER {
            self.bus_busy_until = self.grant_at;
            self.grant_at = NEVER;
        }
    }
}
