use image::{RgbImage, imageops};

use super::build::places;
use super::page::{Page, Rival};
use super::take::{Taken, take};
use super::text::grouped;
use super::{ReportError, Subject};
use crate::diagnosis::{FaultKind, Finding, fix};
use crate::guess::sheet::picture_of;
use crate::picture;
use crate::profile::Profile;

/// Findings and guesses that are shown as pictures, each.
const MOST: usize = 5;
/// Largest size of a rival's picture.
const CELL: (u32, u32) = (480, 360);

/// Pictures of what else the trace may be: as it was given, as each finding would have it, as look-alikes of the first finding would, and as
/// the bus alone suggests. `which` is the frame that is shown, of those received by the profile.
pub(super) fn add_rivals(
    page: &mut Page,
    subject: &Subject<'_>,
    frames: &[Taken],
    which: usize,
) -> Result<(), ReportError> {
    let profile = subject.source.profile();
    let given = frame_of(frames, which).map(|bytes| picture::decode(bytes, profile).picture);
    let mut seen: Vec<RgbImage> = Vec::new();
    if let Some(given) = &given {
        let name = format!("as {} reads it", profile.name);
        let about = if subject.guess_is_profile { "guessed from the trace" } else { "the profile as given" };
        push(
            page,
            &mut seen,
            given,
            Rival { name, about: about.to_owned(), by: "given", ..Rival::default() },
        );
    }
    if let Some(received) = subject.received {
        add_received(page, &mut seen, received, profile, frames);
    }
    for finding in subject.diagnosis.findings.iter().take(MOST) {
        let Some(mended) = mended(subject, frames, which, finding)? else { continue };
        let rival = Rival {
            name: format!("if it is {}, mended", finding.fault),
            about: finding.remedy.text.clone(),
            confidence: Some(finding.confidence),
            by: "finding",
            setting: finding.remedy.profile.clone(),
            ..Rival::default()
        };
        push(page, &mut seen, &mended, rival);
    }
    if let (Some(given), true) = (&given, subject.diagnosis.ambiguous_with.contains(&FaultKind::RedBlueSwap))
    {
        let mut swapped = given.clone();
        swapped.pixels_mut().for_each(|pixel| pixel.0.swap(0, 2));
        let rival = Rival {
            name: "red and blue exchanged".to_owned(),
            about: "looks just like the first finding; only the true colours tell".to_owned(),
            by: "look-alike",
            ..Rival::default()
        };
        push(page, &mut seen, &swapped, rival);
    }
    if let Some(guess) = subject.guess {
        // A guess is seen beside what it ruled out; where a profile was given, only what speaks against it is of interest.
        let ruled_out = if subject.guess_is_profile { MOST } else { 0 };
        let shown = guess.formats.iter().enumerate().take(MOST);
        for (_, format) in shown.filter(|(place, format)| *place < ruled_out || format.confidence > 0) {
            let bits = format.millibits as f64 / 1000.0;
            let rival = Rival {
                name: format.to_string(),
                about: format!("guessed from the bus alone: {bits:.2} bits a sample"),
                confidence: Some(f64::from(format.confidence) / 1000.0),
                by: "guess",
                setting: Some(format!("frame.format = \"{}\"", format.frame.format.name())),
                ..Rival::default()
            };
            push(page, &mut seen, &picture_of(guess, format), rival);
        }
    }
    Ok(())
}

/// What the device got, and where it differs from the frame of the trace that it is most like.
fn add_received(
    page: &mut Page,
    seen: &mut Vec<RgbImage>,
    received: &[u8],
    profile: &Profile,
    frames: &[Taken],
) {
    let device = decoded(received, profile);
    let rival = Rival {
        name: "what the device got".to_owned(),
        about: "the frame of --received".to_owned(),
        by: "received",
        ..Rival::default()
    };
    push(page, seen, &device, rival);
    let sent = frames.iter().filter_map(|frame| Some((frame, frame.bytes.as_deref()?)));
    let alike = |bytes: &[u8]| bytes.iter().zip(received).filter(|(sent, got)| sent == got).count();
    let Some((frame, sent)) = sent.max_by_key(|(_, bytes)| alike(bytes)) else { return };
    let (mut marked, mut differ) = (decoded(sent, profile), 0u64);
    for (pixel, got) in marked.pixels_mut().zip(device.pixels()) {
        let same = pixel == got;
        let gray = (u32::from(pixel.0[0]) + 2 * u32::from(pixel.0[1]) + u32::from(pixel.0[2])) / 10;
        *pixel = if same { image::Rgb([gray as u8; 3]) } else { image::Rgb([255, 90, 40]) };
        differ += u64::from(!same);
    }
    let all = u64::from(marked.width()) * u64::from(marked.height());
    let rival = Rival {
        name: format!("where it differs from frame {} of the trace", frame.verdict.sequence),
        about: format!("{} of {} pixels", grouped(differ), grouped(all)),
        by: "received",
        ..Rival::default()
    };
    push(page, seen, &marked, rival);
}

/// The bytes of a frame, or of the first one that has any.
pub(super) fn frame_of(frames: &[Taken], which: usize) -> Option<&[u8]> {
    let wanted = frames.get(which).and_then(|frame| frame.bytes.as_deref());
    wanted.or_else(|| frames.iter().find_map(|frame| frame.bytes.as_deref()))
}

/// The frame as it would be without this fault, as far as a setting or a change of samples mends it.
fn mended(
    subject: &Subject<'_>,
    frames: &[Taken],
    which: usize,
    finding: &Finding,
) -> Result<Option<RgbImage>, ReportError> {
    let Some(fix) = fix(finding, subject.source.profile()) else { return Ok(None) };
    // With other levels the frames are others; with another edge the trace would have to be read anew.
    let again = if fix.profile.bus == subject.source.profile().bus {
        None
    } else {
        Some(take(subject.source, &fix.profile, subject.bus, &places(subject.diagnosis), None)?.0)
    };
    let Some(bytes) = frame_of(again.as_deref().unwrap_or(frames), which) else { return Ok(None) };
    let mended = fix.samples.map(|samples| samples.apply(bytes, &fix.profile));
    Ok(Some(decoded(mended.as_deref().unwrap_or(bytes), &fix.profile)))
}

fn decoded(bytes: &[u8], profile: &Profile) -> RgbImage {
    picture::decode(bytes, profile).picture
}

/// Adds a rival unless its picture is there already: then the reading that was there gains a name.
fn push(page: &mut Page, seen: &mut Vec<RgbImage>, picture: &RgbImage, mut rival: Rival) {
    if let Some(known) = seen.iter().position(|known| known == picture) {
        if let Some(twin) = page.rivals.get_mut(known) {
            let sure = rival.confidence.map(|sure| format!(" ({:.0} %)", 100.0 * sure)).unwrap_or_default();
            twin.about.push_str(&format!("; the same picture: {}{sure}", rival.name));
        }
        return;
    }
    seen.push(picture.clone());
    rival.picture = page.add(&small(picture));
    page.rivals.push(rival);
}

/// The picture as large as fits a cell, never larger than it is.
fn small(picture: &RgbImage) -> RgbImage {
    let (width, height) = picture.dimensions();
    if width <= CELL.0 && height <= CELL.1 {
        return picture.clone();
    }
    let scale = (f64::from(CELL.0) / f64::from(width)).min(f64::from(CELL.1) / f64::from(height));
    let side = |length: u32| ((f64::from(length) * scale).round() as u32).max(1);
    imageops::thumbnail(picture, side(width), side(height))
}
