//! Whether what was told of a scenario is what was to come of it: asserted on the host and in the images alike.

use core::fmt;

use super::consumer::Told;
use super::scenario::Scenario;

/// What was not as it is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The driver never said so.
    Unseen(&'static str),
    /// The driver said so, and nothing of the kind was put in.
    Unexpected(&'static str),
    /// A frame was called good, and its bytes are not those of a frame that was sent after the one before.
    Torn {
        /// The driver's number for it.
        sequence: u32,
    },
    /// More frames of the trace are missing than the fault explains.
    Missing {
        /// How many.
        frames: usize,
    },
    /// The last frame did not come whole: the driver has not recovered.
    NotRecovered,
    /// The driver counts other frames than it handed out.
    Miscounted {
        /// Frames that it handed out.
        handed_out: u32,
        /// Frames that it says it did.
        counted: u32,
    },
    /// The driver never said what it counted.
    Unfinished,
}

impl Failure {
    /// What it is, and what it is about: a word, or a number.
    #[must_use]
    pub const fn parts(&self) -> (&'static str, &'static str, u32) {
        match *self {
            Self::Unseen(what) => ("the driver never said", what, 0),
            Self::Unexpected(what) => ("the driver said", what, 0),
            Self::Torn { sequence } => ("a frame that is called good is none that was sent", "", sequence),
            Self::Missing { frames } => ("too many frames are missing", "", frames as u32),
            Self::NotRecovered => ("the last frame did not come whole", "", 0),
            Self::Miscounted { counted, .. } => ("the driver counts other frames than it gave", "", counted),
            Self::Unfinished => ("the driver never said what it counted", "", 0),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, word, number) = self.parts();
        write!(f, "{what} {word} ({number})")
    }
}

/// Follows what is told of a scenario.
#[derive(Debug)]
pub struct Check<'a> {
    scenario: &'a Scenario,
    /// Checksums of the frames of the trace, in order.
    sent: &'a [u32],
    /// Which of the scenario's words were told: a bit each.
    seen: u32,
    /// The first frame of the trace that can still come.
    next: usize,
    good: usize,
    handed_out: u32,
    finished: bool,
    failure: Option<Failure>,
}

impl<'a> Check<'a> {
    /// Nothing told yet.
    #[must_use]
    pub const fn new(scenario: &'a Scenario, sent: &'a [u32]) -> Self {
        Self { scenario, sent, seen: 0, next: 0, good: 0, handed_out: 0, finished: false, failure: None }
    }

    /// Takes note of what is told.
    pub fn note(&mut self, told: &Told) {
        match *told {
            Told::Frame(sequence, outcome, checksum) => {
                if self.scenario.lines && outcome != "good" {
                    return self.bad(outcome);
                }
                self.handed_out += 1;
                if outcome != "good" {
                    return self.bad(outcome);
                }
                self.good += 1;
                let left = self.sent.get(self.next..).unwrap_or_default();
                match left.iter().position(|&sent| sent == checksum) {
                    Some(place) => self.next += place + 1,
                    None => self.fail(Failure::Torn { sequence }),
                }
            }
            Told::Lost(word) | Told::Timeout(word) => self.bad(word),
            Told::Refused => self.fail(Failure::Unexpected("line of another length")),
            Told::Total([counted, ..]) => {
                self.finished = true;
                if counted != self.handed_out {
                    self.fail(Failure::Miscounted { handed_out: self.handed_out, counted });
                }
            }
        }
    }

    /// All is told.
    ///
    /// # Errors
    /// The first [`Failure`].
    pub fn finish(mut self) -> Result<(), Failure> {
        if !self.finished {
            self.fail(Failure::Unfinished);
        }
        if self.next != self.sent.len() {
            self.fail(Failure::NotRecovered);
        }
        let frames = self.sent.len() - self.good.min(self.sent.len());
        if frames > self.scenario.missing {
            self.fail(Failure::Missing { frames });
        }
        for (bit, word) in self.scenario.seen.iter().enumerate() {
            if self.seen & 1 << bit == 0 {
                self.fail(Failure::Unseen(word));
            }
        }
        self.failure.map_or(Ok(()), Err)
    }

    fn bad(&mut self, word: &'static str) {
        match self.scenario.seen.iter().position(|seen| *seen == word) {
            Some(bit) => self.seen |= 1 << bit,
            None => self.fail(Failure::Unexpected(word)),
        }
    }

    /// The first failure counts.
    fn fail(&mut self, failure: Failure) {
        self.failure.get_or_insert(failure);
    }
}

#[cfg(test)]
mod tests {
    use super::super::faults::FAULTS;
    use super::*;

    const SENT: [u32; 4] = [10, 11, 12, 13];

    fn checked(name: &str, told: &[Told]) -> Result<(), Failure> {
        let scenario = FAULTS.iter().find(|scenario| scenario.name == name).unwrap();
        let mut check = Check::new(scenario, &SENT);
        told.iter().for_each(|told| check.note(told));
        check.finish()
    }

    fn good(number: u32) -> Told {
        Told::Frame(number, "good", 10 + number)
    }

    #[test]
    fn a_recovery_passes_and_whatever_is_less_does_not() {
        let (overrun, total) = (Told::Lost("overrun"), Told::Total([3, 0, 1, 0, 1]));
        assert_eq!(checked("overrun", &[good(0), overrun, good(2), good(3), total]), Ok(()));
        let all = [good(0), good(1), good(2), good(3), Told::Total([4, 0, 0, 0, 0])];
        assert_eq!(checked("clean", &all), Ok(()));
        assert_eq!(checked("overrun", &all), Err(Failure::Unseen("overrun")), "the fault is not put in");
        let told = [good(0), overrun, Told::Timeout("DMA stalled"), good(2), good(3), total];
        assert_eq!(checked("overrun", &told), Err(Failure::Unexpected("DMA stalled")));
        let told = [good(0), good(1), overrun, good(2), total];
        assert_eq!(checked("overrun", &told), Err(Failure::NotRecovered));
        let told = [good(0), overrun, good(3), Told::Total([2, 0, 2, 0, 1])];
        assert_eq!(checked("overrun", &told), Err(Failure::Missing { frames: 2 }));
        let torn = Told::Frame(2, "good", 99);
        assert_eq!(
            checked("overrun", &[good(0), overrun, torn, good(3), total]),
            Err(Failure::Torn { sequence: 2 })
        );
        let told = [good(0), overrun, good(2), good(2), good(3), Told::Total([4, 0, 1, 0, 1])];
        assert_eq!(checked("overrun", &told), Err(Failure::Torn { sequence: 2 }), "no frame comes twice");
        let told = [good(0), overrun, good(2), good(3), Told::Total([4, 0, 0, 0, 1])];
        assert_eq!(checked("overrun", &told), Err(Failure::Miscounted { handed_out: 3, counted: 4 }));
        assert_eq!(checked("overrun", &told[..4]), Err(Failure::Unfinished));
    }
}
