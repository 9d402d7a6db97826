//! Gradients, edge detectors, and from edge maps to curves.
