//! Points as columns of numbers in text: XYZ, XYZN, PTS, ASC, and any other text with one point per line.
//!
//! Columns are separated by white space, commas or semicolons. `#` and `//` begin comments. Lines before the first point may
//! be a heading or the number of points, which is not needed. The first three columns are the position. A heading, even in a
//! comment, that begins with x, y and z and has a word for each column names the other columns. Without one, the meaning of
//! columns is guessed from their numbers: three in a row are normals if their length is one, colours if they are fractions
//! or integers up to 255 or 65535, and normals of any length if they are the only ones; any other column is an attribute by
//! itself. Notes tell the interpretation of each column.
//!
//! Limits: no decimal commas.
//!
//! Cost: one pass; eight bytes per number.

#[cfg(feature = "fs")]
mod rows;

#[cfg(feature = "fs")]
pub(crate) use rows::table;

use crate::base::error::{Place, Result};
use crate::io::bytes::malformed;
use crate::io::columns::{are_unit, color, cut, normal};
use crate::io::content::{Content, Parsed, Read};
use crate::io::text::{Words, number, quote, write_number};
use crate::mesh::attributes::{Attribute, Attributes, Scalar};
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;
use std::io::{self, Write};

/// Number of lines that are read to tell whether a text is a table.
const PROBE: usize = 8;

/// Number of bytes that are searched to tell whether a file is text at all.
const HEAD: usize = 4096;

/// Names of normals and colours in headings.
const NORMALS: [[&str; 3]; 2] = [["nx", "ny", "nz"], ["normal_x", "normal_y", "normal_z"]];
const COLORS: [[&str; 3]; 2] = [["r", "g", "b"], ["red", "green", "blue"]];

/// Meaning of a single further column, which many scanners write.
const INTENSITY: &str = "intensity";

/// The rows of a table, and its heading.
#[derive(Default)]
struct Table {
    heading: Vec<String>,
    width: usize,
    values: Vec<f64>,
}

pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    if is_binary(bytes) {
        let remedy = "export its points as columns of text, one point per line, or as PLY, PCD or LAS";
        return Err(malformed(Place::Whole, "it is binary, not text with columns of numbers", remedy));
    }
    let mut table = Table::default();
    table.lines(Words::new(bytes))?;
    if table.width == 0 {
        return Err(malformed(Place::Whole, "there are no numbers in it", "check that it has one point per line"));
    }
    Ok(table.finish())
}

/// Writes positions, each followed by all numbers of the vertex, under a comment that names the columns.
pub(crate) fn write(content: &Content, out: &mut dyn Write) -> io::Result<()> {
    let attributes = &content.attributes.vertex;
    let names = attributes.iter().flat_map(Attribute::component_names);
    writeln!(
        out,
        "# x y z{}",
        names.map(|name| format!(" {}", name.replace(char::is_whitespace, "_"))).collect::<String>()
    )?;
    for (v, p) in content.positions.iter().enumerate() {
        let numbers = p.to_array().into_iter().chain(attributes.iter().flat_map(|a| a.of(v)).copied());
        for (k, x) in numbers.enumerate() {
            out.write_all(if k > 0 { b" " } else { b"" })?;
            write_number(out, x)?;
        }
        out.write_all(b"\n")?;
    }
    Ok(())
}

/// Whether a text is certainly a table of points: its first lines are rows of equally many numbers, preceded only by
/// comments, a heading and a number of points.
pub(crate) fn is_table(bytes: &[u8]) -> bool {
    let mut words = Words::new(bytes);
    let (mut row, mut width) = (Vec::new(), None);
    for _ in 0..PROBE {
        match read_line(&mut words, &mut row) {
            Line::Row if row.len() >= 3 && width.is_none_or(|width| width == row.len()) => width = Some(row.len()),
            Line::Row if row.len() == 1 && width.is_none() => {}
            Line::Words(heading) if width.is_none() && is_heading(&heading) => {}
            Line::Row | Line::Words(_) => return false,
            Line::Empty | Line::Comment(_) => {}
        }
        row.clear();
        if !words.next_line() {
            break;
        }
    }
    width.is_some() && !is_binary(bytes)
}

/// Whether a file is not text: it has a zero byte near its beginning.
fn is_binary(bytes: &[u8]) -> bool {
    bytes[..bytes.len().min(HEAD)].contains(&0)
}

impl Table {
    /// Adds all lines of a text.
    fn lines(&mut self, mut words: Words) -> Result<()> {
        loop {
            self.line(&mut words)?;
            if !words.next_line() {
                return Ok(());
            }
        }
    }

