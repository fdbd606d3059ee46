//! The vertices of a binary file as rows of bytes, and the faces after them.

use super::elements::whole_length;
use super::faces::{is_corners, is_number_below, no_vertex};
use super::header::{self, Element, Encoding, Header, Kind};
use super::read;
use super::source::{self, Binary, Source};
use super::vertices::{GROUPS, is_texture, not_finite, scalar};
use crate::base::error::{Error, Place, Result};
use crate::io::bytes::{EXPORT_AGAIN, malformed};
use crate::io::content::Parsed;
use crate::io::table::{FaceRows, Faces, Rows, Table};
use crate::mesh::attributes::Scalar;
use crate::prepare::thin::Seen;
use glam::DVec3;

/// Returns the points of a binary file of this length that has nothing else. `head` must contain its header.
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
    Some(Table { start, row, points, rows: Box::new(BinaryRows::<BIG> { header, vertex, columns }), packed: None })
}

/// Returns the vertices and the faces of a binary file of this length that has nothing else. `head` must contain its header.
pub(crate) fn surface(head: &[u8], length: u64) -> Option<(Table, Faces)> {
    let header = header::parse(head).ok()?;
    match header.encoding {
        Encoding::Text => None,
        Encoding::Little => surface_of::<false>(header, length),
        Encoding::Big => surface_of::<true>(header, length),
    }
}

fn surface_of<const BIG: bool>(mut header: Header, length: u64) -> Option<(Table, Faces)> {
    let with_rows: Vec<usize> = (0..header.elements.len()).filter(|&i| header.elements[i].count > 0).collect();
    let [vertex, face] = with_rows[..] else { return None };
    let (vertices, faces) = (&header.elements[vertex], &header.elements[face]);
    let corners = faces.properties.iter().position(is_corners)?;
    if vertices.name != "vertex" || faces.name != "face" {
        return None;
    }
    let columns = Columns::of(vertices)?;
    let (start, row) = (header.body as u64, columns.row);
    let points = usize::try_from(vertices.count).ok().filter(|&points| points < u32::MAX as usize)?;
    let end = u64::try_from(row).ok()?.checked_mul(vertices.count)?.checked_add(start).filter(|&end| end <= length)?;
    let kinds = faces.properties.iter().map(|p| p.kind).collect();
    let rows = Box::new(BinaryFaces::<BIG> { kinds, corners, vertices: points, length });
    let have_more = faces.properties.len() > 1 || vertices.properties.iter().any(is_texture);
    let faces = Faces { start: end, count: faces.count, have_more, rows };
    // Vertices are read as if they were the whole file.
    header.elements[face].count = 0;
    Some((
        Table { start, row, points, rows: Box::new(BinaryRows::<BIG> { header, vertex, columns }), packed: None },
        faces,
    ))
}

/// The faces of a binary file.
struct BinaryFaces<const BIG: bool> {
    /// Types of a face's properties, and the index of the one with its corners.
    kinds: Vec<Kind>,
    corners: usize,
    /// Number of vertices in the file.
    vertices: usize,
    /// Length of the file, in bytes.
    length: u64,
}

impl<const BIG: bool> FaceRows for BinaryFaces<BIG> {
    fn show(
        &self,
        bytes: &[u8],
        most: u64,
        at: u64,
        show: &mut dyn FnMut(&[u32]) -> Result<()>,
    ) -> Result<(u64, usize)> {
        let mut source = Binary::<BIG>::new(bytes, 0);
        let (mut faces, mut used) = (0, 0);
        let (mut indices, mut corners) = (Vec::new(), Vec::new());
        let after = self.length.saturating_sub(at + bytes.len() as u64) as usize;
        while faces < most {
            let place = Place::Byte(at as usize + used);
            let next = self.next_face(&mut source, after, &mut indices);
            if next.map_err(|cause| malformed(place.clone(), cause, EXPORT_AGAIN))?.is_none() {
                break;
            }
            if let Some(&index) = indices.iter().find(|&&index| !is_number_below(index, self.vertices)) {
                return Err(no_vertex(index, self.vertices, place));
            }
            corners.clear();
            corners.extend(indices.iter().map(|&index| index as u32));
            show(&corners)?;
            faces += 1;
            used = bytes.len() - source.remaining();
        }
        Ok((faces, used))
    }

    fn cut_short(&self, end: u64) -> Error {
        source::cut_short(Place::Byte(end as usize))
    }
}

impl<const BIG: bool> BinaryFaces<BIG> {
    /// Reads the indices of the next face. Returns `None` if `source` does not contain the whole face. The file has `after`
    /// more bytes than `source`. The error says what is wrong with the face.
    fn next_face(
        &self,
        source: &mut Binary<BIG>,
        after: usize,
        indices: &mut Vec<f64>,
    ) -> std::result::Result<Option<()>, String> {
        for (i, kind) in self.kinds.iter().enumerate() {
            let (item, length) = match *kind {
                Kind::Scalar(scalar) => (scalar, 1),
                Kind::List { count, item } => {
                    let Some(length) = source.next(count) else { return Ok(None) };
                    (item, whole_length(length, (source.remaining() + after) / item.size())?)
                }
            };
            if length > source.remaining() / item.size() {
                return Ok(None);
            }
            let values = (0..length).map_while(|_| source.next(item));
            if i == self.corners {
                indices.clear();
                indices.extend(values);
            } else {
                values.for_each(drop);
            }
        }
        Ok(Some(()))
    }
}

/// The vertices of a binary file.
struct BinaryRows<const BIG: bool> {
    header: Header,
    /// Index of their element.
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

    fn read(&self, rows: &[u8]) -> Parsed {
        let mut header = self.header.clone();
        header.elements[self.vertex].count = (rows.len() / self.columns.row) as u64;
        read(Binary::<BIG>::new(rows, 0), &header)
    }
}

/// Location of the position and the normal of a point in its row of bytes.
struct Columns {
    /// Size of a row, in bytes.
    row: usize,
    /// Offset and type of each coordinate.
    position: [(usize, Scalar); 3],
    normal: Option<[(usize, Scalar); 3]>,
}

impl Columns {
    /// Returns the columns of a binary file's vertices, if all their properties are numbers.
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

    /// Returns the position and the normal of the point in a row.
    #[inline]
    fn look<const BIG: bool>(&self, row: &[u8]) -> Seen {
        let number = |(at, kind)| Binary::<BIG>::new(row, at).next(kind).unwrap_or(f64::NAN);
        let vector = |columns: [(usize, Scalar); 3]| DVec3::from_array(columns.map(number));
        Seen { position: vector(self.position), normal: self.normal.map_or(DVec3::ZERO, vector) }
    }
}

/// Returns the error that a coordinate is not finite in the row that begins at byte `start` of the file.
fn not_finite_in<const BIG: bool>(row: &[u8], columns: &[(usize, Scalar); 3], start: usize) -> Error {
    let number = |at, kind| Binary::<BIG>::new(row, at).next(kind).unwrap_or(f64::NAN);
    let values = columns.iter().map(|&(at, kind)| (number(at, kind), at));
    let (value, at) = values.filter(|(value, _)| !value.is_finite()).min_by_key(|(_, at)| *at).unwrap_or((f64::NAN, 0));
    not_finite(value, Place::Byte(start + at))
}
