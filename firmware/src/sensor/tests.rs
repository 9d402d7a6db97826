//! The transfers on the bus, one by one, against `embedded-hal-mock`; whole sensors are in `host-sim`.

use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use embedded_hal_mock::eh1::delay::{CheckedDelay, NoopDelay, Transaction as Delay};
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Level};
use embedded_hal_mock::eh1::i2c::{Mock, Transaction as Transfer};

use super::bus::Addressing;
use super::mt9v034::MT9V034;
use super::ov2640::{OV2640, PIDH};
use super::ov5640::OV5640;
use super::ov7670::OV7670;
use super::table::{Step, Table, command, update, wait, write};
use super::{Access, MODELS, Sensor, SensorError, power_up};

fn read(address: u8, register: &[u8], data: u8) -> [Transfer; 2] {
    [Transfer::write(address, register.to_vec()), Transfer::read(address, vec![data])]
}

#[test]
fn sccb_reads_in_two_transmissions() {
    let transfers = [read(0x21, &[0x0A], 0x76), read(0x21, &[0x0B], 0x73)].concat();
    let mut i2c = Mock::new(&transfers);
    Sensor::new(i2c.clone(), &OV7670).identify().unwrap();
    i2c.done();
    let transfers = [read(0x3C, &[0x30, 0x0A], 0x56), read(0x3C, &[0x30, 0x0B], 0x40)].concat();
    let mut i2c = Mock::new(&transfers);
    Sensor::new(i2c.clone(), &OV5640).identify().unwrap();
    i2c.done();
}

#[test]
fn registers_of_sixteen_bits_are_read_with_a_repeated_start_and_written_high_byte_first() {
    let mut i2c = Mock::new(&[
        Transfer::write_read(0x48, vec![0x00], vec![0x13, 0x24]),
        Transfer::write(0x48, vec![0x04, 0x02, 0x80]),
    ]);
    let mut sensor = Sensor::new(i2c.clone(), &MT9V034);
    sensor.identify().unwrap();
    sensor.write(0x04, 640).unwrap();
    i2c.done();
}

#[test]
fn a_bank_is_selected_when_it_changes() {
    let transfers = [
        vec![Transfer::write(0x30, vec![0xFF, 1])],
        read(0x30, &[0x0A], 0x26).to_vec(),
        read(0x30, &[0x0B], 0x41).to_vec(),
        vec![Transfer::write(0x30, vec![0xFF, 0]), Transfer::write(0x30, vec![0xDA, 0x08])],
        // After a reset nobody knows.
        vec![Transfer::write(0x30, vec![0xFF, 1]), Transfer::write(0x30, vec![0x12, 0x80])],
        vec![Transfer::write(0x30, vec![0xFF, 1])],
        read(0x30, &[0x0A], 0x26).to_vec(),
    ]
    .concat();
    let mut i2c = Mock::new(&transfers);
    let mut sensor = Sensor::new(i2c.clone(), &OV2640);
    assert_eq!(sensor.read(PIDH), Ok(0x26));
    assert_eq!(sensor.read(PIDH + 1), Ok(0x41));
    sensor.write(0x00DA, 0x08).unwrap();
    sensor.reset(&mut NoopDelay).unwrap();
    assert_eq!(sensor.read(PIDH), Ok(0x26));
    i2c.done();
}

const TABLE: Table =
    Table::new("example", &[wait(7), write(0x0C, 4), update(0x70, 0x80, 0x80), command(0x12, 0x80)]);

#[test]
fn a_table_is_written_and_read_back_step_by_step() {
    let transfers = [
        vec![Transfer::write(0x21, vec![0x0C, 4])],
        read(0x21, &[0x0C], 4).to_vec(),
        read(0x21, &[0x70], 0x3A).to_vec(),
        vec![Transfer::write(0x21, vec![0x70, 0xBA])],
        // A bit outside the mask may differ.
        read(0x21, &[0x70], 0xBB).to_vec(),
        vec![Transfer::write(0x21, vec![0x12, 0x80])],
    ]
    .concat();
    let mut i2c = Mock::new(&transfers);
    let mut delay = CheckedDelay::new(&[Delay::delay_us(7)]);
    Sensor::new(i2c.clone(), &OV7670).run(&TABLE, &mut delay).unwrap();
    i2c.done();
    delay.done();
}

#[test]
fn a_register_that_does_not_hold_says_which_step() {
    let transfers = [vec![Transfer::write(0x21, vec![0x0C, 4])], read(0x21, &[0x0C], 0).to_vec()].concat();
    let mut i2c = Mock::new(&transfers);
    let error = Sensor::new(i2c.clone(), &OV7670).run(&TABLE, &mut NoopDelay).unwrap_err();
    let (sensor, table) = ("ov7670", "example");
    assert_eq!(error, SensorError::NotHeld { sensor, table, step: 1, register: 0x0C, written: 4, found: 0 });
    assert!(error.to_string().contains("step 1 of table `example`"), "{error}");
    i2c.done();
}

