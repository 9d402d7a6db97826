//! Cameras of the Linux kernel: USB webcams, frame grabbers, camera interfaces of systems on chip.

use std::path::Path;
use std::time::Duration;

use algos_nostd::pixel::yuv422::{Matrix, Range};
use v4l2_capture::{
    Buffer, Control, ControlKind, Device, Error, Format, FourCc, Interval, Rectangle, Sizes, Stream, Target,
    Value, device_paths,
};

use super::device::{
    CaptureDevice, Captured, Found, FoundFormat, FoundSize, FrameFormat, Settings, YuvMeaning,
};
use super::error::CaptureError;
use super::layout::{Layout, Space};
use crate::profile::nearest;

/// What is looked at where no camera is found.
pub const ADVICE: &str = "\
V4L2: no /dev/video* is a camera. Check that it is plugged in (`lsusb`), that its driver is loaded (`modprobe uvcvideo`
      for USB webcams; `modprobe vivid` makes a virtual one), and what `dmesg` says of it";

/// A camera that streams.
#[derive(Debug)]
pub struct V4l2 {
    name: String,
    stream: Stream,
    format: FrameFormat,
    notes: Vec<String>,
}

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
        formats: formats.collect::<Result<_, Error>>()?,
        inputs: if inputs.len() > 1 {
            inputs.into_iter().map(|input| input.name).collect()
        } else {
            Vec::new()
        },
    })
}

fn open_error(path: &Path, error: &Error) -> CaptureError {
    let remedy = if error.is_missing() {
        "check the path; `host-sim capture --list` says which there are"
    } else if error.is_forbidden() {
        "join the group that owns it, most often by `sudo usermod -aG video $USER`, and log in again"
    } else if error.is_busy() {
        "another program uses it: end that"
    } else if error.is_unsupported() {
        "it is no video device; `host-sim capture --list` says which there are"
    } else {
        "unplug it and plug it in again"
    };
    CaptureError::Open { device: path.display().to_string(), what: error.source.to_string(), remedy }
}

fn refused(device: &Device, setting: String, error: &Error, remedy: impl Into<String>) -> CaptureError {
    let remedy = if error.is_busy() { "another program uses it: end that".into() } else { remedy.into() };
    CaptureError::Refused {
        device: device.path().display().to_string(),
        setting,
        what: format!("{}: {}", error.request, error.source),
        remedy,
    }
}

fn unknown<'a>(
    device: &Device,
    kind: &'static str,
    name: &str,
    known: impl Iterator<Item = &'a str> + Clone,
) -> CaptureError {
    // The nearest one first.
    let first = nearest(name, known.clone());
    let others = known.filter(|other| Some(*other) != first);
    let known = first.into_iter().chain(others).collect::<Vec<_>>().join(", ");
    CaptureError::Unknown { device: device.path().display().to_string(), kind, name: name.to_owned(), known }
}

/// Opens a device that captures.
///
/// # Errors
/// [`CaptureError::Open`] with what to do.
pub fn open(path: &Path) -> Result<Device, CaptureError> {
    match Device::open(path) {
        Ok(Some(device)) => Ok(device),
        Ok(None) => Err(CaptureError::Open {
            device: path.display().to_string(),
            what: "it does not capture frames".to_owned(),
            remedy: "`host-sim capture --list` says which devices do",
        }),
        Err(error) => Err(open_error(path, &error)),
    }
}

/// A control as the command line shows it, and its value.
pub type ControlValue = (Control, Option<Value>);

/// All controls of a device, and their values.
///
/// # Errors
/// If the device does not answer.
pub fn controls(device: &Device) -> Result<Vec<ControlValue>, CaptureError> {
    let fail = |error: &Error| refused(device, "a list of controls".to_owned(), error, "plug it in again");
    let all = device.controls().map_err(|error| fail(&error))?;
    // A value that can't be read now is none.
    Ok(all
        .into_iter()
        .map(|control| (control.clone(), device.control(&control).unwrap_or_default()))
        .collect())
}

impl V4l2 {
    /// Chooses, sets and starts a device.
    ///
    /// # Errors
    /// [`CaptureError`] with the setting that was refused, and what there is instead.
    pub fn start(path: &Path, settings: &Settings) -> Result<Self, CaptureError> {
        let device = open(path)?;
        let mut notes = Vec::new();
        if let Some(index) = settings.input {
            let inputs = device.inputs().unwrap_or_default();
            if !inputs.iter().any(|input| input.index == index) {
                let names: Vec<String> =
                    inputs.iter().map(|input| format!("{} ({})", input.index, input.name)).collect();
                return Err(unknown(&device, "input", &index.to_string(), names.iter().map(String::as_str)));
            }
            device
                .set_input(index)
                .map_err(|error| refused(&device, format!("input {index}"), &error, "take another"))?;
        }
        let format = set_format(&device, settings, &mut notes)?;
        let rate = set_rate(&device, settings, &mut notes)?;
        for (name, value) in &settings.controls {
            set_control(&device, name, value)?;
        }
        let stream = Stream::start(&device, settings.buffers).map_err(|error| {
            refused(&device, "streaming".to_owned(), &error, "take a smaller size, or see `dmesg`")
        })?;
        let format = FrameFormat {
            code: format.code,
            width: format.width,
            height: format.height,
            strides: format.planes.iter().map(|plane| plane.stride).collect(),
            yuv: meaning(&format),
            rate,
        };
        Ok(Self { name: path.display().to_string(), stream, format, notes })
    }
}

