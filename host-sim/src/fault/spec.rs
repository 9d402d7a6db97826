use std::fmt;
use std::fmt::Write as _;
use std::str::FromStr;

use super::kind::{FaultKind, Key, Values};
use super::random::Random;
use crate::profile::{Choice, Profile, nearest};

/// A fault with its values: `stuck-bit:bit=3,level=high`. Values that are not given are drawn by the seed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultSpec {
    /// The class.
    pub kind: FaultKind,
    /// The value of each of the class's keys, in their order; a word is its place in the list.
    values: Vec<Option<i64>>,
}

/// What is wrong with a fault's text, or with a fault on a profile's wires.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FaultError {
    /// A name that is none.
    #[error("no fault is called `{name}`; did you mean `{nearest}`? `--fault help` lists them")]
    UnknownKind {
        /// As it was written.
        name: String,
        /// The name nearest to it.
        nearest: &'static str,
    },
    /// A key that the fault does not have.
    #[error("`{kind}` has no `{key}`; {instead}")]
    UnknownKey {
        /// The class.
        kind: FaultKind,
        /// The key.
        key: String,
        /// Which it has.
        instead: String,
    },
    /// A part without `=`.
    #[error("`{part}` in `{kind}` has no value; write `key=value`")]
    NoValue {
        /// The class.
        kind: FaultKind,
        /// As it was written.
        part: String,
    },
    /// A key that is given twice.
    #[error("`{key}` of `{kind}` is given twice; keep one")]
    Twice {
        /// The class.
        kind: FaultKind,
        /// The key.
        key: &'static str,
    },
    /// A value that the key cannot have.
    #[error("`{key}` of `{kind}` is `{got}`; it must be {allowed}")]
    Value {
        /// The class.
        kind: FaultKind,
        /// The key.
        key: &'static str,
        /// The value.
        got: String,
        /// Which are right.
        allowed: String,
    },
    /// A fault that these wires cannot have.
    #[error("`{kind}` cannot be put into {profile}: {why}")]
    Refused {
        /// The class.
        kind: FaultKind,
        /// The profile's name.
        profile: String,
        /// Why not.
        why: String,
    },
}

fn allowed(values: Values) -> String {
    match values {
        Values::Numbers((first, last), _) => format!("a whole number from {first} to {last}"),
        Values::Words(words) => words.join(", "),
    }
}

impl FromStr for FaultSpec {
    type Err = FaultError;

    fn from_str(text: &str) -> Result<Self, FaultError> {
        let (name, rest) = text.split_once(':').unwrap_or((text, ""));
        let name = name.trim();
        let kind = FaultKind::from_name(name).ok_or_else(|| FaultError::UnknownKind {
            name: name.to_owned(),
            nearest: nearest(name, FaultKind::all().map(Choice::name)).unwrap_or("stuck-bit"),
        })?;
        let mut spec = Self::new(kind);
        for part in rest.split(',').map(str::trim).filter(|part| !part.is_empty()) {
            let (key, value) =
                part.split_once('=').ok_or_else(|| FaultError::NoValue { kind, part: part.to_owned() })?;
            let (place, key) = spec.find(key.trim())?;
            let got = value.trim();
            let wrong = || FaultError::Value {
                kind,
                key: key.name,
                got: got.to_owned(),
                allowed: allowed(key.values),
            };
            let value = match key.values {
                Values::Numbers((first, last), _) => got
                    .replace('_', "")
                    .parse::<i64>()
                    .ok()
                    .filter(|number| (first..=last).contains(number))
                    .ok_or_else(wrong)?,
                Values::Words(words) => words.iter().position(|word| *word == got).ok_or_else(wrong)? as i64,
            };
            if spec.values[place].replace(value).is_some() {
                return Err(FaultError::Twice { kind, key: key.name });
            }
        }
        Ok(spec)
    }
}

impl FaultSpec {
    /// A fault whose values are all left to the seed.
    #[must_use]
    pub fn new(kind: FaultKind) -> Self {
        Self { kind, values: vec![None; kind.keys().len()] }
    }

    fn find(&self, name: &str) -> Result<(usize, &'static Key), FaultError> {
        let keys = self.kind.keys();
        keys.iter().enumerate().find(|(_, key)| key.name == name).ok_or_else(|| {
            let names = keys.iter().map(|key| key.name);
            let instead = match nearest(name, names.clone()) {
                None => "it takes no keys".to_owned(),
                Some(near) => {
                    format!("did you mean `{near}`? It has {}", names.collect::<Vec<_>>().join(", "))
                }
            };
            FaultError::UnknownKey { kind: self.kind, key: name.to_owned(), instead }
        })
    }

    /// The value of a key.
    ///
    /// # Panics
    /// If the class has no such key or its value has not been drawn: both are mistakes in this crate.
    pub(super) fn value(&self, name: &str) -> i64 {
        let place = self.kind.keys().iter().position(|key| key.name == name);
        place.and_then(|place| self.values[place]).unwrap_or_else(|| panic!("{}: {name}", self.kind))
    }

