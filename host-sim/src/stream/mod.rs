//! A device on a serial line, played: scene or trace, block and driver, streams, and the link that a board speaks.
//!
//! ```text
//! scene ─► sensor ─► pins ─► block, driver ─► frame ─► raw, edges, palette ─► Sender ─► noise ─► rate ─► TCP, pty
//!            ▲ registers       ▲ registers                 ▲ stages                                    │
//!            └─────────────────┴──── Board: Device ────────┴──── Dispatcher ◄─ Inbox ◄─ noise ◄────────┘
//! ```
//!
//! One thread does it all: between the pixel clocks of the sensor, which come at their time, the line is served. What of
//! the link is here is the code of the device, `firmware::link`.
//!
//! | file | what lives there |
//! |---|---|
//! | `sensor` | the sensor that looks at a scene, with registers or without |
//! | `play` | [`stream`]: pixel clocks at their time, and the line served between them |
//! | `board` | the device without its line: what it does for each command |
//! | `streams` | [`STREAMS`]: what is made of a frame, and how it is sent |
//! | `station` | the device with its line: commands in, packets out |
//! | `line` | the queue of the serial line |
//! | `noise` | [`Noise`]: bits flipped, packets and bytes lost, bytes put in |
//! | `pace` | the rate of the line |
//! | `transport`, `pty` | [`Address`]: TCP and pseudo-terminals |

mod sensor;
mod play;
mod board;
mod streams;
mod station;
mod line;
mod noise;
mod pace;
mod transport;
#[cfg(unix)]
mod pty;

pub use noise::{Damage, Noise, NoiseSyntaxError, Rates};
pub use play::{Settings, Source, StreamError, Summary, stream};
pub use streams::STREAMS;
pub use transport::{Address, TransportError};
