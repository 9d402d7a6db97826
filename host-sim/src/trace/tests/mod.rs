//! Files as a whole: other tools' dumps, round trips, and everything that can happen to a file on its way.

use std::convert::Infallible;
use std::fmt::Write as _;
use std::path::PathBuf;

use firmware::camif::pins::{Edge, Samples, Sync};
use firmware::trace::StretchSink;
use proptest::prelude::*;

use super::vcd::{
    Layout, SamplePoint, Style, VcdError, VcdNames, VcdPlayed, VcdReader, VcdWriter, VcdWriterOptions,
};
use super::*;

mod changes;
mod files;
mod foreign;
mod random;

/// Every clock: HSYNC, VSYNC and the sample.
type Clock = (bool, bool, u16);

#[derive(Default)]
struct Clocks(Vec<Clock>);

impl StretchSink for Clocks {
    type Error = Infallible;
    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Infallible> {
        self.0.extend((0..samples.len()).map(|i| (sync.hsync, sync.vsync, samples.get(i).unwrap())));
        Ok(())
    }
}

fn send<S: StretchSink>(clocks: &[Clock], sink: &mut S) -> Result<(), S::Error> {
    for run in clocks.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let words: Vec<u16> = run.iter().map(|clock| clock.2).collect();
        sink.stretch(Sync { hsync: run[0].0, vsync: run[0].1 }, Samples::Words(&words))?;
    }
    Ok(())
}

fn read(text: &[u8], options: &CaptureOptions) -> Result<(Vec<Clock>, VcdPlayed), VcdError> {
    let mut clocks = Clocks::default();
    match VcdReader::new(text, options)?.play(&mut clocks, &mut |_| ()) {
        Ok(played) => Ok((clocks.0, played)),
        Err(PlayError::Trace(error)) => Err(error),
        Err(PlayError::Sink(never)) => match never {},
    }
}

fn usual(text: &str) -> Result<Vec<Clock>, VcdError> {
    read(text.as_bytes(), &CaptureOptions::default()).map(|(clocks, _)| clocks)
}

/// The marker timing: HSYNC at the first clock after every line, VSYNC after every frame, one idle clock at the end.
fn marker(line: usize, lines: usize, frames: usize) -> Vec<Clock> {
    let mut seed = 0x2545_F491_u32;
    let mut clocks: Vec<Clock> = (0..line * lines * frames)
        .map(|clock| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (clock > 0 && clock % line == 0, clock > 0 && clock % (line * lines) == 0, (seed >> 24) as u16)
        })
        .collect();
    clocks.push((true, true, 0));
    clocks
}

/// A dump by the `vcd` crate: one wire a bit, sensor names. With the edge: pins first, then the rising edge in the same time
/// stamp; else pins with the falling edge.
fn by_another_tool(clocks: &[Clock], with_edge: bool) -> Vec<u8> {
    let mut text = Vec::new();
    let mut writer = ::vcd::Writer::new(&mut text);
    writer.timescale(1, ::vcd::TimescaleUnit::PS).unwrap();
    writer.add_module("top").unwrap();
    let pclk = writer.add_wire(1, "PIXCLK").unwrap();
    let href = writer.add_wire(1, "HREF").unwrap();
    let vsync = writer.add_wire(1, "VSYNC").unwrap();
    let data: Vec<_> = (0..8).map(|line| writer.add_wire(1, &format!("D{line}")).unwrap()).collect();
    writer.upscope().unwrap();
    writer.enddefinitions().unwrap();
    let (mut time, mut held) = (0, None);
    for clock in clocks {
        writer.timestamp(time).unwrap();
        if !with_edge {
            writer.change_scalar(pclk, false).unwrap();
        }
        if held.map(|held: Clock| held.0) != Some(clock.0) {
            writer.change_scalar(href, clock.0).unwrap();
        }
        if held.map(|held: Clock| held.1) != Some(clock.1) {
            writer.change_scalar(vsync, clock.1).unwrap();
        }
        for (line, &id) in data.iter().enumerate() {
            let bit = |clock: &Clock| clock.2 >> line & 1 == 1;
            if held.as_ref().map(bit) != Some(bit(clock)) {
                writer.change_scalar(id, bit(clock)).unwrap();
            }
        }
        if !with_edge {
            writer.timestamp(time + 18_084).unwrap();
        }
        writer.change_scalar(pclk, true).unwrap();
        if with_edge {
            writer.timestamp(time + 18_084).unwrap();
            writer.change_scalar(pclk, false).unwrap();
        }
        held = Some(*clock);
        time += 36_169;
    }
    text
}

