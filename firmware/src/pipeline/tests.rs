//! The pipeline makes what its stages make one by one over a whole frame, and takes the memory that it says.

use algos_nostd::edges::gradient::Sobel;
use algos_nostd::edges::measure::{L1, Saturated};
use algos_nostd::edges::{
    BitMapMut, CannyConfig, CannySmoothing, GradientFilter, canny, canny_memory, words_a_map,
};
use algos_nostd::filter::{Gaussian3, Gaussian3Filter, Neighbourhood};
use algos_nostd::image::{Image, ImageMut};
use algos_nostd::lines::run;
use algos_nostd::pixel::{ByteOrder, gray8, rgb565, rgb888};
use algos_nostd::quantize::{ColorIndex, InverseMap, Nearest, Probe};

use super::*;

const WIDTH: usize = 70;
const HEIGHT: usize = 40;
const THRESHOLDS: Thresholds = Thresholds { low: 50, high: 150, norm: Norm::L2 };

/// Discs on a slope.
fn picture() -> Vec<Rgb> {
    let pixel = |index: usize| {
        let (x, y) = ((index % WIDTH) as i32, (index / WIDTH) as i32);
        let disc = (x - 20).pow(2) + (y - 15).pow(2) < 100 || (x - 50).pow(2) + (y - 25).pow(2) < 144;
        let level = if disc { 190 } else { 60 + x };
        Rgb { r: level as u8, g: (level - 20) as u8, b: (level / 2 + y) as u8 }
    };
    (0..WIDTH * HEIGHT).map(pixel).collect()
}

/// What comes out for a frame of these bytes, as text that can be compared.
#[derive(Debug, Default, PartialEq, Eq)]
struct Out {
    color: Vec<Rgb>,
    bytes: Vec<u8>,
    words: Vec<u32>,
}

fn frame(pipeline: &mut Pipeline<'_>, bytes: &[u8], line: usize) -> Out {
    let mut out = Out::default();
    let mut sink = |product: Product<'_>| match product {
        Product::Color(line) => out.color.extend_from_slice(line),
        Product::Gray(line) | Product::Indices(line) => out.bytes.extend_from_slice(line),
        Product::Edges(line) => out.words.extend_from_slice(line),
    };
    for line in bytes.chunks_exact(line) {
        pipeline.push(line, &mut sink).unwrap();
    }
    pipeline.finish(&mut sink);
    out
}

/// Runs `settings` in exactly the memory that they say, twice: a second frame is as the first.
fn twice(settings: Settings<'_>, bytes: &[u8], line: usize) -> Out {
    let mut memory = vec![u32::MAX; settings.memory()];
    let mut pipeline = Pipeline::new(settings, &mut memory).unwrap();
    let first = frame(&mut pipeline, bytes, line);
    assert_eq!(frame(&mut pipeline, bytes, line), first);
    first
}

fn gray() -> Vec<u8> {
    let mut gray = vec![0; WIDTH * HEIGHT];
    gray8::encode_line(&picture(), &mut gray).unwrap();
    gray
}

fn smooth() -> Vec<u8> {
    let (gray, mut made) = (gray(), vec![0; WIDTH * HEIGHT]);
    let mut memory = vec![0; Gaussian3Filter::memory(WIDTH)];
    let mut filter = Neighbourhood::new(Gaussian3, WIDTH, &mut memory).unwrap();
    let out = &mut ImageMut::new(&mut made, WIDTH, HEIGHT).unwrap();
    run(&mut filter, Image::new(&gray, WIDTH, HEIGHT).unwrap(), out).unwrap();
    made
}

#[test]
fn gray_and_smoothed_gray() {
    let pixels = picture();
    let bytes = rgb888::as_bytes(&pixels);
    for (smoothing, expected) in [(Smoothing::None, gray()), (Smoothing::Gaussian3, smooth())] {
        let settings = Settings { output: Output::Gray(smoothing), ..Settings::new(WIDTH, HEIGHT) };
        assert_eq!(twice(settings, bytes, 3 * WIDTH).bytes, expected, "{smoothing:?}");
    }
}

#[test]
fn sobel_of_the_smoothed_gray() {
    let (pixels, smooth) = (picture(), smooth());
    let (mut memory, mut line) =
        (vec![0; GradientFilter::<Sobel, Saturated<L1>>::memory(WIDTH)], vec![0; WIDTH]);
    let mut expected = vec![0; WIDTH * HEIGHT];
    let mut filter = GradientFilter::<Sobel, Saturated<L1>>::new(WIDTH, &mut memory, &mut line).unwrap();
    let out = &mut ImageMut::new(&mut expected, WIDTH, HEIGHT).unwrap();
    run(&mut filter, Image::new(&smooth, WIDTH, HEIGHT).unwrap(), out).unwrap();
    let output = Output::Sobel(Smoothing::Gaussian3);
    let settings = Settings { output, ..Settings::new(WIDTH, HEIGHT) };
    assert_eq!(twice(settings, rgb888::as_bytes(&pixels), 3 * WIDTH).bytes, expected);
}

#[test]
fn canny_is_canny_of_the_whole_frame() {
    let (pixels, gray) = (picture(), gray());
    let pairs = [
        (Smoothing::None, CannySmoothing::None),
        (Smoothing::Gaussian3, CannySmoothing::Gaussian3),
        (Smoothing::Gaussian5, CannySmoothing::Gaussian5),
    ];
    for (ours, theirs) in pairs {
        let mut expected = vec![0; words_a_map(WIDTH, HEIGHT)];
        let mut memory = vec![0; canny_memory(WIDTH, HEIGHT, theirs)];
        let config = CannyConfig { smoothing: theirs, thresholds: THRESHOLDS };
        let map = &mut BitMapMut::new(&mut expected, WIDTH, HEIGHT).unwrap();
        canny(Image::new(&gray, WIDTH, HEIGHT).unwrap(), &config, &mut memory, map).unwrap();
        assert!(map.as_map().count() > 50, "the discs have edges");
        let output = Output::Canny(ours, THRESHOLDS);
        let settings = Settings { output, ..Settings::new(WIDTH, HEIGHT) };
        assert_eq!(twice(settings, rgb888::as_bytes(&pixels), 3 * WIDTH).words, expected, "{ours:?}");
    }
}

