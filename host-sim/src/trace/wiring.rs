//! Which signal of a capture is which wire of the camera bus.
//!
//! ```text
//! signals of the file   tb.PIXCLK  tb.HREF  tb.VSYNC  tb.D[7:0]  tb.dut.state …
//! + map, names          ─► PCLK = PIXCLK · HSYNC = HREF (valid when high) · D0 = D, bit 0 …
//! ```
//!
//! A map entry wins; then the shallowest scope, the more usual name, the earlier declaration. The data bus is taken
//! as a whole from one scope, never half from here and half from there.

use super::bus;
use super::names::{ALIASES, MapError, Missing, Role, SignalMap, classify, nearest, split_index};

/// A signal of a capture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Signal {
    /// Scopes, outermost first, joined by dots; empty at the top.
    pub scope: String,
    /// Its own name, without a range.
    pub name: String,
    /// Bits.
    pub width: u32,
    /// Declared indices of its highest and lowest bit, or twice that of a single one.
    pub range: Option<(u32, u32)>,
}

/// One bit of a signal: its number in the list, and the bit (0 is the least significant).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tap {
    /// Index in the list of signals.
    pub signal: usize,
    /// Bit of the signal.
    pub bit: u32,
}

/// Where every wire of the bus is found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wiring {
    /// The pixel clock.
    pub pclk: Tap,
    /// The line sync, if there is one.
    pub hsync: Option<Tap>,
    /// The frame sync, if there is one.
    pub vsync: Option<Tap>,
    /// The data lines, D0 first: 8, 10, 12 or 14.
    pub data: Vec<Tap>,
    /// The same in words.
    pub matched: Matched,
}

/// Which signals were taken for which wires.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Matched {
    /// The pixel clock's signal.
    pub pclk: String,
    /// The line sync's signal.
    pub hsync: Option<SyncName>,
    /// The frame sync's signal.
    pub vsync: Option<SyncName>,
    /// The data lines' signals, D0 first.
    pub data: Vec<String>,
}

/// The signal taken for a sync wire.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SyncName {
    /// The signal.
    pub signal: String,
    /// Its name (HREF, LV, FV) says that data is valid while it is high.
    pub valid_high: bool,
}

/// What is asked of a capture.
#[derive(Clone, Debug, Default)]
pub struct Wanted {
    /// Names that are not the usual ones.
    pub map: SignalMap,
    /// Width of the bus, if known; else as many of the lines there are as a bus can have.
    pub bus_bits: Option<u8>,
    /// HSYNC and VSYNC may be missing, as with embedded sync.
    pub no_sync_wires: bool,
}

