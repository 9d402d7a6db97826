//! The commands of `host-sim`.
//!
//! | file | what lives there |
//! |---|---|
//! | `demo` | scene → trace → block → driver → pictures and a table, with nothing attached |
//! | `generate` | a scene or picture becomes a trace |
//! | `bring_up` | the driver brings a virtual sensor up, for `generate --sensor` |
//! | `inject` | a trace with faults put in |
//! | `broken` | faults on the way into a trace or out of it |
//! | `guess` | a trace without a profile gets one |
//! | `replay` | a trace becomes frames |
//! | `diagnose` | what is wrong with a trace |
//! | `campaign` | faults × seeds × profiles, and the joining of shards |
//! | `process` | a picture file goes through a pipeline |
//! | `capture` | frames of real cameras, to look at, for the algorithms, as a trace |
//! | `capture_list` | which cameras there are |
//! | `capture_controls` | their controls |
//! | `capture_report` | what came of a capture |
//! | `stream` | a device on a serial line, for the inspector |
//! | `showcase` | what the demo makes of its first frame |
//! | `clock` | the clock as it was recovered, for people and as JSON |
//! | `report` | what came of a replay, for people and as JSON |
//! | `progress` | bars on stderr |

mod bring_up;
mod clock;
mod broken;
mod capture;
mod capture_controls;
mod capture_list;
mod capture_report;
mod campaign;
mod demo;
mod diagnose;
mod generate;
mod guess;
mod inject;
mod process;
mod progress;
mod replay;
mod report;
mod showcase;
mod stream;

pub use campaign::{Campaign, Merge};
pub use capture::Capture;
pub use demo::Demo;
pub use diagnose::Diagnose;
pub use generate::Generate;
pub use guess::Guess;
pub use inject::Inject;
pub use process::Process;
pub use replay::Replay;
pub use stream::Stream;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use anyhow::Context as _;
use clap::Subcommand;

/// What came of a command: the exit status says it as 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// All is well.
    Fine,
    /// A fault was found.
    Fault,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Take a scene through trace, camera interface and driver to pictures; needs nothing
    Demo(Demo),
    /// Make a timing trace of a scene or a picture file
    Generate(Generate),
    /// Put faults into a trace; `--fault help` lists them
    Inject(Inject),
    /// Find the profile of a trace that has none: sync, frame size, pixel format, each with a confidence
    Guess(Guess),
    /// Play a trace into the camera interface and receive its frames
    Replay(Replay),
    /// Say what is wrong with a trace, where, and what to change
    Diagnose(Diagnose),
    /// Diagnose faults × seeds × profiles and count what is found
    Campaign(Campaign),
    /// Join the shards of a campaign
    Merge(Merge),
    /// Run the algorithms of the device on a picture file; `--op help` lists them
    Process(Process),
    /// Take frames of a real camera: to look at, for --op, or as a trace
    Capture(Capture),
    /// Play a device on the serial link, over TCP or a pseudo-terminal, for the inspector
    Stream(Stream),
}

impl Command {
    /// Runs the command.
    ///
    /// # Errors
    /// Bad usage or input: one line that names the file, the place and the remedy.
    pub fn run(&self) -> anyhow::Result<Outcome> {
        match self {
            Self::Demo(demo) => demo.run(),
            Self::Generate(generate) => generate.run(),
            Self::Inject(inject) => inject.run(),
            Self::Guess(guess) => guess.run(),
            Self::Replay(replay) => replay.run(),
            Self::Diagnose(diagnose) => diagnose.run(),
            Self::Campaign(campaign) => campaign.run(),
            Self::Merge(merge) => merge.run(),
            Self::Process(process) => process.run(),
            Self::Capture(capture) => capture.run(),
            Self::Stream(stream) => stream.run(),
        }
    }
}

/// Is set by Ctrl-C or a request to terminate.
fn stop_on_signal() -> anyhow::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&stop)).context("Ctrl-C can't be waited for")?;
    }
    Ok(stop)
}
