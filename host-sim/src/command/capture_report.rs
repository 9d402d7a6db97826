use std::fmt;
use std::path::Path;
use std::time::Duration;

use serde::Serialize;

use super::report::grouped;
use crate::capture::{CaptureDevice, CaptureError, Found, FoundSize, Session, Statistics, Written};
use crate::trace::Created;

/// What came of a capture: the JSON of `--json`.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    pub(super) devices: Vec<DeviceReport>,
}

/// What came of one device.
#[derive(Debug, Serialize)]
pub(super) struct DeviceReport {
    device: String,
    format: String,
    width: u32,
    height: u32,
    /// Bytes from line to line.
    strides: Vec<u32>,
    /// Frames a second that the device says.
    rate: Option<f64>,
    notes: Vec<String>,
    #[serde(flatten)]
    statistics: Statistics,
    /// From the start to the last frame.
    seconds: f64,
    frames_per_second: f64,
    /// Processor time of a frame, in all threads.
    processor_ms_per_frame: Option<f64>,
    copied_bytes_per_frame: u64,
    converted_bytes_per_frame: u64,
    files: Vec<Written>,
    #[serde(skip_serializing_if = "Option::is_none")]
    trace: Option<TraceReport>,
    /// Why it ended before its time.
    error: Option<String>,
    #[serde(skip)]
    failure: Option<CaptureError>,
}

#[derive(Debug, Serialize)]
struct TraceReport {
    trace: String,
    pclk: u64,
    bytes: u64,
}

impl DeviceReport {
    pub(super) fn new(device: &dyn CaptureDevice) -> Self {
        let format = device.format();
        Self {
            device: device.name().to_owned(),
            format: format.code.to_string(),
            width: format.width,
            height: format.height,
            strides: format.strides.clone(),
            rate: format.rate,
            notes: device.notes().to_vec(),
            statistics: Statistics::default(),
            seconds: 0.0,
            frames_per_second: 0.0,
            processor_ms_per_frame: None,
            copied_bytes_per_frame: 0,
            converted_bytes_per_frame: 0,
            files: Vec::new(),
            trace: None,
            error: None,
            failure: None,
        }
    }

    pub(super) fn add(&mut self, session: Session) {
        let statistics = session.statistics;
        let used = (statistics.good + statistics.broken).saturating_sub(statistics.dropped).max(1);
        self.seconds = session.took.as_secs_f64();
        self.frames_per_second = rate(statistics.taken, session.took);
        let per_frame = |time: Duration| time.as_secs_f64() * 1e3 / statistics.taken.max(1) as f64;
        self.processor_ms_per_frame = session.processor.map(per_frame);
        self.copied_bytes_per_frame = statistics.copied_bytes / used;
        self.converted_bytes_per_frame = statistics.converted_bytes / used;
        self.statistics = statistics;
        if let Some(error) = session.error {
            self.failed(error);
        }
    }

    pub(super) fn wrote(&mut self, files: Vec<Written>, trace: Option<Created>) {
        self.files = files;
        let report = |trace: Created| TraceReport {
            trace: trace.path.display().to_string(),
            pclk: trace.clocks,
            bytes: trace.bytes,
        };
        self.trace = trace.map(report);
    }

    /// The first failure is the one.
    pub(super) fn failed(&mut self, error: CaptureError) {
        if self.failure.is_none() {
            self.error = Some(error.to_string());
            self.failure = Some(error);
        }
    }

    pub(super) fn take_error(&mut self) -> Option<anyhow::Error> {
        self.failure.take().map(Into::into)
    }

    pub(super) fn is_clean(&self) -> bool {
        self.statistics.is_clean()
    }
}

fn rate(frames: u64, time: Duration) -> f64 {
    let seconds = time.as_secs_f64();
    if seconds > 0.0 { frames as f64 / seconds } else { 0.0 }
}

/// What there is to say of frames, the faults only where there are any.
fn faults(statistics: &Statistics) -> String {
    let faults = [
        ("lost by the device", statistics.lost),
        ("damaged", statistics.damaged),
        ("short", statistics.short),
        ("broken", statistics.broken),
        ("dropped here", statistics.dropped),
        ("restarts", statistics.restarts),
    ];
    let told = faults.iter().filter(|(_, count)| *count > 0);
    let told: Vec<String> = told.map(|(what, count)| format!("{} {what}", grouped(*count))).collect();
    if told.is_empty() { "none lost".to_owned() } else { told.join(", ") }
}

/// The live count.
pub(super) fn count(device: &str, statistics: &Statistics, time: Duration) -> String {
    format!(
        "{device}: {} frames, {:.1} a second, {}",
        grouped(statistics.taken),
        rate(statistics.taken, time),
        faults(statistics)
    )
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.devices.iter().try_for_each(|device| write!(f, "{device}"))
    }
}

