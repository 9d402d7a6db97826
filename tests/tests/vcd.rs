//! Captures that another crate wrote, through everything that `host-sim replay` does with them.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use firmware::camif::Bus;
use firmware::driver::verdict::Outcome;
use host_sim::profile::Profile;
use host_sim::receiver::{Source, capture_config, receive};
use host_sim::trace::SignalMap;
use vcd::{IdCode, SimulationCommand, TimescaleUnit, Value};

/// The levels at an active edge: HREF, VSYNC, D7…D0.
type Clock = (bool, bool, u8);

/// When the wires change.
#[derive(Clone, Copy, Debug)]
enum Timing {
    /// With the falling edge, half a period before they are sampled.
    OppositeEdge,
    /// In the time stamp of the rising edge, written behind it.
    WithEdge,
}

/// A frame of which no two lines are equal.
fn frame(profile: &Profile) -> Vec<u8> {
    let mut seed = 0x9E37_79B9_u32;
    let byte = |_| {
        seed ^= seed << 13;
        seed ^= seed >> 17;
        seed ^= seed << 5;
        (seed >> 11) as u8
    };
    (0..profile.bytes_per_frame()).map(byte).collect()
}

/// HREF and VSYNC pulse with the first byte of what follows a line or frame.
fn marker(profile: &Profile, bytes: &[u8]) -> Vec<Clock> {
    let line = profile.samples_per_line() as usize;
    let mut clocks: Vec<Clock> =
        (0..).zip(bytes).map(|(n, &byte)| (n > 0 && n % line == 0, false, byte)).collect();
    clocks.push((true, true, 0));
    clocks
}

/// HREF is high while data is valid, though the profile says `hsync_blank = "high"`; VSYNC is high between frames.
fn gated(profile: &Profile, bytes: &[u8]) -> Vec<Clock> {
    let blank = |clocks: u32, vsync| (0..clocks).map(move |_| (false, vsync, 0xAA));
    let mut clocks: Vec<Clock> = blank(profile.timing.vblank / 2, true).collect();
    for line in bytes.chunks(profile.samples_per_line() as usize) {
        clocks.extend(blank(profile.timing.hblank / 2, false));
        clocks.extend(line.iter().map(|&byte| (true, false, byte)));
        clocks.extend(blank(profile.timing.hblank / 2, false));
    }
    clocks.extend(blank(profile.timing.vblank / 2, true));
    clocks
}

/// Writes the clocks with the `vcd` crate: a wire a bit, only changes.
fn write(path: &Path, clocks: &[Clock], timing: Timing, hertz: u32) -> io::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    let mut writer = vcd::Writer::new(&mut out);
    writer.timescale(1, TimescaleUnit::PS)?;
    writer.add_module("camera")?;
    let pclk = writer.add_wire(1, "PCLK")?;
    // Not in the order of the wires, nor next to each other.
    let mut data = Vec::new();
    for line in 0..8 {
        data.push(writer.add_wire(1, &format!("D{line}"))?);
        writer.add_wire(1, &format!("unused{line}"))?;
    }
    let vsync = writer.add_wire(1, "VSYNC")?;
    let href = writer.add_wire(1, "HREF")?;
    writer.upscope()?;
    writer.enddefinitions()?;
    let wires: Vec<IdCode> = data.into_iter().chain([href, vsync]).collect();
    let levels = |(href, vsync, byte): Clock| u32::from(byte) | u32::from(href) << 8 | u32::from(vsync) << 9;
    writer.timestamp(0)?;
    writer.begin(SimulationCommand::Dumpvars)?;
    writer.change_scalar(pclk, Value::V0)?;
    for &wire in &wires {
        writer.change_scalar(wire, Value::V0)?;
    }
    writer.end()?;
    let half = 500_000_000_000 / u64::from(hertz);
    let (mut before, mut time) = (0, 0);
    for &clock in clocks {
        let now = levels(clock);
        for rising in [false, true] {
            time += half;
            writer.timestamp(time)?;
            writer.change_scalar(pclk, rising)?;
            if rising == matches!(timing, Timing::WithEdge) {
                for (bit, &wire) in wires.iter().enumerate().filter(|(bit, _)| (now ^ before) >> bit & 1 != 0)
                {
                    writer.change_scalar(wire, now >> bit & 1 != 0)?;
                }
            }
        }
        before = now;
    }
    writer.timestamp(time + half)?;
    io::Write::flush(&mut out)
}

/// What came out of block and driver: the good frames, and the notes for the user.
fn replay(path: &Path, profile: &Profile) -> (Vec<Vec<u8>>, Vec<String>) {
    let source = Source::open(path, Some(profile), SignalMap::default()).unwrap();
    let mut frames = Vec::new();
    let mut take = |frame: host_sim::receiver::Received<'_>| {
        assert_eq!(frame.verdict.outcome, Outcome::Good, "{:?}", frame.verdict);
        frames.extend(frame.bytes.map(<[u8]>::to_vec));
    };
    let play = |receiver: &mut host_sim::receiver::Receiver<'_, '_>| source.play(receiver, &mut |_| ());
    let (played, summary) = receive(&capture_config(source.profile()), Bus::IDEAL, &mut take, play).unwrap();
    assert_eq!(played.unwrap().unknown, 0);
    assert_eq!(summary.unfinished_words, 0);
    (frames, source.notes().to_vec())
}

fn arrives(profile: &Profile, clocks: fn(&Profile, &[u8]) -> Vec<Clock>, timing: Timing) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("capture.vcd");
    let sent = frame(profile);
    write(&path, &clocks(profile, &sent), timing, profile.timing.pclk_hz).unwrap();
    let (frames, notes) = replay(&path, profile);
    assert_eq!(frames.len(), 1, "{timing:?}");
    assert!(frames[0] == sent, "{}, {timing:?}: other bytes than were sent", profile.name);
    notes
}

/// The profile with a frame of a few lines.
fn small(name: &str) -> Profile {
    let mut profile = Profile::built_in(name).unwrap();
    (profile.frame.width, profile.frame.height) = (64, 48);
    profile.timing.vblank = profile.timing.vblank.min(4_000);
    profile.check().unwrap();
    profile
}

#[test]
fn a_vga_frame_with_markers_arrives_byte_by_byte() {
    let profile = Profile::built_in("vga-rgb888").unwrap();
    assert_eq!(arrives(&profile, marker, Timing::OppositeEdge), [""; 0]);
}

#[test]
fn a_vga_frame_gated_by_href_arrives_byte_by_byte() {
    let profile = Profile::built_in("vga-rgb888-gated").unwrap();
    let notes = arrives(&profile, gated, Timing::WithEdge);
    assert!(matches!(&notes[..], [note] if note.contains("HREF") && note.ends_with("inverted")), "{notes:?}");
}

#[test]
fn small_frames_arrive_in_either_timing() {
    for timing in [Timing::OppositeEdge, Timing::WithEdge] {
        assert_eq!(arrives(&small("vga-rgb888"), marker, timing), [""; 0]);
        assert_eq!(arrives(&small("vga-rgb888-gated"), gated, timing).len(), 1);
    }
}
