//! `host-sim stream` as a host sees it: over TCP and over a pseudo-terminal, quiet and noisy, commanded.
#![cfg(unix)]

mod host;

use std::io::{BufRead as _, BufReader};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use firmware::link::packet::{State, Status};
use firmware::link::{Choice, Encoding, Format, Request, Resend};
use host::{Event, Frame, HEIGHT, Host, WIDTH, play};
use host_sim::picture::crc32_after;
use host_sim::pipeline::{Picture, Pipeline, Runner};
use host_sim::profile::Profile;
use host_sim::scene::Scene;
use host_sim::stream::STREAMS;

/// The pixels that a stream must carry of a scene's frame.
fn expected(scene: &Scene, sequence: u32, stream: usize) -> Picture {
    let picture = Picture::from_image(&scene.render(sequence.into(), WIDTH, HEIGHT));
    let pipeline = STREAMS[stream].1;
    if pipeline.is_empty() {
        return picture;
    }
    let pipeline: Pipeline = pipeline.parse().unwrap();
    Runner::new(&pipeline).run(picture).unwrap()
}

fn bytes_of(picture: Picture) -> Vec<u8> {
    match picture {
        Picture::Gray(frame) => frame.pixels().to_vec(),
        rgb @ Picture::Rgb(_) => rgb.into_image().into_raw(),
    }
}

/// All three streams of one frame are what the scene gives, exactly.
fn see_a_frame(host: &mut Host, scene: &Scene) {
    let hello = host.wait_for("hello", |event| match event {
        Event::Hello { streams, commands, name, .. } => Some((streams, commands, name)),
        _ => None,
    });
    assert_eq!((hello.0, hello.1), (3, 0x3FFF));
    assert!(hello.2.starts_with("host-sim "), "{}", hello.2);
    for (number, (name, pipeline)) in STREAMS.iter().enumerate() {
        let format = [Format::RGB888, Format::GRAY8, Format::Index8][number];
        let described =
            host.wait_for("stream", |event| matches!(event, Event::Stream { .. }).then_some(event));
        let size = (WIDTH as u16, HEIGHT as u16);
        let (choice, pipeline) = (Choice::Sender, described_pipeline(pipeline));
        let stream = number as u8;
        let name = (*name).to_owned();
        assert_eq!(described, Event::Stream { stream, format, choice, on: true, size, pipeline, name });
    }
    let mut palettes = Vec::new();
    let mut seen = [false; 3];
    while seen != [true; 3] {
        match host.wait_for("frame", Some) {
            Event::Palette { stream: 2, colors } => palettes.push(colors),
            Event::Frame(frame) => {
                assert!(frame.is_whole() && !frame.snapshot && !frame.repaired, "{:?}", frame.outcome);
                let pixels = if frame.format == Format::Index8 {
                    let named =
                        |colors: &&Vec<[u8; 3]>| crc32_after(0, colors.as_flattened()) == frame.palette;
                    let palette = palettes.iter().find(named).expect("the palette came before its frame");
                    assert!(palette.len() <= 16);
                    frame.pixels.iter().flat_map(|&index| palette[usize::from(index)]).collect()
                } else {
                    frame.pixels
                };
                let stream = usize::from(frame.stream);
                assert!(pixels == bytes_of(expected(scene, frame.sequence, stream)), "stream {stream}");
                seen[stream] = true;
            }
            _ => {}
        }
    }
}

/// A pipeline as it is printed.
fn described_pipeline(text: &str) -> String {
    if text.is_empty() { String::new() } else { text.parse::<Pipeline>().unwrap().to_string() }
}

#[test]
fn frames_over_tcp_are_the_scene() {
    let played = play(&["--tcp", "127.0.0.1:0", "--scene", "demo", "--seed", "3"]);
    assert!(!played.url.ends_with(":0"), "{}", played.url);
    let scene = Scene::Demo { seed: 3 };
    let mut host = Host::connect(&played.url);
    see_a_frame(&mut host, &scene);
    // One that comes back is told all again.
    drop(host);
    std::thread::sleep(Duration::from_millis(200));
    see_a_frame(&mut Host::connect(&played.url), &scene);
}

