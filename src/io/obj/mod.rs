//! Wavefront OBJ: the polygons of all objects and groups over all vertices, in the order of the file.
//!
//! UV seams and normal seams split no vertices: texture coordinates are kept per corner, and the normals of the corners at a
//! vertex are added up. Three or four numbers after the coordinates of every vertex are its colour. Materials, objects and
//! groups are kept by name. Weights and smoothing groups are skipped; points and lines beside polygons, and free-form curves
//! and surfaces, are left out with a note. A face may use vertices that come later in the file.
//!
//! Cost: one pass; memory for the polygons in addition to that of the mesh.

pub(super) mod mtl;
mod write;

pub(crate) use write::write;

use crate::base::error::{Place, Result};
use crate::io::bytes::{CORRECT_LINE, NO_LINES, malformed};
use crate::io::columns::{Columns, color, normal};
use crate::io::content::{Parsed, Read};
use crate::io::faces::Faces;
use crate::io::text::{Words, left_out, number, quote, small_faces, whole};
use crate::mesh::attributes::{Attribute, Attributes};
use crate::mesh::materials::{Material, Materials};
use crate::mesh::parts::{Part, Parts, part_name};
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// Statements that do not affect the shape of polygons.
const SKIPPED: &[&str] =
    &["s", "mg", "usemap", "maplib", "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj", "call", "csh"];

/// Maximum number of values of a colour; the fourth is the opacity.
const COLOR_COLUMNS: usize = 4;

/// Statements of free-form curves and surfaces.
const FREE_FORM: &[&str] = &[
    "vp", "deg", "bmat", "step", "cstype", "curv", "curv2", "surf", "parm", "trim", "hole", "scrv", "sp", "end", "con",
    "ctech", "stech", "bsp", "bzp", "cdc", "cdp", "res",
];

/// Remedy for a file of [`FREE_FORM`] geometry.
const NO_FREE_FORM: &str = "mesh the surfaces in the program that made them, and export that mesh";

pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    let mut reader = Reader::new(bytes);
    loop {
        reader.statement()?;
        if !reader.words.next_line() {
            break;
        }
    }
    reader.check_indices()?;
    reader.refuse_curves()?;
    Ok(reader.finish())
}

struct Reader<'a> {
    words: Words<'a>,
    positions: Vec<DVec3>,
    /// Numbers after the coordinates of vertices.
    columns: Columns,
    texture: Vec<DVec2>,
    normals: Vec<DVec3>,
    faces: Faces,
    /// Texture coordinate index and normal index of each corner. Each list ends with the last corner that has one.
    corner_texture: Vec<u32>,
    corner_normal: Vec<u32>,
    materials: Materials,
    material_numbers: HashMap<String, u32>,
    /// Current material, for the faces that follow.
    material: u32,
    /// Material of each face, up to the last face before the latest `usemtl`.
    face_material: Vec<u32>,
    parts: Parts,
    /// Index of each part so far.
    part_numbers: HashMap<Part, u32>,
    /// Current part, for the faces that follow, and its index.
    part: (Part, u32),
    /// Part of each face, up to the last face before the latest `o` or `g`.
    face_part: Vec<u32>,
    /// Largest vertex number that a face uses, and the line on which it is first used.
    largest: (usize, usize),
    points: usize,
    lines: usize,
    free_form: usize,
    unknown: usize,
    first_unknown: Option<(usize, &'a [u8])>,
}

