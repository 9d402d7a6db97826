//! Edge detection at VGA. `CAMIF_BENCH_GRAY` names a raw 640 × 480 gray picture to take instead of the synthesised one.
use algos_nostd::edges::{self, BitMapMut, CannyConfig};
use algos_nostd::image::Image;
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

fn bench(criterion: &mut Criterion) {
    let pixels = picture();
    let image = Image::new(&pixels, WIDTH, HEIGHT).expect("a picture");
    let config = CannyConfig::default();
    let mut memory = vec![0; edges::canny_memory(WIDTH, HEIGHT, config.smoothing)];
    let mut words = vec![0; edges::words_a_map(WIDTH, HEIGHT)];
    criterion.bench_function("canny gaussian5 L2 50/150", |bencher| {
        bencher.iter(|| {
            let mut map = BitMapMut::new(&mut words, WIDTH, HEIGHT).expect("a map");
            edges::canny(image, &config, &mut memory, &mut map).expect("edges");
        });
    });
}

criterion_group!(benches, bench);
criterion_main!(benches);
