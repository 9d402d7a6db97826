use std::os::fd::AsFd;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

use super::call::{BufferRequest, REQUEST_BUFFERS, STREAM_OFF, STREAM_ON, call, call_buffer};
use super::device::Device;
use super::error::Error;
use super::map::Map;
use super::raw::{self, Plain};

/// A device that streams.
///
/// The driver fills the buffers that it has; [`Stream::next`] takes the oldest full one from it, and dropping the
/// [`Buffer`], from whichever thread, gives it back. Dropping the stream stops the device.
#[derive(Debug)]
pub struct Stream {
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    device: Device,
    /// The planes of each buffer.
    maps: Vec<Vec<Map>>,
    /// Buffers that the driver has.
    queued: AtomicU32,
    /// Why one could not be given back.
    failed: Mutex<Option<Errno>>,
}

/// A frame in memory that the driver wrote, and that is the driver's again when this is dropped.
#[derive(Debug)]
pub struct Buffer {
    shared: Arc<Shared>,
    index: usize,
    sequence: u32,
    flags: u32,
    time: Duration,
    /// Where the data stands in each plane.
    data: Vec<(usize, usize)>,
}

impl Stream {
    /// Begins to stream into `buffers` mapped buffers. The driver may take more or fewer.
    ///
    /// # Errors
    /// If the device refuses: most often another program streams from it. It is busy as well as long as a [`Buffer`] of
    /// an earlier stream is held.
    pub fn start(device: &Device, buffers: u32) -> Result<Self, Error> {
        // Buffers are known by their numbers, which those of an earlier stream have as well.
        if device.streams.swap(true, Ordering::AcqRel) {
            return Err(device.error(REQUEST_BUFFERS.name, Errno::BUSY));
        }
        let mut shared = Shared {
            device: device.clone(),
            maps: Vec::new(),
            queued: AtomicU32::new(0),
            failed: Mutex::new(None),
        };
        let mut request = raw::RequestBuffers {
            count: buffers,
            kind: device.kind,
            memory: raw::MAPPED,
            ..raw::RequestBuffers::ZERO
        };
        device.call(&REQUEST_BUFFERS, &mut request)?;
        for index in 0..request.count {
            shared.maps.push(map_buffer(device, index)?);
        }
        if shared.maps.is_empty() {
            return Err(device.error(REQUEST_BUFFERS.name, Errno::NOMEM));
        }
        for index in 0..shared.maps.len() {
            shared.queue(index).map_err(|errno| device.error("VIDIOC_QBUF", errno))?;
        }
        device.call(&STREAM_ON, &mut { device.kind })?;
        Ok(Self { shared: Arc::new(shared) })
    }

    /// Buffers in all.
    #[must_use]
    pub fn buffers(&self) -> usize {
        self.shared.maps.len()
    }

    /// Buffers that the driver has now, full or to be filled.
    #[must_use]
    pub fn queued(&self) -> u32 {
        self.shared.queued.load(Ordering::Acquire)
    }

    /// Waits for a frame, no longer than `timeout`; `None` if none came.
    ///
    /// # Errors
    /// If the device is gone ([`Error::is_gone`]), stops by itself, or did not take a buffer back.
    pub fn next(&self, timeout: Duration) -> Result<Option<Buffer>, Error> {
        let device = &self.shared.device;
        let deadline = Instant::now() + timeout;
        loop {
            if let Some(errno) = self.shared.failed().take() {
                return Err(device.error("VIDIOC_QBUF", errno));
            }
            match self.dequeue() {
                Ok(buffer) => return Ok(Some(buffer)),
                Err(Errno::AGAIN) => {}
                Err(errno) => return Err(device.error("VIDIOC_DQBUF", errno)),
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(None);
            }
            let left = Timespec { tv_sec: left.as_secs() as i64, tv_nsec: left.subsec_nanos().into() };
            let mut waited = [PollFd::new(&*device.file, PollFlags::IN)];
            match poll(&mut waited, Some(&left)) {
                Ok(_) => {}
                // The caller may want to know of the signal.
                Err(Errno::INTR) => return Ok(None),
                Err(errno) => return Err(device.error("poll", errno)),
            }
            let events = waited[0].revents();
            if events.contains(PollFlags::ERR) && !events.contains(PollFlags::IN) {
                // What is wrong is what dequeuing says.
                match self.dequeue() {
                    Ok(buffer) => return Ok(Some(buffer)),
                    Err(Errno::AGAIN) => return Err(device.error("poll", Errno::IO)),
                    Err(errno) => return Err(device.error("VIDIOC_DQBUF", errno)),
                }
            }
        }
    }

