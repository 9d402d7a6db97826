//! The driver brings the virtual sensors up, and what then comes through block and driver is what was configured.

use std::cell::RefCell;

use embedded_hal::i2c::I2c;
use firmware::camif::Bus;
use firmware::driver::Config;
use firmware::driver::config::{Damaged, Policy};
use firmware::driver::verdict::Outcome;
use firmware::sensor::table::{Table, write};
use firmware::sensor::{MODELS, Mode, Model, Sensor, SensorError, ov2640, ov5640, ov7670};
use proptest::prelude::*;

use super::{Mounting, Readout, Silent, VirtualBus, VirtualSensor};
use crate::picture;
use crate::profile::{Level, Profile};
use crate::receiver::{capture_config, receive};
use crate::scene::Scene;

/// Waits no time.
struct NoDelay;

impl embedded_hal::delay::DelayNs for NoDelay {
    fn delay_ns(&mut self, _: u32) {}
}

/// A sensor mounted for this mode, 24 MHz.
fn mounted(model: &Model, mode: &Mode) -> RefCell<VirtualSensor> {
    let monochrome = mode.name.ends_with("gray8");
    let mounting = Mounting { input_hz: 24_000_000, wires: mode.bus_width.bits(), monochrome };
    RefCell::new(VirtualSensor::new(model.name, mounting).unwrap())
}

fn brought_up(model: &'static Model, mode: &Mode) -> RefCell<VirtualSensor> {
    let chip = mounted(model, mode);
    Sensor::new(VirtualBus(&chip), model).start(mode, &mut NoDelay).unwrap();
    chip
}

fn all_modes() -> impl Iterator<Item = (&'static Model, &'static Mode)> {
    MODELS.into_iter().flat_map(|model| model.modes.iter().map(move |mode| (model, mode)))
}

/// Captures frames of a scene with this configuration: what each was judged, and its bytes.
fn captured(readout: &Readout, config: &Config, frames: u64) -> Vec<(Outcome, Vec<u8>)> {
    let mut received = Vec::new();
    let mut on_frame = |frame: crate::receiver::Received<'_>| {
        received.push((frame.verdict.outcome, frame.bytes.unwrap_or_default().to_vec()));
    };
    let config = Config { policy: Policy::InOrder, damaged: Damaged::Deliver, ..*config };
    receive(&config, Bus::IDEAL, &mut on_frame, |sink| readout.play(frames, &Scene::Bars, sink))
        .unwrap()
        .0
        .unwrap();
    received
}

#[test]
fn the_document_names_every_sensor_and_mode() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/sensors.md");
    let document = std::fs::read_to_string(path).unwrap();
    for model in MODELS {
        let modes: Vec<_> = model.modes.iter().map(|mode| format!("`{}`", mode.name)).collect();
        let megahertz = |hertz: u32| hertz / 1_000_000;
        let (least, most) = model.input_range_hz;
        let row = format!(
            "| `{}` | {:#04X} | {} | {} MHz, {} to {} |",
            model.name,
            model.address,
            modes.join(" "),
            megahertz(model.input_hz),
            megahertz(least),
            megahertz(most)
        )
        .replace("0X", "0x");
        assert!(document.contains(&row), "docs/sensors.md lacks:\n{row}");
    }
}

#[test]
fn the_page_on_boards_tells_of_every_error_and_cause() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/board.md");
    let page = std::fs::read_to_string(path).unwrap();
    let sources = ["../firmware/src/sensor/error.rs", "../firmware/src/driver/deadline.rs"];
    let enums = ["pub enum SensorError {", "pub enum Cause {"];
    for (source, start) in sources.into_iter().zip(enums) {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(source);
        let text = std::fs::read_to_string(path).unwrap();
        let (_, body) = text.split_once(start).unwrap();
        let (body, _) = body.split_once("\n}").unwrap();
        // Variants stand four spaces in.
        let is_variant = |line: &&str| line.starts_with("    ") && line.as_bytes()[4].is_ascii_uppercase();
        let variants: Vec<_> = body.lines().filter(|line| !line.is_empty()).filter(is_variant).collect();
        assert!(variants.len() > 5, "{source}");
        for line in variants {
            let name = line.trim().split(|letter: char| !letter.is_ascii_alphanumeric()).next().unwrap();
            assert!(page.contains(&format!("`{name}`")), "docs/board.md does not tell of {name}");
        }
    }
}

