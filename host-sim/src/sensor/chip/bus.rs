use std::cell::RefCell;

use embedded_hal::i2c::{ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};

use super::VirtualSensor;

/// A bus with one virtual sensor, for code that drives sensors through `embedded-hal`.
#[derive(Clone, Copy, Debug)]
pub struct VirtualBus<'a>(pub &'a RefCell<VirtualSensor>);

/// Nobody acknowledged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotAcknowledged(pub NoAcknowledgeSource);

impl embedded_hal::i2c::Error for NotAcknowledged {
    fn kind(&self) -> ErrorKind {
        ErrorKind::NoAcknowledge(self.0)
    }
}

impl ErrorType for VirtualBus<'_> {
    type Error = NotAcknowledged;
}

impl I2c for VirtualBus<'_> {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), NotAcknowledged> {
        let mut sensor = self.0.borrow_mut();
        let transfer = || {
            // A start before the first operation and wherever the direction changes.
            let mut direction = None;
            for operation in operations {
                let read = matches!(operation, Operation::Read(_));
                if direction.replace(read) != Some(read) && !sensor.start(address, read) {
                    return Err(NotAcknowledged(NoAcknowledgeSource::Address));
                }
                match operation {
                    Operation::Read(data) => data.fill_with(|| sensor.read()),
                    Operation::Write(data) => {
                        if !data.iter().all(|&byte| sensor.write(byte)) {
                            return Err(NotAcknowledged(NoAcknowledgeSource::Data));
                        }
                    }
                }
            }
            Ok(())
        };
        let result = transfer();
        sensor.stop();
        result
    }
}
