//! Pixel format, size, crop, rate: what is asked for, and what the device grants.

use algos_nostd::pixel::yuv422::{Matrix, Range};
use v4l2_capture::{Device, Error, Format, FourCc, Interval, Rectangle, Sizes, Target};

use super::super::device::{Settings, YuvMeaning};
use super::super::error::CaptureError;
use super::super::layout::{Layout, Space};
use super::refusal::{refused, unknown};

/// `V4L2_FIELD_…` of whole frames: any, none, interlaced in its three kinds.
const WHOLE_FRAMES: [u32; 5] = [0, 1, 4, 8, 9];

/// `V4L2_FIELD_NONE`
const PROGRESSIVE: u32 = 1;

pub(super) fn set_format(
    device: &Device,
    settings: &Settings,
    notes: &mut Vec<String>,
) -> Result<Format, CaptureError> {
    let fail = |error: &Error| refused(device, "a format".to_owned(), error, "see `dmesg`");
    let current = device.format().map_err(|error| fail(&error))?;
    let offered: Vec<FourCc> =
        device.formats().map_err(|error| fail(&error))?.iter().map(|format| format.code).collect();
    let size = settings.size.unwrap_or((current.width, current.height));
    let code = match settings.code {
        Some(code) if !offered.is_empty() && !offered.contains(&code) => {
            let names: Vec<String> = offered.iter().map(FourCc::to_string).collect();
            return Err(unknown(device, "pixel format", &code.to_string(), names.iter().map(String::as_str)));
        }
        Some(code) => code,
        None => choose(device, current.code, &offered, size, settings.rate),
    };
    let ask = |size: (u32, u32)| {
        device.set_format(code, size).map_err(|error| {
            refused(device, format!("{code} at {} × {}", size.0, size.1), &error, "ask for another")
        })
    };
    // What is set so is left as it is: with it goes a gap between lines that somebody has asked for.
    let is_set = settings.crop.is_none()
        && (current.code, current.width, current.height, current.field)
            == (code, size.0, size.1, PROGRESSIVE);
    let mut format = if is_set { current } else { ask(size)? };
    if let Some((left, top, width, height)) = settings.crop {
        let crop = Rectangle { left, top, width, height };
        device.set_crop(crop).map_err(|error| {
            let bounds = device.selection(Target::CropBounds).ok().flatten();
            let remedy = bounds.map_or_else(
                || {
                    "this device, or this input of it, can't crop: leave it out, or use `--op crop:…`"
                        .to_owned()
                },
                |bounds| format!("it can be within {bounds}"),
            );
            refused(device, format!("the crop {crop}"), &error, remedy)
        })?;
        // A device that can't scale has changed its size with it; one that can is asked for the crop's pixels as they are.
        format = ask(settings.size.unwrap_or((width, height)))?;
        let granted = device.selection(Target::Crop).ok().flatten();
        if granted != Some(crop) {
            let granted = granted.map_or_else(|| "nothing".to_owned(), |granted| granted.to_string());
            notes.push(format!("asked to crop {crop}, the device crops {granted}"));
        }
    }
    if format.code != code {
        let what = format!("the device takes {} instead", format.code);
        return Err(CaptureError::Refused {
            device: device.path().display().to_string(),
            setting: format!("the pixel format {code}"),
            what,
            remedy: "ask for that".to_owned(),
        });
    }
    if let Some((width, height)) = settings.size
        && (format.width, format.height) != (width, height)
    {
        notes.push(format!(
            "asked for {width} × {height} pixels, the device takes {} × {}",
            format.width, format.height
        ));
    }
    if !WHOLE_FRAMES.contains(&format.field) {
        return Err(CaptureError::Refused {
            device: device.path().display().to_string(),
            setting: "whole frames".to_owned(),
            what: format!("the device gives fields apart (V4L2_FIELD {})", format.field),
            remedy: "take another input or standard".to_owned(),
        });
    }
    Ok(format)
}

