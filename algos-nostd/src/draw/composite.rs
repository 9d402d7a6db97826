use super::mix::divide_by_255;
use crate::image::{Error, Image, ImageMut};

/// Red, green, blue and alpha of 8 bits each; straight: the colours are not multiplied by alpha.
pub type Rgba = rgb::Rgba<u8>;

/// Red, green and blue already multiplied by alpha, hence none of them above it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(transparent)]
pub struct Premultiplied(Rgba);

impl Premultiplied {
    /// Nothing to see: no opacity, and no colour.
    pub const CLEAR: Self = Self(Rgba { r: 0, g: 0, b: 0, a: 0 });

    /// Multiplies the colours by alpha, rounded to the nearest.
    #[must_use]
    pub fn from_straight(straight: Rgba) -> Self {
        let times_alpha = |color: u8| divide_by_255(u32::from(color) * u32::from(straight.a)) as u8;
        Self(Rgba {
            r: times_alpha(straight.r),
            g: times_alpha(straight.g),
            b: times_alpha(straight.b),
            a: straight.a,
        })
    }

    /// Takes colours that are multiplied already; those above alpha are lowered to it.
    #[must_use]
    pub fn from_multiplied(Rgba { r, g, b, a }: Rgba) -> Self {
        Self(Rgba { r: r.min(a), g: g.min(a), b: b.min(a), a })
    }

    /// The colours as they are stored, multiplied by alpha.
    #[must_use]
    pub const fn multiplied(self) -> Rgba {
        self.0
    }

    /// Divides the colours by alpha, rounded to the nearest; all 0 where alpha is 0. Back with
    /// [`from_straight`](Self::from_straight) the pixel is the same.
    #[must_use]
    pub fn straight(self) -> Rgba {
        let Rgba { r, g, b, a } = self.0;
        let over_alpha = |color: u8| rounded_quotient(u32::from(color) * 255, u32::from(a)) as u8;
        Rgba { r: over_alpha(r), g: over_alpha(g), b: over_alpha(b), a }
    }
}

/// Rounded to the nearest, halves up; 0 for a divisor of 0.
fn rounded_quotient(dividend: u32, divisor: u32) -> u32 {
    (2 * u64::from(dividend) + u64::from(divisor)).checked_div(2 * u64::from(divisor)).unwrap_or(0) as u32
}

/// How a source is laid on a destination: Porter and Duff's twelve operators and the sum.
///
/// ```text
///                       source × F_s   destination × F_d        in the picture below, s is the source,
///  Clear                0              0                        d the destination, each covers half:
///  Source               1              0
///  Destination          0              1                           ┌─────────┐
///  SourceOver           1              1 − α_s                     │ d       │
///  DestinationOver      1 − α_d        1                           │    ┌────┼────┐
///  SourceIn             α_d            0                           │    │both│    │
///  DestinationIn        0              α_s                         └────┼────┘    │
///  SourceOut            1 − α_d        0                                │       s │
///  DestinationOut       0              1 − α_s                          └─────────┘
///  SourceAtop           α_d            1 − α_s
///  DestinationAtop      1 − α_d        α_s
///  Xor                  1 − α_d        1 − α_s
///  Plus                 1              1, at most 1 in all
/// ```
///
/// The result is s·F_s + d·F_d with both products summed exactly and rounded once, to the nearest. Of three layers,
/// [`SourceOver`](Self::SourceOver), [`SourceIn`](Self::SourceIn) and their mirror images are associative but for the
/// rounding: two at most of 255 in any channel, and nothing if all alphas are 0 or 255. [`Plus`](Self::Plus), [`Source`](Self::Source),
/// [`Destination`](Self::Destination) and [`Clear`](Self::Clear) are associative exactly; the others are not associative at all.
///
/// The bound: four roundings of half a unit, of which two are multiplied by an alpha, and half a unit of the
/// inner alpha's, times a colour: below 3, and whole.
///
/// Reference: T. Porter and T. Duff, "Compositing digital images", SIGGRAPH 1984.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operator {
    /// Nothing.
    Clear,
    /// The source alone.
    Source,
    /// The destination alone.
    Destination,
    /// The source, and the destination where it shows through: what is meant by "blending".
    SourceOver,
    /// The destination, and the source where it shows through.
    DestinationOver,
    /// The source where the destination is.
    SourceIn,
    /// The destination where the source is.
    DestinationIn,
    /// The source where the destination is not.
    SourceOut,
    /// The destination where the source is not: an eraser.
    DestinationOut,
    /// The source where the destination is, over the destination.
    SourceAtop,
    /// The destination where the source is, over the source.
    DestinationAtop,
    /// Each where the other one is not.
    Xor,
    /// The sum, at most 255: cross-fades and light.
    Plus,
}

