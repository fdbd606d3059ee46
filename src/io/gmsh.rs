//! MSH, the format of Gmsh, versions 2 and 4.1, in text and binary.
//!
//! A file has sections from `$Name` to `$EndName`. Nodes are read, by the tags that elements refer to, and of the elements
//! triangles and quadrilaterals; elements of higher order are reduced to their corners. Text and binary differ only in the
//! form of numbers, except that binary files of version 2 store elements in blocks.
//!
//! The counts in a file are compared with its length before memory is reserved.
//!
//! If a file has volume cells and no faces, their outer surface is read.
//!
//! Limits: points, physical groups and node data are left out, and so are lines and volumes beside faces.

use super::bytes::{CUT_SHORT, EXPORT_AGAIN, malformed};
use super::cells::Kind;
use super::grid::Grid;
use super::mixed::Mixed;
use super::numbers::{Order, Type};
use super::text::number;
use crate::base::error::{Error, Place, Result};
use crate::io::content::{Parsed, Read};
use glam::DVec3;
use std::collections::HashMap;

/// Number of nodes of the element types from 1 on.
const NODES: [usize; 31] =
    [2, 3, 4, 4, 8, 6, 5, 3, 6, 9, 10, 27, 18, 14, 1, 8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5, 6, 20, 35, 56];

/// Type of an element, as far as its reader distinguishes them.
enum Element {
    Point,
    Line,
    /// A polygon with this number of corners, which are its first nodes.
    Face(usize),
    /// A volume cell, whose corners are its first nodes, too.
    Cell(Kind),
}

/// Reads the surface in an MSH file.
///
/// # Errors
/// `Error::Format` with the line or byte that is malformed.
pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    if is_of_mujoco(bytes) {
        let cause = "it is a binary mesh of MuJoCo, which also uses the extension .msh";
        return Err(malformed(Place::Byte(0), cause, "give the OBJ or STL file that it was made from"));
    }
    let mut reader = Reader { source: Mixed::new(bytes), size: Type::U64, tags: HashMap::new(), grid: Grid::default() };
    let is_new = reader.format()?;
    let mut has_elements = false;
    while let Some(word) = reader.source.word() {
        match word {
            b"$Nodes" => if is_new { reader.nodes_of_blocks() } else { reader.nodes() }?,
            b"$Elements" => {
                has_elements = true;
                if is_new { reader.elements_of_blocks() } else { reader.elements() }?;
            }
            name => reader.skip_section(name)?,
        }
    }
    if !has_elements {
        return Err(malformed(reader.source.place(), "it has no $Elements section", CUT_SHORT));
    }
    let (mesh, notes) = reader.grid.into_mesh()?;
    Ok(Read { mesh, notes, ..Read::default() })
}

/// Whether the length of a file matches its first numbers, taken as counts of vertices, normals, texture coordinates and
/// triangles.
fn is_of_mujoco(bytes: &[u8]) -> bool {
    let Some((counts, rest)) = bytes.split_at_checked(16) else { return false };
    let counts = counts.chunks_exact(4).map(|n| u64::from(u32::from_le_bytes(n.try_into().expect("four bytes"))));
    !rest.is_empty() && rest.len() as u64 == counts.zip([12, 12, 8, 12]).map(|(count, size)| count * size).sum::<u64>()
}

struct Reader<'a> {
    source: Mixed<'a>,
    /// Type of counts and tags in version 4.
    size: Type,
    /// Vertex of each node tag.
    tags: HashMap<u64, u32>,
    grid: Grid,
}

