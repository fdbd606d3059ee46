//! Words, lines and numbers of text files that need not be UTF-8.

use super::bytes::{CORRECT_LINE, malformed, without_mark};
use crate::base::count::counted;
use crate::base::error::{Error, Place, Result};
use std::io::{self, Write};

/// Maximum length of a word in a message. Longer words of broken files are cut.
const QUOTED: usize = 24;

/// A cursor over the words of a text, separated by white space, after an optional byte order mark. Lines end with LF, CR LF
/// or CR.
#[derive(Clone)]
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Line of position `at`.
    line_here: usize,
    /// Line of the last word.
    line: usize,
    comments: bool,
    continued: bool,
}

impl<'a> Words<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Words { bytes: without_mark(bytes), at: 0, line_here: 1, line: 1, comments: false, continued: false }
    }

    /// Enables comments: `#` at the start of a word makes the rest of its line a comment.
    pub fn with_comments(self) -> Self {
        Words { comments: true, ..self }
    }

    /// Enables continued lines: a backslash at the end of a line, but not of a comment, joins the next line to it.
    pub fn with_continued_lines(self) -> Self {
        Words { continued: true, ..self }
    }

    /// Sets the number of the line in its file on which the text begins.
    pub fn starting_at(self, line: usize) -> Self {
        Words { line_here: line, line, ..self }
    }

    /// Line of the last word, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// Number of bytes that have not been consumed.
    pub fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Returns the next word on this line.
    #[inline]
    pub fn here(&mut self) -> Option<&'a [u8]> {
        loop {
            let rest = &self.bytes[self.at..];
            let start = rest.iter().position(|&b| !is_blank(b)).unwrap_or(rest.len());
            self.at += start;
            let rest = &rest[start..];
            let length = rest.iter().position(|&b| is_space(b)).unwrap_or(rest.len());
            let (word, rest) = rest.split_at(length);
            if word.is_empty() || (self.comments && word[0] == b'#') {
                return None;
            }
            self.at += length;
            self.line = self.line_here;
            match word.strip_suffix(b"\\") {
                Some(word) if self.continued && rest.first().is_none_or(|&b| is_end(b)) => {
                    self.step_over_end();
                    if !word.is_empty() {
                        return Some(word);
                    }
                }
                _ => return Some(word),
            }
        }
    }

    /// Whether this line ends at the next byte. Returns false if that byte is not sufficient to tell.
    #[inline]
    pub fn ends_here(&self) -> bool {
        self.bytes.get(self.at).is_none_or(|&b| is_end(b))
    }

    /// Returns the next word on this line or a later one.
    pub fn anywhere(&mut self) -> Option<&'a [u8]> {
        loop {
            match self.here() {
                Some(word) => return Some(word),
                None if !self.next_line() => return None,
                None => {}
            }
        }
    }

    /// Goes to the start of the next line. Returns false at the end of the text.
    pub fn next_line(&mut self) -> bool {
        loop {
            let rest = &self.bytes[self.at..];
            let length = rest.iter().position(|&b| is_end(b)).unwrap_or(rest.len());
            self.at += length;
            self.step_over_end();
            if !(self.continued && rest[..length].ends_with(b"\\") && !has_comment(&rest[..length])) {
                return self.at < self.bytes.len();
            }
        }
    }

    fn step_over_end(&mut self) {
        let length = match self.bytes[self.at..] {
            [] => return,
            [b'\r', b'\n', ..] => 2,
            _ => 1,
        };
        self.at += length;
        self.line_here += 1;
    }

    /// Returns the error that the line of the last word is wrong because of `cause`.
    pub fn error(&self, cause: impl Into<String>, remedy: &str) -> Error {
        malformed(Place::Line(self.line), cause, remedy)
    }

    /// Returns the error for a malformed line.
    pub fn mistake(&self, cause: impl Into<String>) -> Error {
        self.error(cause, CORRECT_LINE)
    }

    /// Returns a finite number, from the next word that `next` finds.
    #[inline]
    pub fn coordinate(&mut self, next: impl FnOnce(&mut Self) -> Option<&'a [u8]>) -> Result<f64> {
        match next(self) {
            Some(word) => self.finite(word),
            None => Err(self.mistake("a coordinate is missing")),
        }
    }

    /// Parses a word as a finite number.
    #[inline]
    pub fn finite(&self, word: &[u8]) -> Result<f64> {
        match number(word) {
            Some(number) if number.is_finite() => Ok(number),
            Some(_) => Err(self.mistake(format!("the coordinate {} is not finite", quote(word)))),
            None => Err(self.mistake(format!("{} is not a number", quote(word)))),
        }
    }
}

/// Whether `b` ends a word.
#[inline]
fn is_space(b: u8) -> bool {
    // The first comparison decides for nearly all bytes.
    b <= b' ' && (is_blank(b) || is_end(b))
}

#[inline]
fn is_blank(b: u8) -> bool {
    matches!(b, b' ' | b'\t' | 0x0B | 0x0C)
}

#[inline]
fn is_end(b: u8) -> bool {
    matches!(b, b'\n' | b'\r')
}

fn has_comment(line: &[u8]) -> bool {
    line.starts_with(b"#") || line.windows(2).any(|pair| is_blank(pair[0]) && pair[1] == b'#')
}

/// Parses a word as a number, which may be infinite or NaN.
#[inline]
pub(super) fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Quotes a word for a message: short and printable.
pub(super) fn quote(word: &[u8]) -> String {
    let short = &word[..word.len().min(QUOTED)];
    let dots = if short.len() < word.len() { "..." } else { "" };
    format!("'{}{dots}'", short.escape_ascii())
}

