//! VGA RGB888 line by line through the device's pipeline: balance, gray, Gaussian, Canny.
#![no_std]
#![no_main]

use exercise::replay::scenario::CANNY;
use firmware::pipeline::Settings;

mps2::line_image!(CANNY, Settings::canny_memory(640, 480));
