use std::fmt;
use std::time::Duration;

use serde::Serialize;

use super::report::grouped;
use crate::capture::{CaptureDevice, CaptureError, Session, Statistics, Written};
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
    /// From the first frame on; 0 of fewer than two.
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
        let format = &device.opened().format;
        Self {
            device: device.opened().name.clone(),
            format: format.code.to_string(),
            width: format.width,
            height: format.height,
            strides: format.strides.clone(),
            rate: format.rate,
            notes: device.opened().notes.clone(),
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
        // Frames after the first: that one waits for the device to start.
        self.frames_per_second = rate(statistics.taken.saturating_sub(1), session.between);
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
        write!(f, "  took       {:.2} s", self.seconds)?;
        if self.frames_per_second > 0.0 {
            write!(f, ", {:.2} frames a second", self.frames_per_second)?;
        }
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
}
