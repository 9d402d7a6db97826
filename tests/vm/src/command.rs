//! `host-sim` and others as a user runs them.

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;

/// What came of a command.
#[derive(Debug)]
pub struct Finished {
    /// Exit status; nothing if a signal ended it.
    pub status: Option<i32>,
    /// What it printed.
    pub stdout: String,
    /// What it said.
    pub stderr: String,
}

impl Finished {
    /// Of a process that was spawned with pipes.
    ///
    /// # Panics
    /// If it can't be waited for.
    #[must_use]
    pub fn of(child: Child) -> Self {
        let output = child.wait_with_output().expect("a child can be waited for");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
        Self { status: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }

    /// The one JSON object on stdout.
    ///
    /// # Panics
    /// If it is none.
    #[must_use]
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }

    /// The only device of the report on stdout.
    ///
    /// # Panics
    /// If there is none.
    #[must_use]
    pub fn device(&self) -> Value {
        self.json()["devices"][0].clone()
    }

    /// The same, if it ended with this status and without a panic.
    ///
    /// # Panics
    /// If not.
    #[must_use]
    pub fn expect(self, status: i32) -> Self {
        assert_eq!(self.status, Some(status), "{}{}", self.stdout, self.stderr);
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        self
    }
}

/// A command that is not started yet, with pipes for its output.
pub fn command(program: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Runs a command to its end.
///
/// # Panics
/// If there is no such program.
#[must_use]
pub fn run(program: &str, arguments: &[&str]) -> Finished {
    Finished::of(command(program, arguments).spawn().unwrap_or_else(|error| panic!("{program}: {error}")))
}

/// Runs `host-sim`.
#[must_use]
pub fn host_sim(arguments: &[&str]) -> Finished {
    run("host-sim", arguments)
}

/// Presses Ctrl-C.
///
/// # Panics
/// If the process is not there.
pub fn interrupt(child: &Child) {
    kill_process(Pid::from_child(child), Signal::INT).expect("a process can be interrupted");
}

/// Waits until something is so.
///
/// # Panics
/// If it is not after ten seconds.
pub fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let end = Instant::now() + Duration::from_secs(10);
    while !is_so() {
        assert!(Instant::now() < end, "{what}: not after ten seconds");
        std::thread::sleep(Duration::from_millis(20));
    }
}
