use algos_nostd::pixel::bayer::BayerOrder;
use firmware::trace::StretchSink;
use image::{Rgb, RgbImage, imageops};
use rgb::FromSlice;

use super::encoding::Encoding;
use super::view::View;
use crate::profile::{Bus, Frame, Profile, ProfileError, Timing};
use crate::scene::Scene;
use crate::sensor::{PlayError, Sensor};

/// Why nothing comes out.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Silent {
    /// No input clock.
    #[error("the sensor has no input clock")]
    NoClock,
    /// It sleeps, or its outputs are off.
    #[error("the sensor sends nothing: {reason}")]
    Off {
        /// Which register says so.
        reason: &'static str,
    },
    /// The registers ask for what cannot be sent.
    #[error("the registers make no frame: {reason}")]
    NoFrame {
        /// What does not go together.
        reason: &'static str,
    },
    /// The registers ask for what this model of the sensor lacks.
    #[error("not modelled: {what}")]
    NotModelled {
        /// What.
        what: &'static str,
    },
}

/// A picture that the sensor makes itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// Eight colour bars: white, yellow, cyan, green, magenta, red, blue, black.
    Bars,
    /// The same, fading to gray downwards.
    FadingBars,
    /// Gray, brighter from left to right.
    RampX,
    /// Gray, brighter from top to bottom.
    RampY,
    /// Gray, brighter towards the lower right corner.
    RampDiagonal,
}

/// What a sensor's registers amount to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Readout {
    /// The sensor's name.
    pub sensor: &'static str,
    /// What the wires mean.
    pub bus: Bus,
    /// When things happen.
    pub timing: Timing,
    /// What of the scene is seen, and in what size.
    pub view: View,
    /// How pixels stand on the wires.
    pub encoding: Encoding,
    /// The mosaic from the first pixel that is sent.
    pub bayer: BayerOrder,
    /// Left and right exchanged.
    pub mirror: bool,
    /// Top and bottom exchanged.
    pub flip: bool,
    /// Dark and bright exchanged.
    pub negative: bool,
    /// A picture of its own instead of the scene.
    pub pattern: Option<Pattern>,
    /// Settings that were seen and make no difference here.
    pub notes: Vec<&'static str>,
}

impl Readout {
    /// The profile of what comes out. Where no profile's format is the sensor's, it has the nearest.
    #[must_use]
    pub fn profile(&self) -> Profile {
        let (width, height) = self.view.output;
        let frame = Frame { width, height, format: self.encoding.nearest(), bayer: self.bayer };
        let encoding = self.encoding.name();
        let name = format!("{}-{width}x{height}-{encoding}", self.sensor);
        let about = format!("what the registers of a virtual {} say", self.sensor);
        Profile { name, about, bus: self.bus, frame, timing: self.timing }
    }

    /// What the sensor sees in a frame, before it is encoded.
    #[must_use]
    pub fn picture(&self, scene: &Scene, frame_number: u64) -> RgbImage {
        let (width, height) = self.view.output;
        let mut picture = match self.pattern {
            Some(pattern) => pattern.paint(width, height),
            None => self.view.show(|width, height| scene.render(frame_number, width, height)),
        };
        if self.mirror {
            imageops::flip_horizontal_in_place(&mut picture);
        }
        if self.flip {
            imageops::flip_vertical_in_place(&mut picture);
        }
        if self.negative {
            imageops::invert(&mut picture);
        }
        picture
    }

    /// The bytes of a frame in the form in which DMA writes them.
    #[must_use]
    pub fn frame_bytes(&self, scene: &Scene, frame_number: u64) -> Vec<u8> {
        let profile = self.profile();
        let meaning = profile.frame.meaning();
        let picture = self.picture(scene, frame_number);
        let (width, line) = (profile.frame.width as usize, profile.bytes_per_line() as usize);
        let mut bytes = vec![0; line * profile.frame.height as usize];
        let rows = picture.as_raw().as_rgb().chunks(width.max(1));
        for (y, (pixels, bytes)) in rows.zip(bytes.chunks_mut(line.max(1))).enumerate() {
            self.encoding.encode_line(pixels, bytes, y, &meaning);
        }
        bytes
    }

    /// A player of its frames.
    ///
    /// # Errors
    /// If the registers ask for a frame that no profile can hold, such as one wider than 8,192 pixels.
    pub fn player(&self) -> Result<Sensor, ProfileError> {
        Sensor::new(self.profile())
    }

    /// Plays frames of a scene and closes the last one.
    ///
    /// # Errors
    /// [`PlayError::Sink`] with what the sink has against it.
    ///
    /// # Panics
    /// If [`Readout::player`] fails, which decoded registers rule out.
    pub fn play<S: StretchSink>(
        &self,
        frames: u64,
        scene: &Scene,
        sink: &mut S,
    ) -> Result<(), PlayError<S::Error>> {
        let mut player = self.player().expect("decoded registers make a profile");
        for frame in 0..frames {
            player.play_frame_bytes(&self.frame_bytes(scene, frame), sink)?;
        }
        player.close(sink)
    }

    /// Leaves out what cannot be sent, and says what cannot be sent at all.
    pub(super) fn checked(mut self) -> Result<Self, Silent> {
        if self.view.output.0 == 0 || self.view.output.1 == 0 {
            return Err(Silent::NoFrame { reason: "the window holds no pixel" });
        }
        if self.view.output.0 > 8_192 || self.view.output.1 > 8_192 {
            return Err(Silent::NoFrame { reason: "the window is wider or higher than 8,192 pixels" });
        }
        if self.profile().frame.is_yuv422() && !self.view.output.0.is_multiple_of(2) {
            self.notes.push("an odd pixel at a line's end has no colour of its own and is cut off");
            self.view.output.0 -= 1;
            self.timing.hblank += 2;
            self.timing.vblank += 2;
            self.timing.vfront += 2;
        }
        match self.player() {
            Ok(_) => Ok(self),
            Err(_) => Err(Silent::NoFrame { reason: "blanking and window do not fit each other" }),
        }
    }
}

impl Pattern {
    fn paint(self, width: u32, height: u32) -> RgbImage {
        let part = |place: u32, of: u32| (place * 255 / (of.saturating_sub(1)).max(1)) as u8;
        let bar = |x: u32| {
            let bar = 7 - (x * 8 / width.max(1)).min(7) as u8;
            let level = |bit: u8| if bar >> bit & 1 == 1 { 255_u8 } else { 0 };
            [level(1), level(2), level(0)]
        };
        RgbImage::from_fn(width, height, |x, y| {
            Rgb(match self {
                Self::Bars => bar(x),
                Self::FadingBars => {
                    let fade = u32::from(part(y, height));
                    bar(x).map(|level| ((u32::from(level) * (255 - fade) + 128 * fade) / 255) as u8)
                }
                Self::RampX => [part(x, width); 3],
                Self::RampY => [part(y, height); 3],
                Self::RampDiagonal => [part(x + y, width + height - 1); 3],
            })
        })
    }
}
