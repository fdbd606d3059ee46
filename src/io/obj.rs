//! Wavefront OBJ: the polygons of all objects and groups over all vertices, in the order of the file.
//!
//! Only `v` and `f` are read, and of a corner only its vertex: texture and normal seams split nothing. Weights and
//! colours behind the coordinates, materials, smoothing groups and names are skipped; points, lines, and free-form
//! curves and surfaces are left out with a note. A face may use vertices that come later in the file.
//!
//! Cost: one pass; memory for the polygons beside that of the mesh.

use super::Parsed;
use super::bytes::{CORRECT_LINE, malformed};
use super::faces::Faces;
use super::text::{Words, left_out, quote, small_faces, whole, write_line};
use crate::base::error::{Place, Result};
use crate::surface::mesh::Mesh;
use glam::DVec3;
use std::io::{self, Write};

/// Statements that say nothing about the shape of polygons.
const SKIPPED: &[&str] = &[
    "vt",
    "vn",
    "g",
    "o",
    "s",
    "mg",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "call",
    "csh",
];

/// Statements of free-form curves and surfaces.
const FREE_FORM: &[&str] = &[
    "vp", "deg", "bmat", "step", "cstype", "curv", "curv2", "surf", "parm", "trim", "hole", "scrv", "sp", "end", "con",
    "ctech", "stech", "bsp", "bzp", "cdc", "cdp", "res",
];

pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    let mut reader = Reader::new(bytes);
    loop {
        reader.statement()?;
        if !reader.words.next_line() {
            break;
        }
    }
    reader.check_indices()?;
    let triangles = reader.faces.triangles(&reader.positions);
    let notes = reader.notes();
    Ok((Mesh { positions: reader.positions, triangles }, notes))
}

pub(crate) fn write(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    for p in &mesh.positions {
        write_line(out, "v", p.to_array())?;
    }
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| u64::from(v) + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}

struct Reader<'a> {
    words: Words<'a>,
    positions: Vec<DVec3>,
    faces: Faces,
    /// The largest vertex number that a face uses, and the line that it is first used on.
    largest: (usize, usize),
    points_and_lines: usize,
    free_form: usize,
    unknown: usize,
    first_unknown: Option<(usize, &'a [u8])>,
}

