//! Executes the job that the command line describes.

use crate::base::error::Result;
use crate::cli::args::{Job, is_page};
use crate::cli::files::write_report;
use crate::cli::flags::worded;
use crate::cli::quality::measure_files;
use crate::cli::reconstruct::reconstruct_file;
use crate::cli::remesh::remesh_file;
use crate::cli::sample::sample_file;
use crate::cli::status::Status;
use crate::cli::terminal;
use crate::cli::tiles::do_tiles;
use crate::job::with_threads;
use crate::report::Failure;
use crate::report::page::page_of_failure;

/// Executes a job and returns its status. If a file is at fault, the requested report says so.
///
/// # Errors
/// Errors of reading, remeshing and writing. A result that is not verified is no error.
pub(super) fn run(job: &Job) -> Result<Status> {
    terminal::listen_for_interrupts();
    done(job).inspect_err(|error| {
        if let Some(path) = job.report().filter(|_| Status::of(error) == Status::File) {
            let failure = Failure::new(worded(error));
            let report = if is_page(path) { page_of_failure(&failure) } else { failure.to_json() };
            // If the report cannot be written, the error of the run is still the one to return.
            let _ = write_report(path, &report);
        }
    })
}

fn done(job: &Job) -> Result<Status> {
    match job {
        Job::Remesh(job) => with_threads(job.run.threads, || remesh_file(job))?,
        Job::Sample(job) => with_threads(job.run.threads, || sample_file(job))?.map(|()| Status::Done),
        Job::Tiles(job) => with_threads(job.run().threads, || do_tiles(job))?,
        Job::Reconstruct(job) => with_threads(job.run.threads, || reconstruct_file(job))?.map(|()| Status::Done),
        Job::Measure(job) => with_threads(job.threads, || measure_files(job))?.map(|()| Status::Done),
        Job::Print(text) => terminal::print(text).map(|()| Status::Done),
    }
}
