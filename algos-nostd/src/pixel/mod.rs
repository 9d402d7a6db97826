//! Pixel formats of camera buses and the conversions between them.
