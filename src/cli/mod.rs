//! The command line: parsing ([`args`]), one file per command, and the interaction with the terminal ([`terminal`]). The
//! processing of meshes and points is in [`job`](crate::job).

pub mod args;
mod files;
mod flags;
mod outputs;
mod quality;
mod reconstruct;
mod remesh;
mod run;
mod sample;
mod status;
pub mod terminal;
mod tiles;

pub use status::Status;

use std::ffi::OsString;

/// Runs the whole program, from its arguments, which begin with its name, to its exit status.
pub fn main(words: impl IntoIterator<Item = OsString>) -> Status {
    let outcome = match args::parse(words) {
        Ok(job) => run::run(&job),
        Err(args::Stop::Shown(text)) => terminal::print(&text).map(|()| Status::Done),
        Err(args::Stop::Wrong(cause)) => {
            terminal::complain(&cause);
            Ok(Status::Usage)
        }
    };
    outcome.unwrap_or_else(|error| {
        terminal::complain(&flags::worded(&error));
        Status::of(&error)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_status_has_its_documented_number() {
        let all = [Status::Done, Status::File, Status::Usage, Status::Unverified, Status::Interrupted];
        assert_eq!(all.map(|s| s as u8), [0, 1, 2, 3, 130]);
        for status in all {
            let line = format!("\n  {:<4}", status as u8);
            assert!(args::AFTER_HELP.contains(&line), "{status:?} is not in the help");
        }
    }
}