/// Parses a whole number without a sign, of at most 19 digits.
#[inline]
pub(super) fn whole(word: &[u8]) -> Option<usize> {
    // Twenty digits or more never fit.
    if word.is_empty() || word.len() > 19 || !word.iter().all(u8::is_ascii_digit) {
        return None;
    }
    let number = word.iter().fold(0u64, |sum, b| 10 * sum + u64::from(b - b'0'));
    usize::try_from(number).ok()
}

/// Writes the numbers of one line after `head`, in the shortest form that reads as the same f64.
pub(super) fn write_line(out: &mut dyn Write, head: &str, numbers: impl IntoIterator<Item = f64>) -> io::Result<()> {
    out.write_all(head.as_bytes())?;
    for (i, number) in numbers.into_iter().enumerate() {
        if i > 0 || !head.is_empty() {
            out.write_all(b" ")?;
        }
        write_number(out, number)?;
    }
    out.write_all(b"\n")
}

/// Writes a number in the shortest form that reads as the same f64.
pub(super) fn write_number(out: &mut dyn Write, number: f64) -> io::Result<()> {
    // Display never uses an exponent: 1e-300 would be three hundred zeros.
    if number != 0.0 && !(1e-5..1e16).contains(&number.abs()) {
        write!(out, "{number:e}")
    } else {
        write!(out, "{number}")
    }
}

/// Adds a note on `count` items that are left out, if there are any. `one` and `many` name them in the singular and the
/// plural.
pub(super) fn left_out(notes: &mut Vec<String>, count: usize, one: &str, many: &str) {
    if count > 0 {
        notes.push(counted(count, &format!("{one} is left out"), &format!("{many} are left out")));
    }
}

/// Adds a note on faces with fewer than three corners.
pub(super) fn small_faces(notes: &mut Vec<String>, count: usize) {
    left_out(notes, count, "face with fewer than three corners", "faces with fewer than three corners");
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(mut words: Words) -> Vec<(usize, String)> {
        let mut found = Vec::new();
        while let Some(word) = words.anywhere() {
            found.push((words.line(), String::from_utf8_lossy(word).into_owned()));
        }
        found
    }

    #[test]
    fn lines_end_in_three_ways_and_comments_with_them() {
        let found =
            all(Words::new("\u{FEFF}a b#c\r\n# d\re\n\n  #f\\\ng".as_bytes()).with_comments().with_continued_lines());
        let expected = [(1, "a"), (1, "b#c"), (3, "e"), (6, "g")];
        assert_eq!(found, expected.map(|(line, word)| (line, word.to_string())));
    }

    #[test]
    fn lines_are_joined_where_the_format_says_so() {
        let mut joined =
            Words::new(b"f 1 2\\\r\n 3 \\\n 4\nx \\\n y\nz # \\\nw\\").with_comments().with_continued_lines();
        let mut lines = Vec::new();
        loop {
            let mut line = Vec::new();
            while let Some(word) = joined.here() {
                line.push(String::from_utf8_lossy(word).into_owned());
            }
            lines.push(line.join(" "));
            if !joined.next_line() {
                break;
            }
        }
        assert_eq!(lines, ["f 1 2 3 4", "x y", "z", "w"]);
        assert_eq!(all(Words::new(b"a\\\nb")), [(1, "a\\".to_string()), (2, "b".to_string())]);
        let mut skipped = Words::new(b"g a \\\nv\ng # \\\nb").with_comments().with_continued_lines();
        assert!(skipped.next_line() && skipped.here() == Some(b"g") && skipped.next_line());
        assert_eq!(skipped.here(), Some(&b"b"[..]));
    }

    #[test]
    fn numbers_are_finite() {
        for (text, expected) in [("1e-5", Some(1e-5)), ("-.5", Some(-0.5)), ("+2.", Some(2.0)), ("nan", None)] {
            assert_eq!(Words::new(text.as_bytes()).coordinate(Words::here).ok(), expected);
        }
        for text in ["inf", "1e999", "1,5", "", "0x1", "\u{FF11}"] {
            assert!(Words::new(text.as_bytes()).coordinate(Words::here).is_err());
        }
        assert_eq!(
            [&b"12"[..], b"", b"-1", b"1x", b"99999999999999999999999"].map(whole),
            [Some(12), None, None, None, None]
        );
    }

    #[test]
    fn texts_may_begin_on_any_line_and_be_without_comments() {
        let expected = [(7, "a"), (8, "#"), (8, "b")];
        assert_eq!(all(Words::new(b"a\n# b").starting_at(7)), expected.map(|(line, word)| (line, word.to_string())));
    }

    #[test]
    fn quotes_are_short_and_printable() {
        assert_eq!(quote(b"a\x00b\xFF"), "'a\\x00b\\xff'");
        assert_eq!(quote(&[b'x'; 30]), format!("'{}...'", "x".repeat(24)));
    }

    #[test]
    fn written_numbers_read_as_the_same() {
        for number in [0.1, -0.0, 1.0, 1e-300, f64::MIN_POSITIVE / 4.0, f64::MAX, 1.0 / 3.0, 123456.789, 1e16, 9.9e-6] {
            let mut text = Vec::new();
            write_line(&mut text, "v", [number; 3]).unwrap();
            assert!(text.len() < 80);
            let mut words = Words::new(&text[1..]);
            for _ in 0..3 {
                assert_eq!(words.coordinate(Words::here).unwrap().to_bits(), number.to_bits());
            }
        }
    }
}
