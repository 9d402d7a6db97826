use std::cell::RefCell;
use std::convert::Infallible;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use firmware::camif::pins::{Samples, Sync};
use firmware::camif::{Bus, Camif, Part};
use firmware::driver::config::Policy;
use firmware::driver::{FrameCamera, StartError, frame_plan};
use firmware::link::packet::Level;
use firmware::link::{Device as _, Format};
use firmware::trace::StretchSink;

use super::board::{BUFFERS, Board};
use super::line::Line;
use super::noise::{Damage, Rates};
use super::sensor::Looking;
use super::station::{Memory, Station};
use super::streams::{STREAMS, Stream};
use super::transport::{self, Address, TransportError};
use crate::profile::Profile;
use crate::receiver::{self, capture_config};
use crate::scene::Scene;
use crate::sensor::VirtualSensor;
use crate::trace::TraceError;

/// The line is served at least that often while pixel clocks pass.
const SERVE: Duration = Duration::from_millis(2);
/// How far the pixel clock may be behind before it is given up to catch up.
const LAG: Duration = Duration::from_millis(50);
/// Between two looks while nothing is captured.
const REST: Duration = Duration::from_millis(50);

/// Where pixel clocks come from.
#[derive(Debug)]
pub enum Source {
    /// A virtual sensor that looks at a scene.
    Scene {
        /// What it looks at.
        scene: Scene,
        /// What it sends.
        profile: Profile,
        /// A sensor with registers, which say what it sends; the profile is that of its start.
        chip: Option<Box<VirtualSensor>>,
    },
    /// A trace, over and over.
    Trace(Box<receiver::Source>),
}

/// What the device is.
#[derive(Debug)]
pub struct Settings {
    /// Where it can be reached.
    pub address: Address,
    /// Rate of its line; without, as fast as its bytes are taken.
    pub baud: Option<u32>,
    /// What goes wrong on the line, both ways.
    pub noise: Rates,
    /// Seed of the noise.
    pub seed: u64,
    /// Frames a second; without, those of the profile.
    pub rate: Option<f64>,
    /// The memory bus of the block.
    pub bus: Bus,
    /// Streams that are on at the start, a bit each, in the order of [`STREAMS`].
    pub on: u32,
    /// Pipelines other than those of [`STREAMS`].
    pub stages: [Option<String>; STREAMS.len()],
    /// Captures from the start; else it waits for START.
    pub running: bool,
    /// Ends after so many frames were sent.
    pub frames: Option<u64>,
}

