//! Polygons and unstructured grids as XML, read from front to back. The data appended after the elements need not be XML,
//! and is split off first.

use super::arrays::{Bytes, Packing, in_bytes, in_text};
use super::{Array, Cell, EXTRACT, Role, Surface, wrong};
use crate::base::error::{Error, Place, Result};
use crate::io::bytes::{malformed, most_unpacked};
use crate::io::content::Parsed;
use crate::io::numbers::{Order, Type};
use crate::io::text::quote;
use crate::io::xml::{attribute, mistake};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::mem::take;

/// Reads the surface in a VTP or VTU file.
///
/// # Errors
/// `Error::Format` with the byte or part that is malformed.
pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    let (xml, appended) = split(bytes);
    let text = String::from_utf8_lossy(xml);
    let mut reader = Reader::from_str(&text);
    reader.config_mut().check_end_names = false;
    let mut file = File {
        appended,
        packing: Packing { order: Order::Little, header: Type::U32, compressed: false },
        budget: most_unpacked(bytes.len()),
        surface: Surface::default(),
        section: Section::Other,
        piece: Piece::default(),
        open: None,
        inner: 0,
    };
    loop {
        let event = reader.read_event().map_err(|e| mistake(&reader, &e))?;
        match event {
            Event::Start(tag) => file.start(&tag)?,
            Event::Empty(tag) => {
                file.start(&tag)?;
                file.end(tag.local_name().as_ref())?;
            }
            Event::Text(words) => {
                if let Some((_, text)) = file.open.as_mut().filter(|_| file.inner == 0) {
                    text.push_str(&words);
                }
            }
            Event::End(tag) => file.end(tag.local_name().as_ref())?,
            Event::Eof => break,
            _ => {}
        }
    }
    file.surface.finish()
}

/// Splits a file into its elements and the appended data.
fn split(bytes: &[u8]) -> (&[u8], Option<Appended<'_>>) {
    const TAG: &[u8] = b"<AppendedData";
    let Some(start) = bytes.windows(TAG.len()).position(|w| w == TAG) else { return (bytes, None) };
    let (xml, rest) = bytes.split_at(start);
    let tag = &rest[..rest.iter().position(|&b| b == b'>').unwrap_or(rest.len())];
    let encoded = !tag.windows(5).any(|w| w == b"\"raw\"");
    // The data begins after an underscore.
    let data = rest[tag.len()..].iter().position(|&b| b == b'_').map(|at| &rest[tag.len() + at + 1..]);
    (xml, data.map(|data| Appended { data, encoded }))
}

struct Appended<'a> {
    data: &'a [u8],
    encoded: bool,
}

/// Section to which the arrays that are read now belong.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Section {
    Points,
    PointData,
    Cells(Cell),
    /// Cells of several kinds, as in unstructured grids.
    TypedCells,
    Other,
}

/// Kinds of cells: one for all, or the type number of each.
enum Kinds {
    All(Cell),
    Each(Vec<f64>),
}

/// A piece of the surface, with points of its own.
#[derive(Default)]
struct Piece {
    positions: Vec<f64>,
    /// Groups of cells: their kinds, their corners, and the end of each cell in the list of corners.
    cells: Vec<(Kinds, Vec<f64>, Vec<f64>)>,
    corners: Vec<f64>,
    ends: Vec<f64>,
    types: Vec<f64>,
    arrays: Vec<Array>,
    /// Names of the arrays that the file declares to be normals or texture coordinates.
    roles: Vec<(String, Role)>,
}

/// Attributes of an array element.
struct Header {
    name: String,
    kind: Option<Type>,
    components: usize,
    encoded: bool,
    /// Offset of its numbers in the appended data.
    offset: Option<usize>,
}

struct File<'a> {
    appended: Option<Appended<'a>>,
    packing: Packing,
    budget: usize,
    surface: Surface,
    section: Section,
    piece: Piece,
    open: Option<(Header, String)>,
    /// Number of open elements inside the array. They describe it, and their text is not part of its numbers.
    inner: usize,
}

