//! File names inside files. Only files in the same folder or in its subfolders are followed.

use std::borrow::Cow;
use std::path::{Component, PathBuf};

pub(super) fn not_inside(name: &str) -> String {
    format!("the file '{}' is outside the folder of the file that refers to it", name.escape_debug())
}

/// Returns a relative name as a path, if it stays inside its folder: no scheme, no root, no escape by `..`.
pub(super) fn inside(name: &str) -> Option<PathBuf> {
    if name.contains(':') || name.contains('\0') {
        return None;
    }
    let path = PathBuf::from(name);
    let mut depth = 0;
    for component in path.components() {
        depth += match component {
            Component::Normal(_) => 1,
            Component::CurDir => 0,
            Component::ParentDir => -1,
            Component::RootDir | Component::Prefix(_) => return None,
        };
        if depth < 0 {
            return None;
        }
    }
    (depth > 0).then_some(path)
}

/// Decodes percent escapes such as `%20`. Returns `None` if the result is not UTF-8.
pub(super) fn percent_decoded(address: &str) -> Option<Cow<'_, str>> {
    if !address.contains('%') {
        return Some(address.into());
    }
    let bytes = address.as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let code = bytes.get(at + 1..at + 3).filter(|d| bytes[at] == b'%' && d.iter().all(u8::is_ascii_hexdigit));
        let code = code.and_then(|d| u8::from_str_radix(std::str::from_utf8(d).ok()?, 16).ok());
        decoded.push(code.unwrap_or(bytes[at]));
        at += if code.is_some() { 3 } else { 1 };
    }
    String::from_utf8(decoded).ok().map(Cow::from)
}

/// Encodes a file name as an address: everything but ASCII letters, digits and `-._~` becomes a percent escape such as
/// `%20`.
#[cfg(feature = "fs")]
pub(super) fn percent_encoded(name: &str) -> String {
    let encode = |byte: u8| match byte {
        b'-' | b'.' | b'_' | b'~' => char::from(byte).to_string(),
        _ if byte.is_ascii_alphanumeric() => char::from(byte).to_string(),
        _ => format!("%{byte:02X}"),
    };
    name.bytes().map(encode).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_stay_in_their_folder() {
        for (address, expected) in [
            ("a.bin", Some("a.bin")),
            ("b/../a.bin", Some("b/../a.bin")),
            ("./b/my%20a.bin", Some("./b/my a.bin")),
            ("100%.bin", Some("100%.bin")),
            ("%zz", Some("%zz")),
            ("../a.bin", None),
            ("b/../../a.bin", None),
            ("%2e%2e/a.bin", None),
            ("/etc/passwd", None),
            ("%2Fetc/passwd", None),
            ("http://example.org/a.bin", None),
            ("file:a.bin", None),
            ("a%00", None),
            ("%FF", None),
            ("", None),
            (".", None),
        ] {
            let found = percent_decoded(address).and_then(|name| inside(&name));
            assert_eq!(found, expected.map(PathBuf::from), "{address}");
        }
    }
}