#[test]
fn indices_of_a_palette() {
    let pixels = picture();
    let colors = [[0, 0, 0], [80, 60, 40], [190, 170, 110], [255, 255, 255]].map(|[r, g, b]| Rgb { r, g, b });
    let (mut probes, mut cells) = ([Probe::EMPTY; 4], vec![0; InverseMap::<4>::cells()]);
    let mut map = InverseMap::<4>::new(Nearest::new(&colors, &mut probes).unwrap(), &mut cells).unwrap();
    let expected: Vec<u8> = pixels.iter().map(|&pixel| map.index(pixel)).collect();
    let mut probes = [Probe::EMPTY; 4];
    let output = Output::Palette(Palette { colors: &colors, probes: &mut probes });
    let settings = Settings { output, ..Settings::new(WIDTH, HEIGHT) };
    assert_eq!(twice(settings, rgb888::as_bytes(&pixels), 3 * WIDTH).bytes, expected);
}

#[test]
fn another_format() {
    let pixels = picture();
    let mut bytes = vec![0; 2 * WIDTH * HEIGHT];
    rgb565::encode_line(&pixels, &mut bytes, ByteOrder::BigEndian).unwrap();
    let mut expected = pixels;
    rgb565::decode_line(&bytes, &mut expected, ByteOrder::BigEndian).unwrap();
    let settings = Settings { format: Format::Rgb565Be, ..Settings::new(WIDTH, HEIGHT) };
    assert_eq!(twice(settings, &bytes, 2 * WIDTH).color, expected);
}

#[test]
fn a_tint_goes_after_some_frames() {
    let tinted: Vec<Rgb> = picture().iter().map(|&p| Rgb { r: p.g, g: p.g, b: p.g / 2 }).collect();
    let settings = Settings { balance: Balance::GrayWorld, ..Settings::new(WIDTH, HEIGHT) };
    let mut memory = vec![0; settings.memory()];
    let mut pipeline = Pipeline::new(settings, &mut memory).unwrap();
    let first = frame(&mut pipeline, rgb888::as_bytes(&tinted), 3 * WIDTH);
    assert_eq!(first.color, tinted, "nothing is known before the first frame has ended");
    let last = (0..20).map(|_| frame(&mut pipeline, rgb888::as_bytes(&tinted), 3 * WIDTH)).last().unwrap();
    let sum = |channel: fn(&Rgb) -> u8| last.color.iter().map(|pixel| u64::from(channel(pixel))).sum::<u64>();
    let (red, green, blue) = (sum(|p| p.r), sum(|p| p.g), sum(|p| p.b));
    assert!(red.abs_diff(blue) * 50 < green && red.abs_diff(green) * 50 < green, "{red} {green} {blue}");
}

#[test]
fn a_short_frame_ends_in_empty_lines_and_a_long_one_is_cut() {
    let pixels = picture();
    let bytes = rgb888::as_bytes(&pixels);
    let output = || Output::Canny(Smoothing::None, THRESHOLDS);
    let mut memory = vec![0; Settings::canny_memory(WIDTH, HEIGHT)];
    let settings = Settings { output: output(), ..Settings::new(WIDTH, HEIGHT) };
    let mut pipeline = Pipeline::new(settings, &mut memory).unwrap();
    let whole = frame(&mut pipeline, bytes, 3 * WIDTH);
    let short = frame(&mut pipeline, &bytes[..30 * WIDTH], 3 * WIDTH);
    assert!(short.words[10 * 3..].iter().all(|&word| word == 0));
    let twice = [bytes, bytes].concat();
    assert_eq!(frame(&mut pipeline, &twice, 3 * WIDTH).words.len(), whole.words.len());
    assert_eq!(frame(&mut pipeline, bytes, 3 * WIDTH), whole);
}

#[test]
fn refusals_say_what_was_expected() {
    let short = Pipeline::new(Settings::new(WIDTH, HEIGHT), &mut [0; 4]).unwrap_err();
    assert_eq!(short, Error::BufferLength { name: "memory", expected: 53, got: 4 });
    let raw = Settings { format: Format::Raw8, ..Settings::new(WIDTH, HEIGHT) };
    assert!(matches!(Pipeline::new(raw, &mut [0; 99]), Err(Error::Parameter { name: "format", .. })));
    assert!(matches!(Pipeline::new(Settings::new(0, 1), &mut []), Err(Error::ZeroSize { .. })));
    let mut memory = [0; 99];
    let mut pipeline = Pipeline::new(Settings::new(WIDTH, HEIGHT), &mut memory).unwrap();
    assert!(pipeline.push(&[0; 7], &mut |_| {}).is_err());
}

/// The bars: beside the line ring a whole VGA frame through Sobel in 32 KiB, and through Canny in 128 KiB.
#[test]
fn vga_fits() {
    let ring = 4 * 640 * 3;
    let (sobel, canny) = (Settings::sobel_memory(640) * 4, Settings::canny_memory(640, 480) * 4);
    assert_eq!((sobel, canny), (9_024, 99_448));
    assert!(ring + sobel <= 32 << 10 && ring + canny <= 128 << 10);
}
