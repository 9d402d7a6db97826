//! One image in QEMU: its messages decoded, its end awaited, but not for ever.
//!
//! `-icount shift=0` makes a run a function of the image and its input alone: time passes by instructions, 1 ns each,
//! and not by the host's clock.

use std::fmt;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow};
use defmt_decoder::{DecodeError, Table};

/// The machine's program.
pub(crate) const PROGRAM: &str = "qemu-system-arm";

/// The machines that the images run on, unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum)]
pub(crate) enum Board {
    /// Cortex-M4
    An386,
    /// Cortex-M7
    An500,
}

impl Board {
    pub(crate) const ALL: [Self; 2] = [Self::An386, Self::An500];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::An386 => "an386",
            Self::An500 => "an500",
        }
    }
}

impl fmt::Display for Board {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// Exit status 0.
    Success,
    /// A failed check, a panic, a fault.
    Failure(String),
    /// It was still running at the deadline.
    Deadline,
}

/// A run.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    /// Its messages, one each, without level.
    pub(crate) messages: Vec<String>,
    pub(crate) end: End,
    pub(crate) took: Duration,
}

/// Kills the machine if its run is given up early.
struct Machine(Child);

impl Drop for Machine {
    fn drop(&mut self) {
        // If it has ended by itself there is nothing to kill.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Runs `elf` in `folder`, where it finds its files; `more` are further arguments for QEMU. Each message goes to `watch`
/// as it comes.
pub(crate) fn run(
    board: Board,
    elf: &Path,
    folder: &Path,
    deadline: Duration,
    more: &[&str],
    watch: &mut dyn FnMut(&str),
) -> Result<Run> {
    let bytes = std::fs::read(elf).with_context(|| format!("cannot read {}", elf.display()))?;
    let table = Table::parse(&bytes).with_context(|| format!("defmt's messages in {}", elf.display()))?;
    let table = table.ok_or_else(|| anyhow!("{} has no messages of defmt", elf.display()))?;
    let started = Instant::now();
    let mut command = Command::new(PROGRAM);
    command.args(["-machine", &format!("mps2-{board}"), "-icount", "shift=0,sleep=off"]);
    command.args(["-display", "none", "-monitor", "none", "-semihosting-config", "enable=on,target=native"]);
    if !more.contains(&"-serial") {
        command.args(["-serial", "none"]);
    }
    command.args(more).arg("-kernel").arg(elf).current_dir(folder);
    command.stdin(Stdio::null()).stdout(Stdio::piped());
    let child =
        command.spawn().with_context(|| format!("cannot start {PROGRAM}: see `cargo xtask setup`"))?;
    let mut machine = Machine(child);
    let mut stdout = machine.0.stdout.take().context("the machine's output")?;
    let (sender, receiver) = mpsc::channel();
    let reader = std::thread::spawn(move || {
        let mut buffer = [0; 4096];
        while let Ok(length @ 1..) = stdout.read(&mut buffer) {
            if sender.send(buffer[..length].to_vec()).is_err() {
                break;
            }
        }
    });
    let mut decoder = table.new_stream_decoder();
    let mut messages = Vec::new();
    let end = loop {
        let left = deadline.saturating_sub(started.elapsed());
        match receiver.recv_timeout(left) {
            Ok(bytes) => decoder.received(&bytes),
            Err(mpsc::RecvTimeoutError::Timeout) => break End::Deadline,
            Err(mpsc::RecvTimeoutError::Disconnected) => {
                let status = machine.0.wait()?;
                break if status.success() { End::Success } else { End::Failure(status.to_string()) };
            }
        }
        loop {
            match decoder.decode() {
                Ok(frame) => {
                    let message = frame.display_message().to_string();
                    watch(&message);
                    messages.push(message);
                }
                Err(DecodeError::UnexpectedEof) => break,
                Err(DecodeError::Malformed) => messages.push("(a message that cannot be decoded)".to_owned()),
            }
        }
    };
    drop(machine);
    let _ = reader.join();
    Ok(Run { messages, end, took: started.elapsed() })
}
