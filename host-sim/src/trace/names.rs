//! What the wires of a capture are called, and `--map` for those that are called otherwise.
//!
//! Names are compared without case. `HREF`, `LV` and `FV` mean *valid when high*, the inverse of a blanking level; that is
//! reported, see [`polarity`](super::polarity).

use std::fmt;

/// Lines of the widest data bus.
pub const DATA_LINES: usize = 14;

/// What a wire is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// Pixel clock.
    Pclk,
    /// Line sync.
    Hsync,
    /// Frame sync.
    Vsync,
    /// One line of the data bus, 0 to 13.
    Data(u8),
    /// The data bus as a vector.
    Bus,
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pclk => f.write_str("PCLK"),
            Self::Hsync => f.write_str("HSYNC"),
            Self::Vsync => f.write_str("VSYNC"),
            Self::Data(line) => write!(f, "D{line}"),
            Self::Bus => f.write_str("DATA"),
        }
    }
}

/// A name that a role goes by. Those of one role stand in the order of preference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Alias {
    pub(super) name: &'static str,
    pub(super) role: Role,
    /// The wire is high where data is valid.
    pub(super) valid_high: bool,
}

const fn alias(name: &'static str, role: Role, valid_high: bool) -> Alias {
    Alias { name, role, valid_high }
}

/// All names. With a number behind it, a name of the bus is one of its lines.
pub(super) const ALIASES: [Alias; 15] = [
    alias("PCLK", Role::Pclk, false),
    alias("PIXCLK", Role::Pclk, false),
    alias("DCLK", Role::Pclk, false),
    alias("PIXEL_CLK", Role::Pclk, false),
    alias("PCK", Role::Pclk, false),
    alias("HSYNC", Role::Hsync, false),
    alias("HREF", Role::Hsync, true),
    alias("HS", Role::Hsync, false),
    alias("LV", Role::Hsync, true),
    alias("VSYNC", Role::Vsync, false),
    alias("VS", Role::Vsync, false),
    alias("FV", Role::Vsync, true),
    alias("DATA", Role::Bus, false),
    alias("D", Role::Bus, false),
    alias("DOUT", Role::Bus, false),
];

/// The role of a signal of that name, if it is one of the usual ones, and the name's place among [`ALIASES`].
/// `D3`, `D_3` and `D[3]` are lines; `D` alone is the bus.
pub(super) fn classify(name: &str) -> Option<(Role, usize)> {
    let find = |name: &str| ALIASES.iter().position(|alias| alias.name.eq_ignore_ascii_case(name));
    if let Some(rank) = find(name) {
        return ALIASES.get(rank).map(|alias| (alias.role, rank));
    }
    let (base, index) = split_index(name)?;
    let rank = find(base)?;
    let is_line = ALIASES.get(rank)?.role == Role::Bus && (index as usize) < DATA_LINES;
    is_line.then_some((Role::Data(index as u8), rank))
}

/// `D3`, `D_3`, `D[3]` or `D(3)` as `D` and 3.
pub(super) fn split_index(name: &str) -> Option<(&str, u32)> {
    let inner = name.strip_suffix(']').or_else(|| name.strip_suffix(')')).unwrap_or(name);
    let base = inner.trim_end_matches(|c: char| c.is_ascii_digit());
    let index = inner.get(base.len()..)?.parse().ok()?;
    let base = match (inner.len() < name.len(), base.strip_suffix(['[', '('])) {
        (true, bracketed) => bracketed?,
        (false, None) => base.strip_suffix('_').unwrap_or(base),
        (false, Some(_)) => return None,
    };
    (!base.is_empty()).then_some((base.trim_end(), index))
}

/// One entry of a map: a role, by the name that was used for it, and the signal that has it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    pub(super) role: Role,
    pub(super) rank: usize,
    pub(super) signal: String,
}

/// `--map`: which signal of a capture is which wire.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SignalMap {
    pub(super) entries: Vec<Entry>,
}

