//! Median cut: split the box with most pixels at the median of its longest side, until there are enough boxes.
//!
//! ```text
//!   ┌──────────────┐     ┌──────┬───────┐     ┌──────┬───────┐
//!   │ ∙∙∙∙   ∙   ∙ │     │ ∙∙∙∙ │∙   ∙  │     │ ∙∙∙∙ │∙   ∙  │     half of the pixels
//!   │  ∙∙     ∙    │ ─►  │  ∙∙  │ ∙     │ ─►  ├──────┤ ∙     │     on either side
//!   └──────────────┘     └──────┴───────┘     └─ ∙∙ ─┴───────┘
//! ```
//!
//! Reference: Heckbert, "Color Image Quantization for Frame Buffer Display", 1982. Boxes are shrunk to their colours
//! before their sides are measured; a box's colour is the mean of its pixels. Sides and medians are in whole levels.
//!
//! Deviation: Heckbert splits all boxes of a generation; here always the one with most pixels, so that any number of
//! colours can be made.
//!
//! Cost: linear in the box for each split, without sorting. Memory: a [`Span`] a colour, and 1 KiB of stack; the list
//! is put in another order.

use super::palette::{Total, WeightedColor, check_colors, check_palette, lent, rounded};
use crate::image::{Error, Rgb};

/// A box: a run of the list of colours.
#[derive(Clone, Copy, Debug, Default)]
pub struct Span {
    start: usize,
    end: usize,
    pixels: u32,
    axis: usize,
    /// Lowest and highest level along that axis.
    low: usize,
    high: usize,
}

impl Span {
    /// A place to be filled.
    pub const EMPTY: Self = Self { start: 0, end: 0, pixels: 0, axis: 0, low: 0, high: 0 };

    fn of(colors: &[WeightedColor], start: usize, end: usize) -> Self {
        let (mut low, mut high, mut pixels) = ([255; 3], [0; 3], 0);
        for color in &colors[start..end] {
            pixels += color.count();
            for axis in 0..3 {
                let level = level(color, axis);
                low[axis] = level.min(low[axis]);
                high[axis] = level.max(high[axis]);
            }
        }
        let side = |axis: usize| high[axis] - low[axis];
        // Of equally long sides, the first.
        let axis = (1..3).fold(0, |longest, axis| if side(axis) > side(longest) { axis } else { longest });
        Self { start, end, pixels, axis, low: low[axis], high: high[axis] }
    }

    /// The highest level that stays in the lower half: at least half of the pixels, but not all levels.
    fn median(&self, colors: &[WeightedColor]) -> usize {
        let mut pixels = [0u32; 256];
        for color in &colors[self.start..self.end] {
            pixels[level(color, self.axis)] += color.count();
        }
        let mut below = 0;
        let reaches_half = |level: &usize| {
            below += pixels[*level];
            below >= self.pixels.div_ceil(2)
        };
        (self.low..self.high).find(reaches_half).unwrap_or(self.high - 1)
    }
}

fn level(color: &WeightedColor, axis: usize) -> usize {
    usize::from(color.quarters()[axis] / 4)
}

/// Moves what `first` says to the front; says how many there are.
fn partition(colors: &mut [WeightedColor], first: impl Fn(&WeightedColor) -> bool) -> usize {
    let mut count = 0;
    for at in 0..colors.len() {
        if first(&colors[at]) {
            colors.swap(at, count);
            count += 1;
        }
    }
    count
}

/// Writes a palette of up to `palette.len()` colours, and says how many: fewer where there are no more colours.
///
/// # Errors
/// If the palette's length is not 1 to 256, there are fewer spans than that, or the colours stand for no pixel or
/// too many.
pub fn median_cut(
    colors: &mut [WeightedColor],
    spans: &mut [Span],
    palette: &mut [Rgb],
) -> Result<usize, Error> {
    check_palette(palette)?;
    check_colors(colors)?;
    let spans = lent("spans", spans, palette.len())?;
    let present = partition(colors, |color| color.count() > 0);
    spans[0] = Span::of(colors, 0, present);
    let mut made = 1;
    while made < spans.len() {
        let mut largest: Option<usize> = None;
        for (index, span) in spans[..made].iter().enumerate().filter(|(_, span)| span.high > span.low) {
            if largest.is_none_or(|largest| span.pixels > spans[largest].pixels) {
                largest = Some(index);
            }
        }
        let Some(index) = largest else { break };
        let span = spans[index];
        let median = span.median(colors);
        let lower = |color: &WeightedColor| level(color, span.axis) <= median;
        let middle = span.start + partition(&mut colors[span.start..span.end], lower);
        spans[index] = Span::of(colors, span.start, middle);
        spans[made] = Span::of(colors, middle, span.end);
        made += 1;
    }
    for (color, span) in palette.iter_mut().zip(&spans[..made]) {
        // No span is empty, so each has a mean.
        *color = Total::of(&colors[span.start..span.end]).mean().map_or(*color, rounded);
    }
    Ok(made)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_of_the_pixels_and_not_of_the_side() {
        let gray = |level| Rgb { r: level, g: level, b: level };
        let mut colors = [(0, 4), (10, 4), (77, 0), (250, 6), (255, 2)]
            .map(|(level, count)| WeightedColor::new(gray(level), count));
        let mut spans = [Span::EMPTY; 5];
        let mut palette = [gray(1); 5];
        assert_eq!(median_cut(&mut colors, &mut spans, &mut palette[..2]), Ok(2));
        assert_eq!(palette[..2], [gray(5), gray(251)]);
        assert_eq!(median_cut(&mut colors, &mut spans, &mut palette), Ok(4));
        assert_eq!(palette, [gray(0), gray(250), gray(10), gray(255), gray(1)]);
    }

    #[test]
    fn bad_parameters_are_refused() {
        let mut colors = [WeightedColor::new(Rgb::default(), 1)];
        let mut palette = [Rgb::default(); 2];
        assert!(median_cut(&mut colors, &mut [Span::EMPTY; 1], &mut palette).is_err());
        assert!(median_cut(&mut [], &mut [Span::EMPTY; 2], &mut palette).is_err());
        assert!(median_cut(&mut colors, &mut [], &mut []).is_err());
    }
}
