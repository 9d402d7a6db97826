use std::fmt;

use algos_nostd::image::Rgb;

use super::value::{Length, Place, Thousandths, Value};

/// What a parameter can be.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// A whole number from the first to the last.
    Integer(i64, i64),
    /// One of these whole numbers.
    OneOf(&'static [i64]),
    /// A number from the first to the last, both in thousandths.
    Decimal(i64, i64),
    /// One of these words, each with what it means.
    Word(&'static [(&'static str, &'static str)]),
    /// A colour.
    Color,
    /// Up to so many colours, or none.
    Colors(usize),
    /// Where in the picture.
    Place,
    /// Places, at least and at most so many.
    Places(usize, usize),
    /// A width and a height.
    Size,
    /// Pairs of levels, at least and at most so many.
    Pairs(usize, usize),
    /// Numbers; how many there may be, and the range of each in thousandths.
    Numbers(&'static [usize], i64, i64),
    /// Any text.
    Text,
}

/// Colours that have names.
const COLORS: &[(&str, Rgb)] = &[
    ("black", Rgb { r: 0, g: 0, b: 0 }),
    ("white", Rgb { r: 255, g: 255, b: 255 }),
    ("gray", Rgb { r: 128, g: 128, b: 128 }),
    ("red", Rgb { r: 255, g: 0, b: 0 }),
    ("green", Rgb { r: 0, g: 255, b: 0 }),
    ("blue", Rgb { r: 0, g: 0, b: 255 }),
    ("yellow", Rgb { r: 255, g: 255, b: 0 }),
    ("cyan", Rgb { r: 0, g: 255, b: 255 }),
    ("magenta", Rgb { r: 255, g: 0, b: 255 }),
    ("orange", Rgb { r: 255, g: 128, b: 0 }),
];

/// The farthest that a place may lie, in pixels and in hundredths.
const FARTHEST: i32 = 32_767;
/// The longest side that a picture is scaled to, in pixels.
const LONGEST: i32 = 4096;
/// The most that a picture is scaled by, in hundredths.
const MOST_PERCENT: i32 = 1600;

impl Kind {
    /// The value that a text means, if it means one that is allowed.
    pub(super) fn parse(self, text: &str) -> Option<Value> {
        match self {
            Self::Integer(least, most) => {
                let number = text.parse().ok()?;
                (least..=most).contains(&number).then_some(Value::Integer(number))
            }
            Self::OneOf(numbers) => {
                let number = text.parse().ok()?;
                numbers.contains(&number).then_some(Value::Integer(number))
            }
            Self::Decimal(least, most) => {
                let number = thousandths(text)?;
                (least..=most).contains(&number).then_some(Value::Decimal(number))
            }
            Self::Word(words) => words
                .iter()
                .find(|(word, _)| word.eq_ignore_ascii_case(text))
                .map(|(word, _)| Value::Word(word)),
            Self::Color => color(text).map(Value::Color),
            Self::Colors(_) if text.is_empty() => Some(Value::Colors(Vec::new())),
            Self::Colors(most) => items(text, 1, most, color).map(Value::Colors),
            Self::Place => place(text, -FARTHEST, FARTHEST, FARTHEST).map(Value::Place),
            Self::Places(least, most) => {
                items(text, least, most, |text| place(text, -FARTHEST, FARTHEST, FARTHEST)).map(Value::Places)
            }
            Self::Size => place(text, 1, LONGEST, MOST_PERCENT).map(Value::Place),
            Self::Pairs(least, most) => items(text, least, most, pair).map(Value::Pairs),
            Self::Numbers(counts, least, most) => {
                let number = |text: &str| thousandths(text).filter(|number| (least..=most).contains(number));
                items(text, 1, usize::MAX, number)
                    .filter(|numbers| counts.contains(&numbers.len()))
                    .map(Value::Numbers)
            }
            Self::Text => Some(Value::Text(text.to_owned())),
        }
    }

    /// The words, where the values are words.
    pub(super) fn words(self) -> impl Iterator<Item = &'static str> {
        let words = if let Self::Word(words) = self { words } else { &[] };
        words.iter().map(|(word, _)| *word)
    }
}

/// The values that are right, in words.
impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Integer(least, most) => write!(f, "{least} to {most}"),
            Self::OneOf(numbers) => {
                let numbers: Vec<_> = numbers.iter().map(i64::to_string).collect();
                f.write_str(&numbers.join(", "))
            }
            Self::Decimal(least, most) => write!(f, "{} to {}", Thousandths(least), Thousandths(most)),
            Self::Word(_) => f.write_str(&self.words().collect::<Vec<_>>().join(", ")),
            Self::Color => f.write_str("#rrggbb or a name such as red"),
            Self::Colors(most) => write!(f, "up to {most} colours such as #102030;red"),
            Self::Place => f.write_str("a place such as 50%x50% or 320x240"),
            Self::Places(least, most) => write!(f, "{least} to {most} places such as 0x0;50%x99%"),
            Self::Size => {
                write!(f, "a size such as 50%x50% or 320x240, at most {LONGEST} or {MOST_PERCENT}% a side")
            }
            Self::Pairs(least, most) => write!(f, "{least} to {most} pairs of levels such as 0:0;255:255"),
            Self::Numbers(counts, least, most) => {
                let counts: Vec<_> = counts.iter().map(usize::to_string).collect();
                let (least, most) = (Thousandths(least), Thousandths(most));
                write!(f, "{} numbers from {least} to {most} such as 1;2;1", counts.join(" or "))
            }
            Self::Text => f.write_str("a text"),
        }
    }
}

