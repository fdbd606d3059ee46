//! VTK: legacy files in text or binary, and polygons (VTP) and unstructured grids (VTU) as XML.
//!
//! Both forms have points, cells of several kinds over them, and arrays of numbers. Read are polygons, triangle strips and,
//! of unstructured grids, the two-dimensional cells, or, if there are none, the outer surface of the three-dimensional ones;
//! cells of higher order are reduced to their corners. Arrays of points become attributes: normals and texture coordinates
//! if the file declares them as such, colours if they are three or four unsigned bytes, or named `color`.
//!
//! The counts in a file are compared with its length before memory is reserved. The unpacked size of arrays is bounded by a
//! multiple of that length.
//!
//! Limits: vertices and lines beside faces, volume cells and cell arrays are left out. Other kinds of grids are refused, and
//! so are arrays compressed by LZ4 or LZMA.

mod arrays;
mod legacy;
mod write;
mod xml;

pub(crate) use legacy::parse as parse_legacy;
pub(crate) use write::write;
pub(crate) use xml::parse as parse_xml;

use super::bytes::{EXPORT_AGAIN, malformed};
use super::cells::Kind;
use super::grid::Grid;
use super::numbers::{Type, index};
use crate::base::error::{Error, Place, Result};
use crate::io::content::{Parsed, Read};
use crate::mesh::attributes::{Attribute, Attributes, COLOR, NORMAL};
use crate::mesh::triangle_mesh::Mesh;
use glam::{DVec2, DVec3};

/// Whether a file that begins with `head` is an unstructured grid as XML, and not just a list of other files with its
/// pieces.
pub(super) fn is_grid(head: &[u8]) -> bool {
    ["\"UnstructuredGrid", "'UnstructuredGrid"]
        .iter()
        .any(|kind| head.windows(kind.len()).any(|w| w == kind.as_bytes()))
}

/// Remedy for a grid.
const EXTRACT: &str = "open it in ParaView, extract its surface and save that as VTP";

/// Kinds of cells, as far as they are read differently.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cell {
    Points,
    Lines,
    Polygon,
    /// Four corners, row by row.
    Pixel,
    Strip,
    /// A polygon of higher order, with this number of corners before its other vertices.
    Curved(usize),
    /// A volume cell, with or without further vertices after its corners.
    Solid(Kind),
    /// A volume cell with eight corners, row by row and layer by layer.
    Voxel,
    OtherSolid,
}

/// Role of an array of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    Plain,
    Normals,
    Texture,
    Colors,
}

/// Numbers of all points.
#[derive(Debug, Clone)]
struct Array {
    name: String,
    components: usize,
    values: Vec<f64>,
    kind: Type,
    role: Role,
}

/// The content of a file while it is read.
#[derive(Default)]
struct Surface {
    grid: Grid,
    arrays: Vec<Array>,
}

impl Cell {
    /// Returns the kind for a cell type of unstructured grids.
    fn of_type(number: f64) -> Cell {
        match number as i64 {
            1 | 2 => Cell::Points,
            3 | 4 | 21 => Cell::Lines,
            5 | 7 | 9 => Cell::Polygon,
            6 => Cell::Strip,
            8 => Cell::Pixel,
            22 | 34 => Cell::Curved(3),
            23 | 28 | 30 => Cell::Curved(4),
            10 | 24 => Cell::Solid(Kind::Tetrahedron),
            11 => Cell::Voxel,
            12 | 25 | 29 | 33 => Cell::Solid(Kind::Hexahedron),
            13 | 26 | 31 | 32 => Cell::Solid(Kind::Prism),
            14 | 27 | 37 => Cell::Solid(Kind::Pyramid),
            _ => Cell::OtherSolid,
        }
    }
}

impl Surface {
    /// Adds points, three numbers each.
    fn add_positions(&mut self, numbers: &[f64]) -> Result<()> {
        self.grid.positions.extend(numbers.chunks_exact(3).map(DVec3::from_slice));
        match self.grid.positions.iter().position(|p| !p.is_finite()) {
            Some(v) => {
                Err(malformed(Place::Part(format!("point {v}")), "a coordinate is not finite", "remove this point"))
            }
            None => Ok(()),
        }
    }

