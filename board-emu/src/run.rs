//! A run, from reset to its end.
//!
//! It ends at the deadline, or when the image asks for it (semihosting), or when nothing moves any more: no word through the
//! camera interface, no byte on the serial port. If the camera has nothing more to show, all is done after [`QUIET`]. If it
//! still sends, into an interface that the image has switched on, the image hangs once [`FRAMES_MISSED`] frames have passed
//! that way, or [`LONG_QUIET`], and the report says where.

use std::net::{SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use anyhow::{Context, Result};
use firmware::camif::Bus;
use rigless::emulator::{Driver, Host, Settled, Start, Stop, StopReason};
use rigless::image::Image;
use rigless::session::Session;
use rigless::time::VirtualNanos;

use crate::board::{CameraBoard, Kind, Wiring};
use crate::camera::Camera;
use crate::cpu::{Core, Registers};
use crate::dcmi::Counts;
use crate::gaps::Allowed;
use crate::i2c::SensorOnI2c;
use crate::report::{Ending, Report};
use crate::serial::{FarEnd, Received};
use crate::symbols::Symbols;

/// How often, in virtual nanoseconds, a run looks whether it is over.
const LOOK: u64 = 1_000_000;
/// For how long, in virtual nanoseconds, nothing moves before a run is over or a core hangs, at least.
pub const QUIET: u64 = 100_000_000;
/// For how long nothing moves before a core hangs although VSYNC did not say that frames passed.
pub const LONG_QUIET: u64 = 2_000_000_000;
/// Frames that pass while nothing moves before a core hangs.
pub const FRAMES_MISSED: u64 = 4;

/// What is to be run.
#[derive(Debug)]
pub struct Plan {
    /// The board.
    pub board: Kind,
    /// The ELF file that goes to the flash.
    pub image: PathBuf,
    /// What drives the camera's pins.
    pub camera: Camera,
    /// How long the camera interface waits for the bus.
    pub bus: Bus,
    /// The sensor on I2C, if one answers.
    pub sensor: Option<SensorOnI2c>,
    /// The far end of the serial port.
    pub serial: FarEnd,
    /// Virtual nanoseconds at most.
    pub deadline: u64,
    /// Millions of instructions that the core retires in a virtual second; the emulator's own rate if it is not said.
    pub mips: Option<u32>,
    /// What is expected to be missing of the part.
    pub allowed: Allowed,
    /// Where to serve a debugger.
    pub gdb: Option<SocketAddr>,
    /// Where to serve the image's RTT terminal, such as `defmt`'s.
    pub rtt: Option<SocketAddr>,
}

impl Plan {
    /// A run of an image against a camera: an ideal bus, nothing on I2C, nobody on the serial port, ten virtual seconds.
    #[must_use]
    pub fn new(board: Kind, image: PathBuf, camera: Camera) -> Self {
        Self {
            board,
            image,
            camera,
            bus: Bus::IDEAL,
            sensor: None,
            serial: FarEnd::memory(),
            deadline: 10_000_000_000,
            mips: None,
            allowed: Allowed::of(board),
            gdb: None,
            rtt: None,
        }
    }
}

/// What moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Movement {
    words: u64,
    serial: usize,
    resets: usize,
}

/// Looks on while the emulator runs.
#[derive(Debug)]
struct Watcher {
    deadline: u64,
    received: Received,
    last_access: Option<LastAccess>,
    moved: Movement,
    moved_at: u64,
    /// Changes of VSYNC by then.
    edges_then: u64,
    idle: bool,
    registers: Option<Registers>,
    ending: Option<Ending>,
    instructions: u64,
    at: u64,
    console: Vec<u8>,
}

/// A peripheral access of the core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LastAccess {
    /// When, in virtual nanoseconds.
    pub at: u64,
    /// The instruction.
    pub program_counter: u64,
    /// The peripheral's address.
    pub address: u64,
}

impl Watcher {
    fn look(&mut self, session: &Session<CameraBoard>, now: u64) {
        let moved = Movement {
            words: session.board().part().counts().words,
            serial: self.received.len(),
            resets: session.resets().len(),
        };
        if moved != self.moved {
            self.moved = moved;
            self.moved_at = now;
            self.edges_then = session.board().part().counts().vsync_edges;
        }
    }
}

