//! Messages of the library, with the labels of the page.

use spectral_remesh::{Error, Setting};

/// Returns the page's label of a setting, or `None` if the page does not have it.
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

/// Returns the text of an error, with the label of the page for an option.
pub fn worded(error: &Error) -> String {
    match error {
        Error::Option { option, cause, remedy } => {
            let name = label(*option).map_or_else(|| option.to_string(), String::from);
            format!("{name}: {cause}; {remedy}")
        }
        other => other.to_string(),
    }
}