impl Reader<'_> {
    /// Reads the first section. Returns whether the version is 4.1.
    fn format(&mut self) -> Result<bool> {
        if self.source.word() != Some(b"$MeshFormat") {
            let cause = "it does not begin with $MeshFormat";
            return Err(malformed(Place::Line(1), cause, "check that this is an MSH file of version 2 or 4"));
        }
        let version = self.source.word().and_then(number).unwrap_or(0.0);
        let is_new = (4.1..5.0).contains(&version);
        if !(is_new || (2.0..3.0).contains(&version)) {
            let cause = format!("MSH version {version} is not supported, only 2 and 4.1 are");
            return Err(malformed(
                self.source.place(),
                cause,
                "convert it with `gmsh IN -save -format msh41 -o OUT.msh`",
            ));
        }
        let is_binary = self.source.count()? == 1;
        self.size = match self.source.count()? {
            4 => Type::U32,
            8 => Type::U64,
            other => {
                return Err(self.source.wrong(format!("numbers have {other} bytes, but only 4 and 8 are supported")));
            }
        };
        if is_binary {
            self.source.line();
            let one = self.source.rest();
            self.source.binary = Some(if one.starts_with(&[1, 0, 0, 0]) { Order::Little } else { Order::Big });
            self.source.skip(4);
        }
        self.end("$EndMeshFormat")?;
        Ok(is_new)
    }

    fn end(&mut self, name: &str) -> Result<()> {
        match self.source.word() {
            Some(word) if word == name.as_bytes() => Ok(()),
            _ => Err(self.source.wrong(format!("the section does not end with {name}"))),
        }
    }

    /// Skips the section that begins with the word `name`.
    fn skip_section(&mut self, name: &[u8]) -> Result<()> {
        let Some(name) = name.strip_prefix(b"$") else {
            return Err(self.source.wrong(format!("{} is not the name of a section", super::text::quote(name))));
        };
        let end = [b"$End", name].concat();
        let at = self.source.rest().windows(end.len()).position(|w| w == end);
        let at = at.ok_or_else(|| self.source.wrong(format!("the closing {} is missing", end.escape_ascii())))?;
        self.source.skip(at + end.len());
        Ok(())
    }

    /// Goes to the next line in binary files, in which numbers begin there.
    fn start(&mut self) {
        if self.source.binary.is_some() {
            self.source.line();
        }
    }

    fn node(&mut self, tag: f64) -> Result<()> {
        let mut next = || self.source.number(Type::F64);
        let position = DVec3::new(next()?, next()?, next()?);
        self.add_node(tag, position)
    }

    fn add_node(&mut self, tag: f64, position: DVec3) -> Result<()> {
        if !position.is_finite() {
            return Err(self.source.wrong(format!("a coordinate of node {tag} is not finite")));
        }
        self.tags.insert(tag as u64, self.grid.positions.len() as u32);
        self.grid.positions.push(position);
        Ok(())
    }

    fn nodes(&mut self) -> Result<()> {
        let count = self.source.count()?;
        self.start();
        self.source.check_room(count, 4 * self.source.least(Type::I32))?;
        for _ in 0..count {
            let tag = self.source.number(Type::I32)?;
            self.node(tag)?;
        }
        self.end("$EndNodes")
    }

    fn nodes_of_blocks(&mut self) -> Result<()> {
        self.start();
        let blocks = self.source.size(self.size, 0)?;
        self.source.numbers(self.size, 3)?;
        for _ in 0..blocks {
            let dimension = self.source.number(Type::I32)?;
            self.source.number(Type::I32)?;
            let is_parametric = self.source.number(Type::I32)? != 0.0;
            let count = self.source.size(self.size, self.source.least(self.size))?;
            let tags = self.source.numbers(self.size, count)?;
            let parameters = if is_parametric { dimension as usize } else { 0 };
            for tag in tags {
                self.node(tag)?;
                self.source.numbers(Type::F64, parameters)?;
            }
        }
        self.end("$EndNodes")
    }

    fn elements(&mut self) -> Result<()> {
        let count = self.source.count()?;
        self.start();
        let mut found = 0;
        while found < count {
            if self.source.binary.is_none() {
                self.source.number(Type::I32)?;
                let kind = self.source.number(Type::I32)?;
                let labels = self.source.size(Type::I32, 2)?;
                self.source.numbers(Type::I32, labels)?;
                self.element(kind, Type::I32)?;
                found += 1;
                continue;
            }
            let kind = self.source.number(Type::I32)?;
            let block = self.source.size(Type::I32, 4)?;
            let labels = self.source.size(Type::I32, 4)?;
            if block == 0 {
                return Err(self.source.wrong("a block has no elements"));
            }
            for _ in 0..block {
                self.source.numbers(Type::I32, 1 + labels)?;
                self.element(kind, Type::I32)?;
            }
            found = found.saturating_add(block);
        }
        self.end("$EndElements")
    }

    fn elements_of_blocks(&mut self) -> Result<()> {
        self.start();
        let blocks = self.source.size(self.size, 0)?;
        self.source.numbers(self.size, 3)?;
        for _ in 0..blocks {
            self.source.numbers(Type::I32, 2)?;
            let kind = self.source.number(Type::I32)?;
            let count = self.source.size(self.size, self.source.least(self.size))?;
            for _ in 0..count {
                self.source.number(self.size)?;
                self.element(kind, self.size)?;
            }
        }
        self.end("$EndElements")
    }

    /// Reads the nodes of an element, whose tags are numbers of type `tag`.
    fn element(&mut self, kind: f64, tag: Type) -> Result<()> {
        let Some(&count) = NODES.get((kind as usize).wrapping_sub(1)) else {
            let cause = format!("element type {kind} is not known");
            return Err(malformed(self.source.place(), cause, "save it with first-order elements"));
        };
        let nodes = self.source.numbers(tag, count)?;
        let element = element(kind);
        let corners = match element {
            Element::Face(corners) => &nodes[..corners],
            Element::Line => {
                self.grid.lines += 1;
                return Ok(());
            }
            Element::Cell(kind) => &nodes[..kind.corners()],
            Element::Point => return Ok(()),
        };
        let vertex = |&tag: &f64| self.tags.get(&(tag as u64)).copied().ok_or(tag);
        let corners: std::result::Result<Vec<u32>, f64> = corners.iter().map(vertex).collect();
        let corners = corners.map_err(|tag| self.unknown_node(tag))?;
        match element {
            Element::Cell(kind) => self.grid.cells.push(kind, corners),
            _ => self.grid.add_face(corners),
        }
        Ok(())
    }

    fn unknown_node(&self, tag: f64) -> Error {
        malformed(
            self.source.place(),
            format!("an element uses node {tag}, which the file does not have"),
            EXPORT_AGAIN,
        )
    }
}

