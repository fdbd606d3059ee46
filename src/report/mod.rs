//! Reports on what a run did and how good its result is, as JSON with a fixed schema and as text for a terminal.
//!
//! `docs/report.md` describes every member. Within a version of a schema, members are only ever added, so a reader that
//! ignores unknown members keeps working.

mod failure;
pub mod page;
mod remeshing;
mod rows;
mod run;
pub mod samples;
pub mod surface;
mod table;

pub use crate::mesh::topology::Topology;
pub use crate::pipeline::{CloudSummary, Coverage, Deviation};
pub use crate::prepare::repairs::Repairs;
pub use crate::quality::distance::Distance;
pub use crate::quality::shape::Shape;
pub use failure::{FAILURE_SCHEMA, Failure};
pub use remeshing::{
    AttributesKept, Crossings, Measured, Report, SCHEMA, Sampling, all_to_json, all_to_text, left_out, noise, terrain,
};
pub use run::{Lap, RunSummary};
