//! The binary container of glTF: a header, a chunk of JSON and an optional chunk of binary data.

use crate::base::error::{Error, Place, Result};
use crate::io::bytes::{CUT_SHORT, EXPORT_AGAIN, malformed, u32_at};
use std::io::{self, Write};

pub(super) const MAGIC: &[u8; 4] = b"glTF";
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BIN: u32 = u32::from_le_bytes(*b"BIN\0");
/// Size of magic, version and length.
const HEADER: usize = 12;
/// Size of the length and type of a chunk.
const CHUNK: usize = 8;

/// The chunks of a GLB file.
pub(super) struct Chunks<'a> {
    pub json: &'a [u8],
    pub bin: Option<&'a [u8]>,
    /// Number of bytes beyond the length that the header gives.
    pub extra: usize,
}

/// Splits a GLB file into its chunks. Chunks of other types are ignored, as the specification requires.
pub(super) fn split(bytes: &[u8]) -> Result<Chunks<'_>> {
    let version = u32_at(bytes, 4).ok_or_else(|| ends(bytes))?;
    if version != 2 {
        let cause = format!("GLB version {version} is not supported, only 2 is");
        return Err(malformed(Place::Byte(4), cause, "export it as glTF 2.0"));
    }
    let length = u32_at(bytes, 8).ok_or_else(|| ends(bytes))? as usize;
    let Some(file) = bytes.get(..length) else { return Err(ends(bytes)) };
    let (json, mut at) = chunk(file, HEADER, Some(JSON))?;
    let mut bin = None;
    while at < file.len() && bin.is_none() {
        let kind = u32_at(file, at + 4);
        let (content, next) = chunk(file, at, None)?;
        bin = (kind == Some(BIN)).then_some(content);
        at = next;
    }
    Ok(Chunks { json, bin, extra: bytes.len() - length })
}

fn ends(bytes: &[u8]) -> Error {
    malformed(Place::Byte(bytes.len()), "the file ends before the length in its header", CUT_SHORT)
}

/// Returns the content of the chunk at `at`, which must be of type `kind` if one is given, and the start of the next chunk.
fn chunk(file: &[u8], at: usize, kind: Option<u32>) -> Result<(&[u8], usize)> {
    let header = u32_at(file, at).zip(u32_at(file, at + 4));
    let (length, found) = header.ok_or_else(|| malformed(Place::Byte(at), "a chunk has no header", CUT_SHORT))?;
    if kind.is_some_and(|kind| kind != found) {
        return Err(malformed(Place::Byte(at), "the first chunk is not JSON", EXPORT_AGAIN));
    }
    let rest = &file[at + CHUNK..];
    let content = rest.get(..length as usize).ok_or_else(|| {
        let cause = format!("a chunk has {length} bytes, but only {} are left", rest.len());
        malformed(Place::Byte(at), cause, CUT_SHORT)
    })?;
    Ok((content, at + CHUNK + content.len()))
}

/// Assembles a GLB file. The length of `bin` must be a multiple of four.
///
/// # Errors
/// If the file would be larger than 4 GB; else errors of `out`.
pub(super) fn join(mut json: Vec<u8>, bin: &[u8], out: &mut dyn Write) -> io::Result<()> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let bin_chunk = if bin.is_empty() { 0 } else { CHUNK + bin.len() };
    let size =
        |length: usize| u32::try_from(length).map_err(|_| io::Error::other("a GLB file cannot be larger than 4 GB"));
    out.write_all(MAGIC)?;
    out.write_all(&2u32.to_le_bytes())?;
    out.write_all(&size(HEADER + CHUNK + json.len() + bin_chunk)?.to_le_bytes())?;
    for (kind, content) in [(JSON, &json[..]), (BIN, bin)] {
        if !content.is_empty() {
            out.write_all(&size(content.len())?.to_le_bytes())?;
            out.write_all(&kind.to_le_bytes())?;
            out.write_all(content)?;
        }
    }
    Ok(())
}
