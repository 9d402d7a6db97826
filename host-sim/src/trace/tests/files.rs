//! Files: written whole, told apart by content, named in errors.

use super::*;

fn options(bus_bits: u8) -> TraceWriterOptions {
    TraceWriterOptions {
        vcd: VcdWriterOptions::new(bus_bits, 27_648_000),
        vsync_active: true,
        profile: "[bus]\nbits = 8\n".to_owned(),
    }
}

fn play(trace: &Trace) -> Vec<Clock> {
    let mut clocks = Clocks::default();
    let mut done = 0;
    let played = trace.play(&mut clocks, &mut |bytes| done = bytes).unwrap();
    assert_eq!(played.clocks, clocks.0.len() as u64);
    assert!(done <= trace.info().file_bytes && done > 0);
    clocks.0
}

#[test]
fn files_of_either_format_are_written_whole_and_told_apart_by_content() {
    let folder = tempfile::tempdir().unwrap();
    let sent = marker(200, 30, 3);
    for (name, format) in [
        ("a.camt", Format::Camt),
        ("b.VCD", Format::Vcd),
        ("c.sr", Format::Sr),
        ("d.csv", Format::SaleaeCsv),
        ("e.fst", Format::Fst),
    ] {
        let path = folder.path().join(name);
        let mut writer = create(&path, &options(8)).unwrap();
        send(&sent, &mut writer).unwrap();
        assert!(!path.exists());
        let created = writer.finish().unwrap();
        assert_eq!((created.clocks, created.bytes), (sent.len() as u64, path.metadata().unwrap().len()));
        // The name does not matter for reading.
        let renamed = path.with_extension("trace");
        std::fs::rename(&path, &renamed).unwrap();
        let trace = open(&renamed, &CaptureOptions::default()).unwrap();
        let info = trace.info().clone();
        assert_eq!((info.format, info.bus_bits, info.matched.is_some()), (format, 8, format != Format::Camt));
        assert!(info.pclk_hz.unwrap().abs_diff(27_648_000) < 100);
        assert_eq!(info.profile.is_some(), format == Format::Camt);
        assert!(play(&trace) == sent);
        assert!(play(&trace) == sent, "played twice");
        let mut tail = Clocks::default();
        match trace.play_from(2, &mut tail, &mut |_| ()) {
            Ok(played) => {
                assert!(tail.0 == sent[2 * 200 * 30..] && played.clocks == tail.0.len() as u64);
            }
            Err(error) => assert!(
                matches!(error, PlayError::Trace(TraceError::NoIndex { .. })) && format != Format::Camt
            ),
        }
    }
    // A writer that is dropped leaves nothing.
    drop(create(folder.path().join("c.camt"), &options(8)).unwrap());
    drop(create(folder.path().join("c.saleae"), &options(8)).unwrap());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 5);
}

