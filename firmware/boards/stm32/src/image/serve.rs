//! Which camera the interrupt handlers serve.

use core::cell::Cell;

use critical_section::Mutex;
use firmware::driver::FrameCamera;

use crate::port::DcmiPort;
use crate::silicon::Mmio;

/// A camera over the silicon.
pub type Camera<const N: usize> = FrameCamera<'static, DcmiPort<'static, Mmio>, N>;

/// Whatever has interrupts to serve.
pub trait Serve: Sync {
    /// Serves them.
    fn serve(&self);
}

impl<const N: usize> Serve for Camera<N> {
    fn serve(&self) {
        self.on_interrupt();
    }
}

static SERVED: Mutex<Cell<Option<&'static dyn Serve>>> = Mutex::new(Cell::new(None));

/// From now on the handlers serve this camera.
pub fn register(camera: &'static dyn Serve) {
    critical_section::with(|section| SERVED.borrow(section).set(Some(camera)));
}

/// The handler of DCMI's interrupt and of the stream's.
pub fn on_interrupt() {
    if let Some(camera) = critical_section::with(|section| SERVED.borrow(section).get()) {
        camera.serve();
    }
}
