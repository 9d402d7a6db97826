//! An analyser's capture to pixel clocks: sigrok sessions with 8 and with 40 samples a clock, inflating included.
//! Beside them inflating alone, and all levels of all channels. Then Saleae's exports and FST to pixel clocks, the latter
//! beside the crates `fst-reader` and `wellen`.
//!
//! `cargo bench -p host-sim --bench captures` prints samples a second for sessions, pixel clocks a second for the others.

use std::convert::Infallible;
use std::fs::File;
use std::hint::black_box;
use std::io::{BufWriter, Read};
use std::path::Path;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use firmware::camif::pins::{Edge, Samples, Sync};
use firmware::trace::StretchSink;
use fst_writer::{FstFileType, FstInfo, FstScopeType, FstSignalType, FstVarDirection, FstVarType, open_fst};
use host_sim::trace::levels::LevelSink;
use host_sim::trace::sr::{SrWriter, SrWriterOptions};
use host_sim::trace::vcd::VcdWriterOptions;
use host_sim::trace::{Capture, CaptureOptions, SignalMap, TraceWriterOptions, create, open};

/// Clocks of a line of a VGA frame in RGB888.
const LINE: usize = 1920;

/// Lines of random samples.
fn random_lines(clocks: usize, mut take: impl FnMut(Sync, &[u8])) {
    let mut seed = 0x2545_F491_4F6C_DD1D_u64;
    let mut line = [0; LINE];
    for number in 0..clocks / LINE {
        for byte in &mut line {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            *byte = (seed >> 32) as u8;
        }
        take(Sync { hsync: number % 2 == 1, vsync: number % 480 == 0 }, &line);
    }
}

/// A session of sigrok.
fn session(path: &Path, clocks: usize, samples_per_clock: u16) {
    let options = SrWriterOptions { bus_bits: 8, pclk_hz: 24_000_000, edge: Edge::Rising, samples_per_clock };
    let mut writer = SrWriter::new(BufWriter::new(File::create(path).unwrap()), options).unwrap();
    random_lines(clocks, |sync, line| writer.stretch(sync, Samples::Bytes(line)).unwrap());
    writer.finish().unwrap();
}

/// The wires of a binary export, which knows only numbers.
const NUMBERED: &str =
    "PCLK=CH0,HSYNC=CH1,VSYNC=CH2,D0=CH3,D1=CH4,D2=CH5,D3=CH6,D4=CH7,D5=CH8,D6=CH9,D7=CH10";

/// An export of Saleae's: `.csv`, or a folder of binary files.
fn export(path: &Path, clocks: usize) {
    let vcd = VcdWriterOptions::new(8, 24_000_000);
    let mut writer =
        create(path, &TraceWriterOptions { vcd, vsync_active: true, profile: String::new() }).unwrap();
    random_lines(clocks, |sync, line| writer.stretch(sync, Samples::Bytes(line)).unwrap());
    writer.finish().unwrap();
}

/// An FST with a wire a bit, data at the falling edge, a section every 100,000 clocks.
fn fst(path: &Path, clocks: usize) {
    let info = FstInfo {
        start_time: 0,
        timescale_exponent: -9,
        version: String::new(),
        date: String::new(),
        file_type: FstFileType::Verilog,
    };
    let mut header = open_fst(path, &info).unwrap();
    header.scope("camera", "camera", FstScopeType::Module).unwrap();
    let names: Vec<String> = ["PCLK", "HSYNC", "VSYNC"]
        .map(String::from)
        .into_iter()
        .chain((0..8).map(|bit| format!("D{bit}")))
        .collect();
    let mut wire = |name: &String| {
        let (one, implicit) = (FstSignalType::bit_vec(1), FstVarDirection::Implicit);
        header.var(name, one, FstVarType::Wire, implicit, None).unwrap()
    };
    let wires: Vec<_> = names.iter().map(&mut wire).collect();
    header.up_scope().unwrap();
    let mut body = header.finish().unwrap();
    let (mut time, mut before) = (0, 0xFFFF_u16);
    random_lines(clocks, |sync, line| {
        for &value in line {
            let state = u16::from(value) << 3 | u16::from(sync.vsync) << 2 | u16::from(sync.hsync) << 1;
            body.time_change(time).unwrap();
            body.signal_change(wires[0], b"0").unwrap();
            for bit in (1..11).filter(|bit| (state ^ before) >> bit & 1 != 0) {
                body.signal_change(wires[bit], if state >> bit & 1 == 0 { b"0" } else { b"1" }).unwrap();
            }
            body.time_change(time + 20).unwrap();
            body.signal_change(wires[0], b"1").unwrap();
            (time, before) = (time + 40, state);
            if time.is_multiple_of(4_000_000) {
                body.flush().unwrap();
            }
        }
    });
    body.finish().unwrap();
}

/// All changes by the crate that reads FSTs.
fn fst_reader(path: &Path) -> u64 {
    let file = std::io::BufReader::new(File::open(path).unwrap());
    let mut reader = fst_reader::FstReader::open(file).unwrap();
    let mut changes = 0;
    let all = fst_reader::FstFilter::all();
    let end = reader.read_signals::<()>(&all, |_, _, value| {
        changes += u64::from(matches!(value, fst_reader::FstSignalValue::String(_)));
        Ok(())
    });
    assert!(end.is_ok());
    changes
}

/// The waves of all signals, on one thread.
fn wellen(path: &Path) -> u64 {
    let options = wellen::LoadOptions { multi_thread: false, ..wellen::LoadOptions::default() };
    let mut waves = wellen::simple::read_with_options(path, &options).unwrap();
    let signals: Vec<_> = waves.hierarchy().signals().collect();
    waves.load_signals(&signals);
    signals.iter().map(|&signal| waves.get_signal(signal).unwrap().time_indices().len() as u64).sum()
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

fn read_changes(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap();
    let clocks = 400 * LINE;
    let mut group = criterion.benchmark_group("pixel clocks");
    group.throughput(Throughput::Elements(clocks as u64)).sample_size(10);
    let [csv, binary, waves] =
        ["digital.csv", "binary.saleae", "waves.fst"].map(|name| folder.path().join(name));
    export(&csv, clocks);
    export(&binary, clocks);
    fst(&waves, clocks);
    let size = |path: &Path| std::fs::metadata(path).unwrap().len();
    let sizes = std::fs::read_dir(&binary).unwrap().map(|file| size(&file.unwrap().path())).sum();
    for (path, bytes, map) in [(&csv, size(&csv), ""), (&binary, sizes, NUMBERED), (&waves, size(&waves), "")]
    {
        let name = path.file_name().unwrap().to_string_lossy();
        let mut options = CaptureOptions::default();
        options.wanted.map = SignalMap::parse(map).unwrap();
        let trace = open(path, &options).unwrap();
        let name = format!("{name}, {:.1} bytes a clock", bytes as f64 / clocks as f64);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let mut count = Count::default();
                trace.play(&mut count, &mut |_| ()).unwrap();
                assert!(count.0.abs_diff(clocks as u64) <= 1);
            });
        });
    }
    group.bench_function("waves.fst, changes only, by fst-reader", |bencher| {
        bencher.iter(|| fst_reader(&waves));
    });
    group.bench_function("waves.fst, waves in memory, by wellen", |bencher| {
        bencher.iter(|| wellen(&waves));
    });
    group.finish();
}

criterion_group!(benches, read_sr, read_changes);
criterion_main!(benches);
