//! Palettes, nearest colours and dithering.
//!
//! Two passes over the lines of a frame, or one over each of two frames: the first counts colours, the second gives
//! each pixel its index. No pass holds a frame.
//!
//! ```text
//! lines ─► Histogram ─► weighted colours ─► palette maker ─► palette ─► KMeans ─► palette
//!                                                                                    │
//! lines ─────────────────► ApplyPalette, FloydSteinberg, Ordered ◄── ColorIndex ◄────┘
//!                               └─► lines of indices
//! ```
//!
//! | module | what lives there |
//! |---|---|
//! | [`histogram`] | lines in, weighted colours out |
//! | [`palette`] | weighted colours, and what all palette makers check |
//! | [`uniform`] | the same palette for every picture |
//! | [`mod@popularity`] | the most frequent colours |
//! | [`mod@median_cut`] | boxes of equally many pixels (Heckbert) |
//! | [`wu`] | boxes of least variance (Wu): the one to start with |
//! | [`octree`] | a tree of bounded size, straight from the lines (Gervautz and Purgathofer) |
//! | [`kmeans`] | moves any palette to a minimum of the squared error |
//! | [`mod@local_kmeans`] | sample by sample, with reserved colours (Verevka) |
//! | [`mod@neuquant`] | a self-organising line of neurons (Dekker) |
//! | [`nearest`] | which colour stands for a pixel: exactly, by looking at all |
//! | [`inverse_map`] | by a table, with a known error |
//! | [`exact_map`] | by a table, exactly |
//! | [`apply`] | line filter without dithering |
//! | [`floyd_steinberg`] | line filter with error diffusion |
//! | [`ordered`], [`blue_noise`] | line filter with tiles of thresholds |
//! | [`mod@spatial`] | palette and dithering found together (Puzicha and others) |
//!
//! Recipes, and the mean peak signal-to-noise ratio over four photographs of 640 × 480:
//!
//! | aim | recipe | 16 colours | 256 colours |
//! |---|---|---|---|
//! | fast | `Histogram<5>`, `Wu<5>`, `InverseMap<5>` | 29.3 dB | 39.3 dB |
//! | quality | `Histogram<6>`, `Wu<5>`, `KMeans` with 5 iterations, `ExactMap<5>` | 29.7 dB | 40.2 dB |
//! | small: 28 KiB in all | `Histogram<3>`, `Wu<3>`, `Nearest` | 29.4 dB | |
//! | small and fast: 30 KiB | `Histogram<3>`, `Wu<3>`, `InverseMap<3>` | 28.9 dB | |

mod samples;

pub mod histogram;
pub mod palette;
pub mod uniform;
pub mod popularity;
pub mod median_cut;
pub mod wu;
pub mod octree;
pub mod kmeans;
pub mod local_kmeans;
pub mod neuquant;
pub mod nearest;
pub mod inverse_map;
pub mod exact_map;
pub mod apply;
pub mod floyd_steinberg;
pub mod ordered;
pub mod blue_noise;
pub mod spatial;

pub use apply::ApplyPalette;
pub use blue_noise::BLUE_NOISE;
pub use exact_map::{Cell, ExactMap, Group};
pub use floyd_steinberg::FloydSteinberg;
pub use histogram::{Bin, Histogram};
pub use inverse_map::InverseMap;
pub use kmeans::{Cluster, KMeans};
pub use local_kmeans::{Learning, local_kmeans};
pub use median_cut::{Span, median_cut};
pub use nearest::{ColorIndex, Nearest, Probe};
pub use neuquant::{Neuron, neuquant};
pub use octree::{Node, Octree};
pub use ordered::{BAYER_2, BAYER_4, BAYER_8, Ordered, Tile};
pub use palette::{MOST_COLORS, MOST_PIXELS, WeightedColor};
pub use popularity::popularity;
pub use spatial::{Annealing, spatial};
pub use uniform::Uniform;
pub use wu::{Cuboid, Moment, Wu};
