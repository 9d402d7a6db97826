//! The command line as a user meets it: what it prints, what it writes, how it exits.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// Runs `host-sim` in `folder`.
fn host_sim(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_host-sim")).current_dir(folder).args(arguments).output().unwrap()
}

fn status(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// The one JSON object that stdout holds.
fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&output.stdout)))
}

fn crc32(path: &Path) -> u64 {
    u64::from(host_sim::picture::crc32(&std::fs::read(path).unwrap()))
}

#[test]
fn demo_takes_a_scene_to_verified_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let output = host_sim(folder.path(), &["demo", "--frames", "2"]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    for expected in [
        "frames         2 (2 good)",
        "overruns       0",
        "byte by byte",
        "out/frame-0000.png",
        "out/annotated.png",
        "out/report.html",
    ] {
        assert!(text.contains(expected), "{expected:?} is not in:\n{text}");
    }
    for frame in ["frame-0000", "frame-0001"] {
        let raw = folder.path().join("out").join(frame).with_extension("raw");
        assert_eq!(std::fs::metadata(raw).unwrap().len(), 640 * 480 * 3);
    }
    let frame = image::open(folder.path().join("out/frame-0000.png")).unwrap().into_rgb8();
    for picture in ["balanced", "edges", "quantized", "annotated"] {
        let path = folder.path().join("out").join(picture).with_extension("png");
        let made = image::open(path).unwrap().into_rgb8();
        assert_eq!(made.dimensions(), (640, 480));
        assert_ne!(made, frame, "{picture}");
    }
}

#[test]
fn process_sends_a_picture_through_a_pipeline() {
    let folder = tempfile::tempdir().unwrap();
    let square = |x: u32, y: u32| (10..30).contains(&x) && (8..20).contains(&y);
    let picture =
        image::RgbImage::from_fn(40, 28, |x, y| image::Rgb([if square(x, y) { 250 } else { 5 }; 3]));
    picture.save(folder.path().join("in.png")).unwrap();
    let op = "gray|gaussian:size=5,sigma=1.4|canny:low=50,high=150,norm=l2|flip";
    let output = host_sim(folder.path(), &["process", "in.png", "--op", op, "-o", "out.png", "--timing"]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    assert_eq!(stderr(&output).lines().count(), 5, "a line for each stage, and the sum");
    let edges = image::open(folder.path().join("out.png")).unwrap().into_luma8();
    assert_eq!(edges.dimensions(), (40, 28));
    let lit: Vec<_> = edges.enumerate_pixels().filter(|(_, _, pixel)| pixel.0[0] == 255).collect();
    assert!((40..90).contains(&lit.len()), "the outline of the square: {}", lit.len());
    let near = |at: u32, sides: [u32; 2]| sides.iter().any(|side| at.abs_diff(*side) <= 2);
    assert!(lit.iter().all(|(x, y, _)| near(*x, [10, 29]) || near(*y, [8, 19])), "and nothing else");
    let again = host_sim(folder.path(), &["process", "in.png", "--op", "rgb", "-o", "in.png"]);
    assert_eq!(status(&again), 0);
    assert_eq!(image::open(folder.path().join("in.png")).unwrap().into_rgb8(), picture, "a file onto itself");
}

#[test]
fn replay_sends_frames_through_a_pipeline_too() {
    let folder = tempfile::tempdir().unwrap();
    let generate =
        ["generate", "--scene", "moving", "--profile", "ov7670-qvga-yuv422", "--frames", "2", "-o", "t.camt"];
    assert_eq!(status(&host_sim(folder.path(), &generate)), 0);
    let replay = ["replay", "t.camt", "--op", "scale:50%x50%|sobel", "--out", "out", "--json"];
    let output = host_sim(folder.path(), &replay);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    let report = json(&output);
    for frame in report["frames"].as_array().unwrap() {
        for (key, width) in [("png", 320), ("op_png", 160)] {
            let picture = image::open(folder.path().join(frame[key].as_str().unwrap())).unwrap();
            assert_eq!(picture.width(), width);
        }
    }
    assert!(folder.path().join("out/frame-0001-op.png").exists());
}

#[test]
fn help_on_stages_needs_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, expected) in [
        (&["process", "--op", "help"][..], "floyd-steinberg"),
        (&["process", "--op", "help:canny"], "--op 'gray|canny"),
        (&["replay", "nothing.camt", "--op", "help:gaussian"], "standard deviation"),
    ] {
        let output = host_sim(folder.path(), arguments);
        assert_eq!(status(&output), 0, "{}", stderr(&output));
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains(expected), "{arguments:?}: {text}");
    }
}

