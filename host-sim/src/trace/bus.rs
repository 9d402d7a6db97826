//! The data bus among the signals of a capture.
//!
//! ```text
//! D0 … D7        eight signals               D [7:0]                 one vector
//! D [7:4] D [3:0] slices, put together       D [9:2] alone           eight lines from D0 on
//! ```
//!
//! A bus is taken from one scope under one name: the one with at least eight lines, the shallowest, the more usual name.

use std::collections::BTreeMap;

use super::names::{DATA_LINES, Missing, Role};
use super::wiring::{Signal, Tap, Wanted, WiringError, find, listed, mapped, unknown};

/// A data bus in the making: the lines of one name in one scope.
#[derive(Debug)]
struct Bus {
    lines: [Option<Tap>; DATA_LINES],
    signals: usize,
    vector: Option<(usize, u32)>,
    depth: usize,
    order: usize,
}

impl Bus {
    fn new(depth: usize, order: usize) -> Self {
        Self { lines: [None; DATA_LINES], signals: 0, vector: None, depth, order }
    }

    fn add(&mut self, index: usize, signal: &Signal, first_line: u32) {
        self.signals += 1;
        if signal.width > 1 {
            self.vector = Some((index, signal.width));
        }
        for bit in 0..signal.width.min(DATA_LINES as u32) {
            if let Some(line) = self.lines.get_mut((first_line + bit) as usize) {
                line.get_or_insert(Tap { signal: index, bit });
            }
        }
    }

    /// The lines, D0 first, as far as there is no gap. A vector that is alone starts at D0 however it is numbered: sensors of 10
    /// bits are often wired by D[9:2].
    fn lines(&self) -> Vec<Tap> {
        if let (1, Some((signal, width))) = (self.signals, self.vector) {
            return (0..width.min(DATA_LINES as u32)).map(|bit| Tap { signal, bit }).collect();
        }
        self.lines.iter().map_while(|line| *line).collect()
    }
}

/// The data lines of the bus, D0 first: 8, 10, 12 or 14.
pub(super) fn lines(signals: &[Signal], wanted: &Wanted) -> Result<Vec<Tap>, WiringError> {
    let mut lines = match wanted.map.get(Role::Bus) {
        Some(entry) => mapped_bus(signals, &entry.signal)?,
        None => named_bus(signals),
    };
    // Lines of the map replace those found by name, and may fill up to any number.
    let mut all: Vec<Option<Tap>> = lines.iter().copied().map(Some).collect();
    all.resize(DATA_LINES, None);
    for (line, slot) in all.iter_mut().enumerate() {
        let role = Role::Data(line as u8);
        if let Some(entry) = wanted.map.get(role) {
            *slot = Some(mapped(signals, role, &entry.signal)?);
        }
    }
    lines = all.into_iter().map_while(|line| line).collect();
    let bits = match wanted.bus_bits {
        Some(bits) => usize::from(bits),
        None => [14, 12, 10].into_iter().find(|&bits| bits <= lines.len()).unwrap_or(8),
    };
    if lines.len() < bits {
        return Err(Missing { role: Role::Data(lines.len() as u8), signals: listed(signals) }.into());
    }
    lines.truncate(bits);
    Ok(lines)
}

/// The bus that its names show.
fn named_bus(signals: &[Signal]) -> Vec<Tap> {
    let mut buses: BTreeMap<(&str, usize), Bus> = BTreeMap::new();
    for (index, signal) in signals.iter().enumerate() {
        let Some((role, rank)) = signal.role() else { continue };
        let first_line = match (role, signal.range) {
            (Role::Data(line), _) => u32::from(line),
            (Role::Bus, Some((high, low))) => high.min(low),
            (Role::Bus, None) => 0,
            _ => continue,
        };
        let bus = buses.entry((&signal.scope, rank)).or_insert_with(|| Bus::new(signal.depth(), rank));
        bus.add(index, signal, first_line);
    }
    let lines = buses.values().map(|bus| (bus.lines(), bus.depth, bus.order));
    let widest = lines.min_by_key(|(lines, depth, order)| (usize::MAX - lines.len().min(8), *depth, *order));
    widest.map(|(lines, ..)| lines).unwrap_or_default()
}

/// The bus that a map names: a vector, or signals of that name with numbers.
fn mapped_bus(signals: &[Signal], name: &str) -> Result<Vec<Tap>, WiringError> {
    if let Some(index) = find(signals, name) {
        let width = signals.get(index).map_or(0, |signal| signal.width);
        if width > 1 {
            return Ok((0..width.min(DATA_LINES as u32)).map(|bit| Tap { signal: index, bit }).collect());
        }
    }
    let numbered = |line: usize| {
        let spellings = [format!("{name}{line}"), format!("{name}[{line}]"), format!("{name}_{line}")];
        spellings.iter().find_map(|spelling| find(signals, spelling)).map(|signal| Tap { signal, bit: 0 })
    };
    let lines: Vec<Tap> = (0..DATA_LINES).map_while(numbered).collect();
    if lines.is_empty() { Err(unknown(signals, Role::Bus, name).into()) } else { Ok(lines) }
}
