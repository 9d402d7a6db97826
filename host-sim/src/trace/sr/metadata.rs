//! The INI text of a session.
//!
//! ```text
//! [global]
//! sigrok version=0.5.2
//! [device 1]
//! capturefile=logic-1        where the samples are
//! total probes=11
//! samplerate=192 MHz         a number, and a multiplier of the SI
//! probe1=PCLK                channel 0; only those that were enabled are here
//! unitsize=2                 bytes of a sample
//! ```

use super::error::{MetadataProblem, SrError};

/// Bytes of a sample there can be: channels of the widest analysers, many times over.
const UNIT: usize = 64;

/// A logic channel that was recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Probe {
    /// Bit of a sample.
    pub(super) bit: u32,
    pub(super) name: String,
}

/// What a session says of its device.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Device {
    pub(super) capturefile: String,
    /// Samples a second, if there is a clock.
    pub(super) sample_rate: Option<u64>,
    /// Bytes of a sample.
    pub(super) unit: usize,
    /// The enabled channels, lowest bit first.
    pub(super) probes: Vec<Probe>,
}

/// Reads the text and finds the one device with samples.
pub(super) fn parse(text: &[u8]) -> Result<Device, SrError> {
    let wrong = |line: usize, problem| SrError::Metadata { line, problem };
    let text = std::str::from_utf8(text).map_err(|_| wrong(1, MetadataProblem::NotText))?;
    let mut devices: Vec<(usize, Vec<Line<'_>>)> = Vec::new();
    let mut in_device = false;
    let mut last = 1;
    for (index, line) in text.lines().enumerate() {
        let (line, number) = (line.trim(), index + 1);
        last = number;
        if line.is_empty() || line.starts_with(['#', ';']) {
            continue;
        }
        if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            in_device = name.trim_start().starts_with("device");
            if in_device {
                devices.push((number, Vec::new()));
            }
            continue;
        }
        let (key, value) =
            line.split_once('=').ok_or_else(|| wrong(number, MetadataProblem::Line(shortened(line))))?;
        if let (true, Some((_, lines))) = (in_device, devices.last_mut()) {
            lines.push(Line { number, key: key.trim(), value: value.trim() });
        }
    }
    let mut with_samples =
        devices.into_iter().filter(|(_, lines)| lines.iter().any(|line| line.key == "capturefile"));
    let Some((section, lines)) = with_samples.next() else {
        return Err(wrong(last, MetadataProblem::NoDevice));
    };
    if let more @ 1.. = with_samples.count() {
        return Err(wrong(section, MetadataProblem::SeveralDevices(1 + more)));
    }
    device(section, &lines)
}

struct Line<'a> {
    number: usize,
    key: &'a str,
    value: &'a str,
}

