//! What of the part was missing, and what of that was expected.

use std::fmt::{self, Display};
use std::path::Path;

use anyhow::{Context, Result, bail};
use rigless::session::Session;
use serde::{Deserialize, Serialize};

use crate::board::{CameraBoard, Kind};
use crate::symbols::Symbols;

/// The kinds of gaps.
pub const KINDS: [&str; 5] = ["unmapped", "refused", "unimplemented", "unrouted", "told"];

/// Bytes between two addresses that belong to one range: the widest access.
const STEP: u64 = 8;

/// An access that the emulated part did not answer as the chip would.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Gap {
    /// One of [`KINDS`]: `told` is a broken rule of the manual.
    pub kind: &'static str,
    /// Where: the instance and register, or the address, or `FIRST to LAST` for neighbouring ones.
    pub place: String,
    /// What of it; of a range, that of its first address.
    pub detail: String,
    /// Addresses that this stands for; 1 where a register has a name.
    pub addresses: u64,
    /// The allow-list expects it.
    pub expected: bool,
}

impl Display for Gap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, place, detail, addresses, .. } = self;
        match addresses {
            1 => write!(f, "{kind:<13} {place}: {detail}"),
            _ => write!(f, "{kind:<13} {place}, {addresses} addresses: {detail}"),
        }
    }
}

/// Gaps that an image is known to meet.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Allowed {
    /// Which.
    #[serde(default)]
    pub allow: Vec<Entry>,
}

/// One of them.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// The kind of gap, one of [`KINDS`].
    pub kind: String,
    /// What the name of its place begins with, such as `RTC.`; of `unmapped` and `refused` an address such as
    /// `0x58024400`, or `FIRST to LAST`.
    pub place: String,
    /// Why that is all right.
    pub reason: String,
}

impl Entry {
    /// The addresses that it stands for, if its kind has addresses.
    fn addresses(&self) -> Option<(u64, u64)> {
        let number =
            |text: &str| u64::from_str_radix(&text.trim().strip_prefix("0x")?.replace('_', ""), 16).ok();
        match self.place.split_once(" to ") {
            Some((first, last)) => Some((number(first)?, number(last)?)),
            None => number(&self.place).map(|address| (address, address)),
        }
    }

    fn has_addresses(&self) -> bool {
        self.kind == "unmapped" || self.kind == "refused"
    }
}

impl Allowed {
    /// From a TOML file of `[[allow]]` tables with `kind`, `place` and `reason`.
    ///
    /// # Errors
    /// If it cannot be read, or an entry says what no gap can match.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        Self::parse(&text).with_context(|| path.display().to_string())
    }

    fn parse(text: &str) -> Result<Self> {
        let allowed: Self = toml::from_str(text)?;
        for entry in &allowed.allow {
            let Entry { kind, place, reason } = entry;
            if !KINDS.contains(&kind.as_str()) {
                bail!("kind = {kind:?}: there are {}", KINDS.join(", "));
            }
            if place.is_empty() {
                bail!("{kind} without a place would allow everything");
            }
            if entry.has_addresses() && entry.addresses().is_none() {
                bail!(
                    "{kind} has addresses: write place = \"0x58024400\" or \"0x58024400 to 0x580247fc\", not {place:?}"
                );
            }
            if reason.trim().is_empty() {
                bail!("{kind} {place}: say why that is all right");
            }
        }
        Ok(allowed)
    }

    /// The list that comes with a board: what the emulator leaves out of the part and start-up code touches.
    ///
    /// # Panics
    /// If the list, which is part of the program, is malformed; a test reads it.
    #[must_use]
    pub fn of(board: Kind) -> Self {
        let text = match board {
            Kind::Stm32h743 => include_str!("../allowed/stm32h743.toml"),
            Kind::Stm32f429 => include_str!("../allowed/stm32f429.toml"),
        };
        Self::parse(text).expect("the list is part of the program")
    }

    fn expects_name(&self, kind: &str, place: &str) -> bool {
        self.allow.iter().any(|entry| entry.kind == kind && place.starts_with(&entry.place))
    }

    fn expects_address(&self, kind: &str, address: u64) -> bool {
        let ranges = self.allow.iter().filter(|entry| entry.kind == kind).filter_map(Entry::addresses);
        ranges.into_iter().any(|(first, last)| (first..=last).contains(&address))
    }
}

