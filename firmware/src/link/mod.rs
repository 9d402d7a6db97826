//! The serial link: frames, log and statistics out, commands in. `docs/link-protocol.md` specifies it.
//!
//! ```text
//! lines ─► Sender ─► coding ─► packet ─► Framer ─► stuffed bytes ─► UART, USB, TCP
//!                                                        │
//! frames ◄─ Assembler ◄─ packet ◄─ Inbox ◄─ Deframer ◄───┘
//! REPLY  ◄─ Dispatcher ◄─ COMMAND, on the device; the Device trait is what boards implement
//! ```
//!
//! In the order in which a line flows:
//!
//! | module | what lives there |
//! |---|---|
//! | `format` | the numbers of formats and encodings on the wire |
//! | [`coding`] | the encodings of a line: runs, QOI, differences, bits |
//! | [`packet`] | what is in each kind of packet |
//! | `fields` | little-endian fields |
//! | `framing` | a body, its CRC and its end; and back |
//! | `stuffing` | bytes without a zero |
//! | `crc` | the CRC-32, continued |
//! | `outgoing` | a frame on its way out: its CRC, its lines, their pieces |
//! | `sender` | [`Sender`]: packets into a writer, blocking or async |
//! | `inbox` | [`Inbox`]: bytes into packets, whatever happened to them |
//! | `receiver` | [`Receiver`]: packets out of a reader, blocking or async |
//! | `assembler` | [`Assembler`]: lines into frames, with a mark for each that is missing |
//! | `request` | the commands and their arguments |
//! | `device` | [`Device`]: what a device does for each command |
//! | `dispatcher` | [`Dispatcher`]: one reply for each command, none carried out twice |
//!
//! The caller lends all memory; [`wire_bytes`], [`picture_bytes`] and [`marks_words`] say how much. Nothing that comes
//! over the wire can cause a panic.

mod format;
pub mod coding;
pub mod packet;
mod fields;
mod framing;
mod stuffing;
mod crc;
mod outgoing;
mod sender;
mod inbox;
mod receiver;
mod assembler;
mod request;
mod device;
mod dispatcher;

pub use assembler::{Assembled, Assembler, Dropped, marks_words, picture_bytes};
pub use crc::{Checksum, small_table};
pub use device::{Device, Parameter};
pub use dispatcher::{Dispatcher, REPLY_MEMORY, Then};
pub use format::{Choice, Encoding, Format};
pub use framing::wire_bytes;
pub use framing::{BODY_MAX, BODY_MIN, COMMAND_BODY_MAX, Closed, Damage, Deframer, Framer, TooLong, VERSION};
pub use inbox::{Counts, Inbox, Received};
pub use outgoing::{Outgoing, Piece};
pub use packet::{Content, Packet};
pub use receiver::Receiver;
pub use request::{ALL_COMMANDS, Request, Resend};
pub use sender::{SendError, Sender};
pub use stuffing::overhead;

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_async;
