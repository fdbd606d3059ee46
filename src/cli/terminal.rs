//! Interaction with the user: the report on standard output, everything else on standard error, progress, and interrupts.

use crate::base::error::{Error, Result};
use crate::base::monitor::Monitor;
use crate::cli::args::Voice;
use crate::cli::flags::worded;
use crate::cli::status::Status;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Number of steps of the progress bar.
const STEPS: u64 = 1000;

/// Whether the user wants the run to end.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Whether files are being written.
static WRITING: AtomicBool = AtomicBool::new(false);

/// Time that a stage has to end by itself after the user asked to end the run.
const PATIENCE: Duration = Duration::from_millis(800);

/// Installs handlers through which Ctrl-C and, on Unix, the signals to terminate and to hang up ask the run to end. A run
/// that has not ended after `PATIENCE` or at a second signal is killed. On systems without handlers, the signals act as
/// usual.
pub fn listen_for_interrupts() {
    let handler = || {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            end();
        }
        std::thread::spawn(|| {
            std::thread::sleep(PATIENCE);
            // A file that is being written will soon be renamed or removed.
            if !WRITING.load(Ordering::Relaxed) {
                complain(&worded(&Error::Cancelled));
                end();
            }
        });
    };
    let _ = ctrlc::set_handler(handler);
}

/// The folder of temporary files that is to be removed if the process ends early.
static TEMPORARY: Mutex<Option<PathBuf>> = Mutex::new(None);

/// Ends the process with the status of an interrupt.
fn end() -> ! {
    if let Some(folder) = TEMPORARY.lock().unwrap_or_else(|e| e.into_inner()).take() {
        let _ = std::fs::remove_dir_all(folder);
    }
    std::process::exit(i32::from(Status::Interrupted as u8))
}

/// Announces that files are being written from now on, which an interrupt lets finish.
pub fn now_writing() {
    WRITING.store(true, Ordering::Relaxed);
}

/// A monitor that shows the stages of a run on standard error: as a bar if that is a terminal, as lines if requested,
/// otherwise not at all.
pub struct Terminal {
    voice: Voice,
    bar: Option<ProgressBar>,
    start: Instant,
}

impl Terminal {
    /// A monitor with the amount of output of `voice`.
    pub fn new(voice: Voice) -> Terminal {
        let wanted = voice == Voice::Normal && std::io::stderr().is_terminal();
        Terminal { voice, bar: wanted.then(bar), start: Instant::now() }
    }
}

/// Clears the bar, however the run ended.
impl Drop for Terminal {
    fn drop(&mut self) {
        self.bar.iter().for_each(ProgressBar::finish_and_clear);
    }
}

impl Monitor for Terminal {
    fn stage(&self, name: &'static str) {
        if let Some(bar) = &self.bar {
            bar.set_message(name);
        }
        if self.voice == Voice::Verbose {
            complain(&format!("{:7.3} s {name}", self.start.elapsed().as_secs_f64()));
        }
    }

    fn progress(&self, done: f64) {
        self.bar.iter().for_each(|bar| bar.set_position((done.clamp(0.0, 1.0) * STEPS as f64) as u64));
    }

    fn cancelled(&self) -> bool {
        INTERRUPTED.load(Ordering::Relaxed)
    }

    fn temporary_files(&self, folder: &Path, bytes: u64, is_kept: bool) {
        if !is_kept {
            *TEMPORARY.lock().unwrap_or_else(|e| e.into_inner()) = Some(folder.into());
        }
        if self.voice != Voice::Quiet {
            complain(&format!("about {} MB of temporary files in {}", bytes / 1_000_000 + 1, folder.display()));
        }
    }
}

fn bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{msg:14} {wide_bar} {percent:>3} % {elapsed:>4}");
    let bar = ProgressBar::new(STEPS).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

/// Prints a text on standard output. A reader that stops early is not an error: `remesh quality m.obj | head -1` is fine.
///
/// # Errors
/// [`Error::File`] if the text cannot be written for another reason, such as a full disk.
pub fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::File {
            file: "standard output".into(),
            cause: e.to_string(),
            remedy: "redirect it elsewhere, or use -q".into(),
        }),
        _ => Ok(()),
    }
}

/// Prints one line on standard error, preceded by the program's name. Failures are ignored, since there is nowhere to report
/// them.
pub fn complain(cause: &str) {
    let line = cause.split_whitespace().collect::<Vec<_>>().join(" ");
    let _ = writeln!(std::io::stderr(), "remesh: {line}");
}
