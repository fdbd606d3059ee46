//! Header of a PLY file: the elements, and the properties of each.

use crate::base::error::{Error, Place, Result};
use crate::io::bytes::{CUT_SHORT, EXPORT_AGAIN, malformed};
use crate::io::text::quote;
use crate::mesh::attributes::Scalar;

/// Content of a header, and the start of the body.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Byte at which the body begins.
    pub body: usize,
    /// Line on which the body begins, from 1.
    pub line: usize,
    /// Notes on what was left out, one sentence each.
    pub notes: Vec<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    Little,
    Big,
}

/// A table of the body. Its count is a claim until it is compared with the size of the file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
    /// Line that declares it.
    pub line: usize,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

/// Returns the type with this name. Each type has two names.
fn scalar(name: &str) -> Option<Scalar> {
    Some(match name {
        "char" | "int8" => Scalar::I8,
        "uchar" | "uint8" => Scalar::U8,
        "short" | "int16" => Scalar::I16,
        "ushort" | "uint16" => Scalar::U16,
        "int" | "int32" => Scalar::I32,
        "uint" | "uint32" => Scalar::U32,
        "float" | "float32" => Scalar::F32,
        "double" | "float64" => Scalar::F64,
        _ => return None,
    })
}

/// The first line, which some programs write in capitals.
const MAGIC: &[u8] = b"ply";

/// Whether a file that begins with `head` is in this format.
pub fn has_signature(head: &[u8]) -> bool {
    let (first, rest) = head.split_at(head.len().min(MAGIC.len()));
    first.eq_ignore_ascii_case(MAGIC) && matches!(rest.first(), Some(b'\n' | b'\r'))
}

/// Reads the header of a file.
pub(super) fn parse(bytes: &[u8]) -> Result<Header> {
    let mut lines = Lines::new(bytes);
    if lines.next().is_none_or(|first| !first.eq_ignore_ascii_case(MAGIC)) {
        return Err(malformed(Place::Line(1), "the first line is not 'ply'", "check that this is a PLY file"));
    }
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut notes = Vec::new();
    while let Some(raw) = lines.next() {
        let place = || Place::Line(lines.number);
        let wrong = |cause: &str| malformed(place(), format!("{}: {cause}", quote(raw)), EXPORT_AGAIN);
        let text = String::from_utf8_lossy(raw);
        let words: Vec<&str> = text.split_whitespace().collect();
        match words[..] {
            [] | ["comment" | "obj_info", ..] => {}
            ["format", name, ..] => encoding = Some(Encoding::from_name(name).ok_or_else(|| wrong("unknown format"))?),
            ["element", name, count] => {
                let count = count.parse().map_err(|_| wrong("the count is not a whole number"))?;
                elements.push(Element { name: name.into(), count, properties: Vec::new(), line: lines.number });
            }
            ["property", ref words @ ..] => {
                let property = property(words).ok_or_else(|| wrong("unknown property type"))?;
                let element = elements.last_mut().ok_or_else(|| wrong("a property comes before any element"))?;
                element.properties.push(property);
            }
            ["end_header"] => {
                let encoding = encoding.ok_or_else(|| malformed(place(), "no 'format' line", EXPORT_AGAIN))?;
                return Ok(Header { encoding, elements, body: lines.at, line: lines.number + 1, notes });
            }
            // Some programs sign their files without the word 'comment'. After an element, such a line could be a property.
            _ if elements.is_empty() => {
                notes.push(format!("line {} of the header, {}, is left out", lines.number, quote(raw)));
            }
            _ => return Err(wrong("not a line of a PLY header")),
        }
    }
    Err(malformed(Place::Line(lines.number), "the header has no 'end_header'", CUT_SHORT))
}

impl Encoding {
    fn from_name(name: &str) -> Option<Encoding> {
        match name {
            "ascii" => Some(Encoding::Text),
            "binary_little_endian" => Some(Encoding::Little),
            "binary_big_endian" => Some(Encoding::Big),
            _ => None,
        }
    }
}

/// Parses the words after `property`.
fn property(words: &[&str]) -> Option<Property> {
    let (kind, name) = match *words {
        ["list", count, item, name] => {
            let kind = Kind::List { count: scalar(count)?, item: scalar(item)? };
            (kind, name)
        }
        [kind, name] => (Kind::Scalar(scalar(kind)?), name),
        _ => return None,
    };
    Some(Property { name: name.into(), kind })
}

