//! Quantization by its definitions: lists, sorting, floats, and a look at every colour for every pixel.

use std::collections::BTreeMap;

/// Red, green and blue, in levels.
pub type Color = [u8; 3];

/// A colour and its pixels.
pub type Weighted = (Color, u32);

/// Squared distance of two colours.
#[must_use]
pub fn squared_distance(a: Color, b: Color) -> u32 {
    (0..3).map(|channel| u32::from(a[channel].abs_diff(b[channel])).pow(2)).sum()
}

/// Index of the nearest palette colour; of equals, the first.
#[must_use]
pub fn nearest(palette: &[Color], color: Color) -> usize {
    (0..palette.len())
        .min_by_key(|index| squared_distance(palette[*index], color))
        .expect("a palette has colours")
}

/// Squared error of a list of colours under a palette.
#[must_use]
pub fn squared_error(colors: &[Weighted], palette: &[Color]) -> u64 {
    let error = |&(color, count): &Weighted| {
        u64::from(squared_distance(palette[nearest(palette, color)], color)) * u64::from(count)
    };
    colors.iter().map(error).sum()
}

/// Mean of weighted colours, unrounded.
#[must_use]
pub fn mean(colors: &[Weighted]) -> [f64; 3] {
    let count: f64 = colors.iter().map(|(_, count)| f64::from(*count)).sum();
    [0, 1, 2].map(|channel| {
        colors.iter().map(|(color, count)| f64::from(color[channel]) * f64::from(*count)).sum::<f64>() / count
    })
}

/// Squared error of a list of colours about its own mean.
#[must_use]
pub fn variance(colors: &[Weighted]) -> f64 {
    let mean = mean(colors);
    let square = |color: &Color| (0..3).map(|c| (f64::from(color[c]) - mean[c]).powi(2)).sum::<f64>();
    colors.iter().map(|(color, count)| square(color) * f64::from(*count)).sum()
}

/// Floyd–Steinberg, serpentine, on a whole frame of sixteenths: the indices.
#[must_use]
pub fn floyd_steinberg(pixels: &[Color], width: usize, palette: &[Color]) -> Vec<u8> {
    let height = pixels.len() / width;
    let mut came = vec![[0i32; 3]; pixels.len()];
    let mut indices = vec![0; pixels.len()];
    for y in 0..height {
        let ahead: isize = if y % 2 == 0 { 1 } else { -1 };
        for step in 0..width {
            let x = if ahead > 0 { step } else { width - 1 - step };
            let at = y * width + x;
            let wanted: Color = [0, 1, 2].map(|channel| {
                let rounded = (f64::from(came[at][channel]) / 16.0 + 0.5).floor() as i32;
                (i32::from(pixels[at][channel]) + rounded).clamp(0, 255) as u8
            });
            let index = nearest(palette, wanted);
            indices[at] = index as u8;
            for (dx, dy, share) in [(ahead, 0, 7), (-ahead, 1, 3), (0, 1, 5), (ahead, 1, 1)] {
                let Some(x) = x.checked_add_signed(dx).filter(|x| *x < width) else { continue };
                if y + dy < height {
                    for channel in 0..3 {
                        let error = i32::from(wanted[channel]) - i32::from(palette[index][channel]);
                        came[(y + dy) * width + x][channel] += share * error;
                    }
                }
            }
        }
    }
    indices
}

/// Median cut with sorted lists: the boxes' means, unrounded, in the order of their making.
#[must_use]
pub fn median_cut(colors: &[Weighted], most: usize) -> Vec<[f64; 3]> {
    let pixels = |list: &[Weighted]| list.iter().map(|(_, count)| u64::from(*count)).sum::<u64>();
    let side = |list: &[Weighted], axis: usize| {
        let levels = || list.iter().map(|(color, _)| color[axis]);
        levels().max().unwrap_or(0) - levels().min().unwrap_or(0)
    };
    let longest = |list: &[Weighted]| (0..3).rev().max_by_key(|axis| side(list, *axis)).expect("three axes");
    let mut boxes = vec![colors.iter().copied().filter(|(_, count)| *count > 0).collect::<Vec<_>>()];
    while boxes.len() < most {
        let splittable = |index: &usize| side(&boxes[*index], longest(&boxes[*index])) > 0;
        let Some(index) =
            (0..boxes.len()).rev().filter(splittable).max_by_key(|index| pixels(&boxes[*index]))
        else {
            break;
        };
        let mut list = boxes[index].clone();
        let axis = longest(&list);
        list.sort_by_key(|(color, _)| color[axis]);
        let highest = list.last().expect("boxes are not empty").0[axis];
        // Cut above the first level that takes the lower side to half of the pixels, or below the highest level.
        let half = |level: u8| {
            2 * pixels(&list.iter().copied().filter(|(c, _)| c[axis] <= level).collect::<Vec<_>>())
        };
        let median =
            (list[0].0[axis]..highest).find(|level| half(*level) >= pixels(&list)).unwrap_or(highest - 1);
        let (lower, upper) = list.into_iter().partition(|(color, _)| color[axis] <= median);
        boxes[index] = lower;
        boxes.push(upper);
    }
    boxes.iter().map(|list| mean(list)).collect()
}

