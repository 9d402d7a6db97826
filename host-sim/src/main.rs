//! `host-sim`: makes, replays, breaks and diagnoses camera timing traces.
//!
//! Exit status: 0 fine, 1 a fault was found, 2 bad usage or input.
#![forbid(unsafe_code)]

use std::process::ExitCode;

use clap::Parser;
use host_sim::command::{Command, Outcome};

/// Makes, replays, breaks and diagnoses camera timing traces
#[derive(Debug, Parser)]
#[command(version, after_help = "Exit status: 0 fine, 1 a fault was found, 2 bad usage or input.")]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    end_with_the_reader();
    match CommandLine::parse().command.run() {
        Ok(Outcome::Fine) => ExitCode::SUCCESS,
        Ok(Outcome::Fault) => ExitCode::from(1),
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// Ends the program quietly when whoever reads its output has gone, as in `host-sim capture --list | head -n 1`. Rust
/// lets it live, and its next line be a panic.
fn end_with_the_reader() {
    #[cfg(unix)]
    {
        use std::sync::Arc;
        use std::sync::atomic::AtomicBool;

        // It can't fail for this signal; if it did, all would be as without it.
        let always = Arc::new(AtomicBool::new(true));
        let _ = signal_hook::flag::register_conditional_default(signal_hook::consts::SIGPIPE, always);
    }
}
