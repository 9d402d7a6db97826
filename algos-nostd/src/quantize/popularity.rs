//! Popularity: the palette is the colours that most pixels have.
//!
//! ```text
//!   pixels  ▇
//!           ▇     ▅
//!           ▇  ▂  ▅  ▁  ▄       a palette of three: the first, the third and the fifth
//!           ^     ^     ^
//! ```
//!
//! Reference: Heckbert, "Color Image Quantization for Frame Buffer Display", 1982. Simple, and blind to colours that
//! are rare but far from all others; for pictures with few flat colours it is exact.
//!
//! Cost: one selection, linear in the number of colours. Memory: none, but the list is put in another order.

use core::cmp::Reverse;

use super::palette::{WeightedColor, check_colors, check_palette};
use crate::image::{Error, Rgb};

/// Writes the most frequent colours, most frequent first, and says how many: all, where there are fewer.
///
/// Of equally frequent colours, the darker in red, then green, then blue comes first.
///
/// # Errors
/// If the palette's length is not 1 to 256, or the colours stand for no pixel or too many.
pub fn popularity(colors: &mut [WeightedColor], palette: &mut [Rgb]) -> Result<usize, Error> {
    check_palette(palette)?;
    check_colors(colors)?;
    let key = |color: &WeightedColor| (Reverse(color.count()), color.quarters());
    let most = palette.len().min(colors.len());
    if most < colors.len() {
        colors.select_nth_unstable_by_key(most, key);
    }
    let Some(colors) = colors.get_mut(..most) else { return Ok(0) };
    colors.sort_unstable_by_key(key);
    let mut made = 0;
    for (place, color) in palette.iter_mut().zip(colors.iter().take_while(|color| color.count() > 0)) {
        *place = color.rounded();
        made += 1;
    }
    Ok(made)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn most_frequent_first() {
        let gray = |level| Rgb { r: level, g: level, b: level };
        let mut colors = [(5, 1), (1, 7), (9, 0), (4, 7), (2, 3)]
            .map(|(level, count)| WeightedColor::new(gray(level), count));
        let mut palette = [gray(0); 5];
        assert_eq!(popularity(&mut colors, &mut palette[..3]), Ok(3));
        assert_eq!(palette[..3], [gray(1), gray(4), gray(2)]);
        assert_eq!(popularity(&mut colors, &mut palette), Ok(4));
        assert_eq!(palette[3], gray(5));
        assert!(popularity(&mut colors, &mut []).is_err());
        assert!(popularity(&mut [], &mut palette).is_err());
    }
}
