//! A model, read from its XML: objects, and the list of objects to build.

use crate::base::error::{Error, Place, Result};
use crate::io::bytes::{EXPORT_AGAIN, finite, malformed};
use crate::io::text::quote;
use crate::io::xml::{attribute, mistake};
use glam::{DMat4, DVec3, DVec4};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::{BTreeMap, HashMap};

/// The objects of a model, by their numbers, and the objects to build.
#[derive(Default)]
pub(super) struct Model {
    pub objects: BTreeMap<u32, Object>,
    pub items: Vec<Reference>,
}

/// A mesh, or a composition of other objects.
#[derive(Default)]
pub(super) struct Object {
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    pub components: Vec<Reference>,
    /// Red, green, blue and opacity of each vertex; empty if no triangle has colours.
    pub colors: Vec<[u8; 4]>,
}

/// An object with its transform.
pub(super) struct Reference {
    pub object: u32,
    /// File in the archive that has the object, if it is another one.
    pub path: Option<String>,
    pub transform: DMat4,
}

impl Model {
    /// Reads a model. Indices of triangles are in range.
    pub fn read(text: &str) -> Result<Model> {
        let mut reader = Reader::from_str(text);
        let mut parser = Parser::default();
        loop {
            let event = reader.read_event().map_err(|e| mistake(&reader, &e))?;
            let place = || Place::Byte(reader.buffer_position() as usize);
            match event {
                Event::Start(tag) => parser.start(&tag, &place)?,
                Event::Empty(tag) => {
                    parser.start(&tag, &place)?;
                    parser.end(tag.local_name().as_ref(), &place)?;
                }
                Event::End(tag) => parser.end(tag.local_name().as_ref(), &place)?,
                Event::Eof if parser.depth > 0 => return Err(malformed(place(), "the text ends early", EXPORT_AGAIN)),
                Event::Eof => return Ok(parser.model),
                _ => {}
            }
        }
    }

    /// Returns all references to objects in this model.
    pub fn references(&self) -> impl Iterator<Item = &Reference> {
        self.objects.values().flat_map(|object| &object.components).chain(&self.items)
    }
}

/// Returns the target of the relation whose type ends with `kind`.
pub(super) fn target(relations: &str, kind: &str) -> Result<Option<String>> {
    let mut reader = Reader::from_str(relations);
    loop {
        match reader.read_event().map_err(|e| mistake(&reader, &e))? {
            Event::Start(tag) | Event::Empty(tag) if attribute(&tag, "Type").is_some_and(|t| t.ends_with(kind)) => {
                return Ok(attribute(&tag, "Target").map(|path| path.trim_start_matches('/').to_string()));
            }
            Event::Eof => return Ok(None),
            _ => {}
        }
    }
}

type At<'a> = &'a dyn Fn() -> Place;

#[derive(Default)]
struct Parser {
    model: Model,
    depth: usize,
    /// The object that is open, and its number.
    object: Option<(u32, Object)>,
    /// Default colour of the object's triangles: group and index.
    default: Option<(u32, usize)>,
    groups: HashMap<u32, Vec<[u8; 4]>>,
    group: Option<(u32, Vec<[u8; 4]>)>,
}