    fn dequeue(&self) -> Result<Buffer, Errno> {
        let shared = &self.shared;
        let mut raw = raw::Buffer { kind: shared.device.kind, memory: raw::MAPPED, ..raw::Buffer::ZERO };
        let mut planes = [raw::Plane::ZERO; raw::PLANES];
        call_buffer(shared.device.fd(), BufferRequest::Dequeue, &mut raw, &mut planes)?;
        shared.queued.fetch_sub(1, Ordering::AcqRel);
        let index = raw.index as usize;
        let maps = shared.maps.get(index).ok_or(Errno::IO)?;
        let data = maps
            .iter()
            .zip(&planes)
            .map(|(map, plane)| {
                let single = raw.kind == raw::CAPTURE;
                let (start, end) =
                    if single { (0, raw.bytes_used) } else { (plane.data_offset, plane.bytes_used) };
                // A driver may say anything; the map is what there is.
                let end = (end as usize).min(map.len());
                ((start as usize).min(end), end)
            })
            .collect();
        let time = Duration::from_secs(raw.seconds.max(0) as u64)
            + Duration::from_micros(raw.microseconds.max(0) as u64);
        Ok(Buffer { shared: Arc::clone(shared), index, sequence: raw.sequence, flags: raw.flags, time, data })
    }
}

impl Drop for Stream {
    fn drop(&mut self) {
        let device = &self.shared.device;
        // A device that is gone has stopped.
        let _ = call(device.fd(), &STREAM_OFF, &mut { device.kind });
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        self.maps.clear();
        let mut none =
            raw::RequestBuffers { kind: self.device.kind, memory: raw::MAPPED, ..raw::RequestBuffers::ZERO };
        // So that the device can be set otherwise and stream again; if it is gone, so are its buffers.
        let _ = call(self.device.fd(), &REQUEST_BUFFERS, &mut none);
        self.device.streams.store(false, Ordering::Release);
    }
}

impl Shared {
    fn failed(&self) -> std::sync::MutexGuard<'_, Option<Errno>> {
        self.failed.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    fn queue(&self, index: usize) -> Result<(), Errno> {
        let mut raw = raw::Buffer {
            index: index as u32,
            kind: self.device.kind,
            memory: raw::MAPPED,
            ..raw::Buffer::ZERO
        };
        // Counted before: as soon as the driver has it, another thread may take it back, filled.
        self.queued.fetch_add(1, Ordering::AcqRel);
        call_buffer(self.device.fd(), BufferRequest::Queue, &mut raw, &mut [raw::Plane::ZERO; raw::PLANES])
            .inspect_err(|_| _ = self.queued.fetch_sub(1, Ordering::AcqRel))
    }
}

/// Asks where the planes of a buffer are, and maps them.
fn map_buffer(device: &Device, index: u32) -> Result<Vec<Map>, Error> {
    let mut raw = raw::Buffer { index, kind: device.kind, memory: raw::MAPPED, ..raw::Buffer::ZERO };
    let mut planes = [raw::Plane::ZERO; raw::PLANES];
    call_buffer(device.fd(), BufferRequest::Query, &mut raw, &mut planes)
        .map_err(|errno| device.error("VIDIOC_QUERYBUF", errno))?;
    if raw.kind == raw::CAPTURE {
        (planes[0].m, planes[0].length) = (raw.m, raw.length);
        raw.length = 1;
    }
    planes[..(raw.length as usize).min(raw::PLANES)]
        .iter()
        // The offset is the low 32 bits of the union.
        .map(|plane| Map::new(device.file.as_fd(), plane.m & 0xFFFF_FFFF, plane.length as usize))
        .collect::<Result<_, _>>()
        .map_err(|errno| device.error("mmap", errno))
}

impl Buffer {
    /// The bytes of each piece of memory, as many as the driver wrote.
    pub fn planes(&self) -> impl Iterator<Item = &[u8]> {
        let maps = self.shared.maps.get(self.index).map_or(&[][..], Vec::as_slice);
        maps.iter().zip(&self.data).map(|(map, &(start, end))| &map.bytes()[start..end])
    }

    /// Frames that the device has taken before this one; after 2³²−1 comes 0.
    #[must_use]
    pub fn sequence(&self) -> u32 {
        self.sequence
    }

    /// Whether the driver says that the data is damaged.
    #[must_use]
    pub fn is_error(&self) -> bool {
        self.flags & raw::BUFFER_ERROR != 0
    }

    /// When it was taken, by the clock that the driver uses: most often the monotonic one.
    #[must_use]
    pub fn time(&self) -> Duration {
        self.time
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        if let Err(errno) = self.shared.queue(self.index) {
            // Said by the next call of `Stream::next`.
            *self.shared.failed() = Some(errno);
        }
    }
}
