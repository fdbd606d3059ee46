//! The points of a file that is not compressed, as rows of bytes.

use super::{Cloud, Header, header, nowhere, position};
use crate::base::error::Error;
use crate::io::content::Parsed;
use crate::io::table::{Rows, Table};
use crate::prepare::thin::Seen;
use glam::DVec3;

/// The points of a file of this many bytes that begins with `head`, if they are not compressed.
pub(crate) fn table(head: &[u8], length: u64) -> Option<Table> {
    let header = header(head).ok().filter(|header| !header.compressed)?;
    let Header { start, length: row, count: points, .. } = header;
    let found = length.checked_sub(start as u64)? / row as u64;
    if found < points as u64 || points >= u32::MAX as usize {
        return None;
    }
    Some(Table { start: start as u64, row, points, rows: Box::new(header) })
}

impl Rows for Header {
    fn look(&self, row: &[u8]) -> Seen {
        Seen { position: position(row) * self.scale + self.offset, normal: DVec3::ZERO }
    }

    fn nowhere(&self, point: usize, _: &[u8]) -> Error {
        nowhere(point)
    }

    fn read(&self, rows: &[u8]) -> Parsed {
        let mut cloud = Cloud::default();
        rows.chunks_exact(self.length).for_each(|row| cloud.push(self, row));
        cloud.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{COUNT, las};
    use super::super::{HEADERS, parse};

    #[test]
    fn points_can_be_read_as_rows() {
        let bytes = las();
        let table = super::table(&bytes[..HEADERS[0]], bytes.len() as u64).unwrap();
        assert_eq!((table.points, table.row), (COUNT, 26));
        let rows = &bytes[table.start as usize..];
        assert_eq!(table.rows.look(&rows[26..52]).position, parse(&bytes).unwrap().mesh.positions[1]);
        assert!(table.rows.read(rows).unwrap() == parse(&bytes).unwrap());
        assert!(super::table(&bytes, bytes.len() as u64 - 1).is_none());
    }
}
