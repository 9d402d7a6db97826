//! A host of the link, as small as it can be: packets and frames out of what a played device sends, commands to it.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{BufRead as _, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use firmware::driver::verdict::Outcome;
use firmware::link::packet::{State, Status};
use firmware::link::{
    Assembler, Choice, Format, Framer, Inbox, Packet, Received, Request, marks_words, wire_bytes,
};
use host_sim::picture::crc32_after;
use host_sim::profile::Profile;
use rustix::fs::{Mode, OFlags};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

pub(super) const WIDTH: u32 = 96;
pub(super) const HEIGHT: u32 = 64;
const LONG: Duration = Duration::from_secs(60);

/// A device, which ends with the test.
pub(super) struct Played {
    pub(super) child: Child,
    pub(super) url: String,
    pub(super) _folder: tempfile::TempDir,
}

impl Drop for Played {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Plays a device of small frames.
pub(super) fn play(arguments: &[&str]) -> Played {
    let mut profile = Profile::default();
    (profile.frame.width, profile.frame.height) = (WIDTH, HEIGHT);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("small.toml"), profile.to_toml()).unwrap();
    let with_profile: &[&str] =
        if arguments.contains(&"--sensor") { &[] } else { &["--profile", "small.toml", "--rate", "50"] };
    let mut child = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .current_dir(folder.path())
        .arg("stream")
        .args(with_profile)
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::inherit())
        .spawn()
        .unwrap();
    let mut url = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut url).unwrap();
    Played { child, url: url.trim_end().to_owned(), _folder: folder }
}

/// A frame that came.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) stream: u8,
    pub(super) sequence: u32,
    pub(super) format: Format,
    pub(super) size: (u16, u16),
    pub(super) pixels: Vec<u8>,
    pub(super) missing: Vec<u16>,
    pub(super) crc: Option<bool>,
    pub(super) outcome: Option<Outcome>,
    pub(super) snapshot: bool,
    pub(super) repaired: bool,
    pub(super) palette: u32,
}

impl Frame {
    /// It came whole and was captured well.
    pub(super) fn is_whole(&self) -> bool {
        self.missing.is_empty() && self.crc == Some(true) && self.outcome == Some(Outcome::Good)
    }

    /// Its line, if it came.
    pub(super) fn line(&self, number: u16) -> Option<&[u8]> {
        let size = self.format.line_bytes(self.size.0.into());
        let line = &self.pixels[usize::from(number) * size..][..size];
        (!self.missing.contains(&number)).then_some(line)
    }
}

/// What else came.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Event {
    Frame(Frame),
    Hello {
        streams: u8,
        commands: u32,
        session: u32,
        name: String,
    },
    Stream {
        stream: u8,
        format: Format,
        choice: Choice,
        on: bool,
        size: (u16, u16),
        pipeline: String,
        name: String,
    },
    Palette {
        stream: u8,
        colors: Vec<[u8; 3]>,
    },
    Heartbeat {
        state: State,
        baud: u32,
        delivered: u32,
    },
    Log(String),
    Reply {
        request: u16,
        code: u8,
        status: Status,
        rest: Vec<u8>,
    },
}

/// The host's end.
pub(super) struct Host {
    pub(super) chunks: Receiver<Vec<u8>>,
    pub(super) writer: Box<dyn Write>,
    pub(super) inbox: Inbox<'static>,
    pub(super) assemblers: Vec<Assembler<'static>>,
    pub(super) framer: Framer<'static>,
    pub(super) request: u16,
    pub(super) events: VecDeque<Event>,
    pub(super) bytes: u64,
}

fn lend<T: Clone>(value: T, count: usize) -> &'static mut [T] {
    Vec::leak(vec![value; count])
}

