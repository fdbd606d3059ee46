//! Tests of reading and writing, by subject.

mod accessors;
mod attributes;
mod files;
mod malformed;
mod materials;
mod scenes;
mod writing;
