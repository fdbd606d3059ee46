//! Any bytes as a file of the format that the variable FORMAT names; without it, of the one that they look like.

#![no_main]

use libfuzzer_sys::fuzz_target;
use spectral_remesh_fuzz::reading::{Kind, read};
use std::sync::LazyLock;

static KIND: LazyLock<Kind> = LazyLock::new(Kind::from_environment);

fuzz_target!(init: KIND.allow_caught_panics(), |bytes: &[u8]| read(*KIND, bytes));