impl Host {
    pub(super) fn connect(url: &str) -> Self {
        let (reader, writer): (Box<dyn Read + Send>, Box<dyn Write>) = match url.strip_prefix("socket://") {
            Some(address) => {
                let stream = TcpStream::connect(address).unwrap();
                (Box::new(stream.try_clone().unwrap()), Box::new(stream))
            }
            None => {
                let port = rustix::fs::open(url, OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap();
                let mut settings = tcgetattr(&port).unwrap();
                settings.make_raw();
                tcsetattr(&port, OptionalActions::Now, &settings).unwrap();
                let port = File::from(port);
                (Box::new(port.try_clone().unwrap()), Box::new(port))
            }
        };
        let (sender, chunks) = channel();
        std::thread::spawn(move || {
            let (mut reader, mut bytes) = (reader, [0; 16_384]);
            while let Ok(count @ 1..) = reader.read(&mut bytes) {
                if sender.send(bytes[..count].to_vec()).is_err() {
                    break;
                }
            }
        });
        let room = 4 * (WIDTH * HEIGHT).max(640 * 480) as usize;
        Self {
            chunks,
            writer,
            inbox: Inbox::new(lend(0, 4096), crc32_after),
            assemblers: (0..3)
                .map(|stream| Assembler::new(stream, lend(0, room), lend(0, marks_words(480)), crc32_after))
                .collect(),
            framer: Framer::new(lend(0, wire_bytes(512)), crc32_after),
            request: 0,
            events: VecDeque::new(),
            bytes: 0,
        }
    }

    /// Takes a chunk, if one comes in time.
    pub(super) fn take(&mut self, longest: Duration) -> bool {
        let Ok(chunk) = self.chunks.recv_timeout(longest) else { return false };
        self.bytes += chunk.len() as u64;
        let Self { inbox, assemblers, events, .. } = self;
        inbox.feed(&chunk, |received| {
            let Received::Packet(packet) = received else { return };
            for (stream, assembler) in (0..).zip(assemblers.iter_mut()) {
                assembler.push(&packet, &mut |frame| {
                    events.push_back(Event::Frame(Frame {
                        stream,
                        sequence: frame.sequence,
                        format: frame.format,
                        size: (frame.width, frame.height),
                        pixels: frame.picture.to_vec(),
                        missing: frame.missing().collect(),
                        crc: frame.crc,
                        outcome: frame.end.and_then(|end| end.outcome()),
                        snapshot: frame.start.is_some_and(|start| start.snapshot),
                        repaired: frame.repaired,
                        palette: frame.start.map_or(0, |start| start.palette),
                    }));
                });
            }
            events.extend(event(&packet));
        });
        true
    }

    /// The next event that `choose` takes; others are dropped.
    pub(super) fn wait_for<T>(&mut self, what: &str, mut choose: impl FnMut(Event) -> Option<T>) -> T {
        let started = Instant::now();
        loop {
            while let Some(event) = self.events.pop_front() {
                if let Some(chosen) = choose(event) {
                    return chosen;
                }
            }
            assert!(started.elapsed() < LONG, "no {what}");
            self.take(Duration::from_millis(100));
        }
    }

    pub(super) fn frame(&mut self, stream: u8) -> Frame {
        self.wait_for("frame", |event| match event {
            Event::Frame(frame) if frame.stream == stream => Some(frame),
            _ => None,
        })
    }

    pub(super) fn log(&mut self, part: &str) -> String {
        self.wait_for(part, |event| match event {
            Event::Log(text) if text.contains(part) => Some(text),
            _ => None,
        })
    }

    /// Has a command carried out: sends it again until it is answered, as the protocol has it.
    pub(super) fn command(&mut self, request: &Request<'_>) -> (Status, Vec<u8>) {
        self.request += 1;
        let wire = request.frame(self.request, &mut self.framer).unwrap().to_vec();
        for _ in 0..100 {
            self.writer.write_all(&wire).unwrap();
            let sent = Instant::now();
            while sent.elapsed() < Duration::from_secs(1) {
                self.take(Duration::from_millis(20));
                let number = self.request;
                let at = self
                    .events
                    .iter()
                    .position(|event| matches!(event, Event::Reply { request, .. } if *request == number));
                if let Some(Event::Reply { code, status, rest, .. }) =
                    at.and_then(|at| self.events.remove(at))
                {
                    assert_eq!(code, request.code());
                    return (status, rest);
                }
            }
        }
        panic!("{request:?} is not answered");
    }

    pub(super) fn done(&mut self, request: &Request<'_>) -> Vec<u8> {
        let (status, rest) = self.command(request);
        assert_eq!(status, Status::Done, "{request:?}: {}", String::from_utf8_lossy(&rest));
        rest
    }

    pub(super) fn refused(&mut self, request: &Request<'_>) -> (Status, String) {
        let (status, rest) = self.command(request);
        (status, String::from_utf8(rest).unwrap())
    }
}

fn event(packet: &Packet<'_>) -> Option<Event> {
    Some(match *packet {
        Packet::Hello(hello) => Event::Hello {
            streams: hello.streams,
            commands: hello.commands,
            session: hello.session,
            name: hello.name.to_owned(),
        },
        Packet::Stream(stream) => Event::Stream {
            stream: stream.stream,
            format: stream.format,
            choice: stream.encoding,
            on: stream.on,
            size: (stream.width, stream.height),
            pipeline: stream.pipeline.to_owned(),
            name: stream.name.to_owned(),
        },
        Packet::Palette(palette) => {
            Event::Palette { stream: palette.stream, colors: palette.colors.to_vec() }
        }
        Packet::Heartbeat(beat) => {
            Event::Heartbeat { state: beat.state, baud: beat.baud, delivered: beat.frames.delivered }
        }
        Packet::Log(log) => Event::Log(log.text.to_owned()),
        Packet::Reply(reply) => Event::Reply {
            request: reply.request,
            code: reply.code,
            status: reply.status,
            rest: reply.rest.to_vec(),
        },
        _ => return None,
    })
}
