//! The sensor's frames through the block itself: what DMA leaves in memory is what was encoded.

use std::convert::Infallible;

use firmware::camif::pins::{Edge, Samples, Sync};
use firmware::camif::registers::{
    Burst, BusWidth, Control, DmaMode, Events, Extension, Register, Registers, SyncCodes,
};
use firmware::camif::{Bus, Camif, Part};
use firmware::port::{Dma, Target, Transfer};
use firmware::trace::StretchSink;

use super::Sensor;
use crate::profile::{Profile, SyncMode, built_ins};
use crate::scene::Scene;

/// The block, and how often its interrupts came.
struct Block<'m> {
    camif: Camif<'m>,
    frames: u64,
    lines: u64,
    others: Vec<Events>,
}

impl<'m> Block<'m> {
    /// A block that waits for this profile's frames, with one long transfer into `memory`.
    fn new(profile: &Profile, memory: &'m mut [u32]) -> Self {
        let words = memory.len() as u32;
        let mut camif = Camif::new(Part::CAMIF, Bus::IDEAL);
        camif.lend(0, memory).ok().unwrap();
        camif.aim(Target::Zero, 0, 0).unwrap();
        let (mode, burst) = (DmaMode::Single, Burst::Four);
        camif.start(Transfer { words, mode, burst, line_by_line: false, half_interrupt: false }).unwrap();
        let sync = profile.bus.sync;
        let marker = Extension::default().with_marker(sync == SyncMode::Marker);
        camif.write(Register::Extension, marker.raw_value());
        // The codes of BT.656: any other code ends a frame.
        let codes = SyncCodes::default().with_frame_start(0xFF).with_line_start(0x80);
        let codes = codes.with_line_end(0x9D).with_frame_end(0xFF);
        camif.write(Register::SyncCode, codes.raw_value());
        camif.write(Register::SyncUnmask, u32::MAX);
        camif.write(Register::InterruptEnable, Events::MASK);
        let control = Control::default()
            .with_enable(true)
            .with_capture(true)
            .with_embedded_sync(sync == SyncMode::Embedded)
            .with_sample_on_rising(profile.bus.clock_edge == Edge::Rising)
            .with_hsync_blank_high(profile.bus.hsync_blank.is_high())
            .with_vsync_blank_high(profile.bus.vsync_blank.is_high())
            .with_bus_width(BusWidth::from_bits(profile.bus.bits).unwrap());
        camif.write(Register::Control, control.raw_value());
        Self { camif, frames: 0, lines: 0, others: Vec::new() }
    }

    fn take_interrupts(&mut self) {
        let events = Events::new_with_raw_value(self.camif.read(Register::RawInterrupt));
        self.camif.write(Register::InterruptClear, events.raw_value());
        self.frames += u64::from(events.frame());
        self.lines += u64::from(events.line());
        if events.overrun() || events.error() {
            self.others.push(events);
        }
    }
}

impl StretchSink for Block<'_> {
    type Error = Infallible;

    fn stretch(&mut self, sync: Sync, mut samples: Samples<'_>) -> Result<(), Infallible> {
        while !samples.is_empty() {
            let played = self.camif.run(sync, samples);
            samples = samples.skip(played);
            self.take_interrupts();
        }
        Ok(())
    }
}

#[test]
fn every_profile_arrives_in_memory() {
    const FRAMES: u64 = 3;
    for profile in built_ins() {
        let scene = Scene::Moving;
        let mut sensor = Sensor::new(profile.clone()).unwrap();
        let mut sent = Vec::new();
        let mut memory = vec![0; (FRAMES * profile.words_per_frame()) as usize];
        let mut block = Block::new(&profile, &mut memory);
        sensor.play_watched(FRAMES, &scene, &mut block, |_, bytes| sent.extend_from_slice(bytes)).unwrap();
        block.camif.elapse(100);
        assert_eq!(block.others, [], "{}", profile.name);
        assert_eq!(block.frames, FRAMES, "{}", profile.name);
        assert_eq!(block.lines, FRAMES * u64::from(profile.frame.height), "{}", profile.name);
        let bytes: Vec<u8> =
            block.camif.lent(0).unwrap().iter().flat_map(|word| word.to_le_bytes()).collect();
        let wrong = bytes.iter().zip(&sent).position(|(received, sent)| received != sent);
        assert_eq!((bytes.len(), wrong), (sent.len(), None), "{}", profile.name);
    }
}
