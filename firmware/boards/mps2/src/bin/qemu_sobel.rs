//! VGA RGB888 line by line through the device's pipeline: balance, gray, Gaussian, Sobel.
#![no_std]
#![no_main]

use exercise::replay::scenario::SOBEL;
use firmware::pipeline::Settings;

mps2::line_image!(SOBEL, Settings::sobel_memory(640));
