//! White balance from frame to frame: a frame is measured while it passes, and the next one is corrected.

use algos_nostd::color::balance::Gains;
use algos_nostd::color::balance::gray_world::GrayWorld;
use algos_nostd::color::balance::running::RunningWhite;
use algos_nostd::color::pointwise::PixelMap;
use algos_nostd::image::{Error, Rgb};

/// Each frame moves the white by an eighth of the way; within 2 % it stands still, so that the picture does not flicker.
const RATE: u16 = 32;
const BAND: u16 = 20;

/// The light on the scene, as known so far.
#[derive(Clone, Copy, Debug)]
pub struct Light {
    frame: GrayWorld,
    running: RunningWhite,
    gains: Gains,
}

impl Light {
    pub(super) fn new() -> Result<Self, Error> {
        let running = RunningWhite::new(RATE, BAND)?;
        Ok(Self { frame: GrayWorld::new(), running, gains: Gains::IDENTITY })
    }

    /// Measures the line, and corrects it by what the frames before have shown.
    pub(super) fn balance(&mut self, line: &mut [Rgb]) {
        self.frame.push(line);
        self.gains.apply_line(line);
    }

    /// The frame has been measured. A frame too dark to tell changes nothing.
    pub(super) fn frame_ended(&mut self) {
        if let Some(white) = self.frame.finish()
            && let Ok(gains) = Gains::neutralizing(self.running.update(white))
        {
            self.gains = gains;
        }
    }
}
