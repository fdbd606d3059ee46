//! PCD, the format of the Point Cloud Library: ASCII, binary, and binary compressed by LZF.
//!
//! A header names fields, each with a type and a count of numbers. The points follow as rows, or, if compressed, as columns.
//! `x`, `y` and `z` are the position, `normal_x`, `normal_y` and `normal_z` the normal, `rgb` or `rgba` the colour in the
//! bytes of one number; each other field is an attribute. Points whose position is not finite stand for directions in which
//! a sensor saw nothing; they are left out.
//!
//! The number of points in the header is compared with the length of the file before memory is reserved.
//!
//! Limits: the viewpoint is not used. Positions are written in single precision, as the library requires.

mod lzf;
mod write;

pub(crate) use write::write;

use super::bytes::{CUT_SHORT, EXPORT_AGAIN, malformed, u32_at};
use super::numbers::{Order, Type};
use super::text::{Words, number, quote, whole};
use crate::base::error::{Place, Result};
use crate::io::content::{Parsed, Read};
use crate::mesh::attributes::{Attribute, Attributes, COLOR, NORMAL, Scalar};
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;

/// A field of each point.
#[derive(Debug, Clone, PartialEq)]
struct Field {
    name: String,
    kind: Type,
    count: usize,
    /// Index of its first number among those of a point.
    column: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Text,
    Binary,
    Compressed,
}

struct Header {
    fields: Vec<Field>,
    points: usize,
    encoding: Encoding,
    /// Byte and line at which the points begin.
    body: (usize, usize),
}

/// The numbers of all points, in rows.
struct Table {
    values: Vec<f64>,
    width: usize,
}

/// Whether a file that starts with these bytes is in this format.
pub(crate) fn has_signature(head: &[u8]) -> bool {
    let mut words = Words::new(head).with_comments();
    head.starts_with(b"# .PCD") || words.here() == Some(b"VERSION") && words.here().is_some_and(|v| number(v).is_some())
}

/// Reads the points in a PCD file.
///
/// # Errors
/// `Error::Format` with the line or byte that is malformed.
pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    let header = header(bytes)?;
    let width = header.fields.iter().map(|f| f.count).sum();
    let mut table = Table { width, values: Vec::new() };
    match header.encoding {
        Encoding::Text => table.read_text(bytes, &header)?,
        Encoding::Binary => table.read_rows(bytes, &header)?,
        Encoding::Compressed => table.read_columns(bytes, &header)?,
    }
    Ok(cloud(table, &header))
}

fn header(bytes: &[u8]) -> Result<Header> {
    let mut lists: [Vec<String>; 4] = Default::default();
    let (mut points, mut height, mut rows) = (None, 1usize, None);
    let (mut at, mut line) = (0, 0);
    loop {
        let rest = &bytes[at..];
        let length = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        line += 1;
        let wrong = |cause: String| malformed(Place::Line(line), cause, EXPORT_AGAIN);
        if rest.is_empty() {
            return Err(malformed(Place::Line(line), "the header has no DATA line", CUT_SHORT));
        }
        at += (length + 1).min(rest.len());
        let text = String::from_utf8_lossy(&rest[..length]);
        let mut words = text.split_whitespace();
        let Some(keyword) = words.next() else { continue };
        let count = |word: Option<&str>| {
            word.and_then(|word| whole(word.as_bytes()))
                .ok_or_else(|| wrong(format!("{keyword} is not a whole number")))
        };
        match keyword {
            "FIELDS" | "COLUMNS" => lists[0] = words.map(str::to_string).collect(),
            "SIZE" => lists[1] = words.map(str::to_string).collect(),
            "TYPE" => lists[2] = words.map(str::to_string).collect(),
            "COUNT" => lists[3] = words.map(str::to_string).collect(),
            "WIDTH" => rows = Some(count(words.next())?),
            "HEIGHT" => height = count(words.next())?,
            "POINTS" => points = Some(count(words.next())?),
            "DATA" => {
                let encoding = match words.next() {
                    Some("ascii") => Encoding::Text,
                    Some("binary") => Encoding::Binary,
                    Some("binary_compressed") => Encoding::Compressed,
                    other => {
                        return Err(wrong(format!("unknown DATA encoding {}", quote(other.unwrap_or("").as_bytes()))));
                    }
                };
                let points = points.or_else(|| rows?.checked_mul(height));
                let points =
                    points.ok_or_else(|| wrong("neither POINTS nor WIDTH gives the number of points".into()))?;
                return Ok(Header { fields: fields(&lists).map_err(wrong)?, points, encoding, body: (at, line + 1) });
            }
            "VERSION" | "VIEWPOINT" => {}
            _ if keyword.starts_with('#') => {}
            _ => return Err(wrong(format!("{} is not a line of a PCD header", quote(keyword.as_bytes())))),
        }
    }
}