#[test]
fn every_mode_comes_up_as_it_says() {
    for (model, mode) in all_modes() {
        let what = format!("{} {}", model.name, mode.name);
        let readout = brought_up(model, mode).borrow().readout().unwrap();
        let profile = readout.profile();
        assert_eq!(readout.notes, [""; 0], "{what}");
        assert_eq!((profile.frame.width, profile.frame.height), (mode.width, mode.height), "{what}");
        assert_eq!(profile.frame.format, mode.format, "{what}");
        if profile.frame.is_bayer() && profile.frame.width == 640 {
            assert_eq!(profile.frame.bayer, mode.bayer, "{what}");
        }
        let promised = mode.capture(24_000_000);
        let needed = capture_config(&profile);
        assert_eq!(
            promised,
            Config { policy: promised.policy, damaged: promised.damaged, ..needed },
            "{what}"
        );
    }
}

#[test]
fn frames_of_every_mode_arrive_whole() {
    for (model, mode) in all_modes() {
        let what = format!("{} {}", model.name, mode.name);
        let readout = brought_up(model, mode).borrow().readout().unwrap();
        let sent = readout.frame_bytes(&Scene::Bars, 0);
        let received = captured(&readout, &mode.capture(24_000_000), 2);
        assert_eq!(received.len(), 2, "{what}");
        for (outcome, bytes) in received {
            assert!(outcome.is_good(), "{what}: {outcome}");
            assert!(bytes == sent, "{what}: other bytes arrived");
        }
    }
}

#[test]
fn what_arrives_is_the_scene() {
    // The oracle knows nothing of registers: the scene in the mode's size, encoded by its format.
    for (model, mode) in all_modes().filter(|(model, _)| model.name.starts_with("ov")) {
        let readout = brought_up(model, mode).borrow().readout().unwrap();
        if model.name == "ov5640" && mode.name == "vga-raw8" {
            assert_eq!(readout.view.origin, (960, 720), "the middle of 2,560 × 1,920, pixel by pixel");
            continue;
        }
        let profile = readout.profile();
        let scene = Scene::Bars.render(0, mode.width, mode.height);
        let expected = picture::encode(&scene, &profile).unwrap();
        assert!(readout.frame_bytes(&Scene::Bars, 0) == expected, "{} {}", model.name, mode.name);
    }
}

#[test]
fn the_ov7670_has_the_timing_of_its_data_sheet() {
    for (mode, profile) in [("vga-rgb565", "ov7670-vga-rgb565"), ("qvga-yuv422", "ov7670-qvga-yuv422")] {
        let chip = brought_up(&ov7670::OV7670, ov7670::OV7670.mode(mode).unwrap());
        let readout = chip.borrow().readout().unwrap().profile();
        let expected = Profile::built_in(profile).unwrap();
        let compared = Profile { name: expected.name.clone(), about: expected.about.clone(), ..readout };
        assert_eq!(compared, expected);
    }
}

#[test]
fn frame_rates_are_those_of_the_data_sheets() {
    let rates = [("ov7670", 30.0), ("ov2640", 15.0), ("ov5640", 15.0), ("mt9v034", 62.3)];
    for (model, mode) in all_modes() {
        let rate = brought_up(model, mode).borrow().readout().unwrap().profile().frames_per_second();
        let (_, expected) = rates.iter().find(|(name, _)| *name == model.name).unwrap();
        // Half the rows take less time, but for vertical blanking.
        let expected =
            if mode.name.starts_with("qvga") && model.name == "mt9v034" { 114.7 } else { *expected };
        assert!((rate / expected - 1.0).abs() < 0.005, "{} {}: {rate}", model.name, mode.name);
    }
}

/// A wrong register, and what comes of it at the receiver that expects `vga-rgb565`.
#[test]
fn a_wrong_register_gives_a_wrong_picture() {
    let mode = ov7670::OV7670.mode("vga-rgb565").unwrap();
    let good = brought_up(&ov7670::OV7670, mode).borrow().readout().unwrap();
    let right = good.frame_bytes(&Scene::Bars, 0);
    let outcomes = |register, value| {
        let chip = brought_up(&ov7670::OV7670, mode);
        chip.borrow_mut().poke(register, value);
        let readout = chip.borrow().readout().unwrap();
        assert_ne!(readout, good, "register {register:#04x} makes a difference");
        captured(&readout, &mode.capture(24_000_000), 3)
    };
    // Same length, other bytes: the picture is wrong, and no verdict can tell.
    for (register, value) in [
        (ov7670::COM15, 0xF0),  // RGB555
        (ov7670::COM7, 0x00),   // YUV
        (ov7670::COM3, 0x40),   // bytes swapped
        (ov7670::RGB444, 0x02), // RGB444
        (ov7670::MVFP, 0x20),   // mirrored
        (ov7670::MVFP, 0x10),   // upside down
        (ov7670::TSLB, 0x24),   // negative
        (ov7670::SCALING_XSC, 0xBA),
    ] {
        let received = outcomes(register, value);
        assert_eq!(received.len(), 3, "{register:#04x}");
        assert!(
            received.iter().all(|(outcome, bytes)| outcome.is_good() && *bytes != right),
            "{register:#04x}"
        );
    }
    // Fewer or more bytes: the driver's verdict tells.
    for (register, value, expected) in [
        (ov7670::HSTOP, 0x00, "Short"),
        (ov7670::HSTOP, 0x02, "Long"),
        (ov7670::VSTOP, 0x70, "Short"),
        (ov7670::COM7, 0x14, "Short"),  // QVGA
        (ov7670::COM14, 0x19, "Short"), // PCLK halved
    ] {
        let received = outcomes(register, value);
        assert!(!received.is_empty(), "{register:#04x}");
        for (outcome, _) in received {
            assert!(format!("{outcome:?}").starts_with(expected), "{register:#04x}: {outcome:?}");
        }
    }
    // The wrong polarity: nothing good comes.
    for (register, value) in [(ov7670::COM10, 0x02), (ov7670::COM10, 0x08)] {
        let received = outcomes(register, value);
        assert!(received.iter().all(|(outcome, _)| !outcome.is_good()), "{register:#04x} {value:#04x}");
    }
}

