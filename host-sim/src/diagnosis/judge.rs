//! All rules in order, and what comes first.

use algos_nostd::pixel::format::Format;

use super::calibration;
use super::data::{Data, MOST_LINES};
use super::finding::{Diagnosis, Evidence, Finding, Measured, Place};
use super::marks::Marks;
use super::mixing::{Mixing, TIMES};
use super::pitch::missed_clocks;
use super::planes::Matrix;
use super::recording::Recording;
use super::remedy;
use super::shape::{Codes, Shape};
use super::structure::{At, Structure, found};
use crate::fault::{FaultKind, reverse_bits, swap_bits};
use crate::profile::{Level, Profile, SyncMode};

/// A pixel clock that is so much faster than promised is too fast.
const FAST: f64 = 1.25;
/// The wires fit the profile if this share of lines and frames does.
const FITS: f64 = 0.9;

/// What is wrong with a recording by its profile; `pclk_hz` is what the trace says of its clock.
#[must_use]
pub fn diagnose(recording: &Recording, profile: &Profile, pclk_hz: Option<u32>) -> Diagnosis {
    let mut shape = Shape::of(recording, profile);
    let mut findings = Vec::new();
    let mut profile = profile.clone();
    if shape.fit(&profile) < FITS || markers_last(recording, &profile) {
        if let Some((finding, fitting, better)) = inverted(recording, &profile, &shape) {
            findings.extend(finding);
            (profile, shape) = (fitting, better);
        } else if let Some((finding, better)) = behind_wires(recording, &profile, &shape) {
            findings.extend(finding);
            shape = better;
        }
    }
    let matrix = matrix_of(recording, &profile, &shape);
    let data = Data::new(&profile, &matrix);
    if findings.is_empty() {
        findings = examine(recording, &profile, &shape, &data);
    }
    if let (Some(pclk), claimed) = (pclk_hz, profile.timing.pclk_hz)
        && f64::from(pclk) > FAST * f64::from(claimed)
    {
        let times = f64::from(pclk) / f64::from(claimed);
        let evidence = Evidence::new(format!(
            "the pixel clock is {pclk} Hz, {times:.2} times the profile's {claimed} Hz"
        ))
        .with("pclk_hz", f64::from(pclk))
        .with("pclk_expected_hz", f64::from(claimed));
        let fault = FaultKind::ClockTooFast;
        findings.push(found(fault, 0.85, At::default(), evidence, remedy::of(fault, &profile)));
    }
    let mut kinds = std::collections::BTreeSet::new();
    findings.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
    findings.retain(|finding| finding.confidence >= 0.05 && kinds.insert(finding.fault));
    for finding in &mut findings {
        finding.score = finding.confidence;
        finding.confidence = calibration::confidence(finding.score);
    }
    let ambiguous_with = findings.first().map(|first| look_alikes(first, &profile)).unwrap_or_default();
    let place = if findings.is_empty() { Place::Nowhere } else { Place::WireOrSensor };
    let measured = measure(recording, &profile, &shape, &data, pclk_hz);
    Diagnosis { findings, ambiguous_with, place, measured }
}

/// Structure and data together.
fn examine(recording: &Recording, profile: &Profile, shape: &Shape, data: &Data<'_>) -> Vec<Finding> {
    let structure = Structure::new(profile, shape);
    let mut findings = structure.findings(recording);
    if findings.is_empty() {
        // Levels and marks are where they should be, so only samples can be wrong.
        findings = data.findings();
        findings.extend(structure.blanking());
        if let Some(mut mixing) = Mixing::of(data.matrix, profile.frame.format).finding(profile, TIMES.1) {
            // Bytes and wires in another order look like many things.
            mixing.confidence *= if findings.is_empty() { 1.0 } else { 0.5 };
            findings.push(mixing);
        }
        return findings;
    }
    // What explains all lines explains those that deviate.
    let other_format = findings.first().is_some_and(|first| first.fault == FaultKind::FormatMismatch);
    let missed = (!other_format).then(|| missed_clocks(recording, profile, shape)).flatten();
    let all = missed.or_else(|| untimely(recording, profile, shape, data));
    if let Some(all) = all {
        findings.iter_mut().for_each(|finding| finding.confidence *= 0.4);
        findings.push(all);
    }
    findings
}

/// Samples that were taken while the wires changed, by the marks of sync and by the picture.
fn untimely(recording: &Recording, profile: &Profile, shape: &Shape, data: &Data<'_>) -> Option<Finding> {
    let format = profile.frame.format;
    let marks = Marks::of(recording, profile, shape);
    let mixing = Mixing::of(data.matrix, format).finding(profile, TIMES.0);
    match (marks.finding(profile), mixing) {
        // The picture may hide most of what happens; a mark does not.
        (Some(marks), Some(mixing)) => {
            let evidence = Evidence {
                text: format!("{}; {}", marks.evidence.text, mixing.evidence.text),
                numbers: marks.evidence.numbers.into_iter().chain(mixing.evidence.numbers).collect(),
            };
            Some(Finding { confidence: 0.97, evidence, ..marks })
        }
        (marks, mixing) => marks.or(mixing),
    }
}

