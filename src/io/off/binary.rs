//! The binary form of OFF: three counts, vertices and faces in numbers of four bytes, the most significant first.

use super::Further;
use crate::base::error::Result;
use crate::io::content::{Parsed, Read};
use crate::io::grid::Grid;
use crate::io::mixed::Mixed;
use crate::io::numbers::{Order, Type, index};
use glam::DVec3;

/// Reads what begins at byte `start`.
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
    // The counts of corners and of colours.
    source.check_room(faces, 8)?;
    for _ in 0..faces {
        read_face(&mut source, &mut grid)?;
    }
    let left = source.rest().len();
    let (mesh, mut notes) = grid.into_mesh("")?;
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

#[cfg(test)]
mod tests {
    use crate::base::error::Place;
    use crate::io::bytes::samples::fault;
    use crate::io::off::{has_keyword, parse};
    use glam::DVec3;

    fn file(keyword: &str, further: &[[f32; 4]]) -> Vec<u8> {
        let mut bytes = keyword.as_bytes().to_vec();
        let ints = |numbers: &[i32]| numbers.iter().flat_map(|x| x.to_be_bytes()).collect::<Vec<_>>();
        bytes.extend(ints(&[4, 2, 0]));
        for (v, place) in [[0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]].into_iter().enumerate()
        {
            bytes.extend(place.iter().chain(further.get(v).into_iter().flatten()).flat_map(|x| x.to_be_bytes()));
        }
        bytes.extend([ints(&[4, 0, 1, 2, 3, 0]), ints(&[3, 0, 1, 2, 1]), 0.5f32.to_be_bytes().to_vec()].concat());
        bytes
    }

    #[test]
    fn binary_files_are_read() {
        for keyword in ["OFF BINARY\n", "# a\nOFF\nBINARY\n"] {
            let bytes = file(keyword, &[]);
            assert!(has_keyword(&bytes));
            let read = parse(&bytes).unwrap();
            assert_eq!(read.mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
            assert_eq!(read.mesh.positions[2], DVec3::new(1.0, 1.0, 0.0));
            assert!(read.notes.is_empty() && read.attributes.is_empty());
        }
        let read = parse(&file("COFF BINARY\n", &[[0.0, 0.25, 0.5, 1.0]; 4])).unwrap();
        assert_eq!(read.attributes.color().unwrap().of(3), [0.0, 0.25, 0.5, 1.0]);
    }

    #[test]
    fn errors_name_the_byte() {
        let good = file("OFF BINARY\n", &[]);
        for end in 0..good.len() - 4 {
            assert!(parse(&good[..end]).is_err(), "{end}");
        }
        for (at, value, words) in [
            (11, -1, "is negative"),
            (11, 99, "99 entries are promised"),
            (15, 99, "99 entries are promised"),
            (75, 4, "uses vertex 4"),
            (71, 1 << 30, "entries are promised"),
            (23, f32::NAN.to_bits() as i32, "not finite"),
        ] {
            let mut bytes = good.clone();
            bytes[at..at + 4].copy_from_slice(&i32::to_be_bytes(value));
            let (place, cause) = fault(parse(&bytes));
            assert!(matches!(place, Place::Byte(_)) && cause.contains(words), "{cause}");
        }
    }
}