#[test]
fn the_window_moves_the_picture() {
    let mode = ov7670::OV7670.mode("vga-rgb565").unwrap();
    let chip = brought_up(&ov7670::OV7670, mode);
    let before = chip.borrow().readout().unwrap();
    // Eight pixels to the right and four lines down.
    for (register, by) in [(ov7670::HSTART, 1), (ov7670::HSTOP, 1), (ov7670::VSTRT, 1), (ov7670::VSTOP, 1)] {
        let value = chip.borrow().registers().get(register);
        chip.borrow_mut().poke(register, value + by);
    }
    let after = chip.borrow().readout().unwrap();
    let (whole, moved) = (before.picture(&Scene::Bars, 0), after.picture(&Scene::Bars, 0));
    assert_eq!(moved.get_pixel(100, 50), whole.get_pixel(108, 54));
    assert_eq!(moved.get_pixel(639, 50).0, [0; 3], "beside the array");
    assert_eq!(after.timing.vback, before.timing.vback + 4 * 1_568);
}

#[test]
fn clock_and_polarity_registers_reach_the_pins() {
    let mode = ov7670::OV7670.mode("vga-rgb565").unwrap();
    let with = |register, value| {
        let chip = brought_up(&ov7670::OV7670, mode);
        chip.borrow_mut().poke(register, value);
        chip.borrow().readout().unwrap()
    };
    for (value, pclk_hz) in
        [(0x80, 24_000_000), (0x00, 12_000_000), (0x81, 12_000_000), (0x83, 6_000_000), (0x40, 24_000_000)]
    {
        assert_eq!(with(ov7670::CLKRC, value).timing.pclk_hz, pclk_hz, "CLKRC {value:#04x}");
    }
    assert_eq!(with(ov7670::DBLV, 0x4A).timing.pclk_hz, 96_000_000);
    assert_eq!(with(ov7670::COM10, 0x02).bus.vsync_blank, Level::Low);
    assert_eq!(with(ov7670::COM10, 0x08).bus.hsync_blank, Level::High);
    let falling = with(ov7670::COM10, 0x10);
    assert_ne!(falling.bus.clock_edge, mode.edge);
    let dummy = with(ov7670::EXHCL, 16);
    assert_eq!(dummy.timing.hblank, 288 + 32, "16 pixels more of blanking");
}

#[test]
fn test_patterns_are_the_sensors_own() {
    for (model, mode) in all_modes().filter(|(_, mode)| mode.name.starts_with("vga")) {
        let chip = brought_up(model, mode);
        let seen = chip.borrow().readout().unwrap().frame_bytes(&Scene::Checker, 0);
        let mut sensor = Sensor::new(VirtualBus(&chip), model);
        sensor.test_pattern(true, &mut NoDelay).unwrap();
        let pattern = chip.borrow().readout().unwrap();
        assert!(pattern.frame_bytes(&Scene::Checker, 0) != seen, "{}", model.name);
        assert!(
            pattern.frame_bytes(&Scene::Bars, 0) == pattern.frame_bytes(&Scene::Checker, 0),
            "{}: whatever the lens sees",
            model.name
        );
        sensor.test_pattern(false, &mut NoDelay).unwrap();
        assert!(chip.borrow().readout().unwrap().frame_bytes(&Scene::Checker, 0) == seen, "{}", model.name);
    }
}