#[test]
fn every_profile_goes_through_either_trace_format() {
    let folder = tempfile::tempdir().unwrap();
    for profile in host_sim::profile::built_in_names() {
        for trace in ["trace.camt", "trace.vcd"] {
            // Seven million lines of VCD are for the benchmark: one small profile will do there.
            if trace.ends_with("vcd") && !profile.contains("qvga") {
                continue;
            }
            let output = host_sim(
                folder.path(),
                &["generate", "--scene", "moving", "--profile", profile, "--frames", "2", "-o", trace],
            );
            assert_eq!(status(&output), 0, "{profile}: {}", stderr(&output));
            let output =
                host_sim(folder.path(), &["replay", trace, "--profile", profile, "--json", "--out", "out"]);
            assert_eq!(status(&output), 0, "{profile}: {}", stderr(&output));
            let report = json(&output);
            assert_eq!(report["profile"], profile);
            assert_eq!(report["overruns"], 0);
            let frames = report["frames"].as_array().unwrap();
            assert_eq!(frames.len(), 2, "{profile} as {trace}");
            for frame in frames {
                assert_eq!(frame["verdict"], "good");
                let raw = folder.path().join(frame["raw"].as_str().unwrap());
                assert_eq!(frame["crc32"].as_u64().unwrap(), crc32(&raw));
                let picture = image::open(folder.path().join(frame["png"].as_str().unwrap())).unwrap();
                assert_eq!(u64::from(picture.width()), frame["width"].as_u64().unwrap());
            }
            assert_ne!(frames[0]["crc32"], frames[1]["crc32"], "the scene moves");
        }
    }
}

#[test]
fn json_reports_hold_the_documented_keys() {
    let folder = tempfile::tempdir().unwrap();
    host_sim(
        folder.path(),
        &["generate", "--scene", "bars", "--profile", "ov7670-qvga-yuv422", "-o", "t.camt"],
    );
    let output = host_sim(folder.path(), &["replay", "t.camt", "--json"]);
    let report = json(&output);
    for key in ["trace", "profile", "frames", "overruns", "pclk", "seconds"] {
        assert!(report.get(key).is_some(), "{key}");
    }
    for key in
        ["seq", "width", "height", "format", "lines", "min_line_bytes", "max_line_bytes", "crc32", "verdict"]
    {
        assert!(report["frames"][0].get(key).is_some(), "{key}");
    }
    assert_eq!(report["profile"], "ov7670-qvga-yuv422", "the trace carries its profile");
    assert_eq!(report["frames"][0]["format"], "yuyv");
}

#[test]
fn a_slow_bus_overruns_and_the_exit_status_says_so() {
    let folder = tempfile::tempdir().unwrap();
    host_sim(
        folder.path(),
        &[
            "generate",
            "--scene",
            "moving",
            "--profile",
            "ov7670-qvga-yuv422",
            "--frames",
            "3",
            "-o",
            "t.camt",
        ],
    );
    let slow = ["replay", "t.camt", "--json", "--bus-latency", "0,stall=200/9000,seed=1"];
    let output = host_sim(folder.path(), &slow);
    assert_eq!(status(&output), 1);
    let report = json(&output);
    assert!(report["overruns"].as_u64().unwrap() > 0);
    let frames = report["frames"].as_array().unwrap();
    assert!(frames.iter().any(|frame| frame["verdict"].as_str().unwrap().starts_with("overrun")));
    let again = json(&host_sim(folder.path(), &slow));
    assert_eq!(report["frames"], again["frames"], "the same seed gives the same frames");
}

