//! The block.
pub mod pins;
pub mod registers;
mod part;
mod bus;
pub use bus::{Bus, Hold, Stall};
pub use part::Part;
