//! Every algorithm on one picture: a checksum of what came out, and the instructions that it took.
#![no_std]
#![no_main]

use exercise::Workspace;
use mps2::instructions::Counter;
use mps2::{exit, file};
use static_cell::ConstStaticCell;

static SPACE: ConstStaticCell<Workspace> = ConstStaticCell::new(Workspace::new());

#[cortex_m_rt::entry]
fn main() -> ! {
    let Some(core) = cortex_m::Peripherals::take() else { exit::failure() };
    let mut counter = Counter::start(core.SYST);
    defmt::info!("{=u32} instructions in 1000 ticks", counter.calibration());
    let mut failed = 0_u32;
    let Some(space) = SPACE.try_take() else { exit::failure() };
    file::fill(c"gray.raw", space.gray_mut());
    file::fill(c"picture.raw", space.picture_mut());
    space.prepare();
    for exercise in exercise::all() {
        match (exercise.run)(space, &mut counter) {
            Ok(done) => {
                defmt::info!("{=str}: {=u32:08x} of {=u32}", exercise.name, done.checksum, done.units);
                let units = u64::from(done.units.max(1));
                let hundredths = (counter.counted() * 100 + units / 2) / units;
                let (whole, rest) = (hundredths / 100, hundredths % 100);
                let unit = exercise.unit.name();
                defmt::info!(
                    "measured {=str}, instructions a {=str} {=u64}.{=u64:02}",
                    exercise.name,
                    unit,
                    whole,
                    rest
                );
            }
            Err(_) => {
                defmt::error!("{=str} refused", exercise.name);
                failed += 1;
            }
        }
    }
    if failed == 0 { exit::success() } else { exit::failure() }
}
