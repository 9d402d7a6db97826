//! Captured frames on a serial line, by the link's protocol (`docs/link-protocol.md`).

use embedded_io::Write;
use firmware::driver::verdict::Verdict;
use firmware::link::packet::{FrameStart, Hello, Meaning, Stream};
use firmware::link::{
    BODY_MAX, Choice, Encoding, Format, Packet, SendError, Sender, VERSION, small_table, wire_bytes,
};
use firmware::sensor::{Mode, Model};

/// Bytes of the largest body that is sent: a line of QVGA with two bytes a pixel, and what stands around it.
const BODY: usize = 1_024;
/// Bytes of memory that a sender takes.
pub const MEMORY: usize = wire_bytes(BODY);
const _: () = assert!(BODY <= BODY_MAX);

/// The raw frames.
const STREAM: u8 = 0;

/// The sending end of the line.
#[derive(Debug)]
pub struct Output<'m, W> {
    sender: Sender<'m, W>,
}

impl<'m, W: Write> Output<'m, W> {
    /// Sends into `writer`.
    pub fn new(writer: W, memory: &'m mut [u8; MEMORY]) -> Self {
        Self { sender: Sender::new(writer, memory, small_table) }
    }

    /// Says who this is and what will come.
    ///
    /// # Errors
    /// [`SendError`] of the writer.
    pub fn announce(&mut self, model: &Model, mode: &Mode, session: u32) -> Result<(), SendError<W::Error>> {
        self.sender.send(&Packet::Hello(Hello {
            oldest: VERSION,
            newest: VERSION,
            // It only sends.
            takes: 0,
            sends: BODY as u16,
            streams: 1,
            commands: 0,
            encodings: Encoding::bits(&[Encoding::Raw, Encoding::RunLength, Encoding::Qoi]),
            session,
            name: model.name,
        }))?;
        self.sender.send(&Packet::Stream(Stream {
            stream: STREAM,
            format: Format::Pixels(mode.format),
            encoding: Choice::Sender,
            on: true,
            width: mode.width as u16,
            height: mode.height as u16,
            meaning: meaning(mode),
            pipeline: "",
            name: mode.name,
        }))
    }

    /// Sends a frame, whatever of it there is.
    ///
    /// # Errors
    /// [`SendError`] of the writer.
    pub fn frame(
        &mut self,
        mode: &Mode,
        bytes: &[u8],
        verdict: &Verdict,
        captured_us: u64,
    ) -> Result<(), SendError<W::Error>> {
        let format = Format::Pixels(mode.format);
        let start = FrameStart {
            stream: STREAM,
            format,
            meaning: meaning(mode),
            snapshot: false,
            sequence: verdict.sequence,
            width: mode.width as u16,
            height: mode.height as u16,
            captured: captured_us,
            palette: 0,
        };
        let mut outgoing = self.sender.begin(start, Choice::Sender)?;
        let line_bytes = format.line_bytes(mode.width as usize).max(1);
        for (number, line) in (0_u16..).zip(bytes.chunks_exact(line_bytes)).take(mode.height as usize) {
            self.sender.line(&mut outgoing, number, line)?;
        }
        self.sender.end(outgoing.end().judged(verdict))
    }
}

fn meaning(mode: &Mode) -> Meaning {
    Meaning { bayer: mode.bayer, ..Meaning::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware::driver::verdict::Outcome;
    use firmware::link::{Assembler, Inbox, Received, marks_words, picture_bytes};
    use firmware::sensor::ov7670::OV7670;

    #[test]
    fn a_frame_arrives_at_the_other_end() {
        let mode = OV7670.mode("qvga-rgb565").unwrap();
        let bytes: Vec<u8> = (0..320 * 240 * 2_u32).map(|at| (at * 7 + (at >> 9)) as u8).collect();
        let mut memory = [0; MEMORY];
        let mut wire = Vec::new();
        let mut output = Output::new(&mut wire, &mut memory);
        output.announce(&OV7670, mode, 5).unwrap();
        let verdict = Verdict { sequence: 3, outcome: Outcome::Good, lines: 240, ..Verdict::default() };
        output.frame(mode, &bytes, &verdict, 1_000).unwrap();

        let format = Format::Pixels(mode.format);
        let (mut picture, mut marks) = (vec![0; picture_bytes(format, 320, 240)], vec![0; marks_words(240)]);
        let mut assembler = Assembler::new(STREAM, &mut picture, &mut marks, small_table);
        let (mut frames, mut hellos) = (0, 0);
        let mut room = vec![0; BODY_MAX];
        Inbox::new(&mut room, small_table).feed(&wire, |received| {
            let Received::Packet(packet) = received else { panic!("{received:?}") };
            hellos += u32::from(matches!(packet, Packet::Hello(Hello { name: "ov7670", session: 5, .. })));
            assembler.push(&packet, &mut |frame| {
                assert!(frame.picture == bytes && frame.crc == Some(true) && frame.sequence == 3);
                assert_eq!(frame.end.unwrap().outcome(), Some(Outcome::Good));
                frames += 1;
            });
        });
        assert_eq!((frames, hellos), (1, 1));
    }
}
