//! Captures without an end, several devices, slow disks, readers that leave.

use std::fs;
use std::io::Read as _;
use std::os::unix::process::CommandExt as _;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use camif_vm::bars;
use camif_vm::command::{Finished, command, host_sim, interrupt, run, wait_until};

use crate::{ONE, PLANES, SMALL, cameras};

/// The names in a folder that stand for frames; nothing else may be there.
fn pictures(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert!(names.iter().all(|name| name.starts_with("frame-") && name.ends_with(".png")), "{names:?}");
    names
}

#[test]
#[ignore = "tests/vm/run"]
fn ctrl_c_ends_with_whole_files_and_a_report() {
    cameras();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let asked = ["capture", "--v4l2", ONE, "--size", "640x480", "--format", "RGB3"];
    let child = command("host-sim", &[&asked[..], &["--out", out, "--keep", "png", "--json"]].concat())
        .spawn()
        .unwrap();
    wait_until("six frames", || folder.path().join("frame-0005.png").exists());
    interrupt(&child);
    let finished = Finished::of(child).expect(0);
    let device = finished.device();
    let names = pictures(folder.path());
    assert_eq!(names.len() as u64, device["good"].as_u64().unwrap() - device["dropped"].as_u64().unwrap());
    for name in names {
        let picture = host_sim::picture::read(&folder.path().join(name)).unwrap();
        assert!(bars::difference(&picture, &bars::picture(640, 480, 255), 0).0 == 0);
    }
}

/// On a terminal there is a live count; it is gone at the end, and the report stands there.
#[test]
#[ignore = "tests/vm/run"]
fn a_terminal_shows_a_live_count() {
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    cameras();
    let terminal = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&terminal).unwrap();
    unlockpt(&terminal).unwrap();
    let path = ptsname(&terminal, Vec::new()).unwrap().into_string().unwrap();
    let other = fs::File::options().read(true).write(true).open(path).unwrap();
    let mut child = command("host-sim", &["capture", "--v4l2", ONE, "--size", SMALL]);
    let child = child.stderr(Stdio::from(other)).env("TERM", "xterm").spawn().unwrap();
    let (mut terminal, mut seen) = (fs::File::from(terminal), String::new());
    wait_until("ten frames on the screen", || {
        let mut bytes = [0; 4096];
        let count = terminal.read(&mut bytes).unwrap();
        seen += &String::from_utf8_lossy(&bytes[..count]);
        seen.contains("/dev/video0: 10 frames, ")
    });
    interrupt(&child);
    let finished = Finished::of(child);
    assert_eq!(finished.status, Some(0));
    assert!(seen.contains(" a second, none lost"), "{seen}");
    assert!(finished.stdout.starts_with("/dev/video0\n  format     "), "{}", finished.stdout);
}

/// The disk takes three million bytes a second, the camera gives more than ten: frames are left out with a count, and the
/// device loses none.
#[test]
#[ignore = "tests/vm/run"]
fn a_slow_disk_drops_frames_and_never_makes_the_device_wait() {
    cameras();
    let disk = Path::new("/tmp/disk");
    fs::create_dir_all(disk).unwrap();
    let _ = run("mke2fs", &["/dev/vda"]).expect(0);
    let _ = run("mount", &["-t", "ext4", "-o", "sync", "/dev/vda", "/tmp/disk"]).expect(0);
    let asked =
        ["capture", "--v4l2", ONE, "--size", "640x480", "--format", "RGB3", "--rate", "15", "--frames", "12"];
    let finished =
        host_sim(&[&asked[..], &["--out", "/tmp/disk/out", "--keep", "raw", "--json"]].concat()).expect(0);
    let device = finished.device();
    println!("{} taken, {} dropped, {} lost", device["taken"], device["dropped"], device["lost"]);
    assert!(device["dropped"].as_u64() > Some(5), "{device:#}");
    // A device that waits loses as many as are dropped. One or two go where the whole machine stands still.
    assert!(device["lost"].as_u64() < Some(3), "{device:#}");
    assert_eq!(device["good"], device["taken"], "{device:#}");
    let files = device["files"].as_array().unwrap();
    assert_eq!(files.len(), 12);
    // Without those left out, the device's numbers have gaps.
    let numbers: Vec<u64> = files.iter().map(|file| file["sequence"].as_u64().unwrap()).collect();
    assert!(numbers.is_sorted() && numbers[11] - numbers[0] > 15, "{numbers:?}");
    for file in files {
        assert_eq!(fs::metadata(file["raw"].as_str().unwrap()).unwrap().len(), 640 * 480 * 3);
    }
    let _ = run("umount", &["/tmp/disk"]).expect(0);
}