#[test]
fn frames_over_a_pseudo_terminal_are_the_scene() {
    let played = play(&["--pty", "--scene", "moving"]);
    assert!(played.url.starts_with("/dev/"), "{}", played.url);
    let mut host = Host::connect(&played.url);
    // What was said before the port was set up may be lost.
    host.done(&Request::Hello);
    see_a_frame(&mut host, &Scene::Moving);
}

#[test]
fn commands_have_their_effect() {
    let played = play(&["--tcp", "127.0.0.1:0", "--scene", "bars", "--stopped"]);
    let mut host = Host::connect(&played.url);
    host.log("is up");
    let nothing = host.wait_for("heartbeat", |event| match event {
        Event::Frame(frame) => panic!("frame {} of a device at rest", frame.sequence),
        Event::Heartbeat { state, baud, delivered } => Some((state, baud, delivered)),
        _ => None,
    });
    assert_eq!(nothing, (State::Stopped, 0, 0));
    assert_eq!(host.done(&Request::Ping(b"who is there?")), b"who is there?");

    // Two frames of the raw stream alone.
    assert_eq!(host.done(&Request::Streams(1)), [1, 0, 0, 0]);
    assert_eq!(host.refused(&Request::Streams(8)).0, Status::NoStream);
    host.done(&Request::Snapshot(2));
    let snapshot = [host.frame(0), host.frame(0)];
    assert!(snapshot.iter().all(|frame| frame.snapshot && frame.is_whole()));
    host.done(&Request::Heartbeat);
    let after = host.wait_for("heartbeat", |event| match event {
        Event::Frame(frame) => {
            panic!("frame {} after the snapshot, of stream {}", frame.sequence, frame.stream)
        }
        Event::Heartbeat { state, delivered, .. } => Some((state, delivered)),
        _ => None,
    });
    assert_eq!(after, (State::Stopped, 2));

    // Lines of it once more; they were there already, so the frame does not come again.
    let Frame { sequence, .. } = snapshot[1];
    let lines = Resend { stream: 0, first: 10, sequence, count: 500 };
    assert_eq!(host.done(&Request::Resend(lines)), [HEIGHT as u8 - 10, 0]);
    assert_eq!(host.refused(&Request::Resend(Resend { stream: 1, ..lines })).0, Status::Gone);
    assert_eq!(host.refused(&Request::Resend(Resend { sequence: sequence + 9, ..lines })).0, Status::Gone);
    assert_eq!(
        host.refused(&Request::Resend(Resend { first: HEIGHT as u16, ..lines })).0,
        Status::OutOfRange
    );
    host.done(&Request::Ping(&[]));
    assert_eq!(host.assemblers[0].dropped().doubled, HEIGHT - 10);

    // Another pipeline, in another encoding.
    let edges = "gray|canny:low=20,high=60";
    host.done(&Request::Streams(2));
    let understood = host.done(&Request::Stages(1, edges));
    assert_eq!(&understood[4..], described_pipeline(edges).as_bytes());
    let (status, text) = host.refused(&Request::Stages(1, "gray|cany"));
    assert!(status == Status::OutOfRange && text.contains("canny"), "{text}");
    host.done(&Request::Encoding(Some(1), Choice::One(Encoding::Bits)));
    host.wait_for("stream", |event| match event {
        Event::Stream { stream: 1, choice: Choice::One(Encoding::Bits), on: true, pipeline, .. } => {
            (pipeline == described_pipeline(edges)).then_some(())
        }
        _ => None,
    });
    host.done(&Request::Start);
    let frame = host.frame(1);
    let scene = Picture::from_image(&Scene::Bars.render(0, WIDTH, HEIGHT));
    let pipeline: Pipeline = edges.parse().unwrap();
    assert!(frame.is_whole());
    assert_eq!(frame.pixels, bytes_of(Runner::new(&pipeline).run(scene).unwrap()));

    // A parameter that is seen in the picture.
    host.done(&Request::Streams(1));
    let brightness = (0..).find(|&number| {
        let parameter = host.done(&Request::Get(number));
        parameter[16..].starts_with(b"brightness")
    });
    let brightness = brightness.unwrap();
    let set = host.done(&Request::Set(brightness, 255));
    assert_eq!(set[4..8], 255i32.to_le_bytes());
    assert_eq!(host.refused(&Request::Set(brightness, 256)).0, Status::OutOfRange);
    assert_eq!(host.refused(&Request::Get(brightness + 1)).0, Status::OutOfRange);
    host.wait_for("a white frame", |event| match event {
        Event::Frame(frame) => frame.pixels.iter().all(|&channel| channel == 255).then_some(()),
        _ => None,
    });

    // Registers: the block's are there, the sensor has none.
    let control = host.done(&Request::Read { block: 0, count: 2, offset: 0 });
    assert!(control[8..12] != [0; 4], "capture is enabled: {control:?}");
    host.done(&Request::Write { block: 0, offset: 0, value: 0 });
    assert_eq!(host.done(&Request::Read { block: 0, count: 1, offset: 0 })[8..], [0; 4]);
    assert_eq!(host.refused(&Request::Read { block: 1, count: 1, offset: 0 }).0, Status::Unsupported);
    // The host switched the block off, so no frames come; START after STOP sets it up again.
    host.done(&Request::Stop);
    host.log("stopped");
    host.events.clear();
    host.done(&Request::Start);
    assert!(host.frame(0).is_whole());
}

