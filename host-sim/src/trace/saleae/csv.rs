//! `digital.csv`: a row whenever a channel changes.

use std::io::{BufRead, BufReader, Read};

use super::super::PlayError;
use super::super::capture::About;
use super::super::levels::{LevelSink, LevelsPlayed};
use super::super::wiring::{Signal, Tap};
use super::TICKS;
use super::error::{SaleaeError, SaleaeProblem};

/// Bytes of a row that are read.
const LINE: u64 = 1 << 16;
/// Channels that are read.
const CHANNELS: usize = 512;
/// Rows between two calls of `progress`.
const ROWS: u64 = 1 << 14;

/// A `digital.csv` whose header is read.
#[derive(Debug)]
pub struct CsvExport<R> {
    file: BufReader<R>,
    names: Vec<String>,
    row: Vec<u8>,
    line: u64,
    bytes: u64,
}

impl<R: Read> CsvExport<R> {
    /// Reads the header.
    ///
    /// # Errors
    /// If the file cannot be read or has none.
    pub fn new(file: R) -> Result<Self, SaleaeError> {
        let file = BufReader::with_capacity(1 << 18, file);
        let mut export = Self { file, names: Vec::new(), row: Vec::new(), line: 0, bytes: 0 };
        if !export.next_row()? {
            return Err(export.wrong(SaleaeProblem::Header));
        }
        let text = String::from_utf8_lossy(export.row.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&export.row))
            .into_owned();
        let mut fields = fields(&text).into_iter();
        if !fields.next().is_some_and(|first| first.to_ascii_lowercase().starts_with("time")) {
            return Err(export.wrong(SaleaeProblem::Header));
        }
        export.names = fields.collect();
        if !(1..=CHANNELS).contains(&export.names.len()) {
            return Err(export.wrong(SaleaeProblem::Channels(export.names.len())));
        }
        Ok(export)
    }

    pub(in super::super) fn about(&self) -> About {
        let signal = |name: &String| Signal { name: name.clone(), width: 1, ..Signal::default() };
        let signals = self.names.iter().map(signal).collect();
        About { signals, ticks_per_second: Some(TICKS), sample_rate: None, sampled: true }
    }

    fn wrong(&self, problem: SaleaeProblem) -> SaleaeError {
        SaleaeError::Text { line: self.line, problem }
    }

    /// The next line that is not empty, without its end; false at the end of the file.
    fn next_row(&mut self) -> Result<bool, SaleaeError> {
        loop {
            self.row.clear();
            let count = (&mut self.file).take(LINE).read_until(b'\n', &mut self.row)?;
            self.line += 1;
            self.bytes += count as u64;
            if count == 0 {
                return Ok(false);
            }
            let length = self.row.trim_ascii_end().len();
            if count as u64 == LINE && length == count {
                return Err(self.wrong(SaleaeProblem::LongLine));
            }
            self.row.truncate(length);
            if length > 0 {
                return Ok(true);
            }
        }
    }

    /// Plays the levels of the taps.
    ///
    /// # Errors
    /// If a row cannot be understood, or the sink's.
    pub fn play<S: LevelSink>(
        mut self,
        wires: &[(Tap, u64)],
        sink: &mut S,
        progress: &mut dyn FnMut(u64),
    ) -> Result<LevelsPlayed, PlayError<SaleaeError, S::Error>> {
        let mut bits = vec![0; self.names.len()];
        for (tap, state) in wires {
            if let Some(column) = bits.get_mut(tap.signal) {
                *column |= state;
            }
        }
        let watched = sink.watched();
        let mut played = LevelsPlayed::default();
        let (mut first, mut before, mut unknown_before) = (None, None, 0_u64);
        while self.next_row().map_err(PlayError::Trace)? {
            let at = self.row.iter().position(|&byte| byte == b',').unwrap_or(self.row.len());
            let (time, levels) = self.row.split_at(at);
            let picoseconds = seconds(time).or_else(|| date_time(time));
            let Some(picoseconds) = picoseconds else {
                return Err(PlayError::Trace(self.wrong(SaleaeProblem::Time(printed(time)))));
            };
            let begin = *first.get_or_insert(picoseconds);
            let time = u64::try_from(picoseconds - begin).ok().filter(|&time| time >= played.end);
            let Some(time) = time else {
                return Err(PlayError::Trace(self.wrong(SaleaeProblem::Backwards(printed(&self.row[..at])))));
            };
            let (mut state, mut unknown, mut column) = (0, 0_u64, 0);
            for value in levels.split(|&byte| byte == b',').skip(1) {
                let bit = bits.get(column).copied().unwrap_or(0);
                column += 1;
                match value {
                    b"0" => {}
                    b"1" => state |= bit,
                    other => match other.trim_ascii() {
                        b"0" => {}
                        b"1" => state |= bit,
                        b"X" | b"x" => unknown |= bit,
                        other => {
                            let problem = SaleaeProblem::Level(printed(other));
                            return Err(PlayError::Trace(self.wrong(problem)));
                        }
                    },
                }
            }
            if column != bits.len() {
                let problem = SaleaeProblem::Columns { found: column, expected: bits.len() };
                return Err(PlayError::Trace(self.wrong(problem)));
            }
            played.unknown += u64::from((unknown & !unknown_before).count_ones());
            unknown_before = unknown;
            played.end = time;
            if before.is_none_or(|before: u64| (before ^ state) & watched != 0) {
                sink.levels(time, state).map_err(PlayError::Sink)?;
                before = Some(state);
            }
            if self.line.is_multiple_of(ROWS) {
                progress(self.bytes);
            }
        }
        progress(self.bytes);
        Ok(played)
    }
}

