//! From the sensor's formats to pixels and back.

use algos_nostd::image::{Error, Rgb};
use algos_nostd::pixel::bayer::{BayerOrder, mosaic_line, mosaic_line_deep};
use algos_nostd::pixel::black_level::BlackLevel;
use algos_nostd::pixel::format::{Format, Meaning};
use algos_nostd::pixel::yuv422::{self, Coefficients, Matrix, Packing, Range};
use algos_nostd::pixel::{BitDepth, ByteOrder, gray8, raw, rgb565, rgb888};

use crate::report::{Clock, Done, Exercise, Unit::Pixel};
use crate::space::{PIXELS, WIDTH, Workspace};

pub(crate) static EXERCISES: &[Exercise] = &[
    Exercise { name: "gray", unit: Pixel, run: gray },
    Exercise { name: "gray to rgb", unit: Pixel, run: from_gray },
    Exercise { name: "rgb888 encode", unit: Pixel, run: encode_rgb888 },
    Exercise { name: "rgb888 decode", unit: Pixel, run: decode_rgb888 },
    Exercise { name: "rgb565 encode", unit: Pixel, run: encode_rgb565 },
    Exercise { name: "rgb565 decode", unit: Pixel, run: decode_rgb565 },
    Exercise { name: "yuv422 encode", unit: Pixel, run: encode_yuv },
    Exercise { name: "yuv422 decode", unit: Pixel, run: decode_yuv },
    Exercise { name: "yuv422 luma", unit: Pixel, run: luma },
    Exercise { name: "bayer mosaic 8 bits", unit: Pixel, run: mosaic },
    Exercise { name: "bayer mosaic 12 bits", unit: Pixel, run: mosaic_deep },
    Exercise { name: "black level", unit: Pixel, run: black_level },
    Exercise { name: "raw 16 bits encode", unit: Pixel, run: encode16 },
    Exercise { name: "raw 16 bits decode", unit: Pixel, run: decode16 },
    Exercise { name: "raw 10 bits pack", unit: Pixel, run: pack10 },
    Exercise { name: "raw 10 bits unpack", unit: Pixel, run: unpack10 },
    Exercise { name: "raw 12 bits pack", unit: Pixel, run: pack12 },
    Exercise { name: "raw 12 bits unpack", unit: Pixel, run: unpack12 },
    Exercise { name: "raw to 8 bits", unit: Pixel, run: reduce },
];

/// Each line of the picture into bytes, `bytes` a pixel.
fn encode(
    space: &mut Workspace,
    clock: &mut dyn Clock,
    bytes: usize,
    mut line: impl FnMut(usize, &[Rgb], &mut [u8]) -> Result<(), Error>,
) -> Result<Done, Error> {
    let out = &mut space.bytes[..PIXELS * bytes];
    clock.start();
    let lines = space.picture.chunks_exact(WIDTH).zip(out.chunks_exact_mut(WIDTH * bytes));
    for (y, (pixels, out)) in lines.enumerate() {
        line(y, pixels, out)?;
    }
    clock.stop();
    Ok(Done::new(PIXELS, out))
}

/// Each line of `space.bytes` into pixels.
fn decode(
    space: &mut Workspace,
    clock: &mut dyn Clock,
    bytes: usize,
    mut line: impl FnMut(&[u8], &mut [Rgb]) -> Result<(), Error>,
) -> Result<Done, Error> {
    clock.start();
    let lines = space.bytes.chunks_exact(WIDTH * bytes).zip(space.pixels.chunks_exact_mut(WIDTH));
    for (bytes, pixels) in lines {
        line(bytes, pixels)?;
    }
    clock.stop();
    Ok(Done::new(PIXELS, rgb888::as_bytes(&space.pixels)))
}

fn gray(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    encode(space, clock, 1, |_, pixels, out| gray8::encode_line(pixels, out))
}

fn from_gray(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    encode(space, &mut (), 1, |_, pixels, out| gray8::encode_line(pixels, out))?;
    decode(space, clock, 1, gray8::decode_line)
}

fn encode_rgb888(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    encode(space, clock, 3, |_, pixels, out| rgb888::encode_line(pixels, out))
}

fn decode_rgb888(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    encode_rgb888(space, &mut ())?;
    decode(space, clock, 3, rgb888::decode_line)
}

fn encode_rgb565(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    encode(space, clock, 2, |_, pixels, out| rgb565::encode_line(pixels, out, ByteOrder::BigEndian))
}

fn decode_rgb565(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    encode_rgb565(space, &mut ())?;
    decode(space, clock, 2, |bytes, pixels| rgb565::decode_line(bytes, pixels, ByteOrder::BigEndian))
}

const YUV: Coefficients = Coefficients::new(Matrix::Bt601, Range::Limited);

fn encode_yuv(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    encode(space, clock, 2, |_, pixels, out| yuv422::encode_line(pixels, out, Packing::Yuyv, &YUV))
}

