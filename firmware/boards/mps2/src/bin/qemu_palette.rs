//! VGA RGB888 line by line through the device's pipeline: balance, and the nearest of sixteen colours.
#![no_std]
#![no_main]

use exercise::replay::scenario::PALETTE;
use firmware::pipeline::Settings;

mps2::line_image!(PALETTE, Settings::palette_memory(640));
