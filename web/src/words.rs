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
            on_page(&format!("{name}: {cause}; {remedy}"))
        }
        other => on_page(&other.to_string()),
    }
}

/// A text in which options are named as on the page and not as on the command line.
pub fn on_page(text: &str) -> String {
    let mut settings = Setting::ALL;
    // Longer names first: some begin with others.
    settings.sort_by_key(|setting| std::cmp::Reverse(setting.name().len()));
    settings.iter().fold(text.to_owned(), |text, &setting| match label(setting) {
        Some(label) => text.replace(&format!("--{}", setting.name()), &format!("“{label}”")),
        None => text,
    })
}
