use std::borrow::Cow;
use std::fmt;

use super::capture::Source;
use crate::capture::{CaptureError, Found, FoundSize};

/// What there is on this machine, why some of it can't be asked, and what to check where there is nothing.
fn search() -> (Vec<Found>, Vec<CaptureError>, Vec<&'static str>) {
    let (mut found, mut errors, mut advice) = (Vec::new(), Vec::new(), Vec::new());
    #[cfg(all(target_os = "linux", target_pointer_width = "64"))]
    {
        let (devices, failed) = crate::capture::v4l2::list();
        if devices.is_empty() {
            advice.push(crate::capture::v4l2::ADVICE);
        }
        found.extend(devices);
        errors.extend(failed);
    }
    #[cfg(not(all(target_os = "linux", target_pointer_width = "64")))]
    advice.push("V4L2: a part of Linux, on machines of 64 bits");
    #[cfg(all(target_os = "linux", feature = "libcamera"))]
    match crate::capture::libcamera::list() {
        Ok(cameras) if cameras.is_empty() => advice.push(crate::capture::libcamera::ADVICE),
        Ok(cameras) => found.extend(cameras),
        Err(error) => errors.push(error),
    }
    #[cfg(not(all(target_os = "linux", feature = "libcamera")))]
    advice.push(
        "libcamera: not in this host-sim. Cameras of systems on chip (Raspberry Pi and others) need it: build with `--features libcamera`",
    );
    (found, errors, advice)
}

/// The camera that is taken where none is chosen. One whose pixels come only after a media controller is set up is the last
/// choice: libcamera does that.
pub(super) fn first() -> Option<Source> {
    let found = search().0;
    let ready = found.iter().find(|camera| !camera.media_controlled);
    let first = ready.or(found.first())?;
    Some(match first.interface {
        "libcamera" => Source::Libcamera(first.id.clone()),
        _ => Source::V4l2(first.id.clone().into()),
    })
}

/// Prints every camera.
pub(super) fn list(json: bool) -> anyhow::Result<()> {
    let (found, errors, advice) = search();
    if json {
        let errors: Vec<String> = errors.iter().map(ToString::to_string).collect();
        let list = serde_json::json!({ "devices": found, "errors": errors, "advice": advice });
        println!("{list:#}");
        return Ok(());
    }
    for device in &found {
        print!("{}", Listed(device));
    }
    for error in &errors {
        println!("{error}");
    }
    if found.is_empty() {
        println!("no capture device found");
        advice.iter().for_each(|advice| println!("{advice}"));
    }
    Ok(())
}

/// A name as a shell takes it.
fn quoted(name: &str) -> Cow<'_, str> {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "/._-:@+,=".contains(letter);
    if name.chars().all(plain) { name.into() } else { format!("'{}'", name.replace('\'', r"'\''")).into() }
}

/// Frames a second without zeros at the end.
fn short(rate: f64) -> String {
    let text = format!("{rate:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

struct Listed<'a>(&'a Found);

impl fmt::Display for Listed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(device) = self;
        let id = quoted(&device.id);
        let note = if device.media_controlled { "; needs libcamera, or `media-ctl`" } else { "" };
        writeln!(f, "--{} {id}  {} ({}{note})", device.interface, device.name, device.place)?;
        for (index, input) in device.inputs.iter().enumerate() {
            writeln!(f, "  --input {index}  {input}")?;
        }
        if let Some((least, greatest)) = device.rates {
            writeln!(f, "  --rate {} to {}", short(least), short(greatest))?;
        }
        let mut last: Option<&[FoundSize]> = None;
        for format in &device.formats {
            let raw = if format.picture { "" } else { ", raw bytes only" };
            writeln!(f, "  --format {:7} {}{raw}", format.code, format.name)?;
            // Most devices offer the same sizes in all formats: once is enough.
            if last != Some(&format.sizes) {
                for size in &format.sizes {
                    writeln!(f, "    {}", ListedSize(size))?;
                }
            } else if !format.sizes.is_empty() {
                writeln!(f, "    as above")?;
            }
            last = Some(&format.sizes);
        }
        Ok(())
    }
}

struct ListedSize<'a>(&'a FoundSize);

impl fmt::Display for ListedSize<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(size) = self;
        write!(f, "--size {}x{}", size.width, size.height)?;
        if let Some((width, height)) = size.up_to {
            write!(f, " up to {width}x{height}")?;
        }
        if !size.rates.is_empty() {
            let rates: Vec<String> = size.rates.iter().copied().map(short).collect();
            write!(f, "  --rate {}", rates.join(" "))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_says_how_to_ask_for_what_is_there() {
        let size =
            |width, height, up_to, rates: &[f64]| FoundSize { width, height, up_to, rates: rates.to_vec() };
        let format = |code: &str, picture, sizes: Vec<FoundSize>| crate::capture::FoundFormat {
            code: code.to_owned(),
            name: format!("the format {code}"),
            picture,
            sizes,
        };
        let sizes = vec![size(640, 480, None, &[30.0, 29.97, 7.5]), size(2, 2, Some((64, 64)), &[])];
        let device = Found {
            interface: "v4l2",
            id: "/dev/video0".to_owned(),
            name: "Webcam".to_owned(),
            place: "uvcvideo, usb-1".to_owned(),
            inputs: vec!["Camera".to_owned(), "HDMI".to_owned()],
            media_controlled: false,
            rates: None,
            formats: vec![
                format("YUYV", true, sizes.clone()),
                format("MJPG", true, sizes),
                format("H264", false, Vec::new()),
            ],
        };
        assert_eq!(
            Listed(&device).to_string(),
            "\
--v4l2 /dev/video0  Webcam (uvcvideo, usb-1)
  --input 0  Camera
  --input 1  HDMI
  --format YUYV    the format YUYV
    --size 640x480  --rate 30 29.97 7.5
    --size 2x2 up to 64x64
  --format MJPG    the format MJPG
    as above
  --format H264    the format H264, raw bytes only
"
        );
        let device = Found {
            interface: "libcamera",
            id: r"\_SB_.PCI0".to_owned(),
            name: "imx219".to_owned(),
            place: "libcamera v0.4.0".to_owned(),
            inputs: Vec::new(),
            media_controlled: true,
            rates: Some((0.5, 120.0)),
            formats: vec![format("NV12", true, vec![size(640, 480, None, &[])])],
        };
        assert_eq!(
            Listed(&device).to_string(),
            r"--libcamera '\_SB_.PCI0'  imx219 (libcamera v0.4.0; needs libcamera, or `media-ctl`)
  --rate 0.5 to 120
  --format NV12    the format NV12
    --size 640x480
"
        );
    }
}
