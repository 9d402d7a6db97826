//! The camera interface block (CAMIF) at register and pin level: a pure model that software drives by its registers.
//!
//! In the order in which a picture flows:
//!
//! | module | what lives there |
//! |---|---|
//! | [`pins`] | sync levels, bus samples, clock edges |
//! | `sync` | where frames and lines start and end |
//! | `embedded` | synchronisation codes in the data |
//! | `selection` | crop window, byte and line selection |
//! | `fifo` | packing into words, and the four words that wait |
//! | `dma`, `bus` | bursts into lent memory, and how long each waits |
//! | `block` | the state and one pixel clock of it: [`Camif::step`] |
//! | `run` | many pixel clocks at once: [`Camif::run`] |
//! | [`registers`], `interface`, `part` | the register map, accesses to it, and what each part can do |
//!
//! # Example
//! ```
//! use firmware::camif::registers::{Control, Events, Register, Registers};
//! use firmware::camif::{Bus, Camif, Part, pins::{Samples, Sync}};
//!
//! let mut camif = Camif::new(Part::CAMIF, Bus::IDEAL);
//! let control = Control::default().with_enable(true).with_capture(true).with_snapshot(true);
//! camif.write(Register::Control, control.with_vsync_blank_high(true).with_hsync_blank_high(true).raw_value());
//! let blank = Sync { hsync: true, vsync: true };
//! let valid = Sync { hsync: false, vsync: false };
//! camif.run(blank, Samples::Repeat { value: 0, clocks: 10 });
//! camif.run(valid, Samples::Bytes(&[0x78, 0x56, 0x34, 0x12]));
//! camif.run(blank, Samples::Repeat { value: 0, clocks: 10 });
//! assert_eq!(camif.read(Register::Data), 0x1234_5678);
//! assert!(Events::new_with_raw_value(camif.read(Register::RawInterrupt)).frame());
//! ```

pub mod pins;
mod sync;
mod embedded;
mod selection;
mod fifo;
mod dma;
mod bus;
mod block;
mod run;
pub mod registers;
mod interface;
mod part;
#[cfg(test)]
mod tests;

pub use block::{Camif, Interrupts};
pub use bus::{Bus, Hold, Stall};
pub use fifo::FIFO_WORDS;
pub use interface::{AccessWidth, BusError};
pub use part::Part;
