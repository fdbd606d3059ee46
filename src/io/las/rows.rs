//! The points of a file as rows of bytes.

use super::header::{Header, header};
use super::packed::{self, CAN_UNPACK};
use super::{Cloud, position};
use crate::base::error::Result;
use crate::io::content::Parsed;
use crate::io::table::{Packed, Rows, Table};
use crate::prepare::thin::{Levels, Seen, Wanted};
use glam::DVec3;
use std::fs::File;
use std::io::BufReader;

/// Returns the table of points of a file with this length that begins with `head`.
pub(crate) fn table(head: &[u8], length: u64) -> Option<Table> {
    let header = header(head).ok()?;
    let Header { start, length: row, count: points, compressed, .. } = header;
    let found = length.checked_sub(start as u64)? / row as u64;
    let is_there = if compressed { CAN_UNPACK } else { found >= points as u64 };
    if !is_there || points >= u32::MAX as usize {
        return None;
    }
    let packed = compressed.then(|| Box::new(header) as Box<dyn Packed>);
    Some(Table { start: start as u64, row, points, rows: Box::new(header), packed })
}

impl Packed for Header {
    fn unpack(&self, file: &File, show: &mut dyn FnMut(&[u8]) -> Result<()>) -> Result<()> {
        self.unpack_wanted(file, &Wanted::default(), &mut |_, row| show(row)).map(|_| ())
    }

    fn unpack_wanted(
        &self,
        file: &File,
        wanted: &Wanted,
        show: &mut dyn FnMut(usize, &[u8]) -> Result<()>,
    ) -> Result<Option<Levels>> {
        packed::unpack(BufReader::new(file), self, wanted, show)
    }
}

impl Rows for Header {
    fn look(&self, row: &[u8]) -> Seen {
        Seen { position: position(row) * self.scale + self.offset, normal: DVec3::ZERO }
    }

    fn read(&self, rows: &[u8]) -> Parsed {
        let mut cloud = Cloud::default();
        rows.chunks_exact(self.length).for_each(|row| cloud.push(self, row));
        cloud.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::super::header::HEADERS;
    use super::super::parse;
    use super::super::tests::{COUNT, las};

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
    #[cfg(feature = "laz")]
    #[test]
    fn compressed_points_become_the_same_rows() {
        use super::super::tests::laz;
        use std::io::{Seek, Write};
        let bytes = laz();
        let table = super::table(&bytes, bytes.len() as u64).unwrap();
        assert_eq!((table.points, table.row), (COUNT, 26));
        let packed = table.packed.unwrap();
        let rows_of = |bytes: &[u8]| {
            let mut file = tempfile::tempfile().unwrap();
            file.write_all(bytes).unwrap();
            file.rewind().unwrap();
            let mut rows = Vec::new();
            let whole = packed.unpack(&file, &mut |row| {
                rows.extend_from_slice(row);
                Ok(())
            });
            whole.map(|()| rows)
        };
        assert!(rows_of(&bytes).unwrap() == las()[HEADERS[0]..]);
        assert!(rows_of(&bytes[..bytes.len() - 60]).unwrap_err().to_string().contains("compressed points"));
    }
}
