use std::cell::RefCell;
use std::collections::VecDeque;
use std::fmt;
use std::ops::Range;
use std::rc::Rc;

use firmware::camif::Camif;
use firmware::camif::pins::{Samples, Sync};
use firmware::driver::verdict::{Outcome, Statistics, Verdict};
use firmware::driver::{Config, FrameCamera};
use firmware::link::packet::{Level, State, Status, cause_code};
use firmware::link::{Choice, Device, Parameter, Resend};
use firmware::port::Registers;

use super::sensor::Looking;
use super::streams::{Capture, Prepared, Stream};
use crate::profile::Profile;
use crate::sensor::VirtualSensor;

/// Frame buffers: two that the DMA fills in turn, one that is ready, one that is being taken.
pub(super) const BUFFERS: usize = 4;
/// Frames that are held in case lines of them are asked for again.
const HELD: usize = 4;

pub(super) type Port<'c, 'm> = &'c RefCell<Camif<'m>>;
pub(super) type Camera<'c, 'm> = FrameCamera<'m, Port<'c, 'm>, BUFFERS>;

/// A captured frame, as its streams send it.
pub(super) struct Held {
    pub(super) verdict: Verdict,
    pub(super) sequence: u32,
    /// One for each stream; `None` if it was off.
    pub(super) streams: Vec<Option<Prepared>>,
}

/// Numbers that the host may set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Setting {
    FramePeriod,
    BitErrors,
    /// Not of a sensor with registers, or of a trace.
    Brightness,
}

const SETTINGS: [Setting; 3] = [Setting::FramePeriod, Setting::BitErrors, Setting::Brightness];

/// All of the device but its serial line: the camera, the streams, and what the host wants of them.
pub(super) struct Board<'c, 'm> {
    port: Port<'c, 'm>,
    camera: &'c Camera<'c, 'm>,
    config: Config,
    pub(super) profile: Profile,
    pub(super) streams: Vec<Stream>,
    pub(super) looking: Option<Looking>,
    pub(super) state: State,
    /// Frames of a snapshot that are still to be taken.
    left: u16,
    /// Capture is to be started before the next frame.
    starts: bool,
    /// Frames on the wires before capture was started last.
    before: u32,
    /// What became of the frames of earlier captures.
    earlier: Statistics,
    /// Lost frames that were told of.
    lost: u32,
    pub(super) held: VecDeque<Rc<Held>>,
    /// Lines that are to be sent again.
    pub(super) again: VecDeque<(Rc<Held>, usize, Range<u16>)>,
    /// Streams of which something has changed, a bit each.
    pub(super) changed: u32,
    pub(super) log: VecDeque<(Level, String)>,
    pub(super) period_us: i32,
    /// Bits flipped of a thousand million.
    pub(super) bit_errors: i32,
    pub(super) noise_changed: bool,
    pub(super) sensor_changed: bool,
}

