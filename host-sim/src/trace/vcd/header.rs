//! The declarations of a VCD: time unit, scopes, variables.
//!
//! ```text
//! $timescale 1 ps $end
//! $scope module tb $end  $var wire 1 ! PCLK $end  $var wire 8 " D [7:0] $end  $upscope $end
//! $enddefinitions $end
//! ```
//!
//! IEEE 1364-2005 §18.2. Names may be escaped (`\D[3]`), ranges may stand apart or not. Other sections are skipped.
//! Memory is bounded: names and scopes of all variables may take 64 MiB together.

use std::io::{self, Read};

use super::super::sr::size;
use super::super::wiring::Signal;
use super::blocks::Blocks;
use super::error::Problem;

/// Bytes of names, scopes and identifiers that are kept.
const DECLARED_BYTES: usize = 64 << 20;
/// Scopes within scopes.
const SCOPES: usize = 256;

/// What the values of an identifier look like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Bits, at least 1.
    Bits(u32),
    /// A number or text: never a wire.
    Other,
}

/// The declarations. `signals` and `ids` belong together, one a `$var`.
#[derive(Debug, Default)]
pub(super) struct Declarations {
    pub(super) signals: Vec<Signal>,
    pub(super) ids: Vec<(Box<[u8]>, Kind)>,
    /// Femtoseconds of a unit of time, if said.
    pub(super) timescale_fs: Option<u64>,
    /// Samples a second, if sigrok says.
    pub(super) sample_rate: Option<u64>,
    /// Written by sigrok: the samples of an analyser.
    pub(super) sampled: bool,
    scope: Vec<String>,
    bytes: usize,
}

/// Reads up to and with `$enddefinitions $end`.
pub(super) fn read<R: Read>(blocks: &mut Blocks<R>) -> io::Result<Result<Declarations, (usize, Problem)>> {
    let mut found = Declarations::default();
    let mut words: Vec<String> = Vec::new();
    // sigrok-cli puts a line such as `META samplerate: 96000000` before the dump of a raw capture.
    let mut preamble = None;
    loop {
        let (at, keyword) = match next(blocks)? {
            Ok(Some(word)) => word,
            Ok(None) => return Ok(Err((blocks.at, Problem::NoDefinitions))),
            Err(problem) => return Ok(Err(problem)),
        };
        if *preamble.get_or_insert(keyword == "META") && !keyword.starts_with('$') {
            found.sample_rate = found.sample_rate.or_else(|| keyword.parse().ok());
            continue;
        }
        preamble = Some(false);
        if !keyword.starts_with('$') || keyword == "$end" {
            return Ok(Err((at, Problem::NotAKeyword(shortened(&keyword)))));
        }
        let wanted = match keyword.as_str() {
            "$var" | "$scope" => 64,
            "$timescale" => 4,
            // `Acquisition with 11/11 channels at 96 MHz`
            "$comment" | "$version" => 16,
            _ => 0,
        };
        words.clear();
        loop {
            match next(blocks)? {
                Ok(Some((_, word))) if word == "$end" => break,
                Ok(Some((_, word))) if words.len() < wanted => words.push(word),
                Ok(Some(_)) => {}
                Ok(None) => return Ok(Err((blocks.at, Problem::Unclosed(section_name(&keyword))))),
                Err(problem) => return Ok(Err(problem)),
            }
        }
        // The place may have left the block by now; the end of the section is as good.
        let here = blocks.at;
        let result = match keyword.as_str() {
            "$var" => found.variable(&words),
            "$scope" => found.enter(&words),
            "$upscope" => found.scope.pop().map(|_| ()).ok_or(Problem::Scopes),
            "$timescale" => found.timescale(&words),
            "$comment" => {
                found.acquisition(&words);
                Ok(())
            }
            "$version" => {
                found.sampled |= words.iter().any(|word| word.to_ascii_lowercase().contains("sigrok"));
                Ok(())
            }
            "$enddefinitions" => return Ok(Ok(found)),
            "$dumpvars" | "$dumpall" | "$dumpon" | "$dumpoff" => Err(Problem::NoDefinitions),
            _ => Ok(()),
        };
        if let Err(problem) = result {
            return Ok(Err((here, problem)));
        }
    }
}