impl fmt::Display for DeviceReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let statistics = &self.statistics;
        writeln!(f, "{}", self.device)?;
        write!(f, "  format     {} {} × {}", self.format, self.width, self.height)?;
        writeln!(f, "{}", self.rate.map_or_else(String::new, |rate| format!(", {rate:.2} frames a second")))?;
        writeln!(f, "  frames     {}, {}", grouped(statistics.taken), faults(statistics))?;
        write!(f, "  took       {:.2} s, {:.2} frames a second", self.seconds, self.frames_per_second)?;
        let processor = self.processor_ms_per_frame;
        writeln!(
            f,
            "{}",
            processor.map_or_else(String::new, |spent| format!(", {spent:.2} ms of processor a frame"))
        )?;
        writeln!(
            f,
            "  memory     {} bytes copied and {} made pictures of, a frame",
            grouped(self.copied_bytes_per_frame),
            grouped(self.converted_bytes_per_frame)
        )?;
        let first = self
            .files
            .first()
            .and_then(|file| file.png.as_ref().or(file.raw.as_ref()).or(file.op_png.as_ref()));
        if let Some(folder) = first.and_then(|path| path.parent()) {
            writeln!(f, "  pictures   {}", folder.display())?;
        }
        if let Some(trace) = &self.trace {
            writeln!(
                f,
                "  trace      {}, {} pixel clocks, {} bytes",
                trace.trace,
                grouped(trace.pclk),
                grouped(trace.bytes)
            )?;
        }
        Ok(())
    }
}

/// What there is on this machine, why some of it can't be asked, and what to check where there is nothing.
fn search() -> (Vec<Found>, Vec<CaptureError>, Vec<&'static str>) {
    let (mut found, mut errors, mut advice) = (Vec::new(), Vec::new(), Vec::new());
    #[cfg(all(target_os = "linux", target_pointer_width = "64"))]
    {
        let (devices, failed) = crate::capture::v4l2::list();
        if devices.is_empty() {
            advice.push(crate::capture::v4l2::ADVICE);
        }
        found.extend(devices);
        errors.extend(failed);
    }
    #[cfg(not(all(target_os = "linux", target_pointer_width = "64")))]
    advice.push("V4L2: a part of Linux, on machines of 64 bits");
    (found, errors, advice)
}

/// The camera that is taken where none is chosen.
pub(super) fn first() -> Option<Found> {
    search().0.into_iter().next()
}

/// Prints every camera.
pub(super) fn list(json: bool) -> anyhow::Result<()> {
    let (found, errors, advice) = search();
    if json {
        let errors: Vec<String> = errors.iter().map(ToString::to_string).collect();
        let list = serde_json::json!({ "devices": found, "errors": errors, "advice": advice });
        println!("{list:#}");
        return Ok(());
    }
    for device in &found {
        print!("{}", Listed(device));
    }
    for error in &errors {
        println!("{error}");
    }
    if found.is_empty() {
        println!("no capture device found");
        advice.iter().for_each(|advice| println!("{advice}"));
    }
    Ok(())
}

struct Listed<'a>(&'a Found);

impl fmt::Display for Listed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(device) = self;
        writeln!(f, "--{} {}  {} ({})", device.interface, device.id, device.name, device.place)?;
        for (index, input) in device.inputs.iter().enumerate() {
            writeln!(f, "  --input {index}  {input}")?;
        }
        let mut last: Option<&[FoundSize]> = None;
        for format in &device.formats {
            let raw = if format.picture { "" } else { ", raw bytes only" };
            writeln!(f, "  --format {:7} {}{raw}", format.code, format.name)?;
            // Most devices offer the same sizes in all formats: once is enough.
            if last != Some(&format.sizes) {
                for size in &format.sizes {
                    writeln!(f, "    {}", ListedSize(size))?;
                }
            } else if !format.sizes.is_empty() {
                writeln!(f, "    as above")?;
            }
            last = Some(&format.sizes);
        }
        Ok(())
    }
}

struct ListedSize<'a>(&'a FoundSize);

impl fmt::Display for ListedSize<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(size) = self;
        write!(f, "--size {}x{}", size.width, size.height)?;
        if let Some((width, height)) = size.up_to {
            write!(f, " up to {width}x{height}")?;
        }
        if !size.rates.is_empty() {
            let rates = size.rates.iter().map(|rate| format!("{rate:.2}"));
            let rates = rates.map(|rate| rate.trim_end_matches('0').trim_end_matches('.').to_owned());
            write!(f, "  --rate {}", rates.collect::<Vec<_>>().join(" "))?;
        }
        Ok(())
    }
}

