//! VCD text to pin samples, and on through block and driver to frames. Beside them the readers of the crates `vcd` and
//! `wellen`, and a loop that only looks at every byte.
//!
//! `cargo bench -p host-sim --bench vcd` prints the throughput of file text.

use std::convert::Infallible;
use std::hint::black_box;

use criterion::{
    BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime,
};
use firmware::camif::Bus;
use firmware::camif::pins::{Samples, Sync};
use firmware::driver::Config;
use firmware::driver::verdict::Outcome;
use firmware::trace::{ChunkBuffer, Header, Item, Reader, StretchSink, Writer};
use host_sim::picture::crc32;
use host_sim::profile::Profile;
use host_sim::receiver::{Received, Receiver, capture_config, receive};
use host_sim::trace::CaptureOptions;
use host_sim::trace::camt::{StdIo, fast_crc32};
use host_sim::trace::vcd::{Layout, Style, VcdReader, VcdWriter, VcdWriterOptions};

/// Clocks of a line of a VGA frame in RGB888.
const LINE: usize = 1920;
/// Samples of a quarter of a frame.
const QUARTER: usize = 120 * LINE;

/// Random samples: half of the wires change at every clock, and nobody can tell how many.
fn picture(samples: usize) -> Vec<u8> {
    let mut seed = 0x2545_F491_4F6C_DD1D_u64;
    (0..samples)
        .map(|_| {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            (seed >> 32) as u8
        })
        .collect()
}

/// Marker timing: the first sample of a line carries HSYNC, that of a frame VSYNC too; an idle clock ends the last frame.
fn send<S: StretchSink>(sink: &mut S, pixels: &[u8]) -> Result<(), S::Error> {
    for (line, bytes) in pixels.chunks(LINE).enumerate() {
        let (marked, rest) = bytes.split_at(1);
        sink.stretch(Sync { hsync: line > 0, vsync: line > 0 && line % 480 == 0 }, Samples::Bytes(marked))?;
        sink.stretch(Sync::default(), Samples::Bytes(rest))?;
    }
    sink.stretch(Sync { hsync: true, vsync: true }, Samples::Bytes(&[0]))
}

fn text(layout: Layout, style: Style, pixels: &[u8]) -> Vec<u8> {
    let options = VcdWriterOptions { layout, style, ..VcdWriterOptions::new(8, 27_648_000) };
    let mut writer = VcdWriter::new(Vec::new(), options).unwrap();
    send(&mut writer, pixels).unwrap();
    writer.finish().unwrap().0
}

/// The same changes under identifiers of one to four characters, as in the dump of a larger design.
fn with_long_ids(text: &[u8]) -> Vec<u8> {
    let renamed = |id: u8| -> &str {
        match id {
            b'P' => "!",
            b'H' => "\"%",
            b'V' => "#7a",
            b'a' => "$&",
            b'b' => "{k",
            b'c' => "}~Q",
            b'd' => "aa1",
            b'e' => "bZ",
            b'f' => "c",
            b'g' => "dd!x",
            _ => "e9",
        }
    };
    let mut out = Vec::new();
    for line in text.split_inclusive(|&byte| byte == b'\n') {
        match line {
            [value @ (b'0' | b'1'), id, b'\n'] => {
                out.push(*value);
                out.extend_from_slice(renamed(*id).as_bytes());
                out.push(b'\n');
            }
            _ if line.starts_with(b"$var") => {
                let words: Vec<&str> = std::str::from_utf8(line).unwrap().split(' ').collect();
                let id = renamed(words[3].as_bytes()[0]);
                out.extend_from_slice(format!("$var wire 1 {id} {} $end\n", words[4]).as_bytes());
            }
            _ => out.extend_from_slice(line),
        }
    }
    out
}

/// Counts, so that nothing is optimised away.
#[derive(Default)]
struct Count(u64);

impl StretchSink for Count {
    type Error = Infallible;
    fn stretch(&mut self, _: Sync, samples: Samples<'_>) -> Result<(), Infallible> {
        self.0 += samples.len() as u64;
        black_box(&samples);
        Ok(())
    }
}

fn ours(text: &[u8]) -> u64 {
    let reader = VcdReader::new(text, &CaptureOptions::default()).unwrap();
    let mut count = Count::default();
    reader.play(&mut count, &mut |_| ()).unwrap();
    count.0
}

fn vcd_crate(text: &[u8]) -> u64 {
    let mut parser = vcd::Parser::new(text);
    parser.parse_header().unwrap();
    parser.map(|command| u64::from(matches!(command.unwrap(), vcd::Command::ChangeScalar(..)))).sum()
}

/// The waves of all signals, on one thread. The copy of the text that it wants for itself costs little beside.
fn wellen(text: &[u8]) -> u64 {
    let text = std::io::Cursor::new(text.to_vec());
    let options = wellen::LoadOptions { multi_thread: false, ..wellen::LoadOptions::default() };
    let header = wellen::viewers::read_header(text, &options).unwrap();
    let body = wellen::viewers::read_body(header.body, &header.hierarchy, None).unwrap();
    body.time_table.len() as u64
}

fn byte_loop(text: &[u8]) -> u64 {
    text.iter().fold(0_u64, |hash, &byte| hash.rotate_left(5) ^ u64::from(byte))
}