impl<'a> Reader<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Reader {
            words: Words::new(bytes).with_comments().with_continued_lines(),
            positions: Vec::new(),
            columns: Columns::default(),
            texture: Vec::new(),
            normals: Vec::new(),
            faces: Faces::default(),
            corner_texture: Vec::new(),
            corner_normal: Vec::new(),
            materials: Materials::default(),
            material_numbers: HashMap::new(),
            material: NONE,
            face_material: Vec::new(),
            parts: Parts::default(),
            part_numbers: HashMap::new(),
            part: (Part::default(), NONE),
            face_part: Vec::new(),
            largest: (0, 0),
            points: 0,
            lines: 0,
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
            b"p" => self.points += 1,
            b"l" => self.lines += 1,
            b"vt" => {
                let [u, v, _] = self.vector();
                self.texture.push(DVec2::new(u, v));
            }
            b"vn" => {
                let normal = self.vector();
                self.normals.push(normal.into());
            }
            b"usemtl" => self.use_material(),
            b"o" => {
                let part = Part { object: part_name(&self.rest_of_line()), group: String::new() };
                self.begin_part(part);
            }
            b"g" => {
                let part =
                    Part { group: part_name(&self.rest_of_line()), object: std::mem::take(&mut self.part.0.object) };
                self.begin_part(part);
            }
            b"mtllib" => {
                let library = self.rest_of_line();
                self.materials.libraries.push(library);
            }
            _ => self.other(keyword),
        }
        Ok(())
    }

    fn vertex(&mut self) -> Result<()> {
        let mut next = || self.words.coordinate(Words::here);
        self.positions.push(DVec3::new(next()?, next()?, next()?));
        self.columns.read_line(&mut self.words, COLOR_COLUMNS);
        Ok(())
    }

    /// Reads three numbers; NaN for each that is missing.
    fn vector(&mut self) -> [f64; 3] {
        [0; 3].map(|_| self.words.here().and_then(number).unwrap_or(f64::NAN))
    }

    fn rest_of_line(&mut self) -> String {
        let mut rest = Vec::new();
        while let Some(word) = self.words.here() {
            rest.push(String::from_utf8_lossy(word));
        }
        rest.join(" ")
    }

    fn use_material(&mut self) {
        let name = self.rest_of_line();
        self.face_material.resize(self.faces.count(), self.material);
        let list = &mut self.materials.list;
        self.material = match name.as_str() {
            "" => NONE,
            name => *self.material_numbers.entry(name.into()).or_insert_with(|| {
                list.push(Material::named(name));
                list.len() as u32 - 1
            }),
        };
    }

    fn begin_part(&mut self, part: Part) {
        self.face_part.resize(self.faces.count(), self.part.1);
        let list = &mut self.parts.list;
        let number = match part == Part::default() {
            true => NONE,
            false => *self.part_numbers.entry(part.clone()).or_insert_with(|| {
                list.push(part.clone());
                list.len() as u32 - 1
            }),
        };
        self.part = (part, number);
    }

    fn face(&mut self) -> Result<()> {
        while let Some(corner) = self.words.here() {
            let vertex = self.corner(corner)?;
            self.faces.push_corner(vertex);
        }
        self.faces.end();
        let corners = self.faces.corners();
        self.corner_texture.truncate(corners);
        self.corner_normal.truncate(corners);
        Ok(())
    }

    /// Returns the vertex of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`, counted from 0.
    fn corner(&mut self, corner: &[u8]) -> Result<u32> {
        let (number, length) =
            vertex_number(corner, self.positions.len()).map_err(|cause| self.words.mistake(cause))?;
        if number > self.largest.0 {
            self.largest = (number, self.words.line());
        }
        if length < corner.len() {
            self.further_of_corner(&corner[length + 1..]);
        }
        // Numbers too large for u32 always fail `check_indices`, because a file has fewer vertices.
        Ok(u32::try_from(number - 1).unwrap_or(u32::MAX))
    }

    /// Stores the indices that follow the vertex of the next corner: `vt`, `/vn` or `vt/vn`.
    fn further_of_corner(&mut self, words: &[u8]) {
        let at = self.faces.corners();
        let mut words = words.split(|&b| b == b'/');
        let mut keep = |list: &mut Vec<u32>, known: usize| {
            if let Some(number) = words.next().and_then(|word| relative(word, known)) {
                list.resize(at, NONE);
                list.push(number);
            }
        };
        keep(&mut self.corner_texture, self.texture.len());
        keep(&mut self.corner_normal, self.normals.len());
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
            let cause = format!("a face uses vertex {largest}, but the file has only {count}");
            return Err(malformed(Place::Line(line), cause, CORRECT_LINE));
        }
        Ok(())
    }

    /// Refuses a file that has only lines or free-form geometry: their vertices are not points of a surface.
    fn refuse_curves(&self) -> Result<()> {
        if self.points > 0 || self.faces.count() > 0 {
            return Ok(());
        }
        if self.free_form > 0 {
            return Err(malformed(Place::Whole, "it has free-form curves or surfaces, but no faces", NO_FREE_FORM));
        }
        if self.lines > 0 {
            return Err(malformed(Place::Whole, "it has lines but no faces", NO_LINES));
        }
        Ok(())
    }

    /// Builds the result, once the whole file has been read.
    fn finish(mut self) -> Read {
        let mut notes = self.notes();
        self.faces.keep_outside(&self.positions, &mut notes);
        let triangles = self.faces.triangles(&self.positions);
        let attributes = Attributes {
            vertex: self.colors(&mut notes).into_iter().chain(self.vertex_normals(&triangles, &mut notes)).collect(),
            texture: self.texture_of_triangles(&mut notes),
            materials: self.materials_of_triangles(),
            parts: self.parts_of_triangles(),
        };
        Read { mesh: Mesh { positions: self.positions, triangles }, attributes, notes }
    }

    fn colors(&mut self, notes: &mut Vec<String>) -> Option<Attribute> {
        let columns = std::mem::take(&mut self.columns);
        let ragged = columns.ragged;
        let (values, width) = columns.into_table();
        let colors = if width >= 3 { color(values, width) } else { None };
        if colors.is_none() && (ragged || width >= 3) {
            notes.push(
                "the numbers after the vertex coordinates are left out: they are not colours for all vertices".into(),
            );
        }
        colors
    }

    /// Returns the vertex normals. For a cloud these are the normals of the file, if there are as many as points; for a
    /// mesh, the normalized sum of the corner normals at each vertex.
    fn vertex_normals(&self, triangles: &[[u32; 3]], notes: &mut Vec<String>) -> Option<Attribute> {
        let count = self.positions.len();
        let mut sums = vec![DVec3::ZERO; if self.corner_normal.is_empty() { 0 } else { count }];
        let corner = |(&vertex, &number): (&u32, &u32)| {
            let sum = sums.get_mut(vertex as usize)?;
            *sum += self.normals.get(number as usize).filter(|n| n.is_finite())?.normalize_or_zero();
            Some(())
        };
        let used = self.faces.corner_list().iter().zip(&self.corner_normal).filter_map(corner).count();
        let is_cloud =
            triangles.is_empty() && self.normals.len() == count && self.normals.iter().all(|n| n.is_finite());
        if is_cloud && count > 0 {
            return Some(normal(self.normals.iter().flat_map(|n| n.to_array()).collect()));
        }
        if used == 0 {
            left_out(notes, self.normals.len(), "normal that no face uses", "normals that no face uses");
            return None;
        }
        Some(normal(sums.into_iter().flat_map(|n| n.normalize_or_zero().to_array()).collect()))
    }

    fn texture_of_triangles(&mut self, notes: &mut Vec<String>) -> Vec<[DVec2; 3]> {
        let at = |corner: usize| {
            let number = self.corner_texture.get(corner).copied().unwrap_or(NONE);
            self.texture.get(number as usize).copied().unwrap_or(DVec2::NAN)
        };
        let (mut texture, mut found) = (Vec::new(), false);
        if !self.texture.is_empty() && !self.corner_texture.is_empty() {
            self.faces.each(&self.positions, |_, corners| texture.push(corners.map(at)));
            found = texture.iter().flatten().any(|at| at.is_finite());
        }
        if !found {
            let (one, many) = ("pair of texture coordinates", "pairs of texture coordinates");
            left_out(
                notes,
                self.texture.len(),
                &format!("{one} that no face uses"),
                &format!("{many} that no face uses"),
            );
            texture.clear();
        }
        texture
    }

    fn materials_of_triangles(&mut self) -> Option<Materials> {
        let mut materials = std::mem::take(&mut self.materials);
        if materials.list.is_empty() {
            return None;
        }
        self.face_material.resize(self.faces.count(), self.material);
        self.faces.each(&self.positions, |face, _| materials.of_triangle.push(self.face_material[face]));
        Some(materials)
    }

    fn parts_of_triangles(&mut self) -> Option<Parts> {
        let mut parts = std::mem::take(&mut self.parts);
        self.face_part.resize(self.faces.count(), self.part.1);
        self.faces.each(&self.positions, |face, _| parts.of_triangle.push(self.face_part[face]));
        parts.of_triangle.iter().any(|&part| part != NONE).then_some(parts)
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        small_faces(&mut notes, self.faces.dropped);
        // Without faces, all vertices are points.
        let points = if self.faces.count() > 0 { self.points } else { 0 };
        left_out(&mut notes, points + self.lines, "point or line element", "point or line elements");
        if self.free_form > 0 {
            notes.push("free-form curves and surfaces are left out".into());
        }
        if let Some((line, keyword)) = self.first_unknown {
            let (count, keyword) = (self.unknown, quote(keyword));
            notes.push(format!(
                "statements that are not part of OBJ are left out: {count}, the first is {keyword} on line {line}"
            ));
        }
        notes
    }
}