    /// Returns the points of the rows, and the attributes in their further columns.
    fn finish(self) -> Read {
        let Table { heading, width, values } = self;
        let positions = values.chunks_exact(width).map(|row| DVec3::new(row[0], row[1], row[2])).collect();
        let (vertex, notes) = attributes(&values, width, &heading);
        let attributes = Attributes { vertex, ..Attributes::default() };
        Read { mesh: Mesh { positions, triangles: Vec::new() }, attributes, notes }
    }

    fn line(&mut self, words: &mut Words) -> Result<()> {
        let before = self.values.len();
        let line = read_line(words, &mut self.values);
        let found = self.values.len() - before;
        match line {
            Line::Words(heading) | Line::Comment(heading) if self.width == 0 => {
                self.values.truncate(before);
                if is_heading(&heading) {
                    self.heading = heading;
                }
            }
            Line::Empty | Line::Comment(_) => {}
            Line::Words(words_of_line) => {
                let wrong = words_of_line.iter().find(|word| number(word.as_bytes()).is_none());
                let wrong = quote(wrong.map_or("", |word| word).as_bytes());
                return Err(words.mistake(format!("{wrong} is not a number")));
            }
            // The number of points.
            Line::Row if self.width == 0 && found == 1 => self.values.clear(),
            Line::Row if self.width == 0 && found < 3 => {
                return Err(words.mistake(format!("the line has {found} columns, but x, y and z are needed")));
            }
            Line::Row if self.width != 0 && found != self.width => {
                return Err(
                    words.mistake(format!("the line has {found} columns, but the lines before it have {}", self.width))
                );
            }
            Line::Row => self.width = found,
        }
        match self.values[before.min(self.values.len())..].iter().take(3).find(|x| !x.is_finite()) {
            Some(x) => Err(words.mistake(format!("the coordinate {x} is not finite"))),
            None => Ok(()),
        }
    }
}

/// Content of a line.
enum Line {
    Empty,
    /// All words of a comment.
    Comment(Vec<String>),
    /// Numbers only.
    Row,
    /// All its words, some of which are not numbers.
    Words(Vec<String>),
}

/// Reads the next line. Its numbers are added to `values`.
fn read_line(words: &mut Words, values: &mut Vec<f64>) -> Line {
    let start = words.clone();
    let mut line = Line::Empty;
    while let Some(word) = words.here() {
        if word.starts_with(b"#") || word.starts_with(b"//") {
            return if matches!(line, Line::Empty) { Line::Comment(all_words(start)) } else { line };
        }
        for part in parts(word) {
            match number(part) {
                Some(x) => values.push(x),
                None => return Line::Words(all_words(start)),
            }
            line = Line::Row;
        }
    }
    line
}

fn parts(word: &[u8]) -> impl Iterator<Item = &[u8]> {
    word.split(|b| matches!(b, b',' | b';')).filter(|part| !part.is_empty())
}

/// Returns the words of a line without the comment mark.
fn all_words(mut words: Words) -> Vec<String> {
    let mut all = Vec::new();
    while let Some(word) = words.here() {
        all.extend(parts(word).map(|part| String::from_utf8_lossy(part).trim_start_matches(['#', '/']).to_string()));
    }
    all.retain(|word| !word.is_empty());
    all
}

fn is_heading(words: &[String]) -> bool {
    words.len() >= 3 && words.iter().zip(["x", "y", "z"]).all(|(word, name)| word.eq_ignore_ascii_case(name))
}

/// Returns the attributes in the columns after the third, and notes that name them.
fn attributes(values: &[f64], width: usize, heading: &[String]) -> (Vec<Attribute>, Vec<String>) {
    let (mut found, mut notes) = (Vec::new(), Vec::new());
    let heading = if heading.len() == width { heading } else { &[] };
    let mut at = 3;
    while at < width {
        let known = match heading.get(at..at + 3) {
            _ if at + 3 > width => None,
            Some(names) => three_named(values, width, at, names),
            None => three(values, width, at),
        };
        let (attribute, what) = known.unwrap_or_else(|| (single(values, width, at, heading), ""));
        let last = at + attribute.components;
        notes.push(match what {
            "" => format!("column {last} is taken as '{}'", attribute.name),
            _ => format!("columns {} to {last} are taken as {what}", at + 1),
        });
        found.push(attribute);
        at = last;
    }
    (found, notes)
}

/// Returns the three columns from `at` on as normals or colours, if the heading names them so.
fn three_named(values: &[f64], width: usize, at: usize, names: &[String]) -> Option<(Attribute, &'static str)> {
    let numbers = || cut(values, width, at, at + 3);
    let is = |known: &[&str; 3]| names.iter().zip(known).all(|(name, known)| name.eq_ignore_ascii_case(known));
    if NORMALS.iter().any(is) {
        return Some((normal(numbers()), "normals, as the heading says"));
    }
    let color = if COLORS.iter().any(is) { color(numbers(), 3) } else { None };
    color.map(|color| (color, "colours, as the heading says"))
}

