use std::path::Path;

use super::*;
use crate::capture::fake::{Event, Fake};
use crate::capture::{CaptureError, Files};
use crate::pipeline::Pipeline;
use crate::profile::Profile;

const PATIENT: Limits = Limits { frames: None, timeout: Duration::from_millis(40) };

fn run(fake: &mut Fake, limits: Limits, output: Option<&mut Output<'_>>) -> Session {
    capture(fake, limits, output, &AtomicBool::new(false), &mut |_| {})
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|file| file.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn frames_are_counted_and_the_rest_is_a_timeout() {
    let mut fake = Fake::new((0..3).map(Fake::frame));
    let session = run(&mut fake, PATIENT, None);
    assert_eq!((session.statistics.taken, session.statistics.good, session.statistics.bytes), (3, 3, 27));
    let error = session.error.unwrap();
    assert!(matches!(error, CaptureError::Timeout { frames: 3, .. }), "{error}");
    assert!(error.to_string().contains("after 3 frames"), "{error}");
    assert_eq!(fake.buffers(), 70, "all are given back");
}

#[test]
fn a_pause_shorter_than_the_timeout_is_none() {
    let mut fake = Fake::new([Fake::frame(0), Event::Nothing, Fake::frame(1)]);
    let limits = Limits { frames: Some(2), timeout: Duration::from_secs(1) };
    let session = run(&mut fake, limits, None);
    assert!(session.error.is_none() && session.statistics.good == 2);
}

#[test]
fn gaps_damage_and_short_frames_are_counted_and_not_used() {
    let folder = tempfile::tempdir().unwrap();
    let mut fake = Fake::new([
        Fake::frame(u32::MAX - 1),
        Event::Damaged(u32::MAX),
        // A line and its gap, and a line without one, are 9 bytes.
        Event::Frame(0, vec![7; 8]),
        Event::Frame(3, vec![8; 9]),
        Event::Frame(4, vec![9; 10]),
    ]);
    let mut output = Output::new("fake", &fake.opened.format)
        .to_folder(folder.path(), Files { png: true, raw: true })
        .unwrap();
    let session = run(&mut fake, PATIENT, Some(&mut output));
    let got = session.statistics;
    assert_eq!((got.taken, got.good, got.damaged, got.short, got.lost), (5, 3, 1, 1, 2));
    assert!(!got.is_clean());
    let sequences: Vec<u32> = output.written().iter().map(|frame| frame.sequence).collect();
    assert_eq!(sequences, [u32::MAX - 1, 3, 4]);
    assert_eq!(
        files(folder.path()),
        [
            "frame-0000.png",
            "frame-0000.raw",
            "frame-0001.png",
            "frame-0001.raw",
            "frame-0002.png",
            "frame-0002.raw"
        ]
    );
    // Lines without their gaps.
    assert_eq!(std::fs::read(folder.path().join("frame-0001.raw")).unwrap(), [8; 8]);
    let picture = crate::picture::read(&folder.path().join("frame-0002.png")).unwrap();
    assert!(picture.dimensions() == (4, 2) && picture.pixels().all(|pixel| pixel.0 == [9; 3]));
    assert_eq!((got.copied_bytes, got.converted_bytes), (3 * 8, 3 * 24));
}

/// A bad cable: frames without an end, and none that could be used.
#[test]
fn a_device_that_gives_only_damaged_frames_is_given_up() {
    let mut fake = Fake::new([Fake::frame(0), Event::OnlyDamaged]);
    let session = run(&mut fake, Limits { frames: Some(2), ..PATIENT }, None);
    let error = session.error.unwrap();
    assert!(matches!(error, CaptureError::NoneWhole { frames: 2.., damaged: 1.., short: 0, .. }), "{error}");
    assert!(error.to_string().contains("no whole frame for 0.0 s"), "{error}");
    assert_eq!((session.statistics.good, fake.buffers()), (1, 70));
}

#[test]
fn a_frame_without_gaps_is_written_from_the_devices_memory() {
    let folder = tempfile::tempdir().unwrap();
    let mut fake = Fake::new([Event::Frame(0, (0..8).collect())]);
    fake.opened.format.strides = vec![4];
    let mut output = Output::new("fake", &fake.opened.format)
        .to_folder(folder.path(), Files { png: false, raw: true })
        .unwrap();
    let session = run(&mut fake, PATIENT, Some(&mut output));
    assert_eq!((session.statistics.copied_bytes, session.statistics.converted_bytes), (0, 0));
    assert_eq!(std::fs::read(folder.path().join("frame-0000.raw")).unwrap(), [0, 1, 2, 3, 4, 5, 6, 7]);
}

#[test]
fn unplugging_keeps_what_came_before() {
    let folder = tempfile::tempdir().unwrap();
    let mut fake = Fake::new([Fake::frame(0), Fake::frame(1), Event::Unplugged, Fake::frame(2)]);
    let mut output = Output::new("fake", &fake.opened.format)
        .to_folder(folder.path(), Files { png: false, raw: true })
        .unwrap();
    let session = run(&mut fake, PATIENT, Some(&mut output));
    assert!(matches!(session.error, Some(CaptureError::Gone { frames: 2, .. })));
    assert_eq!(files(folder.path()), ["frame-0000.raw", "frame-0001.raw"]);
}

/// An output that waits for the test never makes the device wait: it keeps its two buffers.
#[test]
fn a_slow_output_drops_frames_with_a_count() {
    let folder = tempfile::tempdir().unwrap();
    let mut fake = Fake::new((0..50).map(Fake::frame));
    fake.free.store(4, Ordering::SeqCst);
    // Two of four buffers can be at the output, and with so large a picture it is slower than the device.
    let pipeline: Pipeline = "scale:2000x2000".parse().unwrap();
    let mut output = Output::new("fake", &fake.opened.format)
        .to_folder(folder.path(), Files { png: false, raw: false })
        .unwrap()
        .through(&pipeline);
    let mut least = usize::MAX;
    let free = std::sync::Arc::clone(&fake.free);
    let limits = Limits { frames: None, timeout: Duration::from_millis(1) };
    let session = capture(&mut fake, limits, Some(&mut output), &AtomicBool::new(false), &mut |_| {
        least = least.min(free.load(Ordering::SeqCst));
    });
    let got = session.statistics;
    assert_eq!((got.taken, got.good), (50, 50));
    assert!(got.dropped > 0 && got.dropped < 50, "{got:?}");
    assert!(least >= RESERVE, "the device kept {least}");
    assert_eq!(output.written().len() as u64, 50 - got.dropped);
    assert_eq!(fake.buffers(), 4);
}

#[test]
fn an_output_that_fails_ends_the_capture_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let mut fake = Fake::new((0..3).map(Fake::frame).chain(std::iter::repeat_n(Event::Nothing, 1000)));
    let place = folder.path().join("frames");
    let mut output =
        Output::new("fake", &fake.opened.format).to_folder(&place, Files { png: false, raw: true }).unwrap();
    std::fs::remove_dir(&place).unwrap();
    let session =
        run(&mut fake, Limits { frames: None, timeout: Duration::from_secs(20) }, Some(&mut output));
    assert!(matches!(session.error, Some(CaptureError::Output(_))), "{:?}", session.error);
    assert!(session.took < Duration::from_secs(10));
}

