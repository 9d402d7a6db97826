//! The tokens that are not many: long identifiers, unknown values, wide vectors, sections, and everything wrong.

use super::super::edges::PCLK;
use super::changes::{Machine, Section};
use super::error::Problem;
use super::header::shortened;
use super::ids::{Entry, IdTable};
use super::scan::{is_blank, token_end};

/// What a token does.
pub(super) enum Step {
    /// The machine after it, and where the next token begins.
    Go(Machine, usize),
    /// Time moves on to this.
    Time(u64, usize),
}

/// Where a token went wrong, and what is wrong: nothing, if it is not whole and more of the file is needed.
type Trouble = (usize, Option<Problem>);
type Outcome = Result<Step, Trouble>;

/// The token at `at` and where it ends.
struct Token<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Where the file's bytes end.
    end: usize,
    last: bool,
}

impl<'a> Token<'a> {
    /// The token's text and where it ends; an error if it may go on in the next block.
    fn text(&self) -> Result<(&'a [u8], usize), Trouble> {
        let to = token_end(self.bytes, self.at).min(self.end);
        if to == self.end && !self.last {
            return Err((self.at, None));
        }
        Ok((self.bytes.get(self.at..to).unwrap_or_default(), to))
    }

    fn wrong<T>(&self, problem: Problem) -> Result<T, Trouble> {
        Err((self.at, Some(problem)))
    }
}

/// Whatever the fast loop did not take.
#[cold]
#[inline(never)]
pub(super) fn token(now: Machine, bytes: &[u8], at: usize, end: usize, last: bool, ids: &IdTable) -> Outcome {
    let token = Token { bytes, at, end, last };
    match bytes.get(at).copied().unwrap_or(b'\n') {
        byte if is_blank(byte) => Ok(Step::Go(now, at + 1)),
        _ if now.section == Section::Skipped => skipped(now, &token),
        b'#' => time(now, &token),
        b'$' => keyword(now, &token),
        b'b' | b'B' => vector(now, &token, ids),
        b'r' | b'R' | b's' | b'S' => other_value(now, &token, ids),
        value => scalar(now, &token, value, ids),
    }
}

/// A word inside a section that is not looked at.
fn skipped(mut now: Machine, token: &Token<'_>) -> Outcome {
    let (text, to) = token.text()?;
    if text == b"$end" {
        now.section = Section::Changes;
    }
    Ok(Step::Go(now, to))
}

/// A time of any length, or one that has not moved on.
fn time(now: Machine, token: &Token<'_>) -> Outcome {
    let (text, to) = token.text()?;
    let words = String::from_utf8_lossy(text);
    let number = words.get(1..).filter(|digits| digits.bytes().all(|digit| digit.is_ascii_digit()));
    match number.and_then(|digits| digits.parse::<u64>().ok()) {
        Some(time) if time == now.time => Ok(Step::Go(now, to)),
        Some(time) if time < now.time => token.wrong(Problem::Backwards { from: now.time, to: time }),
        // More than 15 digits, which the fast loop does not take.
        Some(time) => Ok(Step::Time(time, to)),
        None => token.wrong(Problem::Time(shortened(&words))),
    }
}

fn keyword(mut now: Machine, token: &Token<'_>) -> Outcome {
    let (text, to) = token.text()?;
    let standing = |name| Section::Standing(name);
    now.section = match (text, now.section) {
        (b"$end", Section::Standing(name)) => {
            let active = (now.state ^ now.idle) & PCLK != 0;
            let known = now.unknown == 0;
            now.first = (name == "$dumpvars" && active && known).then_some((now.state, now.time));
            // Where the wires stand is no edge.
            now.settled = now.state;
            Section::Changes
        }
        (b"$end", Section::Checkpoint) => Section::Changes,
        (b"$dumpvars", Section::Changes) => standing("$dumpvars"),
        (b"$dumpon", Section::Changes) => standing("$dumpon"),
        (b"$dumpoff", Section::Changes) => standing("$dumpoff"),
        (b"$dumpall", Section::Changes) => Section::Checkpoint,
        (b"$end" | b"$var" | b"$scope" | b"$upscope" | b"$timescale" | b"$enddefinitions", _)
        | (_, Section::Standing(_) | Section::Checkpoint) => {
            return token.wrong(Problem::LateKeyword(shortened(&String::from_utf8_lossy(text))));
        }
        _ => Section::Skipped,
    };
    Ok(Step::Go(now, to))
}

