//! Any bytes as sigrok sessions: levels, or a typed error.
#![no_main]

use std::io::Cursor;
use host_sim::trace::sr::SrFile;
use host_sim::trace::levels::Levels;
use host_sim::trace::wiring::Tap;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let wires: Vec<(Tap, u64)> = (0..11).map(|signal| (Tap { signal, bit: 0 }, 1 << signal)).collect();
    if let Ok(mut file) = SrFile::new(Cursor::new(bytes)) {
        let _ = file.play(&wires, &mut Levels::at_most(10_000), &mut |_| ());
    }
});
