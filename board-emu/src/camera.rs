//! The camera in front of the part: recorded pins, or a virtual sensor that sends what its registers say.

use std::sync::PoisonError;

use firmware::camif::pins::{Samples, Sync};
use host_sim::fault::{FaultSpec, Injector};
use host_sim::profile::Profile;
use host_sim::scene::Scene;
use host_sim::sensor::{Readout, Sensor};

use crate::footage::Footage;
use crate::i2c::Shared;

/// What drives the pins.
#[derive(Debug)]
pub struct Camera {
    footage: Footage,
    pclk_hz: u32,
    live: Option<Live>,
}

/// A sensor that goes on as its registers say.
#[derive(Debug)]
struct Live {
    sensor: Shared,
    scene: Scene,
    faults: Faults,
    /// Frames sent so far, and at most.
    sent: u64,
    most: u64,
    /// What the registers said when the last frame was sent, and the player of it.
    playing: Option<(Readout, Sensor)>,
}

/// Faults between sensor and pins.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    /// Which.
    pub specs: Vec<FaultSpec>,
    /// What is not said of them is drawn by this.
    pub seed: u64,
}

impl Camera {
    /// Recorded pins, one sample a pixel clock, at `pclk_hz` (at least 1).
    #[must_use]
    pub fn recorded(footage: Footage, pclk_hz: u32) -> Self {
        Self { footage, pclk_hz: pclk_hz.max(1), live: None }
    }

    /// A sensor that looks at `scene` and sends `frames` frames once its registers make it send any.
    #[must_use]
    pub fn live(sensor: Shared, scene: Scene, faults: Faults, frames: u64) -> Self {
        let live = Live { sensor, scene, faults, sent: 0, most: frames, playing: None };
        Self { footage: Footage::default(), pclk_hz: 1, live: Some(live) }
    }

    /// Pixel clocks a second.
    #[must_use]
    pub fn pclk_hz(&self) -> u32 {
        self.pclk_hz
    }

    /// Has the next frame made, if the pins have nothing left and the sensor sends one. Whether there is something ahead.
    pub fn refill(&mut self) -> bool {
        if let (None, Some(live)) = (self.footage.ahead(), &mut self.live)
            && let Some((footage, pclk_hz)) = live.next_frame()
        {
            (self.footage, self.pclk_hz) = (footage, pclk_hz.max(1));
        }
        self.footage.ahead().is_some()
    }

    /// Sync levels and samples from here to the end of the stretch; `None` while the pixel clock stands still.
    #[must_use]
    pub fn ahead(&self) -> Option<(Sync, Samples<'_>)> {
        self.footage.ahead()
    }

    /// Clocks from the clock that is `clocks` ahead to the next change of the sync levels, the first clock with the new
    /// ones among them; `None` if nothing is there yet.
    #[must_use]
    pub fn until_edge(&self, clocks: u64) -> Option<u64> {
        self.footage.until_edge(clocks)
    }

    /// So many clocks have been played.
    pub fn advance(&mut self, clocks: usize) {
        self.footage.advance(clocks);
    }

    /// Nothing more will come.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.footage.ahead().is_none() && self.live.as_ref().is_none_or(|live| live.sent >= live.most)
    }
}

impl Live {
    /// The pins of the next frame, by the registers as they are now.
    fn next_frame(&mut self) -> Option<(Footage, u32)> {
        if self.sent >= self.most {
            return None;
        }
        let readout = self.sensor.lock().unwrap_or_else(PoisonError::into_inner).readout().ok()?;
        if self.playing.as_ref().is_none_or(|(known, _)| *known != readout) {
            let player = readout.player().ok()?;
            self.playing = Some((readout, player));
        }
        let (readout, player) = self.playing.as_mut()?;
        let profile = readout.profile();
        let bytes = readout.frame_bytes(&self.scene, self.sent);
        self.sent += 1;
        let is_last = self.sent == self.most;
        let footage = with_faults(&profile, &self.faults, self.sent, |sink| {
            let played = player.play_frame_bytes(&bytes, sink);
            if is_last { played.and_then(|()| player.close(sink)) } else { played }
        })?;
        Some((footage, profile.timing.pclk_hz))
    }
}

/// Plays through the faults, if there are any, into a footage; `None` if they do not go with the profile.
fn with_faults<E>(
    profile: &Profile,
    faults: &Faults,
    salt: u64,
    play: impl FnOnce(&mut Injector<Footage>) -> Result<(), E>,
) -> Option<Footage> {
    let mut injector =
        Injector::new(profile, &faults.specs, faults.seed.wrapping_add(salt), Footage::default()).ok()?;
    play(&mut injector).ok()?;
    injector.finish().ok()
}
