//! What the library says, in the words of the page.

use spectral_remesh::{Error, Setting};

/// What a setting is called on the page; `None` for those that are not there.
pub fn label(setting: Setting) -> Option<&'static str> {
    Some(match setting {
        Setting::Points => "Vertices",
        Setting::EdgeLength => "Edge length",
        Setting::MaxError => "Maximum error",
        Setting::Features => "Sharp edges",
        Setting::Adaptivity => "Grading",
        Setting::Smoothing => "Smooth noise away",
        Setting::Weld => "Weld distance",
        Setting::FillHoles => "Fill holes up to",
        Setting::Format => "File format",
        _ => return None,
    })
}

/// An error in the words of the page.
pub fn worded(error: &Error) -> String {
    match error {
        Error::Option { option, cause, remedy } => {
            let name = label(*option).map_or_else(|| option.to_string(), String::from);
            format!("{name}: {cause}; {remedy}")
        }
        other => other.to_string(),
    }
}
