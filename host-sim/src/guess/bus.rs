//! All of it: from a trace that can be played to a profile.

use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;
use firmware::camif::pins::Edge;
use firmware::trace::StretchSink;

use super::format::{self, FormatGuess, ambiguous};
use super::layout::Line;
use super::models::Samples;
use super::survey::Survey;
use super::sync::{self, SyncGuess};
use super::windows::Windows;
use crate::profile::{Bus, Frame, Level, Profile, SyncMode, Timing};
use crate::trace::polarity::Enough;

/// Samples of a frame that are looked at: lines beyond it are left out.
const MOST_SAMPLES: u64 = 1 << 24;
/// The pixel clock of a trace that does not say.
const USUAL_CLOCK: u32 = 24_000_000;

/// What is known of a trace without guessing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Known {
    /// Wires of the data bus: 8, 10, 12 or 14.
    pub bits: u8,
    /// The pixel clock, if the trace says or shows it.
    pub pclk_hz: Option<u32>,
    /// The edge of the clock at which the other wires are still, if the trace shows it.
    pub edge: Option<Edge>,
}

/// What a trace turned out to be.
#[derive(Clone, Debug)]
pub struct BusGuess {
    /// The most likely profile.
    pub profile: Profile,
    /// The readings of the sync wires, the most likely first; never empty.
    pub readings: Vec<SyncGuess>,
    /// The pixel formats, the most likely first; never empty.
    pub formats: Vec<FormatGuess>,
    /// What can't be told, in words.
    pub doubts: Vec<String>,
    /// The samples of a frame, line after line, as the first reading has it.
    pub samples: Vec<u16>,
}

/// Why nothing can be guessed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NothingFits {
    /// No reading of the sync wires makes a whole frame.
    #[error(
        "no whole frame shows in {clocks} pixel clocks, however the sync wires are read ({edges} changes of theirs, {codes} \
         sync codes in the data); capture two frames or more, from before a VSYNC on, and check the wires with --map"
    )]
    NoFrame {
        /// Pixel clocks looked at.
        clocks: u64,
        /// Changes of the sync wires.
        edges: usize,
        /// Codes like those of embedded sync.
        codes: usize,
    },
    /// No format fits the bus and the line.
    #[error(
        "a frame of {lines} lines of {clocks} samples of {bits} bits fits no pixel format; write a profile for it (docs/profiles.md)"
    )]
    NoFormat {
        /// Lines of the frame.
        lines: u64,
        /// Samples a line.
        clocks: u64,
        /// Wires of the bus.
        bits: u8,
    },
}

/// Guesses what a trace is. `play` plays it from its beginning into a sink until the sink has enough, and is called twice.
///
/// # Errors
/// [`NothingFits`] inside if the trace shows no frame, and outside whatever `play` has.
pub fn guess<E>(
    known: Known,
    mut play: impl FnMut(&mut dyn StretchSink<Error = Enough>) -> Result<(), E>,
) -> Result<Result<BusGuess, NothingFits>, E> {
    let mut survey = Survey::default();
    play(&mut survey)?;
    let readings = sync::guess(&survey);
    let Some(best) = readings.first() else {
        let (clocks, edges) = (survey.clocks, survey.runs.len().saturating_sub(1));
        return Ok(Err(NothingFits::NoFrame { clocks, edges, codes: survey.codes.len() }));
    };
    let room = (MOST_SAMPLES / best.line_clocks.max(1)).max(2) as usize;
    // Broken lines would shear the picture.
    let lines: Vec<Line> =
        best.frame.iter().copied().filter(|line| line.clocks == best.line_clocks).take(room).collect();
    let mut windows = Windows::new(&lines);
    play(&mut windows)?;
    let samples = windows.samples;
    let (line, bits) = (best.line_clocks as usize, u32::from(known.bits));
    let formats = format::guess(Samples { values: &samples, line, bits });
    let Some(first) = formats.first() else {
        return Ok(Err(NothingFits::NoFormat {
            lines: best.lines,
            clocks: best.line_clocks,
            bits: known.bits,
        }));
    };
    let frame = Frame { height: u32::try_from(best.lines).unwrap_or(u32::MAX), ..first.frame };
    let profile = profile(known, best, frame);
    let doubts = doubts(known, &readings, &formats);
    Ok(Ok(BusGuess { profile, readings, formats, doubts, samples }))
}

