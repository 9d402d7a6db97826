use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};

use super::capture_controls::list_controls;
use super::capture_list::list;
use super::capture_report::{DeviceReport, Report};
use super::process::print_help;
use super::{Outcome, progress, stop_on_signal};
use crate::capture::{self, CaptureDevice, CaptureError, Files, Limits, Output, Settings};
use crate::pipeline::Pipeline;
use crate::profile::{DEFAULT, Profile};

/// Options of `capture`.
#[derive(Debug, Args)]
pub struct Capture {
    /// Lists every camera with its formats, sizes and rates
    #[arg(long)]
    list: bool,
    /// A V4L2 device, such as /dev/video0; can be given several times. Without a device the first camera found is taken
    #[arg(long, value_name = "PATH")]
    v4l2: Vec<PathBuf>,
    /// A camera of libcamera by its name; can be given several times. Needs a host-sim built with `--features libcamera`
    #[arg(long, value_name = "ID")]
    libcamera: Vec<String>,
    /// Lists the controls of the device, and their values
    #[arg(long)]
    controls: bool,
    /// Frames to take of each device; without a number until Ctrl-C
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    frames: Option<u64>,
    /// Writes frames to this folder; of several devices each to a folder of its own in it
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// What to write of a frame
    #[arg(long, value_enum, default_value_t = Kept::Both, requires = "out")]
    keep: Kept,
    /// Also sends each picture through these stages and writes frame-0000-op.png; help says which there are
    #[arg(long, value_name = "PIPELINE")]
    op: Option<String>,
    /// Plays the frames as a camera of --profile into a timing trace; its name ends in .camt or .vcd
    #[arg(long, value_name = "TRACE")]
    as_trace: Option<PathBuf>,
    /// Built-in profile or TOML file of --as-trace
    #[arg(long, default_value = DEFAULT, requires = "as_trace")]
    profile: String,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// Pixel format by its code, such as YUYV; --list says which there are
    #[arg(long, value_name = "CODE", value_parser = parse_code)]
    format: Option<v4l2_capture::FourCc>,
    /// Frames a second
    #[arg(long, value_parser = parse_rate)]
    rate: Option<f64>,
    /// Number of the connector, of devices that have several
    #[arg(long)]
    input: Option<u32>,
    /// The part of the sensor's picture to take: width, height, and pixels from the left and from above
    #[arg(long, value_name = "WxH+X+Y", value_parser = parse_crop)]
    crop: Option<(i32, i32, u32, u32)>,
    /// Sets a control before the first frame; can be given several times. --controls says which there are
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_setting)]
    set: Vec<(String, String)>,
    /// Seconds to wait for a frame before giving up
    #[arg(long, value_name = "SECONDS", default_value = "5", value_parser = parse_seconds)]
    timeout: Duration,
    /// Buffers to ask the device for: more of them outlast a slower disk
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(3..=32))]
    buffers: u32,
    /// Prints one JSON object on stdout
    #[arg(long)]
    json: bool,
}

/// What is kept of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kept {
    /// Picture and bytes
    Both,
    /// The picture alone
    Png,
    /// The bytes alone, which is fastest
    Raw,
}

impl Kept {
    fn files(self) -> Files {
        Files { png: self != Self::Raw, raw: self != Self::Png }
    }
}

/// Where frames come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// The path of a V4L2 device.
    V4l2(PathBuf),
    /// The name of a camera of libcamera.
    Libcamera(String),
}

impl Source {
    /// A name for the device's folder: the last word of a path; a whole name of libcamera, as only that is the camera's own.
    fn folder_name(&self) -> String {
        let name = match self {
            Self::V4l2(path) => path.file_name().unwrap_or_default().to_string_lossy(),
            Self::Libcamera(id) => id.trim_matches(|letter: char| !letter.is_ascii_alphanumeric()).into(),
        };
        name.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '-' }).collect()
    }

    /// Starts the device and lends it to `used`.
    fn with(&self, settings: &Settings, used: Use<'_>) -> anyhow::Result<DeviceReport> {
        match self {
            #[cfg(all(target_os = "linux", target_pointer_width = "64"))]
            Self::V4l2(path) => used(&mut capture::v4l2::V4l2::start(path, settings)?),
            #[cfg(all(target_os = "linux", feature = "libcamera"))]
            Self::Libcamera(id) => used(&mut capture::libcamera::Libcamera::start(id, settings)?),
            #[allow(unreachable_patterns, reason = "which of them is left is a matter of the build")]
            other => {
                let _ = (settings, used);
                Err(other.is_not_built())
            }
        }
    }

    /// Why this build can't use it.
    pub(super) fn is_not_built(&self) -> anyhow::Error {
        match self {
            Self::V4l2(path) => {
                anyhow::anyhow!("{}: V4L2 is a part of Linux, on machines of 64 bits", path.display())
            }
            Self::Libcamera(id) => anyhow::anyhow!(
                "{id}: this host-sim is built without libcamera; build it with `--features libcamera`, \
                 for which docs/capture.md says what to install"
            ),
        }
    }
}

