//! The command `remesh`; all of it is in the library's `cli`.

use std::panic::resume_unwind;
use std::process::ExitCode;
use std::thread;

/// Stack size of the command in bytes, independent of what the system gives the first thread.
const STACK: usize = 8 << 20;

fn main() -> ExitCode {
    let command = || spectral_remesh::cli::main(std::env::args_os());
    match thread::Builder::new().name("main".into()).stack_size(STACK).spawn(command) {
        Ok(running) => running.join().unwrap_or_else(|panic| resume_unwind(panic)).into(),
        Err(error) => {
            eprintln!("remesh: no thread can be started: {error}; close other programs, or allow this one more memory");
            ExitCode::FAILURE
        }
    }
}
