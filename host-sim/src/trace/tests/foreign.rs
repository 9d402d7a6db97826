//! Captures that other programs wrote (`data/make.py`), and everything that can happen to them on their way.

use std::io::{Cursor, Write as _};
use std::path::Path;

use super::fst::FstFile;
use super::levels::Levels;
use super::open as open_trace;
use super::saleae::CsvExport;
use super::sr::SrFile;
use super::wiring::Tap;
use super::*;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src/trace/tests/data").join(name)
}

fn clocks(path: &Path, map: &str) -> (Trace, Vec<Clock>, Played) {
    let wanted = Wanted { map: SignalMap::parse(map).unwrap(), ..Wanted::default() };
    let trace = open(path, &CaptureOptions { wanted, ..CaptureOptions::default() }).unwrap();
    let mut clocks = Clocks::default();
    let played = trace.play(&mut clocks, &mut |_| ()).unwrap();
    (trace, clocks.0, played)
}

/// Channels 0 to 7 are the data, then PCLK, HSYNC, VSYNC.
const NUMBERED: &str =
    "D0=CH0,D1=CH1,D2=CH2,D3=CH3,D4=CH4,D5=CH5,D6=CH6,D7=CH7,PCLK=CH8,HSYNC=CH9,VSYNC=CH10";

#[test]
fn captures_of_other_programs_hold_the_clocks_that_were_sent() {
    let sent = marker(24, 4, 2);
    for (name, map, format, sampled) in [
        ("sigrok.sr", NUMBERED, Format::Sr, true),
        ("digital.csv", "", Format::SaleaeCsv, true),
        ("saleae-0", NUMBERED, Format::SaleaeBinary, true),
        ("saleae-1", NUMBERED, Format::SaleaeBinary, true),
        ("gtkwave-lz4.fst", "", Format::Fst, false),
        ("gtkwave-fastlz.fst", "", Format::Fst, false),
        ("gtkwave-zlib.fst", "", Format::Fst, false),
    ] {
        let (trace, clocks, played) = clocks(&data(name), map);
        assert!(clocks == sent, "{name}: {} of {}", clocks.len(), sent.len());
        assert_eq!((trace.info().format, played.dropped_pulses), (format, 0), "{name}");
        let clock = trace.info().clock.unwrap();
        assert!((clock.hertz.unwrap() / 12e6 - 1.0).abs() < 0.01, "{name}");
        assert_eq!(trace.capture().is_sampled(), sampled);
        let samples = clock.samples_per_clock.map(f64::round);
        let known = matches!(name, "sigrok.sr" | "saleae-1");
        assert_eq!(samples, known.then_some(8.0), "{name}");
    }
}

#[test]
fn an_fst_reads_as_the_crate_that_reads_them_does() {
    for packing in ["lz4", "fastlz", "zlib"] {
        let bytes = std::fs::read(data(&format!("gtkwave-{packing}.fst"))).unwrap();
        let mut oracle = fst_reader::FstReader::open(Cursor::new(&bytes)).unwrap();
        let (mut expected, mut last) = (Vec::new(), (0, [0_u8; 11]));
        let filter = fst_reader::FstFilter::all();
        let end = oracle.read_signals::<()>(&filter, |time, handle, value| {
            if time != last.0 {
                expected.push(last);
                last.0 = time;
            }
            if let fst_reader::FstSignalValue::String(bits) = value {
                let at = [8, 9, 10, 0][handle.get_index()];
                for (bit, &character) in bits.iter().rev().enumerate() {
                    last.1[at + bit] = character - b'0';
                }
            }
            Ok(())
        });
        assert!(end.is_ok());
        expected.push(last);
        let capture = Capture::open(data(&format!("gtkwave-{packing}.fst"))).unwrap();
        let number = |name: &str| capture.channels().iter().position(|channel| channel.name == name).unwrap();
        let mut channels: Vec<usize> = (0..8).map(|bit| number(&format!("tb.D[{bit}]"))).collect();
        channels.extend(["tb.PCLK", "tb.HSYNC", "tb.VSYNC"].map(number));
        let levels = capture.beginning(&channels, 1 << 20).unwrap();
        let ours: Vec<(u64, [u8; 11])> = std::iter::zip(&levels.times, &levels.states)
            .map(|(&time, &state)| (time, std::array::from_fn(|bit| (state >> bit & 1) as u8)))
            .collect();
        assert_eq!(ours, expected, "{packing}");
    }
}

fn all_wires() -> Vec<(Tap, u64)> {
    (0..11).map(|bit| (Tap { signal: bit, bit: 0 }, 1 << bit)).collect()
}

fn played<T: std::fmt::Display, P>(
    play: impl FnOnce(&[(Tap, u64)], &mut Levels) -> Result<P, PlayError<T, levels::Enough>>,
) -> Result<Levels, String> {
    let mut levels = Levels::at_most(100_000);
    match play(&all_wires(), &mut levels) {
        Err(PlayError::Trace(error)) => Err(error.to_string()),
        Ok(_) | Err(PlayError::Sink(_)) => Ok(levels),
    }
}

