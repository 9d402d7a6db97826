use algos_nostd::pixel::yuv422::{Matrix, Range};
use image::codecs::jpeg::JpegEncoder;
use v4l2_capture::FourCc;

use super::*;
use crate::capture::device::YuvMeaning;
use crate::scene::Scene;

fn format(code: &str, (width, height): (u32, u32), strides: &[u32]) -> FrameFormat {
    FrameFormat {
        code: FourCc::parse(code).unwrap(),
        width,
        height,
        strides: strides.to_vec(),
        yuv: YuvMeaning { matrix: Matrix::Bt601, range: Range::Full, whole_hue: false },
        rate: None,
    }
}

fn picture(format: &FrameFormat, planes: &[&[u8]]) -> RgbImage {
    Converter::new(format).picture(planes).unwrap().clone()
}

/// A pixel of each code, by hand from the kernel's documentation: red 0xC6, green 0x82, blue 0x21 or nearly so.
#[test]
#[allow(clippy::unusual_byte_groupings, reason = "bits are grouped by colour")]
fn words_are_read_as_documented() {
    let cases: &[(&str, &[u8], [u8; 3])] = &[
        ("RGB3", &[0xC6, 0x82, 0x21], [0xC6, 0x82, 0x21]),
        ("BGR3", &[0x21, 0x82, 0xC6], [0xC6, 0x82, 0x21]),
        ("RGB4", &[9, 0xC6, 0x82, 0x21], [0xC6, 0x82, 0x21]),
        ("BGR4", &[0x21, 0x82, 0xC6, 9], [0xC6, 0x82, 0x21]),
        ("RX24", &[9, 0x21, 0x82, 0xC6], [0xC6, 0x82, 0x21]),
        ("XB24", &[0xC6, 0x82, 0x21, 9], [0xC6, 0x82, 0x21]),
        // rrrrrggg gggbbbbb
        ("RGBR", &[0b11000_100, 0b000_00100], [0xC6, 0x82, 0x21]),
        ("RGBP", &[0b000_00100, 0b11000_100], [0xC6, 0x82, 0x21]),
        // xrrrrrgg gggbbbbb
        ("XR15-BE", &[0b1_11000_10, 0b000_00100], [0xC5, 0x84, 0x21]),
        ("XR15", &[0b000_00100, 0b1_11000_10], [0xC5, 0x84, 0x21]),
        ("RX15", &[0b00_00100_1, 0b11000_100], [0xC5, 0x84, 0x21]),
        ("XB15", &[0b000_11000, 0b1_00100_10], [0xC5, 0x84, 0x21]),
        ("BX15", &[0b00_11000_1, 0b00100_100], [0xC5, 0x84, 0x21]),
        ("XR12", &[0x82, 0xFC], [0xCC, 0x88, 0x22]),
        ("RX12", &[0x2F, 0xC8], [0xCC, 0x88, 0x22]),
        ("XB12", &[0x8C, 0xF2], [0xCC, 0x88, 0x22]),
        ("GA12", &[0xCF, 0x28], [0xCC, 0x88, 0x22]),
        // rrrgggbb
        ("RGB1", &[0b110_100_01], [219, 146, 85]),
        // bbbbbbgg ggggrrrr rr------ --------
        ("BGRH", &[0b001000_10, 0b0000_1100, 0b01_000000, 0], [198, 130, 32]),
        ("HSV3", &[0, 255, 200], [200, 0, 0]),
        ("HSV4", &[9, 60, 255, 255], [0, 255, 0]),
        ("HSV3", &[120, 128, 200], [100, 100, 200]),
        ("HSV3", &[77, 0, 93], [93, 93, 93]),
        ("GREY", &[0x82], [0x82; 3]),
        ("Y10", &[0b0000_1011, 0b10], [0x82; 3]),
        ("Y12", &[0x21, 0x08], [0x82; 3]),
        ("Y16", &[0xFF, 0x82], [0x82; 3]),
        ("Y16-BE", &[0x82, 0xFF], [0x82; 3]),
        ("Y10", &[0xFF, 0xFF], [0xFF; 3]),
        ("AYUV", &[9, 0x82, 128, 128], [0x82; 3]),
        ("VUYA", &[128, 128, 0x82, 9], [0x82; 3]),
        ("YUVX", &[0x82, 128, 128, 9], [0x82; 3]),
        // Pure red in full range is 76, 85, 255.
        ("YUVX", &[76, 85, 255, 9], [254, 0, 0]),
        ("XYUV", &[9, 76, 85, 255], [254, 0, 0]),
        ("VUYX", &[255, 85, 76, 9], [254, 0, 0]),
    ];
    for &(code, bytes, expected) in cases {
        let got = picture(&format(code, (1, 1), &[]), &[bytes]).get_pixel(0, 0).0;
        let near = got.iter().zip(expected).all(|(got, expected)| got.abs_diff(expected) <= 1);
        assert!(near, "{code} {bytes:02X?}: {got:?}, not {expected:?}");
    }
}