/// What is wrong with a map.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// An entry without `=`, or with nothing on one side.
    #[error("--map: `{0}` is not WIRE=SIGNAL; write for example --map PCLK=CH0,D0=CH3")]
    Syntax(String),
    /// The left side is no wire of a camera bus.
    #[error(
        "--map: there is no wire `{name}`; did you mean `{nearest}`? (PCLK, HSYNC, VSYNC, D0 … D13, DATA)"
    )]
    Wire {
        /// What was written.
        name: String,
        /// The name most like it.
        nearest: String,
    },
    /// A wire twice.
    #[error("--map: {0} is given twice")]
    Twice(Role),
    /// The right side is no signal of the file.
    #[error("--map: the file has no signal `{name}` for {role}; {}", did_you_mean(.nearest.as_deref(), .signals))]
    Signal {
        /// The wire.
        role: Role,
        /// What was written.
        name: String,
        /// The signal most like it.
        nearest: Option<String>,
        /// The file's signals.
        signals: String,
    },
    /// The signal has more bits than the wire.
    #[error(
        "--map: signal `{name}` has {width} bits and {role} is one wire; write {role}={name}[0] for a bit of it"
    )]
    Width {
        /// The wire.
        role: Role,
        /// The signal.
        name: String,
        /// Its width.
        width: u32,
    },
}

fn did_you_mean(nearest: Option<&str>, signals: &str) -> String {
    match nearest {
        Some(nearest) => format!("did you mean `{nearest}`? It has {signals}"),
        None => format!("it has {signals}"),
    }
}

/// A wire that is needed and not found.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no signal is called {role}{}; name it with --map {role}=SIGNAL. The file has {signals}", other_names(*.role))]
pub struct Missing {
    /// The wire.
    pub role: Role,
    /// The file's signals, as words.
    pub signals: String,
}

fn other_names(role: Role) -> String {
    let names: Vec<&str> =
        ALIASES.iter().filter(|alias| alias.role == role).map(|alias| alias.name).skip(1).collect();
    if names.is_empty() { String::new() } else { format!(" (or {})", names.join(", ")) }
}

impl SignalMap {
    /// Reads `PCLK=CH0,D0=CH3,…`. The left sides are wires by any of their usual names, so `HREF=CH1` also says that CH1 is
    /// valid when high; the right sides are signals: `CH1`, `top.cam.clk`, or a bit of a vector, `bus[3]`.
    ///
    /// # Errors
    /// [`MapError::Syntax`], [`MapError::Wire`] or [`MapError::Twice`].
    pub fn parse(text: &str) -> Result<Self, MapError> {
        let mut entries: Vec<Entry> = Vec::new();
        for item in text.split(',').map(str::trim).filter(|item| !item.is_empty()) {
            let syntax = || MapError::Syntax(item.to_owned());
            let (wire, signal) = item.split_once('=').ok_or_else(syntax)?;
            let (wire, signal) = (wire.trim(), signal.trim());
            if wire.is_empty() || signal.is_empty() {
                return Err(syntax());
            }
            let (role, rank) = classify(wire).ok_or_else(|| MapError::Wire {
                name: wire.to_owned(),
                nearest: nearest(wire, wires()).unwrap_or_default(),
            })?;
            if entries.iter().any(|entry| entry.role == role) {
                return Err(MapError::Twice(role));
            }
            entries.push(Entry { role, rank, signal: signal.to_owned() });
        }
        Ok(Self { entries })
    }

    /// A map of these wires to the signals beside them.
    ///
    /// # Errors
    /// [`MapError::Twice`].
    pub fn of(wires: impl IntoIterator<Item = (Role, String)>) -> Result<Self, MapError> {
        let mut entries: Vec<Entry> = Vec::new();
        for (role, signal) in wires {
            if entries.iter().any(|entry| entry.role == role) {
                return Err(MapError::Twice(role));
            }
            let rank = ALIASES.iter().position(|alias| alias.role == role).unwrap_or_default();
            entries.push(Entry { role, rank, signal });
        }
        Ok(Self { entries })
    }

