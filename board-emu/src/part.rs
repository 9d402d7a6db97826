//! A part with the camera interface in its DCMI slot.

use firmware::camif::{Bus, Part};
use rigless::device::{ErasedDevice, ResetCause};
use rigless::emulator::{Access, Checked, Memory};
use rigless::mcu::Mcu;
use rigless::soc::{self, Layout};
use rigless::time::VirtualNanos;

use crate::camera::Camera;
use crate::dcmi::Dcmi;

/// The part as the emulator brings it, and the block that it leaves out.
///
/// Everything but the DCMI's slot is the part's own answer; `repair` puts back what the part forgets of ours at a reset.
#[derive(Debug)]
pub struct WithCamera<M, R> {
    /// The part.
    pub part: M,
    /// The camera interface.
    pub dcmi: Dcmi<R>,
    slot: usize,
    repair: fn(&mut M),
}

impl<M: Mcu, R: Layout + 'static> WithCamera<M, R> {
    /// The part with the block, as `abilities` has it, in front of `camera`.
    ///
    /// # Errors
    /// If the part has no DCMI.
    pub fn new(
        mut part: M,
        abilities: Part,
        camera: Camera,
        bus: Bus,
        repair: fn(&mut M),
    ) -> Result<Self, soc::Error> {
        repair(&mut part);
        let slot = part.bus().slot("DCMI")?;
        Ok(Self { part, dcmi: Dcmi::new(abilities, camera, bus), slot, repair })
    }
}

impl<M: Mcu, R: Layout + 'static> Mcu for WithCamera<M, R> {
    fn bus(&self) -> &soc::Bus {
        self.part.bus()
    }

    fn bus_mut(&mut self) -> &mut soc::Bus {
        self.part.bus_mut()
    }

    fn reset(&mut self, at: VirtualNanos, cause: ResetCause) {
        self.part.reset(at, cause);
        (self.repair)(&mut self.part);
        rigless::device::Device::reset(&mut self.dcmi);
    }

    fn poll(&mut self, now: VirtualNanos) {
        self.part.poll(now);
    }

    fn split(&mut self, slot: usize) -> (&mut soc::Bus, Option<&mut dyn ErasedDevice>) {
        if slot == self.slot {
            return (self.part.bus_mut(), Some(&mut self.dcmi));
        }
        self.part.split(slot)
    }

    fn read_checked(
        &mut self,
        at: VirtualNanos,
        address: u64,
        report: bool,
        memory: &mut dyn Memory,
    ) -> Option<Checked> {
        self.part.read_checked(at, address, report, memory)
    }

    fn checks_every_read(&mut self) -> bool {
        self.part.checks_every_read()
    }

    fn mismatched_words(&mut self) -> Option<Vec<u64>> {
        self.part.mismatched_words()
    }

    fn write_checked(&mut self, access: Access, memory: &mut dyn Memory) -> Option<bool> {
        self.part.write_checked(access, memory)
    }

    fn flip_bits(
        &mut self,
        address: u64,
        data: u64,
        check: u8,
        memory: &mut dyn Memory,
    ) -> Result<(), String> {
        self.part.flip_bits(address, data, check, memory)
    }

    fn keeps_check_bits(&self, address: u64) -> bool {
        self.part.keeps_check_bits(address)
    }

    fn compares_cores(&self) -> bool {
        self.part.compares_cores()
    }

    fn compare_error(&mut self, at: VirtualNanos) {
        self.part.compare_error(at);
    }
}

/// What a run wants of a part, whichever it is.
pub trait CameraPart: Mcu {
    /// The camera interface's counts.
    fn counts(&self) -> crate::dcmi::Counts;
    /// The image has switched the camera interface on.
    fn camera_is_enabled(&self) -> bool;
    /// The camera has nothing more to show.
    fn camera_is_over(&self) -> bool;
}

impl<M: Mcu, R: Layout + 'static> CameraPart for WithCamera<M, R> {
    fn counts(&self) -> crate::dcmi::Counts {
        self.dcmi.counts()
    }

    fn camera_is_enabled(&self) -> bool {
        self.dcmi.is_enabled()
    }

    fn camera_is_over(&self) -> bool {
        self.dcmi.is_over()
    }
}