fn read_vcd(criterion: &mut Criterion) {
    let pixels = picture(QUARTER);
    let mut group = criterion.benchmark_group("vcd to pin samples");
    let wires = text(Layout::Wires, Style::OppositeEdge, &pixels);
    let texts = [
        ("wires", wires.clone()),
        ("wires, identifiers of 1 to 4 characters", with_long_ids(&wires)),
        ("wires, data with the edge", text(Layout::Wires, Style::WithEdge, &pixels)),
        ("bus", text(Layout::Bus, Style::OppositeEdge, &pixels)),
    ];
    for (name, text) in &texts {
        assert_eq!(ours(text), pixels.len() as u64 + 1);
        bench(&mut group, name, text, ours);
    }
    bench(&mut group, "wires, by the vcd crate (parsing only)", &wires, vcd_crate);
    bench(&mut group, "wires, by wellen (waves in memory)", &wires, wellen);
    bench(&mut group, "wires, looking at every byte", &wires, byte_loop);
    group.finish();
}

/// Frames in the text that goes all the way, and the samples of each.
const FRAMES: usize = 2;
const FRAME: usize = 480 * LINE;

/// Plays a trace through block and driver: how many good frames it holds. `check` sees the bytes of each.
fn frames(text: &[u8], config: &Config, check: &mut dyn FnMut(&[u8])) -> usize {
    let mut good = 0;
    let mut take = |frame: Received<'_>| {
        if let (Outcome::Good, Some(bytes)) = (frame.verdict.outcome, frame.bytes) {
            good += 1;
            check(bytes);
        }
    };
    let play = |receiver: &mut Receiver<'_, '_>| {
        let reader = VcdReader::new(text, &CaptureOptions::default()).unwrap();
        reader.play(receiver, &mut |_| ()).unwrap().clocks
    };
    let (clocks, _) = receive(config, Bus::IDEAL, &mut take, play).unwrap();
    assert_eq!(clocks, (FRAMES * FRAME) as u64 + 1);
    good
}

/// All of a replay: text, samples, block, driver, frames.
fn vcd_to_frames(criterion: &mut Criterion) {
    let config = capture_config(&Profile::built_in("vga-rgb888").unwrap());
    let pixels = picture(FRAMES * FRAME);
    let sent: Vec<u32> = pixels.chunks(FRAME).map(crc32).collect();
    let mut group = criterion.benchmark_group("vcd to frames");
    let wires = text(Layout::Wires, Style::OppositeEdge, &pixels);
    let texts = [
        ("wires", wires.clone()),
        ("wires, identifiers of 1 to 4 characters", with_long_ids(&wires)),
        ("wires, data with the edge", text(Layout::Wires, Style::WithEdge, &pixels)),
        ("bus", text(Layout::Bus, Style::OppositeEdge, &pixels)),
    ];
    for (name, text) in &texts {
        let mut received = Vec::new();
        assert_eq!(frames(text, &config, &mut |bytes| received.push(crc32(bytes))), FRAMES);
        assert_eq!(received, sent);
        bench(&mut group, name, text, |text| frames(text, &config, &mut |_| ()) as u64);
    }
    group.finish();
}

fn bench(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, text: &[u8], read: impl Fn(&[u8]) -> u64) {
    group.throughput(Throughput::Bytes(text.len() as u64)).sample_size(20);
    group.bench_function(name, |bencher| bencher.iter(|| read(black_box(text))));
}

fn write_vcd(criterion: &mut Criterion) {
    let pixels = picture(QUARTER);
    let mut group = criterion.benchmark_group("pin samples to vcd");
    let bytes = text(Layout::Wires, Style::OppositeEdge, &pixels).len();
    group.throughput(Throughput::Bytes(bytes as u64)).sample_size(20);
    group.bench_function("wires", |bencher| {
        bencher.iter(|| text(Layout::Wires, Style::OppositeEdge, black_box(&pixels)).len());
    });
    group.finish();
}

fn camt(criterion: &mut Criterion) {
    let pixels = picture(QUARTER).repeat(32);
    let header = Header { bus_bits: 8, vsync_active: true, pclk_hz: 27_648_000 };
    let write = || {
        let out = StdIo(Vec::with_capacity(pixels.len() + pixels.len() / 64));
        let mut writer = Writer::with_checksum(out, header, "", ChunkBuffer::new(), fast_crc32).unwrap();
        send(&mut writer, &pixels).unwrap();
        writer.finish().unwrap().0.0
    };
    let file = write();
    let mut group = criterion.benchmark_group("camt, samples");
    group.throughput(Throughput::Bytes(pixels.len() as u64)).sample_size(20);
    group.bench_function("read", |bencher| {
        bencher.iter(|| {
            let mut reader = Reader::with_checksum(StdIo(&file[..]), ChunkBuffer::new(), fast_crc32).unwrap();
            let mut count = Count::default();
            while let Some(item) = reader.next_item().unwrap() {
                if let Item::Stretch(sync, samples) = item {
                    count.stretch(sync, samples).unwrap();
                }
            }
            assert_eq!(count.0, pixels.len() as u64 + 1);
        });
    });
    group.bench_function("write", |bencher| bencher.iter(|| write().len()));
    group.finish();
}

criterion_group!(benches, read_vcd, vcd_to_frames, write_vcd, camt);
criterion_main!(benches);