impl File<'_> {
    fn start(&mut self, tag: &BytesStart) -> Result<()> {
        if self.open.is_some() {
            self.inner += 1;
            return Ok(());
        }
        match tag.local_name().as_ref() {
            "VTKFile" => self.packing = packing(tag)?,
            "Piece" => {
                self.piece = Piece::default();
                let lines = attribute(tag, "NumberOfLines").and_then(|n| n.trim().parse().ok());
                self.surface.grid.lines = self.surface.grid.lines.saturating_add(lines.unwrap_or(0));
            }
            "Points" => self.section = Section::Points,
            "PointData" => {
                self.section = Section::PointData;
                let roles = [("Normals", Role::Normals), ("TCoords", Role::Texture)];
                self.piece.roles =
                    roles.into_iter().filter_map(|(key, role)| Some((attribute(tag, key)?, role))).collect();
            }
            "Polys" => self.section = Section::Cells(Cell::Polygon),
            "Strips" => self.section = Section::Cells(Cell::Strip),
            "Cells" => self.section = Section::TypedCells,
            "CellData" | "Verts" | "Lines" | "FieldData" => self.section = Section::Other,
            "DataArray" if self.section != Section::Other => self.open = Some((header(tag), String::new())),
            _ => {}
        }
        Ok(())
    }

    fn end(&mut self, name: &str) -> Result<()> {
        if self.inner > 0 {
            self.inner -= 1;
            return Ok(());
        }
        match name {
            "DataArray" => {
                if let Some((header, text)) = self.open.take() {
                    self.array(header, &text)?;
                }
            }
            "Polys" | "Strips" | "Cells" => {
                let kinds = match self.section {
                    Section::Cells(cell) => Some(Kinds::All(cell)),
                    Section::TypedCells => Some(Kinds::Each(take(&mut self.piece.types))),
                    _ => None,
                };
                let Piece { cells, corners, ends, .. } = &mut self.piece;
                cells.extend(kinds.map(|kinds| (kinds, take(corners), take(ends))));
                self.section = Section::Other;
            }
            "Points" | "PointData" | "CellData" | "Verts" | "Lines" | "FieldData" => self.section = Section::Other,
            "Piece" => self.add_piece()?,
            _ => {}
        }
        Ok(())
    }

    fn array(&mut self, header: Header, text: &str) -> Result<()> {
        let part = |error: Error| match error {
            Error::Format { file, cause, remedy, .. } => {
                let place = Place::Part(format!("array '{}'", header.name.escape_debug()));
                Error::Format { file, place, cause, remedy }
            }
            other => other,
        };
        let Some(kind) = header.kind else {
            let name = header.name.escape_debug();
            self.surface.grid.notes.push(format!("the array '{name}' is left out: its number type is not known"));
            return Ok(());
        };
        let values = match (header.offset, &self.appended) {
            (None, _) if !header.encoded => in_text(text),
            (None, _) => in_bytes(Bytes::new(text.as_bytes(), true), kind, self.packing, &mut self.budget),
            (Some(offset), Some(Appended { data, encoded })) if offset <= data.len() => {
                in_bytes(Bytes::new(&data[offset..], *encoded), kind, self.packing, &mut self.budget)
            }
            (Some(_), _) => Err(wrong(Place::Whole, "its numbers are not in the appended data of the file")),
        };
        let values = values.map_err(part)?;
        let Header { name, components, .. } = header;
        match self.section {
            Section::Points => self.piece.positions = values,
            Section::PointData => {
                let role = self.piece.roles.iter().find(|(known, _)| *known == name).map(|(_, role)| *role);
                let role = role.unwrap_or(Role::Plain);
                self.piece.arrays.push(Array { name, components, values, kind, role });
            }
            Section::Other => {}
            _ if name == "connectivity" => self.piece.corners = values,
            _ if name == "offsets" => self.piece.ends = values,
            Section::TypedCells if name == "types" => self.piece.types = values,
            Section::Cells(_) | Section::TypedCells => {}
        }
        Ok(())
    }

    fn add_piece(&mut self) -> Result<()> {
        let piece = take(&mut self.piece);
        let base = self.surface.grid.positions.len();
        self.surface.add_positions(&piece.positions)?;
        if self.surface.grid.positions.len() >= u32::MAX as usize {
            return Err(malformed(Place::Whole, "there are too many points for 32-bit indices", "split the file"));
        }
        for (kinds, corners, ends) in piece.cells {
            if let Kinds::Each(types) = &kinds
                && types.len() != ends.len()
            {
                return Err(wrong(
                    Place::Whole,
                    format!("there are {} cells, but {} cell types", ends.len(), types.len()),
                ));
            }
            let mut start = 0;
            for (i, end) in ends.into_iter().map(|end| end as usize).enumerate() {
                let cell = match &kinds {
                    Kinds::All(cell) => *cell,
                    Kinds::Each(types) => Cell::of_type(types[i]),
                };
                let all = corners.get(start..end).ok_or_else(|| {
                    let cause =
                        format!("a cell has the invalid range of corners {start} to {end} of {}", corners.len());
                    wrong(Place::Part(format!("face {}", self.surface.grid.faces.count())), cause)
                })?;
                self.surface.add_cell(cell, all, base)?;
                start = end;
            }
        }
        for array in piece.arrays {
            let is_same = |known: &&mut Array| known.name == array.name && known.components == array.components;
            match self.surface.arrays.iter_mut().find(is_same).filter(|_| base > 0) {
                Some(known) => known.values.extend(array.values),
                None => self.surface.arrays.push(array),
            }
        }
        Ok(())
    }
}