/// The values of a header, in which a name may stand in quotes.
fn fields(text: &str) -> Vec<String> {
    let (mut found, mut field, mut quoted) = (Vec::new(), String::new(), false);
    for character in text.chars() {
        match character {
            '"' => quoted = !quoted,
            ',' if !quoted => found.push(std::mem::take(&mut field).trim().to_owned()),
            other => field.push(other),
        }
    }
    found.push(field.trim().to_owned());
    found
}

/// Seconds as picoseconds: `-0.000125`.
fn seconds(text: &[u8]) -> Option<i128> {
    let text = text.trim_ascii();
    let (negative, digits) = match text.strip_prefix(b"-") {
        Some(rest) => (true, rest),
        None => (false, text),
    };
    let (mut value, mut places) = (0_i128, None);
    if digits.len() > 30 || !digits.first()?.is_ascii_digit() {
        return None;
    }
    for &digit in digits {
        match digit {
            b'0'..=b'9' if places == Some(12) => {}
            b'0'..=b'9' => {
                value = value * 10 + i128::from(digit - b'0');
                places = places.map(|places| places + 1);
            }
            b'.' if places.is_none() => places = Some(0_u32),
            _ => return None,
        }
    }
    value *= 10_i128.pow(12 - places.unwrap_or(0));
    Some(if negative { -value } else { value })
}

/// An ISO 8601 date and time as picoseconds of the proleptic Gregorian calendar: `2025-03-01T12:00:00.000000125+00:00`. All times of a file have the same
/// offset from UTC, which therefore does not matter.
fn date_time(text: &[u8]) -> Option<i128> {
    let text = std::str::from_utf8(text).ok()?.trim();
    let (date, time) = text.split_once('T')?;
    let number = |text: &str| text.parse::<u32>().ok().map(i128::from);
    let mut parts = date.split('-').map(number);
    let (year, month, day) = (parts.next()??, parts.next()??, parts.next()??);
    let end = time.find(['Z', '+', '-']).unwrap_or(time.len());
    let mut parts = time.get(..end)?.split(':');
    let (hour, minute) = (number(parts.next()?)?, number(parts.next()?)?);
    let second = seconds(parts.next()?.as_bytes())?;
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) || year > 9999 {
        return None;
    }
    // Days since 1 March of the year 0: years begin in March, so that the leap day is the last one.
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let days = 365 * year + year.div_euclid(4) - year.div_euclid(100)
        + year.div_euclid(400)
        + (153 * month + 2) / 5
        + day;
    Some((days * 86_400 + hour * 3_600 + minute * 60) * 1_000_000_000_000 + second)
}

