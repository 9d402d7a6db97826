use std::ops::Range;

use firmware::camif::pins::{Pins, Samples, Sync};
use firmware::trace::StretchSink;

use super::kind::FaultKind;
use super::place::{Place, Tracker};
use super::random::Random;
use super::spec::{FaultError, FaultSpec};
use super::{bytes, clock, codes, frame, lines, sync, wires};
use crate::profile::{Profile, SyncMode};

/// A fault at work: takes clocks, and gives none, one or many for each.
pub(super) trait Fault: Send {
    /// The next clock, and where in the undisturbed frame it is.
    fn clock(&mut self, place: &Place, pins: Pins, out: &mut Vec<Pins>);

    /// There are no more clocks: gives out what was held back.
    fn finish(&mut self, out: &mut Vec<Pins>) {
        let _ = out;
    }
}

/// Clocks taken at a time.
const BATCH: usize = 1 << 16;

struct Stage {
    tracker: Tracker,
    fault: Box<dyn Fault>,
    /// The last clock was of a frame that has the fault.
    broken: bool,
}

/// Puts faults between a source of stretches and a sink, one after the other. Call [`Injector::finish`] at the end.
pub struct Injector<S> {
    stages: Vec<Stage>,
    settled: Vec<FaultSpec>,
    /// The frames that have them.
    frames: Range<u64>,
    byte_bus: bool,
    clocks: Vec<Pins>,
    spare: Vec<Pins>,
    bytes: Vec<u8>,
    words: Vec<u16>,
    sink: S,
}

impl<S: StretchSink> Injector<S> {
    /// Faults on the wires of this profile.
    ///
    /// # Errors
    /// [`FaultError`] if the wires cannot have one of them.
    pub fn new(profile: &Profile, faults: &[FaultSpec], seed: u64, sink: S) -> Result<Self, FaultError> {
        let mut settled = Vec::with_capacity(faults.len());
        let mut stages = Vec::with_capacity(faults.len());
        for (number, spec) in faults.iter().enumerate() {
            let mut random = Random::new(seed.wrapping_add(number as u64 * 0x5851_F42D_4C95_7F2D));
            let spec = spec.clone().settle(profile, &mut random)?;
            stages.push(Stage {
                tracker: Tracker::new(profile),
                fault: make(&spec, profile, random),
                broken: false,
            });
            settled.push(spec);
        }
        Ok(Self {
            stages,
            settled,
            frames: 0..u64::MAX,
            byte_bus: profile.bus.bits == 8,
            clocks: Vec::new(),
            spare: Vec::new(),
            bytes: Vec::new(),
            words: Vec::new(),
            sink,
        })
    }

    /// Puts the faults into these frames only, by the ends of frames on the wires before them: where blanking comes
    /// before the first frame, that is number 1.
    #[must_use]
    pub fn during(mut self, frames: Range<u64>) -> Self {
        self.frames = frames;
        self
    }

    /// The faults with all their values.
    #[must_use]
    pub fn faults(&self) -> &[FaultSpec] {
        &self.settled
    }

    /// Times as fast as the sensor's the pixel clock is: a trace's header says so, for stretches have no time.
    #[must_use]
    pub fn clock_factor(&self) -> u32 {
        let fast = self.settled.iter().filter(|spec| spec.kind == FaultKind::ClockTooFast);
        fast.fold(1, |factor: u32, spec| factor.saturating_mul(spec.value("factor") as u32))
    }

    /// The sink.
    pub fn sink_mut(&mut self) -> &mut S {
        &mut self.sink
    }

    /// Gives out what faults held back, and the sink.
    ///
    /// # Errors
    /// The sink's.
    pub fn finish(mut self) -> Result<S, S::Error> {
        for first in 0..self.stages.len() {
            let mut out = std::mem::take(&mut self.clocks);
            out.clear();
            self.stages[first].fault.finish(&mut out);
            self.clocks = out;
            self.through(first + 1)?;
        }
        Ok(self.sink)
    }

