use std::fmt;

use serde::{Deserialize, Serialize, Serializer};

use crate::profile::{Choice, Profile, SyncMode};

/// A class of faults. What is injected and what is found have one name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum FaultKind {
    /// Extra edges of the pixel clock: a sample comes twice.
    ClockGlitch,
    /// Edges of the pixel clock that are not seen: a sample is lost.
    MissingClock,
    /// The clock's edge wobbles: now and then a sample is taken while data changes.
    ClockJitter,
    /// Data is sampled on the edge on which it changes.
    WrongEdge,
    /// The pixel clock is faster than bus and DMA can take.
    ClockTooFast,
    /// A capture with too few samples a clock: whole clocks are missed, evenly.
    Undersampling,
    /// Lines that end early.
    ShortLine,
    /// Lines that end late.
    LongLine,
    /// The line's valid level comes late: the first samples of every line are lost.
    LineStartLoss,
    /// Less blanking between lines than the receiver was promised.
    ShortBlanking,
    /// A line's end is not signalled: two lines become one.
    MissingHsync,
    /// A line's end is signalled within a line.
    SpuriousHsync,
    /// A frame's end is not signalled: two frames become one.
    MissingVsync,
    /// A short pulse on VSYNC where no frame ends.
    SpuriousVsync,
    /// VSYNC in blanking for its usual time, in the middle of a frame.
    VsyncInFrame,
    /// HSYNC has the other polarity.
    InvertedHsync,
    /// VSYNC has the other polarity.
    InvertedVsync,
    /// A data wire that is always low or high.
    StuckBit,
    /// Two data wires have changed places.
    SwappedBits,
    /// Two data wires are connected to one another.
    ShortedBits,
    /// The data wires are connected some places too high or too low.
    ShiftedBits,
    /// The data wires are connected in reverse.
    ReversedBus,
    /// Lines begin some samples late in the data: bytes fall to the wrong pixel or colour.
    ByteSlip,
    /// Neighbouring samples have changed places.
    ByteSwap,
    /// The sensor sends another pixel format.
    FormatMismatch,
    /// The mosaic starts with another colour.
    BayerPhase,
    /// Red and blue have changed places.
    RedBlueSwap,
}

impl Choice for FaultKind {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("clock-glitch", Self::ClockGlitch),
        ("missing-clock", Self::MissingClock),
        ("clock-jitter", Self::ClockJitter),
        ("wrong-edge", Self::WrongEdge),
        ("clock-too-fast", Self::ClockTooFast),
        ("undersampling", Self::Undersampling),
        ("short-line", Self::ShortLine),
        ("long-line", Self::LongLine),
        ("line-start-loss", Self::LineStartLoss),
        ("short-blanking", Self::ShortBlanking),
        ("missing-hsync", Self::MissingHsync),
        ("spurious-hsync", Self::SpuriousHsync),
        ("missing-vsync", Self::MissingVsync),
        ("spurious-vsync", Self::SpuriousVsync),
        ("vsync-in-frame", Self::VsyncInFrame),
        ("inverted-hsync", Self::InvertedHsync),
        ("inverted-vsync", Self::InvertedVsync),
        ("stuck-bit", Self::StuckBit),
        ("swapped-bits", Self::SwappedBits),
        ("shorted-bits", Self::ShortedBits),
        ("shifted-bits", Self::ShiftedBits),
        ("reversed-bus", Self::ReversedBus),
        ("byte-slip", Self::ByteSlip),
        ("byte-swap", Self::ByteSwap),
        ("format-mismatch", Self::FormatMismatch),
        ("bayer-phase", Self::BayerPhase),
        ("red-blue-swap", Self::RedBlueSwap),
    ];
}

impl fmt::Display for FaultKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for FaultKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for FaultKind {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        Self::from_name(&name).ok_or_else(|| serde::de::Error::custom(format!("no fault is called `{name}`")))
    }
}

/// Values that a key can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Values {
    /// Whole numbers from the first to the last; the second pair is what a seed draws from.
    Numbers((i64, i64), (i64, i64)),
    /// Words.
    Words(&'static [&'static str]),
}

/// A parameter of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key {
    /// As it is written.
    pub name: &'static str,
    /// What it says.
    pub about: &'static str,
    /// What it can be.
    pub values: Values,
}

const fn number(name: &'static str, about: &'static str, range: (i64, i64), drawn: (i64, i64)) -> Key {
    Key { name, about, values: Values::Numbers(range, drawn) }
}

const fn words(name: &'static str, about: &'static str, words: &'static [&'static str]) -> Key {
    Key { name, about, values: Values::Words(words) }
}

const COUNT: Key = number("count", "how often in a frame", (1, 1_000), (1, 4));
/// Numbers of data wires; those a bus lacks are refused where the fault meets it.
const WIRE: (i64, i64) = (0, 13);

