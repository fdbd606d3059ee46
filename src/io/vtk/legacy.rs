//! Legacy files: keywords in text, followed by numbers in text or binary, most significant byte first.

use super::{Array, Cell, EXTRACT, Role, Surface};
use crate::base::error::{Place, Result};
use crate::io::bytes::malformed;
use crate::io::content::Parsed;
use crate::io::mixed::Mixed;
use crate::io::numbers::{Order, Type};
use crate::io::text::quote;

/// Reads the surface in a legacy VTK file.
///
/// # Errors
/// `Error::Format` with the line or byte that is malformed.
pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    let mut source = Mixed::new(bytes);
    if !source.line().starts_with(b"# vtk DataFile") {
        return Err(malformed(
            Place::Line(1),
            "the first line is not '# vtk DataFile'",
            "check that this is a VTK file",
        ));
    }
    // The title.
    source.line();
    match source.upper_word().as_deref() {
        Some("ASCII") => {}
        Some("BINARY") => source.binary = Some(Order::Big),
        other => return Err(source.wrong(format!("the encoding is {}, neither ASCII nor BINARY", shown(other)))),
    }
    let mut reader = Reader { source, surface: Surface::default(), of_points: None, cells: None };
    while let Some(keyword) = reader.source.upper_word() {
        if !reader.section(&keyword)? {
            let place = reader.source.place();
            reader
                .surface
                .grid
                .notes
                .push(format!("everything from {}{place} on is left out", quote(keyword.as_bytes())));
            break;
        }
    }
    reader.surface.finish()
}

fn shown(word: Option<&str>) -> String {
    quote(word.unwrap_or("").as_bytes())
}

struct Reader<'a> {
    source: Mixed<'a>,
    surface: Surface,
    /// Number of tuples in arrays, and whether they belong to points.
    of_points: Option<(usize, bool)>,
    /// End of each cell of a grid in the list of corners, and that list, until the types of cells are known.
    cells: Option<(Vec<usize>, Vec<f64>)>,
}