/// The profile with other levels, if the wires fit it then.
fn inverted(
    recording: &Recording,
    profile: &Profile,
    shape: &Shape,
) -> Option<(Vec<Finding>, Profile, Shape)> {
    if profile.bus.sync == SyncMode::Embedded {
        return None;
    }
    let flip = |level: &mut Level| *level = if level.is_high() { Level::Low } else { Level::High };
    let before = if markers_last(recording, profile) { 0.0 } else { shape.fit(profile) };
    for (hsync, vsync) in [(true, false), (false, true), (true, true)] {
        let mut other = profile.clone();
        if hsync {
            flip(&mut other.bus.hsync_blank);
        }
        if vsync {
            flip(&mut other.bus.vsync_blank);
        }
        let better = Shape::of(recording, &other);
        let fit = better.fit(&other);
        if fit < FITS || fit < before + 0.3 || markers_last(recording, &other) {
            continue;
        }
        let at = At { clock: better.frames.first().map_or(0, |frame| frame.start as u64), line: None };
        let kinds = [(hsync, FaultKind::InvertedHsync, "HSYNC"), (vsync, FaultKind::InvertedVsync, "VSYNC")];
        let findings = kinds.into_iter().filter(|(wrong, ..)| *wrong).map(|(_, kind, wire)| {
            let text = format!(
                "with {wire} the other way up {:.0} % of lines and frames are as the profile says, as it is {:.0} %",
                100.0 * fit,
                100.0 * before
            );
            let evidence = Evidence::new(text).with("fit", before).with("fit_inverted", fit);
            found(kind, 0.97, at, evidence, remedy::of(kind, profile))
        });
        return Some((findings.collect(), other, better));
    }
    None
}

/// Markers that stand longer than they are away: of one level nearly all edges fit, but a clock late.
fn markers_last(recording: &Recording, profile: &Profile) -> bool {
    let share = |active: &dyn Fn(&super::recording::Run) -> bool| {
        let clocks: usize = recording.runs.iter().filter(|run| active(run)).map(|run| run.length).sum();
        clocks * 2 > recording.samples.len()
    };
    profile.bus.sync == SyncMode::Marker
        && (share(&|run| run.sync.hsync == profile.bus.hsync_blank.is_high())
            || share(&|run| run.sync.vsync == profile.bus.vsync_blank.is_high()))
}

type Wires = Box<dyn Fn(u16) -> u16>;

/// Faults of data wires behind which sync codes look otherwise.
fn wire_faults() -> Vec<(FaultKind, String, Wires)> {
    let mut faults: Vec<(FaultKind, String, Wires)> = Vec::new();
    for bit in 0..8u32 {
        faults.push((
            FaultKind::StuckBit,
            format!("D{bit} stuck low"),
            Box::new(move |byte| byte & !(1 << bit)),
        ));
        faults.push((
            FaultKind::StuckBit,
            format!("D{bit} stuck high"),
            Box::new(move |byte| byte | 1 << bit),
        ));
        for other in bit + 1..8 {
            faults.push((
                FaultKind::SwappedBits,
                format!("D{bit} and D{other} exchanged"),
                Box::new(move |byte| swap_bits(byte, bit, other)),
            ));
            let both = 1u16 << bit | 1 << other;
            let shorted = move |low: bool| {
                move |byte: u16| match byte & both {
                    0 => byte,
                    set if set == both => byte,
                    _ if low => byte & !both,
                    _ => byte | both,
                }
            };
            faults.push((
                FaultKind::ShortedBits,
                format!("D{bit} and D{other} shorted, low wins"),
                Box::new(shorted(true)),
            ));
            faults.push((
                FaultKind::ShortedBits,
                format!("D{bit} and D{other} shorted, high wins"),
                Box::new(shorted(false)),
            ));
        }
    }
    for places in 1..8u32 {
        faults.push((
            FaultKind::ShiftedBits,
            format!("all wires {places} up"),
            Box::new(move |byte| byte << places & 0xFF),
        ));
        faults.push((
            FaultKind::ShiftedBits,
            format!("all wires {places} down"),
            Box::new(move |byte| byte >> places),
        ));
    }
    faults.push((
        FaultKind::ReversedBus,
        "the bus reversed".to_owned(),
        Box::new(|byte| reverse_bits(byte, 8)),
    ));
    faults
}