impl Element {
    /// Returns the error that this element is wrong because of `cause`.
    pub fn error(&self, cause: String, remedy: &str) -> Error {
        malformed(Place::Line(self.line), cause, remedy)
    }
}

/// The lines of a header, which may end with LF, CR LF or CR. The first line decides which, because the body of a binary
/// file may begin with any byte.
struct Lines<'a> {
    bytes: &'a [u8],
    end: u8,
    at: usize,
    number: usize,
}

impl<'a> Lines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        let first = bytes.iter().position(|b| matches!(b, b'\n' | b'\r'));
        let lone_cr = first.is_some_and(|i| bytes[i] == b'\r' && bytes.get(i + 1) != Some(&b'\n'));
        Lines { bytes, end: if lone_cr { b'\r' } else { b'\n' }, at: 0, number: 0 }
    }

    /// Returns the next line without its end. The last line of a header must have an end, too.
    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|&b| b == self.end)?;
        self.at += length + 1;
        self.number += 1;
        Some(rest[..length].trim_ascii())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "ply\nformat ascii 1.0\ncomment any thing\nobj_info num_cols 5\nelement vertex 3\n\
                        property float x\nproperty uint8 red\nelement face 1\nproperty list uchar int vertex_indices\n\
                        end_header\n";

    fn line(text: &str) -> usize {
        match parse(text.as_bytes()).unwrap_err() {
            Error::Format { place: Place::Line(line), .. } => line,
            other => panic!("{other}"),
        }
    }

    #[test]
    fn elements_and_properties() {
        let header = parse(TEXT.as_bytes()).unwrap();
        assert_eq!((header.encoding, header.body, header.line), (Encoding::Text, TEXT.len(), 11));
        let [vertex, face] = &header.elements[..] else { panic!() };
        assert_eq!((vertex.name.as_str(), vertex.count, vertex.line), ("vertex", 3, 5));
        assert_eq!(vertex.properties[1], Property { name: "red".into(), kind: Kind::Scalar(Scalar::U8) });
        assert_eq!(face.properties[0].kind, Kind::List { count: Scalar::U8, item: Scalar::I32 });
    }

    #[test]
    fn all_line_ends() {
        let elements = parse(TEXT.as_bytes()).unwrap().elements;
        for end in ["\r\n", "\r", "  \n"] {
            let text = TEXT.replace('\n', end);
            let header = parse(text.as_bytes()).unwrap();
            assert_eq!((&header.elements, header.body), (&elements, text.len()));
        }
    }

    #[test]
    fn both_namings_of_types() {
        let old = ["char", "uchar", "short", "ushort", "int", "uint", "float", "double"];
        let new = ["int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"];
        for (old, new) in old.into_iter().zip(new) {
            assert!(scalar(old).is_some());
            assert_eq!(scalar(old), scalar(new));
        }
    }

    #[test]
    fn lines_that_programs_sign_files_with_are_left_out() {
        let header = parse(TEXT.replace("comment any", "Created by any").as_bytes()).unwrap();
        assert_eq!(header.elements, parse(TEXT.as_bytes()).unwrap().elements);
        assert_eq!(header.notes, ["line 3 of the header, 'Created by any thing', is left out"]);
    }

    #[test]
    fn malformed_headers_have_a_line() {
        assert_eq!(line("plyx\n"), 1);
        assert_eq!(line(""), 1);
        assert_eq!(line(&TEXT.replace("ascii", "roman")), 2);
        assert_eq!(line(&TEXT.replace("vertex 3", "vertex three")), 5);
        assert_eq!(line(&TEXT.replace("vertex 3", "vertex -3")), 5);
        assert_eq!(line(&TEXT.replace("float x", "quad x")), 6);
        assert_eq!(line(&TEXT.replace("list uchar int", "list uchar")), 9);
        assert_eq!(line(&TEXT.replace("element vertex 3", "")), 6);
        assert_eq!(line(&TEXT.replace("property float x", "propperty float x")), 6);
        assert_eq!(line(&TEXT.replace("format ascii 1.0", "")), 10);
        assert_eq!(line(&TEXT.replace("end_header", "")), 10);
    }
}
