//! Where frames and lines start and end, and what that does.

use super::block::Camif;
use super::embedded::Found;
use super::pins::{Pins, Sync};
use super::registers::FrameRate;
use super::selection::Selection;

impl Camif<'_> {
    /// A sync wire changed, or this is the first clock since ENABLE.
    pub(super) fn sync_changed(&mut self, sync: Sync) {
        // "On" is blanking for gated wires and the marker itself for marking ones.
        let on = |levels: Sync| {
            (levels.hsync == self.control.hsync_blank_high(), levels.vsync == self.control.vsync_blank_high())
        };
        let before = self.levels.map(on);
        let (h, v) = on(sync);
        self.levels = Some(sync);
        let line_ends = before.is_some_and(|(before, _)| !before) && h;
        let frame_ends = before.is_some_and(|(_, before)| !before) && v;
        if line_ends || frame_ends {
            self.line_end();
        }
        if line_ends {
            self.raised.set_line(true);
        }
        if frame_ends {
            self.frame_end();
        }
        if self.extension.marker() {
            // Every clock carries data. The stream's first one starts a frame, as every marker does.
            if before.is_none() || frame_ends {
                self.frame_start();
            }
            if before.is_none() || frame_ends || line_ends {
                self.line_start();
            }
        } else {
            if before.is_some_and(|(_, before)| before) && !v {
                self.frame_start();
            }
            if self.in_frame && !h && !v && !self.in_line {
                self.line_start();
            }
        }
    }

    pub(super) fn embedded(&mut self, pins: Pins) {
        match self.decoder.push(pins.data as u8, self.codes, self.unmask) {
            Found::Nothing => {}
            Found::Data(byte) => self.sample(u32::from(byte)),
            Found::FrameStart => self.frame_start(),
            Found::FrameAndLineStart => {
                self.frame_start();
                self.line_start();
            }
            Found::LineStart => self.line_start(),
            Found::LineEnd => {
                self.line_end();
                self.raised.set_line(true);
            }
            Found::FrameEnd => self.frame_end(),
            Found::Error => {
                self.raised.set_error(true);
                self.in_line = false;
                self.lose_frame();
            }
        }
    }

    fn frame_start(&mut self) {
        self.in_frame = true;
        self.line = 0;
        self.bytes_before_line = 0;
        self.lines_taken = 0;
        self.capturing = self.control.capture() && self.takes_frame();
        self.frame_selection = if self.capturing {
            Selection::new(self.control, self.crop_start, self.crop_size)
        } else {
            Selection::NOTHING
        };
    }

    /// FCRC: this frame is one of those taken. Snapshots take any; the reserved rate takes all.
    fn takes_frame(&mut self) -> bool {
        let every = match self.control.frame_rate() {
            _ if self.control.snapshot() => 1,
            Ok(FrameRate::Half) => 2,
            Ok(FrameRate::Quarter) => 4,
            Ok(FrameRate::All) | Err(_) => 1,
        };
        let takes = self.frames_started.is_multiple_of(every);
        self.frames_started = self.frames_started.wrapping_add(1);
        takes
    }

    fn line_start(&mut self) {
        self.in_line = true;
        self.x = 0;
        self.bytes_in_line = 0;
        self.selection = if self.frame_selection.takes_line(self.line) {
            self.frame_selection
        } else {
            Selection::NOTHING
        };
    }

    fn line_end(&mut self) {
        if !self.in_line {
            return;
        }
        self.in_line = false;
        let taken = self.selection != Selection::NOTHING;
        self.selection = Selection::NOTHING;
        self.line_bytes = self.bytes_in_line;
        self.line += 1;
        if taken {
            self.lines_taken += 1;
            self.bytes_before_line += self.bytes_in_line;
            if self.dma.control.line_by_line() && self.bytes_in_line > 0 {
                self.pad();
                if self.capturing && !self.fifo.mark_last() {
                    self.dma.complete();
                }
            }
        }
        if self.capturing && self.frame_selection.is_past(self.line) {
            self.frame_complete();
        }
    }

    fn frame_end(&mut self) {
        self.raised.set_vsync(true);
        self.in_frame = false;
        if self.capturing {
            self.frame_complete();
        }
        // A snapshot that was overtaken by the crop window's end has nothing left to capture either.
        if self.frame_selection != Selection::NOTHING && self.control.snapshot() {
            self.control.set_capture(false);
        }
        self.stop_capturing();
        self.frame_selection = Selection::NOTHING;
    }

    /// The frame, or its crop window, is complete.
    fn frame_complete(&mut self) {
        if self.control.jpeg() {
            self.pad();
        }
        self.packer.clear();
        self.fifo.mark_last();
        if self.capturing {
            self.capturing = false;
            self.frame_bytes = self.bytes_before_line;
            self.frame_lines = self.lines_taken;
            self.raised.set_frame(true);
        }
    }

    /// Between frames, as SR.VSYNC shows it.
    pub(super) fn between_frames(&self) -> bool {
        match self.levels {
            _ if self.control.embedded_sync() => !self.decoder.in_frame(),
            Some(levels) => levels.vsync == self.control.vsync_blank_high(),
            None => false,
        }
    }

    /// Between lines, as SR.HSYNC shows it.
    pub(super) fn between_lines(&self) -> bool {
        match self.levels {
            _ if self.control.embedded_sync() => !self.decoder.in_line(),
            Some(levels) => levels.hsync == self.control.hsync_blank_high(),
            None => false,
        }
    }
}
