//! Palettes, nearest colours and dithering.
