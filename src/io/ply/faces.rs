//! Tables of polygons and triangle strips, converted to triangles.

use super::elements::{checked_count, list_length, skip};
use super::header::{Element, Kind, Property};
use super::source::Source;
use crate::base::error::{Error, Place, Result};
use crate::geom::polygon::triangulate;
use crate::io::bytes::{EXPORT_AGAIN, malformed};
use crate::mesh::attributes::Scalar;
use glam::{DVec2, DVec3};

/// The faces that were read so far.
#[derive(Default)]
pub(super) struct Faces {
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates of each triangle's corners; empty if no list has any.
    pub texture: Vec<[DVec2; 3]>,
    /// Number of faces with fewer than three corners.
    pub small: usize,
}

/// Role of a property of a face.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    LeftOut,
    Corners,
    Texture,
}

impl Faces {
    /// Reads a table of faces over `positions`. A note lists the properties that are left out.
    pub fn read<S: Source>(
        &mut self,
        source: &mut S,
        element: &Element,
        positions: &[DVec3],
        notes: &mut Vec<String>,
    ) -> Result<()> {
        let is_strips = element.name == "tristrips";
        let plan: Vec<(Kind, Role)> = element.properties.iter().map(|p| (p.kind, role(p, is_strips))).collect();
        if !plan.iter().any(|(_, role)| *role == Role::Corners) {
            let cause = format!("the element '{}' has no list 'vertex_indices'", element.name);
            return Err(element.error(cause, EXPORT_AGAIN));
        }
        let left_out = element.properties.iter().filter(|p| role(p, is_strips) == Role::LeftOut);
        let left_out: Vec<String> = left_out.map(|p| format!("'{}'", p.name)).collect();
        if !left_out.is_empty() && element.count > 0 {
            notes.push(format!("properties of faces are left out: {}", left_out.join(", ")));
        }
        let mut table = Table { faces: self, positions, corners: Vec::new(), texture: Vec::new() };
        let count = checked_count(source, element)?;
        table.faces.triangles.reserve(count);
        for _ in 0..count {
            for &(kind, role) in &plan {
                match (kind, role) {
                    (Kind::List { count, item }, Role::Corners) if is_strips => table.strips(source, count, item)?,
                    (Kind::List { count, item }, Role::Corners) => table.corners(source, count, item)?,
                    (Kind::List { count, item }, Role::Texture) => table.texture(source, count, item)?,
                    _ => skip(source, kind)?,
                }
            }
            if !is_strips {
                table.end_face();
            }
        }
        Ok(())
    }
}

fn role(property: &Property, is_strips: bool) -> Role {
    match (property.name.as_str(), property.kind) {
        _ if is_corners(property) => Role::Corners,
        ("texcoord", Kind::List { .. }) if !is_strips => Role::Texture,
        _ => Role::LeftOut,
    }
}

/// Whether a property of a face is its list of corners.
pub(super) fn is_corners(property: &Property) -> bool {
    matches!((property.name.as_str(), property.kind), ("vertex_indices" | "vertex_index", Kind::List { .. }))
}

/// A table that is being read, with the current row.
struct Table<'a> {
    faces: &'a mut Faces,
    positions: &'a [DVec3],
    corners: Vec<u32>,
    texture: Vec<f64>,
}

impl Table<'_> {
    #[inline]
    fn corners<S: Source>(&mut self, source: &mut S, count: Scalar, item: Scalar) -> Result<()> {
        self.corners.clear();
        for _ in 0..list_length(source, count, item)? {
            let index = source.value(item)?;
            self.corners.push(self.checked_index(source, index)?);
        }
        Ok(())
    }

    fn texture<S: Source>(&mut self, source: &mut S, count: Scalar, item: Scalar) -> Result<()> {
        self.texture.clear();
        for _ in 0..list_length(source, count, item)? {
            self.texture.push(source.value(item)?);
        }
        Ok(())
    }

    /// Triangulates the polygon of the current row.
    #[inline]
    fn end_face(&mut self) {
        match self.corners.len() {
            0..3 => self.faces.small += 1,
            3 => self.push([0, 1, 2]),
            _ => {
                let places: Vec<DVec3> = self.corners.iter().map(|&v| self.positions[v as usize]).collect();
                triangulate(&places).into_iter().for_each(|t| self.push(t));
            }
        }
    }

    /// Adds the triangle of these corners of the polygon, with texture coordinates if there is a pair for each corner.
    #[inline]
    fn push(&mut self, corners: [usize; 3]) {
        if !self.texture.is_empty() && self.texture.len() == 2 * self.corners.len() {
            // Earlier faces may have no texture coordinates.
            self.faces.texture.resize(self.faces.triangles.len(), [DVec2::NAN; 3]);
            self.faces.texture.push(corners.map(|i| DVec2::new(self.texture[2 * i], self.texture[2 * i + 1])));
        }
        self.faces.triangles.push(corners.map(|i| self.corners[i]));
    }

    /// Reads one list of strips.
    fn strips<S: Source>(&mut self, source: &mut S, count: Scalar, item: Scalar) -> Result<()> {
        let mut last: [Option<u32>; 2] = [None; 2];
        let mut odd = false;
        for _ in 0..list_length(source, count, item)? {
            let index = source.value(item)?;
            // In an unsigned list, -1 is stored as the largest number.
            if index == -1.0 || index == f64::from(u32::MAX) {
                (last, odd) = ([None; 2], false);
                continue;
            }
            let c = self.checked_index(source, index)?;
            if let [Some(a), Some(b)] = last {
                if a != b && b != c && c != a {
                    self.faces.triangles.push(if odd { [b, a, c] } else { [a, b, c] });
                }
                odd = !odd;
            }
            last = [last[1], Some(c)];
        }
        Ok(())
    }

    #[inline]
    fn checked_index<S: Source>(&self, source: &S, index: f64) -> Result<u32> {
        if is_number_below(index, self.positions.len()) {
            return Ok(index as u32);
        }
        Err(no_vertex(index, self.positions.len(), source.place()))
    }
}

/// Whether `index` is an integer below `vertices`.
#[inline]
pub(super) fn is_number_below(index: f64, vertices: usize) -> bool {
    // The conversion saturates, so only an integer in range is unchanged.
    let whole = index as u32;
    f64::from(whole) == index && (whole as usize) < vertices
}

#[cold]
pub(super) fn no_vertex(index: f64, vertices: usize, place: Place) -> Error {
    malformed(place, format!("there is no vertex {index}, the file has {vertices}"), EXPORT_AGAIN)
}
