//! Which cameras there are.

use v4l2_capture::{Device, Error, Interval, Sizes, device_paths};

use super::super::device::{Found, FoundFormat, FoundSize};
use super::super::error::CaptureError;
use super::super::layout::Layout;
use super::refusal::open_error;

/// What is looked at where no camera is found.
pub const ADVICE: &str = "\
V4L2: no /dev/video* is a camera. Check that it is plugged in (`lsusb`), that its driver is loaded (`modprobe uvcvideo`
      for USB webcams; `modprobe vivid` makes a virtual one), and what `dmesg` says of it";

/// Every camera, and why a device could not be asked.
#[must_use]
pub fn list() -> (Vec<Found>, Vec<CaptureError>) {
    let (mut found, mut errors) = (Vec::new(), Vec::new());
    for path in device_paths() {
        match Device::open(&path).and_then(|device| device.map(|device| describe(&device)).transpose()) {
            Ok(described) => found.extend(described),
            Err(error) => errors.push(open_error(&path, &error)),
        }
    }
    (found, errors)
}

/// `V4L2_CAP_IO_MC`
const MEDIA_CONTROLLED: u32 = 0x2000_0000;

fn describe(device: &Device) -> Result<Found, Error> {
    let capability = device.capability();
    let inputs = device.inputs()?;
    let formats = device.formats()?.into_iter().map(|format| {
        let sizes = match device.sizes(format.code)? {
            Sizes::These(sizes) => sizes.into_iter().map(|size| (size, None)).collect(),
            Sizes::Range { least, greatest, .. } => vec![(least, Some(greatest))],
        };
        let sizes = sizes.into_iter().map(|((width, height), up_to)| {
            let rates = device.intervals(format.code, up_to.unwrap_or((width, height)))?;
            Ok(FoundSize { width, height, up_to, rates: rates.into_iter().map(Interval::rate).collect() })
        });
        Ok(FoundFormat {
            code: format.code.to_string(),
            name: format.name,
            picture: Layout::of(format.code).is_some(),
            sizes: sizes.collect::<Result<_, Error>>()?,
        })
    });
    Ok(Found {
        interface: "v4l2",
        id: device.path().display().to_string(),
        name: capability.card.clone(),
        place: format!("{}, {}", capability.driver, capability.bus),
        media_controlled: capability.flags & MEDIA_CONTROLLED != 0,
        rates: None,
        formats: formats.collect::<Result<_, Error>>()?,
        inputs: if inputs.len() > 1 {
            inputs.into_iter().map(|input| input.name).collect()
        } else {
            Vec::new()
        },
    })
}
