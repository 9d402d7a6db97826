//! How usual a frame's size is.
//!
//! A line of 1,920 samples and 480 lines is VGA in 24 bits a pixel, 960 × 480 in 16 and 1,920 × 480 in 8: only the
//! first is a size that sensors have. Sizes are those of the data sheets of common sensors (OV7670, OV2640, OV5640,
//! MT9V034, MT9M114, AR0130, HM01B0, GC0308).

/// Sizes that sensors have.
const SIZES: [(u32, u32); 30] = [
    (88, 72),
    (96, 96),
    (128, 96),
    (128, 128),
    (160, 120),
    (160, 160),
    (176, 144),
    (240, 176),
    (240, 240),
    (320, 200),
    (320, 240),
    (324, 244),
    (352, 288),
    (400, 296),
    (400, 400),
    (480, 272),
    (480, 320),
    (640, 400),
    (640, 480),
    (648, 488),
    (720, 480),
    (720, 576),
    (752, 480),
    (800, 480),
    (800, 600),
    (1024, 768),
    (1280, 720),
    (1280, 960),
    (1280, 1024),
    (1600, 1200),
];

/// Larger sizes, whose ratio says enough: 4:3, 5:4, 16:9, 16:10, 3:2, 1:1.
const RATIOS: [(u64, u64); 6] = [(4, 3), (5, 4), (16, 9), (8, 5), (3, 2), (1, 1)];

/// How usual, of 1000.
#[must_use]
pub(super) fn usual(width: u32, height: u32) -> u64 {
    if SIZES.contains(&(width, height)) {
        return 1000;
    }
    let (w, h) = (u64::from(width), u64::from(height));
    if w == 0 || h == 0 {
        return 1;
    }
    // Within a hundredth of a ratio, for frames with a few lines or columns more.
    let near = |(a, b): (u64, u64)| (w * b).abs_diff(h * a) * 100 <= h * a;
    if RATIOS.into_iter().any(near) {
        400
    } else if w >= h && w <= 3 * h {
        100
    } else {
        // Upright, or a strip.
        4
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_data_sheets_have_is_usual() {
        assert_eq!(
            [(640, 480), (324, 244), (1920, 1080), (404, 300)].map(|(w, h)| usual(w, h)),
            [1000, 1000, 400, 400]
        );
        assert_eq!([(960, 480), (1920, 480), (320, 480), (0, 0)].map(|(w, h)| usual(w, h)), [100, 4, 4, 1]);
    }
}