    /// The word of a key, likewise.
    pub(super) fn word(&self, name: &str) -> &'static str {
        let value = self.value(name);
        match self.kind.keys().iter().find(|key| key.name == name).map(|key| key.values) {
            Some(Values::Words(words)) => words[value as usize],
            _ => "",
        }
    }

    /// Draws what was not given, and checks all of it against the wires.
    ///
    /// # Errors
    /// [`FaultError::Refused`] or [`FaultError::Value`] if the profile's wires cannot have the fault.
    pub fn settle(mut self, profile: &Profile, random: &mut Random) -> Result<Self, FaultError> {
        let kind = self.kind;
        let refused = |why: String| FaultError::Refused { kind, profile: profile.name.clone(), why };
        if let Some(why) = kind.refusal(profile) {
            return Err(refused(why.to_owned()));
        }
        let bits = i64::from(profile.bus.bits);
        for (place, key) in kind.keys().iter().enumerate() {
            let is_wire = matches!(key.name, "a" | "b" | "bit");
            let drawn = match key.values {
                Values::Numbers(_, (first, last)) => {
                    random.between(first, if is_wire { bits - 1 } else { last })
                }
                Values::Words(words) => random.below(words.len() as u64) as i64,
            };
            let value = *self.values[place].get_or_insert(drawn);
            if is_wire && value >= bits {
                let got = value.to_string();
                let allowed = format!("a data wire of this bus, 0 to {}", bits - 1);
                return Err(FaultError::Value { kind, key: key.name, got, allowed });
            }
        }
        match kind {
            FaultKind::SwappedBits | FaultKind::ShortedBits if self.value("a") == self.value("b") => {
                // Two drawn alike; two given alike are a mistake.
                self.values[1] = Some((self.value("a") + 1) % bits);
            }
            FaultKind::FormatMismatch if self.word("sent") == Choice::name(profile.frame.format) => {
                return Err(refused("the profile already has the format; send another".to_owned()));
            }
            _ => {}
        }
        Ok(self)
    }
}

impl fmt::Display for FaultSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.kind)?;
        let mut mark = ':';
        for (key, value) in self.kind.keys().iter().zip(&self.values) {
            let Some(value) = value else { continue };
            match key.values {
                Values::Numbers(..) => write!(f, "{mark}{}={value}", key.name)?,
                Values::Words(words) => write!(f, "{mark}{}={}", key.name, words[*value as usize])?,
            }
            mark = ',';
        }
        Ok(())
    }
}

/// Every fault with its keys, for a terminal.
#[must_use]
pub fn help() -> String {
    let mut text = String::from("KIND[:key=value,…]; what is not given is drawn by --seed\n\n");
    for kind in FaultKind::all() {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{:<16} {}", kind.name(), kind.about());
        for key in kind.keys() {
            let _ = writeln!(text, "{:>18}{:<8} {}: {}", "", key.name, key.about, allowed(key.values));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_reads_back_as_it_is_written() {
        for text in [
            "reversed-bus",
            "stuck-bit:bit=3,level=high",
            "format-mismatch:sent=yuyv",
            "short-line:samples=8",
        ] {
            assert_eq!(text.parse::<FaultSpec>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn mistakes_name_the_remedy() {
        let error = |text: &str| text.parse::<FaultSpec>().unwrap_err().to_string();
        assert!(error("stuck-bits").contains("did you mean `stuck-bit`?"));
        assert!(error("stuck-bit:bits=3").contains("did you mean `bit`?"));
        assert!(error("reversed-bus:bit=3").contains("it takes no keys"));
        assert!(error("stuck-bit:bit=14").contains("a whole number from 0 to 13"));
        assert!(error("stuck-bit:level=hi").contains("low, high"));
        assert!(error("stuck-bit:bit").contains("key=value"));
        assert!(error("stuck-bit:bit=1,bit=2").contains("twice"));
    }

    #[test]
    fn a_seed_draws_what_is_not_given_and_the_wires_refuse_what_they_lack() {
        let profile = Profile::default();
        for kind in FaultKind::all().filter(|kind| kind.refusal(&profile).is_none()) {
            for seed in 0..50 {
                match FaultSpec::new(kind).settle(&profile, &mut Random::new(seed)) {
                    Ok(spec) => assert_eq!(spec.to_string().parse::<FaultSpec>().unwrap(), spec),
                    Err(error) => assert_eq!(kind, FaultKind::FormatMismatch, "{error}"),
                }
            }
        }
        let settle = |text: &str| text.parse::<FaultSpec>().unwrap().settle(&profile, &mut Random::new(0));
        assert!(settle("stuck-bit:bit=9").unwrap_err().to_string().contains("0 to 7"));
        assert!(settle("short-blanking").unwrap_err().to_string().contains("no blanking"));
    }

    #[test]
    fn help_has_every_fault() {
        let help = help();
        for kind in FaultKind::all() {
            assert!(help.contains(kind.name()) && help.contains(kind.about()));
        }
    }
}