fn printed(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).chars().take(48).flat_map(char::escape_default).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::levels::Levels;
    use super::*;

    fn play(text: &str) -> Result<(Levels, LevelsPlayed), SaleaeError> {
        let export = CsvExport::new(text.as_bytes())?;
        let wires: Vec<(Tap, u64)> =
            (0..export.names.len()).map(|signal| (Tap { signal, bit: 0 }, 1 << signal)).collect();
        let mut levels = Levels::at_most(100);
        match export.play(&wires, &mut levels, &mut |_| ()) {
            Ok(played) => Ok((levels, played)),
            Err(PlayError::Trace(error)) => Err(error),
            Err(PlayError::Sink(_)) => unreachable!("fewer than 100 rows"),
        }
    }

    #[test]
    fn the_example_of_the_vendor_is_read() {
        let text = "Time [s],Channel 0 :),Channel 1 :),Ch2\n0.000000000,0,1,X\n0.125000000,0,0,X\n0.250000000,1,1,X\n\
                    0.500000000,0,0,1\n0.625000000,1,1,0\n0.750000000,0,1,0\n0.875000000,1,0,1\n1.000000000,X,X,X\n";
        let (levels, played) = play(text).unwrap();
        assert_eq!(levels.states, [0b010, 0b000, 0b011, 0b100, 0b011, 0b010, 0b101, 0]);
        assert_eq!(levels.times[1..3], [125_000_000_000, 250_000_000_000]);
        assert_eq!((played.end, played.unknown), (1_000_000_000_000, 4));
        let export = CsvExport::new(text.as_bytes()).unwrap();
        assert_eq!(export.names, ["Channel 0 :)", "Channel 1 :)", "Ch2"]);
    }

    #[test]
    fn other_spellings_of_rows_and_times_are_read() {
        let (levels, _) =
            play("\u{feff}Time[s], \"a, b\", c\r\n-0.5, 0, 1\r\n\r\n-0.25, 1, 1\r\n0.5,0,0").unwrap();
        assert_eq!(levels.times, [0, 250_000_000_000, 1_000_000_000_000]);
        assert_eq!(levels.states, [2, 3, 0]);
        let (levels, _) =
            play("Time [s],a\n2024-02-28T23:59:59.999999999+00:00,0\n2024-03-01T00:00:00Z,1\n").unwrap();
        assert_eq!(levels.times, [0, 86_400_000_000_001_000]);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        for (text, expected) in [
            ("", "line 1: not the header"),
            ("Tempo,a\n", "not the header"),
            ("Time [s]\n0", "0 channels"),
            ("Time [s],a,b\n0.0,0\n", "line 2: 1 values where the header has 2"),
            ("Time [s],a\n0.0,0\n\n0.1,2\n", "line 4: `2` is no level"),
            ("Time [s],a\n0.0,1.25\n", "export digital channels only"),
            ("Time [s],a\nsoon,1\n", "`soon` is neither seconds"),
            ("Time [s],a\n0.2,1\n0.1,0\n", "line 3: time 0.1 comes after"),
            ("Time [s],a\n1e5,1\n", "`1e5` is neither"),
        ] {
            let error = play(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text:?}: {error}");
        }
        let long = format!("Time [s],a\n0.0,{}", "0".repeat(70_000));
        assert!(play(&long).unwrap_err().to_string().contains("64 KiB"));
    }
}
