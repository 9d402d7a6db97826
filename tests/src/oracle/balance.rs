//! Colour science in floating point: spectra, CIE XYZ and CIELAB, adaptation, estimates of the light.

/// A vector of three.
pub type Vector = [f64; 3];
/// A matrix, row by row.
pub type Matrix = [[f64; 3]; 3];

/// Linear RGB to XYZ, IEC 61966-2-1.
pub const RGB_TO_XYZ: Matrix = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];

/// XYZ to responses, by the name of the space.
#[must_use]
pub fn responses(space: &str) -> Matrix {
    match space {
        "rgb" => inverse(&RGB_TO_XYZ),
        "bradford" => [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]],
        "cat02" => [[0.7328, 0.4296, -0.1624], [-0.7036, 1.6975, 0.0061], [0.003, 0.0136, 0.9834]],
        "cmccat2000" => [[0.7982, 0.3389, -0.1371], [-0.5918, 1.5512, 0.0406], [0.0008, 0.0239, 0.9753]],
        "sharp" => [[1.2694, -0.0988, -0.1706], [-0.8364, 1.8006, 0.0357], [0.0297, -0.0315, 1.0018]],
        "romm" => [[1.346, -0.2556, -0.0511], [-0.5446, 1.5082, 0.0205], [0.0, 0.0, 1.2123]],
        _ => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    }
}

/// Matrix times vector.
#[must_use]
pub fn times(matrix: &Matrix, vector: Vector) -> Vector {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])
}

/// The inverse, by Gauss and Jordan with pivoting.
///
/// # Panics
/// If there is none.
#[must_use]
pub fn inverse(matrix: &Matrix) -> Matrix {
    let (mut left, mut right) = (*matrix, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    for column in 0..3 {
        let pivot = (column..3)
            .max_by(|&a, &b| left[a][column].abs().total_cmp(&left[b][column].abs()))
            .expect("three rows");
        left.swap(column, pivot);
        right.swap(column, pivot);
        let by = left[column][column];
        assert!(by.abs() > 1e-12, "singular");
        left[column] = left[column].map(|value| value / by);
        right[column] = right[column].map(|value| value / by);
        for row in (0..3).filter(|&row| row != column) {
            let factor = left[row][column];
            for at in 0..3 {
                left[row][at] -= factor * left[column][at];
                right[row][at] -= factor * right[column][at];
            }
        }
    }
    right
}

/// A colour under `white` as it would be under `target`, all in XYZ: von Kries in the space of that name.
#[must_use]
pub fn adapt(space: &str, xyz: Vector, white: Vector, target: Vector) -> Vector {
    let matrix = responses(space);
    let [from, to, mut response] = [white, target, xyz].map(|color| times(&matrix, color));
    for at in 0..3 {
        response[at] *= to[at] / from[at];
    }
    times(&inverse(&matrix), response)
}

/// CIE 1931 colour matching functions: the fit of Wyman, Sloan and Shirley, JCGT 2 (2013).
#[must_use]
pub fn matching(nanometers: f64) -> Vector {
    let lobe = |height: f64, center: f64, below: f64, above: f64| {
        let t = (nanometers - center) / if nanometers < center { below } else { above };
        height * (-0.5 * t * t).exp()
    };
    [
        lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2),
        lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
        lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8),
    ]
}

/// CIE standard illuminant A (CIE 15:2018).
#[must_use]
pub fn illuminant_a(nanometers: f64) -> f64 {
    let planck = |at: f64| (1.435e7 / (2848.0 * at)).exp() - 1.0;
    100.0 * (560.0 / nanometers).powi(5) * planck(560.0) / planck(nanometers)
}

/// CIE standard illuminant D65 (CIE 15:2018), every 20 nm from 380 to 780, straight between.
#[must_use]
pub fn illuminant_d65(nanometers: f64) -> f64 {
    const TABLE: [f64; 21] = [
        49.98, 82.75, 93.43, 104.86, 117.81, 115.92, 109.35, 104.79, 104.41, 100.0, 95.79, 90.01, 87.70,
        83.70, 80.21, 78.28, 71.61, 61.60, 75.09, 46.42, 63.38,
    ];
    let at = (nanometers - 380.0) / 20.0;
    let below = (at as usize).min(TABLE.len() - 2);
    TABLE[below] + (at - below as f64) * (TABLE[below + 1] - TABLE[below])
}

/// XYZ of a surface under a light; a perfect white has Y = 1.
#[must_use]
pub fn xyz(light: fn(f64) -> f64, reflectance: impl Fn(f64) -> f64) -> Vector {
    let (mut sum, mut white) = ([0.0; 3], 0.0);
    for step in 0..=80 {
        let nanometers = 380.0 + 5.0 * f64::from(step);
        let matched = matching(nanometers);
        white += light(nanometers) * matched[1];
        for at in 0..3 {
            sum[at] += light(nanometers) * reflectance(nanometers) * matched[at];
        }
    }
    sum.map(|value| value / white)
}

/// CIELAB with respect to a white.
#[must_use]
pub fn lab(xyz: Vector, white: Vector) -> Vector {
    let [x, y, z] = [0, 1, 2].map(|at| {
        let t = xyz[at] / white[at];
        if t > (6.0f64 / 29.0).powi(3) { t.cbrt() } else { t * (29.0f64 / 6.0).powi(2) / 3.0 + 4.0 / 29.0 }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The distance of two colours, as ΔE*ab where they are CIELAB.
#[must_use]
pub fn distance(one: Vector, other: Vector) -> f64 {
    (0..3).map(|at| (one[at] - other[at]).powi(2)).sum::<f64>().sqrt()
}

/// The angle between two lights, in degrees.
#[must_use]
pub fn angle(one: Vector, other: Vector) -> f64 {
    let dot = |a: Vector, b: Vector| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    (dot(one, other) / (dot(one, one) * dot(other, other)).sqrt()).clamp(-1.0, 1.0).acos().to_degrees()
}

/// The mean of a picture.
#[must_use]
pub fn gray_world(pixels: &[Vector]) -> Vector {
    [0, 1, 2].map(|at| pixels.iter().map(|pixel| pixel[at]).sum::<f64>() / pixels.len() as f64)
}

/// For each channel the least value that so many per mille of a picture do not exceed, by sorting.
#[must_use]
pub fn white_patch(pixels: &[Vector], per_mille: usize) -> Vector {
    [0, 1, 2].map(|at| {
        let mut values: Vec<f64> = pixels.iter().map(|pixel| pixel[at]).collect();
        values.sort_by(f64::total_cmp);
        values[(values.len() * per_mille).div_ceil(1000).max(1) - 1]
    })
}

/// The Minkowski mean of a picture's forward differences.
#[must_use]
pub fn gray_edge(pixels: &[Vector], width: usize, power: i32) -> Vector {
    [0, 1, 2].map(|at| {
        let mut sum = 0.0;
        for (index, pixel) in pixels.iter().enumerate() {
            if (index + 1) % width != 0 {
                sum += (pixels[index + 1][at] - pixel[at]).abs().powi(power);
            }
            if let Some(below) = pixels.get(index + width) {
                sum += (below[at] - pixel[at]).abs().powi(power);
            }
        }
        sum.powf(1.0 / f64::from(power))
    })
}
