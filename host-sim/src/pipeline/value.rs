use std::fmt;

use algos_nostd::clip::Point;
use algos_nostd::image::Rgb;

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Value {
    /// A whole number.
    Integer(i64),
    /// A number in thousandths.
    Decimal(i64),
    /// One of a list of words.
    Word(&'static str),
    /// A colour.
    Color(Rgb),
    /// Colours.
    Colors(Vec<Rgb>),
    /// A place in the picture, or a size.
    Place(Place),
    /// Places.
    Places(Vec<Place>),
    /// Pairs of levels.
    Pairs(Vec<(u8, u8)>),
    /// Numbers in thousandths.
    Numbers(Vec<i64>),
    /// Anything.
    Text(String),
}

/// A distance across or down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Length {
    /// In pixels.
    Pixels(i32),
    /// In hundredths of the picture's width or height.
    Percent(i32),
}

/// A distance across and one down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// From the left.
    pub(super) across: Length,
    /// From the top.
    pub(super) down: Length,
}

impl Length {
    fn of(self, side: usize) -> i64 {
        match self {
            Self::Pixels(pixels) => i64::from(pixels),
            Self::Percent(percent) => (side as i64 * i64::from(percent)).div_euclid(100),
        }
    }

    /// As a coordinate: a percentage from 0 to 100 lies within the picture.
    fn coordinate(self, side: usize) -> i16 {
        let at = match self {
            Self::Percent(0..=100) => self.of(side).min(side as i64 - 1),
            _ => self.of(side),
        };
        at.clamp(i16::MIN.into(), i16::MAX.into()) as i16
    }

    /// As a length of at least one pixel.
    fn extent(self, side: usize) -> usize {
        self.of(side).max(1) as usize
    }
}

impl Place {
    /// The pixel in a picture of that size; it may lie outside.
    pub(super) fn point(self, (width, height): (usize, usize)) -> Point {
        Point::new(self.across.coordinate(width), self.down.coordinate(height))
    }

    /// Width and height, each at least 1, in a picture of that size.
    pub(super) fn extent(self, (width, height): (usize, usize)) -> (usize, usize) {
        (self.across.extent(width), self.down.extent(height))
    }
}

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pixels(pixels) => write!(f, "{pixels}"),
            Self::Percent(percent) => write!(f, "{percent}%"),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.across, self.down)
    }
}

/// A number in thousandths, as people write it.
pub(super) struct Thousandths(pub(super) i64);

impl fmt::Display for Thousandths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.0 < 0 { "-" } else { "" };
        let (whole, rest) = (self.0.unsigned_abs() / 1000, self.0.unsigned_abs() % 1000);
        if rest == 0 {
            return write!(f, "{sign}{whole}");
        }
        let digits = format!("{rest:03}");
        write!(f, "{sign}{whole}.{}", digits.trim_end_matches('0'))
    }
}

/// A colour as `#rrggbb`.
pub(super) struct Hex(pub(super) Rgb);

impl fmt::Display for Hex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0.r, self.0.g, self.0.b)
    }
}

/// Items with `;` between them.
fn list<T: fmt::Display>(f: &mut fmt::Formatter<'_>, items: impl Iterator<Item = T>) -> fmt::Result {
    for (index, item) in items.enumerate() {
        write!(f, "{}{item}", if index > 0 { ";" } else { "" })?;
    }
    Ok(())
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(number) => write!(f, "{number}"),
            Self::Decimal(number) => write!(f, "{}", Thousandths(*number)),
            Self::Word(word) => f.write_str(word),
            Self::Color(color) => write!(f, "{}", Hex(*color)),
            Self::Colors(colors) => list(f, colors.iter().map(|color| Hex(*color))),
            Self::Place(place) => write!(f, "{place}"),
            Self::Places(places) => list(f, places.iter()),
            Self::Pairs(pairs) => list(f, pairs.iter().map(|(from, to)| format!("{from}:{to}"))),
            Self::Numbers(numbers) => list(f, numbers.iter().map(|number| Thousandths(*number))),
            Self::Text(text) => f.write_str(text),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousandths_are_written_short() {
        let written = [0, 1, -1, 1400, 10_000, -2050].map(|number| Thousandths(number).to_string());
        assert_eq!(written, ["0", "0.001", "-0.001", "1.4", "10", "-2.05"]);
    }

    #[test]
    fn percentages_lie_within_the_picture() {
        let at = |percent| Place { across: Length::Percent(percent), down: Length::Pixels(-3) };
        assert_eq!(at(0).point((10, 1)), Point::new(0, -3));
        assert_eq!(at(50).point((10, 1)), Point::new(5, -3));
        assert_eq!(at(100).point((10, 1)), Point::new(9, -3));
        assert_eq!(at(200).point((10, 1)), Point::new(20, -3));
        assert_eq!(at(25).extent((2, 1)), (1, 1));
    }
}
