//! Lines with gaps between them, as `v4l2-ctl` sets them and drivers like to have them: odd ones too.

use std::fs;

use camif_vm::bars;
use camif_vm::command::host_sim;

use crate::{ONE, cameras, v4l2_ctl};

#[test]
#[ignore = "tests/vm/run"]
fn gaps_between_lines_are_left_out() {
    cameras();
    // Bytes of a line, and what is set; whether it is a format that a camera interface has, whose bytes are written without gaps.
    for (code, line, stride, as_bus, bound) in [
        ("RGB3", 960, 963, true, 0),
        ("RGB3", 960, 1024, true, 0),
        ("YUYV", 640, 644, true, 3),
        ("BA81", 320, 333, true, 0),
        ("XR24", 1280, 1284, false, 0),
        ("NV12", 320, 352, false, 3),
    ] {
        let ask = format!("--set-fmt-video=width=320,height=180,pixelformat={code},bytesperline={stride}");
        v4l2_ctl(ONE, &[&ask]);
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().to_str().unwrap();
        // A stride belongs to format and size; asked for or not, these are what is set.
        let asked = ["capture", "--v4l2", ONE, "--frames", "1", "--out", out, "--json"];
        for more in [&["--size", "320x180", "--format", code][..], &[]] {
            let device = host_sim(&[&asked[..], more].concat()).expect(0).device();
            assert_eq!(device["strides"], serde_json::json!([stride]), "{code}: {device}");
            let raw = fs::read(folder.path().join("frame-0000.raw")).unwrap();
            let (lines, kept) =
                if code == "NV12" { (270, stride) } else { (180, if as_bus { line } else { stride }) };
            assert_eq!(raw.len(), lines * kept, "{code}");
            // Without gaps means copied, once.
            let copied = if as_bus { raw.len() } else { 0 };
            assert_eq!(device["copied_bytes_per_frame"], copied, "{code}");
            let picture = host_sim::picture::read(&folder.path().join("frame-0000.png")).unwrap();
            let margin = if code == "BA81" { 2 } else { 0 };
            let difference = bars::difference(&picture, &bars::picture(320, 180, 255), margin);
            assert!(difference.0 <= bound, "{code}, {stride} bytes a line: {difference:?}");
        }
        // Another size is another format: the gap is gone.
        let small = host_sim(&[
            "capture", "--v4l2", ONE, "--frames", "1", "--size", "640x360", "--format", code, "--json",
        ]);
        let expected = if code == "NV12" { 640 } else { 2 * line };
        assert_eq!(small.expect(0).device()["strides"], serde_json::json!([expected]), "{code}");
    }
}
