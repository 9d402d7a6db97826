//! Every fault that the driver recovers from, and what must be seen of it.
//!
//! One list for the host's tests and for the images: a fault is in the trace, on the bus, or in how late the program
//! is; after it the driver must capture whole frames again, by itself, until the last one.

use firmware::camif::{Bus, Hold, Stall};
use firmware::driver::config::Policy;

use super::scenario::{CLEAN, Disturbance, SMALL_EMBEDDED, SMALL_MARKER, Scenario, Trouble};

/// Ticks of a frame of the gated profile: VSYNC, and the lines with what is between them. Frame n ends at tick (n + 1) × this.
const FRAME: u64 = 98;

const fn during(from: u64, ticks: u64, what: Trouble) -> Option<Disturbance> {
    Some(Disturbance { from, ticks, what })
}

/// Faults of the bus.
const LATE: Bus = Bus { hold: Some(Hold { request: 1_000, clocks: 100 }), ..Bus::IDEAL };
const BROKEN: Bus = Bus { error: Some(1_000), ..Bus::IDEAL };
/// The last burst of the second frame comes after its end has been served.
const SLOW_LAST: Bus = Bus { hold: Some(Hold { request: 1_151, clocks: 2_000 }), ..Bus::IDEAL };
/// For three frames and a half no word moves.
const STANDING: Bus = Bus { hold: Some(Hold { request: 1_152, clocks: 260_000 }), ..Bus::IDEAL };
/// Slower than the sensor.
const SLOW: Bus = Bus { latency_min: 18, latency_max: 22, ..Bus::IDEAL };
const STALLING: Bus =
    Bus { latency_max: 2, stall: Some(Stall { one_in: 1_500, clocks: 60 }), seed: 11, ..Bus::IDEAL };