impl<'c, 'm> Board<'c, 'm> {
    pub(super) fn new(
        (port, camera, config): (Port<'c, 'm>, &'c Camera<'c, 'm>, Config),
        profile: Profile,
        streams: Vec<Stream>,
        looking: Option<Looking>,
    ) -> Self {
        Self {
            port,
            camera,
            config,
            profile,
            streams,
            looking,
            state: State::Stopped,
            left: 0,
            starts: false,
            before: 0,
            earlier: Statistics::default(),
            lost: 0,
            held: VecDeque::new(),
            again: VecDeque::new(),
            changed: 0,
            log: VecDeque::new(),
            period_us: 0,
            bit_errors: 0,
            noise_changed: false,
            sensor_changed: false,
        }
    }

    /// Adds a line to the log.
    pub(super) fn say(&mut self, level: Level, text: impl fmt::Display) {
        self.log.push_back((level, text.to_string()));
    }

    /// Before a frame begins on the wires: `passed` have been there before.
    pub(super) fn before_frame(&mut self, passed: u32) {
        if !std::mem::take(&mut self.starts) {
            return;
        }
        self.earlier = self.statistics();
        (self.before, self.lost) = (passed, 0);
        if let Err(error) = self.camera.start(&self.config) {
            self.state = State::Stopped;
            self.say(Level::Error, format_args!("capture does not start: {error}"));
        }
    }

    /// The handler of both interrupts.
    pub(super) fn on_interrupt(&mut self) {
        self.camera.on_interrupt();
        let lost = self.camera.statistics().lost;
        if lost > self.lost {
            let outcome = self.camera.diagnose().evidence.last_damage.unwrap_or(Outcome::Overrun);
            let frames = if lost - self.lost == 1 { "a frame was" } else { "frames were" };
            self.lost = lost;
            self.say(Level::Warning, format_args!("{frames} lost: {outcome}"));
        }
    }

    /// Plays samples into the block up to its next interrupt; returns how many.
    pub(super) fn run(&mut self, sync: Sync, samples: Samples<'_>) -> usize {
        let mut camif = self.port.borrow_mut();
        let played = camif.run(sync, samples);
        let interrupted = camif.interrupts().any();
        drop(camif);
        if interrupted {
            self.on_interrupt();
        }
        played
    }

    /// What became of all frames since the device started.
    pub(super) fn statistics(&self) -> Statistics {
        self.earlier + self.camera.statistics()
    }

    /// Why no frame comes; 0 unless one is waited for.
    pub(super) fn cause(&self) -> u8 {
        if self.state == State::Stopped { 0 } else { cause_code(Some(self.camera.diagnose().cause)) }
    }

    /// Takes a captured frame, if there is one, and makes of it what the streams send.
    pub(super) fn take_frame(&mut self, at: u64) -> Option<Rc<Held>> {
        if self.state == State::Stopped || self.starts {
            return None;
        }
        let frame = self.camera.try_frame()?;
        let verdict = *frame.verdict();
        let sequence = verdict.sequence.wrapping_add(self.before);
        let snapshot = self.state == State::Snapshot;
        let capture = Capture { bytes: frame.bytes(), verdict, sequence, snapshot, at };
        let (mut streams, mut refused) = (Vec::new(), Vec::new());
        for (number, stream) in (0..).zip(&mut self.streams) {
            let prepared = stream.on.then(|| stream.prepare(number, &capture, &self.profile));
            streams.push(prepared.and_then(|made| made.map_err(|error| refused.push(error)).ok()));
        }
        drop(frame);
        for error in refused {
            self.say(Level::Error, error);
        }
        let held = Rc::new(Held { verdict, sequence, streams });
        self.held.push_back(Rc::clone(&held));
        if self.held.len() > HELD {
            self.held.pop_front();
        }
        if snapshot {
            self.left = self.left.saturating_sub(1);
            if self.left == 0 {
                self.camera.stop();
                self.state = State::Stopped;
            }
        }
        Some(held)
    }

    fn stream(&mut self, number: u8) -> Result<&mut Stream, Status> {
        self.streams.get_mut(usize::from(number)).ok_or(Status::NoStream)
    }

    fn setting(&self, number: u16) -> Option<Setting> {
        let has_brightness = self.looking.as_ref().is_some_and(|looking| looking.chip.is_none());
        let setting = *SETTINGS.get(usize::from(number))?;
        (setting != Setting::Brightness || has_brightness).then_some(setting)
    }

    fn chip(&mut self, register: u32) -> Result<(&mut VirtualSensor, u16), Status> {
        let chip = self.looking.as_mut().and_then(|looking| looking.chip.as_mut());
        let chip = chip.ok_or(Status::Unsupported)?;
        Ok((chip, u16::try_from(register).map_err(|_| Status::NoRegister)?))
    }
}

impl Device for Board<'_, '_> {
    fn start(&mut self) -> Result<(), Status> {
        if self.state != State::Running {
            // A snapshot that is under way goes on as part of it.
            self.starts |= self.state == State::Stopped;
            self.state = State::Running;
            self.say(Level::Information, "capture started");
        }
        Ok(())
    }