/// What a character says of a bit: known and what, or unknown. Lower and upper case mean the same; `l`, `h` are the weak
/// levels and `u`, `w`, `-` the unknowns of VHDL.
fn bit(value: u8) -> Option<Option<bool>> {
    match value.to_ascii_lowercase() {
        b'0' | b'l' => Some(Some(false)),
        b'1' | b'h' => Some(Some(true)),
        b'x' | b'z' | b'u' | b'w' | b'-' => Some(None),
        _ => None,
    }
}

fn scalar(mut now: Machine, token: &Token<'_>, value: u8, ids: &IdTable) -> Outcome {
    let (text, to) = token.text()?;
    let Some(bit) = bit(value) else {
        return token.wrong(Problem::NotAChange(shortened(&String::from_utf8_lossy(text))));
    };
    let entry = find(token, text.get(1..).unwrap_or_default(), ids)?;
    if !entry.is_scalar() {
        return token.wrong(misfit(
            text.get(..1).unwrap_or_default(),
            text.get(1..).unwrap_or_default(),
            entry,
        ));
    }
    let bits = match bit {
        Some(true) => entry.mask,
        Some(false) => 0,
        None => {
            now.unknown += u64::from(entry.mask != 0);
            entry.mask & now.idle & PCLK
        }
    };
    now.state = now.state & !entry.mask | bits;
    Ok(Step::Go(now, to))
}

/// A vector of any width with any bits. Missing bits at the left are 0, or unknown if the leftmost is: both read as 0.
fn vector(mut now: Machine, token: &Token<'_>, ids: &IdTable) -> Outcome {
    let (text, id, to) = value_and_id(token)?;
    let entry = find(token, id, ids)?;
    let digits = text.get(1..).unwrap_or_default();
    if digits.is_empty() || digits.len() > entry.width() as usize {
        return token.wrong(misfit(text, id, entry));
    }
    if digits.iter().any(|&digit| bit(digit).is_none()) {
        return token.wrong(Problem::NotAChange(shortened(&String::from_utf8_lossy(text))));
    }
    let place = |place: u32| {
        let at = digits.len().checked_sub(1 + place as usize);
        at.and_then(|at| digits.get(at)).map_or(Some(false), |&digit| bit(digit).flatten())
    };
    let scalar = [(0, entry.mask)];
    let taps = if entry.is_scalar() {
        &scalar[..]
    } else {
        ids.vector(entry).map_or(&[][..], |wanted| wanted.taps())
    };
    let mut unknown = false;
    for &(bit, mask) in taps {
        let bits = match place(bit) {
            Some(true) => mask,
            Some(false) => 0,
            None => {
                unknown |= mask != 0;
                mask & now.idle & PCLK
            }
        };
        now.state = now.state & !mask | bits;
    }
    now.unknown += u64::from(unknown);
    Ok(Step::Go(now, to))
}

/// A real number or a text: never a wire.
fn other_value(now: Machine, token: &Token<'_>, ids: &IdTable) -> Outcome {
    let (text, id, to) = value_and_id(token)?;
    let entry = find(token, id, ids)?;
    if entry.is_scalar() || entry.width() > 0 {
        return token.wrong(misfit(text, id, entry));
    }
    Ok(Step::Go(now, to))
}

/// The token, the identifier behind it, and where that ends.
fn value_and_id<'a>(token: &Token<'a>) -> Result<(&'a [u8], &'a [u8], usize), Trouble> {
    let (text, to) = token.text()?;
    let blank = token.bytes.get(to..token.end).unwrap_or_default();
    let at = to + blank.iter().take_while(|&&byte| is_blank(byte)).count();
    let (id, to) = Token { at, ..*token }.text().map_err(|_| (token.at, None))?;
    Ok((text, id, to))
}

fn find(token: &Token<'_>, id: &[u8], ids: &IdTable) -> Result<Entry, Trouble> {
    if id.is_empty() {
        return token.wrong(Problem::NoId);
    }
    match ids.find(id) {
        Some(entry) => Ok(entry),
        None => token.wrong(Problem::UndeclaredId(shortened(&String::from_utf8_lossy(id)))),
    }
}

fn misfit(value: &[u8], id: &[u8], entry: Entry) -> Problem {
    let text = |bytes| shortened(&String::from_utf8_lossy(bytes));
    Problem::ValueWidth { value: text(value), id: text(id), width: entry.width() }
}
