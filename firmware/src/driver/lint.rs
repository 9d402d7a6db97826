//! The linter: says what is wrong with a configuration before it costs an afternoon with an oscilloscope.
//!
//! Each rule looks at one thing, gives at most one [`Finding`], and stands with its siblings in `RULES`; the findings
//! are worked out as they are asked for, so no list has to be kept anywhere. The texts are in `findings.rs`.
//!
//! FCRC's reserved value cannot be written down as a [`Config`]; [`control`] looks for it, and for other reserved bits,
//! in a register as read from a device.

use super::chunks::{IN_FLIGHT, Plan};
use super::config::{Config, Crop, LineSelect, Policy, SyncMode};
use super::engine::even_burst;
pub use super::findings::{Code, Finding, Severity};
use super::frame_camera::frame_plan;
use crate::camif::registers::{BusWidth, ByteSelect, Control, FrameRate};
use crate::camif::{FIFO_WORDS, Part};

/// How memory is filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// A buffer holds a frame.
    Frames,
    /// A buffer holds a line.
    Lines,
}

/// What is wrong with `config` on `part`. Nothing means that it will do.
pub fn lint(config: &Config, part: &Part, layout: Layout) -> impl Iterator<Item = Finding> + use<> {
    let (config, part) = (*config, *part);
    RULES.iter().filter_map(move |rule| rule(&config, &part, layout)).map(Finding::new)
}

/// What is wrong with a value of CR that was read from a device.
pub fn control(value: u32, part: &Part) -> impl Iterator<Item = Finding> + use<> {
    let selection = 0x001F_0000;
    let reserved = !(0x4FFF | if part.selection { selection } else { 0 });
    let bits = (value & reserved != 0).then_some(Code::ReservedBits { bits: value & reserved });
    let rate = Control::new_with_raw_value(value).frame_rate().is_err().then_some(Code::ReservedFrameRate);
    [bits, rate].into_iter().flatten().map(Finding::new)
}

type Rule = fn(&Config, &Part, Layout) -> Option<Code>;

const RULES: [Rule; 19] = [
    empty_frame,
    frame_size,
    clock_ratio,
    slow_bus,
    marker,
    embedded_bus_width,
    selection,
    byte_select_bus_width,
    jpeg,
    crop_fields,
    crop_past_the_frame,
    crop_words,
    frame_rate,
    line_transfer,
    line_alignment,
    short_line,
    frame_alignment,
    restart_each_frame,
    burst_alignment,
];

fn empty_frame(config: &Config, _: &Part, _: Layout) -> Option<Code> {
    let geometry = config.geometry();
    (geometry.bytes() < 4)
        .then_some(Code::EmptyFrame { line_bytes: geometry.line_bytes, lines: geometry.lines })
}

fn frame_size(config: &Config, _: &Part, layout: Layout) -> Option<Code> {
    // A word's place in a slot of lent memory is 28 bits.
    let words = config.geometry().words();
    (layout == Layout::Frames && words >= 1 << 28).then_some(Code::FrameTooLarge { words })
}

fn clock_ratio(config: &Config, part: &Part, _: Layout) -> Option<Code> {
    let (pclk, hclk) = (config.pclk_hz, config.hclk_hz);
    let needed = u64::from(pclk) * u64::from(part.bus_clock_tenths);
    (pclk != 0 && hclk != 0 && u64::from(hclk) * 10 < needed).then_some(Code::ClockRatio {
        pclk_hz: pclk,
        hclk_hz: hclk,
        needed_hz: needed.div_ceil(10),
    })
}

fn slow_bus(config: &Config, _: &Part, _: Layout) -> Option<Code> {
    if config.pclk_hz == 0 || config.hclk_hz == 0 || config.bus_latency == 0 {
        return None;
    }
    // The DMA asks when the FIFO holds a burst. The FIFO overruns when the word after the fourth is complete.
    let words = 5 - config.burst.words();
    let pixel_clocks = words * 4 / config.bus_width.bytes_per_sample();
    let slack = u64::from(pixel_clocks) * u64::from(config.hclk_hz) / u64::from(config.pclk_hz);
    (u64::from(config.bus_latency) >= slack).then_some(Code::SlowBus {
        burst: config.burst,
        latency: config.bus_latency,
        slack: u32::try_from(slack).unwrap_or(u32::MAX),
    })
}