impl Operator {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::Clear,
        Self::Source,
        Self::Destination,
        Self::SourceOver,
        Self::DestinationOver,
        Self::SourceIn,
        Self::DestinationIn,
        Self::SourceOut,
        Self::DestinationOut,
        Self::SourceAtop,
        Self::DestinationAtop,
        Self::Xor,
        Self::Plus,
    ];

    /// The name in small letters with hyphens.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Clear => "clear",
            Self::Source => "source",
            Self::Destination => "destination",
            Self::SourceOver => "source-over",
            Self::DestinationOver => "destination-over",
            Self::SourceIn => "source-in",
            Self::DestinationIn => "destination-in",
            Self::SourceOut => "source-out",
            Self::DestinationOut => "destination-out",
            Self::SourceAtop => "source-atop",
            Self::DestinationAtop => "destination-atop",
            Self::Xor => "xor",
            Self::Plus => "plus",
        }
    }

    /// What source and destination are multiplied by, in 255ths.
    #[inline]
    const fn factors(self, source_alpha: u8, destination_alpha: u8) -> (u32, u32) {
        let (source, destination) = (source_alpha as u32, destination_alpha as u32);
        match self {
            Self::Clear => (0, 0),
            Self::Source => (255, 0),
            Self::Destination => (0, 255),
            Self::SourceOver => (255, 255 - source),
            Self::DestinationOver => (255 - destination, 255),
            Self::SourceIn => (destination, 0),
            Self::DestinationIn => (0, source),
            Self::SourceOut => (255 - destination, 0),
            Self::DestinationOut => (0, 255 - source),
            Self::SourceAtop => (destination, 255 - source),
            Self::DestinationAtop => (255 - destination, source),
            Self::Xor => (255 - destination, 255 - source),
            Self::Plus => (255, 255),
        }
    }

    /// One pixel on another one.
    #[inline]
    #[must_use]
    pub const fn premultiplied(self, source: Premultiplied, destination: Premultiplied) -> Premultiplied {
        let (source, destination) = (source.0, destination.0);
        let (of_source, of_destination) = self.factors(source.a, destination.a);
        Premultiplied(Rgba {
            r: weighed(source.r, of_source, destination.r, of_destination),
            g: weighed(source.g, of_source, destination.g, of_destination),
            b: weighed(source.b, of_source, destination.b, of_destination),
            a: weighed(source.a, of_source, destination.a, of_destination),
        })
    }

    /// One pixel on another one, straight: each colour is the exact quotient, rounded once to the nearest (halves
    /// up), without the loss of multiplying first. Where the resulting alpha is 0 all is 0.
    #[must_use]
    pub fn straight(self, source: Rgba, destination: Rgba) -> Rgba {
        let (of_source, of_destination) = self.factors(source.a, destination.a);
        let (source_part, destination_part) =
            (u32::from(source.a) * of_source, u32::from(destination.a) * of_destination);
        // In 255² parts; only `Plus` can pass the whole.
        let alpha = (source_part + destination_part).min(255 * 255);
        let a = divide_by_255(alpha) as u8;
        if a == 0 {
            return Rgba::default();
        }
        let color = |source: u8, destination: u8| {
            let sum = u32::from(source) * source_part + u32::from(destination) * destination_part;
            rounded_quotient(sum, alpha).min(255) as u8
        };
        Rgba {
            r: color(source.r, destination.r),
            g: color(source.g, destination.g),
            b: color(source.b, destination.b),
            a,
        }
    }
}