/// With codes in the data, wires that are wrong show in the codes.
fn behind_wires(recording: &Recording, profile: &Profile, shape: &Shape) -> Option<(Vec<Finding>, Shape)> {
    if profile.bus.sync != SyncMode::Embedded {
        return None;
    }
    let before = shape.fit(profile);
    let mut fitting = Vec::new();
    for (kind, what, wires) in wire_faults() {
        let codes = Codes::behind(&wires);
        if !codes.are_distinct() {
            continue;
        }
        let better = Shape::by_codes(recording, &codes);
        let fit = better.fit(profile);
        if fit >= 0.5 && fit > before + 0.3 {
            fitting.push((fit, kind, what, better));
        }
    }
    // Several wirings may leave the codes alike; the samples tell.
    let matrix = matrix_of(recording, profile, &fitting.first()?.3);
    let of_data = Data::new(profile, &matrix).findings();
    let supported = |kind: FaultKind| of_data.iter().position(|finding| finding.fault == kind);
    fitting.sort_by(|a, b| {
        let place = |kind| supported(kind).unwrap_or(usize::MAX);
        place(a.1).cmp(&place(b.1)).then(b.0.total_cmp(&a.0))
    });
    let mut findings = Vec::new();
    for (fit, kind, what, better) in &fitting {
        if findings.iter().any(|finding: &Finding| finding.fault == *kind) {
            continue;
        }
        let confidence = match supported(*kind) {
            Some(0) => 0.97,
            Some(_) => 0.5,
            None if findings.is_empty() => 0.7,
            None => 0.2,
        };
        let at = At { clock: better.frames.first().map_or(0, |frame| frame.start as u64), line: None };
        let text = format!(
            "with {what} {:.0} % of the codes and lines are as they should be, as it is {:.0} %",
            100.0 * fit,
            100.0 * before
        );
        let evidence = Evidence::new(text).with("fit", before).with("fit_undone", *fit);
        findings.push(found(*kind, confidence, at, evidence, remedy::of(*kind, profile)));
    }
    let shape = fitting.swap_remove(0).3;
    Some((findings, shape))
}

/// The lines of the right length, in order.
fn matrix_of(recording: &Recording, profile: &Profile, shape: &Shape) -> Matrix {
    let width = profile.samples_per_line() as usize;
    let mut matrix = Matrix { width, bits: profile.bus.bits, ..Matrix::default() };
    let height = profile.frame.height as usize;
    let whole = |lines: usize| lines == height;
    // Whole frames first, so that rows keep their place in the mosaic; parts of frames if there are none.
    let frames: Vec<_> = shape.frames.iter().chain(&shape.open).collect();
    let any_whole = frames.iter().any(|frame| whole(frame.lines.len()));
    for frame in frames {
        let good = frame.lines.iter().all(|line| line.length == width) && whole(frame.lines.len());
        if any_whole && !good && matrix.height() > 0 {
            continue;
        }
        for line in frame.lines.iter().filter(|line| line.length == width) {
            if matrix.height() >= MOST_LINES {
                return matrix;
            }
            matrix.starts.push(line.start);
            matrix.samples.extend_from_slice(&recording.samples[line.start..line.end()]);
        }
    }
    matrix
}

/// Causes of which nothing in a trace tells this one.
fn look_alikes(first: &Finding, profile: &Profile) -> Vec<FaultKind> {
    use FaultKind as K;
    let two_bytes =
        matches!(profile.frame.format, Format::Rgb565Be | Format::Rgb565Le | Format::Yuyv | Format::Uyvy);
    match first.fault {
        K::BayerPhase => vec![K::RedBlueSwap],
        K::ByteSwap if two_bytes => vec![K::FormatMismatch],
        K::MissingClock | K::LineStartLoss if profile.bus.sync != SyncMode::Gated => vec![K::ShortLine],
        K::ClockGlitch if profile.bus.sync != SyncMode::Gated => vec![K::LongLine],
        _ => Vec::new(),
    }
}

fn measure(
    recording: &Recording,
    profile: &Profile,
    shape: &Shape,
    data: &Data<'_>,
    pclk_hz: Option<u32>,
) -> Measured {
    let mut measured = Measured {
        clocks: recording.clocks,
        frames: shape.frames.len() as u64,
        sync_edges: recording.edges(),
        pclk_hz,
        ..Measured::default()
    };
    for frame in &shape.frames {
        *measured.lines_a_frame.entry(frame.lines.len() as u64).or_default() += 1;
        for pair in frame.lines.windows(2) {
            *measured.blanking_clocks.entry((pair[1].start - pair[0].end()) as u64).or_default() += 1;
        }
    }
    for line in shape.lines() {
        *measured.samples_a_line.entry(line.length as u64).or_default() += 1;
    }
    for pulse in &shape.pulses {
        *measured.vsync_clocks.entry(*pulse as u64).or_default() += 1;
    }
    let _ = profile;
    measured.toggling.clone_from(&data.statistics.toggling);
    measured.agreement.clone_from(&data.statistics.agreement);
    measured.entropy_bits = data.cost;
    measured
}
