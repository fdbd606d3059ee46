//! The vertices of a binary file that has nothing else, as rows of bytes.

use super::header::{self, Element, Encoding, Header};
use super::read;
use super::source::{self, Binary, Source};
use super::vertices::{GROUPS, not_finite, scalar};
use crate::base::error::{Error, Place};
use crate::io::content::Parsed;
use crate::io::table::{Rows, Table};
use crate::mesh::attributes::Scalar;
use crate::prepare::thin::Seen;
use glam::DVec3;

/// The points of a binary file that has nothing else, of this many bytes, whose header is in `head`.
pub(crate) fn table(head: &[u8], length: u64) -> Option<Table> {
    let header = header::parse(head).ok()?;
    match header.encoding {
        Encoding::Text => None,
        Encoding::Little => table_of::<false>(header, length),
        Encoding::Big => table_of::<true>(header, length),
    }
}

fn table_of<const BIG: bool>(header: Header, length: u64) -> Option<Table> {
    let mut with_rows = (0..header.elements.len()).filter(|&i| header.elements[i].count > 0);
    let (vertex, None) = (with_rows.next()?, with_rows.next()) else { return None };
    let element = &header.elements[vertex];
    let columns = Columns::of(element)?;
    let (start, points, row) = (header.body as u64, element.count, columns.row);
    if element.name != "vertex" || u64::try_from(row).ok()?.checked_mul(points)?.checked_add(start)? != length {
        return None;
    }
    let points = usize::try_from(points).ok().filter(|&points| points < u32::MAX as usize)?;
    Some(Table { start, row, points, rows: Box::new(BinaryRows::<BIG> { header, vertex, columns }) })
}

/// The vertices of a binary file that has nothing else.
struct BinaryRows<const BIG: bool> {
    header: Header,
    /// Which of the elements they are.
    vertex: usize,
    columns: Columns,
}

impl<const BIG: bool> Rows for BinaryRows<BIG> {
    fn look(&self, row: &[u8]) -> Seen {
        self.columns.look::<BIG>(row)
    }

    fn nowhere(&self, point: usize, row: &[u8]) -> Error {
        let Columns { position, row: length, .. } = &self.columns;
        not_finite_in::<BIG>(row, position, self.header.body + point * length)
    }

    fn cut_short(&self, end: u64) -> Error {
        source::cut_short(Place::Byte(end as usize))
    }

    fn read(&self, rows: &[u8]) -> Parsed {
        let mut header = self.header.clone();
        header.elements[self.vertex].count = (rows.len() / self.columns.row) as u64;
        read(Binary::<BIG>::new(rows, 0), &header)
    }
}

/// Where the position and the normal of a point are in its row of bytes.
struct Columns {
    /// The bytes of a row.
    row: usize,
    /// The byte and the type of each coordinate.
    position: [(usize, Scalar); 3],
    normal: Option<[(usize, Scalar); 3]>,
}

impl Columns {
    /// Those of the vertices of a binary file, if all their properties are numbers.
    fn of(element: &Element) -> Option<Columns> {
        let kinds: Option<Vec<Scalar>> = element.properties.iter().map(scalar).collect();
        let kinds = kinds?;
        let find = |name: &str| {
            let i = element.properties.iter().position(|p| p.name == name)?;
            Some((kinds[..i].iter().map(|kind| kind.size()).sum(), kinds[i]))
        };
        let three = |[x, y, z]: [&str; 3]| Some([find(x)?, find(y)?, find(z)?]);
        let [(_, [x, y, z, _]), ..] = GROUPS;
        let row = kinds.iter().map(|kind| kind.size()).sum();
        Some(Columns { row, position: three(["x", "y", "z"])?, normal: three([x, y, z]) })
    }

    /// The place of the point in a row.
    #[inline]
    fn look<const BIG: bool>(&self, row: &[u8]) -> Seen {
        let number = |(at, kind)| Binary::<BIG>::new(row, at).next(kind).unwrap_or(f64::NAN);
        let vector = |columns: [(usize, Scalar); 3]| DVec3::from_array(columns.map(number));
        Seen { position: vector(self.position), normal: self.normal.map_or(DVec3::ZERO, vector) }
    }
}

/// The error that one of the coordinates in a row, which begins at byte `start` of the file, is not finite.
fn not_finite_in<const BIG: bool>(row: &[u8], columns: &[(usize, Scalar); 3], start: usize) -> Error {
    let number = |at, kind| Binary::<BIG>::new(row, at).next(kind).unwrap_or(f64::NAN);
    let values = columns.iter().map(|&(at, kind)| (number(at, kind), at));
    let (value, at) = values.filter(|(value, _)| !value.is_finite()).min_by_key(|(_, at)| *at).unwrap_or((f64::NAN, 0));
    not_finite(value, Place::Byte(start + at))
}