#[test]
fn files_that_cannot_be_opened_or_made_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, bytes: &[u8]| -> PathBuf {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let usual = CaptureOptions::default();
    for (path, expected) in [
        (folder.path().join("none.vcd"), "none.vcd"),
        (folder.path().to_owned(), "a folder without digital.csv"),
        (put("empty.vcd", b""), "neither a .camt trace"),
        (put("picture.png", b"\x89PNG\r\n\x1a\n"), "picture.png: neither"),
        (put("short.camt", b"CAMT"), "short.camt: byte 0: the file ends here"),
        (
            put("short.vcd", b"\n $timescale 1 ns"),
            "short.vcd: line 2 (byte 17): the file ends inside `$timescale`",
        ),
        (
            put("other.vcd", b"$var wire 1 ! clk $end $enddefinitions $end #0"),
            "other.vcd: no signal is called PCLK",
        ),
    ] {
        let error = open(&path, &usual).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let no_format = create(folder.path().join("a.txt"), &options(8)).unwrap_err();
    assert!(no_format.to_string().contains("end in .camt, .vcd"));
    let no_folder = create(folder.path().join("no/where.vcd"), &options(8)).unwrap_err();
    assert!(no_folder.to_string().contains("where.vcd: cannot be written"));
    for name in ["a.camt", "a.vcd", "a.sr", "a.fst", "a.csv", "a.saleae"] {
        assert!(create(folder.path().join(name), &options(9)).unwrap_err().to_string().contains("9 bits"));
        let mut writer = create(folder.path().join(name), &options(8)).unwrap();
        let wide = writer.stretch(Sync::default(), Samples::Words(&[256])).unwrap_err();
        assert!(wide.to_string().contains("0x100"), "{wide}");
    }
}

#[test]
fn a_folder_of_binary_files_is_written_whole_and_read_by_channel_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let sent = marker(200, 30, 3);
    let path = folder.path().join("capture.saleae");
    let mut writer = create(&path, &options(8)).unwrap();
    send(&sent, &mut writer).unwrap();
    assert!(!path.exists());
    let created = writer.finish().unwrap();
    assert_eq!((created.clocks, path.read_dir().unwrap().count()), (sent.len() as u64, 11));
    let lines: Vec<String> = (0..8).map(|line| format!("D{line}=CH{}", line + 3)).collect();
    let map = SignalMap::parse(&format!("PCLK=CH0,HSYNC=CH1,VSYNC=digital_2,{}", lines.join(","))).unwrap();
    let options = CaptureOptions { wanted: Wanted { map, ..Wanted::default() }, ..CaptureOptions::default() };
    // The folder, and any file of it.
    for path in [path.clone(), path.join("digital_10.bin")] {
        let trace = open(&path, &options).unwrap();
        assert_eq!((trace.info().format, trace.info().file_bytes), (Format::SaleaeBinary, created.bytes));
        assert!(play(&trace) == sent);
    }
    // A folder with something in it is not replaced.
    let error = create(&path, &self::options(8)).unwrap().finish().unwrap_err();
    assert!(error.to_string().contains("capture.saleae: cannot be written"), "{error}");
    assert!(path.join("digital_0.bin").exists());
}

#[test]
fn a_capture_shows_the_levels_of_any_channels_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let sent = marker(20, 3, 2);
    for name in ["a.camt", "a.vcd", "a.sr", "a.fst", "a.csv", "a.saleae"] {
        let path = folder.path().join(name);
        let mut writer = create(&path, &options(8)).unwrap();
        send(&sent, &mut writer).unwrap();
        writer.finish().unwrap();
        let capture = Capture::open(&path).unwrap();
        let find = |wanted: &str, number: usize| {
            let found = capture.channels().iter().position(|channel| channel.name.ends_with(wanted));
            found.unwrap_or(number)
        };
        let channels = [find("PCLK", 0), find("HSYNC", 1), find("D7", 10)];
        let levels = capture.beginning(&channels, 1 << 20).unwrap();
        // The levels at the rising edges are what was sent.
        let mut seen = Vec::new();
        for pair in levels.states.windows(2) {
            if pair[1] & !pair[0] & 1 == 1 {
                seen.push((pair[1] & 2 != 0, pair[1] & 4 != 0));
            }
        }
        let expected: Vec<_> = sent.iter().map(|clock| (clock.0, clock.2 >> 7 & 1 == 1)).collect();
        assert!(seen == expected, "{name}: {} edges", seen.len());
        let rises: Vec<u64> = levels
            .times
            .iter()
            .zip(&levels.states)
            .filter(|(_, state)| *state & 1 == 1)
            .map(|(time, _)| *time)
            .collect();
        let period = (rises[rises.len() - 1] - rises[0]) as f64 / capture.ticks_per_second().unwrap();
        assert!((period * 27_648_000.0 / (sent.len() - 1) as f64 - 1.0).abs() < 0.02, "{name}");
        assert!(matches!(capture.beginning(&[99], 1), Err(TraceError::Channels { .. })));
    }
}
