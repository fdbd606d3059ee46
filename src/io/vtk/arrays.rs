//! Numbers of an array in an XML file: in text, or packed as bytes, raw or in base64, inline or appended.

use crate::base::error::{Place, Result};
use crate::io::base64;
use crate::io::bytes::{CUT_SHORT, malformed, unpacks_to_too_much};
use crate::io::numbers::{Order, Type};
use crate::io::text::{Words, number, quote};
use flate2::read::ZlibDecoder;
use std::io::Read;

/// How the arrays of a file are packed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Packing {
    pub order: Order,
    /// Type of the lengths before the numbers.
    pub header: Type,
    pub compressed: bool,
}

/// Reads numbers in text.
pub(super) fn in_text(text: &str) -> Result<Vec<f64>> {
    let mut words = Words::new(text.as_bytes());
    let mut numbers = Vec::new();
    while let Some(word) = words.anywhere() {
        let value = number(word);
        let wrong = || malformed(Place::Whole, format!("{} in an array is not a number", quote(word)), CUT_SHORT);
        numbers.push(value.ok_or_else(wrong)?);
    }
    Ok(numbers)
}

/// Reads numbers in bytes. Subtracts their size from `budget`, the number of bytes that the file may still unpack to.
pub(super) fn in_bytes(mut source: Bytes, kind: Type, packing: Packing, budget: &mut usize) -> Result<Vec<f64>> {
    let damaged = || malformed(Place::Whole, "the bytes of an array are missing or damaged", CUT_SHORT);
    let mut length = || {
        let bytes = source.take(packing.header.size())?;
        let length = packing.header.read(&bytes, packing.order);
        (length < usize::MAX as f64).then_some(length as usize)
    };
    let first = length().ok_or_else(damaged)?;
    if !packing.compressed {
        *budget = budget.checked_sub(first).ok_or_else(|| unpacks_to_too_much(SAVE_PLAIN))?;
        return Ok(kind.read_all(&source.take(first).ok_or_else(damaged)?, packing.order).collect());
    }
    // The number of blocks, their size, the size of the last one if it differs (else 0), and the compressed size of each.
    let (size, last) = length().zip(length()).ok_or_else(damaged)?;
    let mut packed = Vec::new();
    for _ in 0..first {
        packed.push(length().ok_or_else(damaged)?);
    }
    let mut unpacked = Vec::new();
    for (i, &block) in packed.iter().enumerate() {
        let size = if i + 1 == packed.len() && last > 0 { last } else { size };
        *budget = budget.checked_sub(size).ok_or_else(|| unpacks_to_too_much(SAVE_PLAIN))?;
        let bytes = source.take(block).ok_or_else(damaged)?;
        let before = unpacked.len();
        let read = ZlibDecoder::new(&bytes[..]).take(size as u64).read_to_end(&mut unpacked);
        if read.is_err() || unpacked.len() != before + size {
            return Err(damaged());
        }
    }
    Ok(kind.read_all(&unpacked, packing.order).collect())
}

const SAVE_PLAIN: &str = "save it without compression";

/// Raw bytes or base64, read from front to back.
pub(super) struct Bytes<'a> {
    rest: &'a [u8],
    encoded: bool,
    /// Bytes that were decoded and not taken yet.
    ready: Vec<u8>,
}

impl<'a> Bytes<'a> {
    pub fn new(rest: &'a [u8], encoded: bool) -> Self {
        Bytes { rest, encoded, ready: Vec::new() }
    }

    /// Returns the next `count` bytes. Base64 may be padded in the middle, where one piece ends and another begins.
    fn take(&mut self, count: usize) -> Option<Vec<u8>> {
        if count > self.rest.len() + self.ready.len() {
            return None;
        }
        if !self.encoded {
            let (taken, rest) = self.rest.split_at(count);
            self.rest = rest;
            return Some(taken.to_vec());
        }
        let mut taken = std::mem::take(&mut self.ready);
        while taken.len() < count {
            let mut group = [b'='; 4];
            for digit in &mut group {
                let start = self.rest.iter().position(|b| !b.is_ascii_whitespace())?;
                *digit = self.rest[start];
                self.rest = &self.rest[start + 1..];
            }
            let (bytes, length) = base64::decode_group(group)?;
            taken.extend_from_slice(&bytes[..length]);
        }
        self.ready = taken.split_off(count);
        Some(taken)
    }
}