fn marker(config: &Config, part: &Part, _: Layout) -> Option<Code> {
    let marker = matches!(config.sync, SyncMode::Marker { .. });
    (marker && !part.marker).then_some(Code::NoMarker { part: part.name })
}

fn embedded_bus_width(config: &Config, _: &Part, _: Layout) -> Option<Code> {
    let embedded = matches!(config.sync, SyncMode::Embedded { .. });
    (embedded && config.bus_width != BusWidth::Bits8)
        .then_some(Code::EmbeddedBusWidth { bits: config.bus_width.bits() })
}

fn selection(config: &Config, part: &Part, _: Layout) -> Option<Code> {
    let selects = config.byte_select != ByteSelect::All || config.line_select != LineSelect::All;
    (selects && !part.selection).then_some(Code::NoSelection { part: part.name })
}

fn byte_select_bus_width(config: &Config, _: &Part, _: Layout) -> Option<Code> {
    (config.byte_select != ByteSelect::All && config.bus_width != BusWidth::Bits8)
        .then_some(Code::ByteSelectBusWidth { bits: config.bus_width.bits() })
}

fn jpeg(config: &Config, _: &Part, layout: Layout) -> Option<Code> {
    let with = match config {
        _ if !config.jpeg => return None,
        Config { crop: Some(_), .. } => "a crop window",
        Config { sync: SyncMode::Embedded { .. }, .. } => "embedded synchronisation",
        Config { sync: SyncMode::Marker { .. }, .. } => "marker synchronisation",
        _ if config.bus_width != BusWidth::Bits8 => "a bus of more than 8 bits",
        _ if layout == Layout::Lines => "capture line by line",
        _ => return None,
    };
    Some(Code::Jpeg { with })
}

fn crop_fields(config: &Config, _: &Part, _: Layout) -> Option<Code> {
    let Crop { first_clock, clocks, first_line, lines } = config.crop?;
    let fields = [
        ("HOFFCNT", first_clock, 0, 0x3FFF),
        ("CAPCNT", clocks, 1, 0x4000),
        ("VST", first_line, 0, 0x1FFF),
        ("VLINE", lines, 1, 0x4000),
    ];
    let unfit = fields.into_iter().find(|&(_, value, least, most)| value < least || value > most);
    unfit.map(|(field, value, least, most)| Code::CropField { field, value, least, most })
}

fn crop_past_the_frame(config: &Config, _: &Part, _: Layout) -> Option<Code> {
    let crop = config.crop?;
    let past = crop.first_clock.saturating_add(crop.clocks) > config.line_clocks
        || crop.first_line.saturating_add(crop.lines) > config.lines;
    past.then_some(Code::CropPastFrame { line_clocks: config.line_clocks, lines: config.lines })
}

fn crop_words(config: &Config, _: &Part, _: Layout) -> Option<Code> {
    let bytes = config.crop?.clocks.saturating_mul(config.bus_width.bytes_per_sample());
    (!bytes.is_multiple_of(4)).then_some(Code::CropWords { bytes })
}

fn frame_rate(config: &Config, part: &Part, layout: Layout) -> Option<Code> {
    if config.frame_rate == FrameRate::All {
        return None;
    }
    let why = match plan(config, part) {
        _ if config.policy == Policy::Snapshot => "of single frames",
        _ if config.jpeg => "of compressed frames, which are taken one at a time",
        Some(plan) if layout == Layout::Frames && !plan.seamless => {
            "of frames that equal transfers do not fill, which are taken one at a time"
        }
        _ => return None,
    };
    Some(Code::FrameRateIgnored { why })
}

fn line_transfer(config: &Config, part: &Part, layout: Layout) -> Option<Code> {
    let words = config.geometry().line_words();
    // Line by line, the words of a line are told in 16 bits.
    let limit = if part.line_by_line { part.transfer_limit.min(0xFFFF) } else { part.transfer_limit };
    (layout == Layout::Lines && words > limit).then_some(Code::LineTransfer { words, limit })
}

fn line_alignment(config: &Config, part: &Part, layout: Layout) -> Option<Code> {
    let bytes = config.geometry().line_bytes;
    (layout == Layout::Lines && !part.line_by_line && !bytes.is_multiple_of(4))
        .then_some(Code::LineAlignment { bytes })
}

fn short_line(config: &Config, _: &Part, layout: Layout) -> Option<Code> {
    let words = config.geometry().line_words();
    (layout == Layout::Lines && words <= FIFO_WORDS as u32).then_some(Code::ShortLine { words })
}