impl Capture {
    pub(super) fn run(&self) -> anyhow::Result<Outcome> {
        if let Some(op) = &self.op
            && print_help(op)?
        {
            return Ok(Outcome::Fine);
        }
        if self.list {
            list(self.json)?;
            return Ok(Outcome::Fine);
        }
        let pipeline: Option<Pipeline> = self.op.as_deref().map(str::parse).transpose().context("--op")?;
        if pipeline.is_some() && self.out.is_none() {
            bail!("--op makes pictures; say with `--out DIR` where to");
        }
        let chosen = self.choose()?;
        if self.controls {
            if self.json && chosen.len() > 1 {
                bail!("--json prints one object; give one device to --controls");
            }
            for source in &chosen {
                list_controls(source, self.input, &self.set, self.json)?;
            }
            return Ok(Outcome::Fine);
        }
        if chosen.len() > 1 && self.as_trace.is_some() {
            bail!("a trace holds one camera; give one device to --as-trace");
        }
        let profile = self.as_trace.as_ref().map(|_| Profile::find(&self.profile)).transpose()?;
        let stop = stop_on_signal()?;
        let bars = progress::lines();
        let one = |device: &Source| {
            let line = bars.add(progress::line());
            let report =
                self.capture(device, chosen.len() > 1, pipeline.as_ref(), profile.as_ref(), &stop, &line);
            line.finish_and_clear();
            report
        };
        // A device that fails does not end the others.
        let reports: Vec<anyhow::Result<DeviceReport>> = std::thread::scope(|scope| {
            let one = &one;
            let threads: Vec<_> = chosen.iter().map(|device| scope.spawn(move || one(device))).collect();
            threads
                .into_iter()
                .map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
                .collect()
        });
        finish(reports, self.json)
    }

    fn choose(&self) -> anyhow::Result<Vec<Source>> {
        let paths = self.v4l2.iter().cloned().map(Source::V4l2);
        let chosen: Vec<Source> =
            paths.chain(self.libcamera.iter().cloned().map(Source::Libcamera)).collect();
        if chosen.is_empty() {
            return Ok(vec![super::capture_list::first().ok_or(CaptureError::None)?]);
        }
        Ok(chosen)
    }

    fn settings(&self) -> Settings {
        Settings {
            size: self.size,
            code: self.format,
            rate: self.rate,
            input: self.input,
            crop: self.crop,
            controls: self.set.clone(),
            buffers: self.buffers,
        }
    }

    /// Captures from one device, from the first setting to the last file.
    fn capture(
        &self,
        source: &Source,
        in_own_folder: bool,
        pipeline: Option<&Pipeline>,
        profile: Option<&Profile>,
        stop: &AtomicBool,
        line: &indicatif::ProgressBar,
    ) -> anyhow::Result<DeviceReport> {
        let folder = self
            .out
            .as_ref()
            .map(|out| if in_own_folder { out.join(source.folder_name()) } else { out.clone() });
        let mut use_device = |device: &mut dyn CaptureDevice| {
            self.use_device(device, folder.as_deref(), pipeline, profile, stop, line)
        };
        source.with(&self.settings(), &mut use_device)
    }

    fn use_device(
        &self,
        device: &mut dyn CaptureDevice,
        folder: Option<&Path>,
        pipeline: Option<&Pipeline>,
        profile: Option<&Profile>,
        stop: &AtomicBool,
        line: &indicatif::ProgressBar,
    ) -> anyhow::Result<DeviceReport> {
        let name = device.opened().name.clone();
        let mut output = Output::new(&name, &device.opened().format);
        if let Some(folder) = folder {
            output = output.to_folder(folder, self.keep.files())?;
        }
        if let Some(pipeline) = pipeline {
            output = output.through(pipeline);
        }
        if let (Some(path), Some(profile)) = (&self.as_trace, profile) {
            output = output.to_trace(path, profile)?;
        }
        for note in device.opened().notes.iter().cloned().chain(output.note()) {
            line.suspend(|| eprintln!("note: {name}: {note}"));
        }
        let mut report = DeviceReport::new(device);
        let limits = Limits { frames: self.frames, timeout: self.timeout };
        let idle = output.is_idle();
        let started = std::time::Instant::now();
        let session =
            capture::capture(device, limits, (!idle).then_some(&mut output), stop, &mut |statistics| {
                line.set_message(super::capture_report::count(&name, statistics, started.elapsed()));
                line.tick();
            });
        report.add(session);
        match output.finish() {
            Ok((written, trace)) => report.wrote(written, trace),
            // What ended the capture is why there is no trace.
            Err(error) => report.failed(error),
        }
        Ok(report)
    }
}