#[test]
fn all_orders_of_yuv_are_one_picture() {
    // Two pixels: red and a dark one that share chroma.
    let (y0, y1, cb, cr) = (76, 20, 85, 255);
    let expected = picture(&format("YUYV", (2, 1), &[]), &[&[y0, cb, y1, cr]]);
    assert!(expected.get_pixel(0, 0).0[0] > 250 && expected.get_pixel(1, 0).0[0] > 190);
    for (code, bytes) in [
        ("UYVY", [cb, y0, cr, y1]),
        ("YVYU", [y0, cr, y1, cb]),
        ("VYUY", [cr, y0, cb, y1]),
        ("NV16", [y0, y1, cb, cr]),
        ("NV61", [y0, y1, cr, cb]),
        ("422P", [y0, y1, cb, cr]),
        ("NV12", [y0, y1, cb, cr]),
        ("NV21", [y0, y1, cr, cb]),
        ("YU12", [y0, y1, cb, cr]),
        ("YV12", [y0, y1, cr, cb]),
    ] {
        assert_eq!(picture(&format(code, (2, 1), &[2]), &[&bytes]), expected, "{code}");
    }
    assert_eq!(picture(&format("NM12", (2, 1), &[2, 2]), &[&[y0, y1], &[cb, cr]]), expected);
    assert_eq!(picture(&format("YM21", (2, 1), &[2, 1, 1]), &[&[y0, y1], &[cr], &[cb]]), expected);
    assert_eq!(picture(&format("YM24", (2, 1), &[2, 2, 2]), &[&[y0, y1], &[cb, cb], &[cr, cr]]), expected);
    // Some stacks hand out an empty third one.
    assert_eq!(picture(&format("NV12", (2, 1), &[2]), &[&[y0, y1], &[cb, cr], &[]]), expected);
}

/// The same picture comes out whatever stands between the lines, also of an odd size.
#[test]
fn strides_are_skipped() {
    let (width, height) = (5u32, 3u32);
    for code in Layout::codes().map(|code| code.to_string()) {
        let layout = Layout::of(FourCc::parse(&code).unwrap()).unwrap();
        if layout == Layout::Jpeg {
            continue;
        }
        let line = layout.line_bytes(width as usize);
        let planes: Vec<(usize, usize)> = match layout {
            Layout::Planar(planar) => {
                let chroma = planar.chroma_size((width as usize, height as usize));
                std::iter::once((line, height as usize))
                    .chain(std::iter::repeat_n(chroma, if planar.pairs { 1 } else { 2 }))
                    .collect()
            }
            _ => vec![(line, height as usize)],
        };
        let made = |gap: usize| {
            let bytes: Vec<Vec<u8>> = planes
                .iter()
                .map(|&(line, lines)| {
                    let line_of = |y: usize| {
                        (0..line)
                            .map(move |x| (x * 37 + y * 101) as u8)
                            .chain(std::iter::repeat_n(0xEE, if y + 1 < lines { gap } else { 0 }))
                    };
                    (0..lines).flat_map(line_of).collect()
                })
                .collect();
            let strides: Vec<u32> = planes.iter().map(|(line, _)| (line + gap) as u32).collect();
            let format = format(&code, (width, height), &strides);
            let slices: Vec<&[u8]> = bytes.iter().map(Vec::as_slice).collect();
            let mut converter = Converter::new(&format);
            let picture = converter.picture(&slices).unwrap().clone();
            let mut short = slices.clone();
            let last = short.len() - 1;
            short[last] = &short[last][..short[last].len() - 1];
            assert!(matches!(converter.check(&short), Err(FrameFault::Short { .. })), "{code}");
            (picture, converter.as_bus(&slices).map(Cow::into_owned))
        };
        let (tight, bus) = made(0);
        assert_eq!(made(3), (tight, bus.clone()), "{code}");
        assert_eq!(bus.is_some(), layout.as_bus().is_some(), "{code}");
    }
}

#[test]
fn planes_that_follow_one_another_keep_their_strides() {
    // 2 × 2 pixels, luma in lines of 8 bytes, chroma below in lines of 4.
    let mut bytes = [0xEE; 8 * 2 + 4 * 2];
    (bytes[0], bytes[1], bytes[8], bytes[9]) = (10, 20, 30, 40);
    (bytes[16], bytes[20]) = (128, 128);
    let got = picture(&format("YU12", (2, 2), &[8]), &[&bytes[..21]]);
    let levels: Vec<u8> = got.pixels().map(|pixel| pixel.0[1]).collect();
    assert_eq!(levels, [10, 20, 30, 40]);
    let fault = Converter::new(&format("YU12", (2, 2), &[8])).check(&[&bytes[..20]]);
    assert_eq!(fault, Err(FrameFault::Short { needed: 21, got: 20 }));
}

