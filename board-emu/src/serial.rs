//! The far end of the board's serial port.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use rigless::chip::Timeline;
use rigless::chip::uart::Peer;
use rigless::snapshot::Store;
use rigless::time::VirtualNanos;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

/// Bytes that the board has sent, shared with whoever wants to read them after the run.
#[derive(Clone, Debug, Default)]
pub struct Received(Arc<Mutex<Vec<u8>>>);

impl Received {
    /// All bytes so far.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// How many they are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).len()
    }

    /// None at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn push(&self, byte: u8) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(byte);
    }
}

/// Keeps what the board sends, sends what it is given at once, and may pass everything on to a host.
#[derive(Debug, Default)]
pub struct FarEnd {
    received: Received,
    to_send: VecDeque<u8>,
    /// When the next byte of those may be sent, and how long each takes, in virtual nanoseconds.
    pace: (u64, u64),
    host: Option<Host>,
}

/// Who is on the other side, outside.
#[derive(Debug)]
enum Host {
    File(File),
    Line { line: Line, looked: VirtualNanos },
}

/// A line that goes both ways.
#[derive(Debug)]
enum Line {
    Socket(TcpStream),
    Terminal(Terminal),
}

/// The master of a pseudo-terminal. The slave is kept open, so that what is sent waits for a reader who comes late.
#[derive(Debug)]
struct Terminal {
    master: File,
    slave: OwnedFd,
}

/// How often, in virtual time, a line is looked at: a look is a system call.
const LOOK: u64 = 100_000;
/// How long, in real time, the end of a run waits for the other side to take what was sent.
const GRACE: Duration = Duration::from_secs(2);

impl Line {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if !is_readable(self, Duration::ZERO) {
            return Err(ErrorKind::WouldBlock.into());
        }
        match self {
            Self::Socket(stream) => stream.read(buffer),
            Self::Terminal(terminal) => terminal.master.read(buffer),
        }
    }

    /// Waits for a slow host, so that nothing is lost.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::Socket(stream) => stream.write_all(bytes),
            Self::Terminal(terminal) => terminal.master.write_all(bytes),
        }
    }
}

impl AsFd for Line {
    fn as_fd(&self) -> BorrowedFd<'_> {
        match self {
            Self::Socket(stream) => stream.as_fd(),
            Self::Terminal(terminal) => terminal.master.as_fd(),
        }
    }
}

/// Whether something is there to be read, at the latest after `longest`.
fn is_readable(end: &impl AsFd, longest: Duration) -> bool {
    let timeout = Timespec { tv_sec: longest.as_secs() as i64, tv_nsec: longest.subsec_nanos().into() };
    poll(&mut [PollFd::new(end, PollFlags::IN)], Some(&timeout)).is_ok_and(|ready| ready > 0)
}

/// A line that ends leaves its other side time to take what was sent: closing it drops that.
impl Drop for Line {
    fn drop(&mut self) {
        let until = Instant::now() + GRACE;
        match self {
            Self::Socket(stream) => {
                let mut rest = [0; 256];
                let _ = stream.shutdown(Shutdown::Write);
                while let Some(left) = until.checked_duration_since(Instant::now()) {
                    if !is_readable(stream, left) || !matches!(stream.read(&mut rest), Ok(1..)) {
                        break;
                    }
                }
            }
            Self::Terminal(terminal) => {
                while is_readable(&terminal.slave, Duration::ZERO) && Instant::now() < until {
                    std::thread::sleep(Duration::from_millis(10));
                }
            }
        }
    }
}

impl FarEnd {
    /// Nobody but memory listens.
    #[must_use]
    pub fn memory() -> Self {
        Self::default()
    }

    /// Bytes go to a file as well.
    ///
    /// # Errors
    /// If the file can't be made.
    pub fn file(path: &Path) -> io::Result<Self> {
        Ok(Self { host: Some(Host::File(File::create(path)?)), ..Self::default() })
    }

    /// Waits for a host to connect, then passes bytes both ways.
    ///
    /// # Errors
    /// If nobody can be listened for or taken on.
    pub fn accept(listener: &TcpListener) -> io::Result<Self> {
        let (stream, _) = listener.accept()?;
        stream.set_nodelay(true)?;
        Ok(Self::line(Line::Socket(stream)))
    }

