//! The binary form of OFF: three counts, vertices and faces, in four-byte numbers, most significant byte first.

use super::further::Further;
use crate::base::error::Result;
use crate::io::content::{Parsed, Read};
use crate::io::grid::Grid;
use crate::io::mixed::Mixed;
use crate::io::numbers::{Order, Type, index};
use glam::DVec3;

/// Reads the content from byte `start` on.
pub(super) fn parse(bytes: &[u8], start: usize, further: Further) -> Parsed {
    let mut source = Mixed::new(bytes);
    source.binary = Some(Order::Big);
    source.skip(start);
    let width = further.width();
    let vertices = source.number(Type::I32)?;
    let faces = source.number(Type::I32)?;
    let edges = source.number(Type::I32)?;
    if vertices < 0.0 || faces < 0.0 || edges < 0.0 {
        return Err(source.wrong("a count of vertices, faces or edges is negative"));
    }
    let (vertices, faces) = (vertices as usize, faces as usize);
    source.check_room(vertices, 4 * (3 + width))?;
    let mut grid = Grid::default();
    let mut values = Vec::with_capacity(vertices * width);
    for v in 0..vertices {
        let mut next = || source.number(Type::F32);
        let position = DVec3::new(next()?, next()?, next()?);
        for _ in 0..width {
            values.push(next()?);
        }
        if !position.is_finite() {
            return Err(source.wrong(format!("a coordinate of vertex {v} is not finite")));
        }
        grid.positions.push(position);
    }
    // Each face has at least a count of corners and a count of colours.
    source.check_room(faces, 8)?;
    for _ in 0..faces {
        read_face(&mut source, &mut grid)?;
    }
    let left = source.rest().len();
    let (mesh, mut notes) = grid.into_mesh()?;
    if left > 0 {
        notes.push(format!("{left} bytes after the last face are left out"));
    }
    let attributes = further.attributes_of(values, width, &mesh.triangles, &mut notes);
    Ok(Read { mesh, attributes, notes })
}

fn read_face(source: &mut Mixed, grid: &mut Grid) -> Result<()> {
    let corners = source.size(Type::I32, 4)?;
    let vertices = grid.positions.len();
    for _ in 0..corners {
        let number = source.number(Type::I32)?;
        let corner = index(number, vertices).ok_or_else(|| {
            source.wrong(format!("a face uses vertex {number}, but vertices go from 0 to {}", vertices as i64 - 1))
        })?;
        grid.faces.push_corner(corner);
    }
    grid.faces.end();
    let colors = source.size(Type::I32, 4)?;
    source.skip(4 * colors);
    Ok(())
}
