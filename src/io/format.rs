//! The formats by name, by ending and by content.

use super::off;
use crate::base::error::{Error, Result};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A mesh file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Wavefront OBJ, text.
    Obj,
    /// Stanford PLY, text or binary.
    Ply,
    /// STL, text or binary: separate triangles, single precision.
    Stl,
    /// Object file format of Geomview, text.
    Off,
    /// glTF 2.0 as JSON, its buffers embedded or beside it; single precision.
    Gltf,
    /// glTF 2.0 as one binary file; single precision.
    Glb,
}

/// Where a keyword that is not at the very start must appear for the content to be recognised.
const HEAD: usize = 4096;

/// Header and triangle count of a binary STL, and each of its triangles.
const STL_BYTES: (usize, usize) = (84, 50);

/// What the first statement of an OBJ may be.
const OBJ_STATEMENTS: [&[u8]; 12] =
    [b"v", b"vt", b"vn", b"vp", b"f", b"o", b"g", b"s", b"l", b"p", b"mtllib", b"usemtl"];

impl Format {
    /// All formats, in the order of the documentation.
    pub const ALL: [Format; 6] = [Format::Obj, Format::Ply, Format::Stl, Format::Off, Format::Gltf, Format::Glb];

    /// The ending of its files, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Obj => "obj",
            Format::Ply => "ply",
            Format::Stl => "stl",
            Format::Off => "off",
            Format::Gltf => "gltf",
            Format::Glb => "glb",
        }
    }

    /// The name as it is written in prose.
    pub fn name(self) -> &'static str {
        match self {
            Format::Obj => "OBJ",
            Format::Ply => "PLY",
            Format::Stl => "STL",
            Format::Off => "OFF",
            Format::Gltf => "glTF",
            Format::Glb => "GLB",
        }
    }

    /// The format whose files have this ending (without a dot, upper or lower case).
    pub fn from_extension(extension: &str) -> Option<Format> {
        Format::ALL.into_iter().find(|f| f.extension().eq_ignore_ascii_case(extension))
    }

    /// The format of a file by its content: a signature, or a first statement that only one format has.
    pub fn sniff(bytes: &[u8]) -> Option<Format> {
        Format::by_signature(bytes).or_else(|| is_obj(bytes).then_some(Format::Obj))
    }

    /// The format that `bytes` are in without doubt: a file of another format does not start like this.
    pub fn by_signature(bytes: &[u8]) -> Option<Format> {
        let head = &bytes[..bytes.len().min(HEAD)];
        let has = |word: &str| head.windows(word.len()).any(|w| w == word.as_bytes());
        let starts = |word: &str| head.trim_ascii_start().starts_with(word.as_bytes());
        if bytes.starts_with(b"glTF") {
            Some(Format::Glb)
        } else if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
            Some(Format::Ply)
        } else if is_binary_stl(bytes) || (starts("solid") && (has("facet") || has("endsolid"))) {
            Some(Format::Stl)
        } else if starts("{") && has("\"asset\"") {
            Some(Format::Gltf)
        } else if off::has_keyword(head) {
            Some(Format::Off)
        } else {
            None
        }
    }
}

/// Whether the length is what the number of triangles in the header makes it.
fn is_binary_stl(bytes: &[u8]) -> bool {
    let (head, each) = STL_BYTES;
    let Some(&[a, b, c, d]) = bytes.get(head - 4..head) else { return false };
    let triangles = u32::from_le_bytes([a, b, c, d]) as usize;
    triangles > 0 && triangles.checked_mul(each).is_some_and(|size| size == bytes.len() - head)
}

fn is_obj(bytes: &[u8]) -> bool {
    super::text::Words::new(bytes)
        .with_comments()
        .with_continued_lines()
        .anywhere()
        .is_some_and(|word| OBJ_STATEMENTS.contains(&word))
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Format {
    type Err = Error;

    fn from_str(name: &str) -> Result<Format> {
        Format::from_extension(name).ok_or_else(|| Error::Option {
            option: "format",
            cause: format!("{} is no mesh format", super::text::quote(name.as_bytes())),
            remedy: format!("use one of {}", Format::list("")),
        })
    }
}

impl Format {
    /// All endings, each after `before`, for messages.
    pub(crate) fn list(before: &str) -> String {
        Format::ALL.map(|f| format!("{before}{}", f.extension())).join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_endings_lead_back() {
        for format in Format::ALL {
            assert_eq!(Format::from_extension(format.extension()), Some(format));
            assert_eq!(format.to_string().parse(), Ok(format));
            assert_eq!(serde_json::to_value(format).unwrap(), format.extension());
        }
        assert_eq!(Format::from_extension("PLY"), Some(Format::Ply));
        assert_eq!(Format::from_extension("ply "), None);
        let message = "xyz".parse::<Format>().unwrap_err().to_string();
        assert_eq!(message, "format: 'xyz' is no mesh format; use one of obj, ply, stl, off, gltf, glb");
    }

    #[test]
    fn contents_are_recognised() {
        let stl = |triangles: u32, bytes: usize| {
            let mut file = b"solid with a misleading header, facet".to_vec();
            file.resize(80, 0);
            file.extend(triangles.to_le_bytes());
            file.resize(84 + bytes, 0);
            file
        };
        for (bytes, format) in [
            (&b"ply\nformat ascii 1.0\n"[..], Some(Format::Ply)),
            (b"ply\r\nformat ascii 1.0\r\n", Some(Format::Ply)),
            (b"glTF\x02\0\0\0", Some(Format::Glb)),
            (b" {\n \"asset\" : {\"version\": \"2.0\"}}", Some(Format::Gltf)),
            (b"{\"type\": 1}", None),
            (b"solid a\n facet normal 0 0 1\n", Some(Format::Stl)),
            (b"solid a\nendsolid\n", Some(Format::Stl)),
            (b"solid ground\n", None),
            (&stl(2, 100), Some(Format::Stl)),
            (b"# a\nCOFF\n1 0 0\n", Some(Format::Off)),
            (b"# a\n\nmtllib b.mtl\nv 0 0 0\n", Some(Format::Obj)),
            (b"v 0 0 0", Some(Format::Obj)),
            (b"", None),
            (b"\x89PNG\r\n", None),
            (b"hello world", None),
        ] {
            assert_eq!(Format::sniff(bytes), format, "{}", String::from_utf8_lossy(bytes));
        }
        assert_eq!(Format::sniff(&stl(u32::MAX, 100)[5..]), None);
    }
}
