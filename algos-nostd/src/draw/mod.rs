//! Lines, circles, polygons, filling and alpha compositing.
