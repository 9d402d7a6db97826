//! `qemu_stream`: a device in QEMU on a TCP port or a pseudo-terminal, to be looked at; and the check that what comes is
//! what was before the camera.

use std::fs::OpenOptions;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow, bail, ensure};
use camif_tests::on_core;
use exercise::replay::scenario::{STREAM, STREAM_SIZE};
use firmware::link::packet::Status;
use firmware::link::{
    Assembler, BODY_MAX, Format, Framer, Inbox, Packet, Received, Request, marks_words, picture_bytes,
    small_table, wire_bytes,
};
use firmware::pipeline::{Output, Pipeline, Product, Settings, Smoothing, Thresholds};
use host_sim::scene::Scene;

use crate::audit;
use crate::boards;
use crate::qemu::{self, Board};
use crate::suite;
use crate::top;

/// The image.
pub(crate) const IMAGE: &str = "qemu_stream";
/// What an answer may take.
const PATIENCE: Duration = Duration::from_secs(20);

#[derive(clap::Args)]
pub(crate) struct Options {
    /// TCP port to listen on
    #[arg(long, default_value_t = 3333)]
    port: u16,
    /// A pseudo-terminal instead of TCP
    #[arg(long)]
    pty: bool,
    /// The machine; an386 if it is not said, and with --check both
    #[arg(long)]
    board: Option<Board>,
    /// Receive frames over both and compare them with the scene, instead of waiting for somebody who looks; the inspector
    /// does so too if `CAMIF_INSPECT` names it
    #[arg(long)]
    check: bool,
}

/// True if all went well.
pub(crate) fn run(options: &Options) -> Result<bool> {
    let serial = if options.pty { Serial::Pty } else { Serial::Tcp(options.port) };
    if let (Serial::Tcp(port), false) = (serial, options.check) {
        // QEMU would say so after the build, and when its address had been announced.
        TcpListener::bind(("127.0.0.1", port))
            .with_context(|| format!("port {port} can't be listened on; choose another with --port"))?;
    }
    let images = boards::build(&["mps2".to_owned()])?;
    let image = images.iter().find(|image| image.name == IMAGE).with_context(|| format!("no {IMAGE}"))?;
    if options.check {
        let bound = audit::stack_bound(image)?.context("no bound on the stack: see `cargo xtask audit`")?;
        for board in options.board.map_or(Board::ALL.to_vec(), |board| vec![board]) {
            for serial in [Serial::Tcp(free_port()?), Serial::Pty] {
                let device = Device::start(board, &image.elf, serial, "shift=0,sleep=off")?;
                let used = check(&device).with_context(|| format!("{board}, over {}", device.address))?;
                println!("  {board}: {used} bytes of stack used, {bound} at most");
                ensure!(used <= bound, "more of the stack is used than its bound");
                inspect(&device.address)?;
            }
        }
        return Ok(true);
    }
    // 125 million instructions a second, and idle time as long as it is.
    let mut device =
        Device::start(options.board.unwrap_or(Board::An386), &image.elf, serial, "shift=3,sleep=on")?;
    println!("a camera on {}; look at it with\n    camif-inspect view {0}\nCtrl-C ends it", device.address);
    Ok(device.machine.wait()?.success())
}

/// A serial line of the machine.
#[derive(Clone, Copy)]
enum Serial {
    Tcp(u16),
    Pty,
}

/// A machine that runs the image.
struct Device {
    machine: Child,
    address: String,
}

impl Drop for Device {
    fn drop(&mut self) {
        // If it has ended by itself there is nothing to kill.
        let _ = self.machine.kill();
        let _ = self.machine.wait();
    }
}