fn decode_yuv(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    encode_yuv(space, &mut ())?;
    let meaning = Meaning { yuv: YUV, ..Meaning::default() };
    // By its format, as a capture does.
    decode(space, clock, 2, |bytes, pixels| Format::Yuyv.decode_line(bytes, pixels, &meaning))
}

fn luma(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    encode_yuv(space, &mut ())?;
    let (from, to) = space.bytes.split_at_mut(2 * PIXELS);
    clock.start();
    for (bytes, luma) in from.chunks_exact(2 * WIDTH).zip(to.chunks_exact_mut(WIDTH)) {
        yuv422::luma_line(bytes, luma, Packing::Yuyv)?;
    }
    clock.stop();
    Ok(Done::new(PIXELS, to))
}

fn mosaic(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    encode(space, clock, 1, |y, pixels, out| mosaic_line(pixels, out, BayerOrder::Rggb, y))
}

/// Samples of these bits in `space.halves`.
pub(crate) fn samples(space: &mut Workspace, clock: &mut dyn Clock, depth: BitDepth) -> Result<(), Error> {
    clock.start();
    let lines = space.picture.chunks_exact(WIDTH).zip(space.halves.chunks_exact_mut(WIDTH));
    for (y, (pixels, samples)) in lines.enumerate() {
        mosaic_line_deep(pixels, samples, BayerOrder::Rggb, y, depth)?;
    }
    clock.stop();
    Ok(())
}

/// Checks `space.halves`.
fn halves(space: &Workspace) -> Done {
    Done::of(PIXELS, |results| space.halves.iter().for_each(|half| results.bytes(&half.to_le_bytes())))
}

fn mosaic_deep(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    samples(space, clock, BitDepth::Bits12)?;
    Ok(halves(space))
}

fn black_level(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    samples(space, &mut (), BitDepth::Bits12)?;
    let level = BlackLevel::new([64, 60, 68, 72], BitDepth::Bits12)?;
    clock.start();
    for (y, samples) in space.halves.chunks_exact_mut(WIDTH).enumerate() {
        level.apply_line(samples, y);
    }
    clock.stop();
    Ok(halves(space))
}

type Pack = fn(&[u16], &mut [u8]) -> Result<(), Error>;
type Unpack = fn(&[u8], &mut [u16]) -> Result<(), Error>;

/// Samples of these bits into lines of bytes.
fn pack(
    space: &mut Workspace,
    clock: &mut dyn Clock,
    (depth, line_bytes): (BitDepth, usize),
    line: Pack,
) -> Result<Done, Error> {
    samples(space, &mut (), depth)?;
    let out = &mut space.bytes[..line_bytes * (PIXELS / WIDTH)];
    clock.start();
    for (samples, bytes) in space.halves.chunks_exact(WIDTH).zip(out.chunks_exact_mut(line_bytes)) {
        line(samples, bytes)?;
    }
    clock.stop();
    Ok(Done::new(PIXELS, out))
}

/// Lines of bytes back into samples.
fn unpack(
    space: &mut Workspace,
    clock: &mut dyn Clock,
    line_bytes: usize,
    line: Unpack,
) -> Result<Done, Error> {
    space.halves.fill(0);
    let lines = space.bytes.chunks_exact(line_bytes).zip(space.halves.chunks_exact_mut(WIDTH));
    clock.start();
    for (bytes, samples) in lines {
        line(bytes, samples)?;
    }
    clock.stop();
    Ok(halves(space))
}

const DEEP: (BitDepth, usize) = (BitDepth::Bits12, raw::line_bytes16(WIDTH));
const TEN: (BitDepth, usize) = (BitDepth::Bits10, raw::line_bytes10(WIDTH));
const TWELVE: (BitDepth, usize) = (BitDepth::Bits12, raw::line_bytes12(WIDTH));

fn encode16(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    pack(space, clock, DEEP, |samples, bytes| raw::encode_line16(samples, bytes, ByteOrder::LittleEndian))
}

fn decode16(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    encode16(space, &mut ())?;
    unpack(space, clock, DEEP.1, |bytes, samples| {
        raw::decode_line16(bytes, samples, ByteOrder::LittleEndian, DEEP.0)
    })
}

fn pack10(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    pack(space, clock, TEN, raw::pack_line10)
}

fn unpack10(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    pack10(space, &mut ())?;
    unpack(space, clock, TEN.1, raw::unpack_line10)
}

fn pack12(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    pack(space, clock, TWELVE, raw::pack_line12)
}

fn unpack12(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    pack12(space, &mut ())?;
    unpack(space, clock, TWELVE.1, raw::unpack_line12)
}

fn reduce(space: &mut Workspace, clock: &mut dyn Clock) -> Result<Done, Error> {
    samples(space, &mut (), BitDepth::Bits12)?;
    let out = &mut space.bytes[..PIXELS];
    clock.start();
    for (samples, out) in space.halves.chunks_exact(WIDTH).zip(out.chunks_exact_mut(WIDTH)) {
        raw::reduce_line(samples, out, BitDepth::Bits12)?;
    }
    clock.stop();
    Ok(Done::new(PIXELS, out))
}