/// Wu's greedy bipartition on cells of `2^bits` a side, by trying every cut of every box: the squared error left.
#[must_use]
pub fn wu_error(colors: &[Weighted], bits: u32, most: usize) -> f64 {
    let cell = |color: &Color, axis: usize| color[axis] >> (8 - bits);
    let mut boxes = vec![colors.to_vec()];
    while boxes.len() < most {
        let mut best = (1e-9, None);
        for (index, list) in boxes.iter().enumerate() {
            for axis in 0..3 {
                for plane in 1..1u16 << bits {
                    let below = |(color, _): &Weighted| u16::from(cell(color, axis)) < plane;
                    let (first, second): (Vec<_>, Vec<_>) = list.iter().copied().partition(below);
                    if !first.is_empty() && !second.is_empty() {
                        let gain = variance(list) - variance(&first) - variance(&second);
                        if gain > best.0 {
                            best = (gain, Some((index, first, second)));
                        }
                    }
                }
            }
        }
        let (_, Some((index, first, second))) = best else { break };
        boxes[index] = first;
        boxes.push(second);
    }
    boxes.iter().map(|list| variance(list)).sum()
}

/// One iteration of Lloyd's: the means of what is nearest to each colour, unrounded.
#[must_use]
pub fn kmeans_step(colors: &[Weighted], palette: &[Color]) -> Vec<[f64; 3]> {
    let mut members = vec![Vec::new(); palette.len()];
    colors.iter().for_each(|&color| members[nearest(palette, color.0)].push(color));
    let place = |(members, color): (&Vec<Weighted>, &Color)| {
        if members.is_empty() { color.map(f64::from) } else { mean(members) }
    };
    members.iter().zip(palette).map(place).collect()
}

/// The octree as a map from cubes (level and top bits) to what is in them: the leaves' means, unordered.
#[must_use]
pub fn octree(pixels: &[Color], most: usize, depth: u32) -> Vec<[f64; 3]> {
    struct Cube {
        leaf: bool,
        born: usize,
        members: Vec<Weighted>,
    }
    let top = |color: Color, level: u32| color.map(|channel| u16::from(channel) >> (8 - level));
    let mut cubes: BTreeMap<(u32, [u16; 3]), Cube> = BTreeMap::new();
    let mut born = 0;
    for &pixel in pixels {
        for level in 0..=depth {
            born += 1;
            let new = Cube { leaf: level == depth, born, members: Vec::new() };
            let cube = cubes.entry((level, top(pixel, level))).or_insert(new);
            cube.members.push((pixel, 1));
            if cube.leaf {
                break;
            }
        }
        while cubes.values().filter(|cube| cube.leaf).count() > most {
            let inner = cubes.iter().filter(|(_, cube)| !cube.leaf);
            // The deepest; of these the one with fewest pixels; of these the youngest.
            let key = inner
                .max_by_key(|((level, _), cube)| (*level, usize::MAX - cube.members.len(), cube.born))
                .map(|(key, _)| *key)
                .expect("there are too many leaves");
            cubes.retain(|(level, code), _| *level != key.0 + 1 || code.map(|bits| bits >> 1) != key.1);
            cubes.get_mut(&key).expect("it is there").leaf = true;
        }
    }
    cubes.values().filter(|cube| cube.leaf).map(|cube| mean(&cube.members)).collect()
}

/// Bayer's matrix by its recursion, ranks from 0.
#[must_use]
pub fn bayer(side: usize) -> Vec<Vec<u32>> {
    if side == 1 {
        return vec![vec![0]];
    }
    let quarter = bayer(side / 2);
    let add = [[0, 2], [3, 1]];
    let half = side / 2;
    (0..side)
        .map(|y| (0..side).map(|x| 4 * quarter[y % half][x % half] + add[y / half][x / half]).collect())
        .collect()
}

