use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::fault::FaultKind;

/// A cause that explains what is wrong with a trace.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// The class.
    pub fault: FaultKind,
    /// How likely this is the cause, 0 to 1, if all classes are equally likely: measured in campaigns for findings of
    /// such a score. `docs/diagnosis.md` holds what came of it on other seeds.
    pub confidence: f64,
    /// The score of the rule that found it, 0 to 1, by which findings are ranked.
    pub score: f64,
    /// The pixel clock at which it shows first, from 0.
    pub at_pclk: u64,
    /// The line of the frame at that place, from 0; nothing where it is outside a frame or everywhere.
    pub line: Option<u32>,
    /// What was measured.
    pub evidence: Evidence,
    /// What to change.
    pub remedy: Remedy,
}

/// What was measured, in words and in numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// One sentence for people, with the numbers that count.
    pub text: String,
    /// The numbers by name; a name ends in its unit.
    pub numbers: BTreeMap<String, f64>,
}

impl Evidence {
    /// A sentence.
    #[must_use]
    pub fn new(text: impl Into<String>) -> Self {
        Self { text: text.into(), numbers: BTreeMap::new() }
    }

    /// With a number.
    #[must_use]
    pub fn with(mut self, name: &str, number: f64) -> Self {
        self.numbers.insert(name.to_owned(), number);
        self
    }
}

/// What to change.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Remedy {
    /// One sentence for people.
    pub text: String,
    /// The profile's key with its new value, `bus.clock_edge = "falling"`, where that mends it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub profile: Option<String>,
    /// The register bit of the camera interface with its new value, `CR.PCKPOL = 0`, likewise.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub register: Option<String>,
}

impl Remedy {
    /// A sentence.
    #[must_use]
    pub fn new(text: impl Into<String>) -> Self {
        Self { text: text.into(), ..Self::default() }
    }

    /// With the key of the profile that mends it.
    #[must_use]
    pub fn profile(mut self, setting: impl Into<String>) -> Self {
        self.profile = Some(setting.into());
        self
    }

    /// With the register bit that mends it.
    #[must_use]
    pub fn register(mut self, setting: impl Into<String>) -> Self {
        self.register = Some(setting.into());
        self
    }
}

impl fmt::Display for Remedy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)?;
        if let Some(setting) = &self.profile {
            write!(f, "; profile: {setting}")?;
        }
        if let Some(setting) = &self.register {
            write!(f, "; register: {setting}")?;
        }
        Ok(())
    }
}

/// Where the cause is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// Nothing is wrong.
    #[default]
    Nowhere,
    /// The trace itself is wrong: the sensor, its settings, the wires, or what the profile says of them.
    WireOrSensor,
    /// The trace is right and the frame received is not: the receiver, its DMA or its memory bus.
    Receiver,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Nowhere => "nowhere: nothing is wrong",
            Self::WireOrSensor => "wire or sensor",
            Self::Receiver => "receiver",
        })
    }
}

/// What a trace shows: the JSON of `diagnose --json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Diagnosis {
    /// The most likely cause first; none for a clean trace.
    pub findings: Vec<Finding>,
    /// Causes that look just like the first finding: nothing in the trace tells them apart.
    pub ambiguous_with: Vec<FaultKind>,
    /// Where the cause is.
    pub place: Place,
    /// What was measured of the trace as a whole.
    pub measured: Measured,
}

impl Diagnosis {
    /// Nothing is wrong.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.findings.is_empty()
    }
}

/// What was measured of a trace by its profile.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Pixel clocks looked at.
    pub clocks: u64,
    /// Whole frames among them, from one end of frame to the next.
    pub frames: u64,
    /// How many frames have so many lines.
    pub lines_a_frame: BTreeMap<u64, u64>,
    /// How many lines have so many samples.
    pub samples_a_line: BTreeMap<u64, u64>,
    /// How many gaps between the lines of a frame have so many clocks.
    pub blanking_clocks: BTreeMap<u64, u64>,
    /// How many times VSYNC was in blanking for so many clocks.
    pub vsync_clocks: BTreeMap<u64, u64>,
    /// Edges of HSYNC and of VSYNC, both ways.
    pub sync_edges: (u64, u64),
    /// How often each data wire changes from one pixel to the next of its colour, 0 to 1; D0 first.
    pub toggling: Vec<f64>,
    /// How often each data wire agrees with the one below it, 0 to 1; D1 against D0 first.
    pub agreement: Vec<f64>,
    /// Bits a sample that the picture takes when each sample is foretold by its neighbours.
    pub entropy_bits: f64,
    /// The pixel clock in hertz; nothing if the trace has no times.
    pub pclk_hz: Option<u32>,
}