/// The pixel format to ask for: the first that has the size and the rate, of the one that is set and of those that become
/// pictures; if none has, the first that becomes a picture.
fn choose(
    device: &Device,
    current: FourCc,
    offered: &[FourCc],
    size: (u32, u32),
    rate: Option<f64>,
) -> FourCc {
    let fits = |code: FourCc| {
        let has_size = match device.sizes(code) {
            Ok(Sizes::These(sizes)) => sizes.is_empty() || sizes.contains(&size),
            Ok(Sizes::Range { least, greatest, .. }) => {
                (least.0..=greatest.0).contains(&size.0) && (least.1..=greatest.1).contains(&size.1)
            }
            Err(_) => true,
        };
        has_size
            && rate.is_none_or(|rate| {
                device.intervals(code, size).is_ok_and(|all| {
                    all.is_empty() || all.iter().any(|interval| interval.rate() > rate * 0.99)
                })
            })
    };
    let known = std::iter::once(current).chain(Layout::codes());
    let pictures: Vec<FourCc> = known
        .filter(|code| Layout::of(*code).is_some())
        .filter(|code| *code == current || offered.contains(code))
        .collect();
    let best = pictures.iter().find(|code| fits(**code)).or(pictures.first());
    best.copied().unwrap_or(current)
}

pub(super) fn set_rate(
    device: &Device,
    settings: &Settings,
    notes: &mut Vec<String>,
) -> Result<Option<f64>, CaptureError> {
    let Some(rate) = settings.rate else {
        return Ok(device.interval().ok().flatten().map(Interval::rate));
    };
    let granted = device
        .set_interval(Interval::of_rate(rate))
        .map_err(|error| refused(device, format!("{rate} frames a second"), &error, "ask for another rate"))?
        .map(Interval::rate);
    match granted {
        None => {
            notes.push(format!("asked for {rate} frames a second, the device does not let that be chosen"));
        }
        Some(granted) if (granted - rate).abs() > rate / 100.0 => {
            notes.push(format!("asked for {rate} frames a second, the device takes {granted:.2}"));
        }
        Some(_) => {}
    }
    Ok(granted)
}

/// What the device says of its colours, and what the kernel's documentation says of what it leaves open.
pub(super) fn meaning(format: &Format) -> YuvMeaning {
    const REC709: u32 = 3;
    const JPEG: u32 = 7;
    const BT2020: u32 = 10;
    const DCI_P3: u32 = 12;
    let matrix = match (format.encoding, format.colorspace) {
        (2 | 4 | 6 | 7, _) | (0, REC709 | DCI_P3 | BT2020) => Matrix::Bt709,
        _ => Matrix::Bt601,
    };
    let range = match (format.quantization, format.colorspace) {
        (1, _) | (0, JPEG) => Range::Full,
        _ => Range::Limited,
    };
    let hue = Layout::of(format.code);
    let is_hsv = matches!(hue, Some(Layout::Packed(packed)) if packed.space == Space::Hsv);
    // `V4L2_HSV_ENC_256`
    YuvMeaning { matrix, range, whole_hue: is_hsv && format.encoding == 129 }
}

#[cfg(test)]
mod tests {
    use v4l2_capture::PlaneLayout;

    use super::*;

    #[test]
    fn colours_left_open_follow_the_colour_space() {
        let of = |code: &[u8; 4], colorspace, encoding, quantization| {
            let planes = vec![PlaneLayout { stride: 0, bytes: 0 }];
            let code = FourCc::new(code);
            meaning(&Format {
                code,
                width: 2,
                height: 2,
                field: 1,
                colorspace,
                encoding,
                quantization,
                planes,
            })
        };
        let plain = YuvMeaning::default();
        assert_eq!(of(b"YUYV", 8, 0, 0), plain, "sRGB, as of webcams");
        assert_eq!(of(b"YUYV", 3, 0, 0), YuvMeaning { matrix: Matrix::Bt709, ..plain });
        assert_eq!(of(b"YUYV", 3, 1, 1), YuvMeaning { range: Range::Full, ..plain });
        assert_eq!(of(b"YUYV", 7, 0, 0), YuvMeaning { range: Range::Full, ..plain });
        assert_eq!(of(b"YUYV", 7, 0, 2), plain);
        assert!(of(b"HSV3", 8, 129, 0).whole_hue && !of(b"HSV3", 8, 128, 0).whole_hue);
    }
}
