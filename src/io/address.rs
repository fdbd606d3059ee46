//! Files that other files name: read only from the folder of the file that names them, and the folders in it.

use crate::io::disk::{folder_of, read_cause};
use std::borrow::Cow;
use std::fs::{self, File};
use std::io;
use std::path::{Component, Path, PathBuf};

/// The bytes of a buffer that the glTF file at `path` names by a relative address.
pub(super) fn read_buffer(path: &Path, address: &str) -> std::result::Result<Vec<u8>, String> {
    match percent_decoded(address) {
        Some(name) => read_inside(path, &name),
        None => Err(not_inside(address)),
    }
}

/// The bytes of the file `name`, which has to be in the folder of the one at `path` or in a folder there.
pub(super) fn read_inside(path: &Path, name: &str) -> std::result::Result<Vec<u8>, String> {
    let relative = inside(name).ok_or_else(|| not_inside(name))?;
    let name = name.escape_debug();
    let cannot = |error: io::Error| format!("the file '{name}' cannot be read: {}", read_cause(&error));
    let found = folder_of(path).join(relative);
    let file = File::open(&found).map_err(cannot)?;
    if !file.metadata().map_err(cannot)?.is_file() {
        return Err(format!("the file '{name}' is not a file"));
    }
    fs::read(found).map_err(cannot)
}

fn not_inside(name: &str) -> String {
    format!("the file '{}' is not in the folder of the file that names it", name.escape_debug())
}

/// The path that a relative name means, if it stays in its folder: no scheme, no root, not out by `..`.
fn inside(name: &str) -> Option<PathBuf> {
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

/// `%20` and the like as the characters that they stand for; `None` if these are not UTF-8.
fn percent_decoded(address: &str) -> Option<Cow<'_, str>> {
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

    #[test]
    fn buffers_are_read_beside_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gltf");
        fs::write(folder.path().join("my a.bin"), b"123").unwrap();
        assert_eq!(read_buffer(&path, "my%20a.bin"), Ok(b"123".to_vec()));
        assert!(read_buffer(&path, "b.bin").unwrap_err().contains("'b.bin' cannot be read: there is no such file"));
        assert!(read_buffer(&path, "../b.bin").unwrap_err().contains("not in the folder"));
        fs::create_dir(folder.path().join("c")).unwrap();
        assert!(read_buffer(&path, "c").unwrap_err().contains("not a file"));
    }
}