type Use<'a> = &'a mut dyn FnMut(&mut dyn CaptureDevice) -> anyhow::Result<DeviceReport>;

/// Prints what came of all devices. The first that could not be used at all, or that failed, is the error.
fn finish(reports: Vec<anyhow::Result<DeviceReport>>, json: bool) -> anyhow::Result<Outcome> {
    let (mut devices, mut errors) = (Vec::new(), Vec::new());
    for report in reports {
        match report {
            Ok(mut report) => {
                errors.extend(report.take_error());
                devices.push(report);
            }
            Err(error) => errors.push(error),
        }
    }
    let clean = devices.iter().all(DeviceReport::is_clean);
    if !devices.is_empty() {
        let report = Report { devices };
        if json {
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            print!("{report}");
        }
    }
    let mut errors = errors.into_iter();
    let Some(first) = errors.next() else {
        return Ok(if clean { Outcome::Fine } else { Outcome::Fault });
    };
    for other in errors {
        eprintln!("error: {other:#}");
    }
    Err(first)
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let wrong = || "give width and height, such as 640x480".to_owned();
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(wrong)?;
    match (width.trim().parse(), height.trim().parse()) {
        (Ok(width @ 1..=65_535), Ok(height @ 1..=65_535)) => Ok((width, height)),
        _ => Err(wrong()),
    }
}

fn parse_crop(text: &str) -> Result<(i32, i32, u32, u32), String> {
    let wrong = || "give width, height, left and top, such as 320x240+16+8".to_owned();
    let (size, place) = text.split_once('+').ok_or_else(wrong)?;
    let (left, top) = place.split_once('+').ok_or_else(wrong)?;
    let (width, height) = parse_size(size).map_err(|_| wrong())?;
    match (left.parse::<u16>(), top.parse::<u16>()) {
        (Ok(left), Ok(top)) => Ok((left.into(), top.into(), width, height)),
        _ => Err(wrong()),
    }
}

fn parse_code(text: &str) -> Result<v4l2_capture::FourCc, String> {
    v4l2_capture::FourCc::parse(text).ok_or_else(|| "give four characters, such as YUYV".to_owned())
}

fn parse_rate(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate| (0.001..=100_000.0).contains(rate));
    rate.ok_or_else(|| "give frames a second, such as 30".to_owned())
}

fn parse_seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|seconds| (0.001..=1e6).contains(seconds));
    seconds.map(Duration::from_secs_f64).ok_or_else(|| "give seconds, such as 5 or 0.5".to_owned())
}

fn parse_setting(text: &str) -> Result<(String, String), String> {
    let (name, value) =
        text.split_once('=').ok_or_else(|| "give a name and a value, such as gain=100".to_owned())?;
    Ok((name.trim().to_owned(), value.trim().to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_crops_and_settings_are_read() {
        assert_eq!(parse_size("640x480"), Ok((640, 480)));
        assert_eq!(parse_crop("320x240+16+8"), Ok((16, 8, 320, 240)));
        assert_eq!(parse_setting("test_pattern=100% Colorbar").unwrap().1, "100% Colorbar");
        assert_eq!(parse_setting("string=a=b").unwrap(), ("string".to_owned(), "a=b".to_owned()));
        for text in ["", "640", "0x4", "640x", "x", "640x480x3", "-1x5", "99999x1"] {
            assert!(parse_size(text).is_err(), "{text}");
        }
        for text in ["640x480", "640x480+1", "640x480+1+x", "+1+2", "640x480+-1+2"] {
            assert!(parse_crop(text).is_err(), "{text}");
        }
        assert!(parse_setting("gain").is_err() && parse_code("YUYV2").is_err());
        assert!(parse_rate("0").is_err() && parse_rate("NaN").is_err() && parse_rate("29.97").is_ok());
        assert!(parse_seconds("-1").is_err() && parse_seconds("inf").is_err());
    }

    #[test]
    fn folders_are_named_after_devices() {
        let v4l2 = |path: &str| Source::V4l2(path.into()).folder_name();
        assert_eq!(v4l2("/dev/video12"), "video12");
        assert_eq!(v4l2("/dev/v4l/by-id/usb-A_B.1-index0"), "usb-A-B-1-index0");
        let libcamera = |id: &str| Source::Libcamera(id.to_owned()).folder_name();
        assert_eq!(libcamera("/base/soc/i2c0mux/i2c@1/imx219@10"), "base-soc-i2c0mux-i2c-1-imx219-10");
    }
}