impl Device {
    fn start(board: Board, elf: &Path, serial: Serial, pace: &str) -> Result<Self> {
        let folder = top().join("target/qemu").join(board.name()).join(IMAGE);
        on_core::write_inputs(&folder)?;
        let serial_argument = match serial {
            Serial::Tcp(port) => format!("tcp:127.0.0.1:{port},server=on,wait=off"),
            Serial::Pty => "pty".to_owned(),
        };
        let mut command = Command::new(qemu::PROGRAM);
        command.args(["-machine", &format!("mps2-{board}"), "-display", "none", "-monitor", "none"]);
        command.args(["-semihosting-config", "enable=on,target=native", "-serial", &serial_argument]);
        // By instructions: by the host's clock, the timer's interrupts would starve the rest on a busy machine.
        command.args(["-icount", pace]);
        command.arg("-kernel").arg(elf).current_dir(&folder).stdin(Stdio::null());
        match serial {
            // Its messages, in the form of defmt, would fill a pipe that nobody reads; what it complains of is for the user.
            Serial::Tcp(_) => command.stdout(Stdio::null()),
            Serial::Pty => command.stdout(Stdio::piped()).stderr(Stdio::piped()),
        };
        let mut machine = command
            .spawn()
            .with_context(|| format!("cannot start {}: see `cargo xtask setup`", qemu::PROGRAM))?;
        let address = match serial {
            Serial::Tcp(port) => Ok(format!("socket://127.0.0.1:{port}")),
            Serial::Pty => terminal(&mut machine),
        };
        let mut device = Self { machine, address: String::new() };
        device.address = address?;
        Ok(device)
    }

    fn open(&self) -> Result<Link> {
        match self.address.strip_prefix("socket://") {
            Some(address) => {
                let stream = retry(|| TcpStream::connect(address))?;
                let reader = stream.try_clone()?;
                Ok(Link::new(reader, stream))
            }
            None => {
                let file = OpenOptions::new().read(true).write(true).open(&self.address);
                let file = file.with_context(|| format!("cannot open {}", self.address))?;
                let reader = file.try_clone()?;
                Ok(Link::new(reader, file))
            }
        }
    }
}

/// The name that QEMU says its pseudo-terminal has, on either of its outputs.
fn terminal(machine: &mut Child) -> Result<String> {
    let (sender, receiver) = mpsc::channel();
    let outputs: [Option<Box<dyn Read + Send>>; 2] = [
        machine.stdout.take().map(|output| Box::new(output) as _),
        machine.stderr.take().map(|output| Box::new(output) as _),
    ];
    for output in outputs.into_iter().flatten() {
        let sender = sender.clone();
        std::thread::spawn(move || {
            for line in BufReader::new(output).split(b'\n').map_while(Result::ok) {
                let line = String::from_utf8_lossy(&line).into_owned();
                if let Some(at) = line.find("/dev/") {
                    let name = line[at..].split_whitespace().next().unwrap_or_default().to_owned();
                    // Nobody waits any more for a second one.
                    let _ = sender.send(name);
                }
            }
        });
    }
    receiver.recv_timeout(PATIENCE).map_err(|_| anyhow!("QEMU names no pseudo-terminal"))
}

fn free_port() -> Result<u16> {
    Ok(TcpListener::bind("127.0.0.1:0")?.local_addr()?.port())
}

fn retry<T>(mut attempt: impl FnMut() -> std::io::Result<T>) -> Result<T> {
    let started = Instant::now();
    loop {
        match attempt() {
            Ok(done) => return Ok(done),
            Err(error) if started.elapsed() > PATIENCE => return Err(error.into()),
            Err(_) => std::thread::sleep(Duration::from_millis(50)),
        }
    }
}

/// Closes a packet on the wire (docs/link-protocol.md).
const DELIMITER: u8 = 0;

/// The host's end.
struct Link {
    bytes: Receiver<Vec<u8>>,
    /// Of what came last: what nobody has looked at, from a packet's beginning on.
    rest: Vec<u8>,
    writer: Box<dyn Write>,
    request: u16,
}

impl Link {
    fn new(mut reader: impl Read + Send + 'static, writer: impl Write + 'static) -> Self {
        let (sender, bytes) = mpsc::channel();
        std::thread::spawn(move || {
            let mut buffer = [0; 65_536];
            while let Ok(count @ 1..) = reader.read(&mut buffer) {
                if sender.send(buffer[..count].to_vec()).is_err() {
                    break;
                }
            }
        });
        Self { bytes, rest: Vec::new(), writer: Box::new(writer), request: 0 }
    }