    pub(super) fn get(&self, role: Role) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.role == role)
    }
}

impl fmt::Display for SignalMap {
    /// As `--map` takes it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, entry) in self.entries.iter().enumerate() {
            let comma = if number > 0 { "," } else { "" };
            let wire = ALIASES.get(entry.rank).filter(|alias| alias.role == entry.role);
            match wire {
                Some(alias) => write!(f, "{comma}{}={}", alias.name, entry.signal)?,
                None => write!(f, "{comma}{}={}", entry.role, entry.signal)?,
            }
        }
        Ok(())
    }
}

fn wires() -> impl Iterator<Item = String> {
    let lines = (0..DATA_LINES).map(|line| format!("D{line}"));
    ALIASES.iter().map(|alias| alias.name.to_owned()).chain(lines)
}

/// Characters of a name that are compared: those of a file may be of any length.
const COMPARED: usize = 40;

/// The name that takes the fewest changes of a character to become `name`, without case.
pub(super) fn nearest(name: &str, names: impl IntoIterator<Item = String>) -> Option<String> {
    let short = |name: &str| name.chars().take(COMPARED).collect::<String>().to_lowercase();
    names.into_iter().min_by_key(|other| distance(&short(name), &short(other)))
}

/// Optimal string alignment: insertions, deletions, changes, and neighbours that are swapped, which is the commonest slip.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    // rows[i][j]: from the first i characters of a to the first j of b.
    let mut rows = vec![(0..=b.len()).collect::<Vec<usize>>()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let change = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = change.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(rows[i - 2][j - 2] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_known_without_case_and_in_any_spelling() {
        let role = |name| classify(name).map(|(role, _)| role);
        for (name, expected) in [
            ("pixclk", Role::Pclk),
            ("Pixel_Clk", Role::Pclk),
            ("href", Role::Hsync),
            ("LV", Role::Hsync),
            ("FV", Role::Vsync),
            ("D0", Role::Data(0)),
            ("d[13]", Role::Data(13)),
            ("Data7", Role::Data(7)),
            ("DATA[7]", Role::Data(7)),
            ("dout_2", Role::Data(2)),
            ("data(2)", Role::Data(2)),
            ("DATA", Role::Bus),
        ] {
            assert_eq!(role(name), Some(expected), "{name}");
        }
        for name in ["", "D14", "D[", "D[]", "[3]", "3", "PCLK2", "HS0", "XD0", "D[3", "D3]"] {
            assert_eq!(role(name), None, "{name}");
        }
    }

    #[test]
    fn maps_are_read_or_refused_with_the_nearest_name() {
        let map = SignalMap::parse("pclk=CH0, href=CH1,D3=bus[3]").unwrap();
        assert_eq!(map.get(Role::Pclk).unwrap().signal, "CH0");
        assert!(ALIASES[map.get(Role::Hsync).unwrap().rank].valid_high);
        assert_eq!(map.get(Role::Data(3)).unwrap().signal, "bus[3]");
        assert_eq!(SignalMap::parse("").unwrap(), SignalMap::default());
        assert_eq!(map.to_string(), "PCLK=CH0,HREF=CH1,D3=bus[3]");
        let message = |text| SignalMap::parse(text).unwrap_err().to_string();
        assert!(message("PLCK=a").contains("did you mean `PCLK`"), "{}", message("PLCK=a"));
        assert!(message("VSNC=a").contains("`VSYNC`"));
        assert!(message("D14=a").contains("`D1`"), "{}", message("D14=a"));
        assert!(message("PCLK").contains("WIRE=SIGNAL"));
        assert!(message("=a").contains("WIRE=SIGNAL"));
        assert!(message("HSYNC=a,HREF=b").contains("HSYNC is given twice"));
    }

    #[test]
    fn distances() {
        for (a, b, expected) in
            [("", "abc", 3), ("abc", "", 3), ("plck", "pclk", 1), ("ab", "xy", 2), ("kitten", "sitting", 3)]
        {
            assert_eq!(distance(a, b), expected);
        }
    }
}
