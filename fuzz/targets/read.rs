//! Arbitrary bytes as a file of the format named by the variable FORMAT or, without it, of the detected format.

#![no_main]

use libfuzzer_sys::fuzz_target;
use spectral_remesh_fuzz::reading::{Kind, read};
use std::sync::LazyLock;

static KIND: LazyLock<Kind> = LazyLock::new(Kind::from_environment);

fuzz_target!(init: KIND.allow_caught_panics(), |bytes: &[u8]| read(*KIND, bytes));