#[test]
fn who_does_not_answer_and_who_fails_are_told_apart() {
    let failing = |kind| {
        let mut i2c = Mock::new(&[Transfer::write(0x21, vec![0x0A]).with_error(kind)]);
        let error = Sensor::new(i2c.clone(), &OV7670).identify().unwrap_err();
        i2c.done();
        error
    };
    let (sensor, address, access) = ("ov7670", 0x21, Access::Read { register: 0x0A });
    let nobody = failing(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address));
    assert_eq!(nobody, SensorError::NoAnswer { sensor, address, access });
    assert!(nobody.to_string().contains("pull-ups"));
    let kind = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Data);
    assert_eq!(failing(kind), SensorError::Bus { sensor, address, access, kind });
    let kind = ErrorKind::ArbitrationLoss;
    assert_eq!(failing(kind), SensorError::Bus { sensor, address, access, kind });
}

#[test]
fn another_sensor_is_named_with_what_was_found() {
    for (found, hint) in [(0xFF, "nobody drives SDA"), (0x77, "which sensor the module has")] {
        let mut i2c = Mock::new(&read(0x21, &[0x0A], found));
        let error = Sensor::new(i2c.clone(), &OV7670).identify().unwrap_err();
        assert_eq!(
            error,
            SensorError::WrongIdentity {
                sensor: "ov7670",
                register: 0x0A,
                expected: 0x76,
                found: u16::from(found)
            }
        );
        assert!(error.to_string().contains(hint), "{error}");
        i2c.done();
    }
}

#[test]
fn detection_asks_one_after_the_other() {
    let nobody = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);
    let absent = [
        Transfer::write(0x21, vec![0x0A]).with_error(nobody),
        Transfer::write(0x30, vec![0xFF, 1]).with_error(nobody),
    ];
    let present = [read(0x3C, &[0x30, 0x0A], 0x56), read(0x3C, &[0x30, 0x0B], 0x40)].concat();
    let mut i2c = Mock::new(&[&absent[..], &present[..]].concat());
    let sensor = Sensor::detect(i2c.clone(), &MODELS).unwrap();
    assert_eq!(sensor.model().name, "ov5640");
    i2c.done();
    let mut i2c = Mock::new(&absent);
    let (error, _) = Sensor::detect(i2c.clone(), &MODELS[..2]).unwrap_err();
    assert_eq!(error, SensorError::NotFound { tried: 2 });
    i2c.done();
}

#[test]
fn power_comes_before_the_end_of_reset() {
    let mut power_down = Pin::new(&[Level::set(State::High), Level::set(State::Low)]);
    let mut reset = Pin::new(&[Level::set(State::Low), Level::set(State::High)]);
    let mut delay =
        CheckedDelay::new(&[Delay::delay_us(5_000), Delay::delay_us(5_000), Delay::delay_us(20_000)]);
    power_up(&OV5640, &mut reset, &mut power_down, &mut delay).unwrap();
    power_down.done();
    reset.done();
    delay.done();
}

#[test]
fn a_pin_that_cannot_be_set_is_named() {
    use embedded_hal_mock::eh1::MockError;
    let mut power_down = Pin::new(&[Level::set(State::High)]);
    let mut reset =
        Pin::new(&[Level::set(State::Low).with_error(MockError::Io(std::io::ErrorKind::NotConnected))]);
    let error = power_up(&OV7670, &mut reset, &mut power_down, &mut NoopDelay).unwrap_err();
    assert!(matches!(error, SensorError::Pin { name: "reset", .. }), "{error}");
    power_down.done();
    reset.done();
}

#[test]
fn tables_fit_the_registers_and_names_are_unique() {
    for model in MODELS {
        let (widest_register, widest_value) = match model.addressing {
            Addressing::Byte => (0xFF, 0xFF),
            Addressing::Banked { .. } => (0x1FF, 0xFF),
            Addressing::Word => (0xFFFF, 0xFF),
            Addressing::ByteWithWord => (0xFF, 0xFFFF),
        };
        let own = [&model.reset, &model.base, &model.pattern_off, &model.pattern_on];
        for table in own.into_iter().chain(model.modes.iter().map(|mode| &mode.table)) {
            for step in table.steps {
                let (register, value) = match *step {
                    Step::Wait { .. } => continue,
                    Step::Write { register, value } | Step::Command { register, value } => (register, value),
                    Step::Update { register, mask, value } => {
                        assert_eq!(value & !mask, 0, "{} {}: {step:?}", model.name, table.name);
                        (register, mask)
                    }
                };
                assert!(register <= widest_register && value <= widest_value, "{}: {step:?}", model.name);
            }
        }
        for (index, mode) in model.modes.iter().enumerate() {
            assert!(core::ptr::eq(model.mode(mode.name).unwrap(), mode), "{} twice", mode.name);
            assert!(index == 0 || mode.pixel_clock_hz(model.input_hz) > 0);
        }
        for other in MODELS.iter().filter(|other| !core::ptr::eq(**other, model)) {
            assert_ne!(model.address, other.address, "detection needs different addresses");
        }
    }
}
