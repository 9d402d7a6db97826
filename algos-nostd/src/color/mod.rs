//! Demosaic, curves, histograms and colour balance: what a camera does to colour.
