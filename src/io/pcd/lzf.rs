//! LZF, the compression of LibLZF by Marc Lehmann: literal runs, and copies of earlier bytes.
//!
//! A control byte below 32 is the length of a literal run, less one. Any other has in its upper three bits the length of a
//! copy, less two, to which the next byte is added if all three bits are set; its lower five bits and one more byte are the
//! distance, less one.

/// Maximum number of bytes per compressed byte: three compressed bytes can copy 264.
const MOST_PER_BYTE: usize = 88;

/// Decompresses `packed` to `size` bytes. Returns `None` if it yields more or fewer bytes, or is malformed.
pub(super) fn decompress(packed: &[u8], size: usize) -> Option<Vec<u8>> {
    if size > packed.len().saturating_mul(MOST_PER_BYTE) {
        return None;
    }
    let mut out = Vec::with_capacity(size);
    let mut bytes = packed.iter().copied();
    while let Some(control) = bytes.next() {
        let (length, upper) = (usize::from(control >> 5), usize::from(control & 31));
        if length == 0 {
            let run = upper + 1;
            let start = packed.len() - bytes.len();
            out.extend_from_slice(packed.get(start..start + run)?);
            bytes.nth(run - 1)?;
        } else {
            let length = 2 + length + if length == 7 { usize::from(bytes.next()?) } else { 0 };
            let distance = 1 + (upper << 8) + usize::from(bytes.next()?);
            let start = out.len().checked_sub(distance)?;
            // A copy may overlap itself.
            for i in start..start + length {
                out.push(out[i]);
            }
        }
        if out.len() > size {
            return None;
        }
    }
    (out.len() == size).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_and_copies() {
        assert_eq!(decompress(&[2, b'a', b'b', b'c'], 3).unwrap(), b"abc");
        assert_eq!(decompress(&[0, b'a', 0x20, 0], 4).unwrap(), b"aaaa");
        assert_eq!(decompress(&[1, b'a', b'b', 0xE0, 1, 1], 12).unwrap(), b"abababababab");
        assert_eq!(decompress(&[], 0).unwrap(), b"");
    }

    #[test]
    fn what_makes_no_sense() {
        for (packed, size) in [
            (&[2u8, b'a'][..], 3),
            (&[0, b'a', 0x20], 4),
            (&[0, b'a', 0x20, 1], 4),
            (&[0, b'a', 0x20, 0], 5),
            (&[0, b'a', 0x20, 0], 3),
            (&[0, b'a'], 1 << 30),
        ] {
            assert_eq!(decompress(packed, size), None);
        }
    }
}