#[test]
fn stopping_ends_it_without_an_error() {
    let mut fake = Fake::new((0..1000).map(Fake::frame));
    let stop = AtomicBool::new(false);
    let session = capture(&mut fake, PATIENT, None, &stop, &mut |statistics| {
        stop.store(statistics.taken == 7, Ordering::Relaxed);
    });
    assert!(session.error.is_none());
    assert_eq!(session.statistics.taken, 7);
}

#[test]
fn frames_that_are_no_pictures_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let mut fake = Fake::new((0..2).map(Fake::frame));
    fake.opened.format.code = v4l2_capture::FourCc::new(b"MJPG");
    let mut output = Output::new("fake", &fake.opened.format)
        .to_folder(folder.path(), Files { png: true, raw: false })
        .unwrap();
    let session = run(&mut fake, PATIENT, Some(&mut output));
    assert_eq!((session.statistics.broken, session.statistics.good), (2, 0));
    assert!(!session.statistics.is_clean());
    assert!(files(folder.path()).is_empty());
}

#[test]
fn a_format_that_is_no_picture_is_said_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let mut fake = Fake::new((0..2).map(Fake::frame));
    fake.opened.format.code = v4l2_capture::FourCc::new(b"H264");
    let mut output = Output::new("fake", &fake.opened.format)
        .to_folder(folder.path(), Files { png: true, raw: true })
        .unwrap();
    let session = run(&mut fake, PATIENT, Some(&mut output));
    let error = session.error.unwrap().to_string();
    assert!(error.contains("frame 0") && error.contains("--format"), "{error}");
    assert!(files(folder.path()).is_empty());
}

#[test]
fn a_trace_holds_the_frames_byte_by_byte_where_they_fit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.camt");
    let mut profile = Profile::built_in("vga-gray8").unwrap();
    (profile.frame.width, profile.frame.height) = (4, 2);
    let mut fake = Fake::new((0..3).map(Fake::frame));
    let mut output = Output::new("fake", &fake.opened.format).to_trace(&path, &profile).unwrap();
    assert_eq!(output.note(), None);
    let session = run(&mut fake, PATIENT, Some(&mut output));
    assert_eq!((session.statistics.copied_bytes, session.statistics.converted_bytes), (3 * 8, 0));
    let (_, created) = output.finish().unwrap();
    assert_eq!(created.unwrap().path, path);
    assert_eq!(files(folder.path()), ["x.camt"]);

    // Of another size, by way of a picture.
    profile.frame.width = 8;
    let mut fake = Fake::new([Fake::frame(200)]);
    let mut output = Output::new("fake", &fake.opened.format).to_trace(&path, &profile).unwrap();
    assert!(output.note().unwrap().contains("scaled to 8 × 2"));
    let session = run(&mut fake, PATIENT, Some(&mut output));
    assert_eq!((session.statistics.copied_bytes, session.statistics.converted_bytes), (0, 24));
    assert!(output.finish().unwrap().1.is_some());
}

#[test]
fn a_trace_without_a_frame_is_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.vcd");
    let mut fake = Fake::new([]);
    let mut output = Output::new("fake", &fake.opened.format).to_trace(&path, &Profile::default()).unwrap();
    run(&mut fake, PATIENT, Some(&mut output));
    assert_eq!(output.finish().unwrap().1, None);
    assert!(files(folder.path()).is_empty());
}
