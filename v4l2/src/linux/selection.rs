use super::call::{GET_SELECTION, SET_SELECTION};
use super::device::Device;
use super::error::Error;
use super::raw::{self, Plain};

/// A part of a picture, in pixels from its left and upper side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rectangle {
    /// Pixels from the left.
    pub left: i32,
    /// Lines from above.
    pub top: i32,
    /// Pixels a line.
    pub width: u32,
    /// Lines.
    pub height: u32,
}

impl std::fmt::Display for Rectangle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}x{}{:+}{:+}", self.width, self.height, self.left, self.top)
    }
}

/// What a rectangle is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// The part of the sensor's picture that is captured.
    Crop,
    /// That part as the driver sets it by itself.
    CropDefault,
    /// The whole of what can be captured.
    CropBounds,
}

impl Device {
    fn selection_argument(target: Target) -> raw::Selection {
        let target = match target {
            Target::Crop => 0,
            Target::CropDefault => 1,
            Target::CropBounds => 2,
        };
        // The single-planar type is meant for devices of both kinds.
        raw::Selection { kind: raw::CAPTURE, target, ..raw::Selection::ZERO }
    }

    /// A rectangle of the device; `None` if it has none.
    ///
    /// # Errors
    /// If the device does not answer.
    pub fn selection(&self, target: Target) -> Result<Option<Rectangle>, Error> {
        let mut raw = Self::selection_argument(target);
        match self.call(&GET_SELECTION, &mut raw) {
            Err(error) if error.is_unsupported() => Ok(None),
            other => other.map(|()| Some(rectangle(&raw))),
        }
    }

    /// Asks for the part to be captured. The device takes the nearest that it can, and that comes back.
    ///
    /// # Errors
    /// If the device cannot choose, or is streaming.
    pub fn set_crop(&self, crop: Rectangle) -> Result<Rectangle, Error> {
        let mut raw = Self::selection_argument(Target::Crop);
        (raw.left, raw.top, raw.width, raw.height) = (crop.left, crop.top, crop.width, crop.height);
        self.call(&SET_SELECTION, &mut raw)?;
        Ok(rectangle(&raw))
    }
}

fn rectangle(raw: &raw::Selection) -> Rectangle {
    Rectangle { left: raw.left, top: raw.top, width: raw.width, height: raw.height }
}
