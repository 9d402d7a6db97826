//! Pipelines as text, as `host-sim process --op` has them, as far as the device's pipeline makes them.

use core::fmt;

use crate::pipeline::{Norm, Output, Smoothing, Thresholds};

/// What a stream can be made by.
pub(super) const KNOWN: &str = "this device makes: nothing (the raw picture), gray, then gaussian:size=3 or size=5, \
                                then sobel or canny:low=…,high=…,norm=l1|l2";

/// What is made of the raw picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stages {
    /// Nothing: the picture in colour.
    Color,
    /// Gray, smoothed.
    Gray(Smoothing),
    /// The gradient's magnitude.
    Sobel(Smoothing),
    /// Edges.
    Canny(Smoothing, Thresholds),
}

impl Stages {
    /// Reads a pipeline; `None` if this device can't make it.
    pub(super) fn read(text: &str) -> Option<Self> {
        let mut stages = text.split('|').map(str::trim);
        match stages.next()? {
            "" => return stages.next().is_none().then_some(Self::Color),
            "gray" => {}
            _ => return None,
        }
        let mut made = Self::Gray(Smoothing::None);
        for stage in stages {
            let (name, arguments) = stage.split_once(':').unwrap_or((stage, ""));
            made = match (made, name) {
                (Self::Gray(Smoothing::None), "gaussian") => Self::Gray(gaussian(arguments)?),
                (Self::Gray(smoothing), "sobel") if arguments.is_empty() || arguments == "norm=l1" => {
                    Self::Sobel(smoothing)
                }
                (Self::Gray(smoothing), "canny") => Self::Canny(smoothing, thresholds(arguments)?),
                _ => return None,
            };
        }
        Some(made)
    }

    /// What the device's pipeline is told.
    pub(super) fn output(self) -> Output<'static> {
        match self {
            Self::Color => Output::Color,
            Self::Gray(smoothing) => Output::Gray(smoothing),
            Self::Sobel(smoothing) => Output::Sobel(smoothing),
            Self::Canny(smoothing, thresholds) => Output::Canny(smoothing, thresholds),
        }
    }
}

impl fmt::Display for Stages {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (smoothing, end) = match self {
            Self::Color => return Ok(()),
            Self::Gray(smoothing) => (smoothing, None),
            Self::Sobel(smoothing) => (smoothing, Some(None)),
            Self::Canny(smoothing, thresholds) => (smoothing, Some(Some(thresholds))),
        };
        f.write_str("gray")?;
        f.write_str(match smoothing {
            Smoothing::None => "",
            Smoothing::Gaussian3 => "|gaussian:size=3",
            Smoothing::Gaussian5 => "|gaussian:size=5,sigma=1.4",
        })?;
        match end {
            None => Ok(()),
            Some(None) => f.write_str("|sobel"),
            Some(Some(Thresholds { low, high, norm })) => {
                let norm = if *norm == Norm::L1 { "l1" } else { "l2" };
                write!(f, "|canny:low={low},high={high},norm={norm}")
            }
        }
    }
}

fn gaussian(arguments: &str) -> Option<Smoothing> {
    match arguments {
        "" | "size=3" => Some(Smoothing::Gaussian3),
        "size=5" | "size=5,sigma=1.4" => Some(Smoothing::Gaussian5),
        _ => None,
    }
}

fn thresholds(arguments: &str) -> Option<Thresholds> {
    let mut thresholds = Thresholds { low: 50, high: 150, norm: Norm::L2 };
    for argument in arguments.split(',').filter(|argument| !argument.is_empty()) {
        match argument.split_once('=')? {
            ("low", value) => thresholds.low = value.parse().ok()?,
            ("high", value) => thresholds.high = value.parse().ok()?,
            ("norm", "l1") => thresholds.norm = Norm::L1,
            ("norm", "l2") => thresholds.norm = Norm::L2,
            _ => return None,
        }
    }
    (thresholds.low <= thresholds.high).then_some(thresholds)
}