/// One fault each, and what the driver makes of it.
pub static FAULTS: [Scenario; 30] = [
    Scenario { name: "clean", ..CLEAN },
    Scenario { name: "slow-bus", bus: Bus { latency_max: 3, seed: 7, ..Bus::IDEAL }, ..CLEAN },
    // The bus and the DMA.
    Scenario { name: "overrun", frames: 8, bus: LATE, seen: &["overrun"], missing: 1, ..CLEAN },
    Scenario { name: "stalls", frames: 12, bus: STALLING, seen: &["overrun"], missing: 6, ..CLEAN },
    Scenario {
        name: "overruns-go-on",
        frames: 8,
        patience: 150,
        disturbance: during(2 * FRAME, 3 * FRAME, Trouble::Bus(SLOW)),
        seen: &["overrun", "DMA stalled"],
        missing: 4,
        ..CLEAN
    },
    Scenario {
        name: "bus-stands-still",
        frames: 10,
        patience: 150,
        bus: STANDING,
        seen: &["overrun", "DMA stalled"],
        missing: 5,
        ..CLEAN
    },
    Scenario {
        name: "last-burst-late",
        frames: 8,
        policy: Policy::Snapshot,
        bus: SLOW_LAST,
        seen: &["DMA stalled"],
        missing: 2,
        ..CLEAN
    },
    Scenario { name: "bus-error", frames: 8, bus: BROKEN, seen: &["DMA error"], missing: 1, ..CLEAN },
    // Lines.
    Scenario {
        name: "short-line",
        frames: 8,
        faults: &["short-line:count=1,samples=6"],
        faulty: (3, 5),
        seen: &["short"],
        missing: 3,
        ..CLEAN
    },
    Scenario {
        name: "long-line",
        frames: 8,
        faults: &["long-line:count=1,samples=6"],
        faulty: (3, 5),
        seen: &["long"],
        missing: 3,
        ..CLEAN
    },
    Scenario {
        name: "uneven-lines",
        frames: 8,
        faults: &["short-line:count=1,samples=6", "long-line:count=1,samples=6"],
        faulty: (3, 5),
        seen: &["uneven lines"],
        missing: 3,
        ..CLEAN
    },
    Scenario {
        name: "missing-hsync",
        frames: 8,
        faults: &["missing-hsync:count=2"],
        faulty: (3, 5),
        deliver_damaged: true,
        seen: &["long"],
        missing: 2,
        ..CLEAN
    },
    Scenario {
        name: "missing-marker",
        profile: SMALL_MARKER,
        frames: 8,
        faults: &["missing-hsync:count=2"],
        faulty: (3, 4),
        seen: &["wrong number of lines"],
        missing: 2,
        ..CLEAN
    },
    // Frames.
    Scenario {
        name: "vsync-in-frame",
        frames: 8,
        faults: &["vsync-in-frame"],
        faulty: (3, 5),
        seen: &["short"],
        missing: 2,
        ..CLEAN
    },
    Scenario {
        name: "missing-vsync",
        frames: 8,
        faults: &["missing-vsync:every=1"],
        faulty: (3, 4),
        seen: &["long"],
        missing: 3,
        ..CLEAN
    },
    Scenario {
        name: "short-frames",
        frames: 10,
        patience: 150,
        faults: &["vsync-in-frame"],
        faulty: (3, 7),
        seen: &["short", "short frames"],
        missing: 5,
        ..CLEAN
    },
    Scenario {
        name: "sync-error",
        profile: SMALL_EMBEDDED,
        frames: 8,
        faults: &["spurious-vsync:count=1"],
        faulty: (3, 4),
        seen: &["sync error"],
        missing: 2,
        ..CLEAN
    },
    // Wires that stand still.
    Scenario {
        name: "no-clock",
        patience: 110,
        disturbance: during(2 * FRAME + 1, 3 * FRAME, Trouble::Silence),
        seen: &["no clock", "unfinished"],
        ..CLEAN
    },
    Scenario {
        name: "no-vsync",
        frames: 8,
        patience: 110,
        disturbance: during(2 * FRAME, 3 * FRAME, Trouble::Vsync(true)),
        seen: &["no VSYNC", "unfinished"],
        missing: 4,
        ..CLEAN
    },
    Scenario {
        name: "no-data",
        frames: 8,
        patience: 150,
        disturbance: during(2 * FRAME, 3 * FRAME, Trouble::Hsync(true)),
        seen: &["short", "short frames"],
        missing: 4,
        ..CLEAN
    },
    // The program.
    Scenario {
        name: "late-interrupt",
        frames: 8,
        disturbance: during(2 * FRAME + 10, 2 * FRAME, Trouble::Masked),
        seen: &["late interrupt"],
        missing: 4,
        ..CLEAN
    },
    Scenario { name: "impatience", patience: 70, seen: &["unfinished"], ..CLEAN },
    Scenario { name: "no-buffer", frames: 12, hoard: true, seen: &["no buffer"], missing: 8, ..CLEAN },
    // Line by line: a frame's end is handed out with what was wrong, whatever it was.
    Scenario { name: "lines-clean", lines: true, ..CLEAN },
    Scenario {
        name: "lines-overrun",
        lines: true,
        frames: 8,
        bus: LATE,
        seen: &["overrun"],
        missing: 2,
        ..CLEAN
    },
    Scenario {
        name: "lines-bus-error",
        lines: true,
        frames: 8,
        bus: BROKEN,
        seen: &["DMA error"],
        missing: 2,
        ..CLEAN
    },
    Scenario {
        name: "lines-short",
        lines: true,
        frames: 8,
        faults: &["short-line:count=1,samples=6"],
        faulty: (3, 5),
        seen: &["short"],
        missing: 2,
        ..CLEAN
    },
    Scenario {
        name: "lines-uneven",
        lines: true,
        frames: 8,
        faults: &["short-line:count=1,samples=6", "long-line:count=1,samples=6"],
        faulty: (3, 5),
        seen: &["uneven lines"],
        missing: 2,
        ..CLEAN
    },
    Scenario {
        name: "lines-late-interrupt",
        lines: true,
        frames: 8,
        disturbance: during(2 * FRAME + 10, 7, Trouble::Masked),
        seen: &["late interrupt"],
        missing: 2,
        ..CLEAN
    },
    Scenario {
        name: "lines-dropped",
        lines: true,
        frames: 8,
        disturbance: during(2 * FRAME + 10, 20, Trouble::Nap),
        seen: &["lines dropped"],
        missing: 1,
        ..CLEAN
    },
];
