use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::fault::{FaultKind, FaultSpec, Random};
use crate::profile::{Choice, Profile, ProfileError, SyncMode, nearest};

/// Which cases a campaign has.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    /// Seeds a class of faults.
    pub seeds: u64,
    /// The first seed.
    pub seed_base: u64,
    /// Traces without a fault.
    pub clean: u64,
    /// Classes of faults.
    pub faults: Vec<FaultKind>,
    /// Built-in profiles, by name; they run in a smaller size, see [`small`].
    pub profiles: Vec<String>,
}

/// Why there is no such plan or shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// A class that is none, or cannot be found in a trace.
    #[error("no fault is called `{name}`; did you mean `{nearest}`?")]
    Fault {
        /// As it was written.
        name: String,
        /// The nearest.
        nearest: &'static str,
    },
    /// A profile that is none.
    #[error(transparent)]
    Profile(#[from] ProfileError),
    /// Text that is no shard.
    #[error("`{0}` is no shard; write I/N with I from 1 to N, for instance 1/4")]
    Shard(String),
}

/// A part of a campaign: number `index` of `count`, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Shard {
    /// Which, from 1.
    pub index: u64,
    /// Of how many.
    pub count: u64,
}

impl Shard {
    /// All of it.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Whether a case belongs to the shard.
    #[must_use]
    pub fn holds(&self, case: u64) -> bool {
        case % self.count == self.index - 1
    }
}

impl FromStr for Shard {
    type Err = PlanError;

    fn from_str(text: &str) -> Result<Self, PlanError> {
        let wrong = || PlanError::Shard(text.to_owned());
        let (index, count) = text.split_once('/').ok_or_else(wrong)?;
        let number = |text: &str| text.trim().parse::<u64>().map_err(|_| wrong());
        let shard = Self { index: number(index)?, count: number(count)? };
        if (1..=shard.count).contains(&shard.index) { Ok(shard) } else { Err(wrong()) }
    }
}

/// One case of a plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Case {
    /// Its number in the plan.
    pub number: u64,
    /// The fault, its values settled; nothing for a clean trace.
    pub fault: Option<FaultSpec>,
    /// The profile, small.
    pub profile: Profile,
    /// The seed of everything that is drawn.
    pub seed: u64,
}

/// The classes that show in a trace. Red and blue exchanged leave a picture that is as likely as the true one.
pub(super) fn recognisable() -> impl Iterator<Item = FaultKind> {
    FaultKind::all().filter(|kind| *kind != FaultKind::RedBlueSwap)
}

impl Plan {
    /// So many seeds of every class on every built-in profile in turn, and ten times as many clean traces.
    #[must_use]
    pub fn new(seeds: u64, seed_base: u64) -> Self {
        Self {
            seeds,
            seed_base,
            clean: 10 * seeds,
            faults: recognisable().collect(),
            profiles: crate::profile::built_in_names().map(str::to_owned).collect(),
        }
    }

    /// Takes classes by name instead of all.
    ///
    /// # Errors
    /// [`PlanError::Fault`] with the nearest name.
    pub fn with_faults<'a>(mut self, names: impl IntoIterator<Item = &'a str>) -> Result<Self, PlanError> {
        self.faults = names
            .into_iter()
            .map(|name| {
                FaultKind::from_name(name).ok_or_else(|| PlanError::Fault {
                    name: name.to_owned(),
                    nearest: nearest(name, FaultKind::all().map(Choice::name)).unwrap_or("stuck-bit"),
                })
            })
            .collect::<Result<_, _>>()?;
        Ok(self)
    }

    /// Cases in all.
    #[must_use]
    pub fn cases(&self) -> u64 {
        self.faults.len() as u64 * self.seeds + self.clean
    }

    /// Case `number`: class by class, then the clean ones; the profiles take turns.
    ///
    /// # Errors
    /// [`PlanError::Profile`] if a profile is not there.
    pub fn case(&self, number: u64) -> Result<Case, PlanError> {
        let kind = self.faults.get((number / self.seeds.max(1)) as usize).copied();
        let faulty = self.faults.len() as u64 * self.seeds;
        let turn = if kind.is_some() { number % self.seeds } else { number - faulty };
        let seed = self.seed_base + turn;
        let mut profiles = Vec::new();
        for name in &self.profiles {
            let profile = small(&Profile::find(name)?);
            if kind.is_none_or(|kind| kind.refusal(&profile).is_none()) {
                profiles.push(profile);
            }
        }
        let Some(profile) = profiles.get((turn % profiles.len().max(1) as u64) as usize).cloned() else {
            // A class that no profile of the plan can have becomes a clean case.
            return Ok(Case { number, fault: None, profile: small(&Profile::default()), seed });
        };
        let fault = kind.map(|kind| draw(kind, &profile, seed));
        Ok(Case { number, fault, profile, seed })
    }
}