/// All gaps of a run.
pub(crate) fn gaps(session: &Session<CameraBoard>, allowed: &Allowed, symbols: &Symbols) -> Vec<Gap> {
    let unmapped = session.unmapped();
    let unmapped = unmapped.iter().map(|gap| (gap.address, gap.program_counter));
    let mut gaps = ranges("unmapped", unmapped, allowed, |by| format!("first by {}", symbols.describe(*by)));
    let refused = session.refused().iter().map(|(&address, fault)| (address, fault));
    gaps.extend(ranges("refused", refused, allowed, |fault| fault.to_string()));
    let mut add = |kind: &'static str, place: String, detail: String| {
        let expected = allowed.expects_name(kind, &place);
        gaps.push(Gap { kind, place, detail, addresses: 1, expected });
    };
    for gap in session.unimplemented().values() {
        let by = symbols.describe(gap.program_counter);
        let detail = format!("{} reads, {} writes, first by {by}", gap.reads, gap.writes);
        add("unimplemented", format!("{}.{}", gap.instance, gap.register), detail);
    }
    for (instance, number) in session.unrouted() {
        add("unrouted", format!("{instance}.{number}"), "the core has no such line".into());
    }
    for told in session.told() {
        add("told", format!("{}.{}", told.instance, told.register), told.reason.into());
    }
    gaps
}

/// Gaps by address, in ascending order, as ranges of neighbours that are expected, or are not.
fn ranges<T>(
    kind: &'static str,
    met: impl Iterator<Item = (u64, T)>,
    allowed: &Allowed,
    detail: impl Fn(&T) -> String,
) -> Vec<Gap> {
    let mut gaps: Vec<(Gap, u64, u64)> = Vec::new();
    for (address, what) in met {
        let expected = allowed.expects_address(kind, address);
        match gaps.last_mut() {
            Some((gap, _, last)) if gap.expected == expected && address - *last <= STEP => {
                (*last, gap.addresses) = (address, gap.addresses + 1);
            }
            _ => {
                let gap = Gap { kind, place: String::new(), detail: detail(&what), addresses: 1, expected };
                gaps.push((gap, address, address));
            }
        }
    }
    let named = gaps.into_iter().map(|(mut gap, first, last)| {
        gap.place = match gap.addresses {
            1 => format!("{first:#010x}"),
            _ => format!("{first:#010x} to {last:#010x}"),
        };
        gap
    });
    named.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lists_that_come_along_are_well_formed() {
        for board in [Kind::Stm32h743, Kind::Stm32f429] {
            assert!(Allowed::of(board).allow.iter().all(|entry| !entry.reason.is_empty()));
        }
    }

    #[test]
    fn a_million_addresses_are_one_line_and_the_expected_ones_among_them_another() {
        let allow =
            "[[allow]]\nkind = \"unmapped\"\nplace = \"0x1000_0100 to 0x100001ff\"\nreason = \"a test\"\n";
        let allowed = Allowed::parse(allow).unwrap();
        let met = (0..1_000_000).map(|word| (0x1000_0000 + 4 * word, word)).chain([(0x5000_0000, 7)]);
        let gaps = ranges("unmapped", met, &allowed, |word| format!("word {word}"));
        let lines: Vec<String> = gaps.iter().map(|gap| format!("{gap} {}", gap.expected)).collect();
        let expected = [
            "unmapped      0x10000000 to 0x100000fc, 64 addresses: word 0 false",
            "unmapped      0x10000100 to 0x100001fc, 64 addresses: word 64 true",
            "unmapped      0x10000200 to 0x103d08fc, 999872 addresses: word 128 false",
            "unmapped      0x50000000: word 7 false",
        ];
        assert_eq!(lines, expected);
    }

    #[test]
    fn a_list_that_allows_nothing_or_all_is_refused() {
        let refused = |kind: &str, place: &str, reason: &str| {
            let text = format!("[[allow]]\nkind = {kind:?}\nplace = {place:?}\nreason = {reason:?}\n");
            format!("{:#}", Allowed::parse(&text).unwrap_err())
        };
        assert!(refused("unmaped", "0x0", "x").contains("unmapped, refused, unimplemented"));
        assert!(refused("told", "", "x").contains("everything"));
        assert!(refused("refused", "RTC.", "x").contains("addresses"));
        assert!(refused("told", "RTC.", " ").contains("why"));
        assert!(Allowed::parse("[[allow]]\nkind = \"told\"\nplace = \"RTC.\"\n").is_err(), "no reason");
    }
}
