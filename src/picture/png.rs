//! Pictures as PNG (ISO/IEC 15948).

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};
use std::io::Write;

const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// Eight bits for each of red, green, blue and opacity; deflated, filtered, not interlaced.
const KIND: [u8; 5] = [8, 6, 0, 0, 0];

/// The filter that stores each byte as its difference from the same byte of the pixel to the left.
const SUB: u8 = 1;

/// Encodes a picture as a PNG file. Pixels are red, green, blue and opacity, row by row from the top, `width` per row.
pub fn encode(pixels: &[[u8; 4]], width: usize) -> Vec<u8> {
    let mut rows = ZlibEncoder::new(Vec::new(), Compression::default());
    for row in pixels.chunks_exact(width) {
        let mut filtered = vec![SUB];
        let mut left = [0; 4];
        for pixel in row {
            filtered.extend((0..4).map(|k| pixel[k].wrapping_sub(left[k])));
            left = *pixel;
        }
        rows.write_all(&filtered).expect("memory does not fail");
    }
    let rows = rows.finish().expect("memory does not fail");
    let size = [width, pixels.len() / width].map(|n| (n as u32).to_be_bytes());
    let mut file = SIGNATURE.to_vec();
    add(&mut file, b"IHDR", &[&size.concat()[..], &KIND].concat());
    add(&mut file, b"IDAT", &rows);
    add(&mut file, b"IEND", &[]);
    file
}

/// Appends a chunk: its length, its name, its content, and a checksum of name and content.
fn add(file: &mut Vec<u8>, name: &[u8; 4], content: &[u8]) {
    let mut sum = Crc::new();
    sum.update(name);
    sum.update(content);
    file.extend((content.len() as u32).to_be_bytes());
    file.extend(name);
    file.extend(content);
    file.extend(sum.sum().to_be_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_reader_reads_it() {
        let pixels: Vec<[u8; 4]> = (0..35u8).map(|n| [n, 3 * n, 255 - n, 7 * n]).collect();
        let file = encode(&pixels, 7);
        let mut reader = png::Decoder::new(std::io::Cursor::new(&file)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!((info.width, info.height, info.color_type), (7, 5, png::ColorType::Rgba));
        assert_eq!(bytes, pixels.concat());
    }
}
