//! Arbitrary bytes as a mesh and options: the whole job ends, and verified results are sound.

#![no_main]

use libfuzzer_sys::fuzz_target;
use spectral_remesh_fuzz::cases::Case;
use std::time::Duration;

fuzz_target!(|bytes: &[u8]| Case::new(bytes, 250).run(Duration::from_secs(60)));
