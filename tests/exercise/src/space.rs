//! The picture and all memory that is lent, as fields, so that no exercise needs a heap.

use algos_nostd::draw::{Edge, PendingRun, Point, Premultiplied, Rgba};
use algos_nostd::edges::gradient::Gradient;
use algos_nostd::edges::{Marks, words_a_line, words_a_map};
use algos_nostd::image::{Image, Rgb};
use algos_nostd::pixel::rgb888;
use algos_nostd::quantize::{
    Bin, Cell, Cluster, Cuboid, ExactMap, Group, Histogram, InverseMap, Moment, Neuron, Node, Octree, Probe,
    Span, WeightedColor, Wu,
};

/// Pixels a line of the picture.
pub const WIDTH: usize = 320;
/// Lines of the picture.
pub const HEIGHT: usize = 240;
/// Pixels of the picture.
pub const PIXELS: usize = WIDTH * HEIGHT;
/// Bytes of the picture in colour.
pub const PICTURE_BYTES: usize = PIXELS * 3;
/// Bits a channel of the histograms and maps.
pub(crate) const BITS: u32 = 4;
/// Colours of the palettes.
pub(crate) const COLORS: usize = 16;
/// Segments that are clipped and drawn.
pub(crate) const SEGMENTS: usize = 500;
const BLACK: Rgb = Rgb { r: 0, g: 0, b: 0 };

/// The picture and the memory.
#[derive(Debug)]
pub struct Workspace {
    pub(crate) picture: [Rgb; PIXELS],
    pub(crate) gray: [u8; PIXELS],
    pub(crate) pixels: [Rgb; PIXELS],
    pub(crate) bytes: [u8; PICTURE_BYTES],
    pub(crate) halves: [u16; PIXELS],
    pub(crate) gradients: [Gradient; PIXELS],
    pub(crate) words: [u32; PIXELS],
    pub(crate) marks: [Marks; words_a_line(WIDTH) * HEIGHT],
    pub(crate) edges: [u32; words_a_map(WIDTH, HEIGHT)],
    pub(crate) map: [u32; words_a_map(WIDTH, HEIGHT)],
    pub(crate) memory: [u8; 64 * WIDTH],
    pub(crate) half_memory: [u16; 16 * WIDTH],
    pub(crate) word_memory: [u32; 32 * 1024],
    pub(crate) long_memory: [u64; 2048],
    pub(crate) line: [Rgb; 8 * WIDTH],
    pub(crate) byte_line: [u8; 2 * WIDTH],
    pub(crate) half_line: [u16; WIDTH],
    pub(crate) points: [Point; PIXELS / 4],
    pub(crate) segments: [(Point, Point); SEGMENTS],
    pub(crate) runs: [PendingRun; 512],
    pub(crate) polygon: [Edge; 64],
    pub(crate) layer: [Premultiplied; PIXELS / 4],
    pub(crate) base: [Premultiplied; PIXELS / 4],
    pub(crate) straight: [Rgba; PIXELS / 4],
    pub(crate) bins: [Bin; Histogram::<BITS>::bins()],
    pub(crate) colors: [WeightedColor; Histogram::<BITS>::bins()],
    pub(crate) scratch: [WeightedColor; Histogram::<BITS>::bins()],
    pub(crate) cumulative: [u32; Histogram::<BITS>::bins()],
    pub(crate) moments: [Moment; Wu::<BITS>::moments()],
    pub(crate) cuboids: [Cuboid; COLORS],
    pub(crate) clusters: [Cluster; COLORS],
    pub(crate) probes: [Probe; COLORS],
    pub(crate) spans: [Span; COLORS],
    pub(crate) neurons: [Neuron; COLORS],
    pub(crate) centers: [[i32; 3]; COLORS],
    pub(crate) nodes: [Node; Octree::nodes(COLORS, 6)],
    pub(crate) table: [u32; InverseMap::<BITS>::cells()],
    pub(crate) cells: [Cell; ExactMap::<BITS>::cells()],
    pub(crate) groups: [Group; 1024],
    pub(crate) errors: [[i16; 3]; PIXELS / 16],
    pub(crate) palette: [Rgb; COLORS],
}

