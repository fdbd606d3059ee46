//! Messages to the page while it waits.

use spectral_remesh::Monitor;
use std::panic;

#[cfg(target_family = "wasm")]
#[link(wasm_import_module = "page")]
// SAFETY: `library.js` defines functions with these names and types, and they only read the memory passed to them.
unsafe extern "C" {
    safe fn stage(name: *const u8, length: usize);
    safe fn progress(done: f64);
    safe fn panicked(message: *const u8, length: usize);
}

/// Ignores the messages where there is no page.
#[cfg(not(target_family = "wasm"))]
mod nobody {
    pub fn stage(_name: *const u8, _length: usize) {}
    pub fn progress(_done: f64) {}
    pub fn panicked(_message: *const u8, _length: usize) {}
}
#[cfg(not(target_family = "wasm"))]
use nobody::{panicked, progress, stage};

/// The page as a monitor. It never cancels through the monitor: it terminates the worker instead.
pub struct Page;

impl Monitor for Page {
    fn stage(&self, name: &'static str) {
        stage(name.as_ptr(), name.len());
    }

    fn progress(&self, done: f64) {
        progress(done);
    }
}

/// Installs a hook that sends the message of a panic to the page. The module is unusable after a panic.
pub fn tell_panics() {
    panic::set_hook(Box::new(|panic| {
        let message = panic.to_string();
        panicked(message.as_ptr(), message.len());
    }));
}
