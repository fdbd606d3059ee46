//! Runs a job on its own thread, without the global interpreter lock, while the calling thread handles signals and reports
//! progress.

use crate::errors::exception;
use pyo3::prelude::*;
use spectral_remesh::{Monitor, Result, with_threads};
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, OnceLock};
use std::thread;
use std::time::Duration;

/// Interval at which the calling thread checks for signals, short enough for an interrupt to seem immediate.
const TICK: Duration = Duration::from_millis(20);

/// State shared with the job: its progress, and whether it is cancelled.
#[derive(Default)]
struct Watch {
    stage: Mutex<&'static str>,
    /// The bits of the completed share of the job.
    done: AtomicU64,
    cancelled: AtomicBool,
}

impl Monitor for Watch {
    fn stage(&self, name: &'static str) {
        *self.stage.lock().unwrap_or_else(|e| e.into_inner()) = name;
    }

    fn progress(&self, done: f64) {
        self.done.store(done.to_bits(), Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

impl Watch {
    fn stage_and_share(&self) -> (&'static str, f64) {
        let stage = *self.stage.lock().unwrap_or_else(|e| e.into_inner());
        (stage, f64::from_bits(self.done.load(Ordering::Relaxed)))
    }

    fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }
}

/// The calling thread's side: it runs signal handlers and calls the progress function.
struct Caller<'a, 'py> {
    py: Python<'py>,
    progress: Option<&'a Bound<'py, PyAny>>,
    told: (&'static str, f64),
}

impl Caller<'_, '_> {
    /// Runs pending signal handlers, and reports the stage and the completed share if they have changed.
    ///
    /// # Errors
    /// An exception raised by a handler or by the progress function. The job must then end.
    fn look(&mut self, watch: &Watch) -> PyResult<()> {
        self.py.check_signals()?;
        let now = watch.stage_and_share();
        if let Some(call) = self.progress.filter(|_| now != self.told) {
            self.told = now;
            call.call1(now)?;
        }
        Ok(())
    }
}

/// Runs `job` on the given number of threads and returns its result. If a signal handler or `progress` raises, the exception is
/// raised at once. Nothing waits for the cancelled job, which ends when it next asks its monitor.
///
/// # Errors
/// Errors of the job, as exceptions.
pub fn run<T: Send + 'static>(
    py: Python,
    threads: Option<usize>,
    progress: Option<&Bound<PyAny>>,
    job: impl FnOnce(&dyn Monitor) -> Result<T> + Send + 'static,
) -> PyResult<T> {
    let watch = Arc::new(Watch::default());
    let (tell, ended) = channel();
    let ended = Mutex::new(ended);
    let worker = {
        let watch = Arc::clone(&watch);
        let threads = threads.or_else(threads_after_fork);
        thread::spawn(move || {
            let result = with_threads(threads, || job(&*watch)).and_then(|result| result);
            // There is no receiver if the job was cancelled.
            let _ = tell.send(result);
        })
    };
    let mut caller = Caller { py, progress, told: ("", 0.0) };
    let wait = || ended.lock().unwrap_or_else(|e| e.into_inner()).recv_timeout(TICK);
    loop {
        match py.detach(wait) {
            Ok(result) => {
                let result = result.map_err(|error| exception(&error))?;
                caller.look(&watch)?;
                return Ok(result);
            }
            Err(RecvTimeoutError::Timeout) => caller.look(&watch).inspect_err(|_| watch.cancel())?,
            Err(RecvTimeoutError::Disconnected) => {
                if let Err(panic) = py.detach(|| worker.join()) {
                    resume_unwind(panic);
                }
                unreachable!("a thread that ends without a panic has sent its result");
            }
        }
    }
}

/// Calls `work` without the global interpreter lock. It can be neither interrupted nor monitored.
///
/// # Errors
/// If the system cannot start threads.
pub fn detached<T: Send>(py: Python, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| with_threads(threads_after_fork(), work)).map_err(|error| exception(&error))
}

/// Id of the process that loaded the package.
static FIRST: OnceLock<u32> = OnceLock::new();

/// Remembers the id of this process.
pub fn remember_process() {
    FIRST.get_or_init(std::process::id);
}

/// Requests new threads, as many as by default, in a forked process. The threads of rayon's global pool, if the parent
/// started it, do not exist in the child.
fn threads_after_fork() -> Option<usize> {
    FIRST.get().is_some_and(|&first| first != std::process::id()).then_some(0)
}
