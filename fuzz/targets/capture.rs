//! Any bytes as a file of any format, as a user opens it: binary exports and `.camt` among them.
#![no_main]

use std::sync::OnceLock;

use host_sim::trace::{Capture, CaptureOptions, open};
use libfuzzer_sys::fuzz_target;

/// A file of this process alone.
fn path() -> &'static std::path::Path {
    static PATH: OnceLock<std::path::PathBuf> = OnceLock::new();
    PATH.get_or_init(|| std::env::temp_dir().join(format!("camif-fuzz-{}", std::process::id())))
}

fuzz_target!(|bytes: &[u8]| {
    std::fs::write(path(), bytes).expect("a temporary file");
    let _ = open(path(), &CaptureOptions::default());
    if let Ok(capture) = Capture::open(path()) {
        let all: Vec<usize> = (0..capture.channels().len().min(20)).collect();
        let _ = capture.beginning(&all, 10_000);
    }
});
