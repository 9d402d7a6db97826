//! Edge detection at VGA. `CAMIF_BENCH_GRAY` names a raw 640 × 480 gray picture to take instead of the synthesised one.
use algos_nostd::edges::gradient::Sobel;
use algos_nostd::edges::measure::{L1, L2, Saturated, Sector8};
use algos_nostd::edges::{
    self, BitMap, BitMapMut, CannyConfig, GradientFilter, Measure, Norm, Point, Thinning,
};
use algos_nostd::image::{Image, ImageMut};
use algos_nostd::lines::run;
use criterion::{Criterion, criterion_group, criterion_main};

const WIDTH: usize = 640;
const HEIGHT: usize = 480;

/// Discs and bars over a slope, with noise: as many edges as a photograph has.
fn picture() -> Vec<u8> {
    if let Some(path) = std::env::var_os("CAMIF_BENCH_GRAY") {
        let bytes = std::fs::read(&path).expect("the picture can be read");
        assert_eq!(bytes.len(), WIDTH * HEIGHT, "a raw picture of 640 × 480 pixels");
        return bytes;
    }
    let mut state = 1u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 29) as i32 - 4
    };
    let discs: Vec<[i32; 4]> =
        (0..40).map(|i| [i * 331 % 640, i * 197 % 480, 10 + i * 7 % 60, i * 53 % 160]).collect();
    let pixels = (0..WIDTH * HEIGHT).map(|i| {
        let (x, y) = ((i % WIDTH) as i32, (i / WIDTH) as i32);
        let inside = |&&[cx, cy, r, _]: &&[i32; 4]| (x - cx).pow(2) + (y - cy).pow(2) < r * r;
        let level = discs.iter().rfind(inside).map_or(40 + x / 8 + y / 10, |disc| 60 + disc[3]);
        (level + noise()).clamp(0, 255) as u8
    });
    pixels.collect()
}

/// A curve that turns at every scale: each step goes to a neighbour at random.
fn walk(points: usize) -> Vec<Point> {
    let mut state = 1u32;
    let mut step = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 16) as i16 % 3 - 1
    };
    let mut at = Point { x: 5000, y: 5000 };
    let mut next = || {
        at = Point { x: at.x + step(), y: at.y + step() };
        at
    };
    (0..points).map(|_| next()).collect()
}

fn gradients<M: Measure>(criterion: &mut Criterion, name: &str, image: Image<'_, u8>)
where
    M::Output: Default,
{
    let mut memory = vec![0; GradientFilter::<Sobel, M>::memory(WIDTH)];
    let mut line = vec![M::Output::default(); WIDTH];
    let mut pixels = vec![M::Output::default(); WIDTH * HEIGHT];
    criterion.bench_function(name, |bencher| {
        bencher.iter(|| {
            let mut filter =
                GradientFilter::<Sobel, M>::new(WIDTH, &mut memory, &mut line).expect("a filter");
            let mut picture = ImageMut::new(&mut pixels, WIDTH, HEIGHT).expect("a picture");
            run(&mut filter, image, &mut picture).expect("gradients");
        });
    });
}

fn bench(criterion: &mut Criterion) {
    let pixels = picture();
    let image = Image::new(&pixels, WIDTH, HEIGHT).expect("a picture");
    gradients::<L1>(criterion, "sobel L1, 16 bits", image);
    gradients::<Saturated<L1>>(criterion, "sobel L1, 8 bits", image);
    gradients::<L2>(criterion, "sobel L2, 16 bits", image);
    gradients::<Sector8>(criterion, "sobel direction of eight", image);

    let mut words = vec![0; edges::words_a_map(WIDTH, HEIGHT)];
    for norm in [Norm::L1, Norm::L2] {
        let mut config = CannyConfig::default();
        config.thresholds.norm = norm;
        let mut memory = vec![0; edges::canny_memory(WIDTH, HEIGHT, config.smoothing)];
        criterion.bench_function(&format!("gaussian 5 × 5 and canny 50/150 {norm:?}"), |bencher| {
            bencher.iter(|| {
                let mut map = BitMapMut::new(&mut words, WIDTH, HEIGHT).expect("a map");
                edges::canny(image, &config, &mut memory, &mut map).expect("edges");
            });
        });
    }

    let (mut rest, mut room) = (vec![0; words.len()], vec![Point::default(); 4096]);
    criterion.bench_function("trace canny's edges", |bencher| {
        bencher.iter(|| {
            let map = BitMap::new(&words, WIDTH, HEIGHT).expect("a map");
            let mut rest = BitMapMut::new(&mut rest, WIDTH, HEIGHT).expect("a map");
            let mut points = 0;
            edges::trace(map, &mut rest, &mut room, &mut |curve| points += curve.points.len())
                .expect("curves");
            points
        });
    });
    let mut memory = vec![0; edges::thin_memory(WIDTH)];
    criterion.bench_function("thin canny's edges, Guo-Hall", |bencher| {
        bencher.iter(|| {
            rest.copy_from_slice(&words);
            let mut map = BitMapMut::new(&mut rest, WIDTH, HEIGHT).expect("a map");
            edges::thin(&mut map, Thinning::GuoHall, &mut memory).expect("thin edges")
        });
    });

    let curve = walk(10_000);
    let (mut points, mut memory) = (curve.clone(), vec![0; edges::simplify_memory(curve.len())]);
    criterion.bench_function("ramer-douglas-peucker, 10,000 points, ε = 1", |bencher| {
        bencher.iter(|| {
            points.copy_from_slice(&curve);
            edges::simplify(&mut points, 256, &mut memory).expect("fewer points")
        });
    });
}

criterion_group!(benches, bench);
criterion_main!(benches);