#[test]
fn a_picture_file_becomes_a_trace() {
    let folder = tempfile::tempdir().unwrap();
    let picture = image::RgbImage::from_fn(640, 480, |x, y| image::Rgb([x as u8, y as u8, (x ^ y) as u8]));
    picture.save(folder.path().join("in.png")).unwrap();
    let output = host_sim(folder.path(), &["generate", "--image", "in.png", "-o", "t.camt", "--json"]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    assert_eq!(json(&output)["pclk"], 921_601, "a frame, and the idle clock that closes it");
    let output = host_sim(folder.path(), &["replay", "t.camt", "--out", "out"]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    assert_eq!(image::open(folder.path().join("out/frame-0000.png")).unwrap().into_rgb8(), picture);
}

#[test]
fn bad_usage_and_input_exit_with_2_and_one_line_that_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("text.txt"), "hello").unwrap();
    std::fs::write(folder.path().join("cut.camt"), b"CAMT").unwrap();
    std::fs::write(folder.path().join("bad.toml"), "[bus]\nbitz = 8\n").unwrap();
    for (arguments, expected) in [
        (&["replay", "nothing.camt"][..], "nothing.camt"),
        (&["replay", "text.txt"], "text.txt"),
        (&["replay", "cut.camt"], "cut.camt"),
        (&["generate", "--scene", "bar", "-o", "t.camt"], "did you mean `bars`"),
        (&["generate", "--scene", "bars", "-o", "t.png"], ".camt, .vcd"),
        (&["generate", "--scene", "bars", "-o", "no/such/folder/t.camt"], "no/such/folder"),
        (&["generate", "--scene", "bars", "--profile", "vga-rgb88", "-o", "t.camt"], "vga-rgb888"),
        (&["generate", "--scene", "bars", "--profile", "bad.toml", "-o", "t.camt"], "bits"),
        (&["replay", "cut.camt", "--bus-latency", "soon"], "soon"),
        (&["replay", "cut.camt", "--map", "PCKL=CH0"], "PCLK"),
        (&["replay", "cut.camt", "--op", "gray"], "--out DIR"),
        (&["replay", "cut.camt", "--out", "o", "--op", "gray|cany"], "did you mean `canny`"),
        (&["process", "in.png", "--op", "canny:lwo=3", "-o", "o.png"], "did you mean `low`"),
        (&["process", "in.png", "--op", "canny:norm=l3", "-o", "o.png"], "did you mean `l1`"),
        (&["process", "in.png", "--op", "gray", "-o", "o.png"], "in.png"),
        (&["process", "in.png", "--op", "gray", "-o", "o.jpg"], ".png"),
        (&["process", "in.png", "--op", "gray"], "-o IMAGE"),
        (&["process", "--op", "gray", "-o", "o.png"], "no picture"),
        (&["process", "text.txt", "--op", "gray", "-o", "o.png"], "text.txt"),
        (&["process", "--op", "help:cany"], "did you mean `canny`"),
    ] {
        let output = host_sim(folder.path(), arguments);
        assert_eq!(status(&output), 2, "{arguments:?}");
        assert!(output.stdout.is_empty());
        let text = stderr(&output);
        assert!(text.contains(expected), "{arguments:?}: {text}");
        assert_eq!(text.lines().count(), 1, "{arguments:?}: {text}");
    }
    let usage = host_sim(folder.path(), &["generate", "--frames", "0", "--scene", "bars", "-o", "t.camt"]);
    assert_eq!(status(&usage), 2);
    assert!(!folder.path().join("t.camt").exists(), "nothing half-written");
}

#[test]
fn inject_breaks_a_trace_the_same_way_again() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| host_sim(folder.path(), arguments);
    run(&["generate", "--scene", "demo", "--profile", "ov7670-qvga-yuv422", "--frames", "2", "-o", "a.camt"]);
    for name in ["b.camt", "c.camt", "d.vcd"] {
        let output =
            run(&["inject", "a.camt", "--fault", "missing-clock", "--seed", "3", "-o", name, "--json"]);
        assert_eq!(status(&output), 0, "{}", stderr(&output));
        let report = json(&output);
        assert!(report["faults"][0].as_str().unwrap().starts_with("missing-clock:count="), "{report}");
    }
    assert_eq!(crc32(&folder.path().join("b.camt")), crc32(&folder.path().join("c.camt")));
    assert_ne!(crc32(&folder.path().join("a.camt")), crc32(&folder.path().join("b.camt")));
    assert_eq!(status(&run(&["replay", "b.camt"])), 1, "its frames are short");

    let error = stderr(&run(&["inject", "a.camt", "--fault", "mising-clock", "-o", "e.camt"]));
    assert!(error.contains("did you mean `missing-clock`?"), "{error}");
    let help = run(&["inject", "--fault", "help"]);
    assert!(String::from_utf8(help.stdout).unwrap().contains("vsync-in-frame"));
    assert!(!folder.path().join("e.camt").exists());
}

