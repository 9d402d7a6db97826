//! Scaling in floating point: areas by integration, and the four nearest.

/// The mean of the area that pixel (`x`, `y`) of the output covers.
#[must_use]
pub fn area(from: &[u8], size: (usize, usize), to: (usize, usize), x: usize, y: usize) -> f64 {
    // Length that [a, a + 1] and the output pixel's span have in common.
    let overlap = |at: usize, out: usize, from: usize, to: usize| {
        let (begin, end) = (out as f64 * from as f64 / to as f64, (out + 1) as f64 * from as f64 / to as f64);
        (end.min(at as f64 + 1.0) - begin.max(at as f64)).max(0.0)
    };
    let (mut sum, mut total) = (0.0, 0.0);
    for line in 0..size.1 {
        for column in 0..size.0 {
            let weight = overlap(column, x, size.0, to.0) * overlap(line, y, size.1, to.1);
            sum += weight * f64::from(from[line * size.0 + column]);
            total += weight;
        }
    }
    sum / total
}

/// The mixture of the four pixels around the center of (`x`, `y`).
#[must_use]
pub fn bilinear(from: &[u8], size: (usize, usize), to: (usize, usize), x: usize, y: usize) -> f64 {
    let position = |out: usize, from: usize, to: usize| {
        ((out as f64 + 0.5) * from as f64 / to as f64 - 0.5).clamp(0.0, from as f64 - 1.0)
    };
    let (column, line) = (position(x, size.0, to.0), position(y, size.1, to.1));
    let pixel =
        |column: usize, line: usize| f64::from(from[line.min(size.1 - 1) * size.0 + column.min(size.0 - 1)]);
    let (left, top) = (column.floor(), line.floor());
    let (fx, fy) = (column - left, line - top);
    let (left, top) = (left as usize, top as usize);
    let upper = pixel(left, top) * (1.0 - fx) + pixel(left + 1, top) * fx;
    let lower = pixel(left, top + 1) * (1.0 - fx) + pixel(left + 1, top + 1) * fx;
    upper * (1.0 - fy) + lower * fy
}
