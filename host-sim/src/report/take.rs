use firmware::camif::{Bus, Part};
use firmware::driver::verdict::Verdict;

use super::ReportError;
use crate::picture;
use crate::profile::Profile;
use crate::receiver::{Activity, Source, Summary, capture_config, receive_on};

/// Frames that are listed.
const MOST_FRAMES: usize = 1_000;
/// Frames from the beginning whose bytes are kept, and bytes that are kept at most.
const FIRST: usize = 16;
const MOST_BYTES: usize = 1 << 28;

/// A frame as block and driver received it.
#[derive(Clone, Debug)]
pub(super) struct Taken {
    /// What is known of it.
    pub(super) verdict: Verdict,
    /// Its bytes as DMA wrote them; nothing for a lost frame, or one that nobody will look at.
    pub(super) bytes: Option<Vec<u8>>,
    /// CRC-32 of its bytes.
    pub(super) crc32: Option<u32>,
    /// Pixel clocks played until it came.
    pub(super) clock: u64,
}

/// Plays a trace into block and driver, and keeps the first frames and those that pass at these clocks.
pub(super) fn take(
    source: &Source,
    profile: &Profile,
    bus: Bus,
    near: &[u64],
    activity: Option<&mut Activity>,
) -> Result<(Vec<Taken>, Summary), ReportError> {
    let mut frames = Vec::new();
    let (mut kept, mut before) = (0, 0);
    let mut on_frame = |frame: crate::receiver::Received<'_>| {
        let wanted = frames.len() < FIRST || near.iter().any(|clock| (before..=frame.clock).contains(clock));
        before = frame.clock;
        let room = |bytes: &&[u8]| wanted && kept + bytes.len() <= MOST_BYTES;
        let bytes = frame.bytes.filter(room).map(<[u8]>::to_vec);
        kept += bytes.as_ref().map_or(0, Vec::len);
        if frames.len() < MOST_FRAMES {
            let crc32 = frame.bytes.map(picture::crc32);
            frames.push(Taken { verdict: frame.verdict, bytes, crc32, clock: frame.clock });
        }
    };
    let (played, summary) =
        receive_on(Part::CAMIF, &capture_config(profile), bus, activity, &mut on_frame, |receiver| {
            source.play(receiver, &mut |_| {})
        })
        .map_err(|error| ReportError::Profile { profile: profile.name.clone(), error })?;
    played?;
    Ok((frames, summary))
}
