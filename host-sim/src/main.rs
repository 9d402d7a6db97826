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
    match CommandLine::parse().command.run() {
        Ok(Outcome::Fine) => ExitCode::SUCCESS,
        Ok(Outcome::Fault) => ExitCode::from(1),
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}
