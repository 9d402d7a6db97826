use std::ops::Range;

use firmware::camif::{Bus, FIFO_WORDS};

use super::ReportError;
use super::page::{BusFacts, FindingPlace, FrameFacts, Lines, Page};
use super::rivals::add_rivals;
use super::rows::Rows;
use super::take::{Taken, take};
use super::text::{capital, grouped};
use super::waves::waves;
use crate::diagnosis::{CutFrame, Diagnosis, Finding, Place, Recording, cut, fix};
use crate::guess::BusGuess;
use crate::picture;
use crate::profile::{Choice as _, Profile};
use crate::receiver::{Activity, Source};

/// Frames whose pictures stand in the page.
const MOST_PICTURES: usize = 4;
/// Buckets of FIFO and DMA.
const MOST_BUCKETS: usize = 2_048;
/// Pixel clocks shown before and after the place of a finding.
const AROUND: u64 = 256;
/// Pixel clocks shown of the line of a finding, at most.
const MOST_OF_LINE: u64 = 8_192;

/// What a report is of.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// The trace and its profile.
    pub source: &'a Source,
    /// Its beginning in memory.
    pub recording: &'a Recording,
    /// What is wrong with it.
    pub diagnosis: &'a Diagnosis,
    /// What the bus alone suggests, if that was asked.
    pub guess: Option<&'a BusGuess>,
    /// The profile is the guess's first.
    pub guess_is_profile: bool,
    /// A frame as the device got it, its bytes as DMA wrote them.
    pub received: Option<&'a [u8]>,
    /// What the user should know.
    pub notes: &'a [String],
    /// The memory bus of the block that receives the frames.
    pub bus: Bus,
}

/// Puts a report together: receives the frames, places the findings in them, and makes the pictures.
///
/// # Errors
/// [`ReportError`] if the trace cannot be played or the driver refuses the profile.
pub fn build(subject: &Subject<'_>) -> Result<Page, ReportError> {
    let Subject { source, recording, diagnosis, .. } = *subject;
    let given = source.profile();
    let mut page = Page {
        trace: source.trace().path().display().to_string(),
        profile: given.name.clone(),
        profile_toml: given.to_toml(),
        is_clean: diagnosis.is_clean(),
        diagnosis: diagnosis.clone(),
        notes: subject.notes.to_vec(),
        fifo_words: FIFO_WORDS,
        ..Page::default()
    };
    (page.verdict, page.summary) = verdict(diagnosis);
    let near = places(diagnosis);
    let mut activity = Activity::new(MOST_BUCKETS);
    let (received, summary) = take(source, given, subject.bus, &near, Some(&mut activity))?;
    let mut corrected = None;
    if !has_picture(&received) {
        let why = summary.last.cause;
        page.notes.push(format!(
            "by the profile as given came no frame with data in it; at the trace's end: {why}"
        ));
        for mended in diagnosis.findings.iter().filter_map(|finding| fix(finding, given)) {
            let mut again = Activity::new(MOST_BUCKETS);
            let (better, _) = take(source, &mended.profile, subject.bus, &near, Some(&mut again))?;
            if has_picture(&better) {
                page.notes.push("picture, lines and FIFO are those of the corrected profile".to_owned());
                activity = again;
                corrected = Some((better, mended.profile));
                break;
            }
        }
    }
    let (frames, profile) =
        corrected.as_ref().map_or((&received, given), |(frames, profile)| (frames, profile));
    let came = summary.statistics.frames() as usize;
    if came > frames.len() {
        page.notes.push(format!("the first {} of {came} frames are listed", frames.len()));
    }
    page.bus = facts(profile);
    page.activity = Some(activity);
    let cuts = cut(recording, profile);
    let cut_of: Vec<Option<usize>> = frames.iter().map(|frame| cut_of(&cuts, frame)).collect();
    page.places = diagnosis.findings.iter().map(|finding| place(finding, profile, &cuts, &cut_of)).collect();
    let pictured = pictured(&page.places, frames);
    let mut wanted: Vec<Range<u64>> = Vec::new();
    for place in &page.places {
        wanted.push(place.clock.saturating_sub(AROUND)..place.clock + AROUND);
        let lines = cuts.iter().flat_map(|cut| &cut.lines);
        wanted.extend(
            lines
                .filter(|line| (line.start..line.start + line.samples).contains(&place.clock))
                .map(|line| line.start..line.start + line.samples.min(MOST_OF_LINE)),
        );
    }
    for (index, frame) in frames.iter().enumerate() {
        let rows = cut_of[index]
            .and_then(|cut| cuts.get(cut))
            .map(|cut| Rows::new(cut, profile.samples_per_line(), profile.frame.height));
        let mut facts = FrameFacts {
            sequence: frame.verdict.sequence,
            verdict: frame.verdict.outcome.to_string(),
            is_good: frame.verdict.outcome.is_good(),
            bytes: frame.verdict.bytes,
            lines: frame.verdict.lines,
            crc32: frame.crc32,
            cut: cut_of[index],
            ..FrameFacts::default()
        };
        if let (true, Some(bytes)) = (pictured.contains(&index), &frame.bytes) {
            facts.picture = Some(page.add(&picture::decode(bytes, profile).picture));
            facts.row_clocks = rows.map(|rows| rows.clocks()).unwrap_or_default();
            let clocks = facts.row_clocks.iter().flatten();
            wanted.extend(clocks.map(|clock| clock.saturating_sub(16)..clock + 48));
            let lines = cut_of[index].and_then(|cut| cuts.get(cut)).map(|cut| &cut.lines[..]);
            let ends = lines.unwrap_or_default().iter().map(|line| line.start + line.samples);
            wanted.extend(ends.map(|end| end.saturating_sub(48)..end + 32));
        }
        page.frames.push(facts);
    }
    page.waves = waves(recording, profile.bus.bits, &wanted);
    page.cuts = cuts.iter().map(lines).collect();
    add_rivals(&mut page, subject, &received, pictured.first().copied().unwrap_or(0))?;
    Ok(page)
}