/// The next word and where it begins in the block.
type Word = Result<Option<(usize, String)>, (usize, Problem)>;

fn next<R: Read>(blocks: &mut Blocks<R>) -> io::Result<Word> {
    Ok(match blocks.token()? {
        Ok(Some((from, to))) => Ok(Some((
            from,
            String::from_utf8_lossy(blocks.bytes().get(from..to).unwrap_or_default()).into_owned(),
        ))),
        Ok(None) => Ok(None),
        Err(problem) => Err((blocks.at, problem)),
    })
}

fn section_name(keyword: &str) -> &'static str {
    ["$var", "$scope", "$upscope", "$timescale", "$comment", "$date", "$version", "$enddefinitions"]
        .into_iter()
        .find(|&name| name == keyword)
        .unwrap_or("a section")
}

impl Declarations {
    /// `wire 8 " D [7:0]`: type, bits, identifier, name, range.
    fn variable(&mut self, words: &[String]) -> Result<(), Problem> {
        let wrong = || Problem::Declaration("$var", shortened(&words.join(" ")));
        let [kind, width, id, name, rest @ ..] = words else { return Err(wrong()) };
        let width: u32 = width.parse().map_err(|_| wrong())?;
        if !id.bytes().all(|byte| byte.is_ascii_graphic()) {
            return Err(wrong());
        }
        let kind = match kind.as_str() {
            "real" | "realtime" | "string" => Kind::Other,
            _ if width == 0 => Kind::Other,
            _ => Kind::Bits(width),
        };
        let (name, range) = name_and_range(name, &rest.concat(), width);
        let scope = self.scope.join(".");
        self.bytes += scope.len() + name.len() + id.len() + size_of::<Signal>() + 64;
        if self.bytes > DECLARED_BYTES {
            return Err(Problem::TooManyDeclarations(DECLARED_BYTES));
        }
        // What is no wire keeps its place, but has no bit that could be taken for one.
        let bits = if matches!(kind, Kind::Bits(_)) { width } else { 0 };
        self.signals.push(Signal { scope, name: name.to_owned(), width: bits, range });
        self.ids.push((id.as_bytes().into(), kind));
        Ok(())
    }

    fn enter(&mut self, words: &[String]) -> Result<(), Problem> {
        let [_, name, ..] = words else {
            return Err(Problem::Declaration("$scope", shortened(&words.join(" "))));
        };
        self.scope.push(unescaped(name).to_owned());
        if self.scope.len() > SCOPES || self.scope.iter().map(String::len).sum::<usize>() > DECLARED_BYTES {
            return Err(Problem::Scopes);
        }
        Ok(())
    }

    /// `Acquisition with 11/11 channels at 96 MHz`, as libsigrok and PulseView write it.
    fn acquisition(&mut self, words: &[String]) {
        if words.first().is_some_and(|word| word == "Acquisition")
            && let Some(at) = words.iter().rposition(|word| word == "at")
        {
            self.sampled = true;
            let rate = words.get(at + 1..).unwrap_or_default().join(" ");
            self.sample_rate = size(&rate).filter(|&rate| rate > 0).or(self.sample_rate);
        }
    }

    fn timescale(&mut self, words: &[String]) -> Result<(), Problem> {
        let text = words.concat();
        let wrong = || Problem::Declaration("$timescale", shortened(&text));
        let unit_at = text.find(|c: char| !c.is_ascii_digit()).ok_or_else(wrong)?;
        let (number, unit) = text.split_at(unit_at);
        let number: u64 = number.parse().map_err(|_| wrong())?;
        let unit = match unit {
            "s" => 1_000_000_000_000_000,
            "ms" => 1_000_000_000_000,
            "us" => 1_000_000_000,
            "ns" => 1_000_000,
            "ps" => 1_000,
            "fs" => 1,
            _ => return Err(wrong()),
        };
        if !(1..=1000).contains(&number) {
            return Err(wrong());
        }
        self.timescale_fs = Some(number * unit);
        Ok(())
    }
}

