//! Tests of reading and writing, by what they are about.

mod accessors;
mod attributes;
mod files;
mod malformed;
mod materials;
mod scenes;
mod writing;