/// The pixel clocks at which findings show.
pub(super) fn places(diagnosis: &Diagnosis) -> Vec<u64> {
    diagnosis.findings.iter().map(|finding| finding.at_pclk).collect()
}

fn has_picture(frames: &[Taken]) -> bool {
    frames.iter().any(|frame| frame.bytes.is_some() && frame.verdict.bytes > 0)
}

/// The verdict in a few words, and in a sentence.
fn verdict(diagnosis: &Diagnosis) -> (String, String) {
    let Some(first) = diagnosis.findings.first() else {
        let summary = format!(
            "{} frames in {} pixel clocks are as the profile says.",
            grouped(diagnosis.measured.frames),
            grouped(diagnosis.measured.clocks)
        );
        return ("No fault found".to_owned(), summary);
    };
    let place = match diagnosis.place {
        Place::Receiver => "The cause is in the receiver.",
        _ => "The cause is on the wire or in the sensor.",
    };
    let like: Vec<&str> = diagnosis.ambiguous_with.iter().map(|kind| kind.name()).collect();
    let like = if like.is_empty() {
        String::new()
    } else {
        format!(" It looks just like {}; the trace does not tell them apart.", like.join(", "))
    };
    (first.fault.to_string(), format!("{}. {place}{like}", capital(first.fault.about())))
}

fn facts(profile: &Profile) -> BusFacts {
    BusFacts {
        bits: profile.bus.bits,
        sync: profile.bus.sync.name(),
        clock_edge: profile.bus.clock_edge.name(),
        hsync_blank_high: profile.bus.hsync_blank.is_high(),
        vsync_blank_high: profile.bus.vsync_blank.is_high(),
        pclk_hz: profile.timing.pclk_hz,
        width: profile.frame.width,
        height: profile.frame.height,
        samples_per_line: profile.samples_per_line(),
        clocks_per_line: profile.clocks_per_line(),
    }
}

/// The frame of the trace that a received one is: the last that had ended when it came.
fn cut_of(cuts: &[CutFrame], frame: &Taken) -> Option<usize> {
    cuts.iter().rposition(|cut| cut.end.is_some_and(|end| end <= frame.clock))
}

fn place(finding: &Finding, profile: &Profile, cuts: &[CutFrame], cut_of: &[Option<usize>]) -> FindingPlace {
    let frame = cut_of.iter().position(Option::is_some);
    let first = frame.and_then(|frame| cut_of[frame]).and_then(|cut| cuts.get(cut));
    let start = first.and_then(|cut| cut.lines.first()).map_or(0, |line| line.start);
    // A finding of no line at or before the first one is of the whole trace.
    let everywhere = finding.line.is_none() && finding.at_pclk <= start;
    if everywhere {
        return FindingPlace { clock: start, frame, row: None, everywhere };
    }
    let clock = finding.at_pclk;
    // What is told of a line at the very end of a frame is of the frame that ended.
    let ended = |end: u64| end < clock || end == clock && finding.line.unwrap_or(0) == 0;
    let which = cuts.partition_point(|cut| cut.end.is_some_and(ended));
    let frame = cut_of.iter().position(|cut| *cut == Some(which));
    let rows = cuts
        .get(which)
        .filter(|_| frame.is_some())
        .map(|cut| Rows::new(cut, profile.samples_per_line(), profile.frame.height));
    // A frame compared tells the byte, which is more than the clock.
    let byte = finding.evidence.numbers.get("first_wrong_byte");
    let sample = byte.map(|byte| *byte as u64 / u64::from(profile.bus.bytes_per_sample()));
    let exact = rows.as_ref().and_then(|rows| rows.clock_of_sample(sample?));
    let clock = exact.unwrap_or(clock);
    FindingPlace { clock, frame, row: rows.and_then(|rows| rows.row_of(clock)), everywhere }
}

/// The frames whose pictures are shown: those of the findings, the most likely first, then the first ones.
fn pictured(places: &[FindingPlace], frames: &[Taken]) -> Vec<usize> {
    let mut pictured = Vec::new();
    for index in places.iter().filter_map(|place| place.frame).chain(0..frames.len()) {
        let there = frames.get(index).is_some_and(|frame| frame.bytes.is_some());
        if there && !pictured.contains(&index) && pictured.len() < MOST_PICTURES {
            pictured.push(index);
        }
    }
    pictured
}

fn lines(cut: &CutFrame) -> Lines {
    let (start, samples) = cut.lines.iter().map(|line| (line.start, line.samples)).unzip();
    Lines { start, samples }
}
