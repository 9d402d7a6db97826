use algos_nostd::pixel::bayer::{BayerOrder, Channel};
use rgb::RGB8;

/// Colours of a mosaic of 8-bit samples, one line of pixels to each of `rows`.
///
/// Each pixel keeps its own sample and takes the colours it lacks from the block of 2 × 2 around it.
pub(super) fn demosaic(samples: &[u8], order: BayerOrder, rows: &mut [&mut [RGB8]]) {
    let height = rows.len();
    for (y, row) in rows.iter_mut().enumerate() {
        let width = row.len();
        // At the far edges the block lies before the pixel; a side of one pixel has one filter only.
        let (near, far) = (x_pair(y, height), width);
        for (x, pixel) in row.iter_mut().enumerate() {
            let across = x_pair(x, far);
            let sample = |x: usize, y: usize| samples.get(y * width + x).copied().unwrap_or(0);
            let mut colours = [None; 3];
            for (x, y) in [(x, y), (across, y), (x, near), (across, near)] {
                let slot = match order.channel(x, y) {
                    Channel::Red => 0,
                    Channel::Green => 1,
                    Channel::Blue => 2,
                };
                colours[slot].get_or_insert(sample(x, y));
            }
            let own = sample(x, y);
            *pixel = RGB8::from(colours.map(|colour| colour.unwrap_or(own)));
        }
    }
}

/// The other place of a pair: the next one, or at the end the one before.
fn x_pair(at: usize, length: usize) -> usize {
    if at + 1 < length { at + 1 } else { at.saturating_sub(1) }
}