#[test]
#[ignore = "tests/vm/run"]
fn a_full_disk_is_said_and_leaves_no_half_of_a_file() {
    cameras();
    let disk = Path::new("/tmp/full");
    fs::create_dir_all(disk).unwrap();
    let _ = run("mount", &["-t", "tmpfs", "-o", "size=1m", "none", "/tmp/full"]).expect(0);
    let asked = [
        "capture",
        "--v4l2",
        ONE,
        "--size",
        SMALL,
        "--format",
        "RGB3",
        "--out",
        "/tmp/full",
        "--keep",
        "raw",
    ];
    let said = host_sim(&asked).expect(2).stderr;
    assert!(said.contains("/tmp/full/frame-000") && said.contains("No space left"), "{said}");
    for file in fs::read_dir(disk).unwrap() {
        assert_eq!(file.unwrap().metadata().unwrap().len(), 320 * 180 * 3);
    }
    let _ = run("umount", &["/tmp/full"]).expect(0);
}

#[test]
#[ignore = "tests/vm/run"]
fn several_devices_are_captured_at_once() {
    cameras();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let asked =
        ["capture", "--v4l2", ONE, "--v4l2", PLANES, "--size", SMALL, "--format", "NV12", "--frames", "5"];
    let finished =
        host_sim(&[&asked[..], &["--out", out, "--keep", "png", "--json"]].concat()).expect(0).json();
    for (device, name) in finished["devices"].as_array().unwrap().iter().zip(["video0", "video1"]) {
        assert_eq!(
            (&device["device"], device["good"].as_u64() >= Some(5)),
            (&format!("/dev/{name}").into(), true)
        );
        assert_eq!(pictures(&folder.path().join(name)).len(), 5);
    }
    // One that fails does not end the other.
    let asked =
        ["capture", "--v4l2", "/dev/video9", "--v4l2", PLANES, "--size", SMALL, "--frames", "2", "--json"];
    let finished = host_sim(&asked).expect(2);
    assert_eq!(finished.device()["good"], 2);
    assert!(finished.stderr.contains("/dev/video9: No such file"), "{}", finished.stderr);
}

#[test]
#[ignore = "tests/vm/run"]
fn a_device_that_another_program_has_is_busy() {
    cameras();
    let child = command("host-sim", &["capture", "--v4l2", ONE, "--size", SMALL, "--json"]).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(800));
    let said = host_sim(&["capture", "--v4l2", ONE, "--frames", "1"]).expect(2).stderr;
    assert!(said.contains("another program uses it: end that"), "{said}");
    interrupt(&child);
    assert!(Finished::of(child).expect(0).device()["good"].as_u64() > Some(0));
}

#[test]
#[ignore = "tests/vm/run"]
fn a_device_that_the_user_may_not_open_names_the_remedy() {
    cameras();
    let limited = |arguments: &[&str]| {
        Finished::of(command("/bin/host-sim", arguments).uid(1000).gid(1000).spawn().unwrap())
    };
    let _ = run("chmod", &["600", ONE, PLANES]).expect(0);
    let (capture, list) = (limited(&["capture", "--v4l2", ONE]), limited(&["capture", "--list"]));
    let _ = run("chmod", &["666", ONE, PLANES]).expect(0);
    assert!(capture.expect(2).stderr.contains("sudo usermod -aG video $USER"));
    assert!(list.expect(0).stdout.contains("sudo usermod -aG video $USER"));
}

/// `host-sim capture --list | head -n 1` ends quietly.
#[test]
#[ignore = "tests/vm/run"]
fn a_reader_that_leaves_is_no_panic() {
    cameras();
    for arguments in [
        &["capture", "--list"][..],
        &["capture", "--list", "--json"],
        &["capture", "--v4l2", ONE, "--controls"],
    ] {
        let mut child = command("host-sim", arguments).spawn().unwrap();
        drop(child.stdout.take());
        let finished = Finished::of(child);
        assert!(finished.status.is_none() && finished.stderr.is_empty(), "{arguments:?}: {finished:?}");
    }
}

/// Raw frames are written out of the driver's memory: what the program has of its own stays below a single frame, of which
/// a copy would take as much.
#[test]
#[ignore = "tests/vm/run"]
fn raw_frames_take_no_memory_of_their_own() {
    cameras();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let asked = ["capture", "--v4l2", ONE, "--size", "1920x1080", "--format", "RGB3", "--frames", "6"];
    let mut child = command("host-sim", &[&asked[..], &["--out", out, "--keep", "raw", "--json"]].concat())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut most = 0;
    while child.try_wait().unwrap().is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let own = text.lines().find_map(|line| line.strip_prefix("RssAnon:")?.split_whitespace().next());
        most = most.max(own.map_or(0, |kilobytes| 1024 * kilobytes.parse::<u64>().unwrap()));
        std::thread::sleep(Duration::from_millis(5));
    }
    let device = Finished::of(child).expect(0).device();
    println!("{most} bytes at most, of a frame's 6220800");
    assert_eq!(device["bytes"].as_u64().unwrap() / device["taken"].as_u64().unwrap(), 6_220_800);
    assert_eq!(device["copied_bytes_per_frame"], 0);
    assert!((1..6_220_800).contains(&most), "{most}");
}