/// A name without its backslash, and the range behind it, which may be part of the same word.
pub(in super::super) fn name_and_range<'a>(
    word: &'a str,
    apart: &str,
    width: u32,
) -> (&'a str, Option<(u32, u32)>) {
    let name = unescaped(word);
    if let Some(range) = range(apart) {
        return (name, Some(range));
    }
    let joined = name.rfind('[').filter(|&at| at > 0).and_then(|at| {
        let range = range(name.get(at..)?)?;
        let fits = range.0.abs_diff(range.1).checked_add(1) == Some(width);
        fits.then_some((name.get(..at)?, Some(range)))
    });
    joined.unwrap_or((name, None))
}

fn unescaped(name: &str) -> &str {
    name.strip_prefix('\\').unwrap_or(name)
}

/// `[7:0]` or `[3]`.
fn range(text: &str) -> Option<(u32, u32)> {
    let inner = text.strip_prefix('[')?.strip_suffix(']')?;
    let (high, low) = inner.split_once(':').unwrap_or((inner, inner));
    Some((high.trim().parse().ok()?, low.trim().parse().ok()?))
}

/// A text for an error message: what can be printed, and not too much of it.
pub(super) fn shortened(text: &str) -> String {
    let mut short: String = text.chars().take(48).flat_map(char::escape_default).collect();
    if text.chars().nth(48).is_some() {
        short.push('…');
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    fn declared(text: &str) -> Result<Declarations, Problem> {
        read(&mut Blocks::new(text.as_bytes())).unwrap().map_err(|(_, problem)| problem)
    }

    #[test]
    fn every_way_to_write_a_variable() {
        let found = declared(
            "$date today $end $version any $end $comment $var is only a word here $end
             $timescale 100ps $end $attrbegin misc 02 $end
             $scope module tb $end $var wire 1 ! PCLK $end
             $scope module \\cam[0] $end $var reg 8 \" D [7:0] $end $var wire 4 # D[11:8] $end
             $var wire 1 $ D [3] $end $var wire 1 %& \\D[2] $end $var real 64 ' temperature $end $upscope $end
             $var integer 32 ( count $end $upscope $end
             $enddefinitions $end #0",
        )
        .unwrap();
        let labels: Vec<String> =
            found.signals.iter().map(|s| format!("{} {}", s.label(), s.width)).collect();
        let expected = [
            "tb.PCLK 1",
            "tb.cam[0].D 8",
            "tb.cam[0].D 4",
            "tb.cam[0].D[3] 1",
            "tb.cam[0].D[2] 1",
            "tb.cam[0].temperature 0",
            "tb.count 32",
        ];
        assert_eq!(labels, expected);
        assert_eq!(found.signals[2].range, Some((11, 8)));
        assert_eq!(found.timescale_fs, Some(100_000));
        assert_eq!((found.sample_rate, found.sampled), (None, false));
        let sigrok = "META samplerate: 96000000 $version libsigrok 0.5.2 $end $enddefinitions $end";
        assert_eq!(declared(sigrok).unwrap().sample_rate, Some(96_000_000));
        let pulse_view = "$comment Acquisition with 11/11 channels at 1.5 MHz $end $enddefinitions $end";
        let found_there = declared(pulse_view).unwrap();
        assert_eq!((found_there.sample_rate, found_there.sampled), (Some(1_500_000), true));
        assert_eq!(&*found.ids[4].0, b"%&");
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, expected) in [
            ("", "before $enddefinitions"),
            ("$var wire 1 ! PCLK", "inside `$var`"),
            ("$var wire 1 ! $end", "a $var that cannot be understood: `wire 1 !`"),
            ("$var wire x ! A $end", "`wire x ! A`"),
            ("$var wire 1 \u{e9} A $end", "cannot be understood"),
            ("PCLK", "`PCLK` where a $ keyword should be"),
            ("$upscope $end", "do not match"),
            ("$timescale 1 parsec $end", "`1parsec`"),
            ("$timescale 0 ns $end", "`0ns`"),
            ("$timescale 99999999999999999999 ns $end", "$timescale"),
            ("$dumpvars 1! $end", "before $enddefinitions"),
        ] {
            let error = declared(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text:?}: {error}");
        }
        let deep = "$scope module a $end ".repeat(257);
        assert_eq!(declared(&deep).unwrap_err(), Problem::Scopes);
    }
}
