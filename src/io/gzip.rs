//! Files compressed by gzip, such as `scan.ply.gz`: decompressed when read, compressed if the name of the output says so.
//!
//! The decompressed size is bounded by a multiple of the file's size, so that a small file cannot exhaust memory.

use super::bytes::{CUT_SHORT, malformed, most_unpacked, unpacks_to_too_much};
use crate::base::error::{Place, Result};
use flate2::read::MultiGzDecoder;
use std::io::Read;
#[cfg(feature = "fs")]
use std::io::{self, Write};

/// Extension of compressed files, after that of their format.
pub(super) const ENDING: &str = "gz";

/// First bytes of a compressed file: the signature, and deflate, the only method of compression.
const MAGIC: [u8; 3] = [0x1F, 0x8B, 8];

pub(super) fn is_packed(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC)
}

/// Decompresses a file.
///
/// # Errors
/// `Error::Format` for a damaged file, or one that decompresses to implausibly many bytes.
pub(super) fn unpack(bytes: &[u8]) -> Result<Vec<u8>> {
    let limit = most_unpacked(bytes.len());
    let mut unpacked = Vec::new();
    let mut source = MultiGzDecoder::new(bytes).take(limit as u64 + 1);
    if let Err(error) = source.read_to_end(&mut unpacked) {
        return Err(malformed(Place::Whole, format!("it cannot be unpacked: {error}"), CUT_SHORT));
    }
    if unpacked.len() > limit {
        return Err(unpacks_to_too_much("unpack it with gunzip if that is right"));
    }
    Ok(unpacked)
}

/// Compresses what `fill` writes.
///
/// # Errors
/// Those of `fill` and of `out`.
#[cfg(feature = "fs")]
pub(super) fn pack(out: &mut dyn Write, fill: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut packer = flate2::write::GzEncoder::new(out, flate2::Compression::default());
    fill(&mut packer)?;
    packer.finish().map(drop)
}

#[cfg(all(test, feature = "fs"))]
mod tests {
    use super::*;
    use crate::io::bytes::samples::fault;

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        pack(&mut out, &mut |out| out.write_all(bytes)).unwrap();
        out
    }

    #[test]
    fn what_is_packed_comes_back() {
        let bytes: Vec<u8> = (0..100_000u32).flat_map(u32::to_le_bytes).collect();
        let file = packed(&bytes);
        assert!(is_packed(&file) && file.len() < bytes.len());
        assert_eq!(unpack(&file).unwrap(), bytes);
        assert_eq!(unpack(&[&file[..], &packed(b"more")].concat()).unwrap(), [&bytes[..], b"more"].concat());
        for end in [3, 10, file.len() / 2, file.len() - 1] {
            assert!(fault(unpack(&file[..end])).1.contains("cannot be unpacked"));
        }
    }

    #[test]
    fn what_would_fill_the_memory_is_refused() {
        let file = packed(&vec![0; 8 << 20]);
        assert!(file.len() < 1 << 14);
        assert!(fault(unpack(&file)).1.contains("more than 256 times"));
    }
}