/// Why no device could be played.
#[derive(Debug, thiserror::Error)]
pub enum StreamError {
    /// It can't be reached.
    #[error(transparent)]
    Transport(#[from] TransportError),
    /// The driver refuses the profile.
    #[error("profile {profile}")]
    Start {
        /// Its name.
        profile: String,
        /// Why.
        #[source]
        error: StartError,
    },
    /// The link has no format for what the DMA writes.
    #[error("profile {profile}: the link can't send lines of {line_bytes} bytes as {format}")]
    Format {
        /// Its name.
        profile: String,
        /// Its format.
        format: &'static str,
        /// Bytes of a line as DMA writes them.
        line_bytes: u32,
    },
    /// The sensor sends nothing.
    #[error("the sensor sends nothing: {0}")]
    Sensor(String),
    /// A stream can't be made so.
    #[error("stream {stream}: {error}")]
    Stages {
        /// Its name.
        stream: &'static str,
        /// What is wrong with its pipeline.
        error: String,
    },
    /// The trace is damaged.
    #[error(transparent)]
    Trace(#[from] TraceError),
}

/// What came of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Frames that were sent to their END.
    pub frames: u64,
    /// Bytes that left.
    pub bytes: u64,
    /// Time since the start.
    pub seconds: f64,
    /// What the noise did to them.
    pub damage: Damage,
}

/// Plays a device until `stop` is set, or all frames were sent. `on_open` gets the URL at which it can be reached.
///
/// # Errors
/// [`StreamError`], before `on_open` is called; but a trace that is damaged ends the device where it is.
pub fn stream(
    source: Source,
    settings: &Settings,
    stop: &AtomicBool,
    on_open: &mut dyn FnMut(&str),
) -> Result<Summary, StreamError> {
    let (profile, looking, trace) = match source {
        Source::Scene { scene, profile, chip } => {
            (profile, Some(Looking { scene, chip: chip.map(|chip| *chip), brightness: 0 }), None)
        }
        Source::Trace(trace) => (trace.profile().clone(), None, Some(trace)),
    };
    let name = describe(&profile, looking.as_ref(), trace.as_deref());
    let streams = streams(settings, &profile)?;
    let mut config = capture_config(&profile);
    config.policy = Policy::NewestWins;
    let part = Part::CAMIF;
    let words = frame_plan(&config, part.transfer_limit).unwrap_or_default().room();
    let mut memory: [Vec<u32>; BUFFERS] = std::array::from_fn(|_| vec![0; words as usize]);
    let camif = RefCell::new(Camif::new(part, settings.bus));
    let refused = |error| StreamError::Start { profile: profile.name.clone(), error };
    let camera = FrameCamera::new(&camif, memory.each_mut().map(Vec::as_mut_slice)).map_err(refused)?;
    // Tried here, so that what the driver refuses is said at the start.
    camera.start(&config).map_err(refused)?;
    camera.stop();

    let mut board = Board::new((&camif, &camera, config), profile.clone(), streams, looking);
    let nominal_us = 1e6 / profile.frames_per_second();
    board.period_us = settings.rate.map_or(nominal_us, |rate| 1e6 / rate).round().clamp(1e3, 6e7) as i32;
    board.bit_errors = (settings.noise.bits * 1e9).round() as i32;
    board.say(Level::Information, format_args!("{name} is up"));
    if settings.running {
        // A device at rest can always be started.
        let _ = board.start();
    }
    let line = Line::new(transport::open(&settings.address)?, settings.baud, settings.noise, settings.seed);
    on_open(&line.url());
    let mut link = Memory::new();
    let line_settings = (settings.baud, settings.noise, settings.seed);
    let mut station = Station::new(board, line, &mut link, stop, name, line_settings);
    station.frames_wanted = settings.frames;
    let mut wires = Wires {
        station,
        nominal_us,
        hz: f64::from(profile.timing.pclk_hz),
        epoch: Instant::now(),
        clocks: 0,
        served: Instant::now(),
        is_trace: trace.is_some(),
    };
    let started = Instant::now();
    let played = match &trace {
        Some(trace) => play_trace(trace, &mut wires),
        None => {
            play_scene(&mut wires);
            Ok(())
        }
    };
    let mut station = wires.station;
    if let Err(error) = &played {
        station.board.say(Level::Error, error);
    }
    station.close();
    let frames = station.frames;
    let line = station.line();
    let (bytes, damage) = (line.sent, line.damage());
    played?;
    Ok(Summary { frames, bytes, seconds: started.elapsed().as_secs_f64(), damage })
}

fn describe(profile: &Profile, looking: Option<&Looking>, trace: Option<&receiver::Source>) -> String {
    let seen = match (looking, trace) {
        (Some(Looking { chip: Some(chip), scene, .. }), _) => format!("{} at {}", chip.name(), scene.name()),
        (Some(looking), _) => looking.scene.name(),
        (None, trace) => trace.map(|trace| trace.trace().path().display().to_string()).unwrap_or_default(),
    };
    format!("host-sim {}, {}, {seen}", env!("CARGO_PKG_VERSION"), profile.name)
}

fn streams(settings: &Settings, profile: &Profile) -> Result<Vec<Stream>, StreamError> {
    let format = profile.frame.format;
    let line_bytes = profile.bytes_per_line();
    if Format::Pixels(format).line_bytes(profile.frame.width as usize) != line_bytes as usize {
        return Err(StreamError::Format { profile: profile.name.clone(), format: format.name(), line_bytes });
    }
    let one = |(number, &(name, stages)): (usize, &(&'static str, &str))| {
        let stages = settings.stages[number].as_deref().unwrap_or(stages);
        let stream = Stream::new(name, stages, profile);
        let mut stream =
            stream.map_err(|error| StreamError::Stages { stream: name, error: error.to_string() })?;
        stream.on = settings.on >> number & 1 != 0;
        Ok(stream)
    };
    STREAMS.iter().enumerate().map(one).collect()
}

/// The wires between sensor and block: pixel clocks at their time.
struct Wires<'s, 'c, 'm> {
    station: Station<'s, 'c, 'm>,
    /// Microseconds of a frame as the profile has it.
    nominal_us: f64,
    /// Pixel clocks a second as the profile has it.
    hz: f64,
    /// When the clocks counted began.
    epoch: Instant,
    clocks: u64,
    served: Instant,
    /// A trace, in which capture may begin anywhere; a sensor that is played is begun with between frames.
    is_trace: bool,
}

impl Wires<'_, '_, '_> {
    /// When the next pixel clock is due.
    fn due(&mut self) -> Instant {
        let slower = f64::from(self.station.board.period_us) / self.nominal_us;
        let due = self.epoch + Duration::from_secs_f64(self.clocks as f64 / self.hz * slower);
        let now = Instant::now();
        if due + LAG < now {
            self.restart(now);
            return now;
        }
        due
    }

