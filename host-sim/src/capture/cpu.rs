use std::time::Duration;

/// The processor time of a thread from here on.
#[derive(Debug)]
pub(super) struct ThreadTime(Option<Duration>);

impl ThreadTime {
    pub(super) fn start() -> Self {
        Self(now())
    }

    /// What this thread has spent since; nothing where the system does not tell.
    pub(super) fn spent(&self) -> Option<Duration> {
        Some(now()?.saturating_sub(self.0?))
    }
}

#[cfg(target_os = "linux")]
fn now() -> Option<Duration> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Some(Duration::new(time.tv_sec.try_into().ok()?, time.tv_nsec.try_into().ok()?))
}

#[cfg(not(target_os = "linux"))]
fn now() -> Option<Duration> {
    None
}