    /// Gives every packet to `each` until that is content. What comes behind is left for the next one who asks: a frame may follow the
    /// reply to SNAPSHOT in one read.
    fn receive(&mut self, what: &str, mut each: impl FnMut(&Packet<'_>) -> bool) -> Result<()> {
        let mut room = vec![0; BODY_MAX];
        let mut inbox = Inbox::new(&mut room, small_table);
        let until = Instant::now() + PATIENCE;
        loop {
            let mut bytes = std::mem::take(&mut self.rest);
            if bytes.is_empty() {
                let left = until.saturating_duration_since(Instant::now());
                bytes = self.bytes.recv_timeout(left).map_err(|_| anyhow!("no {what} came"))?;
            }
            let (mut content, mut looked_at) = (false, 0);
            for packet in bytes.split_inclusive(|&byte| byte == DELIMITER) {
                looked_at += packet.len();
                inbox.feed(packet, |received| {
                    if let Received::Packet(packet) = received {
                        content = each(&packet);
                    }
                });
                if content {
                    self.rest = bytes[looked_at..].to_vec();
                    return Ok(());
                }
            }
        }
    }

    /// Sends a command, and returns status and results. What comes before the reply is passed over.
    fn ask(&mut self, request: Request<'_>) -> Result<(Status, Vec<u8>)> {
        self.request += 1;
        let (mut memory, number) = (vec![0; wire_bytes(BODY_MAX)], self.request);
        let mut framer = Framer::new(&mut memory, small_table);
        let wire = request.frame(number, &mut framer).map_err(|error| anyhow!("{error}"))?;
        self.writer.write_all(wire)?;
        self.writer.flush()?;
        let mut answer = None;
        self.receive("reply", |packet| {
            if let Packet::Reply(reply) = packet
                && reply.request == number
            {
                answer = Some((reply.status, reply.rest.to_vec()));
            }
            answer.is_some()
        })?;
        answer.context("no reply")
    }

    fn command(&mut self, request: Request<'_>) -> Result<Vec<u8>> {
        match self.ask(request)? {
            (Status::Done, results) => Ok(results),
            (status, why) => bail!("{request:?}: {status}: {}", String::from_utf8_lossy(&why)),
        }
    }
}

/// Takes a snapshot of each stream and compares, exactly. Returns the bytes of stack that the device used.
fn check(device: &Device) -> Result<u32> {
    const STAGES: &str = "gray|gaussian:size=5,sigma=1.4|canny:low=50,high=150,norm=l2";
    let mut link = device.open()?;
    link.command(Request::Stop)?;
    let understood = link.command(Request::Stages(1, STAGES))?;
    ensure!(understood.get(4..) == Some(STAGES.as_bytes()), "the device understood {understood:?}");
    link.command(Request::Streams(0b11))?;
    link.command(Request::Set(0, 0))?;
    let control = link.command(Request::Read { block: 0, count: 1, offset: 0 })?;
    ensure!(control.len() == 12, "a register has {} bytes", control.len());
    ensure!(
        link.ask(Request::Stages(1, "median:size=3"))?.0 == Status::OutOfRange,
        "it cannot make a median"
    );
    const FRAMES: usize = 3;
    link.command(Request::Snapshot(FRAMES as u16))?;
    let (width, height) = (STREAM_SIZE.0 as usize, STREAM_SIZE.1 as usize);
    let room = |format| (vec![0; picture_bytes(format, width, height)], vec![0; marks_words(height)]);
    let ((mut raw, mut raw_marks), (mut made, mut made_marks)) = (room(Format::RGB888), room(Format::GRAY8));
    let mut streams = [
        (Assembler::new(0, &mut raw, &mut raw_marks, small_table), Vec::new()),
        (Assembler::new(1, &mut made, &mut made_marks, small_table), Vec::new()),
    ];
    link.receive("frame", |packet| {
        for (assembler, frames) in &mut streams {
            assembler.push(packet, &mut |frame| {
                let harm = match (frame.crc, frame.missing().count()) {
                    (Some(true), 0) => None,
                    (crc, missing) => Some(format!("{missing} lines are missing, its CRC is {crc:?}")),
                };
                frames.push((frame.sequence, harm, frame.picture.to_vec()));
            });
        }
        streams.iter().all(|(_, frames)| frames.len() >= FRAMES)
    })?;
    let [(_, raw), (_, made)] = streams;
    let scene: Vec<Vec<u8>> = (0..STREAM.frames).map(scene).collect();
    let mut before = None;
    for ((sequence, harm, picture), (made_sequence, made_harm, edges)) in raw.iter().zip(&made) {
        let mut harms = [("picture", harm), ("edges", made_harm)].into_iter();
        if let Some((what, harm)) = harms.find_map(|(what, harm)| Some((what, harm.as_ref()?))) {
            bail!("frame {sequence}, {what}: {harm}");
        }
        let place = scene.iter().position(|frame| frame == picture);
        let place = place.with_context(|| format!("frame {sequence} is none of the scene"))?;
        ensure!(before.is_none_or(|before| (before + 1) % scene.len() == place), "frames are out of order");
        before = Some(place);
        ensure!(
            sequence == made_sequence && *edges == canny(picture)?,
            "the edges of frame {sequence} differ"
        );
    }
    println!("{}: {FRAMES} frames and their edges, each the scene's and the host's", device.address);
    let mut used = None;
    link.receive("word on the stack", |packet| {
        if let Packet::Log(log) = packet {
            used = log.text.strip_prefix(suite::STACK).and_then(|bytes| bytes.trim().parse().ok());
        }
        used.is_some()
    })?;
    link.command(Request::Streams(0b01))?;
    link.command(Request::Set(0, 100))?;
    link.command(Request::Start)?;
    used.context("no word on the stack")
}

/// A frame of the scene before the camera.
fn scene(frame: u64) -> Vec<u8> {
    Scene::Moving.render(frame, STREAM_SIZE.0, STREAM_SIZE.1).into_raw()
}

/// The edges that the host makes of it.
fn canny(picture: &[u8]) -> Result<Vec<u8>> {
    let (width, height) = (STREAM_SIZE.0 as usize, STREAM_SIZE.1 as usize);
    let thresholds = Thresholds { low: 50, high: 150, norm: firmware::pipeline::Norm::L2 };
    let output = Output::Canny(Smoothing::Gaussian5, thresholds);
    let settings = Settings { output, ..Settings::new(width, height) };
    let mut memory = vec![0; settings.memory()];
    let mut pipeline = Pipeline::new(settings, &mut memory)?;
    let mut edges = Vec::new();
    let mut sink = |product: Product<'_>| {
        if let Product::Edges(words) = product {
            let bit = |x: usize| if words[x / 32] >> (x % 32) & 1 == 1 { 255 } else { 0 };
            edges.extend((0..width).map(bit));
        }
    };
    for line in picture.chunks_exact(width * 3) {
        pipeline.push(line, &mut sink)?;
    }
    pipeline.finish(&mut sink);
    Ok(edges)
}

