//! Pixel formats from their standards, in floating point.

/// Luma weights of red and blue.
pub const BT601: (f64, f64) = (0.299, 0.114);
/// Luma weights of red and blue.
pub const BT709: (f64, f64) = (0.2126, 0.0722);

/// Y, Cb, Cr of a colour of 0 to 255 a channel, not yet rounded to codes.
#[must_use]
pub fn yuv([r, g, b]: [f64; 3], (kr, kb): (f64, f64), limited: bool) -> [f64; 3] {
    let (black, luma_span, chroma_span) = if limited { (16.0, 219.0, 224.0) } else { (0.0, 255.0, 255.0) };
    let y = (kr * r + (1.0 - kr - kb) * g + kb * b) / 255.0;
    let cb = (b / 255.0 - y) / (2.0 * (1.0 - kb));
    let cr = (r / 255.0 - y) / (2.0 * (1.0 - kr));
    [black + luma_span * y, 128.0 + chroma_span * cb, 128.0 + chroma_span * cr]
}

/// Red, green, blue of 0 to 255 of codes Y, Cb, Cr, not yet rounded.
#[must_use]
pub fn rgb([y, cb, cr]: [f64; 3], (kr, kb): (f64, f64), limited: bool) -> [f64; 3] {
    let (black, luma_span, chroma_span) = if limited { (16.0, 219.0, 224.0) } else { (0.0, 255.0, 255.0) };
    let (y, cb, cr) = ((y - black) / luma_span, (cb - 128.0) / chroma_span, (cr - 128.0) / chroma_span);
    let r = y + 2.0 * (1.0 - kr) * cr;
    let b = y + 2.0 * (1.0 - kb) * cb;
    let g = (y - kr * r - kb * b) / (1.0 - kr - kb);
    [255.0 * r, 255.0 * g, 255.0 * b]
}
