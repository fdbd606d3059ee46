//! Does what the command line asks for.

use crate::base::error::Result;
use crate::cli::args::Job;
use crate::cli::quality::measure_files;
use crate::cli::reconstruct::reconstruct_file;
use crate::cli::remesh::remesh_file;
use crate::cli::sample::sample_file;
use crate::cli::status::Status;
use crate::cli::terminal;
use crate::cli::tiles::do_tiles;
use crate::job::with_threads;

/// Does a job, and says how it went.
///
/// # Errors
/// Those of reading, remeshing and writing; a result that is not verified is not among them.
pub(super) fn run(job: &Job) -> Result<Status> {
    terminal::listen_for_interrupts();
    match job {
        Job::Remesh(job) => with_threads(job.run.threads, || remesh_file(job))?,
        Job::Sample(job) => with_threads(job.run.threads, || sample_file(job))?.map(|()| Status::Done),
        Job::Tiles(job) => with_threads(job.run().threads, || do_tiles(job))?.map(|()| Status::Done),
        Job::Reconstruct(job) => with_threads(job.run.threads, || reconstruct_file(job))?.map(|()| Status::Done),
        Job::Measure(job) => with_threads(job.threads, || measure_files(job))?.map(|()| Status::Done),
        Job::Print(text) => terminal::print(text).map(|()| Status::Done),
    }
}