fn device(section: usize, lines: &[Line<'_>]) -> Result<Device, SrError> {
    let wrong = |line: usize, problem| SrError::Metadata { line, problem };
    let mut device = Device::default();
    let mut numbers: Vec<(usize, u32)> = Vec::new();
    let mut total = None;
    for line in lines {
        let misread = |expected| {
            let (key, value) = (shortened(line.key), shortened(line.value));
            wrong(line.number, MetadataProblem::Value { key, value, expected })
        };
        match line.key {
            "capturefile" => line.value.clone_into(&mut device.capturefile),
            "samplerate" => {
                let rate = size(line.value).ok_or_else(|| misread("write for instance 96 MHz"))?;
                device.sample_rate = Some(rate).filter(|&rate| rate > 0);
            }
            "unitsize" => {
                let unit = line.value.parse().ok().filter(|unit| (1..=UNIT).contains(unit));
                device.unit = unit.ok_or_else(|| misread("it is a number of bytes from 1 to 64"))?;
            }
            "total probes" => {
                let probes = line.value.parse().ok().filter(|probes| (1..=8 * UNIT).contains(probes));
                total = Some(probes.ok_or_else(|| misread("it is a number from 1 to 512"))?);
            }
            key => {
                let number = key
                    .strip_prefix("probe")
                    .filter(|digits| digits.starts_with(|c: char| c.is_ascii_digit()));
                let Some(number) = number else { continue };
                let number: u32 = number
                    .parse()
                    .ok()
                    .filter(|&number| number > 0)
                    .ok_or_else(|| misread("probes count from 1"))?;
                if device.probes.iter().any(|probe| probe.bit == number - 1) {
                    return Err(wrong(line.number, MetadataProblem::TwiceProbe(number)));
                }
                device.probes.push(Probe { bit: number - 1, name: line.value.to_owned() });
                numbers.push((line.number, number));
            }
        }
    }
    if device.unit == 0 {
        let probes = total.ok_or_else(|| wrong(section, MetadataProblem::MissingKey("unitsize")))?;
        device.unit = probes.div_ceil(8);
    }
    let unit = device.unit;
    if let Some(&(line, number)) = numbers.iter().find(|(_, number)| *number as usize > 8 * unit) {
        return Err(wrong(line, MetadataProblem::Probe { number, unit }));
    }
    if device.probes.is_empty() {
        return Err(wrong(section, MetadataProblem::MissingKey("probe")));
    }
    device.probes.sort_by_key(|probe| probe.bit);
    Ok(device)
}

/// A size string of sigrok: `192 MHz`, `1.5 MHz`, `200k`, `24000000`.
pub(in super::super) fn size(text: &str) -> Option<u64> {
    let text = text.trim();
    let at = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let (number, unit) = text.split_at(at);
    let unit = unit.trim().to_ascii_lowercase();
    let multiplier = match unit.strip_suffix("hz").unwrap_or(&unit).trim_end() {
        "" => 1,
        "k" => 1_000,
        "m" => 1_000_000,
        "g" => 1_000_000_000,
        _ => return None,
    };
    let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
    if whole.is_empty() || fraction.len() > 18 {
        return None;
    }
    let scale = 10_u128.pow(fraction.len() as u32);
    let fraction: u128 = if fraction.is_empty() { 0 } else { fraction.parse().ok()? };
    let whole: u64 = whole.parse().ok()?;
    let hertz = (u128::from(whole) * scale + fraction) * multiplier / scale;
    u64::try_from(hertz).ok()
}

/// A text for an error message: what can be printed, and not too much of it.
fn shortened(text: &str) -> String {
    text.chars().take(48).flat_map(char::escape_default).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_exactly() {
        for (text, hertz) in [
            ("192 MHz", 192_000_000),
            ("1.5 MHz", 1_500_000),
            ("200k", 200_000),
            ("24000000", 24_000_000),
            ("0.000001 GHz", 1_000),
            ("500 Hz", 500),
            ("12 M", 12_000_000),
        ] {
            assert_eq!(size(text), Some(hertz), "{text}");
        }
        for text in [
            "",
            "MHz",
            "1.2.3",
            "5 THz",
            ".5 k",
            "-1",
            "99999999999999999999",
            "1 MHz x",
            "18446744073709551615 G",
        ] {
            assert_eq!(size(text), None, "{text}");
        }
    }

    #[test]
    fn the_device_with_samples_is_found_and_only_enabled_probes_have_names() {
        let device = parse(
            b"[global]\nsigrok version=0.5.2\n\n[device 1]\ncapturefile=logic-1\ntotal probes=16\nsamplerate=1 MHz\n\
              total analog=0\nprobe3 = PCLK\nprobe1=D=0\nunitsize=2\n",
        )
        .unwrap();
        assert_eq!(
            (device.capturefile.as_str(), device.unit, device.sample_rate),
            ("logic-1", 2, Some(1_000_000))
        );
        let probes: Vec<(u32, &str)> =
            device.probes.iter().map(|probe| (probe.bit, probe.name.as_str())).collect();
        assert_eq!(probes, [(0, "D=0"), (2, "PCLK")]);
        let no_unit = parse(b"[device 1]\ncapturefile=logic-1\ntotal probes=9\nprobe9=a").unwrap();
        assert_eq!((no_unit.unit, no_unit.sample_rate), (2, None));
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        for (text, line, expected) in [
            ("", 1, "no [device …] section"),
            ("[device 1]\nprobe1=a", 2, "no [device …] section"),
            ("capturefile", 1, "neither [section] nor key=value"),
            ("[device 1]\ncapturefile=l\nsamplerate=fast", 3, "samplerate=fast cannot be understood; write"),
            ("[device 1]\ncapturefile=l\nunitsize=0", 3, "1 to 64"),
            ("[device 1]\ncapturefile=l\nunitsize=1\nprobe9=x", 4, "probe9 has no bit"),
            ("[device 1]\ncapturefile=l\nunitsize=1\nprobe0=x", 4, "count from 1"),
            ("[device 1]\ncapturefile=l\nunitsize=1\nprobe1=x\nprobe1=y", 5, "twice"),
            ("[device 1]\ncapturefile=l\nunitsize=1", 1, "no probe"),
            ("[device 1]\ncapturefile=l\nprobe1=x", 1, "no unitsize"),
            ("[device 1]\ncapturefile=l\nunitsize=1\n[device 2]\ncapturefile=m", 1, "2 devices"),
            ("\u{0}", 1, "neither"),
        ] {
            let error = parse(text.as_bytes()).unwrap_err().to_string();
            assert!(
                error.contains(expected) && error.contains(&format!("line {line}:")),
                "{text:?}: {error}"
            );
        }
        assert!(parse(b"\xff").is_err());
    }
}