#[test]
fn a_virtual_sensor_is_brought_up_and_a_wrong_register_shows() {
    let folder = tempfile::tempdir().unwrap();
    let sensor = ["generate", "--scene", "bars", "--sensor", "ov7670", "--mode", "qvga-rgb565"];
    let run = |more: &[&str]| host_sim(folder.path(), &[&sensor[..], more].concat());
    let replayed = |trace: &str, folder_out: &str| {
        let output = host_sim(folder.path(), &["replay", trace, "--json", "--out", folder_out]);
        (status(&output), json(&output))
    };
    let output = run(&["-o", "good.camt"]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    let (code, good) = replayed("good.camt", "good");
    assert_eq!(code, 0);
    assert_eq!(good["frames"][0]["width"], 320);
    assert_eq!(good["frames"][0]["verdict"], "good");
    // RGB555 instead of RGB565: as many bytes, other colours.
    let output = run(&["--set", "0x40=0xF0", "-o", "555.camt"]);
    assert!(stderr(&output).contains("the sensor sends rgb555"), "{}", stderr(&output));
    let (code, wrong) = replayed("555.camt", "wrong");
    assert_eq!(code, 0);
    assert_ne!(wrong["frames"][0]["crc32"], good["frames"][0]["crc32"]);
    // A window that VSTOP closes above VSTRT.
    let output = run(&["--set", "0x1A=0x01", "-o", "none.camt"]);
    assert_eq!(status(&output), 2);
    assert!(stderr(&output).contains("VSTOP is above VSTRT"), "{}", stderr(&output));
    assert!(!folder.path().join("none.camt").exists());
    let output =
        host_sim(folder.path(), &["generate", "--scene", "bars", "--sensor", "ov7760", "-o", "x.camt"]);
    assert_eq!(status(&output), 2);
    assert!(stderr(&output).contains("did you mean `ov7670`?"), "{}", stderr(&output));
}

#[test]
fn diagnose_names_the_planted_fault_and_mends_it() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| host_sim(folder.path(), arguments);
    run(&["generate", "--scene", "demo", "--profile", "ov7670-qvga-yuv422", "--frames", "2", "-o", "a.camt"]);
    let clean = run(&["diagnose", "a.camt", "--json"]);
    assert_eq!(status(&clean), 0, "{}", stderr(&clean));
    assert_eq!(json(&clean)["findings"], Value::Array(Vec::new()));

    for (fault, name) in [
        ("stuck-bit:bit=5,level=low", "stuck-bit"),
        ("swapped-bits:a=2,b=6", "swapped-bits"),
        ("inverted-hsync", "inverted-hsync"),
        ("short-line:count=3,samples=6", "short-line"),
    ] {
        // What an analyser would export.
        run(&["inject", "a.camt", "--fault", fault, "-o", "b.vcd"]);
        let profile = ["--profile", "ov7670-qvga-yuv422"];
        let output = run(&["diagnose", "b.vcd", profile[0], profile[1], "--json", "--fix", "fixed"]);
        assert_eq!(status(&output), 1, "{fault}: {}", stderr(&output));
        assert_eq!(json(&output)["findings"][0]["fault"], name, "{}", json(&output));
    }
    run(&["inject", "a.camt", "--fault", "inverted-hsync", "-o", "b.camt"]);
    run(&["diagnose", "b.camt", "--fix", "fixed"]);
    let fixed = run(&["diagnose", "b.camt", "--profile", "fixed/profile.toml"]);
    assert_eq!(status(&fixed), 0, "the corrected profile fits");
    assert!(folder.path().join("fixed/after.png").exists());

    run(&["replay", "a.camt", "--out", "frames"]);
    let good = run(&["diagnose", "a.camt", "--received", "frames/frame-0001.raw"]);
    assert_eq!(status(&good), 0, "{}", stderr(&good));
    let mut bytes = std::fs::read(folder.path().join("frames/frame-0001.raw")).unwrap();
    bytes.drain(6_400..6_432);
    bytes.extend([0; 32]);
    std::fs::write(folder.path().join("torn.raw"), bytes).unwrap();
    let torn = run(&["diagnose", "a.camt", "--received", "torn.raw", "--json"]);
    assert_eq!(status(&torn), 1);
    assert_eq!(json(&torn)["place"], "receiver");
    assert_eq!(json(&torn)["findings"][0]["line"], 10);
}

