//! A frame into packets, by each encoding: what the serial link costs the processor.

use core::convert::Infallible;

use algos_nostd::image::Error;
use algos_nostd::pixel::rgb888;
use firmware::link::packet::{FrameStart, Meaning};
use firmware::link::{BODY_MAX, Choice, Encoding, Format, Sender, small_table, wire_bytes};

use crate::report::{Clock, Done, Exercise, Results, Unit};
use crate::space::{HEIGHT, WIDTH, Workspace};

pub(crate) static EXERCISES: &[Exercise] = &[
    exercise("link raw rgb888", |s, c| color(s, c, Encoding::Raw)),
    exercise("link run-length rgb888", |s, c| color(s, c, Encoding::RunLength)),
    exercise("link qoi rgb888", |s, c| color(s, c, Encoding::Qoi)),
    exercise("link raw gray8", |s, c| gray(s, c, Encoding::Raw)),
    exercise("link qoi gray8", |s, c| gray(s, c, Encoding::Qoi)),
    exercise("link bits of a map", |s, c| map(s, c, Encoding::Bits)),
    exercise("link bits-run-length of a map", |s, c| map(s, c, Encoding::BitsRunLength)),
];

const fn exercise(
    name: &'static str,
    run: fn(&mut Workspace, &mut dyn Clock) -> Result<Done, Error>,
) -> Exercise {
    Exercise { name, unit: Unit::Byte, run }
}

/// A line without a wire: nothing but the encoder is counted.
struct Nowhere;

impl embedded_io::ErrorType for Nowhere {
    type Error = Infallible;
}

impl embedded_io::Write for Nowhere {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

impl embedded_io::ErrorType for Results {
    type Error = Infallible;
}

impl embedded_io::Write for Results {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.bytes(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

fn color(space: &mut Workspace, clock: &mut dyn Clock, encoding: Encoding) -> Result<Done, Error> {
    let Workspace { picture, memory, .. } = space;
    sent(rgb888::as_bytes(picture), Format::RGB888, encoding, memory, clock)
}

fn gray(space: &mut Workspace, clock: &mut dyn Clock, encoding: Encoding) -> Result<Done, Error> {
    let Workspace { gray, memory, .. } = space;
    sent(gray, Format::GRAY8, encoding, memory, clock)
}

/// The steep places of the picture, as a map of 0 and 255.
fn map(space: &mut Workspace, clock: &mut dyn Clock, encoding: Encoding) -> Result<Done, Error> {
    let Workspace { gray, bytes, memory, .. } = space;
    let edges = &mut bytes[..gray.len()];
    for (edges, gray) in edges.chunks_mut(WIDTH).zip(gray.chunks(WIDTH)) {
        for (edge, pair) in edges.iter_mut().zip(gray.windows(2)) {
            *edge = if pair[0].abs_diff(pair[1]) > 24 { 255 } else { 0 };
        }
        edges[WIDTH - 1] = 0;
    }
    sent(edges, Format::GRAY8, encoding, memory, clock)
}

/// Sends the picture twice: into nothing, which is counted, and into the checksum.
fn sent(
    pixels: &[u8],
    format: Format,
    encoding: Encoding,
    memory: &mut [u8],
    clock: &mut dyn Clock,
) -> Result<Done, Error> {
    let memory = &mut memory[..wire_bytes(BODY_MAX)];
    clock.start();
    send(Nowhere, pixels, format, encoding, memory)?;
    clock.stop();
    let mut result = Ok(());
    let done = Done::of(pixels.len(), |results| result = send(results, pixels, format, encoding, memory));
    result.map(|()| done)
}

fn send(
    writer: impl embedded_io::Write,
    pixels: &[u8],
    format: Format,
    encoding: Encoding,
    memory: &mut [u8],
) -> Result<(), Error> {
    let bytes = memory.len();
    // The writers take everything, so it could only be that.
    let full = |_| Error::BufferLength { name: "memory", expected: wire_bytes(BODY_MAX), got: bytes };
    let mut sender = Sender::new(writer, memory, small_table);
    let start = FrameStart {
        stream: 0,
        format,
        meaning: Meaning::default(),
        snapshot: false,
        sequence: 1,
        width: WIDTH as u16,
        height: HEIGHT as u16,
        captured: 0,
        palette: 0,
    };
    let mut frame = sender.begin(start, Choice::One(encoding)).map_err(full)?;
    for (number, line) in (0..).zip(pixels.chunks(format.line_bytes(WIDTH))) {
        sender.line(&mut frame, number, line).map_err(full)?;
    }
    sender.end(frame.end()).map_err(full)
}
