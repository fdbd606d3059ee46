//! The points of a text as rows of numbers, converted from its lines block by block.
//!
//! Which columns are normals is decided from the first rows alone, because it must be known before all rows are read.

use super::{Table as Columns, attributes, is_binary};
use crate::base::error::{Place, Result};
use crate::io::bytes::{BECAME_SHORTER, LEAVE_IT, array, malformed};
use crate::io::content::Parsed;
use crate::io::line_blocks::{in_blocks, whole_lines};
use crate::io::table::{Packed, Rows, Table};
use crate::io::text::Words;
use crate::mesh::attributes::NORMAL;
use crate::prepare::thin::Seen;
use glam::DVec3;
use std::fs::File;
use std::io::{ErrorKind, Read as _};

/// Size of a number in a row, in bytes.
const NUMBER: usize = 8;

/// Layout of all rows, derived from the first lines.
#[derive(Clone)]
struct Layout {
    heading: Vec<String>,
    width: usize,
    /// First of the three normal columns.
    normal: Option<usize>,
    /// Number of lines with words or numbers before the first point.
    before: usize,
}

/// Returns the points of a file of this length that begins with `head`, if its first lines form a table.
pub(crate) fn table(head: &[u8], length: u64) -> Option<Table> {
    let whole = if head.len() as u64 == length { head.len() } else { whole_lines(head, 0) };
    let mut first = Columns::default();
    first.lines(Words::new(&head[..whole])).ok().filter(|()| first.width > 0 && !is_binary(head))?;
    let rows = first.values.len() / first.width;
    let mut column = 3;
    let mut normal = None;
    for attribute in attributes(&first.values, first.width, &first.heading).0 {
        if attribute.name == NORMAL {
            normal = Some(column);
        }
        column += attribute.components;
    }
    let layout =
        Layout { heading: first.heading, width: first.width, normal, before: lines_with_words(&head[..whole]) - rows };
    let row = NUMBER * layout.width;
    Some(Table { start: 0, row, points: 0, rows: Box::new(layout.clone()), packed: Some(Box::new(layout)) })
}

impl Layout {
    fn number(row: &[u8], column: usize) -> f64 {
        array(row, NUMBER * column).map_or(0.0, f64::from_le_bytes)
    }

    fn vector(row: &[u8], column: usize) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|k| Layout::number(row, column + k)))
    }
}

impl Rows for Layout {
    fn look(&self, row: &[u8]) -> Seen {
        let normal = self.normal.map_or(DVec3::ZERO, |column| Layout::vector(row, column));
        Seen { position: Layout::vector(row, 0), normal }
    }

    fn read(&self, rows: &[u8]) -> Parsed {
        let values = rows.chunks_exact(NUMBER).map(|number| Layout::number(number, 0)).collect();
        Ok(Columns { heading: self.heading.clone(), width: self.width, values }.finish())
    }
}

impl Packed for Layout {
    fn count(&self, file: &File) -> Result<Option<usize>> {
        let mut lines = 0;
        blocks_of(file, |bytes, _| {
            lines += lines_with_words(bytes);
            Ok(())
        })?;
        Ok(Some(lines - self.before.min(lines)))
    }

    fn unpack(&self, file: &File, show: &mut dyn FnMut(&[u8]) -> Result<()>) -> Result<()> {
        let mut columns = Columns::default();
        let mut row = Vec::new();
        blocks_of(file, |bytes, line| {
            columns.lines(Words::new(bytes).starting_at(line))?;
            for numbers in columns.values.chunks_exact(self.width) {
                row.clear();
                row.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
                show(&row)?;
            }
            columns.values.clear();
            Ok(())
        })
    }
}

/// Passes the text of a file to `show` in blocks of whole lines, each with the number of its first line.
fn blocks_of(mut file: &File, show: impl FnMut(&[u8], usize) -> Result<()>) -> Result<()> {
    let failed = |error: std::io::Error| match error.kind() {
        ErrorKind::UnexpectedEof => malformed(Place::Whole, BECAME_SHORTER, LEAVE_IT),
        _ => malformed(Place::Whole, error.to_string(), "check that it can be read"),
    };
    let length = file.metadata().map_err(failed)?.len();
    in_blocks(length, |bytes| file.read_exact(bytes).map_err(failed), show)
}

/// Returns the number of lines in `bytes` that have something before a comment.
fn lines_with_words(bytes: &[u8]) -> usize {
    let is_line = |line: &[u8]| {
        let line = line.trim_ascii_start();
        !(line.is_empty() || line.starts_with(b"#") || line.starts_with(b"//"))
    };
    bytes.split(|byte| matches!(byte, b'\n' | b'\r')).filter(|line| is_line(line)).count()
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;
    use std::io::{Seek, Write};

    fn file(text: &[u8]) -> File {
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(text).unwrap();
        file.rewind().unwrap();
        file
    }

    fn rows_of(table: &Table, text: &[u8]) -> Result<Vec<u8>> {
        let mut rows = Vec::new();
        table.packed.as_ref().unwrap().unpack(&file(text), &mut |row| {
            rows.extend_from_slice(row);
            Ok(())
        })?;
        Ok(rows)
    }

    fn count(table: &Table, text: &[u8]) -> usize {
        table.packed.as_ref().unwrap().count(&file(text)).unwrap().unwrap()
    }

    #[test]
    fn lines_become_the_rows_that_all_of_the_text_has() {
        for text in [
            "1 2 3\n4 5 6",
            "# a\n2\n\n1 2 3 // b\n4 5 6 # c\n",
            "x y z i\r\n1 2 3 4\r\n  \r\n4 5 6 7\r\n",
            "//X,Y,Z\r1,2,3\r4,5,6\r",
            "0 0 0 255 8 0 0 0 1\n1 0 0 0 0 1 0 1 0\n",
        ] {
            let text = text.as_bytes();
            let table = table(text, text.len() as u64).unwrap();
            let rows = rows_of(&table, text).unwrap();
            let whole = parse(text).unwrap();
            assert_eq!((count(&table, text), rows.len()), (2, 2 * table.row));
            assert_eq!(table.rows.look(&rows[table.row..]).position, whole.mesh.positions[1]);
            let normal = whole.attributes.vertex.iter().find(|attribute| attribute.name == NORMAL);
            let of_second = normal.map_or(DVec3::ZERO, |normal| DVec3::from_slice(&normal.values[3..]));
            assert_eq!(table.rows.look(&rows[table.row..]).normal, of_second);
            assert!(table.rows.read(&rows).unwrap() == whole);
        }
        for none in ["", "hello\n", "1 2\n", "1 2 3\n4 5\n", "1 2 3\n\0"] {
            assert!(table(none.as_bytes(), none.len() as u64).is_none(), "{none}");
        }
    }

    #[test]
    fn what_is_wrong_far_on_has_its_line() {
        let mut text: String = (0..300_000).map(|i| format!("{i} 0.5 -7\n")).collect();
        assert!(text.len() > 3 << 20);
        let table = table(&text.as_bytes()[..1 << 16], text.len() as u64).unwrap();
        assert_eq!(count(&table, text.as_bytes()), 300_000);
        assert_eq!(rows_of(&table, text.as_bytes()).unwrap().len(), 300_000 * 24);
        text.push_str("1 2\n");
        let error = rows_of(&table, text.as_bytes()).unwrap_err().to_string();
        assert!(error.starts_with(":300001: ") && error.contains("2 columns"), "{error}");
    }
}
