//! The one thread in which libcamera lives.
//!
//! A process may have one camera manager, and neither that nor a camera may change threads. So a thread of its own has
//! them all, and does what it is told to, in order. It ends with its last user, and the next user starts another.

use std::collections::HashMap;
use std::io;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use ::libcamera::camera::ActiveCamera;
use ::libcamera::camera_manager::CameraManager;
use ::libcamera::logging::{LoggingTarget, log_set_target};
use ::libcamera::request::{Request, ReuseFlag};

use super::super::error::CaptureError;

/// What a camera tells.
#[derive(Debug)]
pub(super) enum Event {
    /// A frame is there, or was given up.
    Finished(Request),
    /// The camera was unplugged.
    Disconnected,
    /// It takes no memory for a frame any more.
    Refused(io::Error),
}

/// What lives in the thread.
pub(super) struct Cameras {
    /// Those that stream. They go before the manager.
    active: HashMap<u64, Active>,
    pub(super) manager: CameraManager,
    next: u64,
}

/// A camera that streams.
pub(super) struct Active {
    pub(super) camera: ActiveCamera<'static>,
    pub(super) events: Sender<Event>,
    /// Buffers that the camera has.
    pub(super) free: Arc<AtomicUsize>,
}

impl Cameras {
    fn new(manager: CameraManager) -> Self {
        Self { active: HashMap::new(), manager, next: 0 }
    }

    /// Keeps a camera, and says by which number.
    pub(super) fn keep(&mut self, camera: Active) -> u64 {
        self.next += 1;
        self.active.insert(self.next, camera);
        self.next
    }

    /// Gives a camera the memory of a frame back. Of one that has ended, it is freed.
    pub(super) fn give_back(&mut self, camera: u64, mut request: Request) {
        let Some(active) = self.active.get(&camera) else { return };
        request.reuse(ReuseFlag::REUSE_BUFFERS);
        // Counted before, as the frame may be there at once.
        active.free.fetch_add(1, Ordering::SeqCst);
        if let Err((_, error)) = active.camera.queue_request(request) {
            active.free.fetch_sub(1, Ordering::SeqCst);
            let _ = active.events.send(Event::Refused(error));
        }
    }

    /// Ends a stream. What is under way comes back as events, so there must be somebody to take them.
    pub(super) fn end(&mut self, camera: u64) {
        if let Some(mut active) = self.active.remove(&camera) {
            let _ = active.camera.stop();
        }
    }
}

type Task = Box<dyn FnOnce(&mut Cameras) + Send>;

/// Somebody who needs libcamera.
#[derive(Debug)]
pub(super) struct Library {
    tasks: Sender<Task>,
}

/// The thread, and how many need it.
struct Running {
    users: usize,
    tasks: Sender<Task>,
    thread: JoinHandle<()>,
}

/// Locked while the thread starts and while it ends, so that there are never two managers.
static RUNNING: Mutex<Option<Running>> = Mutex::new(None);

fn failed(what: String) -> CaptureError {
    CaptureError::Open {
        device: "libcamera".to_owned(),
        what,
        remedy: "LIBCAMERA_LOG_LEVELS=WARN in the environment shows what it says",
    }
}

impl Library {
    /// Starts libcamera, if nobody has yet.
    pub(super) fn open() -> Result<Self, CaptureError> {
        let mut running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(running) = &mut *running {
            running.users += 1;
            return Ok(Self { tasks: running.tasks.clone() });
        }
        let (tasks, received) = channel::<Task>();
        let (started, is_started) = channel();
        let thread = std::thread::Builder::new().name("libcamera".to_owned()).spawn(move || {
            // It is talkative, and writes over the live count.
            if ["LIBCAMERA_LOG_LEVELS", "LIBCAMERA_LOG_FILE"]
                .iter()
                .all(|name| std::env::var_os(name).is_none())
            {
                let _ = log_set_target(LoggingTarget::None);
            }
            match CameraManager::new() {
                Ok(manager) => {
                    let _ = started.send(Ok(()));
                    let mut cameras = Cameras::new(manager);
                    received.into_iter().for_each(|task| task(&mut cameras));
                }
                Err(error) => drop(started.send(Err(error))),
            }
        });
        let thread = thread.map_err(|error| failed(error.to_string()))?;
        match is_started.recv() {
            Ok(Ok(())) => {
                *running = Some(Running { users: 1, tasks: tasks.clone(), thread });
                Ok(Self { tasks })
            }
            Ok(Err(error)) => Err(failed(error.to_string())),
            Err(_) => Err(failed("it failed when it started".to_owned())),
        }
    }

    /// Has something done, when what is told before is done.
    pub(super) fn tell(&self, task: impl FnOnce(&mut Cameras) + Send + 'static) {
        // A thread that has failed has nothing to be done with.
        let _ = self.tasks.send(Box::new(task));
    }

    /// Has something done and waits for what it gives.
    pub(super) fn ask<T: Send + 'static>(
        &self,
        task: impl FnOnce(&mut Cameras) -> T + Send + 'static,
    ) -> Result<T, CaptureError> {
        let (sender, receiver) = channel();
        self.tell(move |cameras| drop(sender.send(task(cameras))));
        receiver.recv().map_err(|_| failed("it has failed".to_owned()))
    }
}

impl Drop for Library {
    fn drop(&mut self) {
        let mut running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(one) = &mut *running else { return };
        one.users -= 1;
        if one.users > 0 {
            return;
        }
        if let Some(Running { tasks, thread, .. }) = running.take() {
            // Without anybody to tell it something the thread ends; this is the last but one to go.
            drop((tasks, std::mem::replace(&mut self.tasks, channel().0)));
            let _ = thread.join();
        }
    }
}
