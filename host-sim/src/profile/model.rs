use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;
use firmware::camif::pins::Edge;

use super::Choice;

/// What a receiver must know of a camera, and a virtual sensor of the camera it plays.
///
/// The numbers below are those of a profile that passed [`Profile::check`], as every profile that was read has;
/// for others they saturate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Profile {
    /// What reports call it.
    pub name: String,
    /// One line for people.
    pub about: String,
    /// What the wires mean.
    pub bus: Bus,
    /// What a frame holds.
    pub frame: Frame,
    /// When things happen.
    pub timing: Timing,
}

/// What the wires mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bus {
    /// Data wires: 8, 10, 12 or 14.
    pub bits: u32,
    /// The edge on which data is stable.
    pub clock_edge: Edge,
    /// How lines and frames are told apart.
    pub sync: SyncMode,
    /// `gated`: the level of HSYNC at which data is not valid; `marker`: its active level; `embedded`: of no meaning.
    pub hsync_blank: Level,
    /// The same for VSYNC.
    pub vsync_blank: Level,
}

/// What a frame holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Pixels a line, 1 to 8,192.
    pub width: u32,
    /// Lines, 1 to 8,192.
    pub height: u32,
    /// How pixels stand on the bus.
    pub format: Format,
    /// Which colour the mosaic starts with; of meaning for the raw formats only.
    pub bayer: BayerOrder,
}

/// When things happen.
///
/// ```text
///            frame n                                   frame n+1
///  data  ▓▓▓▓▓…▓▓▓▓▓ ◄──────────── vblank ──────────► ▓▓▓▓▓…
/// VSYNC  ___________ ◄vfront►┌───────────┐◄─ vback ─► ______     vsync_blank = "high"
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// Pixel clocks a second.
    pub pclk_hz: u32,
    /// Pixel clocks from the last sample of a line to the first of the next; with embedded sync, its codes included.
    pub hblank: u32,
    /// Pixel clocks from the last sample of a frame to the first of the next, lines of blanking and all.
    pub vblank: u32,
    /// The part of `vblank` before VSYNC takes its blanking level (front porch); `gated` only.
    pub vfront: u32,
    /// The part of `vblank` after VSYNC left its blanking level (back porch); `gated` only.
    pub vback: u32,
}

/// How lines and frames are told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SyncMode {
    /// The sync wires have a blanking level, and data counts only outside it.
    Gated,
    /// Every pixel clock carries data, and an edge of the sync wires says that a line or frame has ended.
    Marker,
    /// Codes in the data (`FF 00 00 XY`), as in ITU-R BT.656.
    Embedded,
}

impl Choice for SyncMode {
    const NAMES: &'static [(&'static str, Self)] =
        &[("gated", Self::Gated), ("marker", Self::Marker), ("embedded", Self::Embedded)];
}

/// The level of a wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Level {
    /// 0.
    Low,
    /// 1.
    High,
}

impl Choice for Level {
    const NAMES: &'static [(&'static str, Self)] = &[("low", Self::Low), ("high", Self::High)];
}

impl Level {
    /// Whether the wire is high.
    #[must_use]
    pub const fn is_high(self) -> bool {
        matches!(self, Self::High)
    }
}

impl Bus {
    /// Bytes that DMA writes for a sample: buses wider than 8 bits zero-extend each sample to 16 bits.
    #[must_use]
    pub const fn bytes_per_sample(&self) -> u32 {
        if self.bits > 8 { 2 } else { 1 }
    }
}

impl Profile {
    /// Samples a line, that is pixel clocks that carry data.
    #[must_use]
    pub const fn samples_per_line(&self) -> u32 {
        self.frame.width.saturating_mul(self.frame.samples_per_pixel())
    }

    /// Bytes that DMA writes for a line.
    #[must_use]
    pub const fn bytes_per_line(&self) -> u32 {
        self.samples_per_line().saturating_mul(self.bus.bytes_per_sample())
    }

    /// Bytes that DMA writes for a frame.
    #[must_use]
    pub const fn bytes_per_frame(&self) -> u64 {
        (self.bytes_per_line() as u64).saturating_mul(self.frame.height as u64)
    }

    /// 32-bit words that DMA moves for a frame, the last one padded.
    #[must_use]
    pub const fn words_per_frame(&self) -> u64 {
        self.bytes_per_frame().div_ceil(4)
    }

    /// Pixel clocks from the first sample of a line to the first of the next.
    #[must_use]
    pub const fn clocks_per_line(&self) -> u64 {
        self.samples_per_line() as u64 + self.timing.hblank as u64
    }

    /// Pixel clocks from the first sample of a frame to the first of the next.
    #[must_use]
    pub const fn clocks_per_frame(&self) -> u64 {
        // The last line's blanking is part of the frame's.
        self.clocks_per_line()
            .saturating_mul(self.frame.height as u64)
            .saturating_sub(self.timing.hblank as u64)
            .saturating_add(self.timing.vblank as u64)
    }

    /// Frames a second.
    #[must_use]
    pub fn frames_per_second(&self) -> f64 {
        f64::from(self.timing.pclk_hz) / self.clocks_per_frame() as f64
    }

    /// Seconds that a number of pixel clocks takes.
    #[must_use]
    pub fn seconds(&self, clocks: u64) -> f64 {
        clocks as f64 / f64::from(self.timing.pclk_hz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_the_default_profile() {
        let profile = Profile::default();
        assert_eq!(profile.samples_per_line(), 1_920);
        assert_eq!(profile.bytes_per_line(), 1_920);
        assert_eq!(profile.clocks_per_line(), 1_920);
        assert_eq!(profile.bytes_per_frame(), 921_600);
        assert_eq!(profile.words_per_frame(), 230_400);
        assert_eq!(profile.clocks_per_frame(), 921_600);
        assert_eq!(profile.frames_per_second(), 30.0);
    }

    #[test]
    fn numbers_of_a_wide_bus() {
        let profile = Profile::built_in("vga-raw10").unwrap();
        assert_eq!(profile.samples_per_line(), 640);
        assert_eq!(profile.bytes_per_line(), 1_280, "two bytes a sample");
        assert_eq!(profile.words_per_frame(), 153_600);
    }

    #[test]
    fn numbers_of_the_ov7670_are_the_data_sheets() {
        let profile = Profile::built_in("ov7670-vga-rgb565").unwrap();
        assert_eq!(profile.clocks_per_line(), 2 * 784);
        assert_eq!(profile.clocks_per_frame(), 510 * 2 * 784);
        assert!((profile.frames_per_second() - 30.0).abs() < 0.02);
        let small = Profile::built_in("ov7670-qvga-yuv422").unwrap();
        assert_eq!(small.clocks_per_frame(), profile.clocks_per_frame() / 2);
        assert_eq!(small.frames_per_second(), profile.frames_per_second());
    }

    #[test]
    fn numbers_of_a_profile_nobody_checked_saturate() {
        let mut profile = Profile::default();
        profile.frame.width = u32::MAX;
        profile.frame.height = u32::MAX;
        profile.timing.vblank = u32::MAX;
        assert!(profile.bytes_per_frame() > 0);
        assert!(profile.clocks_per_frame() > 0);
    }
}