/// Why the wires could not be found.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WiringError {
    /// The map does not fit the file.
    #[error(transparent)]
    Map(#[from] MapError),
    /// A wire is not there.
    #[error(transparent)]
    Missing(#[from] Missing),
}

impl Signal {
    /// Scopes, name and, for one bit of a bus, its index: `tb.cam.D[3]`.
    #[must_use]
    pub fn label(&self) -> String {
        let index = match self.range {
            Some((high, low)) if high == low && self.width == 1 => format!("[{low}]"),
            _ => String::new(),
        };
        let dot = if self.scope.is_empty() { "" } else { "." };
        format!("{}{dot}{}{index}", self.scope, self.name)
    }

    pub(super) fn depth(&self) -> usize {
        if self.scope.is_empty() { 0 } else { 1 + self.scope.matches('.').count() }
    }

    /// Role by name, and the name's place in the order of preference.
    pub(super) fn role(&self) -> Option<(Role, usize)> {
        match self.range {
            Some((high, low)) if high == low && self.width == 1 => classify(&format!("{}[{low}]", self.name)),
            _ => classify(&self.name),
        }
    }

    /// How well `wanted` names this signal: 0 to the letter, then without case, then without the outer scopes.
    fn fits(&self, label: &str, wanted: &str) -> Option<usize> {
        if label == wanted {
            return Some(0);
        }
        let tail = label.len().checked_sub(wanted.len())?;
        let same = label.get(tail..)?.eq_ignore_ascii_case(wanted);
        match (same, tail) {
            (true, 0) => Some(1),
            (true, _) => (label.as_bytes().get(tail - 1) == Some(&b'.')).then_some(2),
            (false, _) => None,
        }
    }

    pub(super) fn tap_name(&self, bit: u32) -> String {
        let label = self.label();
        if self.width == 1 { label } else { format!("{label}[{bit}]") }
    }
}

/// Finds the wires among the signals.
///
/// # Errors
/// [`WiringError::Missing`] for a wire that is needed and not there, [`WiringError::Map`] for a map that does not fit.
pub fn wire(signals: &[Signal], wanted: &Wanted) -> Result<Wiring, WiringError> {
    let one = |role: Role| -> Result<Option<(Tap, usize)>, WiringError> {
        if let Some(entry) = wanted.map.get(role) {
            return Ok(Some((mapped(signals, role, &entry.signal)?, entry.rank)));
        }
        let named = signals.iter().enumerate().filter(|(_, signal)| signal.width == 1);
        let ranked = named.filter_map(|(index, signal)| {
            let (found, rank) = signal.role()?;
            (found == role).then_some((signal.depth(), rank, index))
        });
        Ok(ranked.min().map(|(_, rank, index)| (Tap { signal: index, bit: 0 }, rank)))
    };
    let missing = |role: Role| Missing { role, signals: listed(signals) };
    let (pclk, _) = one(Role::Pclk)?.ok_or_else(|| missing(Role::Pclk))?;
    let (hsync, vsync) = (one(Role::Hsync)?, one(Role::Vsync)?);
    if !wanted.no_sync_wires {
        for (role, found) in [(Role::Hsync, hsync), (Role::Vsync, vsync)] {
            found.ok_or_else(|| missing(role))?;
        }
    }
    let data = bus::lines(signals, wanted)?;
    let name = |tap: Tap| signals.get(tap.signal).map(|signal| signal.tap_name(tap.bit)).unwrap_or_default();
    let sync = |found: Option<(Tap, usize)>| {
        found.map(|(tap, rank)| SyncName {
            signal: name(tap),
            valid_high: ALIASES.get(rank).is_some_and(|alias| alias.valid_high),
        })
    };
    let matched = Matched {
        pclk: name(pclk),
        hsync: sync(hsync),
        vsync: sync(vsync),
        data: data.iter().copied().map(name).collect(),
    };
    Ok(Wiring { pclk, hsync: hsync.map(|(tap, _)| tap), vsync: vsync.map(|(tap, _)| tap), data, matched })
}

/// The one bit that a map entry names.
pub(super) fn mapped(signals: &[Signal], role: Role, name: &str) -> Result<Tap, WiringError> {
    if let Some(index) = find(signals, name) {
        return match signals.get(index).map(|signal| signal.width) {
            Some(1) => Ok(Tap { signal: index, bit: 0 }),
            width => {
                Err(MapError::Width { role, name: name.to_owned(), width: width.unwrap_or_default() }.into())
            }
        };
    }
    let bit = split_index(name).and_then(|(base, number)| {
        let index = find(signals, base)?;
        let signal = signals.get(index)?;
        let low = signal.range.map_or(0, |(high, low)| high.min(low));
        let bit = number.checked_sub(low).filter(|&bit| bit < signal.width)?;
        Some(Tap { signal: index, bit })
    });
    bit.ok_or_else(|| unknown(signals, role, name).into())
}

pub(super) fn find(signals: &[Signal], name: &str) -> Option<usize> {
    let fitting = signals
        .iter()
        .enumerate()
        .filter_map(|(index, signal)| Some((signal.fits(&signal.label(), name)?, signal.depth(), index)));
    fitting.min().map(|(_, _, index)| index).or_else(|| numbered(signals, name))
}

/// The channel of an analyser by its number: `CH3` is also `Channel 3`, `digital_3` or `3`.
fn numbered(signals: &[Signal], name: &str) -> Option<usize> {
    let number = |name: &str| {
        let lower = name.to_ascii_lowercase();
        let bases = ["channel ", "channel", "digital_", "ch", ""];
        bases.into_iter().find_map(|base| lower.strip_prefix(base)?.parse::<u32>().ok())
    };
    let wanted = number(name)?;
    signals.iter().position(|signal| number(&signal.name) == Some(wanted))
}

pub(super) fn unknown(signals: &[Signal], role: Role, name: &str) -> MapError {
    let labels = signals.iter().take(LOOKED_AT).flat_map(|signal| [signal.label(), signal.name.clone()]);
    MapError::Signal { role, name: name.to_owned(), nearest: nearest(name, labels), signals: listed(signals) }
}

/// Signals among which the nearest name is sought.
const LOOKED_AT: usize = 4096;
/// Signals that an error names.
const LISTED: usize = 24;

/// The signals as words for an error.
pub(super) fn listed(signals: &[Signal]) -> String {
    if signals.is_empty() {
        return "no signals".to_owned();
    }
    let mut names: Vec<String> = signals.iter().take(LISTED).map(Signal::label).collect();
    if let Some(more) = signals.len().checked_sub(LISTED).filter(|&more| more > 0) {
        names.push(format!("… and {more} more"));
    }
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `scope.name width high:low` a line.
    fn signals(text: &str) -> Vec<Signal> {
        let signal = |line: &str| {
            let mut words = line.split_whitespace();
            let path = words.next().unwrap();
            let width = words.next().map_or(1, |width| width.parse().unwrap());
            let range = words.next().map(|range| {
                let (high, low) = range.split_once(':').unwrap();
                (high.parse().unwrap(), low.parse().unwrap())
            });
            let (scope, name) = path.rsplit_once('.').unwrap_or(("", path));
            Signal { scope: scope.to_owned(), name: name.to_owned(), width, range }
        };
        text.lines().map(str::trim).filter(|line| !line.is_empty()).map(signal).collect()
    }

    fn eight(name: &str) -> String {
        (0..8)
            .map(|line| {
                format!(
                    "{name}{line}
"
                )
            })
            .collect()
    }

    fn wanted(map: &str) -> Wanted {
        Wanted { map: SignalMap::parse(map).unwrap(), ..Wanted::default() }
    }

    #[test]
    fn usual_names_are_found_and_reported() {
        let list = signals(&format!(
            "PIXCLK
HREF
VSYNC
RESET
{}",
            eight("D")
        ));
        let found = wire(&list, &wanted("")).unwrap();
        assert_eq!(found.matched.pclk, "PIXCLK");
        assert_eq!(found.matched.hsync, Some(SyncName { signal: "HREF".into(), valid_high: true }));
        assert_eq!(found.matched.vsync, Some(SyncName { signal: "VSYNC".into(), valid_high: false }));
        assert_eq!(found.matched.data.join(" "), "D0 D1 D2 D3 D4 D5 D6 D7");
        assert_eq!(found.data[7], Tap { signal: 11, bit: 0 });
    }

    #[test]
    fn the_outer_scope_wins_and_a_bus_is_not_mixed() {
        let list = signals(&format!(
            "tb.dut.PCLK
tb.dut.HS
tb.dut.VS
{}tb.PCLK
tb.HS
tb.VS
tb.D0
tb.D1",
            eight("tb.dut.D")
        ));
        let found = wire(&list, &wanted("")).unwrap();
        assert_eq!(found.matched.pclk, "tb.PCLK");
        assert_eq!(found.matched.data[0], "tb.dut.D0");
    }

    #[test]
    fn a_vector_is_a_bus_wherever_it_starts() {
        for range in ["8 7:0", "8 0:7", "8 9:2", "8"] {
            let list = signals(&format!(
                "PCLK
HS
VS
DATA {range}"
            ));
            let found = wire(&list, &wanted("")).unwrap();
            assert_eq!(found.data, (0..8).map(|bit| Tap { signal: 3, bit }).collect::<Vec<_>>());
        }
        let halves = signals(
            "PCLK
HS
VS
D 4 7:4
D 4 3:0",
        );
        let found = wire(&halves, &wanted("")).unwrap();
        assert_eq!(found.data[0], Tap { signal: 4, bit: 0 });
        assert_eq!(found.data[7], Tap { signal: 3, bit: 3 });
    }

    #[test]
    fn the_bus_is_as_wide_as_asked_or_as_it_can_be() {
        let list = signals(
            "PCLK
HS
VS
D 12 11:0",
        );
        assert_eq!(wire(&list, &wanted("")).unwrap().data.len(), 12);
        assert_eq!(wire(&list, &Wanted { bus_bits: Some(8), ..wanted("") }).unwrap().data.len(), 8);
        let error = wire(&list, &Wanted { bus_bits: Some(14), ..wanted("") }).unwrap_err().to_string();
        assert!(error.contains("--map D12="), "{error}");
    }

    #[test]
    fn a_map_overrides_and_reaches_into_vectors() {
        let list = signals(&format!(
            "CH0
CH1
CH2
top.bus 12 11:0
PCLK
{}",
            eight("CH1")
        ));
        let found = wire(&list, &wanted("PCLK=ch0,HREF=CH1,VSYNC=CH2,DATA=bus,D1=bus[11],D2=CH13")).unwrap();
        assert_eq!(found.matched.pclk, "CH0");
        assert!(found.matched.hsync.unwrap().valid_high);
        assert_eq!(found.data[0], Tap { signal: 3, bit: 0 });
        assert_eq!(found.data[1], Tap { signal: 3, bit: 11 });
        assert_eq!(found.matched.data[2], "CH13");
        let numbered = wire(&list, &wanted("HS=CH1,VS=CH2,DATA=CH1")).unwrap();
        assert_eq!(numbered.matched.data[7], "CH17");
    }

    #[test]
    fn what_is_missing_is_said_with_the_remedy() {
        let message = |list: &str, map: &str| wire(&signals(list), &wanted(map)).unwrap_err().to_string();
        let error = message(
            "CH0
CH1
HS
VS",
            "",
        );
        assert!(error.contains("--map PCLK=") && error.contains("CH0, CH1, HS, VS"), "{error}");
        assert!(
            message(
                "PCLK
VS", ""
            )
            .contains("--map HSYNC=")
        );
        assert!(
            message(
                "PCLK
HS
VS
D0
D1
D3",
                ""
            )
            .contains("--map D2=")
        );
        let error = message(
            "tb.clock
HS
VS",
            "PCLK=clok",
        );
        assert!(error.contains("did you mean `clock`"), "{error}");
        assert!(message("bus 8 7:0", "PCLK=bus").contains("PCLK=bus[0]"));
        assert!(message("bus 8 7:0", "PCLK=bus[8]").contains("no signal `bus[8]`"));
        assert!(message("", "").contains("no signals"));
    }
}