fn profile(known: Known, sync: &SyncGuess, frame: Frame) -> Profile {
    let level = |high| if high { Level::High } else { Level::Low };
    let clocks = |value: u64| u32::try_from(value).unwrap_or(u32::MAX);
    let reading = sync.reading;
    let line = u64::from(frame.width * frame.samples_per_pixel());
    let (hblank, vblank) = match reading.mode {
        SyncMode::Marker => (0, 0),
        SyncMode::Gated => (sync.hblank, sync.vblank),
        // Both hold the codes.
        SyncMode::Embedded => {
            let hblank = sync.hblank.max(8);
            (hblank, sync.vblank.max(line + 2 * hblank))
        }
    };
    let porches = reading.mode == SyncMode::Gated;
    Profile {
        name: "guessed".to_owned(),
        about: "guessed from a trace".to_owned(),
        bus: Bus {
            bits: u32::from(known.bits),
            clock_edge: known.edge.unwrap_or(Edge::Rising),
            sync: reading.mode,
            hsync_blank: level(reading.hsync_high),
            vsync_blank: level(reading.vsync_high),
        },
        frame,
        timing: Timing {
            pclk_hz: known.pclk_hz.unwrap_or(USUAL_CLOCK),
            hblank: clocks(hblank),
            vblank: clocks(vblank),
            vfront: if porches { clocks(sync.vfront) } else { 0 },
            vback: if porches { clocks(sync.vback) } else { 0 },
        },
    }
}