impl Parser {
    fn start(&mut self, tag: &BytesStart, at: At) -> Result<()> {
        self.depth += 1;
        match (tag.local_name().as_ref(), &mut self.object) {
            ("object", _) => {
                self.object = Some((required(tag, "id", at)?, Object::default()));
                self.default = number(tag, "pid", at)?.zip(number(tag, "pindex", at)?);
            }
            ("vertex", Some((_, object))) => {
                let coordinate = |name| required(tag, name, at);
                let position = DVec3::new(coordinate("x")?, coordinate("y")?, coordinate("z")?);
                object.positions.push(finite(position, at)?);
            }
            ("triangle", Some(_)) => self.triangle(tag, at)?,
            ("component", Some((_, object))) => object.components.push(reference(tag, at)?),
            ("item", _) => self.model.items.push(reference(tag, at)?),
            ("colorgroup", _) => self.group = Some((required(tag, "id", at)?, Vec::new())),
            ("color", _) => {
                if let Some((_, colors)) = &mut self.group {
                    let text = attribute(tag, "color").unwrap_or_default();
                    let wrong = || malformed(at(), format!("{} is not a colour", quote(text.as_bytes())), EXPORT_AGAIN);
                    colors.push(color(&text).ok_or_else(wrong)?);
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn end(&mut self, name: &str, at: At) -> Result<()> {
        self.depth = self.depth.saturating_sub(1);
        if let ("object", Some((id, object))) = (name, &mut self.object) {
            let count = object.positions.len();
            if let Some(t) = object.triangles.iter().position(|t| t.iter().any(|&v| v as usize >= count)) {
                let cause = format!("triangle {t} of object {id} uses a vertex that does not exist: there are {count}");
                return Err(malformed(at(), cause, EXPORT_AGAIN));
            }
            object.colors.truncate(count);
            if !object.colors.is_empty() {
                object.colors.resize(count, [255; 4]);
            }
            let object = std::mem::take(object);
            self.model.objects.insert(*id, object);
            self.object = None;
        }
        if name == "colorgroup" {
            self.groups.extend(self.group.take());
        }
        Ok(())
    }

    fn triangle(&mut self, tag: &BytesStart, at: At) -> Result<()> {
        let Some((_, object)) = &mut self.object else { return Ok(()) };
        let corners = [required(tag, "v1", at)?, required(tag, "v2", at)?, required(tag, "v3", at)?];
        object.triangles.push(corners);
        let first: Option<usize> = number(tag, "p1", at)?;
        let group: Option<u32> = number(tag, "pid", at)?.or(self.default.map(|(group, _)| group));
        let Some(colors) = group.and_then(|group| self.groups.get(&group)) else { return Ok(()) };
        let Some(first) = first.or(self.default.map(|(_, first)| first)) else { return Ok(()) };
        let numbers = [first, number(tag, "p2", at)?.unwrap_or(first), number(tag, "p3", at)?.unwrap_or(first)];
        for (vertex, number) in corners.into_iter().zip(numbers) {
            // Vertices come before triangles.
            let known = colors.get(number).filter(|_| (vertex as usize) < object.positions.len());
            if let Some(&color) = known {
                object.colors.resize(object.positions.len(), [255; 4]);
                object.colors[vertex as usize] = color;
            }
        }
        Ok(())
    }
}

fn reference(tag: &BytesStart, at: At) -> Result<Reference> {
    let path = attribute(tag, "path").map(|path| path.trim_start_matches('/').to_string());
    let transform = match attribute(tag, "transform") {
        Some(text) => transform(&text).ok_or_else(|| {
            malformed(at(), format!("{} is not a transform of twelve numbers", quote(text.as_bytes())), EXPORT_AGAIN)
        })?,
        None => DMat4::IDENTITY,
    };
    Ok(Reference { object: required(tag, "objectid", at)?, path, transform })
}

/// Parses a transform: four rows of three numbers, to be multiplied from the left by a row vector.
fn transform(text: &str) -> Option<DMat4> {
    let numbers: Vec<f64> = text.split_whitespace().map(|n| n.parse().ok()).collect::<Option<_>>()?;
    let row = |k: usize, last: f64| DVec3::from_slice(&numbers[3 * k..]).extend(last);
    let columns = |w: DVec4| DMat4::from_cols(row(0, 0.0), row(1, 0.0), row(2, 0.0), w);
    (numbers.len() == 12).then(|| columns(row(3, 1.0))).filter(|m| m.is_finite())
}

/// Parses `#RRGGBB` or `#RRGGBBAA`.
fn color(text: &str) -> Option<[u8; 4]> {
    let digits = text.trim().strip_prefix('#').filter(|d| d.is_ascii() && matches!(d.len(), 6 | 8))?;
    let mut color = [255; 4];
    for (k, byte) in color.iter_mut().enumerate().take(digits.len() / 2) {
        *byte = u8::from_str_radix(&digits[2 * k..2 * k + 2], 16).ok()?;
    }
    Some(color)
}

/// Parses an attribute as a number, if it exists.
fn number<T: std::str::FromStr>(tag: &BytesStart, name: &str, at: At) -> Result<Option<T>> {
    let Some(text) = attribute(tag, name) else { return Ok(None) };
    let wrong = |_| malformed(at(), format!("{name} is {}, not a number", quote(text.as_bytes())), EXPORT_AGAIN);
    text.trim().parse().map(Some).map_err(wrong)
}

fn required<T: std::str::FromStr>(tag: &BytesStart, name: &str, at: At) -> Result<T> {
    let missing = || -> Error {
        let element = tag.local_name().as_ref().escape_debug().to_string();
        malformed(at(), format!("'{element}' has no {name}"), EXPORT_AGAIN)
    };
    number(tag, name, at)?.ok_or_else(missing)
}