    /// Adds a cell over the points from `base` on.
    fn add_cell(&mut self, cell: Cell, corners: &[f64], base: usize) -> Result<()> {
        let of_order = match cell {
            Cell::Points => return Ok(()),
            Cell::Lines => {
                self.grid.lines += 1;
                return Ok(());
            }
            Cell::OtherSolid => {
                self.grid.other_cells += 1;
                return Ok(());
            }
            Cell::Curved(count) => &corners[..count.min(corners.len())],
            Cell::Solid(kind) => &corners[..kind.corners().min(corners.len())],
            Cell::Polygon | Cell::Pixel | Cell::Strip | Cell::Voxel => corners,
        };
        let points = self.grid.positions.len() - base;
        let vertex = |&corner: &f64| {
            let found = index(corner, points).map(|v| v + base as u32);
            found.ok_or_else(|| {
                let cause = format!("a cell uses point {corner}, but points go from 0 to {}", points as i64 - 1);
                malformed(Place::Part(format!("face {}", self.grid.faces.count())), cause, EXPORT_AGAIN)
            })
        };
        let vertices: Vec<u32> = of_order.iter().map(vertex).collect::<Result<_>>()?;
        match (cell, &vertices[..]) {
            (Cell::Strip, strip) => {
                for (i, w) in strip.windows(3).enumerate() {
                    self.grid.add_face(if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] });
                }
            }
            (Cell::Pixel, &[a, b, c, d]) => self.grid.add_face([a, b, d, c]),
            (Cell::Voxel, &[a, b, c, d, e, f, g, h]) => {
                self.grid.cells.push(Kind::Hexahedron, [a, b, d, c, e, f, h, g]);
            }
            (Cell::Solid(kind), corners) if corners.len() == kind.corners() => {
                self.grid.cells.push(kind, corners.iter().copied());
            }
            (Cell::Solid(_) | Cell::Voxel, _) => self.grid.other_cells += 1,
            (_, polygon) => self.grid.add_face(polygon.iter().copied()),
        }
        Ok(())
    }

    fn finish(self) -> Parsed {
        let Grid { faces, other_cells, .. } = &self.grid;
        if faces.count() == 0 && *other_cells > 0 {
            let cause = format!("it has volume cells, {other_cells} of them of unknown types, and no faces");
            return Err(malformed(Place::Whole, cause, EXTRACT));
        }
        let (mesh, mut notes) = self.grid.into_mesh()?;
        let attributes = attributes(self.arrays, &mesh, &mut notes);
        Ok(Read { mesh, attributes, notes })
    }
}

/// Converts arrays to attributes.
fn attributes(arrays: Vec<Array>, mesh: &Mesh, notes: &mut Vec<String>) -> Attributes {
    let (points, triangles) = (mesh.positions.len(), &mesh.triangles);
    let mut attributes = Attributes::default();
    for array in arrays {
        if array.components == 0 || Some(array.values.len()) != array.components.checked_mul(points) {
            notes.push(format!(
                "the array '{}' is left out: it does not have one value for each point",
                array.name.escape_debug()
            ));
            continue;
        }
        let is_color = array.role == Role::Colors
            || array.kind == Type::U8
            || array.name == COLOR && matches!(array.kind, Type::U16 | Type::F32 | Type::F64);
        let is_color = is_color && matches!(array.components, 3 | 4) && attributes.get(COLOR).is_none();
        let is_normal = array.role == Role::Normals || array.name.eq_ignore_ascii_case("normals");
        let is_normal = is_normal && array.components == 3 && attributes.get(NORMAL).is_none();
        let is_texture = array.role == Role::Texture && array.components >= 2 && attributes.texture.is_empty();
        if is_texture && !triangles.is_empty() {
            let row = |v: u32| DVec2::from_slice(&array.values[v as usize * array.components..]);
            attributes.texture = triangles.iter().map(|t| t.map(row)).collect();
            continue;
        }
        let name = match () {
            () if is_color => COLOR.into(),
            () if is_normal => NORMAL.into(),
            () => array.name,
        };
        let scalar = array.kind.scalar(&array.values);
        attributes.vertex.push(Attribute { name, components: array.components, values: array.values, scalar });
    }
    attributes
}

fn wrong(place: Place, cause: impl Into<String>) -> Error {
    malformed(place, cause, EXPORT_AGAIN)
}

#[cfg(test)]
mod tests;
