use std::io;
use std::os::fd::{AsFd, OwnedFd};
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, QueueSelector, tcflush, tcgetattr, tcsetattr};

use super::transport::{Change, Transport};

/// How long to sleep at most while nobody has the terminal open: its end can't be waited for.
const LOOK: Duration = Duration::from_millis(20);

/// Waits until one of these can be read, or written where that is asked for.
pub(super) fn wait_for(ends: &[(&dyn AsFd, bool)], longest: Duration) {
    let flags = |to_write| if to_write { PollFlags::IN | PollFlags::OUT } else { PollFlags::IN };
    let mut ends: Vec<_> =
        ends.iter().map(|&(end, to_write)| PollFd::from_borrowed_fd(end.as_fd(), flags(to_write))).collect();
    let timeout = Timespec {
        tv_sec: longest.as_secs().try_into().unwrap_or(1),
        tv_nsec: longest.subsec_nanos().into(),
    };
    // A signal ends it early, which is fine.
    let _ = poll(&mut ends, Some(&timeout));
}

/// A pseudo-terminal. Its slave is what the host opens; that is hung up while nobody has it open.
pub(super) struct Pty {
    master: OwnedFd,
    name: String,
    is_open: bool,
}

impl Pty {
    pub(super) fn open() -> io::Result<Self> {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&master)?;
        unlockpt(&master)?;
        rustix::io::ioctl_fionbio(&master, true)?;
        let name = ptsname(&master, Vec::new())?.to_string_lossy().into_owned();
        // Hung up is only what was open before.
        drop(rustix::fs::open(&name, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?);
        let pty = Self { master, name, is_open: false };
        pty.make_raw()?;
        Ok(pty)
    }

    /// Bytes pass as they are, and none comes back as an echo.
    fn make_raw(&self) -> io::Result<()> {
        let mut settings = tcgetattr(&self.master)?;
        settings.make_raw();
        Ok(tcsetattr(&self.master, OptionalActions::Now, &settings)?)
    }
}

impl Transport for Pty {
    fn url(&self) -> String {
        self.name.clone()
    }

    fn attend(&mut self) -> Option<Change> {
        let mut ends = [PollFd::new(&self.master, PollFlags::IN)];
        poll(&mut ends, Some(&Timespec { tv_sec: 0, tv_nsec: 0 })).ok()?;
        let is_open = !ends[0].revents().contains(PollFlags::HUP);
        if is_open == self.is_open {
            return None;
        }
        self.is_open = is_open;
        if is_open {
            // The host sets it as well, but may be later than the first byte.
            let _ = self.make_raw();
            Some(Change::Came)
        } else {
            // What nobody read is not for the next one.
            let _ = tcflush(&self.master, QueueSelector::IOFlush);
            Some(Change::Gone)
        }
    }

    fn read(&mut self, bytes: &mut [u8]) -> usize {
        // What is wrong with it is seen when it is attended.
        if self.is_open { rustix::io::read(&self.master, bytes).unwrap_or(0) } else { 0 }
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        if self.is_open { rustix::io::write(&self.master, bytes).unwrap_or(0) } else { 0 }
    }

    fn wait(&self, longest: Duration, to_write: bool) {
        if self.is_open {
            wait_for(&[(&self.master, to_write)], longest);
        } else {
            std::thread::sleep(longest.min(LOOK));
        }
    }
}
