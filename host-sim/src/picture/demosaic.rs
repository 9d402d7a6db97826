use algos_nostd::color::demosaic::bilinear::{self, Bilinear};
use algos_nostd::lines::LineFilter as _;
use algos_nostd::pixel::BitDepth;
use algos_nostd::pixel::bayer::BayerOrder;
use rgb::RGB8;

/// Colours of a mosaic of 8-bit samples, one line of pixels to each of `rows`: bilinear, as on the device.
///
/// Lines of a single pixel have nothing to interpolate from: they become gray.
pub(crate) fn demosaic(samples: &[u8], order: BayerOrder, rows: &mut [&mut [RGB8]]) {
    let width = rows.first().map_or(0, |row| row.len());
    let (mut window, mut line) = (vec![0; bilinear::window(width)], vec![RGB8::default(); width]);
    let Ok(mut filter) = Bilinear::new(order, BitDepth::Bits8, &mut window, &mut line) else {
        for (row, &sample) in rows.iter_mut().zip(samples) {
            row.fill(RGB8::new(sample, sample, sample));
        }
        return;
    };
    let mut rows = rows.iter_mut();
    let mut sink = |line: &[RGB8]| {
        if let Some(row) = rows.next() {
            row.copy_from_slice(line);
        }
    };
    for line in samples.chunks(width.max(1)) {
        // Refused would be lines of another length, which there are none of.
        let _ = filter.push(line, &mut sink);
    }
    filter.finish(&mut sink);
}
