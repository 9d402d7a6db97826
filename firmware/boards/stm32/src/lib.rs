//! The driver's seams over the silicon of STM32: DCMI, and a stream of DMA1 or DMA2 in double-buffer mode.
//!
//! ```text
//! driver ─► Registers, Dma, Port ─► DcmiPort ─► Silicon ─┬─► Mmio: volatile accesses, on the chip
//!                                      │                 └─► a model, in this package's tests
//!                                      └─ Chip: addresses, request, memory within the DMA's reach
//! ```
//!
//! | module | what lives there |
//! |---|---|
//! | [`chip`] | where a chip has what: DCMI, the stream, the request, the memory that the DMA reaches |
//! | [`stream`] | the registers of a DMA stream, as numbers |
//! | [`silicon`] | [`Silicon`](silicon::Silicon): reads and writes; [`Mmio`](silicon::Mmio) does them |
//! | [`port`] | [`DcmiPort`](port::DcmiPort): the seam |
//! | [`device`] | [`CameraBoard`](device::CameraBoard): what the host may see and set beside capture |
//! | [`capture`](mod@capture) | frames out, commands in: [`capture`](capture::capture) |
//! | `image` | what the images of all boards do: frame memory, ticks, bring-up, logs (feature `image`) |
//!
//! # Who owns the memory, and when
//! A buffer that is lent is the DMA's: it is kept as an address, so that no reference to it is alive. Three orderings make that
//! sound:
//! - **To the DMA**: the processor's writes to the buffer happen before the stream is enabled. A fence stands before the write of
//!   EN; the write itself is volatile, to device memory, and is not moved across it.
//! - **In flight**: a target may be moved while the other is in use. The register of the target in use is never written: CT
//!   is read before, and the driver reads it again after.
//! - **Back**: a buffer is taken back only when neither target aims at it, or when EN reads 0. TCIF, and EN after it was
//!   cleared, are set when the last word is in memory (RM0090 §10.3.13 and §10.3.14; RM0433 ch. 16 has the same
//!   controller), and a fence follows before the
//!   first read by the processor.
//!
//! The cache of a Cortex-M7 is not this package's business: a board puts its buffers where they are not cached.
#![cfg_attr(not(test), no_std)]

pub mod chip;
pub mod stream;
pub mod silicon;
pub mod port;
pub mod device;
pub mod capture;
#[cfg(feature = "image")]
pub mod image;
