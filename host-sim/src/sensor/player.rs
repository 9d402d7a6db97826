use firmware::trace::StretchSink;
use image::RgbImage;

use super::lines::Lines;
use super::{embedded, gated, marker};
use crate::picture::{self, SizeError};
use crate::profile::{Profile, ProfileError, SyncMode};
use crate::scene::Scene;

/// A virtual sensor of a profile.
///
/// Frames follow one another without a pause of their own until [`Sensor::close`] ends the last one.
#[derive(Clone, Debug)]
pub struct Sensor {
    profile: Profile,
    /// Whether a frame has been played since the start or the last close.
    is_open: bool,
    /// Room for a line, kept between frames.
    lines: Lines,
}

/// Why playing stopped. What had been played by then has been played.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlayError<E> {
    /// A picture of another size than the profile's frame; nothing of it was played.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// Bytes that are not a frame; nothing of them was played.
    #[error("a frame of this profile has {expected} bytes, not {got}")]
    Length {
        /// Bytes of a frame.
        expected: u64,
        /// Bytes given.
        got: u64,
    },
    /// The sink wants no more.
    #[error("the sensor's output was refused")]
    Sink(#[source] E),
}

impl Sensor {
    /// A sensor that plays as the profile says.
    ///
    /// # Errors
    /// What [`Profile::check`] finds.
    pub fn new(profile: Profile) -> Result<Self, ProfileError> {
        profile.check()?;
        Ok(Self { profile, is_open: false, lines: Lines::default() })
    }

    /// The profile.
    #[must_use]
    pub fn profile(&self) -> &Profile {
        &self.profile
    }

    /// The bytes of a frame as they go out, in the form in which DMA writes them: see [`picture::encode`]. With
    /// embedded sync no byte is a code's: see [`make_code_free`](super::make_code_free).
    ///
    /// # Errors
    /// [`SizeError`] if the picture is not of the profile's size.
    pub fn encode(&self, picture: &RgbImage) -> Result<Vec<u8>, SizeError> {
        let mut bytes = picture::encode(picture, &self.profile)?;
        if self.profile.bus.sync == SyncMode::Embedded {
            embedded::make_code_free(&mut bytes);
        }
        Ok(bytes)
    }

    /// Plays frames 0 to `frames` - 1 of a scene and closes the last one.
    ///
    /// # Errors
    /// [`PlayError::Sink`] with what the sink has against it.
    pub fn play<S: StretchSink>(
        &mut self,
        frames: u64,
        scene: &Scene,
        sink: &mut S,
    ) -> Result<(), PlayError<S::Error>> {
        let mut bytes = Vec::new();
        for frame_number in 0..frames {
            if bytes.is_empty() || !scene.is_still() {
                let frame = &self.profile.frame;
                bytes = self.encode(&scene.render(frame_number, frame.width, frame.height))?;
            }
            self.play_frame_bytes(&bytes, sink)?;
        }
        self.close(sink)
    }

    /// Plays a picture as the next frame.
    ///
    /// # Errors
    /// [`PlayError::Size`] if it is not of the profile's size, and [`PlayError::Sink`].
    pub fn play_picture<S: StretchSink>(
        &mut self,
        picture: &RgbImage,
        sink: &mut S,
    ) -> Result<(), PlayError<S::Error>> {
        let bytes = self.encode(picture)?;
        self.play_frame_bytes(&bytes, sink)
    }

    /// Plays the next frame from its bytes, which are in the form in which DMA writes them (see [`Sensor::encode`]).
    ///
    /// Bits above the width of the bus are cut off. With embedded sync 0x00 goes out as 0x01 and 0xFF as 0xFE.
    ///
    /// # Errors
    /// [`PlayError::Length`] if there are more or fewer bytes than a frame has, and [`PlayError::Sink`].
    pub fn play_frame_bytes<S: StretchSink>(
        &mut self,
        bytes: &[u8],
        sink: &mut S,
    ) -> Result<(), PlayError<S::Error>> {
        let (expected, got) = (self.profile.bytes_per_frame(), bytes.len() as u64);
        if expected != got {
            return Err(PlayError::Length { expected, got });
        }
        let is_first = !std::mem::replace(&mut self.is_open, true);
        let play = match self.profile.bus.sync {
            SyncMode::Marker => marker::frame,
            SyncMode::Gated => gated::frame,
            SyncMode::Embedded => embedded::frame,
        };
        play(&self.profile, &mut self.lines, bytes, is_first, sink).map_err(PlayError::Sink)
    }

    /// Ends the last frame: `marker` by an idle clock, the others by blanking. Without a frame before it does nothing.
    ///
    /// # Errors
    /// [`PlayError::Sink`] with what the sink has against it.
    pub fn close<S: StretchSink>(&mut self, sink: &mut S) -> Result<(), PlayError<S::Error>> {
        if !std::mem::replace(&mut self.is_open, false) {
            return Ok(());
        }
        let close = match self.profile.bus.sync {
            SyncMode::Marker => marker::close,
            SyncMode::Gated => gated::close,
            SyncMode::Embedded => embedded::blanking,
        };
        close(&self.profile, sink).map_err(PlayError::Sink)
    }
}