/// `a·of_a + b·of_b` in 255ths, rounded to the nearest, at most 255.
#[inline]
const fn weighed(a: u8, of_a: u32, b: u8, of_b: u32) -> u8 {
    let sum = a as u32 * of_a + b as u32 * of_b;
    // Above 255² only for `Plus`, whose sum is cut off there.
    divide_by_255(if sum > 255 * 255 { 255 * 255 } else { sum }) as u8
}

/// Lays a premultiplied picture on another one of the same size.
///
/// # Errors
/// [`Error::SizeMismatch`]; the destination is then not touched.
pub fn composite(
    operator: Operator,
    source: Image<'_, Premultiplied>,
    destination: &mut ImageMut<'_, Premultiplied>,
) -> Result<(), Error> {
    by_pixel(source, destination, |source, destination| operator.premultiplied(source, destination))
}

/// Lays a straight picture on another one of the same size.
///
/// # Errors
/// [`Error::SizeMismatch`]; the destination is then not touched.
pub fn composite_straight(
    operator: Operator,
    source: Image<'_, Rgba>,
    destination: &mut ImageMut<'_, Rgba>,
) -> Result<(), Error> {
    by_pixel(source, destination, |source, destination| operator.straight(source, destination))
}

#[inline]
fn by_pixel<P: Copy>(
    source: Image<'_, P>,
    destination: &mut ImageMut<'_, P>,
    laid: impl Fn(P, P) -> P,
) -> Result<(), Error> {
    let expected = (destination.width(), destination.height());
    let got = (source.width(), source.height());
    if expected != got {
        return Err(Error::SizeMismatch { expected, got });
    }
    for (row, source_row) in destination.rows_mut().zip(source.rows()) {
        for (pixel, &source) in row.iter_mut().zip(source_row) {
            *pixel = laid(source, *pixel);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiplying_and_dividing_are_inverse() {
        for a in 0..=255 {
            for color in 0..=a {
                let pixel = Premultiplied::from_multiplied(Rgba { r: color, g: 0, b: a, a });
                assert_eq!(Premultiplied::from_straight(pixel.straight()), pixel);
            }
        }
    }

    #[test]
    fn opaque_shapes_are_set_operations() {
        let (s, d) = (Rgba { r: 1, g: 2, b: 3, a: 255 }, Rgba { r: 4, g: 5, b: 6, a: 255 });
        let none = Rgba::default();
        // For each operator: source on destination, source on nothing, nothing on destination.
        let expected = [
            (Operator::Clear, [none, none, none]),
            (Operator::Source, [s, s, none]),
            (Operator::Destination, [d, none, d]),
            (Operator::SourceOver, [s, s, d]),
            (Operator::DestinationOver, [d, s, d]),
            (Operator::SourceIn, [s, none, none]),
            (Operator::DestinationIn, [d, none, none]),
            (Operator::SourceOut, [none, s, none]),
            (Operator::DestinationOut, [none, none, d]),
            (Operator::SourceAtop, [s, none, d]),
            (Operator::DestinationAtop, [d, s, none]),
            (Operator::Xor, [none, s, d]),
            (Operator::Plus, [Rgba { r: 5, g: 7, b: 9, a: 255 }, s, d]),
        ];
        for (operator, results) in expected {
            for ((source, destination), result) in [(s, d), (s, none), (none, d)].into_iter().zip(results) {
                assert_eq!(operator.straight(source, destination), result, "{operator:?}");
                let multiplied = Premultiplied::from_straight;
                let made = operator.premultiplied(multiplied(source), multiplied(destination));
                assert_eq!(made.straight(), result, "{operator:?}");
            }
        }
    }

    #[test]
    fn sizes_must_match() {
        let source = [Premultiplied::default(); 2];
        let mut destination = source;
        let mut view = ImageMut::new(&mut destination, 1, 2).unwrap();
        let error = Error::SizeMismatch { expected: (1, 2), got: (2, 1) };
        let source = Image::new(&source, 2, 1).unwrap();
        assert_eq!(composite(Operator::Xor, source, &mut view), Err(error));
    }
}