    /// Opens a pseudo-terminal, and passes bytes both ways; also the name by which a host opens it. A run waits for a
    /// host once the terminal's buffer is full.
    ///
    /// # Errors
    /// If the system has none to give.
    pub fn terminal() -> io::Result<(Self, String)> {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&master)?;
        unlockpt(&master)?;
        let name = ptsname(&master, Vec::new())?.to_string_lossy().into_owned();
        let slave = rustix::fs::open(&name, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?;
        // Bytes pass as they are, and none comes back as an echo.
        let mut settings = tcgetattr(&slave)?;
        settings.make_raw();
        tcsetattr(&slave, OptionalActions::Now, &settings)?;
        let terminal = Terminal { master: File::from(master), slave };
        Ok((Self::line(Line::Terminal(terminal)), name))
    }

    fn line(line: Line) -> Self {
        Self { host: Some(Host::Line { line, looked: VirtualNanos(0) }), ..Self::default() }
    }

    /// Sends `bytes` to the board as soon as its receiver takes them.
    #[must_use]
    pub fn sending(mut self, bytes: impl IntoIterator<Item = u8>) -> Self {
        self.to_send.extend(bytes);
        self
    }

    /// Sends nothing before `from`, and then a byte each `gap` virtual nanoseconds: a core that is slow, or has its
    /// interrupts masked, loses bytes that come back to back.
    #[must_use]
    pub fn paced(mut self, from: u64, gap: u64) -> Self {
        self.pace = (from, gap);
        self
    }

    /// A handle to what the board sends.
    #[must_use]
    pub fn received(&self) -> Received {
        self.received.clone()
    }

    fn look(&mut self, now: VirtualNanos) {
        let Some(Host::Line { line, looked }) = &mut self.host else { return };
        if now.0 < looked.0.saturating_add(LOOK) {
            return;
        }
        *looked = now;
        let mut buffer = [0; 256];
        match line.read(&mut buffer) {
            Ok(0) => self.host = None,
            Ok(count) => self.to_send.extend(&buffer[..count]),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(_) => self.host = None,
        }
    }
}

impl Store for FarEnd {}

impl Peer for FarEnd {
    fn receive(&mut self, word: u16, _: &mut Timeline<'_, '_>) {
        let byte = word as u8;
        self.received.push(byte);
        let written = match &mut self.host {
            Some(Host::File(file)) => file.write_all(&[byte]),
            Some(Host::Line { line, .. }) => line.write(&[byte]),
            None => Ok(()),
        };
        if written.is_err() {
            // The host has gone; what the board sends is kept in memory still.
            self.host = None;
        }
    }

    fn transmit(&mut self, now: VirtualNanos) -> Option<u16> {
        self.look(now);
        if now.0 < self.pace.0 {
            return None;
        }
        let byte = self.to_send.pop_front()?;
        self.pace.0 = now.0.saturating_add(self.pace.1);
        Some(byte.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_terminal_passes_every_byte_as_it_is_both_ways() {
        let (mut end, name) = FarEnd::terminal().unwrap();
        let mut host = File::options().read(true).write(true).open(name).unwrap();
        // Among them those that a terminal would act on: end of file, interrupt, carriage return, XOFF.
        let bytes: Vec<u8> = (0..=255).collect();
        let Some(Host::Line { line, .. }) = &mut end.host else { panic!("a line") };
        line.write(&bytes).unwrap();
        let mut read = [0; 256];
        host.read_exact(&mut read).unwrap();
        assert_eq!(read[..], bytes);
        host.write_all(&bytes).unwrap();
        let mut now = 0;
        while end.to_send.len() < 256 {
            now += LOOK;
            end.look(VirtualNanos(now));
        }
        assert_eq!(end.to_send, bytes);
    }

    #[test]
    fn what_was_sent_last_arrives_although_the_run_is_over() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mut host = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let mut end = FarEnd::accept(&listener).unwrap();
        // What the board never took must not make the end abrupt.
        host.write_all(b"command").unwrap();
        let Some(Host::Line { line, .. }) = &mut end.host else { panic!("a line") };
        line.write(b"last words").unwrap();
        let reader = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(50));
            let mut all = Vec::new();
            host.read_to_end(&mut all).map(|_| all)
        });
        drop(end);
        assert_eq!(reader.join().unwrap().unwrap(), b"last words");
    }
}
