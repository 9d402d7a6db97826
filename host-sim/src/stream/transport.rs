use std::io::{self, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::time::Duration;

/// Where a device can be reached.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// `HOST:PORT`; port 0 takes a free one.
    Tcp(String),
    /// A pseudo-terminal.
    Pty,
}

/// Why a device can't be reached.
#[derive(Debug, thiserror::Error)]
pub enum TransportError {
    /// No listening at this address.
    #[error(
        "{address}: can't listen there ({error}); write HOST:PORT of this machine, with port 0 for a free one"
    )]
    Tcp {
        /// The address.
        address: String,
        /// The system's words.
        error: io::Error,
    },
    /// No pseudo-terminal.
    #[error("a pseudo-terminal can't be opened ({0}); take --tcp instead")]
    Pty(io::Error),
}

/// What became of the other end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    /// Somebody is there.
    Came,
    /// Nobody is there any more.
    Gone,
}

/// A channel of bytes to one host at a time. Nothing here waits but [`Transport::wait`].
pub(super) trait Transport {
    /// What the inspector opens.
    fn url(&self) -> String;
    /// Looks whether a host came or went.
    fn attend(&mut self) -> Option<Change>;
    /// Takes bytes that came; 0 if there are none.
    fn read(&mut self, bytes: &mut [u8]) -> usize;
    /// Gives as many bytes as are taken at once.
    fn write(&mut self, bytes: &[u8]) -> usize;
    /// Waits until a byte came, a host came, or, if `to_write`, bytes are taken again.
    fn wait(&self, longest: Duration, to_write: bool);
}

/// Opens it.
///
/// # Errors
/// [`TransportError`].
pub(super) fn open(address: &Address) -> Result<Box<dyn Transport>, TransportError> {
    match address {
        Address::Tcp(address) => {
            let opened = Tcp::open(address);
            let opened = opened.map_err(|error| TransportError::Tcp { address: address.clone(), error })?;
            Ok(Box::new(opened))
        }
        #[cfg(unix)]
        Address::Pty => Ok(Box::new(super::pty::Pty::open().map_err(TransportError::Pty)?)),
        #[cfg(not(unix))]
        Address::Pty => Err(TransportError::Pty(io::ErrorKind::Unsupported.into())),
    }
}

struct Tcp {
    listener: TcpListener,
    host: Option<TcpStream>,
    broken: bool,
}

impl Tcp {
    fn open(address: &str) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Self { listener, host: None, broken: false })
    }

    /// What reading or writing gave; an end is noted.
    fn moved(&mut self, result: &io::Result<usize>) -> usize {
        match result {
            Ok(0) => self.broken = true,
            Ok(count) => return *count,
            Err(error) => {
                let later = matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted);
                self.broken |= !later;
            }
        }
        0
    }
}

impl Transport for Tcp {
    fn url(&self) -> String {
        self.listener.local_addr().map(|address| format!("socket://{address}")).unwrap_or_default()
    }

    fn attend(&mut self) -> Option<Change> {
        if std::mem::take(&mut self.broken) {
            self.host = None;
            return Some(Change::Gone);
        }
        let (stream, peer) = self.listener.accept().ok()?;
        if self.host.is_some() {
            eprintln!("note: {peer} was turned away; one host at a time");
            return None;
        }
        // Without these it would still work, slowly.
        stream.set_nonblocking(true).ok()?;
        let _ = stream.set_nodelay(true);
        self.host = Some(stream);
        Some(Change::Came)
    }

    fn read(&mut self, bytes: &mut [u8]) -> usize {
        let Some(host) = &mut self.host else { return 0 };
        let result = host.read(bytes);
        self.moved(&result)
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        let Some(host) = &mut self.host else { return 0 };
        if bytes.is_empty() {
            return 0;
        }
        let result = host.write(bytes);
        self.moved(&result)
    }

    #[cfg(unix)]
    fn wait(&self, longest: Duration, to_write: bool) {
        if self.broken {
            return;
        }
        let listener: (&dyn std::os::fd::AsFd, bool) = (&self.listener, false);
        match &self.host {
            Some(host) => super::pty::wait_for(&[listener, (host, to_write)], longest),
            None => super::pty::wait_for(&[listener], longest),
        }
    }

    #[cfg(not(unix))]
    fn wait(&self, longest: Duration, _: bool) {
        std::thread::sleep(longest.min(Duration::from_millis(1)));
    }
}
