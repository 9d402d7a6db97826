//! A camera that does as it is told, for tests.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use v4l2_capture::FourCc;

use super::device::{CaptureDevice, Captured, FrameFormat, Opened, YuvMeaning};
use super::error::CaptureError;

/// What comes next.
#[derive(Clone, Debug)]
pub(super) enum Event {
    /// A frame with this sequence number and these bytes.
    Frame(u32, Vec<u8>),
    /// One that is damaged.
    Damaged(u32),
    /// Damaged ones and nothing else from now on, one each millisecond.
    OnlyDamaged,
    /// Nothing, for as long as is waited.
    Nothing,
    /// The device is unplugged.
    Unplugged,
}

/// Gives what it is told to; afterwards nothing more comes.
#[derive(Debug)]
pub(super) struct Fake {
    pub(super) opened: Opened,
    pub(super) events: VecDeque<Event>,
    /// Buffers that it has, of 70.
    pub(super) free: Arc<AtomicUsize>,
}

#[derive(Debug)]
struct Lent {
    sequence: u32,
    bytes: Vec<u8>,
    damaged: bool,
    free: Arc<AtomicUsize>,
}

impl Fake {
    /// A camera of gray frames, 4 × 2 pixels, with lines of 5 bytes.
    pub(super) fn new(events: impl IntoIterator<Item = Event>) -> Self {
        let format = FrameFormat {
            code: FourCc::new(b"GREY"),
            width: 4,
            height: 2,
            strides: vec![5],
            yuv: YuvMeaning::default(),
            rate: None,
        };
        let opened = Opened { name: "fake".to_owned(), format, notes: Vec::new() };
        Self { opened, events: events.into_iter().collect(), free: Arc::new(AtomicUsize::new(70)) }
    }

    /// A whole frame with this number.
    pub(super) fn frame(sequence: u32) -> Event {
        Event::Frame(sequence, vec![sequence as u8; 9])
    }
}

impl CaptureDevice for Fake {
    fn opened(&self) -> &Opened {
        &self.opened
    }

    fn buffers(&self) -> usize {
        self.free.load(Ordering::SeqCst)
    }

    fn next(&mut self, timeout: Duration) -> Result<Option<Box<dyn Captured>>, CaptureError> {
        let (sequence, bytes, damaged) = match self.events.pop_front() {
            Some(Event::Frame(sequence, bytes)) => (sequence, bytes, false),
            Some(Event::Damaged(sequence)) => (sequence, vec![0; 9], true),
            Some(Event::OnlyDamaged) => {
                self.events.push_front(Event::OnlyDamaged);
                std::thread::sleep(Duration::from_millis(1));
                (0, vec![0; 9], true)
            }
            Some(Event::Unplugged) => return Err(self.opened.gone()),
            Some(Event::Nothing) | None => {
                std::thread::sleep(timeout);
                return Ok(None);
            }
        };
        self.free.fetch_sub(1, Ordering::SeqCst);
        Ok(Some(Box::new(Lent { sequence, bytes, damaged, free: Arc::clone(&self.free) })))
    }
}

impl Captured for Lent {
    fn planes(&self) -> Vec<&[u8]> {
        vec![&self.bytes]
    }

    fn sequence(&self) -> u32 {
        self.sequence
    }

    fn is_damaged(&self) -> bool {
        self.damaged
    }
}

impl Drop for Lent {
    fn drop(&mut self) {
        self.free.fetch_add(1, Ordering::SeqCst);
    }
}
