//! The spectral sampler: kernel, measure, linear scan, gradient ascent.
//!
//! Based on: A. C. Öztireli, M. Alexa, M. Gross, Spectral sampling of manifolds, 2010, DOI 10.1145/1882261.1866190.

pub mod ascent;
pub mod candidates;
mod cells;
pub mod curve_samples;
pub mod free_ascent;
pub mod lattice;
pub mod measure;
mod nearest;
pub mod scan;
pub mod spacing;
pub mod subset;