/// The inspector's turn: what it saves must be a frame of the scene.
fn inspect(address: &str) -> Result<()> {
    let Some(inspector) = std::env::var_os("CAMIF_INSPECT") else {
        println!("{address}: not tried with the inspector, which CAMIF_INSPECT would name");
        return Ok(());
    };
    let folder = top().join("target/qemu/inspected");
    if folder.exists() {
        std::fs::remove_dir_all(&folder)?;
    }
    std::fs::create_dir_all(&folder)?;
    let mut save = Command::new(&inspector);
    save.args(["save", address, "--frames", "1", "--stream", "raw", "--whole", "--out"]).arg(&folder);
    let output = save.output().with_context(|| format!("cannot start {}", inspector.display()))?;
    ensure!(output.status.success(), "camif-inspect: {}", String::from_utf8_lossy(&output.stderr));
    let scene: Vec<Vec<u8>> = (0..STREAM.frames).map(scene).collect();
    let mut kinds = Vec::new();
    for entry in std::fs::read_dir(&folder)? {
        let path = entry?.path();
        let bytes = match path.extension().and_then(|extension| extension.to_str()) {
            Some("raw") => std::fs::read(&path)?,
            Some("png") => image::open(&path)?.into_rgb8().into_raw(),
            _ => continue,
        };
        ensure!(scene.contains(&bytes), "{} is no frame of the scene", path.display());
        kinds.push(path.extension().unwrap_or_default().to_owned());
    }
    kinds.sort();
    ensure!(kinds == ["png", "raw"], "the inspector saved {kinds:?}");
    println!("{address}: what the inspector saved is a frame of the scene");
    Ok(())
}
