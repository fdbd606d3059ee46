//! Code shared by the fuzz targets and the tests of the project.

#[path = "../../tests/all/cases.rs"]
pub mod cases;
#[path = "../../tests/all/common.rs"]
pub mod common;
#[path = "../../tests/all/files.rs"]
pub mod files;
pub mod reading;
#[path = "../../tests/all/sound.rs"]
pub mod sound;