#[test]
fn a_trace_without_a_profile_is_guessed_and_replays_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    for profile in ["ov7670-qvga-yuv422", "vga-raw10"] {
        let generate = ["generate", "--scene", "demo", "--profile", profile, "--frames", "2", "-o", "t.camt"];
        assert_eq!(status(&host_sim(folder.path(), &generate)), 0);
        let guess = ["guess", "t.camt", "--json", "--out", "g", "--profile-out", "guessed.toml"];
        let output = host_sim(folder.path(), &guess);
        assert_eq!(status(&output), 0, "{}", stderr(&output));
        let answer = json(&output);
        assert!(answer["formats"][0]["confidence"].as_f64().unwrap() > 0.4, "{answer}");
        assert!(image::open(folder.path().join("g/guess.png")).unwrap().width() > 640);
        let crcs = |profile: &str| -> Vec<Value> {
            let output = host_sim(folder.path(), &["replay", "t.camt", "--profile", profile, "--json"]);
            assert_eq!(status(&output), 0, "{profile}: {}", stderr(&output));
            json(&output)["frames"].as_array().unwrap().iter().map(|frame| frame["crc32"].clone()).collect()
        };
        let known = crcs(profile);
        assert_eq!(known.len(), 2);
        assert_eq!(crcs("guessed.toml"), known);
        assert_eq!(crcs("auto"), known);
    }
    let vcd = ["generate", "--scene", "bars", "--profile", "ov7670-qvga-yuv422", "-o", "t.vcd"];
    assert_eq!(status(&host_sim(folder.path(), &vcd)), 0);
    let output = host_sim(folder.path(), &["replay", "t.vcd", "--json"]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    assert!(stderr(&output).contains("guessed yuyv 320×240"), "{}", stderr(&output));
}

/// `host-sim process --op help | head -n 1`, with a reader that leaves at once.
#[cfg(unix)]
#[test]
fn a_reader_that_leaves_is_no_panic() {
    use std::process::Stdio;
    // The reader is gone before the program starts: whoever is faster, the first write meets a closed pipe.
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .args(["process", "--op", "help"])
        .stdout(writer)
        .stderr(Stdio::piped())
        .output()
        .unwrap();
    assert_eq!((output.status.code(), stderr(&output).as_str()), (None, ""));
}

#[test]
fn a_trace_is_broken_alike_when_it_is_made_later_or_as_it_is_played() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &str| {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        host_sim(folder.path(), &arguments)
    };
    let fault = "--fault missing-clock --fault stuck-bit --seed 3";
    assert!(run("generate --scene bars --profile vga-gray8 -o good.camt").status.success());
    let made = run(&format!("generate --scene bars --profile vga-gray8 {fault} -o made.camt"));
    assert!(made.status.success(), "{}", stderr(&made));
    assert!(stderr(&made).contains("stuck-bit:"), "what was drawn is said: {}", stderr(&made));
    assert!(run(&format!("inject good.camt {fault} -o later.camt")).status.success());
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert!(read("made.camt") == read("later.camt"));
    assert!(read("made.camt") != read("good.camt"));
    let played = json(&run(&format!("replay good.camt {fault} --json")));
    assert_eq!(played["frames"], json(&run("replay made.camt --json"))["frames"]);
    assert_ne!(played["frames"], json(&run("replay good.camt --json"))["frames"]);
}
