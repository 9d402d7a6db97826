//! What a finding would change: the profile, and the bytes of a frame.

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;
use firmware::camif::pins::Edge;

use super::finding::Finding;
use crate::fault::{FaultKind, reverse_bits, swap_bits};
use crate::profile::{Choice, Level, Profile};

/// A profile that takes a finding into account, and what is to be done to frames beyond that.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// The profile with the finding's key changed; as it was if no key mends it.
    pub profile: Profile,
    /// What mends the samples of a picture already taken; nothing if nothing has to or can.
    pub samples: Option<Samples>,
}

/// A change of samples that undoes a fault of wires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Samples {
    /// Two bits change places.
    Swap(u32, u32),
    /// The bus is reversed.
    Reverse,
    /// Neighbouring samples change places.
    Pairs,
    /// Bits move up by so many places, lost ones apart.
    Up(u32),
    /// Lines begin so many samples earlier.
    Slip(usize),
}

fn flipped(level: Level) -> Level {
    if level.is_high() { Level::Low } else { Level::High }
}

/// What this finding would change; nothing if no setting and no change of samples mends it.
#[must_use]
pub fn fix(finding: &Finding, profile: &Profile) -> Option<Fix> {
    let mut fixed = profile.clone();
    let number = |name: &str| finding.evidence.numbers.get(name).map(|number| *number as u32);
    let setting = finding.remedy.profile.as_deref().unwrap_or_default();
    let word = setting.split('"').nth(1);
    let mut samples = None;
    match finding.fault {
        FaultKind::InvertedHsync => fixed.bus.hsync_blank = flipped(profile.bus.hsync_blank),
        FaultKind::InvertedVsync => fixed.bus.vsync_blank = flipped(profile.bus.vsync_blank),
        FaultKind::WrongEdge => {
            fixed.bus.clock_edge =
                if profile.bus.clock_edge == Edge::Rising { Edge::Falling } else { Edge::Rising };
        }
        FaultKind::FormatMismatch | FaultKind::ByteSwap if setting.starts_with("frame.format") => {
            fixed.frame.format = <Format as Choice>::from_name(word?)?;
        }
        FaultKind::ByteSwap => samples = Some(Samples::Pairs),
        FaultKind::BayerPhase => fixed.frame.bayer = <BayerOrder as Choice>::from_name(word?)?,
        FaultKind::ShortBlanking => fixed.timing.hblank = number("blanking_clocks")?,
        FaultKind::SwappedBits => samples = Some(Samples::Swap(number("a")?, number("b")?)),
        FaultKind::ReversedBus => samples = Some(Samples::Reverse),
        FaultKind::ShiftedBits if finding.evidence.text.contains("down") => {
            samples = Some(Samples::Up(number("places")?));
        }
        FaultKind::ByteSlip => samples = Some(Samples::Slip(number("samples")? as usize)),
        _ => return None,
    }
    fixed.check().is_ok().then_some(Fix { profile: fixed, samples })
}

impl Samples {
    /// The bytes of a frame of this profile, mended.
    #[must_use]
    pub fn apply(self, bytes: &[u8], profile: &Profile) -> Vec<u8> {
        let wide = profile.bus.bits > 8;
        let mask = ((1u32 << profile.bus.bits) - 1) as u16;
        let mut samples: Vec<u16> = if wide {
            bytes.as_chunks::<2>().0.iter().map(|pair| u16::from_le_bytes(*pair)).collect()
        } else {
            bytes.iter().map(|&byte| u16::from(byte)).collect()
        };
        let line = (profile.samples_per_line() as usize).max(1);
        match self {
            Self::Swap(a, b) => samples.iter_mut().for_each(|sample| *sample = swap_bits(*sample, a, b)),
            Self::Reverse => {
                samples.iter_mut().for_each(|sample| *sample = reverse_bits(*sample, profile.bus.bits));
            }
            Self::Up(places) => samples.iter_mut().for_each(|sample| *sample = *sample << places & mask),
            Self::Pairs => {
                for line in samples.chunks_mut(line) {
                    line.as_chunks_mut::<2>().0.iter_mut().for_each(|pair| pair.swap(0, 1));
                }
            }
            Self::Slip(count) => {
                for line in samples.chunks_mut(line) {
                    line.rotate_right(count.min(line.len()));
                }
            }
        }
        if wide {
            samples.into_iter().flat_map(u16::to_le_bytes).collect()
        } else {
            samples.into_iter().map(|sample| sample as u8).collect()
        }
    }
}
