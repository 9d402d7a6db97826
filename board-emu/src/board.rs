//! The boards: a part, its crystal and rail, the camera on its pins, and whatever hangs on its serial port and I2C.

use std::num::NonZeroU64;
use std::sync::LazyLock;

use clap::ValueEnum;
use firmware::camif::{Bus, Part};
use rigless::chip::uart;
use rigless::emulator::CoreSpec;
use rigless::machine::stm32f427_bench::Stm32f427Bench;
use rigless::machine::stm32h743_bench::Stm32h743Bench;
use rigless::machine::{Board, Crystal, Target};
use rigless::mcu::Mcu;
use rigless::snapshot::Store;
use rigless::soc;
use rigless::soc::stm32f427::Stm32f427;
use rigless::soc::stm32f427::generated::dcmi::Register as F4Register;
use rigless::soc::stm32f427::peripherals::dma::{Dma, Wire};
use rigless::soc::stm32f427::peripherals::{CONTROLLERS, SERIAL_PORTS};
use rigless::soc::stm32h743::Stm32h743;
use rigless::soc::stm32h743::generated::dcmi::Register as H7Register;
use rigless::soc::stm32h743::peripherals::usart;

use crate::camera::Camera;
use crate::i2c::SensorOnI2c;
use crate::part::{CameraPart, WithCamera};

/// Boards that can be run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "lower")]
pub enum Kind {
    /// NUCLEO-H743ZI: STM32H743ZI, 8 MHz from the debugger, USART3 to its virtual COM port.
    Stm32h743,
    /// NUCLEO-F429ZI: STM32F429ZI, 8 MHz from the debugger, USART3 to its virtual COM port.
    Stm32f429,
}

impl Kind {
    /// The name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stm32h743 => "stm32h743",
            Self::Stm32f429 => "stm32f429",
        }
    }

    /// What the part's camera interface and DMA can do.
    #[must_use]
    pub const fn part(self) -> Part {
        match self {
            Self::Stm32h743 => Part::STM32H7,
            Self::Stm32f429 => Part::STM32F4,
        }
    }
}

/// The clock on the boards' OSC_IN, from the debugger's MCO.
const OSCILLATOR: Crystal = Crystal(8_000_000);
/// The rail, in millivolts.
const RAIL: u32 = 3300;
/// The serial port that the boards lead to the debugger.
const SERIAL_PORT: &str = "USART3";
/// The I2C that the camera hangs on, by its place among the part's: I2C1.
const SENSOR_I2C: usize = 0;

/// What hangs on a board beside the camera's pins.
#[derive(Debug)]
pub struct Wiring {
    /// The far end of USART3.
    pub serial: Box<dyn uart::Peer>,
    /// What answers on I2C1, if anything.
    pub sensor: Option<SensorOnI2c>,
}

/// A board.
#[derive(Debug)]
pub struct CameraBoard {
    kind: Kind,
    part: Boxed,
    core: CoreSpec,
}

#[derive(Debug)]
enum Boxed {
    H7(Box<WithCamera<Stm32h743, H7Register>>),
    F4(Box<WithCamera<Stm32f427, F4Register>>),
}

impl CameraBoard {
    /// The board, out of reset, with `camera` on its pins and `bus` between the camera interface and memory. The core
    /// retires `mips` million instructions a second if it is said.
    ///
    /// # Errors
    /// What the emulator has against its own description of the part.
    pub fn new(
        kind: Kind,
        camera: Camera,
        bus: Bus,
        wiring: Wiring,
        mips: Option<u32>,
    ) -> Result<Self, soc::Error> {
        let Wiring { serial, sensor } = wiring;
        let (part, mut core) = match kind {
            Kind::Stm32h743 => {
                let mut part = Stm32h743::new()?;
                part.rcc.attach_crystals(OSCILLATOR.0, Crystal::NONE.0);
                part.set_supply(RAIL);
                part.set_analog_supply(RAIL);
                let place = usart::INSTANCES.iter().position(|&name| name == SERIAL_PORT);
                part.usart[place.unwrap_or(0)].attach_boxed(serial);
                if let Some(sensor) = sensor {
                    part.i2c[SENSOR_I2C].attach(sensor);
                }
                let part = WithCamera::new(part, kind.part(), camera, bus, |_| {})?;
                let core = core_of(&mut Stm32h743Bench::new()?);
                (Boxed::H7(Box::new(part)), core)
            }
            Kind::Stm32f429 => {
                let mut part = Stm32f427::new()?;
                part.rcc.attach_crystals(OSCILLATOR.0, Crystal::NONE.0);
                part.set_supply(RAIL);
                let place = SERIAL_PORTS.iter().position(|port| port.instance == SERIAL_PORT);
                part.usart[place.unwrap_or(0)].attach_boxed(serial);
                if let Some(sensor) = sensor {
                    part.i2c[SENSOR_I2C].attach(sensor);
                }
                let part = WithCamera::new(part, kind.part(), camera, bus, wire_dcmi)?;
                let core = core_of(&mut Stm32f427Bench::new()?);
                (Boxed::F4(Box::new(part)), core)
            }
        };
        if let Some(rate) = mips.and_then(|mips| NonZeroU64::new(u64::from(mips) * 1_000_000)) {
            core.instructions_per_second = rate;
        }
        Ok(Self { kind, part, core })
    }

    /// The part with the camera interface.
    #[must_use]
    pub fn part(&self) -> &dyn CameraPart {
        match &self.part {
            Boxed::H7(part) => &**part,
            Boxed::F4(part) => &**part,
        }
    }

    fn part_mut(&mut self) -> &mut dyn Mcu {
        match &mut self.part {
            Boxed::H7(part) => &mut **part,
            Boxed::F4(part) => &mut **part,
        }
    }
}

/// The part's core, as the emulator's own bench for the part describes it.
fn core_of(bench: &mut dyn Board) -> CoreSpec {
    let mut targets = bench.targets();
    targets.remove(0).core
}

/// RM0090 rev 22, table 44: DCMI on channel 1 of DMA2's streams 1 and 7. The emulator's table lists only requests that
/// its own models drive.
fn wire_dcmi(part: &mut Stm32f427) {
    static WIRING: LazyLock<Vec<Wire>> = LazyLock::new(|| {
        let mut wires = CONTROLLERS[1].wiring.to_vec();
        wires.push(Wire { instance: "DCMI", request: 0, channel: 1, streams: &[1, 7] });
        wires
    });
    part.dma[1] = Dma::new(&WIRING, CONTROLLERS[1].last_data, CONTROLLERS[1].reaches_memory);
}

/// Runs start from reset; nothing is kept.
impl Store for CameraBoard {}

impl Board for CameraBoard {
    fn name(&self) -> &'static str {
        self.kind.name()
    }

    fn targets(&mut self) -> Vec<Target<'_>> {
        let (name, core) = (self.kind.name(), self.core.clone());
        vec![Target::new(name, self.part_mut(), core)]
    }

    fn target_names(&self) -> Vec<&'static str> {
        vec![self.kind.name()]
    }

    fn mcu(&mut self, target: usize) -> Option<&mut dyn Mcu> {
        (target == 0).then(|| self.part_mut())
    }
}