    fn stop(&mut self) -> Result<(), Status> {
        if self.state != State::Stopped {
            self.camera.stop();
            (self.state, self.starts) = (State::Stopped, false);
            self.say(Level::Information, "capture stopped");
        }
        Ok(())
    }

    fn snapshot(&mut self, frames: u16) -> Result<(), Status> {
        // What was captured before the command is no snapshot.
        self.camera.stop();
        (self.state, self.left, self.starts) = (State::Snapshot, frames, true);
        Ok(())
    }

    fn select_streams(&mut self, on: u32) -> Result<u32, Status> {
        if on.checked_shr(self.streams.len() as u32).unwrap_or(0) != 0 {
            return Err(Status::NoStream);
        }
        for (number, stream) in self.streams.iter_mut().enumerate() {
            let wanted = on >> number & 1 != 0;
            self.changed |= u32::from(stream.on != wanted) << number;
            stream.on = wanted;
        }
        Ok(on)
    }

    fn choose_encoding(&mut self, stream: Option<u8>, choice: Choice) -> Result<(), Status> {
        match stream {
            Some(number) => self.stream(number)?.choice = choice,
            None => self.streams.iter_mut().for_each(|stream| stream.choice = choice),
        }
        self.changed |= stream.map_or(u32::MAX, |number| 1 << number);
        Ok(())
    }

    fn choose_stages(&mut self, stream: u8, pipeline: &str, text: &mut dyn fmt::Write) -> Result<(), Status> {
        let profile = self.profile.clone();
        let chosen = self.stream(stream)?;
        // Text that does not fit is cut.
        if let Err(error) = chosen.choose(pipeline, &profile) {
            let _ = write!(text, "{error}");
            return Err(Status::OutOfRange);
        }
        let _ = text.write_str(&chosen.text);
        self.changed |= 1 << stream;
        Ok(())
    }

    fn parameter(&self, number: u16) -> Option<Parameter<'_>> {
        let (name, value, least, greatest) = match self.setting(number)? {
            Setting::FramePeriod => ("frame period (µs)", self.period_us, 1_000, 60_000_000),
            Setting::BitErrors => ("bit errors (of 10⁹ bits)", self.bit_errors, 0, 100_000_000),
            Setting::Brightness => {
                ("brightness (levels)", self.looking.as_ref().map_or(0, |it| it.brightness), -255, 255)
            }
        };
        Some(Parameter { name, value, least, greatest })
    }

    fn set_parameter(&mut self, number: u16, value: i32) -> Result<(), Status> {
        match self.setting(number).ok_or(Status::OutOfRange)? {
            Setting::FramePeriod => self.period_us = value,
            Setting::BitErrors => (self.bit_errors, self.noise_changed) = (value, true),
            Setting::Brightness => {
                self.looking.as_mut().ok_or(Status::Unsupported)?.brightness = value;
            }
        }
        Ok(())
    }

    fn registers(&mut self) -> &mut dyn Registers {
        &mut self.port
    }

    fn read_sensor(&mut self, register: u32) -> Result<u32, Status> {
        let (chip, register) = self.chip(register)?;
        Ok(chip.registers().get(register).into())
    }

    fn write_sensor(&mut self, register: u32, value: u32) -> Result<(), Status> {
        let value = u16::try_from(value).map_err(|_| Status::OutOfRange)?;
        let (chip, register) = self.chip(register)?;
        chip.poke(register, value);
        self.sensor_changed = true;
        Ok(())
    }

    fn resend(&mut self, lines: &Resend) -> Result<u16, Status> {
        let stream = usize::from(lines.stream);
        self.stream(lines.stream)?;
        let held = self.held.iter().find(|held| held.sequence == lines.sequence).ok_or(Status::Gone)?;
        let frame = held.streams.get(stream).and_then(Option::as_ref).ok_or(Status::Gone)?;
        if lines.first >= frame.start.height {
            return Err(Status::OutOfRange);
        }
        let end = lines.first.saturating_add(lines.count).min(frame.lines());
        let range = lines.first..end.max(lines.first);
        let count = range.len() as u16;
        self.again.push_back((Rc::clone(held), stream, range));
        Ok(count)
    }
}