impl<'a> Reader<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Reader {
            words: Words::new(bytes).with_comments().with_continued_lines(),
            positions: Vec::new(),
            faces: Faces::default(),
            largest: (0, 0),
            points_and_lines: 0,
            free_form: 0,
            unknown: 0,
            first_unknown: None,
        }
    }

    fn statement(&mut self) -> Result<()> {
        let Some(keyword) = self.words.here() else { return Ok(()) };
        match keyword {
            b"v" => self.vertex()?,
            b"f" | b"fo" => self.face()?,
            b"p" | b"l" => self.points_and_lines += 1,
            _ => self.other(keyword),
        }
        Ok(())
    }

    fn vertex(&mut self) -> Result<()> {
        let mut next = || self.words.coordinate(Words::here);
        self.positions.push(DVec3::new(next()?, next()?, next()?));
        Ok(())
    }

    fn face(&mut self) -> Result<()> {
        while let Some(corner) = self.words.here() {
            let vertex = self.corner(corner)?;
            self.faces.push_corner(vertex);
        }
        self.faces.end();
        Ok(())
    }

    /// The vertex of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`, counted from 0.
    fn corner(&mut self, corner: &[u8]) -> Result<u32> {
        let length = corner.iter().position(|&b| b == b'/').unwrap_or(corner.len());
        let (back, digits) = match &corner[..length] {
            [b'-', digits @ ..] => (true, digits),
            [b'+', digits @ ..] => (false, digits),
            digits => (false, digits),
        };
        let Some(number) = whole(digits) else {
            return Err(self.words.mistake(format!("{} is not a vertex number", quote(corner))));
        };
        let known = self.positions.len();
        if number == 0 {
            return Err(self.words.mistake("a face uses vertex 0, but OBJ counts from 1"));
        }
        if back && number > known {
            let cause = format!("a face uses vertex {} from the last, but only {known} precede it", quote(corner));
            return Err(self.words.mistake(cause));
        }
        let number = if back { known + 1 - number } else { number };
        if number > self.largest.0 {
            self.largest = (number, self.words.line());
        }
        // Numbers too large for u32 fail `check_indices` in any case: a file has fewer vertices.
        Ok(u32::try_from(number - 1).unwrap_or(u32::MAX))
    }

    fn other(&mut self, keyword: &'a [u8]) {
        let is_one_of = |known: &[&str]| known.iter().any(|k| k.as_bytes() == keyword);
        if is_one_of(SKIPPED) {
            return;
        }
        if is_one_of(FREE_FORM) {
            self.free_form += 1;
            return;
        }
        self.unknown += 1;
        self.first_unknown.get_or_insert((self.words.line(), keyword));
    }

    fn check_indices(&self) -> Result<()> {
        let ((largest, line), count) = (self.largest, self.positions.len());
        if largest > count {
            let cause = format!("a face uses vertex {largest}, but the file has {count}");
            return Err(malformed(Place::Line(line), cause, CORRECT_LINE));
        }
        Ok(())
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        small_faces(&mut notes, self.faces.dropped);
        left_out(&mut notes, self.points_and_lines, "point or line element", "point or line elements");
        if self.free_form > 0 {
            notes.push("free-form curves and surfaces are left out".into());
        }
        if let Some((line, keyword)) = self.first_unknown {
            let (count, keyword) = (self.unknown, quote(keyword));
            notes.push(format!(
                "statements that OBJ does not have are left out: {count}, the first is {keyword} on line {line}"
            ));
        }
        notes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::error::{Error, Place};
    use proptest::prelude::*;

    fn mesh(text: &str) -> Mesh {
        parse(text.as_bytes()).unwrap().0
    }

    fn triangles(text: &str) -> Vec<[u32; 3]> {
        mesh(text).triangles
    }

    #[track_caller]
    fn fails_at(text: &str, line: usize, words: &str) {
        match parse(text.as_bytes()) {
            Err(Error::Format { place, cause, .. }) => {
                assert_eq!(place, Place::Line(line), "{cause}");
                assert!(cause.contains(words), "{cause}");
            }
            other => panic!("{other:?}"),
        }
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn corners_in_all_forms() {
        for face in ["1 2 3", "1/1 2/2 3/3", "1//1 2//1 3//1", "1/1/1 2/2/1 3/3/1", "-4 -3 -2", "-4/1 -3// +3/-1/-1"] {
            assert_eq!(triangles(&format!("{SQUARE}f {face}\n")), [[0, 1, 2]], "{face}");
        }
    }

    #[test]
    fn vertices_in_all_forms() {
        let m = mesh("v 1e-5 2 -3.5 # in words\nv 1 2 3 0.5\nv\t4 5 6 1 0 0\r\nv 7 8 9 nan nan nan nan");
        let expected = [[1e-5, 2.0, -3.5], [1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]];
        assert_eq!(m.positions, expected.map(DVec3::from));
        assert!(m.triangles.is_empty());
    }

    #[test]
    fn groups_and_objects_are_one_mesh() {
        let text = format!(
            "# C:\\models\\\nmtllib gone.mtl\n{SQUARE}o one\ng a b\ns off\nusemtl red\nf 1 2 3\no two\nv 0 0 1\nf -1 1 2\n"
        );
        assert_eq!(triangles(&text), [[0, 1, 2], [4, 0, 1]]);
        assert!(parse(text.as_bytes()).unwrap().1.is_empty());
    }

    #[test]
    fn polygons_and_lines_that_go_on() {
        assert_eq!(triangles(&format!("{SQUARE}f 1 2 \\\n 3\\\r\n4\nf 1 2 3")), [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
        let dart = "v 0 0 0\nv 2 1 0\nv 0 2 0\nv 0.5 1 0\nf 1 2 3 4\n";
        assert_eq!(triangles(dart), [[0, 1, 3], [1, 2, 3]]);
    }

    #[test]
    fn faces_may_come_first() {
        assert_eq!(triangles(&format!("f 1 2 3 4\n{SQUARE}")).len(), 2);
    }

    #[test]
    fn what_is_left_out_is_said() {
        let text = format!("{SQUARE}p 1\nl 1 2\nf 1 2\nf\nvp 1 2\ncstype bezier\nsurf 0 1\nend\nfoo\nbar\n");
        assert_eq!(
            parse(text.as_bytes()).unwrap().1,
            [
                "2 faces with fewer than three corners are left out",
                "2 point or line elements are left out",
                "free-form curves and surfaces are left out",
                "statements that OBJ does not have are left out: 2, the first is 'foo' on line 13",
            ]
        );
    }

    #[test]
    fn names_need_not_be_utf8() {
        let mut text = b"# caf\xE9\r\ng \xFF\xFE\r\n".to_vec();
        text.extend(SQUARE.bytes());
        text.extend(b"f 1 2 3\r\n");
        assert_eq!(parse(&text).unwrap().0.triangles, [[0, 1, 2]]);
    }

    #[test]
    fn errors_name_the_line() {
        fails_at("v 0 0 0\n\nv 1 nan 0\n", 3, "'nan' is not finite");
        fails_at("v 0 0 -inf", 1, "not finite");
        fails_at("v 0 0 1e999", 1, "not finite");
        fails_at("v 0 0\nv 0 0 0", 1, "missing");
        fails_at("v 0 0 x7\n", 1, "'x7' is not a number");
        fails_at(&format!("{SQUARE}f 1 2 5\n"), 5, "vertex 5, but the file has 4");
        fails_at(&format!("{SQUARE}f 1 2 99999999999\nf 1 2 3"), 5, "vertex 99999999999");
        fails_at(&format!("{SQUARE}f 1 2 0\n"), 5, "counts from 1");
        fails_at(&format!("{SQUARE}f 1 2 -5\n"), 5, "only 4 precede");
        fails_at(&format!("{SQUARE}f 1 2 a\n"), 5, "not a vertex number");
        fails_at(&format!("{SQUARE}f 1 2 /3\n"), 5, "not a vertex number");
        fails_at(&format!("{SQUARE}f 1 2 --3\n"), 5, "not a vertex number");
        fails_at("# one \\\nv 0 0 \\\n  0\nf 1 1 2", 4, "vertex 2");
    }

    #[test]
    fn the_written_is_short() {
        let m =
            Mesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::new(-0.5, 1e-7, 0.1)], triangles: vec![[0, 1, 2]] };
        let mut text = Vec::new();
        write(&m, &mut text).unwrap();
        assert_eq!(String::from_utf8(text).unwrap(), "v 0 0 0\nv 1 0 0\nv -0.5 1e-7 0.1\nf 1 2 3\n");
    }

    /// The corner places of all faces, as tobj reads them.
    fn by_tobj(text: &str) -> Vec<Vec<[f32; 3]>> {
        let options = tobj::LoadOptions::default();
        let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
        let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, no_materials).unwrap();
        let mut faces = Vec::new();
        for m in models.iter().map(|m| &m.mesh) {
            let place = |&v: &u32| [0, 1, 2].map(|k| m.positions[3 * v as usize + k]);
            let sizes = if m.face_arities.is_empty() { vec![3; m.indices.len() / 3] } else { m.face_arities.clone() };
            let mut rest = &m.indices[..];
            for size in sizes {
                let (face, others) = rest.split_at(size as usize);
                faces.push(face.iter().map(place).collect());
                rest = others;
            }
        }
        faces
    }

    proptest! {
        #[test]
        fn tobj_reads_the_same(
            points in prop::collection::vec(prop::array::uniform3(-1e3f32..1e3), 3..20),
            faces in prop::collection::vec((prop::collection::vec(0usize..1000, 3..4), 0u8..5), 1..30),
        ) {
            let mut text: String = points.iter().map(|[x, y, z]| format!("v {x} {y} {z}\nvt 0 0\nvn 0 0 1\n")).collect();
            for (i, (corners, form)) in faces.iter().enumerate() {
                if i % 7 == 3 {
                    text.push_str(&format!("o part{i}\n"));
                }
                text.push('f');
                for c in corners {
                    let v = c % points.len() + 1;
                    text.push_str(&match form {
                        0 => format!(" {v}"),
                        1 => format!(" {v}/1"),
                        2 => format!(" {v}//1"),
                        3 => format!(" {v}/1/1"),
                        _ => format!(" -{}", points.len() + 1 - v),
                    });
                }
                text.push('\n');
            }
            let ours = mesh(&text);
            let places: Vec<Vec<[f32; 3]>> = ours.triangles.iter()
                .map(|t| t.iter().map(|&v| ours.positions[v as usize].as_vec3().to_array()).collect())
                .collect();
            prop_assert_eq!(places, by_tobj(&text));
        }
    }
}