#[test]
fn mosaics_of_all_depths_are_one_picture() {
    let mosaic: Vec<u8> = (0..8 * 4).map(|index| (index * 71) as u8).collect();
    let expected = picture(&format("GBRG", (8, 4), &[8]), &[&mosaic]);
    let words = |bits: u32| -> Vec<u8> {
        mosaic.iter().flat_map(|&sample| (u16::from(sample) << (bits - 8) | 1).to_le_bytes()).collect()
    };
    for (code, bits) in [("GB10", 10), ("GB12", 12), ("GB14", 14), ("GB16", 16)] {
        assert_eq!(picture(&format(code, (8, 4), &[16]), &[&words(bits)]), expected, "{code}");
    }
    let ten: Vec<u8> = mosaic.chunks(4).flat_map(|four| [four, &[0x1B]].concat()).collect();
    assert_eq!(picture(&format("pGAA", (8, 4), &[10]), &[&ten]), expected);
    let twelve: Vec<u8> = mosaic.chunks(2).flat_map(|two| [two, &[0x5A]].concat()).collect();
    assert_eq!(picture(&format("pGCC", (8, 4), &[12]), &[&twelve]), expected);
}

fn jpeg_of(picture: &RgbImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, 95).encode_image(picture).unwrap();
    bytes
}

/// Cuts the segments with Huffman tables out, as webcams do.
fn without_tables(jpeg: &[u8]) -> Vec<u8> {
    let (mut out, mut at) = (jpeg[..2].to_vec(), 2);
    while jpeg[at + 1] != 0xDA {
        let end = at + 2 + usize::from(u16::from_be_bytes([jpeg[at + 2], jpeg[at + 3]]));
        if jpeg[at + 1] != 0xC4 {
            out.extend(&jpeg[at..end]);
        }
        at = end;
    }
    out.extend(&jpeg[at..]);
    out
}

#[test]
fn jpeg_frames_are_read_with_and_without_tables_and_padding() {
    let scene = Scene::Bars.render(0, 64, 32);
    let whole = jpeg_of(&scene);
    let format = format("MJPG", (64, 32), &[0]);
    let expected = picture(&format, &[&whole]);
    assert!(
        expected.iter().zip(scene.iter()).filter(|(a, b)| a.abs_diff(**b) < 40).count()
            > 64 * 32 * 3 * 9 / 10
    );
    let bare = without_tables(&whole);
    assert!(bare.len() < whole.len() - 300, "the tables are gone");
    assert_eq!(picture(&format, &[&bare]), expected);
    assert_eq!(picture(&format, &[&[&bare[..], &[0; 100]].concat()]), expected);
}

#[test]
fn broken_jpeg_frames_are_faults_and_the_next_is_good() {
    let whole = jpeg_of(&Scene::Bars.render(0, 64, 32));
    let mut converter = Converter::new(&format("MJPG", (64, 32), &[0]));
    for length in (0..whole.len() / 2).step_by(7) {
        // Decoders may make something of a frame whose end is missing, not of one whose head is.
        let _ = converter.picture(&[&whole[..length]]);
    }
    assert!(matches!(converter.picture(&[&whole[..100]]), Err(FrameFault::Jpeg(_))));
    assert!(matches!(converter.picture(&[&[]]), Err(FrameFault::Short { .. })));
    assert!(converter.picture(&[&whole]).is_ok());
}

#[test]
fn other_formats_are_raw_bytes_only() {
    let mut converter = Converter::new(&format("H264", (640, 480), &[0]));
    assert_eq!(converter.check(&[&[1, 2, 3]]), Ok(()));
    assert!(
        converter.picture(&[&[1]]).unwrap_err().to_string().contains("H264 is captured as raw bytes only")
    );
    assert!(converter.as_bus(&[&[1]]).is_none());
}

/// Hue in 256 steps and in 180 meet where both are whole.
#[test]
fn hue_turns_once() {
    for (eighth, expected) in
        [[255, 0, 0], [255, 191, 0], [128, 255, 0], [0, 255, 64]].into_iter().enumerate()
    {
        let got = hsv((eighth * 32) as u8, 255, 255, true);
        let near = [got.r, got.g, got.b].iter().zip(expected).all(|(a, b): (&u8, u8)| a.abs_diff(b) <= 2);
        assert!(near, "{eighth}: {got:?}");
    }
    assert_eq!(hsv(90, 255, 255, false), hsv(128, 255, 255, true));
}
