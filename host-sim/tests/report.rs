//! The report of `diagnose`: what stands in the file is what the trace and the frames hold.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn host_sim(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_host-sim")).current_dir(folder).args(arguments).output().unwrap()
}

/// The numbers of a report.
fn numbers(path: &Path) -> Value {
    let html = std::fs::read_to_string(path).unwrap();
    let (_, rest) = html.split_once("<script type=\"application/json\" id=\"numbers\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

/// The sample at a pixel clock, if the report shows it.
fn sample(report: &Value, clock: u64) -> Option<u64> {
    let digits = report["bus"]["bits"].as_u64().unwrap().div_ceil(4);
    report["waves"].as_array().unwrap().iter().find_map(|wave| {
        let place = (clock.checked_sub(wave["start"].as_u64().unwrap())? * digits) as usize;
        let text = wave["samples"].as_str().unwrap().get(place..place + digits as usize)?;
        u64::from_str_radix(text, 16).ok()
    })
}

/// Every row of every picture begins, in the waveform, with the bytes that the frame has there.
#[test]
fn rows_and_waveforms_are_of_one_trace() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| host_sim(folder.path(), arguments);
    for (profile, fault) in [
        ("ov7670-qvga-yuv422", "short-line:count=3,samples=6"),
        ("ov7670-qvga-yuv422", "missing-clock:count=5"),
        ("vga-rgb888", "long-line:count=2,samples=9"),
        ("vga-raw10", "stuck-bit:bit=3,level=low"),
        ("bt656-vga-yuv422", "clock-glitch:count=2"),
    ] {
        run(&["generate", "--scene", "demo", "--profile", profile, "--frames", "3", "-o", "a.camt"]);
        run(&["inject", "a.camt", "--fault", fault, "--seed", "5", "-o", "b.camt"]);
        let told = run(&["diagnose", "b.camt", "--report", "r.html", "--json"]);
        assert_eq!(told.status.code(), Some(1), "{fault}: {}", String::from_utf8_lossy(&told.stderr));
        let told: Value = serde_json::from_slice(&told.stdout).unwrap();
        assert_eq!(told["report"], "r.html");
        run(&["replay", "b.camt", "--out", "frames"]);
        let report = numbers(&folder.path().join("r.html"));
        for key in ["findings", "ambiguous_with", "place", "measured"] {
            assert_eq!(report["diagnosis"][key], told[key]);
        }
        let wide = report["bus"]["bits"].as_u64().unwrap() > 8;
        let line = report["bus"]["samples_per_line"].as_u64().unwrap() as usize;
        let mut compared = 0;
        for frame in report["frames"].as_array().unwrap().iter().filter(|frame| !frame["picture"].is_null()) {
            let raw = format!("frames/frame-{:04}.raw", frame["sequence"].as_u64().unwrap());
            let raw = std::fs::read(folder.path().join(raw)).unwrap();
            for (row, clock) in frame["row_clocks"].as_array().unwrap().iter().enumerate() {
                let Some(clock) = clock.as_u64() else { continue };
                for ahead in [0, 1, 7] {
                    let at = row * line + ahead;
                    let byte = |place: usize| raw.get(place).map(|byte| u64::from(*byte));
                    let value = if wide {
                        byte(2 * at).zip(byte(2 * at + 1)).map(|(low, high)| low | high << 8)
                    } else {
                        byte(at)
                    };
                    // A line that is too long goes on beyond what the driver made room for.
                    let Some(value) = value else { continue };
                    let shown = sample(&report, clock + ahead as u64);
                    let whole = frame["verdict"] == "good" || ahead == 0;
                    assert!(
                        !whole || shown == Some(value),
                        "{profile} {fault}: row {row} at {clock} + {ahead}: {shown:?}, not {value}"
                    );
                    compared += 1;
                }
            }
        }
        assert!(compared > 1_000, "{profile} {fault}: {compared}");
        let place = &report["places"][0];
        assert!(sample(&report, place["clock"].as_u64().unwrap()).is_some(), "the finding has its waveform");
        std::fs::remove_dir_all(folder.path().join("frames")).unwrap();
    }
}

#[test]
fn fifo_and_dma_are_those_of_the_bus() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| host_sim(folder.path(), arguments);
    run(&["generate", "--scene", "demo", "--profile", "vga-rgb888-gated", "--frames", "2", "-o", "a.camt"]);
    for (latency, overruns) in [("0", 0), ("60", 1)] {
        let told = run(&["diagnose", "a.camt", "--report", "r.html", "--bus-latency", latency]);
        assert_eq!(
            told.status.code(),
            Some(0),
            "the trace is good: {}",
            String::from_utf8_lossy(&told.stderr)
        );
        let replayed = run(&["replay", "a.camt", "--bus-latency", latency, "--json"]);
        let replayed: Value = serde_json::from_slice(&replayed.stdout).unwrap();
        let report = numbers(&folder.path().join("r.html"));
        let buckets = report["activity"]["buckets"].as_array().unwrap();
        let sum = |key: &str| buckets.iter().map(|bucket| bucket[key].as_u64().unwrap()).sum::<u64>();
        assert_eq!(sum("clocks"), replayed["pclk"].as_u64().unwrap());
        assert_eq!(sum("overruns"), replayed["overruns"].as_u64().unwrap());
        assert!(sum("overruns") >= overruns);
        let most = buckets.iter().map(|bucket| bucket["most"].as_u64().unwrap()).max().unwrap();
        assert!(most <= report["fifo_words"].as_u64().unwrap() && most > 0);
        let crc = |frame: &Value| frame["crc32"].clone();
        let frames =
            |report: &Value| -> Vec<Value> { report["frames"].as_array().unwrap().iter().map(crc).collect() };
        assert_eq!(frames(&report), frames(&replayed), "watching changes nothing");
    }
}

