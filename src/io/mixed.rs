//! A cursor over a file that has words, and numbers that are words or bytes.

use super::bytes::{CUT_SHORT, EXPORT_AGAIN, malformed};
use super::numbers::{Order, Type};
use super::text::{number, quote, whole};
use crate::base::error::{Error, Place, Result};

pub(super) struct Mixed<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Byte order of numbers, unless they are words.
    pub binary: Option<Order>,
}

impl<'a> Mixed<'a> {
    /// Starts at the beginning of a file, with numbers as words until `binary` is set.
    pub fn new(bytes: &'a [u8]) -> Self {
        Mixed { bytes, at: 0, binary: None }
    }

    /// Returns the current line, or the byte if numbers are bytes. Scans the file from its start, so it is for errors only.
    pub fn place(&self) -> Place {
        if self.binary.is_some() {
            return Place::Byte(self.at);
        }
        Place::Line(1 + self.bytes[..self.at].iter().filter(|&&b| b == b'\n').count())
    }

    /// Returns the error that the file contradicts itself here.
    pub fn wrong(&self, cause: impl Into<String>) -> Error {
        malformed(self.place(), cause, EXPORT_AGAIN)
    }

    fn cut_short(&self, cause: impl Into<String>) -> Error {
        malformed(self.place(), cause, CUT_SHORT)
    }

    /// Returns the bytes that have not been consumed.
    pub fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// Skips `count` bytes, or to the end.
    pub fn skip(&mut self, count: usize) {
        self.at = self.at.saturating_add(count).min(self.bytes.len());
    }

    /// Goes to byte `at` of the file, if it exists and is not before the current one.
    pub fn go_on_to(&mut self, at: usize) -> Option<()> {
        (self.at..=self.bytes.len()).contains(&at).then(|| self.at = at)
    }

    /// Consumes and returns the rest of this line.
    pub fn line(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let length = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.skip(length + 1);
        &rest[..length]
    }

    /// Returns the next word without consuming it.
    pub fn peek_word(&self) -> Option<&'a [u8]> {
        let rest = self.rest().trim_ascii_start();
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        (length > 0).then(|| &rest[..length])
    }

    /// Consumes and returns the next word, on this line or a later one.
    pub fn word(&mut self) -> Option<&'a [u8]> {
        let word = self.peek_word()?;
        self.at = self.bytes.len() - self.rest().trim_ascii_start().len() + word.len();
        Some(word)
    }

    /// Consumes the next word and returns it in capitals.
    pub fn upper_word(&mut self) -> Option<String> {
        self.word().map(|word| String::from_utf8_lossy(word).to_ascii_uppercase())
    }

    /// Reads a whole number, always as a word.
    pub fn count(&mut self) -> Result<usize> {
        let word = self.word();
        let count = word.and_then(whole);
        count.ok_or_else(|| self.wrong(format!("{} is not a count", quote(word.unwrap_or_default()))))
    }

    /// Reads the next number.
    #[inline]
    pub fn number(&mut self, kind: Type) -> Result<f64> {
        let Some(order) = self.binary else { return self.spelled_number() };
        let Some(bytes) = self.rest().get(..kind.size()) else {
            return Err(self.cut_short("the file ends before its last number"));
        };
        self.at += kind.size();
        Ok(kind.read(bytes, order))
    }

    fn spelled_number(&mut self) -> Result<f64> {
        match self.word() {
            Some(word) => number(word).ok_or_else(|| self.wrong(format!("{} is not a number", quote(word)))),
            None => Err(self.cut_short("the file ends before its last number")),
        }
    }

    /// Reads a count of items that take at least `least` bytes each, if that many can follow.
    pub fn size(&mut self, kind: Type, least: usize) -> Result<usize> {
        let number = self.number(kind)?;
        if !(number >= 0.0 && number.fract() == 0.0) {
            return Err(self.wrong(format!("{number} is not a count")));
        }
        // A conversion that would overflow gives the largest number.
        self.check_room(number as usize, least)?;
        Ok(number as usize)
    }

    /// Refuses a count of items that take at least `least` bytes each, if that many cannot follow.
    pub fn check_room(&self, count: usize, least: usize) -> Result<()> {
        // The last word needs no white space after it.
        let left = self.rest().len();
        if count.checked_mul(least).is_none_or(|needed| needed > left + 1) {
            return Err(self.cut_short(format!("{count} entries are declared, but only {left} bytes follow")));
        }
        Ok(())
    }

    /// Returns the minimum number of bytes that a number takes.
    pub fn least(&self, kind: Type) -> usize {
        // A word takes a digit and white space.
        if self.binary.is_some() { kind.size() } else { 2 }
    }

    /// Reads the next `count` numbers.
    pub fn numbers(&mut self, kind: Type, count: usize) -> Result<Vec<f64>> {
        self.check_room(count, self.least(kind))?;
        (0..count).map(|_| self.number(kind)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::bytes::samples::fault;

    #[test]
    fn words_and_numbers() {
        let mut text = Mixed::new(b" a\nb 3 1.5 x");
        assert_eq!((text.word(), text.line(), text.upper_word()), (Some(&b"a"[..]), &b""[..], Some("B".into())));
        assert_eq!((text.count(), text.number(Type::U8)), (Ok(3), Ok(1.5)));
        assert_eq!(fault(text.number(Type::F64)), (Place::Line(2), "'x' is not a number".into()));
        assert!(fault(text.count()).1.contains("is not a count"));
        let mut bytes = Mixed::new(&[0, 2, 0, 0xFF, 0xFF, 9]);
        bytes.binary = Some(Order::Big);
        assert_eq!((bytes.size(Type::U16, 1), bytes.number(Type::U8)), (Ok(2), Ok(0.0)));
        assert_eq!(fault(bytes.size(Type::U16, 1)).0, Place::Byte(5));
        assert_eq!(fault(bytes.numbers(Type::F64, usize::MAX)).0, Place::Byte(5));
        assert_eq!((bytes.go_on_to(2), bytes.go_on_to(6), bytes.go_on_to(7)), (None, Some(()), None));
    }
}
