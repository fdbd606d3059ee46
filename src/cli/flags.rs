//! What the settings of the library are called on the command line.

use crate::base::error::{Error, Setting};

/// An error in the words of the command line.
pub(super) fn worded(error: &Error) -> String {
    match error {
        Error::Cancelled => "interrupted; no file was changed".into(),
        Error::Option { option, cause, remedy } => format!("{}: {cause}; {remedy}", flag(*option)),
        other => other.to_string(),
    }
}

fn flag(setting: Setting) -> &'static str {
    match setting {
        Setting::Points => "--points",
        Setting::EdgeLength => "--edge-length",
        Setting::SigmaP => "--sigma-p",
        Setting::SigmaN => "--sigma-n",
        Setting::Signals => "--sigma",
        Setting::Adaptivity => "--adapt",
        Setting::Field => "--sizing",
        Setting::Weld => "--weld",
        Setting::Features => "--features",
        Setting::Smoothing => "--smooth",
        Setting::PartBox => "--within",
        Setting::PartMarks => "--select",
        Setting::MaxError => "--max-error",
        Setting::NormalNeighbors => "--normal-neighbors",
        Setting::NormalRadius => "--normal-radius",
        Setting::FillHoles => "--fill-holes",
        Setting::Resolution => "--resolution",
        Setting::Format => "--format",
        Setting::Threads => "--threads",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args;

    #[test]
    fn errors_name_flags_that_there_are() {
        let all = [
            Setting::Points,
            Setting::EdgeLength,
            Setting::SigmaP,
            Setting::SigmaN,
            Setting::Signals,
            Setting::Adaptivity,
            Setting::Field,
            Setting::Weld,
            Setting::Features,
            Setting::Smoothing,
            Setting::PartBox,
            Setting::PartMarks,
            Setting::MaxError,
            Setting::NormalNeighbors,
            Setting::NormalRadius,
            Setting::FillHoles,
            Setting::Resolution,
            Setting::Format,
            Setting::Threads,
        ];
        let help = |words: &[&str]| match args::parse(words.iter().map(Into::into)) {
            Err(args::Stop::Shown(text)) => text,
            other => panic!("{other:?}"),
        };
        let texts = [help(&["remesh", "--help"]), help(&["remesh", "reconstruct", "--help"])].concat();
        for flag in all.map(flag) {
            assert!(texts.contains(&format!("{flag} <")) || texts.contains(&format!("{flag} [")), "{flag}");
        }
    }
}