#[test]
fn without_a_profile_the_bus_is_guessed_and_its_rivals_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| host_sim(folder.path(), arguments);
    run(&["generate", "--scene", "demo", "--profile", "ov7670-qvga-yuv422", "--frames", "2", "-o", "a.vcd"]);
    let told = run(&["diagnose", "a.vcd", "--report", "r.html", "--junit", "j.xml"]);
    let said = String::from_utf8_lossy(&told.stderr);
    assert_eq!(told.status.code(), Some(0), "{said}");
    assert!(said.contains("guessed yuyv 320×240"), "{said}");
    let report = numbers(&folder.path().join("r.html"));
    let by: Vec<&str> =
        report["rivals"].as_array().unwrap().iter().map(|rival| rival["by"].as_str().unwrap()).collect();
    assert_eq!(by[0], "given");
    assert!(by.iter().filter(|by| **by == "guess").count() >= 1, "{by:?}");
    assert!(report["rivals"][0]["about"].as_str().unwrap().contains("guessed"));
    assert!(std::fs::read_to_string(folder.path().join("j.xml")).unwrap().contains("failures=\"0\""));
}

/// Words lost on their way into memory are shown at the clock at which they passed the wires.
#[test]
fn a_frame_received_is_compared_with_the_trace() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| host_sim(folder.path(), arguments);
    run(&["generate", "--scene", "demo", "--profile", "vga-raw10", "--frames", "3", "-o", "a.camt"]);
    run(&["replay", "a.camt", "--out", "frames"]);
    let mut bytes = std::fs::read(folder.path().join("frames/frame-0001.raw")).unwrap();
    let lost = 100 * 1_280 + 640;
    bytes.drain(lost..lost + 64);
    bytes.extend([0; 64]);
    std::fs::write(folder.path().join("torn.raw"), bytes).unwrap();
    let told = run(&["diagnose", "a.camt", "--received", "torn.raw", "--report", "r.html"]);
    assert_eq!(told.status.code(), Some(1), "{}", String::from_utf8_lossy(&told.stderr));
    let report = numbers(&folder.path().join("r.html"));
    assert_eq!(report["diagnosis"]["place"], "receiver");
    let place = &report["places"][0];
    assert_eq!((&place["frame"], &place["row"]), (&Value::from(1), &Value::from(100)));
    let start = report["frames"][1]["row_clocks"][100].as_u64().unwrap();
    assert_eq!(place["clock"].as_u64(), Some(start + 320), "half a line on");
    let counted = report["diagnosis"]["findings"][0]["at_pclk"].as_u64().unwrap();
    assert!(
        counted.abs_diff(start + 320) < 32,
        "counted back from the frame's end: {counted}, not {}",
        start + 320
    );
    let names: Vec<&str> =
        report["rivals"].as_array().unwrap().iter().map(|rival| rival["by"].as_str().unwrap()).collect();
    assert_eq!(names.iter().filter(|by| **by == "received").count(), 2, "{names:?}");
}

/// A fault in a late frame has the picture of that frame.
#[test]
fn the_frame_of_a_finding_is_kept_however_late_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| host_sim(folder.path(), arguments);
    let small = "[bus]\nsync = \"gated\"\n[frame]\nwidth = 64\nheight = 48\nformat = \"gray8\"\n[timing]\nhblank = 16\nvblank = 400\n\
                 vfront = 40\nvback = 40\n";
    std::fs::write(folder.path().join("small.toml"), small).unwrap();
    run(&["generate", "--scene", "demo", "--profile", "small.toml", "--frames", "30", "-o", "a.vcd"]);
    // Two edges of HSYNC in a late frame are taken out: two lines become one.
    let dump = std::fs::read_to_string(folder.path().join("a.vcd")).unwrap();
    let wire =
        dump.lines().find(|line| line.contains("HSYNC")).unwrap().split(' ').nth(3).unwrap().to_owned();
    let is_edge = |line: &str| line == format!("0{wire}") || line == format!("1{wire}");
    let edges = dump.lines().filter(|line| is_edge(line)).count();
    let first = edges * 9 / 10;
    let mut seen = 0;
    let kept = dump.lines().filter(|line| {
        seen += usize::from(is_edge(line));
        !(is_edge(line) && (first..first + 2).contains(&seen))
    });
    let broken: String = kept.flat_map(|line| [line, "\n"]).collect();
    std::fs::write(folder.path().join("b.vcd"), broken).unwrap();
    let told = run(&["diagnose", "b.vcd", "--profile", "small.toml", "--report", "r.html"]);
    assert_eq!(told.status.code(), Some(1), "{}", String::from_utf8_lossy(&told.stderr));
    let report = numbers(&folder.path().join("r.html"));
    assert_eq!(report["frames"].as_array().unwrap().len(), 30);
    let place = &report["places"][0];
    assert!(place["frame"].as_u64().unwrap() > 20, "{place}");
    let frame = &report["frames"][place["frame"].as_u64().unwrap() as usize];
    assert!(!frame["picture"].is_null() && !place["row"].is_null(), "{place}");
}

#[test]
fn a_report_that_cannot_be_written_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| host_sim(folder.path(), arguments);
    run(&["generate", "--scene", "bars", "--profile", "ov7670-qvga-yuv422", "-o", "a.camt"]);
    let told = run(&["diagnose", "a.camt", "--report", "nowhere/r.html"]);
    assert_eq!(told.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&told.stderr).contains("nowhere/r.html: "));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}