impl FaultKind {
    /// All of them, in the order of the list.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::NAMES.iter().map(|(_, kind)| *kind)
    }

    /// One line for people.
    #[must_use]
    pub const fn about(self) -> &'static str {
        match self {
            Self::ClockGlitch => "extra edges of the pixel clock: a sample comes twice",
            Self::MissingClock => "edges of the pixel clock are not seen: a sample is lost",
            Self::ClockJitter => {
                "the clock's edge wobbles: now and then a sample is taken while data changes"
            }
            Self::WrongEdge => "data is sampled on the edge on which it changes",
            Self::ClockTooFast => "the pixel clock is faster than bus and DMA can take",
            Self::Undersampling => "too few samples a clock: whole clocks are missed, evenly",
            Self::ShortLine => "lines that end early",
            Self::LongLine => "lines that end late",
            Self::LineStartLoss => "the first samples of every line are lost",
            Self::ShortBlanking => "less blanking between lines than promised",
            Self::MissingHsync => "a line's end is not signalled: two lines become one",
            Self::SpuriousHsync => "a line's end is signalled within a line",
            Self::MissingVsync => "a frame's end is not signalled: two frames become one",
            Self::SpuriousVsync => "a short pulse on VSYNC within a frame",
            Self::VsyncInFrame => "VSYNC for its usual time in the middle of a frame",
            Self::InvertedHsync => "HSYNC has the other polarity",
            Self::InvertedVsync => "VSYNC has the other polarity",
            Self::StuckBit => "a data wire is always low or high",
            Self::SwappedBits => "two data wires have changed places",
            Self::ShortedBits => "two data wires are connected to one another",
            Self::ShiftedBits => "the data wires are connected some places too high or too low",
            Self::ReversedBus => "the data wires are connected in reverse",
            Self::ByteSlip => "lines begin some samples late in the data",
            Self::ByteSwap => "neighbouring samples have changed places",
            Self::FormatMismatch => "the sensor sends another pixel format",
            Self::BayerPhase => "the mosaic starts with another colour",
            Self::RedBlueSwap => "red and blue have changed places",
        }
    }

    /// What can be said of it beyond its name.
    #[must_use]
    pub const fn keys(self) -> &'static [Key] {
        match self {
            Self::ClockGlitch | Self::MissingClock | Self::MissingHsync => &[COUNT],
            Self::ClockJitter => {
                const { &[number("permille", "samples in a thousand that are hit", (1, 200), (10, 50))] }
            }
            Self::WrongEdge => {
                const {
                    &[number(
                        "percent",
                        "changing bits that still show the sample before",
                        (10, 100),
                        (30, 70),
                    )]
                }
            }
            Self::ClockTooFast => const { &[number("factor", "times as fast", (2, 64), (2, 8))] },
            Self::Undersampling => const { &[number("percent", "clocks that are seen", (10, 99), (55, 95))] },
            Self::ShortLine | Self::LongLine => {
                const { &[COUNT, number("samples", "too few or too many", (1, 4_096), (3, 24))] }
            }
            Self::LineStartLoss => const { &[number("samples", "lost a line", (1, 4_096), (1, 16))] },
            Self::ShortBlanking => {
                const { &[number("percent", "of the blanking that is left", (1, 95), (5, 60))] }
            }
            Self::SpuriousHsync | Self::SpuriousVsync => {
                const { &[COUNT, number("clocks", "length of the pulse", (1, 64), (1, 4))] }
            }
            Self::MissingVsync => {
                const { &[number("every", "one frame's end in so many is lost", (1, 1_000), (2, 3))] }
            }
            Self::VsyncInFrame => {
                const { &[number("percent", "of the frame that has passed", (5, 95), (15, 85))] }
            }
            Self::StuckBit => {
                const {
                    &[
                        number("bit", "the data wire", WIRE, (0, 13)),
                        words("level", "where it is stuck", &["low", "high"]),
                    ]
                }
            }
            Self::SwappedBits => {
                const { &[number("a", "a data wire", WIRE, (0, 13)), number("b", "the other", WIRE, (0, 13))] }
            }
            Self::ShortedBits => {
                const {
                    &[
                        number("a", "a data wire", WIRE, (0, 13)),
                        number("b", "the other", WIRE, (0, 13)),
                        words("wins", "which level wins", &["low", "high"]),
                    ]
                }
            }
            Self::ShiftedBits => {
                const {
                    &[
                        number("places", "how far", (1, 7), (1, 3)),
                        words(
                            "to",
                            "high: sensor D0 arrives on a higher wire; low: on none",
                            &["high", "low"],
                        ),
                    ]
                }
            }
            Self::ByteSlip => const { &[number("samples", "how far", (1, 64), (1, 3))] },
            Self::FormatMismatch => {
                const {
                    &[words(
                        "sent",
                        "the format on the wires",
                        &["rgb888", "rgb565-be", "rgb565-le", "yuyv", "uyvy", "gray8", "raw8"],
                    )]
                }
            }
            Self::BayerPhase => {
                const { &[words("by", "which neighbour comes first", &["column", "row", "both"])] }
            }
            Self::InvertedHsync
            | Self::InvertedVsync
            | Self::ReversedBus
            | Self::ByteSwap
            | Self::RedBlueSwap => &[],
        }
    }

    /// Why such a fault cannot be put into this profile's wires, if it cannot.
    #[must_use]
    pub fn refusal(self, profile: &Profile) -> Option<&'static str> {
        let sync = profile.bus.sync;
        match self {
            Self::InvertedHsync | Self::InvertedVsync if sync == SyncMode::Embedded => {
                Some("with embedded sync there are no sync wires")
            }
            Self::ShortBlanking if sync == SyncMode::Marker => Some("with marker sync there is no blanking"),
            Self::ShortBlanking if profile.timing.hblank < 2 => Some("there is no blanking to take from"),
            Self::FormatMismatch if profile.bus.bits != 8 => Some("the other formats need a bus of 8 bits"),
            Self::BayerPhase if !profile.frame.is_bayer() => Some("the format has no mosaic"),
            Self::RedBlueSwap if profile.frame.format == algos_nostd::pixel::format::Format::Gray8 => {
                Some("the format has no colours")
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_enums_order_and_json_says_the_names() {
        let kinds: Vec<_> = FaultKind::all().collect();
        assert!(kinds.is_sorted());
        assert_eq!(kinds.len(), FaultKind::RedBlueSwap as usize + 1, "no class without a name");
        for kind in kinds {
            let text = serde_json::to_string(&kind).unwrap();
            assert_eq!(text, format!("\"{kind}\""));
            assert_eq!(serde_json::from_str::<FaultKind>(&text).unwrap(), kind);
        }
    }
}
