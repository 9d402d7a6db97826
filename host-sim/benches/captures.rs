//! An analyser's capture to pixel clocks: sigrok sessions with 8 and with 40 samples a clock, inflating included.
//! Beside them inflating alone, and all levels of all channels.
//!
//! `cargo bench -p host-sim --bench captures` prints samples a second.

use std::convert::Infallible;
use std::fs::File;
use std::hint::black_box;
use std::io::{BufWriter, Read};
use std::path::Path;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use firmware::camif::pins::{Edge, Samples, Sync};
use firmware::trace::StretchSink;
use host_sim::trace::levels::LevelSink;
use host_sim::trace::sr::{SrWriter, SrWriterOptions};
use host_sim::trace::{Capture, CaptureOptions, open};

/// Clocks of a line of a VGA frame in RGB888.
const LINE: usize = 1920;

/// A session of random samples.
fn session(path: &Path, clocks: usize, samples_per_clock: u16) {
    let options = SrWriterOptions { bus_bits: 8, pclk_hz: 24_000_000, edge: Edge::Rising, samples_per_clock };
    let mut writer = SrWriter::new(BufWriter::new(File::create(path).unwrap()), options).unwrap();
    let mut seed = 0x2545_F491_4F6C_DD1D_u64;
    let mut line = [0; LINE];
    for number in 0..clocks / LINE {
        for byte in &mut line {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            *byte = (seed >> 32) as u8;
        }
        let sync = Sync { hsync: number % 2 == 1, vsync: number % 480 == 0 };
        writer.stretch(sync, Samples::Bytes(&line)).unwrap();
    }
    writer.finish().unwrap();
}

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

impl LevelSink for Count {
    type Error = Infallible;
    fn levels(&mut self, _: u64, state: u64) -> Result<(), Infallible> {
        self.0 = self.0.wrapping_add(state);
        Ok(())
    }
}

fn inflate(path: &Path) -> u64 {
    let mut archive = zip::ZipArchive::new(File::open(path).unwrap()).unwrap();
    let mut block = vec![0; 1 << 17];
    let mut all = 0;
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index).unwrap();
        loop {
            match entry.read(&mut block).unwrap() {
                0 => break,
                count => all += count as u64,
            }
        }
    }
    all
}

fn read_sr(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap();
    let mut group = criterion.benchmark_group("sigrok session");
    for (samples_per_clock, clocks) in [(8, 1000 * LINE), (40, 400 * LINE)] {
        let path = folder.path().join(format!("{samples_per_clock}.sr"));
        session(&path, clocks, samples_per_clock);
        group.throughput(Throughput::Elements(clocks as u64 * u64::from(samples_per_clock))).sample_size(10);
        let trace = open(&path, &CaptureOptions::default()).unwrap();
        group.bench_function(format!("{samples_per_clock} samples a clock to pixel clocks"), |bencher| {
            bencher.iter(|| {
                let mut count = Count::default();
                trace.play(&mut count, &mut |_| ()).unwrap();
                assert_eq!(count.0, clocks as u64);
            });
        });
        let capture = Capture::open(&path).unwrap();
        let all: Vec<usize> = (0..capture.channels().len()).collect();
        group.bench_function(
            format!("{samples_per_clock} samples a clock to levels of all channels"),
            |bencher| {
                bencher.iter(|| {
                    let mut count = Count::default();
                    capture.play(&all, &mut count, &mut |_| ()).unwrap();
                    count.0
                });
            },
        );
        group.bench_function(format!("{samples_per_clock} samples a clock, inflating alone"), |bencher| {
            bencher.iter(|| inflate(&path));
        });
    }
    group.finish();
}

criterion_group!(benches, read_sr);
criterion_main!(benches);
