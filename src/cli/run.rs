//! Does what the command line asks for.

use crate::base::error::{Error, Result, Setting};
use crate::cli::args::Job;
use crate::cli::quality::measure_files;
use crate::cli::reconstruct::reconstruct_file;
use crate::cli::remesh::remesh_file;
use crate::cli::sample::sample_file;
use crate::cli::status::Status;
use crate::cli::terminal;

/// Does a job, and says how it went.
///
/// # Errors
/// Those of reading, remeshing and writing; a result that is not verified is not among them.
pub(super) fn run(job: &Job) -> Result<Status> {
    terminal::listen_for_interrupts();
    match job {
        Job::Remesh(job) => with_threads(job.run.threads, || remesh_file(job))?,
        Job::Sample(job) => with_threads(job.run.threads, || sample_file(job))?.map(|()| Status::Done),
        Job::Reconstruct(job) => with_threads(job.run.threads, || reconstruct_file(job))?.map(|()| Status::Done),
        Job::Measure(job) => with_threads(job.threads, || measure_files(job))?.map(|()| Status::Done),
        Job::Complete(script) => terminal::print(script).map(|()| Status::Done),
    }
}

/// Calls `work` where rayon has as many threads as are wanted.
fn with_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T> {
    let Some(threads) = threads else { return Ok(work()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| Error::Option {
        option: Setting::Threads,
        cause: e.to_string(),
        remedy: "use fewer".into(),
    })?;
    Ok(pool.install(work))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_as_many_as_wanted() {
        assert_eq!(with_threads(Some(3), rayon::current_num_threads), Ok(3));
    }
}
