//! Base64 with the standard alphabet, as used in the data URIs of glTF.

const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Encodes `bytes` as base64, padded with `=` to a multiple of four characters.
pub(crate) fn encode(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let bits = group.iter().enumerate().fold(0u32, |bits, (i, &b)| bits | u32::from(b) << (16 - 8 * i));
        for i in 0..4 {
            let digit = char::from(ALPHABET[(bits >> (18 - 6 * i)) as usize & 63]);
            text.push(if i > group.len() { '=' } else { digit });
        }
    }
    text
}

/// Value of each character, if it is a digit.
const VALUES: [Option<u8>; 256] = {
    let mut values = [None; 256];
    let mut value = 0;
    while value < ALPHABET.len() {
        values[ALPHABET[value] as usize] = Some(value as u8);
        value += 1;
    }
    values
};

/// Decodes `text`, with or without padding. Returns `None` if a character or the length is invalid.
pub(super) fn decode(text: &str) -> Option<Vec<u8>> {
    let digits = text.trim_ascii().trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    for digits in digits.chunks(4) {
        let mut group = [b'='; 4];
        group[..digits.len()].copy_from_slice(digits);
        let (three, length) = decode_group(group)?;
        bytes.extend_from_slice(&three[..length]);
    }
    Some(bytes)
}

/// Decodes four characters, padding included, to one to three bytes. Returns the bytes and their number.
#[inline]
pub(super) fn decode_group(group: [u8; 4]) -> Option<([u8; 3], usize)> {
    let digits = 4 - group.iter().rev().take_while(|&&b| b == b'=').count();
    let mut bits = 0u32;
    for (i, &digit) in group[..digits].iter().enumerate() {
        bits |= u32::from(VALUES[digit as usize]?) << (18 - 6 * i);
    }
    let [_, a, b, c] = bits.to_be_bytes();
    (digits > 1).then_some(([a, b, c], digits - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_texts() {
        // Test vectors of RFC 4648.
        for (bytes, text) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(encode(bytes.as_bytes()), text);
            assert_eq!(decode(text).as_deref(), Some(bytes.as_bytes()));
            assert_eq!(decode(text.trim_end_matches('=')).as_deref(), Some(bytes.as_bytes()));
        }
    }

    #[test]
    fn all_bytes_round_trip() {
        let bytes: Vec<u8> = (0..=255).collect();
        assert_eq!(decode(&encode(&bytes)), Some(bytes));
    }

    #[test]
    fn malformed_texts() {
        for text in ["A", "AAAAA", "AA-A", "AA A", "é", "A=AA"] {
            assert_eq!(decode(text), None, "{text}");
        }
    }
}