/// Builds the fields from the lists FIELDS, SIZE, TYPE and COUNT, the last of which may be missing.
fn fields([names, sizes, types, counts]: &[Vec<String>; 4]) -> std::result::Result<Vec<Field>, String> {
    if sizes.len() != names.len() || types.len() != names.len() || !(counts.is_empty() || counts.len() == names.len()) {
        return Err("FIELDS, SIZE, TYPE and COUNT differ in length".into());
    }
    let mut column = 0usize;
    let field = |i: usize| {
        let kind = kind(&types[i], &sizes[i]);
        let kind = kind.ok_or_else(|| format!("TYPE {} with SIZE {} is not supported", types[i], sizes[i]))?;
        let count = counts.get(i).map_or(Some(1), |count| whole(count.as_bytes()));
        let end = count.and_then(|count| column.checked_add(count)).filter(|&end| end <= u32::MAX as usize);
        let end =
            end.ok_or_else(|| format!("the COUNT of field {} is not a valid count", quote(names[i].as_bytes())))?;
        let field = Field { name: names[i].clone(), kind, count: end - column, column };
        column = end;
        Ok(field)
    };
    let fields: Vec<Field> = (0..names.len()).map(field).collect::<std::result::Result<_, String>>()?;
    match ["x", "y", "z"].iter().find(|name| !fields.iter().any(|f| f.name == **name && f.count == 1)) {
        Some(name) => Err(format!("there is no field {name}")),
        None => Ok(fields),
    }
}

fn kind(name: &str, size: &str) -> Option<Type> {
    Some(match (name, size) {
        ("I", "1") => Type::I8,
        ("I", "2") => Type::I16,
        ("I", "4") => Type::I32,
        ("I", "8") => Type::I64,
        ("U", "1") => Type::U8,
        ("U", "2") => Type::U16,
        ("U", "4") => Type::U32,
        ("U", "8") => Type::U64,
        ("F", "4") => Type::F32,
        ("F", "8") => Type::F64,
        _ => return None,
    })
}

impl Header {
    /// Size of a point, in bytes.
    fn row(&self) -> usize {
        self.fields.iter().map(|f| f.count * f.kind.size()).sum()
    }

    /// Refuses the count of points if `left` bytes cannot hold so many, at `least` bytes per point.
    fn check_count(&self, left: usize, least: usize, place: Place) -> Result<()> {
        if self.points.checked_mul(least).is_some_and(|needed| needed <= left) {
            return Ok(());
        }
        let cause = format!("the header declares {} points, but only {left} bytes follow", self.points);
        Err(malformed(place, cause, CUT_SHORT))
    }
}

impl Field {
    fn is_color(&self) -> bool {
        matches!(self.name.as_str(), "rgb" | "rgba") && self.count == 1 && self.kind.size() == 4
    }

    /// Reads a number of this field from bytes. A colour becomes its bits.
    fn read(&self, bytes: &[u8]) -> f64 {
        let kind = if self.is_color() { Type::U32 } else { self.kind };
        kind.read(bytes, Order::Little)
    }

    /// Parses a number of this field from text. A colour becomes its bits; some programs write the float that has these
    /// bits.
    fn spelled(&self, word: &[u8]) -> Option<f64> {
        let number = number(word)?;
        let is_whole = number.fract() == 0.0 && (1.0..=u32::MAX.into()).contains(&number.abs());
        let is_bits = !self.is_color() || self.kind != Type::F32 || is_whole;
        Some(if is_bits { number } else { f64::from((number as f32).to_bits()) })
    }
}

impl Table {
    fn read_text(&mut self, bytes: &[u8], header: &Header) -> Result<()> {
        let (body, line) = header.body;
        let mut words = Words::new(&bytes[body..]).starting_at(line);
        // A number takes a digit and white space; the last one needs no white space.
        header.check_count(words.remaining() + 1, 2 * self.width, Place::Line(line))?;
        self.values.reserve_exact(header.points * self.width);
        for found in 0..header.points {
            for field in header.fields.iter().flat_map(|f| std::iter::repeat_n(f, f.count)) {
                let word = words.anywhere().ok_or_else(|| {
                    words.error(format!("the file ends after {found} of {} points", header.points), CUT_SHORT)
                })?;
                let value = field.spelled(word);
                self.values.push(value.ok_or_else(|| words.mistake(format!("{} is not a number", quote(word))))?);
            }
        }
        Ok(())
    }

    fn read_rows(&mut self, bytes: &[u8], header: &Header) -> Result<()> {
        let (row, data) = (header.row(), &bytes[header.body.0..]);
        header.check_count(data.len(), row, Place::Byte(bytes.len()))?;
        self.values.reserve_exact(header.points * self.width);
        for mut point in data.chunks_exact(row).take(header.points) {
            for field in header.fields.iter().flat_map(|f| std::iter::repeat_n(f, f.count)) {
                self.values.push(field.read(point));
                point = &point[field.kind.size()..];
            }
        }
        Ok(())
    }