/// Prints the controls of a V4L2 device, after those that are asked for are set.
#[cfg(all(target_os = "linux", target_pointer_width = "64"))]
pub(super) fn list_controls(
    path: &Path,
    input: Option<u32>,
    set: &[(String, String)],
    json: bool,
) -> anyhow::Result<()> {
    use v4l2_capture::ControlKind;

    use crate::capture::v4l2;

    let device = v4l2::open(path)?;
    if let Some(input) = input {
        device.set_input(input)?;
    }
    for (name, value) in set {
        v4l2::set_control(&device, name, value)?;
    }
    let controls = v4l2::controls(&device)?;
    if json {
        let controls: Vec<_> = controls
            .iter()
            .map(|(control, value)| {
                serde_json::json!({
                    "name": control.name,
                    "kind": format!("{:?}", control.kind).to_lowercase(),
                    "minimum": control.minimum,
                    "maximum": control.maximum,
                    "step": control.step,
                    "default": control.default,
                    "value": value.as_ref().map(ToString::to_string),
                    "read_only": control.is_read_only(),
                    "inactive": control.is_inactive(),
                    "items": control.items.iter().map(|item| (item.value, &item.name)).collect::<Vec<_>>(),
                })
            })
            .collect();
        println!("{:#}", serde_json::json!({ "device": path, "controls": controls }));
        return Ok(());
    }
    for (control, value) in controls {
        let value = value.map_or_else(|| "–".to_owned(), |value| value.to_string());
        let range = match control.kind {
            ControlKind::Integer | ControlKind::Integer64 => {
                format!("{} to {}, default {}", control.minimum, control.maximum, control.default)
            }
            ControlKind::Boolean => format!("on or off, default {}", control.default),
            ControlKind::Menu | ControlKind::IntegerMenu => {
                let items = control.items.iter().map(|item| format!("{} {}", item.value, item.name));
                items.collect::<Vec<_>>().join(" · ")
            }
            ControlKind::Button => "press it by any value".to_owned(),
            ControlKind::Text => format!("{} to {} characters", control.minimum, control.maximum),
            ControlKind::Bitmask => format!("bits of {:#x}", control.maximum as u32),
            ControlKind::Compound(_) => "a structure or an array".to_owned(),
        };
        let state = match (control.is_read_only(), control.is_inactive()) {
            (true, _) => ", read only",
            (_, true) => ", switched off by another",
            _ => "",
        };
        println!("{:32} {value:>12}   {range}{state}", control.name);
    }
    Ok(())
}

#[cfg(not(all(target_os = "linux", target_pointer_width = "64")))]
pub(super) fn list_controls(
    path: &Path,
    _: Option<u32>,
    _: &[(String, String)],
    _: bool,
) -> anyhow::Result<()> {
    anyhow::bail!("{}: V4L2 is a part of Linux, on machines of 64 bits", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_count_tells_faults_where_there_are_any() {
        let mut statistics = Statistics::default();
        statistics.taken = 1234;
        assert_eq!(
            count("/dev/video0", &statistics, Duration::from_secs(10)),
            "/dev/video0: 1,234 frames, 123.4 a second, none lost"
        );
        (statistics.lost, statistics.dropped) = (3, 7);
        assert!(
            count("x", &statistics, Duration::ZERO)
                .ends_with("0.0 a second, 3 lost by the device, 7 dropped here")
        );
    }

    #[test]
    fn a_list_says_how_to_ask_for_what_is_there() {
        let size =
            |width, height, up_to, rates: &[f64]| FoundSize { width, height, up_to, rates: rates.to_vec() };
        let format = |code: &str, picture, sizes: Vec<FoundSize>| crate::capture::FoundFormat {
            code: code.to_owned(),
            name: format!("the format {code}"),
            picture,
            sizes,
        };
        let sizes = vec![size(640, 480, None, &[30.0, 29.97, 7.5]), size(2, 2, Some((64, 64)), &[])];
        let device = Found {
            interface: "v4l2",
            id: "/dev/video0".to_owned(),
            name: "Webcam".to_owned(),
            place: "uvcvideo, usb-1".to_owned(),
            inputs: vec!["Camera".to_owned(), "HDMI".to_owned()],
            formats: vec![
                format("YUYV", true, sizes.clone()),
                format("MJPG", true, sizes),
                format("H264", false, Vec::new()),
            ],
        };
        assert_eq!(
            Listed(&device).to_string(),
            "\
--v4l2 /dev/video0  Webcam (uvcvideo, usb-1)
  --input 0  Camera
  --input 1  HDMI
  --format YUYV    the format YUYV
    --size 640x480  --rate 30 29.97 7.5
    --size 2x2 up to 64x64
  --format MJPG    the format MJPG
    as above
  --format H264    the format H264, raw bytes only
"
        );
    }
}
