//! `host-sim capture` on the virtual cameras of the kernel's driver `vivid`: `/dev/video0` with its pixels in one piece of memory,
//! `/dev/video1` with planes apart.
//!
//! Run by `tests/vm/run` in a virtual machine; ignored elsewhere.
#![cfg(all(target_os = "linux", target_pointer_width = "64"))]

use std::path::Path;
use std::sync::Once;

use camif_vm::command::{Finished, run};

mod list;
mod formats;
mod strides;
mod settings;
mod errors;
mod live;
mod trace;
mod numbers;

/// The device whose pixels are in one piece of memory.
const ONE: &str = "/dev/video0";
/// The one with planes apart.
const PLANES: &str = "/dev/video1";

/// A size with the highest rates.
const SMALL: &str = "320x180";

/// Loads the driver, once.
fn cameras() {
    static LOADED: Once = Once::new();
    LOADED.call_once(load);
}

/// Loads the driver with two devices that capture and do nothing else. Their pictures are the bars of 100 %, without text.
fn load() {
    let parameters = ["n_devs=2", "node_types=0x1,0x1", "multiplanar=1,2"];
    let _ = run("insmod", &[&["/modules/vivid.ko"][..], &parameters].concat()).expect(0);
    for device in [ONE, PLANES] {
        camif_vm::command::wait_until(device, || Path::new(device).exists());
        v4l2_ctl(device, &["--set-ctrl=test_pattern=1,osd_text_mode=2"]);
    }
}

/// The tool that most people use, which these tests compare with.
fn v4l2_ctl(device: &str, arguments: &[&str]) -> String {
    let Finished { stdout, .. } = run("v4l2-ctl", &[&["-d", device], arguments].concat()).expect(0);
    stdout
}