/// A number with at most three digits behind the point, in thousandths.
fn thousandths(text: &str) -> Option<i64> {
    let (negative, digits) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text),
    };
    let (whole, rest) = digits.split_once('.').unwrap_or((digits, ""));
    let all_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if !all_digits(whole)
        || !all_digits(rest)
        || rest.len() > 3
        || whole.len() > 9
        || digits.trim_matches('.').is_empty()
    {
        return None;
    }
    let number: i64 = format!("0{whole}{rest:0<3}").parse().ok()?;
    Some(if negative { -number } else { number })
}

fn color(text: &str) -> Option<Rgb> {
    if let Some((_, color)) = COLORS.iter().find(|(name, _)| name.eq_ignore_ascii_case(text)) {
        return Some(*color);
    }
    let digits = text.strip_prefix('#').unwrap_or(text);
    if digits.len() != 6 || !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    let number = u32::from_str_radix(digits, 16).ok()?;
    let [_, r, g, b] = number.to_be_bytes();
    Some(Rgb { r, g, b })
}

fn length(text: &str, least: i32, most_pixels: i32, most_percent: i32) -> Option<Length> {
    if let Some(percent) = text.strip_suffix('%') {
        let number = percent.parse().ok()?;
        return (least..=most_percent).contains(&number).then_some(Length::Percent(number));
    }
    let number = text.parse().ok()?;
    (least..=most_pixels).contains(&number).then_some(Length::Pixels(number))
}

fn place(text: &str, least: i32, most_pixels: i32, most_percent: i32) -> Option<Place> {
    let (across, down) = text.split_once('x')?;
    let side = |text: &str| length(text.trim(), least, most_pixels, most_percent);
    Some(Place { across: side(across)?, down: side(down)? })
}

fn pair(text: &str) -> Option<(u8, u8)> {
    let (from, to) = text.split_once(':')?;
    Some((from.trim().parse().ok()?, to.trim().parse().ok()?))
}

fn items<T>(text: &str, least: usize, most: usize, item: impl Fn(&str) -> Option<T>) -> Option<Vec<T>> {
    let items: Option<Vec<T>> = text.split(';').map(|text| item(text.trim())).collect();
    items.filter(|items| (least..=most).contains(&items.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_to_three_digits() {
        for (text, number) in [("1.4", 1400), ("-0.25", -250), ("7", 7000), (".5", 500), ("3.", 3000)] {
            assert_eq!(thousandths(text), Some(number), "{text}");
        }
        for text in ["", "-", ".", "1.2345", "1e3", "+1", "--1", "1.-2", "٣", "9999999999"] {
            assert_eq!(thousandths(text), None, "{text}");
        }
    }

    #[test]
    fn colours_have_names_and_numbers() {
        assert_eq!(color("#fF8000"), color("orange"));
        assert_eq!(color("ff8000"), color("Orange"));
        assert_eq!([color("#ff80"), color("#ff80zz"), color("#+f8000"), color("éé€")], [None; 4]);
    }

    #[test]
    fn what_is_out_of_range_is_refused() {
        assert_eq!(Kind::Integer(1, 3).parse("4"), None);
        assert_eq!(Kind::Decimal(100, 16_000).parse("16.001"), None);
        assert_eq!(Kind::Size.parse("0x10"), None);
        assert_eq!(Kind::Size.parse("10%x1601%"), None);
        assert_eq!(Kind::Numbers(&[9], -1000, 1000).parse("1;2;1"), None);
        assert_eq!(Kind::Places(3, 9).parse("1x1;2x2"), None);
        assert_eq!(Kind::Pairs(2, 9).parse("0:0;255:256"), None);
        assert_eq!(Kind::Colors(2).parse(""), Some(Value::Colors(vec![])));
    }
}
