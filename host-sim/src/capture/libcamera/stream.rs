//! From settings to a camera that streams. All of it runs in libcamera's thread.

use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use std::sync::mpsc::{Receiver, channel};

use ::libcamera::camera::ActiveCamera;
use ::libcamera::framebuffer_allocator::FrameBufferAllocator;
use ::libcamera::framebuffer_map::MemoryMappedFrameBuffer;
use ::libcamera::request::Request;
use ::libcamera::stream::Stream;

use super::super::device::{FrameFormat, Opened, Settings};
use super::super::error::CaptureError;
use super::library::{Active, Cameras, Event};
use super::{control, format};

/// A camera that has begun.
pub(super) struct Started {
    pub(super) opened: Opened,
    pub(super) number: u64,
    pub(super) stream: Stream,
    pub(super) free: Arc<AtomicUsize>,
    pub(super) events: Receiver<Event>,
}

/// The camera of this name.
pub(super) fn find<'a>(cameras: &Cameras, id: &str) -> Result<::libcamera::camera::Camera<'a>, CaptureError> {
    cameras.manager.get(id).ok_or_else(|| {
        let list = cameras.manager.cameras();
        let known: Vec<String> = list.iter().map(|camera| camera.id().to_owned()).collect();
        if known.is_empty() {
            CaptureError::None
        } else {
            CaptureError::unknown("libcamera", "camera", id, known.iter().map(String::as_str))
        }
    })
}

pub(super) fn start(cameras: &mut Cameras, id: &str, settings: &Settings) -> Result<Started, CaptureError> {
    let refused = |setting: &str, error: &io::Error, remedy: &str| {
        CaptureError::refused(id, setting, &error.to_string(), remedy)
    };
    if settings.input.is_some() {
        return Err(CaptureError::refused(
            id,
            "--input",
            "cameras of libcamera have no connectors to choose from",
            "leave it out",
        ));
    }
    let mut camera = find(cameras, id)?
        .acquire()
        .map_err(|error| refused("to be captured from", &error, "another program uses it: end that"))?;
    let mut notes = Vec::new();
    let mut configuration = format::configuration(&camera, id, settings, &mut notes)?;
    camera
        .configure(&mut configuration)
        .map_err(|error| refused("its configuration", &error, "ask for another size or format"))?;
    let unknown = || refused("its configuration", &io::ErrorKind::NotFound.into(), "update libcamera");
    let configured = configuration.get(0).ok_or_else(unknown)?;
    let stream = configured.stream().ok_or_else(unknown)?;
    let (list, rate) = control::start_list(&camera, id, settings, &mut notes)?;
    let size = configured.get_size();
    let format = FrameFormat {
        code: format::code_of(configured.get_pixel_format()),
        width: size.width,
        height: size.height,
        strides: vec![configured.get_stride()],
        yuv: format::meaning(configured.get_color_space()),
        rate,
    };
    let requests = requests(&mut camera, id, &stream)?;
    let (sender, events) = channel();
    let (finished, disconnected) = (sender.clone(), sender.clone());
    camera.on_request_completed(move |request| drop(finished.send(Event::Finished(request))));
    camera.on_disconnected(move || drop(disconnected.send(Event::Disconnected)));
    camera
        .start(Some(&list))
        .map_err(|error| refused("streaming", &error, "take a smaller size, or see `dmesg`"))?;
    let free = Arc::new(AtomicUsize::new(requests.len()));
    for request in requests {
        camera
            .queue_request(request)
            .map_err(|(_, error)| refused("a buffer", &error, "take a smaller size, or see `dmesg`"))?;
    }
    let number = cameras.keep(Active { camera, events: sender, free: Arc::clone(&free) });
    Ok(Started { opened: Opened { name: id.to_owned(), format, notes }, number, stream, free, events })
}

/// A request for each piece of memory that the camera allocates.
fn requests(camera: &mut ActiveCamera<'_>, id: &str, stream: &Stream) -> Result<Vec<Request>, CaptureError> {
    const HEAPS: &str = "libcamera takes it of /dev/dma_heap/* or /dev/udmabuf: check that there is one, that you may read and write it \
                         (`sudo usermod -aG video $USER`, log in again), and that memory is free";
    let memory = |what: &str| CaptureError::refused(id, "memory for frames", what, HEAPS);
    let buffers =
        FrameBufferAllocator::new(camera).alloc(stream).map_err(|error| memory(&error.to_string()))?;
    buffers
        .into_iter()
        .map(|buffer| {
            let mapped = MemoryMappedFrameBuffer::new(buffer).map_err(|error| memory(&error.to_string()))?;
            let mut request = camera.create_request(None).ok_or_else(|| memory("no request for a frame"))?;
            request.add_buffer(stream, mapped).map_err(|error| memory(&error.to_string()))?;
            Ok(request)
        })
        .collect()
}