#[test]
fn after_reset_alone_no_sensor_sends_the_mode() {
    for (model, mode) in all_modes() {
        let chip = mounted(model, mode);
        Sensor::new(VirtualBus(&chip), model).reset(&mut NoDelay).unwrap();
        let readout = chip.borrow().readout();
        let same = readout.is_ok_and(|readout| {
            let expected = mode.capture(24_000_000);
            let config = capture_config(&readout.profile());
            readout.profile().frame.format == mode.format
                && (config.line_clocks, config.lines) == (expected.line_clocks, expected.lines)
        });
        assert!(!same, "{} {}: the tables would be for nothing", model.name, mode.name);
    }
}

#[test]
fn a_sensor_without_clock_does_not_answer() {
    let mounting = Mounting { input_hz: 0, wires: 8, monochrome: false };
    let chip = RefCell::new(VirtualSensor::new("ov7670", mounting).unwrap());
    let error = Sensor::new(VirtualBus(&chip), &ov7670::OV7670).identify().unwrap_err();
    assert!(matches!(error, SensorError::NoAnswer { sensor: "ov7670", address: 0x21, .. }), "{error}");
    assert_eq!(chip.borrow().readout(), Err(Silent::NoClock));
}

#[test]
fn the_sensor_that_is_there_is_found() {
    for model in MODELS {
        let chip = mounted(model, &model.modes[0]);
        let found = Sensor::detect(VirtualBus(&chip), &MODELS).unwrap();
        assert_eq!(found.model().name, model.name);
    }
}

#[test]
fn another_sensor_and_a_register_that_does_not_hold_are_told() {
    static IMPOSSIBLE: Table =
        Table::new("impossible", &[write(ov7670::COM3, 0x04), write(ov7670::PID, 0x77)]);
    let chip = mounted(&ov7670::OV7670, &ov7670::OV7670.modes[0]);
    let mut sensor = Sensor::new(VirtualBus(&chip), &ov7670::OV7670);
    assert_eq!(
        sensor.run(&IMPOSSIBLE, &mut NoDelay),
        Err(SensorError::NotHeld {
            sensor: "ov7670",
            table: "impossible",
            step: 1,
            register: ov7670::PID,
            written: 0x77,
            found: 0x76
        })
    );
}

#[test]
fn sccb_knows_no_repeated_start() {
    let chip = mounted(&ov7670::OV7670, &ov7670::OV7670.modes[0]);
    let mut bus = VirtualBus(&chip);
    let mut data = [0];
    assert!(bus.write_read(0x21, &[0x0A], &mut data).is_err());
    bus.write(0x21, &[0x0A]).unwrap();
    bus.read(0x21, &mut data).unwrap();
    assert_eq!(data, [0x76]);
}

#[test]
fn what_cannot_come_says_why() {
    let sleeping = brought_up(&ov7670::OV7670, &ov7670::OV7670.modes[0]);
    sleeping.borrow_mut().poke(0x09, 0x10);
    assert!(matches!(sleeping.borrow().readout(), Err(Silent::Off { .. })));
    let held = brought_up(&ov2640::OV2640, &ov2640::OV2640.modes[0]);
    held.borrow_mut().poke(ov2640::RESET, 0x04);
    assert!(matches!(held.borrow().readout(), Err(Silent::Off { .. })));
    let silent = brought_up(&ov5640::OV5640, &ov5640::OV5640.modes[0]);
    silent.borrow_mut().poke(ov5640::FORMAT_MUX, 0x00);
    assert!(matches!(silent.borrow().readout(), Err(Silent::NoFrame { .. })), "RGB from YUV");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Whatever is written, the readout is a profile that can be played, or says why there is none.
    #[test]
    fn any_registers_make_a_frame_or_a_reason(
        which in 0..18usize,
        pokes in prop::collection::vec((any::<prop::sample::Index>(), any::<u16>()), 1..6),
    ) {
        let (model, mode) = all_modes().nth(which % all_modes().count()).unwrap();
        let chip = brought_up(model, mode);
        // The registers that the tables write are those that have a meaning.
        let registers: Vec<u16> = [&model.base, &mode.table, &model.pattern_on]
            .into_iter()
            .flat_map(|table| table.steps)
            .filter_map(|step| match *step {
                firmware::sensor::table::Step::Write { register, .. }
                | firmware::sensor::table::Step::Update { register, .. } => Some(register),
                _ => None,
            })
            .collect();
        for (index, value) in pokes {
            let register = registers[index.index(registers.len())];
            let value = if model.name == "mt9v034" { value } else { value & 0xFF };
            chip.borrow_mut().poke(register, value);
        }
        if let Ok(readout) = chip.borrow().readout() {
            prop_assert!(readout.player().is_ok());
        }
    }
}
