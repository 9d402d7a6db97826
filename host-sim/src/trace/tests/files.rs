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
    for (name, format) in [("a.camt", Format::Camt), ("b.VCD", Format::Vcd)] {
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
        assert_eq!((info.format, info.bus_bits, info.matched.is_some()), (format, 8, format == Format::Vcd));
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
                matches!(error, PlayError::Trace(TraceError::NoIndex { .. })) && format == Format::Vcd
            ),
        }
    }
    // A writer that is dropped leaves nothing.
    drop(create(folder.path().join("c.camt"), &options(8)).unwrap());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
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
        (folder.path().to_owned(), "directory"),
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
    let no_format = create(folder.path().join("a.csv"), &options(8)).unwrap_err();
    assert!(no_format.to_string().contains(".camt or .vcd"));
    let no_folder = create(folder.path().join("no/where.vcd"), &options(8)).unwrap_err();
    assert!(no_folder.to_string().contains("where.vcd: cannot be written"));
    for name in ["a.camt", "a.vcd"] {
        assert!(create(folder.path().join(name), &options(9)).unwrap_err().to_string().contains("9 bits"));
        let mut writer = create(folder.path().join(name), &options(8)).unwrap();
        let wide = writer.stretch(Sync::default(), Samples::Words(&[256])).unwrap_err();
        assert!(wide.to_string().contains("0x100"), "{wide}");
    }
}