    fn read_columns(&mut self, bytes: &[u8], header: &Header) -> Result<()> {
        let start = header.body.0;
        let damaged = |cause: &str| malformed(Place::Byte(start), cause, CUT_SHORT);
        let sizes = u32_at(bytes, start).zip(u32_at(bytes, start + 4));
        let (packed, size) = sizes.ok_or_else(|| damaged("the sizes of the compressed points are missing"))?;
        let packed = bytes[start + 8..].get(..packed as usize);
        let packed = packed.ok_or_else(|| damaged("the compressed points are cut short"))?;
        header.check_count(size as usize, header.row(), Place::Byte(start))?;
        let data = lzf::decompress(packed, size as usize);
        let data = data.ok_or_else(|| damaged("the compressed points are damaged"))?;
        self.values = vec![0.0; header.points * self.width];
        let mut rest = &data[..];
        for field in &header.fields {
            let (column, others) = rest.split_at(header.points * field.count * field.kind.size());
            for (i, number) in column.chunks_exact(field.kind.size()).enumerate() {
                let (point, k) = (i / field.count, i % field.count);
                self.values[point * self.width + field.column + k] = field.read(number);
            }
            rest = others;
        }
        Ok(())
    }

    fn columns(&self, from: usize, count: usize) -> Vec<f64> {
        super::columns::cut(&self.values, self.width, from, from + count)
    }

    /// Leaves out the points without a position. Returns how many there were.
    fn drop_nowhere(&mut self, position: [usize; 3]) -> usize {
        let before = self.values.len() / self.width;
        let (width, mut kept) = (self.width, 0);
        for row in 0..before {
            if position.iter().all(|&k| self.values[row * width + k].is_finite()) {
                self.values.copy_within(row * width..(row + 1) * width, kept * width);
                kept += 1;
            }
        }
        self.values.truncate(kept * width);
        before - kept
    }
}

/// Returns the points of a table.
fn cloud(mut table: Table, header: &Header) -> Read {
    let find = |name: &str| header.fields.iter().find(|f| f.name == name && f.count == 1).map(|f| f.column);
    let three = |names: [&str; 3]| Some([find(names[0])?, find(names[1])?, find(names[2])?]);
    let Some(position) = three(["x", "y", "z"]) else { return Read::default() };
    let mut notes = Vec::new();
    super::text::left_out(
        &mut notes,
        table.drop_nowhere(position),
        "point without a position",
        "points without positions",
    );
    let row = |row: &[f64]| DVec3::from(position.map(|k| row[k]));
    let positions = table.values.chunks_exact(table.width).map(row).collect();
    let normal = three(["normal_x", "normal_y", "normal_z"]).or_else(|| three(["nx", "ny", "nz"]));
    let mut vertex = Vec::new();
    vertex.extend(normal.map(|at| normals(&table, at)));
    let mut has_color = false;
    for field in &header.fields {
        let used = position.into_iter().chain(normal.into_iter().flatten()).any(|k| k == field.column);
        // Padding is named '_'.
        if used && field.count == 1 || field.count == 0 || field.name == "_" {
            continue;
        }
        if field.is_color() && !has_color {
            vertex.push(color(&table, field));
            has_color = true;
        } else {
            let values = table.columns(field.column, field.count);
            let scalar = field.kind.scalar(&values);
            vertex.push(Attribute { name: field.name.clone(), components: field.count, values, scalar });
        }
    }
    let attributes = Attributes { vertex, ..Attributes::default() };
    Read { mesh: Mesh { positions, triangles: Vec::new() }, attributes, notes }
}

/// Returns the normals, with zero for missing ones.
fn normals(table: &Table, at: [usize; 3]) -> Attribute {
    let row = |row: &[f64]| at.map(|k| row[k]);
    let rows = table.values.chunks_exact(table.width).map(row);
    let values = rows.flat_map(|n| if n.iter().all(|x| x.is_finite()) { n } else { [0.0; 3] }).collect();
    Attribute { name: NORMAL.into(), components: 3, values, scalar: Scalar::F32 }
}

/// Returns the colours: red, green and blue from the lower bytes of a number, and the opacity from the highest if the name
/// is `rgba`.
fn color(table: &Table, field: &Field) -> Attribute {
    let components = field.name.len();
    let bytes = |bits: f64| {
        let [a, r, g, b] = (bits as i64 as u32).to_be_bytes();
        [r, g, b, a].map(f64::from)
    };
    let bits = table.columns(field.column, 1);
    let values = bits.into_iter().flat_map(|bits| bytes(bits).into_iter().take(components)).collect();
    Attribute { name: COLOR.into(), components, values, scalar: Scalar::U8 }
}

#[cfg(test)]
mod tests;
