use firmware::camif::Bus;
use firmware::driver::verdict::Verdict;

use super::ReportError;
use crate::profile::Profile;
use crate::receiver::{Activity, Source, Summary, capture_config, receive_watched};

/// Frames that are kept.
pub(super) const MOST_FRAMES: usize = 16;

/// A frame as block and driver received it.
#[derive(Clone, Debug)]
pub(super) struct Taken {
    /// What is known of it.
    pub(super) verdict: Verdict,
    /// Its bytes as DMA wrote them; nothing for a lost frame.
    pub(super) bytes: Option<Vec<u8>>,
    /// Pixel clocks played until it came.
    pub(super) clock: u64,
}

/// Plays a trace into block and driver and keeps the first frames.
pub(super) fn take(
    source: &Source,
    profile: &Profile,
    bus: Bus,
    activity: Option<&mut Activity>,
) -> Result<(Vec<Taken>, Summary), ReportError> {
    let mut frames = Vec::new();
    let mut on_frame = |frame: crate::receiver::Received<'_>| {
        if frames.len() < MOST_FRAMES {
            let bytes = frame.bytes.map(<[u8]>::to_vec);
            frames.push(Taken { verdict: frame.verdict, bytes, clock: frame.clock });
        }
    };
    let (played, summary) =
        receive_watched(&capture_config(profile), bus, activity, &mut on_frame, |receiver| {
            source.play(receiver, &mut |_| {})
        })
        .map_err(|error| ReportError::Profile { profile: profile.name.clone(), error })?;
    played?;
    Ok((frames, summary))
}
