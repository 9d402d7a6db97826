//! The far end of the board's serial port.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use rigless::chip::Timeline;
use rigless::chip::uart::Peer;
use rigless::snapshot::Store;
use rigless::time::VirtualNanos;

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
    host: Option<Host>,
}

#[derive(Debug)]
enum Host {
    File(std::fs::File),
    Socket { stream: TcpStream, looked: VirtualNanos },
}

/// How often, in virtual time, the socket is looked at: a look is a system call.
const LOOK: u64 = 100_000;

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
        Ok(Self { host: Some(Host::File(std::fs::File::create(path)?)), ..Self::default() })
    }

    /// Waits for a host to connect, then passes bytes both ways.
    ///
    /// # Errors
    /// If nobody can be listened for or taken on.
    pub fn accept(listener: &TcpListener) -> io::Result<Self> {
        let (stream, _) = listener.accept()?;
        stream.set_nodelay(true)?;
        Ok(Self { host: Some(Host::Socket { stream, looked: VirtualNanos(0) }), ..Self::default() })
    }

    /// Sends `bytes` to the board as soon as its receiver takes them.
    #[must_use]
    pub fn sending(mut self, bytes: impl IntoIterator<Item = u8>) -> Self {
        self.to_send.extend(bytes);
        self
    }

    /// A handle to what the board sends.
    #[must_use]
    pub fn received(&self) -> Received {
        self.received.clone()
    }

    fn look(&mut self, now: VirtualNanos) {
        let Some(Host::Socket { stream, looked }) = &mut self.host else { return };
        if now.0 < looked.0.saturating_add(LOOK) {
            return;
        }
        *looked = now;
        let mut buffer = [0; 256];
        let read = stream.set_nonblocking(true).and_then(|()| stream.read(&mut buffer));
        // Sending waits for a slow host, so that nothing is lost.
        let blocking = stream.set_nonblocking(false);
        match (read, blocking) {
            (Ok(0), _) | (_, Err(_)) => self.host = None,
            (Ok(count), Ok(())) => self.to_send.extend(&buffer[..count]),
            (Err(error), Ok(())) if error.kind() == ErrorKind::WouldBlock => {}
            (Err(_), Ok(())) => self.host = None,
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
            Some(Host::Socket { stream, .. }) => stream.write_all(&[byte]),
            None => Ok(()),
        };
        if written.is_err() {
            // The host has gone; what the board sends is kept in memory still.
            self.host = None;
        }
    }

    fn transmit(&mut self, now: VirtualNanos) -> Option<u16> {
        self.look(now);
        self.to_send.pop_front().map(u16::from)
    }
}
