//! The values of a PLY body in sequence, independent of its encoding.

use crate::base::error::{Error, Place, Result};
use crate::io::bytes::{CUT_SHORT, EXPORT_AGAIN, malformed};
use crate::io::text::{Words, number, quote};
use crate::mesh::attributes::Scalar;

/// A body that is read from front to back. Each clone has its own position.
pub(super) trait Source: Clone {
    /// Returns the next value, if there is one. All types fit in `f64` exactly.
    fn next(&mut self, kind: Scalar) -> Option<f64>;
    /// Returns the reason why there was no next value.
    fn failure(&self) -> Error;
    /// Returns the next value, or the error that there is none.
    #[inline]
    fn value(&mut self, kind: Scalar) -> Result<f64> {
        match self.next(kind) {
            Some(value) => Ok(value),
            None => Err(self.failure()),
        }
    }
    /// Skips `count` values.
    fn skip(&mut self, kind: Scalar, count: usize) -> Result<()>;
    /// Minimum number of bytes that a value takes.
    fn least(kind: Scalar) -> usize;
    /// Number of bytes that are left.
    fn remaining(&self) -> usize;
    /// Place of the last value.
    fn place(&self) -> Place;
    /// End of the file.
    fn end(&self) -> Place;
    /// Whether anything but white space is left.
    fn has_more(&self) -> bool;
}

#[cold]
pub(super) fn cut_short(place: Place) -> Error {
    malformed(place, "the file ends before its last value", CUT_SHORT)
}

/// A body in text.
#[derive(Clone)]
pub(super) struct Text<'a> {
    words: Words<'a>,
    last: Option<&'a [u8]>,
}

impl<'a> Text<'a> {
    /// Starts at a text that begins on line `line` of the file.
    pub fn new(text: &'a [u8], line: usize) -> Self {
        Text { words: Words::new(text).starting_at(line), last: None }
    }
}

impl Source for Text<'_> {
    #[inline]
    fn next(&mut self, _: Scalar) -> Option<f64> {
        self.last = self.words.anywhere();
        number(self.last?)
    }

    #[cold]
    fn failure(&self) -> Error {
        match self.last {
            Some(word) => self.words.error(format!("{} is not a number", quote(word)), EXPORT_AGAIN),
            None => cut_short(self.place()),
        }
    }

    fn skip(&mut self, _: Scalar, count: usize) -> Result<()> {
        for _ in 0..count {
            self.words.anywhere().ok_or_else(|| cut_short(self.place()))?;
        }
        Ok(())
    }

    /// A digit and white space.
    fn least(_: Scalar) -> usize {
        2
    }

    fn remaining(&self) -> usize {
        // The last value needs no white space after it.
        self.words.remaining() + 1
    }

    fn place(&self) -> Place {
        Place::Line(self.words.line())
    }

    fn end(&self) -> Place {
        let mut rest = self.words.clone();
        while rest.anywhere().is_some() {}
        Place::Line(rest.line())
    }

    fn has_more(&self) -> bool {
        self.words.clone().anywhere().is_some()
    }
}

/// A body in bytes, most significant byte first if `BIG`.
#[derive(Clone)]
pub(super) struct Binary<'a, const BIG: bool> {
    bytes: &'a [u8],
    at: usize,
    last: usize,
}

impl<'a, const BIG: bool> Binary<'a, BIG> {
    /// Starts at byte `at` of a file.
    pub fn new(bytes: &'a [u8], at: usize) -> Self {
        Binary { bytes, at, last: at }
    }

    /// Returns the next `N` bytes, least significant byte first.
    #[inline]
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut bytes = self.bytes[self.at..].first_chunk::<N>().copied()?;
        self.last = self.at;
        self.at += N;
        if BIG {
            bytes.reverse();
        }
        Some(bytes)
    }
}

impl<const BIG: bool> Source for Binary<'_, BIG> {
    #[inline]
    fn next(&mut self, kind: Scalar) -> Option<f64> {
        Some(match kind {
            Scalar::I8 => i8::from_le_bytes(self.take()?).into(),
            Scalar::U8 => u8::from_le_bytes(self.take()?).into(),
            Scalar::I16 => i16::from_le_bytes(self.take()?).into(),
            Scalar::U16 => u16::from_le_bytes(self.take()?).into(),
            Scalar::I32 => i32::from_le_bytes(self.take()?).into(),
            Scalar::U32 => u32::from_le_bytes(self.take()?).into(),
            Scalar::F32 => f32::from_le_bytes(self.take()?).into(),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    #[cold]
    fn failure(&self) -> Error {
        cut_short(self.end())
    }

    #[inline]
    fn skip(&mut self, kind: Scalar, count: usize) -> Result<()> {
        let length = count.checked_mul(kind.size()).filter(|&length| length <= self.remaining());
        self.at += length.ok_or_else(|| cut_short(self.end()))?;
        Ok(())
    }

    fn least(kind: Scalar) -> usize {
        kind.size()
    }

    #[inline]
    fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn place(&self) -> Place {
        Place::Byte(self.last)
    }

    fn end(&self) -> Place {
        Place::Byte(self.bytes.len())
    }

    fn has_more(&self) -> bool {
        !self.bytes[self.at..].trim_ascii().is_empty()
    }
}