/// Parses a corner `v`, `v/vt`, `v//vn` or `v/vt/vn` after `known` vertices of the file. Returns the vertex number, from 1,
/// and the number of bytes that spell it; the error says what is wrong.
pub(super) fn vertex_number(corner: &[u8], known: usize) -> std::result::Result<(usize, usize), String> {
    let length = corner.iter().position(|&b| b == b'/').unwrap_or(corner.len());
    let (back, digits) = match &corner[..length] {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        digits => (false, digits),
    };
    let number = whole(digits).ok_or_else(|| format!("{} is not a vertex number", quote(corner)))?;
    if number == 0 {
        return Err("a face uses vertex 0, but OBJ counts from 1".into());
    }
    if back && number > known {
        return Err(format!(
            "a face uses vertex {}, counted from the last, but only {known} precede it",
            quote(corner)
        ));
    }
    Ok((if back { known + 1 - number } else { number }, length))
}

/// Returns the index, from 0, for a word that counts from 1 or, if negative, backwards from the last of `known` entries.
fn relative(word: &[u8], known: usize) -> Option<u32> {
    let from_last = word.strip_prefix(b"-").and_then(whole);
    let number = from_last.map_or_else(|| whole(word)?.checked_sub(1), |back| known.checked_sub(back.max(1)));
    number.and_then(|number| u32::try_from(number).ok())
}

#[cfg(test)]
mod tests;