/// Void and cluster (Ulichney, "The void-and-cluster method for dither array generation", 1993): the rank of each
/// cell of a square tile of blue noise. Gaussian energy with σ = 1.5, all in integers, so the tile is the same
/// everywhere.
#[must_use]
pub fn void_and_cluster(side: usize) -> Vec<u16> {
    let cells = side * side;
    // exp(−1 / (2 · 1.5²)) in 2^-32; its powers are the energies of squared distances.
    const RATIO: u64 = 3_439_140_958;
    let energy: Vec<u64> =
        std::iter::successors(Some(1u64 << 32), |e| Some((e * RATIO) >> 32)).take(2 * cells).collect();
    let around = |cell: usize, other: usize| {
        let torus = |a: usize, b: usize| a.abs_diff(b).min(side - a.abs_diff(b));
        energy[torus(cell % side, other % side).pow(2) + torus(cell / side, other / side).pow(2)]
    };
    let total = |pattern: &[bool]| -> Vec<u64> {
        let ones: Vec<usize> = (0..cells).filter(|cell| pattern[*cell]).collect();
        (0..cells).map(|cell| ones.iter().map(|one| around(cell, *one)).sum()).collect()
    };
    let tightest = |pattern: &[bool], sum: &[u64]| {
        (0..cells).filter(|cell| pattern[*cell]).rev().max_by_key(|cell| sum[*cell]).expect("there are ones")
    };
    let emptiest = |pattern: &[bool], sum: &[u64]| {
        (0..cells).filter(|cell| !pattern[*cell]).min_by_key(|cell| sum[*cell]).expect("there are zeros")
    };
    let set = |pattern: &mut [bool], sum: &mut [u64], cell: usize, one: bool| {
        pattern[cell] = one;
        for (other, sum) in sum.iter_mut().enumerate() {
            let energy = around(cell, other);
            *sum = if one { *sum + energy } else { *sum - energy };
        }
    };
    // A tenth of ones anywhere (a linear congruential generator), then the tightest moved to the emptiest place.
    let mut pattern = vec![false; cells];
    let (mut random, mut ones) = (1u32, 0);
    while ones < cells / 10 {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let cell = (random >> 8) as usize % cells;
        ones += usize::from(!std::mem::replace(&mut pattern[cell], true));
    }
    let mut sum = total(&pattern);
    loop {
        let from = tightest(&pattern, &sum);
        set(&mut pattern, &mut sum, from, false);
        let to = emptiest(&pattern, &sum);
        set(&mut pattern, &mut sum, to, true);
        if from == to {
            break;
        }
    }
    let mut ranks = vec![0; cells];
    // Down from the first pattern: the tightest goes first.
    let (mut falling, mut falling_sum) = (pattern.clone(), sum.clone());
    for rank in (0..ones).rev() {
        let cell = tightest(&falling, &falling_sum);
        set(&mut falling, &mut falling_sum, cell, false);
        ranks[cell] = rank as u16;
    }
    // Up from it: the emptiest place is filled. Past the half, that is the tightest cluster of zeros: the energies
    // of ones and zeros add up to a constant.
    for rank in ones..cells {
        let cell = emptiest(&pattern, &sum);
        set(&mut pattern, &mut sum, cell, true);
        ranks[cell] = rank as u16;
    }
    ranks
}

/// Energy of spatial quantization: what blurring by 1 2 1 ⊗ 1 2 1 / 16 leaves of the error, squared and summed over
/// the pixels and a border of one. Errors outside of the picture are zero.
#[must_use]
pub fn blurred_error(pixels: &[Color], width: usize, palette: &[Color], indices: &[u8]) -> f64 {
    let height = pixels.len() / width;
    let error = |x: i64, y: i64, channel: usize| {
        if x < 0 || y < 0 || x >= width as i64 || y >= height as i64 {
            return 0.0;
        }
        let at = y as usize * width + x as usize;
        f64::from(palette[usize::from(indices[at])][channel]) - f64::from(pixels[at][channel])
    };
    let weights = [1.0, 2.0, 1.0];
    let mut energy = 0.0;
    for y in -1..=height as i64 {
        for x in -1..=width as i64 {
            for channel in 0..3 {
                let mut blurred = 0.0;
                for (dy, down) in (-1..).zip(weights) {
                    for (dx, across) in (-1..).zip(weights) {
                        blurred += down * across * error(x + dx, y + dy, channel) / 16.0;
                    }
                }
                energy += blurred * blurred;
            }
        }
    }
    energy
}