impl Driver<CameraBoard> for Watcher {
    fn on_settled(&mut self, _: &mut Session<CameraBoard>, _: &mut dyn Host, settled: Settled) {
        match settled {
            Settled::Access { access, .. } => {
                if let Some(program_counter) = access.program_counter {
                    let (at, address) = (access.virtual_time.0, access.address);
                    self.last_access = Some(LastAccess { at, program_counter, address });
                }
            }
            Settled::Stop(stop) => self.idle = stop.reason == StopReason::Idle,
            _ => {}
        }
    }

    fn on_stop(
        &mut self,
        session: &mut Session<CameraBoard>,
        stop: Stop,
        host: &mut dyn Host,
    ) -> Option<VirtualNanos> {
        let now = stop.at.0;
        (self.at, self.instructions) = (now, stop.instruction_count);
        self.look(session, now);
        let part = session.board().part();
        let quiet = now.saturating_sub(self.moved_at);
        let missed = part.counts().vsync_edges - self.edges_then >= 2 * FRAMES_MISSED;
        let hangs = quiet >= QUIET && missed || quiet >= LONG_QUIET;
        // What was quiet before the camera came to its end hung; what became quiet after that was done.
        self.ending = match part.camera_is_over() {
            false if hangs && part.camera_is_enabled() => Some(Ending::Hung),
            true if quiet >= QUIET => Some(Ending::Done),
            _ if now < self.deadline => None,
            _ if part.counts().clocks == 0 && !part.camera_is_enabled() => Some(Ending::Dark),
            _ => Some(Ending::Deadline),
        };
        if self.ending.is_some() {
            self.registers = host.save_state().ok().and_then(|saved| Registers::read(&saved));
            return None;
        }
        Some(VirtualNanos((now + LOOK).min(self.deadline)))
    }

    fn on_console(&mut self, _: VirtualNanos, _: u64, bytes: &[u8]) {
        self.console.extend_from_slice(bytes);
    }
}

impl Plan {
    /// Runs it. `interrupt`, once set, ends the run where it stands.
    ///
    /// # Errors
    /// If the image cannot be read or does not fit the part, or an address cannot be listened on.
    pub fn run(self, interrupt: Option<&AtomicBool>) -> Result<Report> {
        let Self { board: kind, image, camera, bus, sensor, serial, deadline, mips, allowed, gdb, rtt } =
            self;
        let images = [Image::read(&image, None).with_context(|| format!("{}", image.display()))?];
        let symbols = Symbols::read(images[0].bytes());
        let listen = |address: Option<SocketAddr>, what: &str| {
            let bind = |address| TcpListener::bind(address).with_context(|| format!("{what} on {address}"));
            let listener = address.map(bind).transpose()?;
            if let Some(listener) = &listener {
                eprintln!("{what} on {}", listener.local_addr()?);
            }
            anyhow::Ok(listener)
        };
        let (gdb, rtt) = (listen(gdb, "waiting for a debugger")?, listen(rtt, "the RTT terminal")?);
        let received = serial.received();
        let wiring = Wiring { serial: Box::new(serial), sensor };
        let board = CameraBoard::new(kind, camera, bus, wiring, mips).context("the board's description")?;
        let session = Session::new(Box::new(board), 0, VirtualNanos(LOOK.min(deadline)))?;
        let mut start = Start::new(&images);
        start.semihosting = true;
        start.debugger = gdb.as_ref();
        start.wait_for_debugger = gdb.is_some();
        start.rtt = rtt.as_ref();
        start.interrupt = interrupt;
        let watcher = Watcher {
            deadline,
            received: received.clone(),
            last_access: None,
            moved: Movement::default(),
            moved_at: 0,
            edges_then: 0,
            idle: false,
            registers: None,
            ending: None,
            instructions: 0,
            at: 0,
            console: Vec::new(),
        };
        let began = Instant::now();
        let finished = rigless::emulator::run(session, &start, watcher)?;
        let seconds = began.elapsed().as_secs_f64();
        let (session, watcher) = (finished.session, finished.driver);
        let ending = match (finished.exit_status, finished.interrupted, watcher.ending) {
            (Some(status), ..) => Ending::Exit(status),
            (None, Some(_), _) => Ending::Interrupted,
            (None, None, ending) => ending.unwrap_or(Ending::Deadline),
        };
        let counts: Counts = session.board().part().counts();
        let core =
            Core::of(ending, watcher.registers, watcher.idle, watcher.last_access, watcher.at, &symbols);
        Ok(Report::new(kind, &session, counts, ending, core, &allowed, &symbols)
            .timed(watcher.at, watcher.instructions, seconds)
            .with_output(received.bytes(), watcher.console))
    }
}
