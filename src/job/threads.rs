//! Sets the number of threads of a job.

use crate::base::error::{Error, Result, Setting};

/// Calls `work` on a rayon thread: of a pool of the wanted size, or of the global pool. From any other thread, each parallel
/// loop would have to wake one up and wait for it.
///
/// # Errors
/// [`Error::Option`] if the system does not provide that many.
pub fn with_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T> {
    let Some(threads) = threads else { return Ok(rayon::scope(|_| work())) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| Error::Option {
        option: Setting::Threads,
        cause: e.to_string(),
        remedy: "use fewer threads".into(),
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
