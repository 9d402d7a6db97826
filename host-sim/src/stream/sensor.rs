use image::RgbImage;

use crate::profile::Profile;
use crate::scene::Scene;
use crate::sensor::{Readout, Sensor, VirtualSensor};

/// What the device's sensor is, and what it looks at.
pub(super) struct Looking {
    pub(super) scene: Scene,
    /// A sensor with registers; without, one that sends what its profile says.
    pub(super) chip: Option<VirtualSensor>,
    /// Levels that are added to a sensor's picture that has no registers for that.
    pub(super) brightness: i32,
}

/// The sensor as it sends frames now.
pub(super) struct Player {
    pub(super) sensor: Sensor,
    readout: Option<Readout>,
    /// The frame of a scene that stands still, and its brightness.
    still: Option<(i32, Vec<u8>)>,
}

impl Looking {
    /// A player of what comes out; or why nothing does.
    pub(super) fn player(&self, profile: &Profile) -> Result<Player, String> {
        let readout = match &self.chip {
            None => None,
            Some(chip) => Some(chip.readout().map_err(|silent| silent.to_string())?),
        };
        let profile = readout.as_ref().map_or_else(|| profile.clone(), Readout::profile);
        let sensor = Sensor::new(profile).map_err(|error| error.to_string())?;
        Ok(Player { sensor, readout, still: None })
    }
}

impl Player {
    /// The bytes of a frame as they go over the wires.
    pub(super) fn frame(&mut self, looking: &Looking, number: u64) -> Vec<u8> {
        if let Some(readout) = &self.readout {
            return readout.frame_bytes(&looking.scene, number);
        }
        let brightness = looking.brightness;
        if let Some((made_at, bytes)) = &self.still
            && *made_at == brightness
        {
            return bytes.clone();
        }
        let frame = self.sensor.profile().frame;
        let mut picture = looking.scene.render(number, frame.width, frame.height);
        brighten(&mut picture, brightness);
        // The picture is of the profile's size.
        let bytes = self.sensor.encode(&picture).unwrap_or_default();
        if looking.scene.is_still() {
            self.still = Some((brightness, bytes.clone()));
        }
        bytes
    }
}

/// Adds to each channel, up to its ends.
pub(super) fn brighten(picture: &mut RgbImage, levels: i32) {
    if levels != 0 {
        for channel in picture.iter_mut() {
            *channel = (i32::from(*channel) + levels).clamp(0, 255) as u8;
        }
    }
}