/// Every truncation and every flipped bit: levels, or words.
fn damaged(bytes: &[u8], mut read: impl FnMut(&[u8]) -> Result<Levels, String>) -> usize {
    let whole = read(bytes).unwrap();
    assert!(whole.times.len() > 10);
    let mut refused = 0;
    let mut check = |bytes: &[u8]| match read(bytes) {
        Ok(levels) => assert!(levels.times.is_sorted()),
        Err(words) => {
            refused += 1;
            assert!(words.len() > 10, "{words}");
        }
    };
    for length in 0..bytes.len() {
        check(&bytes[..length]);
    }
    let mut flipped = bytes.to_vec();
    for bit in 0..bytes.len() * 8 {
        flipped[bit / 8] ^= 1 << (bit % 8);
        check(&flipped);
        flipped[bit / 8] ^= 1 << (bit % 8);
    }
    refused
}

#[test]
fn every_truncation_and_every_flipped_bit_of_a_session_is_levels_or_a_typed_error() {
    let bytes = std::fs::read(data("sigrok.sr")).unwrap();
    let refused = damaged(&bytes, |bytes| {
        let mut file = SrFile::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
        played(|wires, levels| file.play(wires, levels, &mut |_| ()))
    });
    assert!(refused > bytes.len(), "{refused}");
}

#[test]
fn every_truncation_and_every_flipped_bit_of_an_fst_is_levels_or_a_typed_error() {
    for packing in ["lz4", "fastlz", "zlib"] {
        let bytes = std::fs::read(data(&format!("gtkwave-{packing}.fst"))).unwrap();
        let refused = damaged(&bytes, |bytes| {
            let mut file = FstFile::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
            played(|wires, levels| file.play(wires, levels, &mut |_| ()))
        });
        assert!(refused > bytes.len(), "{packing}: {refused}");
    }
}

#[test]
fn every_truncation_and_every_flipped_bit_of_an_export_is_levels_or_a_typed_error() {
    let text = std::fs::read(data("digital.csv")).unwrap();
    damaged(&text[..900], |bytes| {
        let file = CsvExport::new(bytes).map_err(|error| error.to_string())?;
        played(|wires, levels| file.play(wires, levels, &mut |_| ()))
    });
    for version in ["saleae-0", "saleae-1"] {
        let bytes = std::fs::read(data(version).join("digital_3.bin")).unwrap();
        damaged(&bytes, |bytes| saleae::changes_of_one(bytes).map_err(|error| error.to_string()));
    }
}

#[test]
fn hostile_archives_are_refused() {
    use zip::write::SimpleFileOptions;
    let made = |files: &[(&str, &[u8])]| {
        let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
        for (name, bytes) in files {
            zip.start_file(*name, SimpleFileOptions::default()).unwrap();
            zip.write_all(bytes).unwrap();
        }
        zip.finish().unwrap().into_inner()
    };
    let metadata = b"[device 1]\ncapturefile=logic-1\nunitsize=2\nsamplerate=1 MHz\nprobe1=a\n";
    let session = |more: &[(&'static str, &'static [u8])]| {
        let mut files: Vec<(&str, &[u8])> = vec![("version", b"2"), ("metadata", metadata)];
        files.extend(more);
        made(&files)
    };
    let read = |bytes: &[u8]| {
        let mut file = SrFile::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
        played(|wires, levels| file.play(&wires[..1], levels, &mut |_| ()))
    };
    // Pieces are put in order by their numbers, and may break a sample anywhere.
    let mut pieces: Vec<(&str, &[u8])> = vec![("logic-1-2", b"\x00\x01\x00"), ("logic-1-1", b"\x01\x00\x00")];
    let names: Vec<String> = (3..=12).map(|number| format!("logic-1-{number}")).collect();
    pieces.extend(
        names
            .iter()
            .rev()
            .map(|name| (name.as_str(), if name.ends_with('2') { &b"\x00\x00"[..] } else { b"\x01\x00" })),
    );
    let mut files: Vec<(&str, &[u8])> = vec![("version", b"2"), ("metadata", metadata)];
    files.extend(pieces);
    let levels = read(&made(&files)).unwrap();
    assert_eq!((levels.times, levels.states), (vec![0, 1, 2, 12], vec![1, 0, 1, 0]));
    for (bytes, expected) in [
        (session(&[]), "`logic-1-1` is missing"),
        (session(&[("logic-1-1", b"ab"), ("logic-1-3", b"ab")]), "`logic-1-2` is missing"),
        (session(&[("logic-1", b"ab"), ("logic-1-1", b"ab")]), "beside pieces"),
        (session(&[("logic-1", b"abc")]), "1 bytes of one that has 2"),
        (session(&[("../logic-1", b"ab")]), "a path in its name"),
        (session(&[("/etc/passwd", b"ab")]), "a path in its name"),
        (session(&[("logic-1-01", b"ab")]), "`logic-1-1` is missing"),
        (made(&[("version", b"3"), ("metadata", metadata)]), "version `3`"),
        (made(&[("meta.json", b"{}")]), "Saleae Logic 2"),
        (made(&[("version", b"2")]), "no `metadata`"),
        (made(&[("version", &[b'2'; 100]), ("metadata", metadata)]), "version"),
    ] {
        let words = read(&bytes).unwrap_err();
        assert!(words.contains(expected), "{words}");
    }
    // More files than there can be, by the last record alone.
    let mut many = session(&[("logic-1", b"ab")]);
    let end = many.len() - 22;
    many.splice(end..end, *b"PK\x06\x07\0\0\0\0\0\0\0\0\0\0\0\0\x01\0\0\0");
    many[end + 20 + 10..end + 20 + 12].fill(0xFF);
    let mut record = vec![0; 56];
    record[32..40].copy_from_slice(&u64::MAX.to_le_bytes());
    many.splice(0..0, record);
    assert!(read(&many).unwrap_err().contains("18446744073709551615 files"));
}