/// A fault of this class that the profile can have and that has a name of its own.
fn draw(kind: FaultKind, profile: &Profile, seed: u64) -> FaultSpec {
    let mut random = Random::new(seed ^ 0xFA17_0000_0000 ^ (kind as u64) << 40);
    for _ in 0..1_000 {
        let Ok(spec) = FaultSpec::new(kind).settle(profile, &mut random) else { continue };
        let text = spec.to_string();
        let format = profile.frame.format.name();
        // The other byte order of one format is `byte-swap`; what a gray sensor sends through a mosaic is what a gray scene
        // does; a mosaic moved by both is red and blue exchanged.
        let other_name = matches!(
            (format, text.as_str()),
            ("rgb565-be", "format-mismatch:sent=rgb565-le")
                | ("rgb565-le", "format-mismatch:sent=rgb565-be")
                | ("yuyv", "format-mismatch:sent=uyvy")
                | ("uyvy", "format-mismatch:sent=yuyv")
                | ("raw8", "format-mismatch:sent=gray8")
                | ("gray8", "format-mismatch:sent=raw8")
                | (_, "bayer-phase:by=both")
        );
        if !other_name {
            return spec;
        }
    }
    FaultSpec::new(kind)
}

/// The profile at 160 × 120 pixels, its blanking shortened in proportion: a campaign runs thousands of frames.
#[must_use]
pub fn small(profile: &Profile) -> Profile {
    let mut small = profile.clone();
    let divide = (profile.frame.width / 160).max(1);
    let lines = (profile.frame.height / 120).max(1);
    small.frame.width = profile.frame.width / divide;
    small.frame.height = profile.frame.height / lines;
    let timing = &mut small.timing;
    timing.hblank = (profile.timing.hblank / divide).max(u32::from(profile.timing.hblank > 0));
    timing.vblank = profile.timing.vblank / divide / lines;
    (timing.vfront, timing.vback) =
        (profile.timing.vfront / divide / lines, profile.timing.vback / divide / lines);
    if profile.bus.sync == SyncMode::Embedded {
        timing.hblank = timing.hblank.max(24);
        let line = small.samples_per_line() + 2 * small.timing.hblank;
        small.timing.vblank = small.timing.vblank.max(4 * line);
    }
    small
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::built_ins;

    #[test]
    fn small_profiles_are_right_and_every_case_is_one() {
        for profile in built_ins() {
            let small = small(&profile);
            small.check().unwrap();
            assert_eq!((small.frame.width, small.frame.height), (160, 120), "{}", small.name);
        }
        let plan = Plan::new(9, 77);
        for number in 0..plan.cases() {
            let case = plan.case(number).unwrap();
            assert_eq!(case.fault.is_some(), number < 9 * plan.faults.len() as u64);
            assert_eq!(case, plan.case(number).unwrap());
        }
    }

    #[test]
    fn shards_share_the_cases_without_a_rest() {
        for count in 1..6 {
            for case in 0..30 {
                let holders = (1..=count).filter(|&index| Shard { index, count }.holds(case)).count();
                assert_eq!(holders, 1);
            }
        }
        assert_eq!("2/3".parse(), Ok(Shard { index: 2, count: 3 }));
        for text in ["", "1", "0/3", "4/3", "a/b", "1/0"] {
            assert!(text.parse::<Shard>().unwrap_err().to_string().contains("I/N"), "{text}");
        }
    }
}
