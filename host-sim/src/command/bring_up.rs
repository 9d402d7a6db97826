use std::cell::RefCell;

use anyhow::{Context as _, anyhow, bail};
use clap::Args;
use firmware::sensor::{MODELS, Mode, Model, Sensor};

use crate::profile::nearest;
use crate::sensor::{Mounting, Readout, VirtualBus, VirtualSensor};

/// A sensor with registers instead of a profile.
#[derive(Debug, Args)]
pub(super) struct BringUp {
    /// Bring up a virtual sensor through the driver, instead of a profile: ov7670, ov2640, ov5640, mt9v034
    #[arg(long, value_name = "NAME")]
    sensor: Option<String>,
    /// What the sensor is to send, such as vga-rgb565; its first one if it is not said
    #[arg(long, value_name = "NAME", requires = "sensor")]
    mode: Option<String>,
    /// The sensor's input clock, in hertz
    #[arg(long, value_name = "HZ", requires = "sensor")]
    xclk: Option<u32>,
    /// Write a register after bring-up; may be given often. Numbers are decimal, or 0x and hexadecimal
    #[arg(long, value_name = "REGISTER=VALUE", requires = "sensor")]
    set: Vec<String>,
    /// The sensor's own test pattern instead of what it looks at
    #[arg(long, requires = "sensor")]
    test_pattern: bool,
}

/// The virtual sensor takes no time.
struct NoDelay;

impl embedded_hal::delay::DelayNs for NoDelay {
    fn delay_ns(&mut self, _: u32) {}
}

impl BringUp {
    /// What the sensor sends after bring-up; `None` if no sensor was asked for.
    pub(super) fn run(&self) -> anyhow::Result<Option<Readout>> {
        Ok(self.sensor()?.map(|(_, readout)| readout))
    }

    /// The same, and the sensor.
    pub(super) fn sensor(&self) -> anyhow::Result<Option<(VirtualSensor, Readout)>> {
        let Some(name) = &self.sensor else { return Ok(None) };
        let model = model(name)?;
        let mode = match &self.mode {
            Some(name) => mode(model, name)?,
            None => model.modes.first().context("a sensor without modes")?,
        };
        let input_hz = self.xclk.unwrap_or(model.input_hz);
        let (least, most) = model.input_range_hz;
        if !(least..=most).contains(&input_hz) {
            bail!("--xclk {input_hz}: {} takes {least} to {most} Hz", model.name);
        }
        let monochrome = mode.format == algos_nostd::pixel::format::Format::Gray8;
        let mounting = Mounting { input_hz, wires: mode.bus_width.bits(), monochrome };
        let chip = VirtualSensor::new(model.name, mounting).context("a model without a virtual sensor")?;
        let chip = RefCell::new(chip);
        let mut sensor = Sensor::new(VirtualBus(&chip), model);
        sensor.start(mode, &mut NoDelay)?;
        if self.test_pattern {
            sensor.test_pattern(true, &mut NoDelay)?;
        }
        for set in &self.set {
            let (register, value) = parse_set(set)?;
            sensor.write(register, value)?;
        }
        let chip = chip.into_inner();
        let readout = chip.readout().with_context(|| format!("{} {}", model.name, mode.name))?;
        for note in &readout.notes {
            eprintln!("note: {note}");
        }
        let encoding = readout.encoding;
        if encoding.name() != encoding.nearest().name() {
            let (is, nearest) = (encoding.name(), encoding.nearest().name());
            eprintln!(
                "note: the sensor sends {is}, which no profile can say; the trace's profile says {nearest}"
            );
        }
        Ok(Some((chip, readout)))
    }
}

fn model(name: &str) -> anyhow::Result<&'static Model> {
    MODELS.into_iter().find(|model| model.name == name).ok_or_else(|| {
        let names = MODELS.map(|model| model.name);
        let nearest = nearest(name, names).unwrap_or(names[0]);
        anyhow!("no sensor is called `{name}`; did you mean `{nearest}`? There are {}", names.join(", "))
    })
}

fn mode(model: &'static Model, name: &str) -> anyhow::Result<&'static Mode> {
    model.mode(name).ok_or_else(|| {
        let names: Vec<_> = model.modes.iter().map(|mode| mode.name).collect();
        let nearest = nearest(name, names.iter().copied()).unwrap_or_default();
        let known = names.join(", ");
        anyhow!("{} has no mode `{name}`; did you mean `{nearest}`? There are {known}", model.name)
    })
}

fn parse_set(text: &str) -> anyhow::Result<(u16, u16)> {
    let number = |text: &str| match text.trim().strip_prefix("0x") {
        Some(digits) => u16::from_str_radix(digits, 16).ok(),
        None => text.trim().parse().ok(),
    };
    text.split_once('=')
        .and_then(|(register, value)| Some((number(register)?, number(value)?)))
        .with_context(|| format!("--set {text}: write REGISTER=VALUE, as in 0x12=0x04; numbers up to 0xffff"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn registers_are_set_in_both_bases() {
        assert_eq!(parse_set("0x12=0x04").unwrap(), (0x12, 4));
        assert_eq!(parse_set("0x3820 = 65").unwrap(), (0x3820, 65));
        for wrong in ["0x12", "12=", "=4", "0x12=0x10000", "a=1"] {
            assert!(parse_set(wrong).unwrap_err().to_string().contains(wrong));
        }
    }

    #[test]
    fn names_that_are_none_name_the_nearest() {
        assert!(model("ov7760").unwrap_err().to_string().contains("`ov7670`"));
        let error = mode(MODELS[0], "vga-rgb556").unwrap_err().to_string();
        assert!(error.contains("did you mean `vga-rgb565`?"), "{error}");
    }
}
