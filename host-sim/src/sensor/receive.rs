//! Naive receivers, a clock at a time and written from the specification: the oracle of the sensor's tests.

use std::convert::Infallible;

use firmware::camif::pins::{Samples, Sync};
use firmware::trace::StretchSink;

use crate::profile::{Profile, SyncMode};

/// Every pixel clock as it went over the wires.
#[derive(Default)]
pub(super) struct Clocks(pub(super) Vec<(Sync, u16)>);

impl StretchSink for Clocks {
    type Error = Infallible;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Infallible> {
        assert!(!samples.is_empty(), "the sensor plays no empty stretches");
        self.0.extend((0..samples.len()).map(|clock| (sync, samples.get(clock).unwrap())));
        Ok(())
    }
}

/// A frame as lines of samples.
pub(super) type Received = Vec<Vec<u16>>;

/// The frames in the clocks, closed ones only.
pub(super) fn receive(profile: &Profile, clocks: &[(Sync, u16)]) -> Vec<Received> {
    let (hsync_blank, vsync_blank) = (profile.bus.hsync_blank.is_high(), profile.bus.vsync_blank.is_high());
    let wires = |sync: Sync| (sync.hsync == hsync_blank, sync.vsync == vsync_blank);
    match profile.bus.sync {
        SyncMode::Marker => marker(clocks.iter().map(|&(sync, sample)| (wires(sync), sample))),
        SyncMode::Gated => gated(clocks.iter().map(|&(sync, sample)| (wires(sync), sample))),
        SyncMode::Embedded => {
            assert!(clocks.iter().all(|&(sync, _)| sync == Sync::default()), "the wires idle");
            embedded(clocks.iter().map(|&(_, sample)| sample))
        }
    }
}

fn marker(clocks: impl Iterator<Item = ((bool, bool), u16)>) -> Vec<Received> {
    let (mut frames, mut frame, mut line) = (Vec::new(), Received::new(), Vec::new());
    let mut before = (false, false);
    for (active, sample) in clocks {
        if active.0 && !before.0 {
            frame.push(std::mem::take(&mut line));
        }
        if active.1 && !before.1 {
            frames.push(std::mem::take(&mut frame));
        }
        line.push(sample);
        before = active;
    }
    assert!(frame.is_empty() && line.len() == 1, "one idle clock after the last frame");
    frames
}

fn gated(clocks: impl Iterator<Item = ((bool, bool), u16)>) -> Vec<Received> {
    let (mut frames, mut frame, mut line) = (Vec::new(), Received::new(), Vec::new());
    let mut before = None;
    for ((hblank, vblank), sample) in clocks {
        assert!(before.is_some() || (hblank && vblank), "a stream starts in blanking");
        if (hblank || vblank) && !line.is_empty() {
            frame.push(std::mem::take(&mut line));
        }
        if vblank && before == Some(false) {
            frames.push(std::mem::take(&mut frame));
        }
        if !hblank && !vblank {
            line.push(sample);
        }
        before = Some(vblank);
    }
    assert!(frame.is_empty() && line.is_empty(), "the last frame is closed");
    frames
}

fn embedded(samples: impl Iterator<Item = u16>) -> Vec<Received> {
    let samples: Vec<u8> = samples.map(|sample| u8::try_from(sample).unwrap()).collect();
    let (mut frames, mut frame, mut line) = (Vec::new(), Received::new(), None::<usize>);
    let mut at = 0;
    while at < samples.len() {
        let Some([0xFF, 0, 0, code]) = samples.get(at..at + 4) else {
            assert!(!matches!(samples[at], 0 | 0xFF), "codes' bytes stand in codes only");
            at += 1;
            continue;
        };
        match (code, line) {
            (0x80, None) => line = Some(at + 4),
            (0x9D, Some(start)) => {
                frame.push(samples[start..at].iter().copied().map(u16::from).collect());
                line = None;
            }
            (0xAB | 0xB6, None) => {
                if !frame.is_empty() {
                    frames.push(std::mem::take(&mut frame));
                }
            }
            other => panic!("{other:?} at {at}"),
        }
        at += 4;
    }
    assert!(frame.is_empty() && line.is_none(), "the last frame is closed");
    frames
}