#[test]
fn what_noise_leaves_is_right_and_commands_get_through() {
    let noise = "bits=2e-5,lost=0.01,dropped=1e-5,inserted=1e-5";
    let played = play(&["--tcp", "127.0.0.1:0", "--seed", "5", "--noise", noise]);
    let scene = Scene::Demo { seed: 5 };
    let mut host = Host::connect(&played.url);
    // Otherwise a stream that was lost would not be known.
    host.done(&Request::Hello);
    let (mut whole, mut torn) = (0, 0);
    while whole < 20 || torn < 20 {
        let frame = host.frame(0);
        let right = bytes_of(expected(&scene, frame.sequence, 0));
        let lines = right.chunks(3 * WIDTH as usize);
        for (number, right) in (0..).zip(lines) {
            assert!(
                frame.line(number).is_none_or(|line| line == right),
                "frame {}, line {number}",
                frame.sequence
            );
        }
        assert_ne!(frame.crc, Some(false));
        if frame.missing.is_empty() { whole += 1 } else { torn += 1 }
    }
    for number in 0..20 {
        assert_eq!(host.done(&Request::Ping(&[number])), [number]);
    }
    assert!(host.inbox.counts().damaged > 0);
    // A quiet line from now on.
    host.done(&Request::Set(1, 0));
}

#[test]
fn lines_that_were_lost_can_be_asked_for() {
    let played = play(&[
        "--tcp",
        "127.0.0.1:0",
        "--seed",
        "8",
        "--noise",
        "lost=0.05",
        "--streams",
        "raw",
        "--stopped",
    ]);
    let scene = Scene::Demo { seed: 8 };
    let mut host = Host::connect(&played.url);
    host.done(&Request::Hello);
    let (mut seen, mut torn) = (0, 0);
    while seen < 5 || torn == 0 {
        host.done(&Request::Snapshot(1));
        // Ended by a FRAME or END that is not lost, soon or by the next snapshot.
        while host.take(Duration::from_millis(300)) {}
        let last = host.events.drain(..).rev().find_map(|event| match event {
            Event::Frame(frame) if frame.outcome.is_some() => Some(frame),
            _ => None,
        });
        let Some(mut frame) = last else { continue };
        let Frame { sequence, .. } = frame;
        seen += 1;
        torn += u32::from(!frame.missing.is_empty());
        let mut rounds = 0;
        while !frame.missing.is_empty() {
            for &first in &frame.missing {
                host.done(&Request::Resend(Resend { stream: 0, first, sequence, count: 1 }));
            }
            // Behind the lines.
            host.done(&Request::Ping(&[]));
            let repaired = host.events.iter().find_map(|event| match event {
                Event::Frame(frame) if frame.repaired => Some(frame.clone()),
                _ => None,
            });
            if let Some(repaired) = repaired {
                frame = repaired;
            }
            rounds += 1;
            assert!(rounds < 50);
        }
        assert_eq!(frame.pixels, bytes_of(expected(&scene, sequence, 0)));
    }
}