impl Workspace {
    /// All zeros: 2.6 MB for a `static`.
    #[must_use]
    pub const fn new() -> Self {
        const NOWHERE: Point = Point::new(0, 0);
        Self {
            picture: [BLACK; PIXELS],
            gray: [0; PIXELS],
            pixels: [BLACK; PIXELS],
            bytes: [0; PICTURE_BYTES],
            halves: [0; PIXELS],
            gradients: [Gradient { x: 0, y: 0 }; PIXELS],
            words: [0; PIXELS],
            marks: [Marks { candidates: 0, strong: 0 }; words_a_line(WIDTH) * HEIGHT],
            edges: [0; words_a_map(WIDTH, HEIGHT)],
            map: [0; words_a_map(WIDTH, HEIGHT)],
            memory: [0; 64 * WIDTH],
            half_memory: [0; 16 * WIDTH],
            word_memory: [0; 32 * 1024],
            long_memory: [0; 2048],
            line: [BLACK; 8 * WIDTH],
            byte_line: [0; 2 * WIDTH],
            half_line: [0; WIDTH],
            points: [NOWHERE; PIXELS / 4],
            segments: [(NOWHERE, NOWHERE); SEGMENTS],
            runs: [PendingRun::EMPTY; 512],
            polygon: [Edge::EMPTY; 64],
            layer: [Premultiplied::CLEAR; PIXELS / 4],
            base: [Premultiplied::CLEAR; PIXELS / 4],
            straight: [Rgba { r: 0, g: 0, b: 0, a: 0 }; PIXELS / 4],
            bins: [Bin::EMPTY; Histogram::<BITS>::bins()],
            colors: [WeightedColor::EMPTY; Histogram::<BITS>::bins()],
            scratch: [WeightedColor::EMPTY; Histogram::<BITS>::bins()],
            cumulative: [0; Histogram::<BITS>::bins()],
            moments: [Moment::EMPTY; Wu::<BITS>::moments()],
            cuboids: [Cuboid::EMPTY; COLORS],
            clusters: [Cluster::EMPTY; COLORS],
            probes: [Probe::EMPTY; COLORS],
            spans: [Span::EMPTY; COLORS],
            neurons: [Neuron::EMPTY; COLORS],
            centers: [[0; 3]; COLORS],
            nodes: [Node::EMPTY; Octree::nodes(COLORS, 6)],
            table: [0; InverseMap::<BITS>::cells()],
            cells: [Cell::EMPTY; ExactMap::<BITS>::cells()],
            groups: [Group::EMPTY; 1024],
            errors: [[0; 3]; PIXELS / 16],
            palette: [BLACK; COLORS],
        }
    }

    /// Where the colour picture's bytes go: 320 × 240, RGB888.
    pub fn picture_mut(&mut self) -> &mut [u8] {
        rgb888::as_bytes_mut(&mut self.picture)
    }

    /// Where the gray picture goes: 320 × 240.
    pub fn gray_mut(&mut self) -> &mut [u8] {
        &mut self.gray
    }

    /// Makes what else the exercises start from: segments about the picture.
    pub fn prepare(&mut self) {
        let mut random = Random(42);
        // Ends in a rectangle twice the picture's size about its middle.
        let mut point = || {
            let x = random.below(2 * WIDTH as u32) as i16 - WIDTH as i16 / 2;
            let y = random.below(2 * HEIGHT as u32) as i16 - HEIGHT as i16 / 2;
            Point::new(x, y)
        };
        for segment in &mut self.segments {
            *segment = (point(), point());
        }
    }
}

impl Default for Workspace {
    fn default() -> Self {
        Self::new()
    }
}

/// Numbers without a pattern that matters, the same everywhere (Knuth's MMIX generator).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn below(&mut self, limit: u32) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as u32 % limit
    }
}

/// The gray picture.
pub(crate) fn gray_view(gray: &[u8; PIXELS]) -> Result<Image<'_, u8>, algos_nostd::image::Error> {
    Image::new(gray, WIDTH, HEIGHT)
}

/// The colour picture.
pub(crate) fn view(picture: &[Rgb; PIXELS]) -> Result<Image<'_, Rgb>, algos_nostd::image::Error> {
    Image::new(picture, WIDTH, HEIGHT)
}