fn frame_alignment(config: &Config, _: &Part, layout: Layout) -> Option<Code> {
    let bytes = config.geometry().bytes();
    (layout == Layout::Frames && !config.jpeg && !bytes.is_multiple_of(4))
        .then_some(Code::FrameAlignment { bytes })
}

fn restart_each_frame(config: &Config, part: &Part, layout: Layout) -> Option<Code> {
    let words = config.geometry().words();
    let plan = plan(config, part)?;
    let one_by_one = config.jpeg || config.policy == Policy::Snapshot;
    (layout == Layout::Frames && !one_by_one && !plan.seamless)
        .then_some(Code::RestartEachFrame { words, short: words < u64::from(2 * IN_FLIGHT) })
}

fn burst_alignment(config: &Config, part: &Part, layout: Layout) -> Option<Code> {
    let words = match layout {
        Layout::Lines if part.line_by_line => return None,
        Layout::Lines => config.geometry().line_words(),
        Layout::Frames => frame_plan(config, part.transfer_limit)?.chunk,
    };
    let used = even_burst(config.burst, words);
    (used != config.burst).then_some(Code::BurstShortened { burst: config.burst, used, words })
}

fn plan(config: &Config, part: &Part) -> Option<Plan> {
    let words = u32::try_from(config.geometry().words()).ok()?;
    Plan::new(words, part.transfer_limit, false)
}

/// The first finding that forbids to start.
pub(super) fn first_error(config: &Config, part: &Part, layout: Layout) -> Option<Finding> {
    lint(config, part, layout).find(|finding| finding.severity == Severity::Error)
}

#[cfg(test)]
mod tests {
    use super::super::config::tests::{GATED, MARKER};
    use super::*;
    use crate::camif::registers::{Burst, SyncCodes};

    fn codes(config: &Config, part: &Part, layout: Layout) -> Vec<Code> {
        lint(config, part, layout).map(|finding| finding.code).collect()
    }

    #[test]
    fn a_sound_configuration_has_no_findings() {
        let clocks = Config {
            pclk_hz: 27_648_000,
            hclk_hz: 100_000_000,
            bus_latency: 10,
            ..Config::new(MARKER, 1920, 480)
        };
        assert_eq!(codes(&clocks, &Part::CAMIF, Layout::Frames), []);
        assert_eq!(codes(&clocks, &Part::CAMIF, Layout::Lines), []);
        assert_eq!(codes(&Config::new(GATED, 1920, 480), &Part::STM32F4, Layout::Frames), []);
    }

