//! Line and polygon clipping in integers.
