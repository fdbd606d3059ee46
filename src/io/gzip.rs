//! Files packed by gzip, such as `scan.ply.gz`: unpacked when they are read, packed when the name says so.
//!
//! What a packed file holds is bounded by its size, so that a small one cannot fill the memory.

use super::bytes::{CUT_SHORT, malformed, most_unpacked, unpacks_to_too_much};
use crate::base::error::{Place, Result};
use flate2::read::MultiGzDecoder;
use std::io::Read;
#[cfg(feature = "fs")]
use std::io::{self, Write};

/// The ending of packed files, behind that of their format.
pub(super) const ENDING: &str = "gz";

/// The first bytes of a packed file: its mark, and the one way of packing that there is.
const MAGIC: [u8; 3] = [0x1F, 0x8B, 8];

pub(super) fn is_packed(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC)
}

/// What is in a packed file.
///
/// # Errors
/// `Error::Format` for what is damaged, or unpacks to more than its size lets expect.
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

/// Packs what `fill` writes.
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