/// `V4L2_FIELD_…` of whole frames: any, none, interlaced in its three kinds.
const WHOLE_FRAMES: [u32; 5] = [0, 1, 4, 8, 9];

fn set_format(device: &Device, settings: &Settings, notes: &mut Vec<String>) -> Result<Format, CaptureError> {
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
    let mut format = ask(size)?;
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

fn set_rate(
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

/// Sets a control by its name to a value by its text.
///
/// # Errors
/// [`CaptureError::Unknown`] for a control or an item that there is none of, [`CaptureError::Refused`] for a value that is
/// none.
pub fn set_control(device: &Device, name: &str, value: &str) -> Result<(), CaptureError> {
    let all = device
        .controls()
        .map_err(|error| refused(device, "a list of controls".to_owned(), &error, "plug it in again"))?;
    let Some(control) = all.iter().find(|control| control.name == name) else {
        return Err(unknown(device, "control", name, all.iter().map(|control| control.name.as_str())));
    };
    let wrong = |remedy: String| CaptureError::Refused {
        device: device.path().display().to_string(),
        setting: format!("{name}={value}"),
        what: "not a value of this control".to_owned(),
        remedy,
    };
    if control.is_read_only() {
        return Err(wrong("it can only be read".to_owned()));
    }
    let number = parse_number(value);
    let range = || format!("give a number from {} to {}", control.minimum, control.maximum);
    let value = match control.kind {
        ControlKind::Compound(_) => {
            return Err(wrong("it is a structure or an array, which `v4l2-ctl` can set".to_owned()));
        }
        ControlKind::Text => Value::Text(value.to_owned()),
        ControlKind::Button => Value::Number(1),
        ControlKind::Menu | ControlKind::IntegerMenu => {
            let named = control.items.iter().find(|item| item.name.eq_ignore_ascii_case(value));
            // In a menu of numbers, 8 is the item 8, not the eighth.
            let numbered = control.items.iter().find(|item| Some(item.value) == number);
            match named.or(numbered) {
                Some(item) => Value::Number(item.value),
                None => {
                    let names = control.items.iter().map(|item| item.name.as_str());
                    return Err(unknown(device, "menu item", value, names));
                }
            }
        }
        ControlKind::Boolean => match value {
            "on" | "true" | "yes" => Value::Number(1),
            "off" | "false" | "no" => Value::Number(0),
            _ => Value::Number(number.ok_or_else(|| wrong("give on or off".to_owned()))?),
        },
        ControlKind::Integer | ControlKind::Integer64 => {
            let number = number.ok_or_else(|| wrong(range()))?;
            if !(control.minimum..=control.maximum).contains(&number) {
                return Err(wrong(range()));
            }
            Value::Number(number)
        }
        ControlKind::Bitmask => Value::Number(number.ok_or_else(|| wrong("give a number".to_owned()))?),
    };
    device.set_control(control, &value).map_err(|error| {
        let inactive = control.is_inactive();
        let remedy = if inactive {
            "another control has switched it off".to_owned()
        } else {
            "see --controls".to_owned()
        };
        refused(device, format!("{name}={value}"), &error, remedy)
    })
}

/// A decimal number, or a hexadecimal one after 0x.
fn parse_number(text: &str) -> Option<i64> {
    match text.strip_prefix("0x") {
        Some(digits) => i64::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
}

/// What the device says of its colours, and what the kernel's documentation says of what it leaves open.
fn meaning(format: &Format) -> YuvMeaning {
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

impl CaptureDevice for V4l2 {
    fn name(&self) -> &str {
        &self.name
    }

    fn format(&self) -> &FrameFormat {
        &self.format
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }

    fn buffers(&self) -> usize {
        self.stream.queued() as usize
    }

    fn next(&mut self, timeout: Duration) -> Result<Option<Box<dyn Captured>>, CaptureError> {
        match self.stream.next(timeout) {
            Ok(buffer) => Ok(buffer.map(|buffer| Box::new(buffer) as Box<dyn Captured>)),
            Err(error) if error.is_gone() => Err(CaptureError::Gone { device: self.name.clone(), frames: 0 }),
            Err(error) => Err(CaptureError::Stopped {
                device: self.name.clone(),
                frames: 0,
                what: format!("{}: {}", error.request, error.source),
            }),
        }
    }
}

impl Captured for Buffer {
    fn planes(&self) -> Vec<&[u8]> {
        Self::planes(self).collect()
    }

    fn sequence(&self) -> u32 {
        Self::sequence(self)
    }

    fn is_damaged(&self) -> bool {
        self.is_error()
    }
}

#[cfg(test)]
mod tests {
    use v4l2_capture::PlaneLayout;

    use super::*;

    #[test]
    fn what_is_no_camera_is_said_with_a_remedy() {
        let said = |path| open(Path::new(path)).unwrap_err().to_string();
        assert!(said("/dev/video-none").contains("check the path"));
        assert!(said("/dev/null").contains("it is no video device"));
    }

    #[test]
    fn numbers_are_decimal_or_hexadecimal() {
        assert_eq!(
            ["12", "-3", "0x1F", "x", ""].map(parse_number),
            [Some(12), Some(-3), Some(31), None, None]
        );
    }

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
