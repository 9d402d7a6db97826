//! Every pixel format that vivid offers: the bytes are those that `v4l2-ctl` gets, the picture is the colour bars.

use std::path::Path;
use std::time::Duration;

use camif_vm::bars;
use host_sim::capture::v4l2::{V4l2, open};
use host_sim::capture::{CaptureDevice as _, Converter, Layout, Samples, Settings, Space};
use image::RgbImage;

use crate::{ONE, PLANES, cameras, v4l2_ctl};

const SIZE: (u32, u32) = (320, 180);

/// How far a picture may be from the bars, and the pixels around their borders that are not looked at.
fn bound(code: &str, layout: Layout) -> (u8, u32) {
    match (code, layout) {
        // A step of samples of 4, 5 and 6 bits.
        ("Y444", _) => (17, 0),
        ("YUVO" | "YUVP", _) => (8, 0),
        // The neighbours of a colour that it is interpolated from.
        (_, Layout::Bayer { .. }) => (0, 2),
        (_, Layout::Packed(packed)) if packed.space == Space::Yuv => (3, 0),
        // A step of hue.
        (_, Layout::Packed(packed)) if packed.space == Space::Hsv => (10, 0),
        (_, Layout::Planar(_) | Layout::Yuv422(_)) | ("YUYV" | "UYVY", _) => (3, 0),
        (_, Layout::DeepGray { .. }) | ("GREY", _) => (2, 0),
        _ => (0, 0),
    }
}

fn expected(code: &str, layout: Layout) -> RgbImage {
    match layout {
        Layout::DeepGray { .. } => bars::luma(SIZE.0, SIZE.1, 255),
        _ if code == "GREY" => bars::luma(SIZE.0, SIZE.1, 255),
        _ => bars::picture(SIZE.0, SIZE.1, 255),
    }
}

/// Sets a format of hue and how hue is meant: 0 by two degrees, 1 in 256 steps.
///
/// Setting a format of red, green and blue makes vivid forget what its control says, and tell a code that is none of V4L2's; a change
/// of the control mends it.
fn set_hue(device: &str, code: &str, encoding: u8) {
    let format = format!("--set-fmt-video=width={},height={},pixelformat={code}", SIZE.0, SIZE.1);
    let control = |value: u8| v4l2_ctl(device, &[&format!("--set-ctrl=hsv_encoding={value}")]);
    v4l2_ctl(device, &[&format]);
    control(1 - encoding);
    control(encoding);
}

/// Hue in steps of two degrees and in 256 steps a turn, as vivid's control has it.
#[test]
#[ignore = "tests/vm/run"]
fn hue_is_read_as_the_device_says() {
    cameras();
    // A step of hue is 8.5 or 6 of 255, and vivid's whole turn has 255 steps.
    for (encoding, whole, bound) in [(0, false, 9), (1, true, 10)] {
        for code in ["HSV3", "HSV4"] {
            set_hue(ONE, code, encoding);
            let code = v4l2_capture::FourCc::parse(code);
            let settings = Settings { size: Some(SIZE), code, buffers: 3, ..Settings::default() };
            let mut device = V4l2::start(Path::new(ONE), &settings).unwrap();
            let format = device.opened().format.clone();
            let frame = device.next(Duration::from_secs(5)).unwrap().expect("a frame in five seconds");
            let mut converter = Converter::new(&format);
            let picture = converter.picture(&frame.planes()).unwrap();
            let (difference, place) = bars::difference(picture, &bars::picture(SIZE.0, SIZE.1, 255), 0);
            assert_eq!(format.yuv.whole_hue, whole);
            assert!(difference <= bound, "{code:?}: {difference} at {place:?}");
        }
    }
}

#[test]
#[ignore = "tests/vm/run"]
fn every_format_shows_the_bars() {
    cameras();
    let (mut pictures, mut wrong) = (0, Vec::new());
    for path in [ONE, PLANES].map(Path::new) {
        for offered in open(path).unwrap().formats().unwrap() {
            let code = offered.code.to_string();
            let Some(layout) = Layout::of(offered.code) else {
                println!("{} {code}: raw bytes only", path.display());
                continue;
            };
            if matches!(layout, Layout::Packed(packed) if packed.space == Space::Hsv) {
                set_hue(path.to_str().unwrap(), &code, 0);
            }
            let settings =
                Settings { size: Some(SIZE), code: Some(offered.code), buffers: 3, ..Settings::default() };
            let mut device = V4l2::start(path, &settings).unwrap();
            let format = device.opened().format.clone();
            assert_eq!((format.code, format.width, format.height), (offered.code, SIZE.0, SIZE.1));
            let frame = device.next(Duration::from_secs(5)).unwrap().expect("a frame in five seconds");
            let mut converter = Converter::new(&format);
            let picture = converter.picture(&frame.planes()).unwrap();
            let (bound, margin) = bound(&code, layout);
            let (difference, place) = bars::difference(picture, &expected(&code, layout), margin);
            println!("{} {code}: differs by {difference}, at most {bound}", path.display());
            if difference > bound {
                wrong.push(format!(
                    "{code} differs by {difference} at {place:?}: {:?} {:?}",
                    format.yuv,
                    picture.get_pixel(place.0, place.1)
                ));
            }
            pictures += 1;
            let name = path.file_name().unwrap().to_str().unwrap();
            host_sim::picture::write_png(Path::new(&format!("/out/{name}-{code}.png")), picture).unwrap();
            let ours = frame.planes().concat();
            drop(frame);
            drop(device);
            // The same bytes as the usual tool gets.
            let file = tempfile::NamedTempFile::new().unwrap();
            // It wants all four characters.
            let (letters, end) = code.strip_suffix("-BE").map_or((&code[..], ""), |letters| (letters, "-BE"));
            let ask =
                format!("--set-fmt-video=width={},height={},pixelformat={letters:4}{end}", SIZE.0, SIZE.1);
            let into = format!("--stream-to={}", file.path().display());
            v4l2_ctl(path.to_str().unwrap(), &[&ask, "--stream-mmap=3", "--stream-count=1", &into]);
            if std::fs::read(file.path()).unwrap() != ours {
                wrong.push(format!("{code}: v4l2-ctl gets other bytes"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(pictures > 100, "only {pictures} formats");
    // Bayer of each depth and order, which vivid has, is among them.
    assert!(matches!(
        Layout::of(v4l2_capture::FourCc::new(b"RG12")),
        Some(Layout::Bayer { samples: Samples::Words(12), .. })
    ));
}
