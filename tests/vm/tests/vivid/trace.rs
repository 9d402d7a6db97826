//! Frames become a trace, which goes through the block and comes out as the same bytes.

use camif_vm::command::host_sim;

use crate::{ONE, PLANES, cameras};

#[test]
#[ignore = "tests/vm/run"]
fn frames_go_through_the_block_byte_by_byte() {
    cameras();
    for (device, profile, code) in
        [(ONE, "vga-rgb888", "RGB3"), (ONE, "ov7670-vga-rgb565", "RGBR"), (PLANES, "vga-raw10", "RG10")]
    {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        let (trace, captured, received) = (path("trace.camt"), path("captured"), path("received"));
        let captured_by =
            ["capture", "--v4l2", device, "--size", "640x480", "--format", code, "--frames", "2"];
        let into =
            ["--out", &captured, "--keep", "raw", "--profile", profile, "--as-trace", &trace, "--json"];
        let finished = host_sim(&[&captured_by[..], &into].concat()).expect(0);
        let replayed =
            host_sim(&["replay", &trace, "--profile", profile, "--out", &received, "--json"]).expect(0);
        let frames = replayed.json()["frames"].as_array().unwrap().clone();
        assert_eq!(frames.len(), 2, "{code}: {finished:?}");
        for (number, frame) in frames.iter().enumerate() {
            let name = format!("frame-{number:04}.raw");
            let sent = std::fs::read(format!("{captured}/{name}")).unwrap();
            assert!(sent == std::fs::read(format!("{received}/{name}")).unwrap(), "{code}: frame {number}");
            assert_eq!(frame["verdict"], "good");
            assert_eq!(frame["crc32"], finished.device()["files"][number]["crc32"]);
        }
    }
}
