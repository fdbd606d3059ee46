//! The command `remesh`; everything is in the library's `cli`.

use std::process::ExitCode;

fn main() -> ExitCode {
    spectral_remesh::cli::main(std::env::args_os()).into()
}
