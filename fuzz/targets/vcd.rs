//! Any bytes as a value change dump: pixel clocks, or a typed error.
#![no_main]


use host_sim::trace::CaptureOptions;
use host_sim::trace::polarity::{RunLengths, Wire};
use host_sim::trace::vcd::VcdReader;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(reader) = VcdReader::new(bytes, &CaptureOptions::default()) {
        let _ = reader.play(&mut RunLengths::new(Wire::Hsync, 10_000), &mut |_| ());
    }
});