#[test]
fn a_line_of_a_given_rate_is_no_faster() {
    let played = play(&["--tcp", "127.0.0.1:0", "--scene", "noise", "--baud", "921600"]);
    let started = Instant::now();
    let mut host = Host::connect(&played.url);
    host.frame(0);
    host.frame(0);
    let most = 92_160.0 * started.elapsed().as_secs_f64();
    assert!((host.bytes as f64) <= most + 1.0, "{} bytes, {most} at most", host.bytes);
    let baud = host.wait_for("heartbeat", |event| match event {
        Event::Heartbeat { baud, .. } => Some(baud),
        _ => None,
    });
    assert_eq!(baud, 921_600);
}

#[test]
fn a_sensor_with_registers_obeys_them() {
    let arguments = [
        "--sensor",
        "mt9v034",
        "--mode",
        "qvga-gray8",
        "--streams",
        "raw",
        "--tcp",
        "127.0.0.1:0",
        "--scene",
        "bars",
    ];
    let played = play(&arguments);
    let mut host = Host::connect(&played.url);
    let before = host.frame(0);
    assert!(before.is_whole());
    // Read mode of context A: columns flipped.
    let mode = host.done(&Request::Read { block: 1, count: 1, offset: 0x0D });
    let mode = u32::from_le_bytes(mode[8..12].try_into().unwrap());
    host.done(&Request::Write { block: 1, offset: 0x0D, value: mode ^ 0x20 });
    let width = usize::from(before.size.0) * before.format.bytes_per_pixel();
    let mut mirrored = before.pixels.clone();
    mirrored.chunks_mut(width).for_each(<[u8]>::reverse);
    assert_ne!(mirrored, before.pixels);
    host.wait_for("a mirrored frame", |event| match event {
        Event::Frame(frame) => (frame.pixels == mirrored).then_some(()),
        _ => None,
    });
}

#[test]
fn a_trace_is_played_over_and_over() {
    let folder = tempfile::tempdir().unwrap();
    let trace = folder.path().join("bars.camt");
    let trace = trace.to_str().unwrap();
    let made = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .args([
            "generate",
            "--scene",
            "bars",
            "--profile",
            "ov7670-qvga-yuv422",
            "--frames",
            "2",
            "-o",
            trace,
        ])
        .output()
        .unwrap();
    assert!(made.status.success());
    let mut child = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .args(["stream", trace, "--tcp", "127.0.0.1:0", "--streams", "raw", "--frames", "5"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut url = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut url).unwrap();
    let mut host = Host::connect(url.trim_end());
    let mut profile = Profile::built_in("ov7670-qvga-yuv422").unwrap();
    profile.name.clear();
    let (width, height) = (profile.frame.width, profile.frame.height);
    let right = host_sim::picture::encode(&Scene::Bars.render(0, width, height), &profile).unwrap();
    let mut good = 0;
    for _ in 0..5 {
        let frame = host.frame(0);
        // Where the trace begins anew a frame may be damaged.
        good += u32::from(frame.is_whole() && frame.pixels == right);
    }
    assert!(good >= 3, "{good} of 5");
    host.log("switched off");
    assert!(child.wait().unwrap().success());
}

#[test]
fn what_can_not_be_played_is_said() {
    let refused = |arguments: &[&str]| {
        let output =
            Command::new(env!("CARGO_BIN_EXE_host-sim")).arg("stream").args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(output.stdout.is_empty());
        String::from_utf8(output.stderr).unwrap()
    };
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap().to_string();
    assert!(refused(&["--tcp", &address]).contains(&address));
    assert!(refused(&["--pty", "--noise", "bits=2"]).contains("`bits=2` is no noise"));
    assert!(refused(&["--pty", "--stages", "edges=gray|cany"]).contains("canny"));
    assert!(refused(&["--pty", "--stages", "edge=gray"]).contains("edges"));
    assert!(refused(&["--pty", "--profile", "vga-rgb565"]).contains("profile"));
    assert!(refused(&["--pty", "--tcp", &address]).contains("cannot be used with"));
    assert!(refused(&[]).contains("--tcp"));
}
