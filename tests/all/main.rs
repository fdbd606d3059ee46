//! Tests of the library and the program as users see them, in one binary that is compiled and linked once. Each module is a
//! subject: `cargo test --test all sampling` runs one of them.

#![allow(clippy::disallowed_methods)]

mod attributes;
mod cases;
#[cfg(feature = "cli")]
mod cli;
mod clouds;
mod common;
mod data;
#[cfg(feature = "fs")]
mod dense;
mod docs;
mod features;
mod files;
mod io;
#[cfg(feature = "cli")]
mod large;
#[cfg(feature = "fs")]
mod library;
#[cfg(feature = "fs")]
mod materials;
#[cfg(feature = "cli")]
mod page;
mod pipeline;
mod properties;
mod reconstruct;
#[cfg(feature = "cli")]
mod same_bytes;
mod sampling;
mod sound;
mod table2;
#[cfg(feature = "fs")]
mod tiles;
mod within;