/// What can't be told from the trace, in words.
fn doubts(known: Known, readings: &[SyncGuess], formats: &[FormatGuess]) -> Vec<String> {
    let mut doubts = Vec::new();
    if known.pclk_hz.is_none() {
        doubts.push(format!("the pixel clock is not in the trace: {USUAL_CLOCK} Hz is assumed"));
    }
    if known.edge.is_none() {
        doubts.push("the clock's edge is not in the trace: the rising one is assumed".to_owned());
    }
    if let [first, second, ..] = readings
        && second.confidence * 3 >= first.confidence
    {
        doubts.push(format!("sync: `{}` can't be told from `{}`", first.reading, second.reading));
    }
    let Some(first) = formats.first() else { return doubts };
    let alike: Vec<_> = ambiguous(formats).map(ToString::to_string).collect();
    if !alike.is_empty() {
        doubts.push(format!("format: `{first}` can't be told from `{}`", alike.join("`, `")));
    }
    match first.frame.format {
        Format::Raw8 | Format::Raw10 | Format::Raw12 => {
            let swapped = match first.frame.bayer {
                BayerOrder::Rggb | BayerOrder::Bggr => "rggb and bggr",
                BayerOrder::Grbg | BayerOrder::Gbrg => "grbg and gbrg",
            };
            doubts.push(format!(
                "{swapped} differ by red and blue exchanged, which no trace shows: look at the colours"
            ));
        }
        Format::Gray8 => doubts.push("a mosaic of a scene without colour looks like gray8".to_owned()),
        Format::Rgb888 | Format::Rgb565Be | Format::Rgb565Le => doubts.push(
            "red and blue may stand exchanged (BGR), which no trace shows: look at the colours".to_owned(),
        ),
        Format::Yuyv | Format::Uyvy => doubts.push(
            "Cb and Cr may stand exchanged (YVYU, VYUY), which no trace shows: look at the colours"
                .to_owned(),
        ),
    }
    doubts
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use firmware::camif::pins::{Samples as Pins, Sync};

    use super::*;
    use crate::profile::built_ins;
    use crate::scene::{Scene, Still};
    use crate::sensor::Sensor;

    fn guess_of(profile: &Profile, scene: &Scene, frames: u64) -> BusGuess {
        let mut sensor = Sensor::new(profile.clone()).unwrap();
        let known = Known { bits: profile.bus.bits as u8, pclk_hz: Some(profile.timing.pclk_hz), edge: None };
        let play = |mut sink: &mut dyn StretchSink<Error = Enough>| {
            let _ = sensor.play(frames, scene, &mut sink);
            // The sink may have stopped it in the middle of a frame.
            sensor = Sensor::new(profile.clone()).unwrap();
            Ok::<_, ()>(())
        };
        guess(known, play).unwrap().unwrap()
    }

    fn scenes() -> Vec<Scene> {
        let photograph = |name: &str| {
            let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/photographs/colour/");
            Scene::Still(Still::open(Path::new(&format!("{folder}{name}.jpg"))).unwrap())
        };
        let drawn = ["demo", "bars", "gradient", "moving"].map(|name| Scene::named(name, 1).unwrap());
        drawn.into_iter().chain(["astronaut", "chelsea", "coffee", "rocket"].map(photograph)).collect()
    }

    /// Red and blue exchanged is what no trace shows.
    fn as_far_as_can_be_told(frame: Frame) -> (Format, u32, u32, Option<bool>) {
        let diagonal = matches!(frame.bayer, BayerOrder::Rggb | BayerOrder::Bggr);
        (frame.format, frame.width, frame.height, frame.is_bayer().then_some(diagonal))
    }

    #[test]
    fn every_built_in_profile_is_guessed_from_scenes_and_photographs() {
        for profile in built_ins() {
            for scene in scenes() {
                let frames = if scene.is_still() { 2 } else { 1 };
                let guess = guess_of(&profile, &scene, frames);
                let place = format!("{} {}", profile.name, scene.name());
                let (found, bus) = (&guess.profile, profile.bus);
                assert_eq!(
                    as_far_as_can_be_told(found.frame),
                    as_far_as_can_be_told(profile.frame),
                    "{place}"
                );
                assert_eq!(found.timing, profile.timing, "{place}");
                assert_eq!(found.bus, Bus { clock_edge: Edge::Rising, ..bus }, "{place}");
                assert!(guess.readings[0].confidence > 850, "{place}");
                found.check().unwrap();
            }
        }
    }

    #[test]
    fn what_is_truly_ambiguous_is_said_to_be() {
        // In black and white both bytes of RGB565 are equal; noise is alike in any format.
        for (profile, scene, other) in [
            ("ov7670-vga-rgb565", "checker", Format::Rgb565Le),
            ("ov7670-vga-rgb565", "noise", Format::Yuyv),
            ("ov7670-qvga-yuv422", "noise", Format::Uyvy),
            ("vga-gray8", "noise", Format::Raw8),
        ] {
            let profile = Profile::built_in(profile).unwrap();
            let guess = guess_of(&profile, &Scene::named(scene, 1).unwrap(), 1);
            let alike: Vec<Format> = std::iter::once(&guess.formats[0])
                .chain(ambiguous(&guess.formats))
                .map(|guess| guess.frame.format)
                .collect();
            assert!(alike.contains(&profile.frame.format), "{}: {alike:?}", profile.name);
            assert!(alike.contains(&other), "{}: {alike:?}", profile.name);
            assert!(guess.doubts.iter().any(|doubt| doubt.contains("can't be told")), "{:?}", guess.doubts);
        }
        // A mosaic of a scene without colour is gray8, byte by byte.
        let raw = guess_of(&Profile::built_in("vga-raw8").unwrap(), &Scene::Checker, 1);
        assert!(raw.doubts.iter().any(|doubt| doubt.contains("without colour")), "{:?}", raw.doubts);
    }

    #[test]
    fn red_and_blue_of_a_mosaic_are_a_doubt() {
        let profile = Profile::built_in("vga-raw10").unwrap();
        let guess = guess_of(&profile, &scenes()[4], 1);
        let alike: Vec<_> = ambiguous(&guess.formats).map(|guess| guess.frame.bayer).collect();
        assert_eq!((guess.formats[0].frame.bayer, alike), (BayerOrder::Rggb, vec![BayerOrder::Bggr]));
    }

    #[test]
    fn a_trace_without_a_frame_says_what_is_missing() {
        let known = Known { bits: 8, pclk_hz: None, edge: None };
        let play = |sink: &mut dyn StretchSink<Error = Enough>| {
            let _ = sink.stretch(Sync::default(), Pins::Bytes(&[1, 2, 3]));
            Ok::<_, ()>(())
        };
        let error = guess(known, play).unwrap().unwrap_err().to_string();
        assert!(error.contains("3 pixel clocks") && error.contains("two frames or more"), "{error}");
    }
}