impl Reader<'_> {
    /// Reads a section. Returns false if its kind is unknown.
    fn section(&mut self, keyword: &str) -> Result<bool> {
        match keyword {
            "DATASET" => {
                let kind = self.source.upper_word();
                if !matches!(kind.as_deref(), Some("POLYDATA" | "UNSTRUCTURED_GRID")) {
                    let cause = format!("it is a DATASET of type {}, which has no faces", shown(kind.as_deref()));
                    return Err(malformed(self.source.place(), cause, EXTRACT));
                }
            }
            "POINTS" => {
                let count = self.source.count()?;
                let kind = self.number_type()?;
                let numbers = self.numbers(kind, count.saturating_mul(3))?;
                self.surface.add_positions(&numbers)?;
            }
            "VERTICES" => drop(self.cells()?),
            "LINES" => self.add_cells(Cell::Lines)?,
            "POLYGONS" => self.add_cells(Cell::Polygon)?,
            "TRIANGLE_STRIPS" => self.add_cells(Cell::Strip)?,
            "CELLS" => self.cells = Some(self.cells()?),
            "CELL_TYPES" => self.typed_cells()?,
            "POINT_DATA" => self.of_points = Some((self.source.count()?, true)),
            "CELL_DATA" => self.of_points = Some((self.source.count()?, false)),
            "METADATA" => self.skip_lines(),
            "FIELD" => self.field()?,
            _ => return self.array(keyword),
        }
        Ok(true)
    }

    /// Skips lines up to and including the next empty one.
    fn skip_lines(&mut self) {
        self.source.line();
        while !self.source.line().trim_ascii().is_empty() {}
    }

    /// Reads cells. Returns the end of each cell in the list of corners, and that list.
    fn cells(&mut self) -> Result<(Vec<usize>, Vec<f64>)> {
        let (count, size) = (self.source.count()?, self.source.count()?);
        if self.source.peek_word() == Some(b"OFFSETS") {
            self.source.word();
            let kind = self.number_type()?;
            let offsets = self.numbers(kind, count)?;
            if self.source.upper_word().as_deref() != Some("CONNECTIVITY") {
                return Err(self.source.wrong("OFFSETS is not followed by CONNECTIVITY"));
            }
            let kind = self.number_type()?;
            let corners = self.numbers(kind, size)?;
            return Ok((offsets.into_iter().skip(1).map(|end| end as usize).collect(), corners));
        }
        let list = self.numbers(Type::I32, size)?;
        let (mut ends, mut corners) = (Vec::new(), Vec::with_capacity(list.len()));
        let mut rest = &list[..];
        for _ in 0..count {
            let cell = rest.split_first().and_then(|(&length, rest)| rest.split_at_checked(length as usize));
            let Some((cell, others)) = cell else {
                return Err(self.source.wrong(format!("{size} numbers are too few for {count} cells")));
            };
            corners.extend_from_slice(cell);
            ends.push(corners.len());
            rest = others;
        }
        Ok((ends, corners))
    }

    fn add_cells(&mut self, cell: Cell) -> Result<()> {
        let (ends, corners) = self.cells()?;
        self.add_all(&ends, &corners, |_| cell)
    }

    fn typed_cells(&mut self) -> Result<()> {
        let count = self.source.count()?;
        let types = self.numbers(Type::I32, count)?;
        let (ends, corners) = self.cells.take().unwrap_or_default();
        if ends.len() != types.len() {
            let cause = format!("there are {} cells, but {} cell types", ends.len(), types.len());
            return Err(self.source.wrong(cause));
        }
        self.add_all(&ends, &corners, |i| Cell::of_type(types[i]))
    }

    fn add_all(&mut self, ends: &[usize], corners: &[f64], cell: impl Fn(usize) -> Cell) -> Result<()> {
        let mut start = 0;
        for (i, &end) in ends.iter().enumerate() {
            let Some(of_cell) = corners.get(start..end) else {
                let cause = format!("cell {i} has the invalid range of corners {start} to {end} of {}", corners.len());
                return Err(self.source.wrong(cause));
            };
            self.surface.add_cell(cell(i), of_cell, 0)?;
            start = end;
        }
        Ok(())
    }

    /// Reads an array of points or cells. Returns false if the keyword is not that of an array.
    fn array(&mut self, keyword: &str) -> Result<bool> {
        let Some((count, _)) = self.of_points else { return Ok(false) };
        let known =
            ["SCALARS", "COLOR_SCALARS", "LOOKUP_TABLE", "VECTORS", "NORMALS", "TEXTURE_COORDINATES", "TENSORS"];
        if !known.contains(&keyword) {
            return Ok(false);
        }
        let name = self.source.word().map(|name| String::from_utf8_lossy(name).into_owned()).unwrap_or_default();
        // Colours and tables of colours have bytes in binary files and fractions in text.
        let bytes = if self.source.binary.is_some() { Type::U8 } else { Type::F32 };
        let (kind, components, role) = match keyword {
            "LOOKUP_TABLE" => {
                let size = self.source.count()?;
                self.numbers(bytes, size.saturating_mul(4))?;
                return Ok(true);
            }
            "COLOR_SCALARS" => (bytes, self.source.count()?, Role::Colors),
            "SCALARS" => {
                let kind = self.number_type()?;
                let components = self.count_on_line().unwrap_or(1);
                if self.source.peek_word().is_some_and(|word| word.eq_ignore_ascii_case(b"LOOKUP_TABLE")) {
                    self.source.word();
                    self.source.word();
                }
                (kind, components, Role::Plain)
            }
            "TEXTURE_COORDINATES" => {
                let components = self.source.count()?;
                (self.number_type()?, components, Role::Texture)
            }
            "NORMALS" => (self.number_type()?, 3, Role::Normals),
            "TENSORS" => (self.number_type()?, 9, Role::Plain),
            _ => (self.number_type()?, 3, Role::Plain),
        };
        let values = self.numbers(kind, count.saturating_mul(components))?;
        self.keep(Array { name, components, values, kind, role });
        Ok(true)
    }

    /// Reads the arrays of a field. A field outside of point and cell data belongs to neither.
    fn field(&mut self) -> Result<()> {
        self.source.word();
        for _ in 0..self.source.count()? {
            // An array may be followed by a description.
            if self.source.peek_word() == Some(b"METADATA") {
                self.source.word();
                self.skip_lines();
            }
            let name = self.source.word().map(|name| String::from_utf8_lossy(name).into_owned()).unwrap_or_default();
            let (components, count) = (self.source.count()?, self.source.count()?);
            let kind = self.number_type()?;
            let values = self.numbers(kind, count.saturating_mul(components))?;
            self.keep(Array { name, components, values, kind, role: Role::Plain });
        }
        Ok(())
    }

    fn keep(&mut self, array: Array) {
        if matches!(self.of_points, Some((_, true))) {
            self.surface.arrays.push(array);
        }
    }

    /// Reads a count, if there is another word on this line.
    fn count_on_line(&mut self) -> Option<usize> {
        let rest = self.source.rest();
        let line = &rest[..rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len())];
        if line.trim_ascii().is_empty() { None } else { self.source.count().ok() }
    }

    fn number_type(&mut self) -> Result<Type> {
        let word = self.source.word().unwrap_or_default();
        Ok(match word.to_ascii_lowercase().as_slice() {
            b"char" | b"signed_char" => Type::I8,
            b"unsigned_char" => Type::U8,
            b"short" => Type::I16,
            b"unsigned_short" => Type::U16,
            b"int" | b"vtkidtype" => Type::I32,
            b"unsigned_int" => Type::U32,
            b"long" | b"long_long" | b"vtktypeint64" => Type::I64,
            b"unsigned_long" | b"unsigned_long_long" | b"vtktypeuint64" => Type::U64,
            b"float" => Type::F32,
            b"double" => Type::F64,
            _ => return Err(self.source.wrong(format!("the number type {} is not supported", quote(word)))),
        })
    }

    /// Reads the next `count` numbers. In binary files they begin on the next line.
    fn numbers(&mut self, kind: Type, count: usize) -> Result<Vec<f64>> {
        if count > 0 && self.source.binary.is_some() {
            self.source.line();
        }
        self.source.numbers(kind, count)
    }
}