#[test]
fn dumps_of_another_tool_give_the_samples_that_were_meant() {
    let sent = marker(1920, 40, 2);
    for with_edge in [false, true] {
        let text = by_another_tool(&sent, with_edge);
        let reader = VcdReader::new(&text[..], &CaptureOptions::default()).unwrap();
        let matched = reader.matched().clone();
        assert_eq!(matched.pclk, "top.PIXCLK");
        assert!(matched.hsync.unwrap().valid_high && !matched.vsync.unwrap().valid_high);
        assert!(reader.measure_clock().unwrap().unwrap().abs_diff(27_648_000) < 100);
        let (clocks, played) = read(&text, &CaptureOptions::default()).unwrap();
        assert!(clocks == sent, "data with the edge: {with_edge}");
        assert_eq!(played.clocks, sent.len() as u64);
    }
}

#[test]
fn another_tool_reads_what_is_written() {
    let sent = marker(50, 4, 2);
    for layout in [Layout::Wires, Layout::Bus] {
        let options = VcdWriterOptions { layout, ..VcdWriterOptions::new(8, 27_648_000) };
        let mut writer = VcdWriter::new(Vec::new(), options).unwrap();
        send(&sent, &mut writer).unwrap();
        let (text, _) = writer.finish().unwrap();
        let mut parser = ::vcd::Parser::new(&text[..]);
        let header = parser.parse_header().unwrap();
        assert_eq!(header.timescale, Some((1, ::vcd::TimescaleUnit::PS)));
        let id = |name: &str| header.find_var(&["camera", name]).map(|var| var.code);
        let (pclk, hsync, vsync, bus) =
            (id("PCLK").unwrap(), id("HSYNC").unwrap(), id("VSYNC").unwrap(), id("D"));
        let lines: Vec<_> = (0..8).map(|line| id(&format!("D{line}"))).collect();
        let (mut now, mut seen) = ((false, false, 0_u16), Vec::new());
        for command in parser {
            match command.unwrap() {
                ::vcd::Command::ChangeScalar(code, value) => {
                    let high = value == ::vcd::Value::V1;
                    if code == pclk {
                        seen.extend(high.then_some(now));
                    } else if code == hsync {
                        now.0 = high;
                    } else if code == vsync {
                        now.1 = high;
                    } else if let Some(line) = lines.iter().position(|&line| line == Some(code)) {
                        now.2 = now.2 & !(1 << line) | u16::from(high) << line;
                    }
                }
                ::vcd::Command::ChangeVector(code, bits) if Some(code) == bus => {
                    now.2 = bits.iter().fold(0, |all, bit| all << 1 | u16::from(bit == ::vcd::Value::V1));
                }
                _ => {}
            }
        }
        assert!(seen == sent);
    }
}

/// What the dumps in `data/` were made from: three lines of eight clocks and an idle clock, marker timing.
fn recorded() -> Vec<Clock> {
    let value = |clock: u16| if clock < 24 { (37 * clock + 11) & 0xFF } else { 0 };
    (0..25).map(|clock| (clock > 0 && clock % 8 == 0, clock == 24, value(clock))).collect()
}

#[test]
fn a_dump_of_pyvcd_keeps_its_first_sample() {
    // It puts what changes at time 0 into $dumpvars, and that is the first pixel.
    let (clocks, _) = read(include_bytes!("data/pyvcd.vcd"), &CaptureOptions::default()).unwrap();
    assert_eq!(clocks, recorded());
}

#[test]
fn a_dump_of_sigrok_is_read_by_a_map() {
    let lines: String = (0..8).map(|line| format!(",D{line}={}", line + 3)).collect();
    let map = SignalMap::parse(&format!("PIXCLK=0,HREF=1,VSYNC=2{lines}")).unwrap();
    let options = CaptureOptions { wanted: Wanted { map, ..Wanted::default() }, ..CaptureOptions::default() };
    let (clocks, _) = read(include_bytes!("data/sigrok.vcd"), &options).unwrap();
    assert_eq!(clocks, recorded());
    let unnamed = read(include_bytes!("data/sigrok.vcd"), &CaptureOptions::default()).unwrap_err();
    assert!(unnamed.to_string().contains("--map PCLK="), "{unnamed}");
}
