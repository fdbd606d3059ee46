//! Text read in blocks of whole lines.

use crate::base::error::Result;

/// Number of bytes read at a time.
const BLOCK: u64 = 1 << 20;

/// Passes a text of `length` bytes, read by `fill`, to `show` in blocks of whole lines, with the number of each block's
/// first line.
///
/// # Errors
/// Those of `fill` and `show`.
pub(super) fn in_blocks(
    length: u64,
    mut fill: impl FnMut(&mut [u8]) -> Result<()>,
    mut show: impl FnMut(&[u8], usize) -> Result<()>,
) -> Result<()> {
    let (mut bytes, mut left, mut line) = (Vec::new(), length, 1);
    while left > 0 {
        let known = bytes.len();
        let more = BLOCK.min(left);
        bytes.resize(known + more as usize, 0);
        fill(&mut bytes[known..])?;
        left -= more;
        let whole = if left == 0 { bytes.len() } else { whole_lines(&bytes, known) };
        if whole > 0 {
            show(&bytes[..whole], line)?;
            line += (0..whole).filter(|&i| ends_line(&bytes[..whole], i)).count();
            bytes.drain(..whole);
        }
    }
    Ok(())
}

/// Returns the length of the longest prefix that ends with a complete line that the next one does not continue. Of the first
/// `known` bytes, only the last can end such a line.
pub(super) fn whole_lines(bytes: &[u8], known: usize) -> usize {
    let continues = |i: usize| bytes[..i].strip_suffix(b"\r").unwrap_or(&bytes[..i]).ends_with(b"\\");
    // A line that ends with CR may go on with LF.
    let is_known = |i: usize| bytes[i] == b'\n' || i + 1 < bytes.len();
    let ends = |&i: &usize| ends_line(bytes, i) && is_known(i) && !continues(i);
    (known.saturating_sub(1)..bytes.len()).rev().find(ends).map_or(0, |i| i + 1)
}

/// Whether a line ends at byte `i`: with LF, CR or CR LF.
fn ends_line(bytes: &[u8], i: usize) -> bool {
    bytes[i] == b'\n' || bytes[i] == b'\r' && bytes.get(i + 1) != Some(&b'\n')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_end_with_whole_lines() {
        assert_eq!(whole_lines(b"v 1 2 3\nf 1 2", 0), 8);
        assert_eq!(whole_lines(b"v 1 2 3\rf 1 2", 0), 8);
        assert_eq!(whole_lines(b"v 1 2 3\r", 0), 0);
        assert_eq!(whole_lines(b"v 1 2 3\r\nf", 8), 9);
        assert_eq!(whole_lines(b"v 1 2 3\nf 1 2 \\\r\n3 4", 0), 8);
        assert_eq!(whole_lines(b"v 1 2 3\nf 1 2 \\\r\n3 4\n\n", 15), 22);
        assert_eq!(whole_lines(b"v 1 2 3", 0), 0);
    }

    #[test]
    fn each_block_has_the_number_of_its_first_line() {
        for end in ["\n", "\r\n", "\r"] {
            let text: String = (1..=400_000).map(|i| format!("{i}{end}")).collect();
            assert!(text.len() as u64 > 2 * BLOCK);
            let (mut at, mut blocks) = (0, 0);
            let fill = |bytes: &mut [u8]| {
                bytes.copy_from_slice(&text.as_bytes()[at..][..bytes.len()]);
                at += bytes.len();
                Ok(())
            };
            let show = |bytes: &[u8], line: usize| {
                assert!(bytes.starts_with(format!("{line}{end}").as_bytes()));
                blocks += 1;
                Ok(())
            };
            in_blocks(text.len() as u64, fill, show).unwrap();
            assert!(blocks > 2);
        }
    }
}