fn packing(tag: &BytesStart) -> Result<Packing> {
    if let Some(kind) = attribute(tag, "type").filter(|kind| !["PolyData", "UnstructuredGrid"].contains(&&kind[..])) {
        return Err(malformed(
            Place::Whole,
            format!("it is of type {}, which is not supported", quote(kind.as_bytes())),
            EXTRACT,
        ));
    }
    let compressor = attribute(tag, "compressor").filter(|name| !name.is_empty());
    if let Some(name) = compressor.as_ref().filter(|name| *name != "vtkZLibDataCompressor") {
        let cause = format!("its arrays are compressed with {}, which is not supported", quote(name.as_bytes()));
        return Err(malformed(Place::Whole, cause, "save it with ZLib compression or without compression"));
    }
    let is = |key: &str, value: &str| attribute(tag, key).is_some_and(|found| found == value);
    Ok(Packing {
        order: if is("byte_order", "BigEndian") { Order::Big } else { Order::Little },
        header: if is("header_type", "UInt64") { Type::U64 } else { Type::U32 },
        compressed: compressor.is_some(),
    })
}

fn header(tag: &BytesStart) -> Header {
    let is = |value: &str| attribute(tag, "format").is_some_and(|found| found.eq_ignore_ascii_case(value));
    let number = |key: &str| attribute(tag, key).and_then(|n| n.trim().parse().ok());
    Header {
        name: attribute(tag, "Name").unwrap_or_default(),
        kind: attribute(tag, "type").as_deref().and_then(number_type),
        components: number("NumberOfComponents").unwrap_or(1),
        encoded: is("binary"),
        // An appended array must give its offset.
        offset: is("appended").then(|| number("offset").unwrap_or(usize::MAX)),
    }
}

fn number_type(name: &str) -> Option<Type> {
    Some(match name {
        "Int8" => Type::I8,
        "UInt8" => Type::U8,
        "Int16" => Type::I16,
        "UInt16" => Type::U16,
        "Int32" => Type::I32,
        "UInt32" => Type::U32,
        "Int64" => Type::I64,
        "UInt64" => Type::U64,
        "Float32" => Type::F32,
        "Float64" => Type::F64,
        _ => return None,
    })
}