/// A clock of that many samples a period and data that moves with it, as an analyser sees them.
fn sampled(samples_per_clock: f64, clocks: u64, phase: f64, glitch: Option<u64>) -> PathBuf {
    let path =
        std::env::temp_dir().join(format!("camif-{samples_per_clock}-{phase}-{}.csv", std::process::id()));
    let mut seed = 1_u32;
    let values: Vec<u32> = (0..=clocks + 1)
        .map(|_| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            seed >> 24
        })
        .collect();
    let mut zip = zip::ZipWriter::new(std::fs::File::create(&path).unwrap());
    let names: Vec<String> = (0..8).map(|line| format!("probe{}=D{line}\n", line + 1)).collect();
    let metadata = format!(
        "[device 1]\ncapturefile=logic-1\nunitsize=2\nsamplerate=100 MHz\n{}probe9=PCLK\nprobe10=HS\nprobe11=VS\n",
        names.concat()
    );
    let mut samples = Vec::new();
    for number in 0..(clocks as f64 * samples_per_clock) as u64 {
        let time = number as f64 / samples_per_clock;
        let mut high = time.fract() >= 0.5;
        if glitch.is_some_and(|every| number % every == every / 2) {
            high = !high;
        }
        let data = values[(time + 1.0 - phase) as usize];
        samples.extend((data as u16 | u16::from(high) << 8).to_le_bytes());
    }
    for (name, bytes) in [("version", &b"2"[..]), ("metadata", metadata.as_bytes()), ("logic-1", &samples)] {
        zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap();
    path
}

#[test]
fn the_clock_is_recovered_from_samples() {
    let open = |path: &PathBuf| {
        let trace = open_trace(path, &CaptureOptions::default());
        let _ = std::fs::remove_file(path);
        trace.map(|trace| trace.info().clock.unwrap())
    };
    // Data moves at the falling edge: the rising one is kept.
    let clock = open(&sampled(7.3, 3000, 0.0, None)).unwrap();
    assert!((clock.samples_per_clock.unwrap() - 7.3).abs() < 0.05, "{clock:?}");
    assert!(clock.edge == Edge::Rising && !clock.edge_was_changed && clock.notes().is_empty(), "{clock:?}");
    // It moves at the rising edge: read at the falling one.
    let clock = open(&sampled(7.3, 3000, 0.5, None)).unwrap();
    assert!(clock.edge == Edge::Falling && clock.edge_was_changed, "{clock:?}");
    assert!(clock.notes()[0].contains("read at the falling edge"), "{:?}", clock.notes());
    for samples in [2.2, 2.9, 3.6] {
        let clock = open(&sampled(samples, 6000, 0.05, None)).unwrap();
        assert!(clock.notes()[0].starts_with("warning: only"), "{samples}: {:?}", clock.notes());
    }
    for samples in [1.15, 1.4, 1.5, 1.6, 1.8, 1.9] {
        let error = open(&sampled(samples, 6000, 0.05, None)).unwrap_err().to_string();
        assert!(error.contains("fewer than 2 samples a clock"), "{samples}: {error}");
    }
    // Short pulses are dropped and counted, and the samples are the same.
    let path = sampled(16.0, 2000, 0.0, Some(161));
    let trace = open_trace(&path, &CaptureOptions::default()).unwrap();
    let (mut with, mut without) = (Clocks::default(), Clocks::default());
    let played = trace.play(&mut with, &mut |_| ()).unwrap();
    let _ = std::fs::remove_file(&path);
    let clean = sampled(16.0, 2000, 0.0, None);
    let trace = open_trace(&clean, &CaptureOptions::default()).unwrap();
    trace.play(&mut without, &mut |_| ()).unwrap();
    let _ = std::fs::remove_file(&clean);
    assert!(played.dropped_pulses > 100, "{played:?}");
    let close = (with.0.len() as i64 - without.0.len() as i64).abs();
    assert!(close < 10, "{} {}", with.0.len(), without.0.len());
}
