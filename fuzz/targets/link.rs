//! Any bytes on the serial line, at either end: packets or damage, however they are cut; what is a packet comes back
//! from its own bytes; commands are answered; pixels that an encoding gives are those that it takes.
#![no_main]

use std::fmt;

use firmware::camif::{Bus, Camif, Part};
use firmware::link::packet::{Command, Status};
use firmware::link::{
    Assembler, BODY_MAX, Choice, Content, Device, Dispatcher, Encoding, Format, Framer, Inbox, Packet,
    Parameter, REPLY_MEMORY, Received, Resend, coding, marks_words, small_table, wire_bytes,
};
use firmware::port::Registers;
use libfuzzer_sys::fuzz_target;

/// A device that does what it is told.
struct Told {
    camif: Camif<'static>,
    value: i32,
}

impl Device for Told {
    fn start(&mut self) -> Result<(), Status> {
        Ok(())
    }

    fn stop(&mut self) -> Result<(), Status> {
        Ok(())
    }

    fn snapshot(&mut self, frames: u16) -> Result<(), Status> {
        assert!(frames > 0);
        Ok(())
    }

    fn choose_stages(&mut self, _: u8, pipeline: &str, text: &mut dyn fmt::Write) -> Result<(), Status> {
        let _ = text.write_str(pipeline);
        if pipeline.len().is_multiple_of(2) { Ok(()) } else { Err(Status::OutOfRange) }
    }

    fn parameter(&self, number: u16) -> Option<Parameter<'_>> {
        (number < 2).then_some(Parameter { name: "gain", value: self.value, least: -5, greatest: 1000 })
    }

    fn set_parameter(&mut self, _: u16, value: i32) -> Result<(), Status> {
        assert!((-5..=1000).contains(&value));
        self.value = value;
        Ok(())
    }

    fn registers(&mut self) -> &mut dyn Registers {
        &mut self.camif
    }

    fn read_sensor(&mut self, register: u32) -> Result<u32, Status> {
        Ok(register)
    }

    fn resend(&mut self, lines: &Resend) -> Result<u16, Status> {
        Ok(lines.count)
    }
}

/// What a receiver makes of bytes that come in pieces of this length.
fn received(bytes: &[u8], cut: usize) -> Vec<String> {
    let (mut memory, mut all) = (vec![0; BODY_MAX], Vec::new());
    let mut inbox = Inbox::new(&mut memory, small_table);
    for piece in bytes.chunks(cut) {
        inbox.feed(piece, |received| all.push(format!("{received:?}")));
    }
    all
}

/// A body of any content, with the head and the CRC that make it a packet.
fn put(kind: u8, content: &[u8], framer: &mut Framer<'_>) -> Option<Vec<u8>> {
    let wire = framer.frame(kind, true, |room| {
        room.get_mut(..content.len())?.copy_from_slice(content);
        Some(content.len())
    });
    wire.ok().map(<[u8]>::to_vec)
}

fuzz_target!(|bytes: &[u8]| {
    let Some((&first, rest)) = bytes.split_first() else { return };
    let cut = usize::from(first) + 1;
    assert_eq!(received(bytes, bytes.len()), received(bytes, cut), "in pieces of {cut}");

    // The same bytes as the content of every kind of packet.
    let mut memory = vec![0; wire_bytes(BODY_MAX)];
    let mut framer = Framer::new(&mut memory, small_table);
    let (mut picture, mut marks) = (vec![0; 1 << 16], vec![0; marks_words(256)]);
    let mut assembler =
        Assembler::new(rest.first().copied().unwrap_or(0), &mut picture, &mut marks, small_table);
    let mut device = Told { camif: Camif::new(Part::CAMIF, Bus::IDEAL), value: 0 };
    let mut replies = vec![0; if first < 128 { REPLY_MEMORY } else { usize::from(first) - 128 }];
    let mut dispatcher = Dispatcher::new(&mut replies, small_table);
    for kind in (1..=9).chain([0x81, first]) {
        let Some(wire) = put(kind, rest, &mut framer) else { continue };
        let mut body = vec![0; BODY_MAX];
        let mut inbox = Inbox::new(&mut body, small_table);
        let mut again = None;
        inbox.feed(&wire, |received| match received {
            Received::Packet(packet) => {
                assembler.push(&packet, &mut |frame| {
                    assert!(frame.missing().count() <= usize::from(frame.height));
                });
                if let Packet::Command(Command { request, code, arguments }) = packet {
                    let command = Command { request, code, arguments };
                    let (reply, _) = dispatcher.handle(&mut device, &command);
                    assert_eq!((reply.request, reply.code), (request, code));
                }
                again = packet.frame(&mut framer).ok().map(<[u8]>::to_vec);
                assert!(again.is_some(), "{packet:?} does not fit where it came from");
            }
            Received::Damaged(damage) => panic!("{damage:?}"),
            Received::Malformed(_) | Received::UnknownKind(_) | Received::OtherVersion { .. } => {}
        });
        if let Some(again) = again {
            // Reserved bits are zero now; what they stand beside is the same.
            assert_eq!(received(&again, again.len()), received(&wire, wire.len()));
        }
    }
    // Any body at all.
    let _ = Content::read(bytes);

    // The same bytes as the payload of every encoding.
    for format in Format::ALL {
        for encoding in Encoding::ALL {
            let mut pixels = vec![0; 1 + usize::from(first) * 64];
            let Some(length) = coding::decode(format, encoding, first & 7, rest, &mut pixels) else {
                continue;
            };
            let pixels = &pixels[..length];
            let mut payload = vec![0; 2 * length + 16];
            let Some((used, size)) = coding::encode(format, Choice::One(encoding), pixels, &mut payload)
            else {
                assert_eq!(encoding, Encoding::Raw, "{} can't take what it gave", encoding.name());
                continue;
            };
            assert_eq!(used, encoding);
            let unused = if encoding == Encoding::Bits { coding::unused_bits(length) } else { 0 };
            let mut back = vec![0; length];
            assert_eq!(coding::decode(format, encoding, unused, &payload[..size], &mut back), Some(length));
            assert_eq!(back, pixels, "{} of {}", encoding.name(), format.name());
        }
    }
});