    #[test]
    fn every_rule_finds_its_case() {
        let base = Config::new(GATED, 64, 16);
        let crop =
            |first_clock, clocks, first_line, lines| Some(Crop { first_clock, clocks, first_line, lines });
        let embedded = SyncMode::Embedded { codes: SyncCodes::default(), unmask: SyncCodes::default() };
        let camif = Part::CAMIF;
        let f4 = Part::STM32F4;
        let (frames, lines) = (Layout::Frames, Layout::Lines);
        let cases: [(Config, Part, Layout, Code); 22] = [
            (Config { line_clocks: 16, ..base }, camif, lines, Code::ShortLine { words: 4 }),
            (
                Config { line_clocks: 8, ..base },
                f4,
                lines,
                Code::BurstShortened { burst: Burst::Four, used: Burst::Two, words: 2 },
            ),
            (Config { lines: 0, ..base }, camif, frames, Code::EmptyFrame { line_bytes: 64, lines: 0 }),
            (
                Config { line_clocks: 1 << 20, lines: 1 << 10, ..base },
                camif,
                frames,
                Code::FrameTooLarge { words: 1 << 28 },
            ),
            (
                Config { pclk_hz: 48_000_000, hclk_hz: 100_000_000, ..base },
                camif,
                frames,
                Code::ClockRatio { pclk_hz: 48_000_000, hclk_hz: 100_000_000, needed_hz: 120_000_000 },
            ),
            (
                Config { pclk_hz: 40_000_000, hclk_hz: 100_000_000, bus_latency: 10, ..base },
                camif,
                frames,
                Code::SlowBus { burst: Burst::Four, latency: 10, slack: 10 },
            ),
            (Config { sync: MARKER, ..base }, f4, frames, Code::NoMarker { part: "STM32F4" }),
            (
                Config { sync: embedded, bus_width: BusWidth::Bits10, ..base },
                camif,
                frames,
                Code::EmbeddedBusWidth { bits: 10 },
            ),
            (
                Config { line_select: LineSelect::Even, ..base },
                f4,
                frames,
                Code::NoSelection { part: "STM32F4" },
            ),
            (
                Config { byte_select: ByteSelect::OneOfTwo, bus_width: BusWidth::Bits12, ..base },
                camif,
                frames,
                Code::ByteSelectBusWidth { bits: 12 },
            ),
            (
                Config { jpeg: true, crop: crop(0, 8, 0, 8), ..base },
                camif,
                frames,
                Code::Jpeg { with: "a crop window" },
            ),
            (
                Config { jpeg: true, sync: embedded, ..base },
                camif,
                frames,
                Code::Jpeg { with: "embedded synchronisation" },
            ),
            (Config { jpeg: true, ..base }, camif, lines, Code::Jpeg { with: "capture line by line" }),
            (
                Config { line_clocks: 20_000, crop: crop(0x4000, 8, 0, 8), ..base },
                camif,
                frames,
                Code::CropField { field: "HOFFCNT", value: 0x4000, least: 0, most: 0x3FFF },
            ),
            (
                Config { crop: crop(60, 8, 0, 8), ..base },
                camif,
                frames,
                Code::CropPastFrame { line_clocks: 64, lines: 16 },
            ),
            (Config { crop: crop(0, 6, 0, 8), ..base }, camif, frames, Code::CropWords { bytes: 6 }),
            (
                Config { policy: Policy::Snapshot, frame_rate: FrameRate::Half, ..base },
                camif,
                frames,
                Code::FrameRateIgnored { why: "of single frames" },
            ),
            (
                Config { line_clocks: 262_144, lines: 1, ..base },
                f4,
                lines,
                Code::LineTransfer { words: 65_536, limit: 65_535 },
            ),
            (Config { line_clocks: 62, ..base }, f4, lines, Code::LineAlignment { bytes: 62 }),
            (
                Config { line_clocks: 63, lines: 3, ..base },
                camif,
                frames,
                Code::FrameAlignment { bytes: 189 },
            ),
            (
                Config { line_clocks: 262_148, lines: 1, ..base },
                f4,
                frames,
                Code::RestartEachFrame { words: 65_537, short: false },
            ),
            (
                Config { line_clocks: 8, lines: 4, ..base },
                camif,
                frames,
                Code::RestartEachFrame { words: 8, short: true },
            ),
        ];
        for (config, part, layout, code) in cases {
            let found = codes(&config, &part, layout);
            assert!(found.contains(&code), "{code:?} is not among {found:?}");
        }
    }

    #[test]
    fn a_smaller_burst_bears_a_slower_bus() {
        let config = Config {
            pclk_hz: 40_000_000,
            hclk_hz: 100_000_000,
            bus_latency: 35,
            ..Config::new(GATED, 64, 16)
        };
        let fits = |burst| lint(&Config { burst, ..config }, &Part::CAMIF, Layout::Frames).next().is_none();
        assert_eq!([Burst::One, Burst::Two, Burst::Four].map(fits), [true, false, false]);
    }

    #[test]
    fn reserved_bits_of_a_register_are_found() {
        let found = |value, part| control(value, &part).map(|finding| finding.code).collect::<Vec<_>>();
        assert_eq!(found(0x4FFF & !0x300, Part::STM32F4), []);
        assert_eq!(found(0x300, Part::STM32F4), [Code::ReservedFrameRate]);
        assert_eq!(found(0x0003_0000, Part::STM32F4), [Code::ReservedBits { bits: 0x0003_0000 }]);
        assert_eq!(found(0x0003_0000, Part::STM32H7), []);
        assert_eq!(found(0x8020_0000, Part::STM32H7), [Code::ReservedBits { bits: 0x8020_0000 }]);
    }

    #[test]
    fn findings_say_why_and_what_to_do() {
        let config = Config { pclk_hz: 48_000_000, hclk_hz: 100_000_000, ..Config::new(GATED, 64, 16) };
        let finding = lint(&config, &Part::CAMIF, Layout::Frames).next().unwrap();
        let text = "error: HCLK is 100000000 Hz where PCLK of 48000000 Hz needs at least 120000000 Hz; \
                    lower the sensor's pixel clock or raise HCLK";
        assert_eq!(finding.to_string(), text);
    }
}
