use std::fmt;

use firmware::camif::pins::Edge;
use serde::Serialize;

use crate::trace::Trace;

/// The pixel clock as it was recovered from an analyser's samples.
#[derive(Debug, Serialize)]
pub(super) struct ClockReport {
    /// The trace's format.
    format: &'static str,
    /// The clock's frequency, as measured.
    pclk_hz: Option<f64>,
    /// Samples a second of the analyser, if known.
    sample_rate: Option<f64>,
    samples_per_clock: Option<f64>,
    /// The edge at which the wires were read: `rising` or `falling`.
    edge: &'static str,
    /// It is not the profile's.
    edge_was_changed: bool,
    /// Changes of the other wires that are nearer to a falling edge than to a rising one, 0 to 1.
    changes_near_falling: Option<f64>,
    /// Pulses of the clock that were too short and dropped.
    dropped_pulses: u64,
}

impl ClockReport {
    /// The clock of a trace; nothing where none had to be recovered.
    pub(super) fn of(trace: &Trace, dropped_pulses: u64) -> Option<Self> {
        let clock = trace.info().clock?;
        Some(Self {
            format: trace.info().format.name(),
            pclk_hz: clock.hertz,
            sample_rate: clock.sample_rate,
            samples_per_clock: clock.samples_per_clock,
            edge: if clock.edge == Edge::Rising { "rising" } else { "falling" },
            edge_was_changed: clock.edge_was_changed,
            changes_near_falling: clock.stillness.map(|found| found.near_falling),
            dropped_pulses,
        })
    }
}

impl fmt::Display for ClockReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(hertz) = self.pclk_hz {
            write!(f, "{:.3} MHz, ", hertz / 1e6)?;
        }
        match self.samples_per_clock {
            Some(samples) => write!(f, "{samples:.2} samples a clock, ")?,
            None => f.write_str("samples a clock unknown, ")?,
        }
        write!(f, "read at the {} edge", self.edge)?;
        if let Some(falling) = self.changes_near_falling {
            let part = if self.edge == "rising" { falling } else { 1.0 - falling };
            write!(f, " ({:.0}% of the changes are nearer to the other one)", 100.0 * part)?;
        }
        write!(f, ", {} short pulses dropped", self.dropped_pulses)
    }
}

/// A time of the command line in seconds: `12ns`, `0.5us`, `800ps`.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    let at = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(at);
    let unit = match unit {
        "s" => 1.0,
        "ms" => 1e-3,
        "us" => 1e-6,
        "ns" => 1e-9,
        "ps" => 1e-12,
        _ => return Err("write a number with ps, ns, us, ms or s, for instance 12ns".to_owned()),
    };
    let number: f64 = number.trim().parse().map_err(|_| format!("`{number}` is not a number"))?;
    if number.is_finite() && (0.0..1e6).contains(&number) {
        Ok(number * unit)
    } else {
        Err("a time cannot be negative, nor that long".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        assert_eq!(seconds("12ns"), Ok(12.0 * 1e-9));
        assert_eq!(seconds("0.5 us"), Ok(0.5 * 1e-6));
        for text in ["12", "ns", "-1ns", "1e9s", "12 parsec", "nans"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }
}
