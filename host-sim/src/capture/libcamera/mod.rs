//! Cameras of libcamera: those of systems on chip, whose sensor, receiver and image processor it puts together, and USB webcams.
//!
//! | file | what lives there |
//! |---|---|
//! | `library` | the thread in which libcamera lives |
//! | `format` | pixel formats and sizes by V4L2's codes |
//! | `control` | controls by name, rate, crop |
//! | `stream` | from settings to a camera that streams |
//!
//! Frames are lent out in the camera's memory, as those of V4L2 are.

mod library;
mod format;
mod control;
mod stream;

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use ::libcamera::framebuffer::{AsFrameBuffer as _, FrameMetadataStatus};
use ::libcamera::framebuffer_allocator::FrameBuffer;
use ::libcamera::framebuffer_map::MemoryMappedFrameBuffer;
use ::libcamera::properties;
use ::libcamera::request::{Request, RequestStatus};
use ::libcamera::stream::Stream;

use super::device::{CaptureDevice, Captured, Found, Opened, Settings};
use super::error::CaptureError;
pub use control::{FoundControl, controls};
use library::{Event, Library};

/// What is looked at where no camera is found.
pub const ADVICE: &str = "\
libcamera: it finds no camera. Check the cable and the sensor's overlay, that you may read /dev/media* and /dev/video*,
      and what LIBCAMERA_LOG_LEVELS=DEBUG in the environment shows";

/// Every camera.
///
/// # Errors
/// [`CaptureError::Open`] if libcamera can't be started.
pub fn list() -> Result<Vec<Found>, CaptureError> {
    Library::open()?.ask(|cameras| {
        let place = format!("libcamera {}", cameras.manager.version());
        let list = cameras.manager.cameras();
        let found = list.iter().map(|camera| Found {
            interface: "libcamera",
            id: camera.id().to_owned(),
            name: camera
                .properties()
                .get::<properties::Model>()
                .map_or_else(|_| "camera".to_owned(), |model| model.0),
            place: place.clone(),
            inputs: Vec::new(),
            media_controlled: false,
            rates: control::rates(&camera),
            formats: format::listed(&camera),
        });
        found.collect()
    })
}

/// A camera that streams.
#[derive(Debug)]
pub struct Libcamera {
    opened: Opened,
    number: u64,
    stream: Stream,
    free: Arc<AtomicUsize>,
    events: Receiver<Event>,
    user: Arc<Library>,
}

impl Libcamera {
    /// Chooses, configures and starts a camera.
    ///
    /// # Errors
    /// [`CaptureError`] with the setting that was refused, and what there is instead.
    pub fn start(id: &str, settings: &Settings) -> Result<Self, CaptureError> {
        let user = Arc::new(Library::open()?);
        let (id, settings) = (id.to_owned(), settings.clone());
        let started = user.ask(move |cameras| stream::start(cameras, &id, &settings))??;
        let stream::Started { opened, number, stream, free, events } = started;
        Ok(Self { opened, number, stream, free, events, user })
    }
}

impl CaptureDevice for Libcamera {
    fn opened(&self) -> &Opened {
        &self.opened
    }

    fn buffers(&self) -> usize {
        self.free.load(Ordering::SeqCst)
    }

    fn next(&mut self, timeout: Duration) -> Result<Option<Box<dyn Captured>>, CaptureError> {
        match self.events.recv_timeout(timeout) {
            Ok(Event::Finished(request)) => {
                self.free.fetch_sub(1, Ordering::SeqCst);
                // What is given up is so because the camera is gone or stopped, which is said by itself.
                if request.status() == RequestStatus::Cancelled {
                    return Ok(None);
                }
                Ok(Some(Box::new(Frame {
                    request: Some(request),
                    stream: self.stream,
                    camera: self.number,
                    user: Arc::clone(&self.user),
                })))
            }
            Ok(Event::Disconnected) => Err(self.opened.gone()),
            Ok(Event::Refused(error)) => {
                Err(self.opened.stopped(format!("it takes no more buffers: {error}")))
            }
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(self.opened.stopped("libcamera has ended".to_owned())),
        }
    }
}

impl Drop for Libcamera {
    fn drop(&mut self) {
        let number = self.number;
        // Waits, because what is under way comes back through the events.
        let _ = self.user.ask(move |cameras| cameras.end(number));
    }
}

/// A frame in the memory of its camera.
#[derive(Debug)]
struct Frame {
    request: Option<Request>,
    stream: Stream,
    camera: u64,
    user: Arc<Library>,
}

impl Frame {
    fn buffer(&self) -> Option<&MemoryMappedFrameBuffer<FrameBuffer>> {
        self.request.as_ref()?.buffer(&self.stream)
    }
}

impl Captured for Frame {
    fn planes(&self) -> Vec<&[u8]> {
        let Some(buffer) = self.buffer() else { return Vec::new() };
        let mut planes = buffer.data();
        // Virtual cameras say nothing of their frames.
        if let Some(metadata) = buffer.metadata() {
            let written = metadata.planes();
            for (plane, written) in planes.iter_mut().zip(&written) {
                *plane = &plane[..plane.len().min(written.bytes_used as usize)];
            }
        }
        // They also give three planes where the format has two.
        while planes.len() > 1 && planes.last().is_some_and(|plane| plane.is_empty()) {
            planes.pop();
        }
        planes
    }

    fn sequence(&self) -> u32 {
        let request = self.request.as_ref().map_or(0, Request::sequence);
        let metadata = self.buffer().and_then(|buffer| buffer.metadata());
        metadata.map_or(request, |metadata| metadata.sequence())
    }

    fn is_damaged(&self) -> bool {
        let metadata = self.buffer().and_then(|buffer| buffer.metadata());
        metadata.is_some_and(|metadata| metadata.status() != FrameMetadataStatus::Success)
    }
}

impl Drop for Frame {
    fn drop(&mut self) {
        if let Some(request) = self.request.take() {
            let camera = self.camera;
            self.user.tell(move |cameras| cameras.give_back(camera, request));
        }
    }
}