fn element(kind: f64) -> Element {
    match kind as usize {
        15 => Element::Point,
        1 | 8 | 26..=28 => Element::Line,
        2 | 9 | 20..=25 => Element::Face(3),
        3 | 10 | 16 => Element::Face(4),
        4 | 11 | 29..=31 => Element::Cell(Kind::Tetrahedron),
        5 | 12 | 17 => Element::Cell(Kind::Hexahedron),
        6 | 13 | 18 => Element::Cell(Kind::Prism),
        // 7, 14 and 19: other types have no entry in `NODES`.
        _ => Element::Cell(Kind::Pyramid),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::bytes::samples::{fails_at, fault};

    const OLD: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"a\"\n$EndPhysicalNames\n$Nodes\n4\n\
                       10 0 0 0\n20 1 0 0\n30 1 1 0\n40 0 1 0\n$EndNodes\n$Elements\n4\n1 15 2 0 1 10\n2 1 2 0 1 10 20\n\
                       3 2 2 0 1 10 20 30\n4 3 1 0 10 20 30 40\n$EndElements\n";

    const NEW: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 1 0\n1 0 0 0 1 1 1 0 0\n$EndEntities\n\
                       $Nodes\n2 4 10 40\n2 1 1 2\n10\n20\n0 0 0 .5 .5\n1 0 0 .5 .5\n2 1 0 2\n30\n40\n1 1 0\n0 1 0\n$EndNodes\n\
                       $Elements\n3 3 1 4\n1 1 1 1\n2 10 20\n2 1 2 1\n3 10 20 30\n2 1 3 1\n4 10 20 30 40\n$EndElements\n";

    fn ints(numbers: &[i32], order: Order) -> Vec<u8> {
        let bytes = |x: &i32| if order == Order::Big { x.to_be_bytes() } else { x.to_le_bytes() };
        numbers.iter().flat_map(bytes).collect()
    }

    fn floats(numbers: &[f64], order: Order) -> Vec<u8> {
        let bytes = |x: &f64| if order == Order::Big { x.to_be_bytes() } else { x.to_le_bytes() };
        numbers.iter().flat_map(bytes).collect()
    }

    const PLACES: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

    fn old_binary(order: Order) -> Vec<u8> {
        let mut bytes = b"$MeshFormat\n2.2 1 8\n".to_vec();
        bytes.extend(ints(&[1], order));
        bytes.extend(b"\n$EndMeshFormat\n$Nodes\n4\n");
        for (tag, place) in [10, 20, 30, 40].into_iter().zip(PLACES) {
            bytes.extend([ints(&[tag], order), floats(&place, order)].concat());
        }
        bytes.extend(b"\n$EndNodes\n$Elements\n3\n");
        bytes.extend(ints(&[1, 1, 1, 2, 0, 10, 20], order));
        bytes.extend(ints(&[2, 1, 2, 3, 0, 1, 10, 20, 30], order));
        bytes.extend(ints(&[3, 1, 0, 4, 10, 20, 30, 40], order));
        bytes.extend(b"\n$EndElements\n");
        bytes
    }

    fn new_binary() -> Vec<u8> {
        let order = Order::Little;
        let sizes = |numbers: &[u64]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>();
        let mut bytes = b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n$EndMeshFormat\n$Nodes\n".to_vec();
        bytes.extend([sizes(&[1, 4, 10, 40]), ints(&[2, 1, 0], order), sizes(&[4, 10, 20, 30, 40])].concat());
        bytes.extend(floats(PLACES.as_flattened(), order));
        bytes.extend(b"\n$EndNodes\n$Elements\n");
        bytes.extend([sizes(&[3, 3, 1, 3]), ints(&[1, 1, 1], order), sizes(&[1, 2, 10, 20])].concat());
        bytes.extend([ints(&[2, 1, 2], order), sizes(&[1, 3, 10, 20, 30])].concat());
        bytes.extend([ints(&[2, 1, 3], order), sizes(&[1, 4, 10, 20, 30, 40])].concat());
        bytes.extend(b"\n$EndElements\n");
        bytes
    }

    #[test]
    fn all_forms_are_the_same() {
        for bytes in [OLD.into(), NEW.into(), old_binary(Order::Little), old_binary(Order::Big), new_binary()] {
            let read = parse(&bytes).unwrap();
            assert_eq!(read.mesh.positions, PLACES.map(DVec3::from));
            assert_eq!(read.mesh.triangles, [[0, 1, 2], [0, 1, 2], [0, 2, 3]]);
            assert_eq!(read.notes, ["1 line is left out"]);
            // The last line holds only the end of the section.
            for end in 0..bytes.len() - "$EndElements\n".len() {
                assert!(parse(&bytes[..end]).is_err(), "{end}");
            }
        }
    }

    #[test]
    fn curved_elements_give_their_corners() {
        let text = OLD.replace("3 2 2 0 1 10 20 30\n", "3 9 2 0 1 10 20 30 40 40 40\n");
        assert_eq!(parse(text.as_bytes()).unwrap().mesh.triangles[0], [0, 1, 2]);
    }

    #[test]
    fn the_outside_of_a_volume_is_read() {
        let elements = "2\n1 4 2 0 1 10 20 30 40\n2 15 2 0 1 10\n";
        let text = OLD[..OLD.find("$Elements").unwrap()].to_string() + "$Elements\n" + elements + "$EndElements\n";
        let Read { mesh, notes, .. } = parse(text.as_bytes()).unwrap();
        assert_eq!(mesh.triangles, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
        assert_eq!(notes, ["1 cell fills a volume: only its outer surface is used"]);
    }

    #[test]
    fn what_ends_like_one_but_is_of_mujoco_is_named() {
        let counts = [3, 0, 3, 1].map(u32::to_le_bytes).concat();
        let (_, cause) = fault(parse(&[counts, vec![7; 3 * 12 + 3 * 8 + 12]].concat()));
        assert!(cause.contains("MuJoCo"), "{cause}");
    }

    #[test]
    fn errors_have_a_place() {
        for (from, to, line, words) in [
            ("2.2 0", "4.0 0", 2, "version 4 is not supported, only 2 and 4.1 are"),
            ("2.2 0 8", "2.2 0 7", 2, "numbers have 7 bytes"),
            ("30 1 1 0", "30 1 x 0", 12, "'x' is not a number"),
            ("30 1 1 0", "30 1 inf 0", 12, "node 30 is not finite"),
            ("$Nodes\n4", "$Nodes\n99999999", 9, "99999999 entries are declared"),
            ("$Nodes\n4", "$Nodes\n5", 14, "'$EndNodes' is not a number"),
            ("0 1 10 20 30\n", "0 1 10 20 31\n", 19, "uses node 31"),
            ("3 2 2", "3 99 2", 19, "type 99 is not known"),
            ("$EndPhysicalNames", "$End", 4, "the closing $EndPhysicalNames is missing"),
        ] {
            fails_at(parse(OLD.replace(from, to).as_bytes()), line, words);
        }
        let nodes = "10 ".repeat(64);
        let volume = OLD.replace("$Elements\n4\n", &format!("$Elements\n1\n1 92 2 0 1 {nodes}\n"));
        assert!(fault(parse(volume.as_bytes())).1.contains("type 92 is not known"));
    }
}