    /// Sends what is in `clocks` through the stages from `first` on and to the sink.
    fn through(&mut self, first: usize) -> Result<(), S::Error> {
        for stage in &mut self.stages[first..] {
            self.spare.clear();
            for &pins in &self.clocks {
                let place = stage.tracker.clock(pins);
                let broken = self.frames.contains(&place.frame);
                if std::mem::replace(&mut stage.broken, broken) && !broken {
                    stage.fault.finish(&mut self.spare);
                }
                if broken {
                    stage.fault.clock(&place, pins, &mut self.spare);
                } else {
                    self.spare.push(pins);
                }
            }
            std::mem::swap(&mut self.clocks, &mut self.spare);
        }
        let clocks = std::mem::take(&mut self.clocks);
        for run in clocks.chunk_by(|a, b| a.sync == b.sync) {
            self.put(run)?;
        }
        self.clocks = clocks;
        self.clocks.clear();
        Ok(())
    }

    fn put(&mut self, run: &[Pins]) -> Result<(), S::Error> {
        let Some(Pins { sync, data }) = run.first().copied() else { return Ok(()) };
        if run.iter().all(|pins| pins.data == data) {
            return self.sink.stretch(sync, Samples::Repeat { value: data, clocks: run.len() as u32 });
        }
        if self.byte_bus {
            self.bytes.clear();
            self.bytes.extend(run.iter().map(|pins| pins.data as u8));
            return self.sink.stretch(sync, Samples::Bytes(&self.bytes));
        }
        self.words.clear();
        self.words.extend(run.iter().map(|pins| pins.data));
        self.sink.stretch(sync, Samples::Words(&self.words))
    }
}

impl<S: StretchSink> StretchSink for Injector<S> {
    type Error = S::Error;

    fn stretch(&mut self, sync: Sync, mut samples: Samples<'_>) -> Result<(), S::Error> {
        while !samples.is_empty() {
            let batch = samples.take(BATCH);
            self.clocks.clear();
            match batch {
                Samples::Bytes(bytes) => {
                    self.clocks.extend(bytes.iter().map(|&byte| Pins { sync, data: u16::from(byte) }));
                }
                Samples::Words(words) => self.clocks.extend(words.iter().map(|&data| Pins { sync, data })),
                Samples::Repeat { value, clocks } => {
                    self.clocks.extend(std::iter::repeat_n(Pins { sync, data: value }, clocks as usize));
                }
            }
            samples = samples.skip(batch.len());
            self.through(0)?;
        }
        Ok(())
    }
}

/// The fault of a settled specification.
fn make(spec: &FaultSpec, profile: &Profile, random: Random) -> Box<dyn Fault> {
    use FaultKind as K;
    let embedded = profile.bus.sync == SyncMode::Embedded;
    match spec.kind {
        K::ClockGlitch
        | K::MissingClock
        | K::ClockJitter
        | K::WrongEdge
        | K::Undersampling
        | K::ClockTooFast => clock::make(spec, profile, random),
        K::ShortLine | K::LongLine | K::LineStartLoss | K::ShortBlanking => {
            lines::make(spec, profile, random)
        }
        K::MissingHsync | K::SpuriousHsync | K::MissingVsync | K::SpuriousVsync | K::VsyncInFrame
            if embedded =>
        {
            codes::make(spec, profile, random)
        }
        K::MissingHsync
        | K::SpuriousHsync
        | K::MissingVsync
        | K::SpuriousVsync
        | K::VsyncInFrame
        | K::InvertedHsync
        | K::InvertedVsync => sync::make(spec, profile, random),
        K::StuckBit | K::SwappedBits | K::ShortedBits | K::ShiftedBits | K::ReversedBus => {
            wires::make(spec, profile)
        }
        K::ByteSlip | K::ByteSwap => bytes::make(spec, profile),
        K::FormatMismatch | K::BayerPhase | K::RedBlueSwap => frame::make(spec, profile),
    }
}
