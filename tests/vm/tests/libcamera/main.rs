//! `host-sim capture` on libcamera's virtual cameras, which `tests/vm/virtual.yaml` describes: one shows colour bars, one lines.
//!
//! Run by `tests/vm/run-libcamera` in a virtual machine; ignored elsewhere.
#![cfg(all(target_os = "linux", target_pointer_width = "64"))]

use std::path::Path;

use camif_vm::bars;
use camif_vm::command::{Finished, host_sim};
use image::RgbImage;

mod list;
mod frames;
mod errors;

/// The camera that shows bars.
const BARS: &str = "Virtual0";
/// The one that shows lines.
const LINES: &str = "Virtual1";

/// Captures from one camera.
fn capture(id: &str, more: &[&str]) -> Finished {
    host_sim(&[&["capture", "--libcamera", id], more].concat())
}

/// Holds a picture to the bars, which move left by a pixel from frame to frame. Chroma is shared by two pixels, so those at
/// the borders are not looked at.
fn assert_shows_bars(picture: &RgbImage, sequence: u32) {
    let (width, height) = picture.dimensions();
    let shift = (sequence + 1) % width;
    let still = RgbImage::from_fn(width, height, |x, y| *picture.get_pixel((x + width - shift) % width, y));
    let (difference, place) = bars::difference(&still, &bars::picture(width, height, 255), 2);
    assert!(difference <= 3, "frame {sequence} differs by {difference} at {place:?}");
}

fn read(folder: &Path, name: &str) -> RgbImage {
    host_sim::picture::read(&folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}