/// Returns the three columns from `at` on as normals or colours, if their numbers suggest it.
fn three(values: &[f64], width: usize, at: usize) -> Option<(Attribute, &'static str)> {
    let numbers = cut(values, width, at, at + 3);
    if are_unit(&numbers) {
        return Some((normal(numbers), "normals: their length is one"));
    }
    if let Some(color) = color(numbers.clone(), 3) {
        let bytes = color.scalar == Scalar::U8;
        return Some((
            color,
            if bytes { "colours: whole numbers up to 255" } else { "colours: fractions from 0 to 1" },
        ));
    }
    (width == 6).then(|| (normal(numbers), "normals, though not of length one"))
}

/// Returns column `at` as an attribute by itself.
fn single(values: &[f64], width: usize, at: usize, heading: &[String]) -> Attribute {
    let unnamed = || if width == 4 || width == 7 { INTENSITY.into() } else { format!("column_{}", at + 1) };
    let name = heading.get(at).cloned().unwrap_or_else(unnamed);
    Attribute { name, components: 1, values: cut(values, width, at, at + 1), scalar: Scalar::F64 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::bytes::samples;

    fn names(text: &str) -> Vec<(String, usize, Scalar)> {
        let read = parse(text.as_bytes()).unwrap();
        assert_eq!(read.notes.len(), read.attributes.vertex.len());
        read.attributes.vertex.into_iter().map(|a| (a.name, a.components, a.scalar)).collect()
    }

    #[track_caller]
    fn fails_at(text: &str, line: usize, words: &str) {
        samples::fails_at(parse(text.as_bytes()), line, words);
    }

    #[test]
    fn columns_are_parted_in_all_ways() {
        for text in [
            "1 2 3\n4 5 6",
            "1\t2\t3\r\n4\t5\t6\r\n",
            "1,2,3\n4, 5, 6\n",
            "1;2;3;\n4;5;6;\n",
            "# a\n2\n\n1 2 3 // b\n4 5 6 # c\n",
            "x y z\n1 2 3\n4 5 6\n",
            "//X,Y,Z\r1,2,3\r4,5,6\r",
        ] {
            let read = parse(text.as_bytes()).unwrap();
            assert_eq!(read.mesh.positions, [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)], "{text}");
            assert!(read.attributes.is_empty() && read.notes.is_empty());
        }
    }

    #[test]
    fn what_columns_are_is_found_from_their_numbers() {
        let normal = || ("normal".to_string(), 3, Scalar::F64);
        let bytes = || ("color".to_string(), 3, Scalar::U8);
        let one = |name: &str| (name.to_string(), 1, Scalar::F64);
        assert_eq!(names("0 0 0 0.6 0.8 0\n1 0 0 0 0 1\n"), [normal()]);
        assert_eq!(names("0 0 0 255 8 0\n1 0 0 0 0 1\n"), [bytes()]);
        assert_eq!(names("0 0 0 0.5 0.5 0\n"), [("color".to_string(), 3, Scalar::F32)]);
        assert_eq!(names("0 0 0 2.5 0.5 -7\n"), [normal()]);
        assert_eq!(names("0 0 0 -7\n"), [one("intensity")]);
        assert_eq!(names("0 0 0 -7 9 9 9\n"), [one("intensity"), bytes()]);
        assert_eq!(names("0 0 0 9 9 9 0 0 -1\n"), [bytes(), normal()]);
        assert_eq!(names("x y z a b\n0 0 0 9 9\n"), [one("a"), one("b")]);
        assert_eq!(names("# x y z a b c\n0 0 0 9 9 9\n"), [one("a"), one("b"), one("c")]);
        assert_eq!(names("//X,Y,Z,R,G,B,Nx,Ny,Nz\n0 0 0 9 9 9 0 0 4\n"), [bytes(), normal()]);
        assert_eq!(names("0 0 0 9 9\n"), [one("column_4"), one("column_5")]);
    }

    #[test]
    fn errors_name_the_line() {
        fails_at("1 2 3\n1 2\n", 2, "2 columns, but the lines before it have 3");
        fails_at("1 2 3\n\n1 2 3 4\n", 3, "4 columns");
        fails_at("1 2\n", 1, "x, y and z are needed");
        fails_at("1 2 3\n1 x 3\n", 2, "'x' is not a number");
        fails_at("1 2 3\n1 inf 3\n", 2, "not finite");
        for none in ["hello\n", "7\n", "# 1 2 3\n"] {
            assert!(parse(none.as_bytes()).unwrap_err().to_string().contains("no numbers"), "{none}");
        }
    }
}