    /// Time begins anew.
    fn restart(&mut self, now: Instant) {
        (self.epoch, self.clocks) = (now, 0);
    }

    /// Serves the line until the next pixel clock is due.
    fn keep_time(&mut self) {
        let (due, now) = (self.due(), Instant::now());
        if due > now + SERVE || now > self.served + SERVE {
            let before = self.station.board.period_us;
            self.station.serve(due);
            self.served = Instant::now();
            if self.station.board.period_us != before {
                self.restart(self.served);
            }
        }
    }

    /// Serves the line while nothing is to be captured.
    fn rest(&mut self) {
        while self.station.rests() && !self.station.is_over() {
            self.station.serve(Instant::now() + REST);
            self.restart(Instant::now());
        }
    }
}

impl StretchSink for Wires<'_, '_, '_> {
    type Error = Infallible;

    fn stretch(&mut self, sync: Sync, samples: Samples<'_>) -> Result<(), Infallible> {
        let mut played = 0;
        // A trace can't be left before its end.
        while played < samples.len() && !self.station.is_over() {
            if self.is_trace {
                let passed = self.station.board.statistics().frames();
                self.station.board.before_frame(passed);
            }
            let part = samples.skip(played).take((self.hz * SERVE.as_secs_f64()) as usize + 1);
            let count = self.station.board.run(sync, part);
            played += count;
            self.clocks += count as u64;
            self.keep_time();
        }
        Ok(())
    }
}

fn play_scene(wires: &mut Wires<'_, '_, '_>) {
    let (mut number, mut player, mut trouble) = (0, None, String::new());
    loop {
        wires.rest();
        if wires.station.is_over() {
            return;
        }
        let board = &mut wires.station.board;
        if player.is_none() || std::mem::take(&mut board.sensor_changed) {
            let made = board.looking.as_ref().map(|looking| looking.player(&board.profile));
            player = match made {
                Some(Ok(player)) => {
                    trouble.clear();
                    Some(player)
                }
                Some(Err(reason)) => {
                    if reason != trouble {
                        board.say(Level::Warning, &reason);
                        trouble = reason;
                    }
                    None
                }
                None => return,
            };
        }
        board.before_frame(number);
        let Some(player) = &mut player else {
            wires.station.serve(Instant::now() + REST);
            continue;
        };
        wires.hz = f64::from(player.sensor.profile().timing.pclk_hz);
        let bytes = match &wires.station.board.looking {
            Some(looking) => player.frame(looking, number.into()),
            None => return,
        };
        // A frame of the sensor's own is as long as it should be.
        let _ = player.sensor.play_frame_bytes(&bytes, wires);
        number = number.wrapping_add(1);
    }
}

fn play_trace(trace: &receiver::Source, wires: &mut Wires<'_, '_, '_>) -> Result<(), StreamError> {
    loop {
        wires.rest();
        if wires.station.is_over() {
            return Ok(());
        }
        trace.play(wires, &mut |_| {})?;
    }
}
