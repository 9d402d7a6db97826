//! The virtual sensor on the board's I2C.

use std::sync::{Arc, Mutex, PoisonError};

use host_sim::sensor::VirtualSensor;
use rigless::chip::Timeline;
use rigless::chip::i2c::Peer;
use rigless::snapshot::Store;

/// A sensor that the bus and the camera's pins share.
pub type Shared = Arc<Mutex<VirtualSensor>>;

/// The sensor's side of the bus.
#[derive(Clone, Debug)]
pub struct SensorOnI2c(pub Shared);

impl SensorOnI2c {
    fn with<T>(&self, access: impl FnOnce(&mut VirtualSensor) -> T) -> T {
        access(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Store for SensorOnI2c {}

impl Peer for SensorOnI2c {
    fn start(&mut self, address: u8, read: bool, _: &mut Timeline<'_, '_>) -> bool {
        self.with(|sensor| sensor.start(address, read))
    }

    fn write(&mut self, byte: u8, _: &mut Timeline<'_, '_>) -> bool {
        self.with(|sensor| sensor.write(byte))
    }

    fn read(&mut self, _: bool, _: &mut Timeline<'_, '_>) -> u8 {
        self.with(VirtualSensor::read)
    }

    fn stop(&mut self, _: &mut Timeline<'_, '_>) {
        self.with(VirtualSensor::stop);
    }
}
