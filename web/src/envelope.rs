//! Encodes requests and answers as bytes: the length of a JSON text in four bytes, little-endian; the text, whose member `sizes`
//! has the lengths of the files that follow; the files.

use serde::{Deserialize, Serialize};

/// The JSON text of an envelope, with the lengths of the files that follow.
#[derive(Serialize, Deserialize)]
struct Letter<T> {
    sizes: Vec<usize>,
    content: T,
}

/// Returns the content of an envelope, and the files in it.
///
/// # Errors
/// A message if the envelope is malformed.
pub fn open<T: for<'de> Deserialize<'de>>(mut bytes: &[u8]) -> Result<(T, Vec<&[u8]>), String> {
    let mut take = |length: usize| -> Result<&[u8], String> {
        let (taken, rest) = bytes.split_at_checked(length).ok_or("a request is cut short")?;
        bytes = rest;
        Ok(taken)
    };
    let length = take(4)?.try_into().map(u32::from_le_bytes).map_err(|_| "a request has no length")?;
    let letter: Letter<T> = serde_json::from_slice(take(length as usize)?).map_err(|e| e.to_string())?;
    let files = letter.sizes.iter().map(|&size| take(size)).collect::<Result<_, _>>()?;
    Ok((letter.content, files))
}

/// Returns an envelope with the given content and files.
pub fn seal<T: Serialize>(content: T, files: &[Vec<u8>]) -> Vec<u8> {
    let letter = Letter { sizes: files.iter().map(Vec::len).collect(), content };
    let text = serde_json::to_vec(&letter).expect("an answer is plain data with text keys");
    let mut bytes = (text.len() as u32).to_le_bytes().to_vec();
    bytes.extend(text);
    files.iter().for_each(|file| bytes.extend(file));
    bytes
}
