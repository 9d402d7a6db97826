//! Boots, logs and ends: what every other image stands on.
#![no_std]
#![no_main]

use mps2::exit;

#[cortex_m_rt::entry]
fn main() -> ! {
    defmt::info!("booted");
    exit::success()
}
