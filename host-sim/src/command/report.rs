use std::fmt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::Context as _;
use serde::Serialize;

use super::clock::ClockReport;
use crate::picture;
use crate::pipeline::{Picture, Runner};
use crate::profile::{Choice, Profile};
use crate::receiver::{Received, Summary};
pub(super) use crate::report::grouped;

/// What came of a replay: the JSON of `--json`.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    /// The trace file.
    pub(super) trace: String,
    /// The profile's name.
    pub(super) profile: String,
    pub(super) frames: Vec<FrameReport>,
    pub(super) overruns: u32,
    /// Pixel clocks played.
    pub(super) pclk: u64,
    /// Seconds that reading the trace, the block and the driver took, without checksums and pictures.
    pub(super) seconds: f64,
    /// Seconds that the trace lasts by its pixel clock.
    pub(super) trace_seconds: f64,
    /// Words of a frame that the trace breaks off in.
    pub(super) unfinished_words: u32,
    /// Unknown levels (`x`, `z`) that were read as 0.
    pub(super) unknown_levels: u64,
    /// The pixel clock, if it had to be recovered from an analyser's samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) clock: Option<ClockReport>,
    /// Why there was no frame, if there was none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) no_frame: Option<String>,
}

/// One frame.
#[derive(Debug, Serialize)]
pub(super) struct FrameReport {
    seq: u32,
    width: u32,
    height: u32,
    format: String,
    lines: u32,
    min_line_bytes: u32,
    max_line_bytes: u32,
    bytes: u32,
    /// CRC-32 (IEEE) of the bytes as DMA wrote them; nothing for a lost frame.
    pub(super) crc32: Option<u32>,
    verdict: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    png: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    raw: Option<PathBuf>,
    /// The frame as the pipeline made it.
    #[serde(skip_serializing_if = "Option::is_none")]
    op_png: Option<PathBuf>,
}

/// Receives frames: measures them, and writes them to a folder if there is one.
pub(super) struct Collector<'a, 'p> {
    profile: &'a Profile,
    out: Option<&'a Path>,
    runner: Option<&'a mut Runner<'p>>,
    pub(super) frames: Vec<FrameReport>,
    pub(super) error: Option<anyhow::Error>,
    /// Time spent on measuring and writing frames, which is not the block's.
    pub(super) aside: Duration,
}

impl<'a, 'p> Collector<'a, 'p> {
    pub(super) fn new(
        profile: &'a Profile,
        out: Option<&'a Path>,
        runner: Option<&'a mut Runner<'p>>,
    ) -> Self {
        Self { profile, out, runner, frames: Vec::new(), error: None, aside: Duration::ZERO }
    }

    pub(super) fn take(&mut self, received: &Received<'_>) {
        let started = Instant::now();
        let verdict = received.verdict;
        let mut report = FrameReport {
            seq: verdict.sequence,
            width: self.profile.frame.width,
            height: self.profile.frame.height,
            format: Choice::name(self.profile.frame.format).to_owned(),
            lines: verdict.lines,
            min_line_bytes: verdict.min_line_bytes,
            max_line_bytes: verdict.max_line_bytes,
            bytes: verdict.bytes,
            crc32: received.bytes.map(picture::crc32),
            verdict: verdict.outcome.to_string(),
            png: None,
            raw: None,
            op_png: None,
        };
        if let (Some(out), Some(bytes), None) = (self.out, received.bytes, &self.error)
            && let Err(error) = self.write(out, bytes, &mut report)
        {
            self.error = Some(error);
        }
        self.frames.push(report);
        self.aside += started.elapsed();
    }

    fn write(&mut self, out: &Path, bytes: &[u8], report: &mut FrameReport) -> anyhow::Result<()> {
        let stem = format!("frame-{:04}", report.seq);
        let (png, raw) = (out.join(format!("{stem}.png")), out.join(format!("{stem}.raw")));
        let picture = picture::decode(bytes, self.profile).picture;
        picture::write_png(&png, &picture)?;
        picture::write_raw(&raw, bytes)?;
        (report.png, report.raw) = (Some(png), Some(raw));
        if let Some(runner) = &mut self.runner {
            let made = runner.run(Picture::from_image(&picture)).with_context(|| stem.clone())?;
            let png = out.join(format!("{stem}-op.png"));
            picture::write_png(&png, &made.into_image())?;
            report.op_png = Some(png);
        }
        Ok(())
    }
}

impl Report {
    pub(super) fn new(
        trace: &Path,
        profile: &Profile,
        frames: Vec<FrameReport>,
        summary: &Summary,
        seconds: f64,
    ) -> Self {
        Self {
            trace: trace.display().to_string(),
            profile: profile.name.clone(),
            no_frame: frames.is_empty().then(|| summary.last.cause.to_string()),
            frames,
            overruns: summary.statistics.overruns,
            pclk: summary.clocks,
            seconds,
            trace_seconds: profile.seconds(summary.clocks),
            unfinished_words: summary.unfinished_words,
            unknown_levels: 0,
            clock: None,
        }
    }

    /// Every frame is good, and there is one.
    pub(super) fn is_good(&self) -> bool {
        !self.frames.is_empty() && self.frames.iter().all(|frame| frame.verdict == "good")
    }
}

/// Most frames that a table for people lists one by one.
const LISTED: usize = 20;

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:>5}  {:>9}  {:>5}  {:>11}  {:>8}  verdict",
            "frame", "size", "lines", "bytes/line", "crc32"
        )?;
        for frame in self.frames.iter().take(LISTED) {
            let size = format!("{}×{}", frame.width, frame.height);
            let bytes = if frame.min_line_bytes == frame.max_line_bytes {
                frame.max_line_bytes.to_string()
            } else {
                format!("{}–{}", frame.min_line_bytes, frame.max_line_bytes)
            };
            let crc = frame.crc32.map_or_else(|| "–".to_owned(), |crc| format!("{crc:08x}"));
            writeln!(
                f,
                "{:>5}  {size:>9}  {:>5}  {bytes:>11}  {crc:>8}  {}",
                frame.seq, frame.lines, frame.verdict
            )?;
        }
        if self.frames.len() > LISTED {
            writeln!(f, "{:>5}  and {} more (--json lists all)", "…", self.frames.len() - LISTED)?;
        }
        if let Some(why) = &self.no_frame {
            writeln!(f, "no frame came: {why}")?;
        }
        let good = self.frames.iter().filter(|frame| frame.verdict == "good").count();
        writeln!(f)?;
        writeln!(f, "profile        {}", self.profile)?;
        writeln!(f, "frames         {} ({good} good)", self.frames.len())?;
        writeln!(f, "overruns       {}", self.overruns)?;
        writeln!(f, "pixel clocks   {}", grouped(self.pclk))?;
        if let Some(clock) = &self.clock {
            writeln!(f, "clock          {clock}")?;
        }
        if self.unfinished_words > 0 {
            writeln!(
                f,
                "unfinished     {} words of a frame that the trace breaks off in",
                self.unfinished_words
            )?;
        }
        if self.unknown_levels > 0 {
            writeln!(f, "unknown        {} levels (x, z or X) were read as 0", self.unknown_levels)?;
        }
        let rate = if self.seconds > 0.0 { self.pclk as f64 / self.seconds / 1e6 } else { 0.0 };
        write!(f, "took           {:.3} s, {rate:.0} million clocks a second", self.seconds)
    }
}
