//! A job beside Python: it runs on a thread of its own without the lock of the interpreter, while the calling thread looks
//! after signals and tells the progress.

use crate::errors::exception;
use pyo3::prelude::*;
use spectral_remesh::{Monitor, Result, with_threads};
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, OnceLock};
use std::thread;
use std::time::Duration;

/// How often the calling thread looks after signals: to people an interrupt seems to work at once.
const TICK: Duration = Duration::from_millis(20);

/// What the job tells the calling thread, and whether it should end.
#[derive(Default)]
struct Watch {
    stage: Mutex<&'static str>,
    /// The bits of the share that is done.
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

/// The calling thread's part: handlers of signals, and the function that is told the progress.
struct Caller<'a, 'py> {
    py: Python<'py>,
    progress: Option<&'a Bound<'py, PyAny>>,
    told: (&'static str, f64),
}

impl Caller<'_, '_> {
    /// Lets handlers of signals run, and tells the stage and the share that is done, if it is another one.
    ///
    /// # Errors
    /// What one of these raises: the job shall end.
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

/// Runs `job` to its end, on as many threads as are wanted. If a handler of a signal or `progress` raises, that is raised at
/// once, and the job, which nobody waits for any more, ends by itself as soon as it asks its monitor.
///
/// # Errors
/// Those of the job, as exceptions.
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
            // Nobody listens if the job was given up.
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

/// Calls `work`, which nobody needs to wait for or to interrupt, without the lock of the interpreter.
///
/// # Errors
/// If the system gives no threads.
pub fn detached<T: Send>(py: Python, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| with_threads(threads_after_fork(), work)).map_err(|error| exception(&error))
}

/// The process that the package was loaded in.
static FIRST: OnceLock<u32> = OnceLock::new();

/// Remembers the process.
pub fn remember_process() {
    FIRST.get_or_init(std::process::id);
}

/// The threads of a job in a process that was forked off another one: rayon's may have been started there, and are not in this
/// one, so it gets new ones, as many as by default.
fn threads_after_fork() -> Option<usize> {
    FIRST.get().is_some_and(|&first| first != std::process::id()).then_some(0)
}
