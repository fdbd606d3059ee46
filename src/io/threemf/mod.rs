//! 3MF, a format for 3D printing: an archive with a model, and perhaps further ones, in XML.
//!
//! A model has objects, which are meshes or composed of other objects, and a list of objects to build. The objects to build
//! are read, each with its transform; the unit of the file is kept. Colours of the corners of triangles become those of
//! vertices.
//!
//! The unpacked size of the archive is bounded by a multiple of its size, and the number of repeated objects is limited.
//!
//! Limits: materials, textures, slices and beams are left out; encrypted models are not read.

mod model;
mod write;

pub(crate) use write::write;

use super::bytes::{EXPORT_AGAIN, malformed, most_unpacked, unpacks_to_too_much};
use crate::base::error::{Error, Place, Result};
use crate::io::content::{Parsed, Read};
use crate::mesh::attributes::{Attribute, Attributes, COLOR, Scalar};
use crate::mesh::triangle_mesh::Mesh;
use glam::DMat4;
use model::{Model, Object, Reference};
use std::collections::BTreeMap;
use std::io::{Cursor, Read as _};
use zip::ZipArchive;

/// Default path of the model, if no relation gives it.
const MODEL: &str = "3D/3dmodel.model";
const RELATIONS: &str = "_rels/.rels";

/// End of the type of the relation that gives the path of the model.
const RELATION: &str = "/3dmodel";

/// Maximum nesting depth of objects composed of objects.
const DEPTH: usize = 32;

/// Maximum total number of vertices, triangles and objects, in all copies together.
const REPEATED: usize = 1 << 26;

/// Length of the tail of an archive in which its list of files is searched.
const TAIL: usize = 1 << 16;

/// Whether a file is an archive with a model in it.
pub(crate) fn has_signature(bytes: &[u8]) -> bool {
    let tail = &bytes[bytes.len().saturating_sub(TAIL)..];
    bytes.starts_with(b"PK\x03\x04") && tail.windows(6).any(|w| w == b".model")
}

/// Reads the meshes in a 3MF file.
///
/// # Errors
/// `Error::Format` with the part that is malformed.
pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    let mut archive = Archive::new(bytes)?;
    let root = archive.model_name()?;
    let models = archive.models(&root)?;
    let mut builder = Builder { models: &models, built: 0, mesh: Mesh::default(), colors: Vec::new(), bare: false };
    let items = &models[&root].items;
    if items.is_empty() {
        // A file that builds nothing may still have objects.
        for (id, _) in models[&root].objects.iter().filter(|(_, object)| !object.triangles.is_empty()) {
            builder.add(
                &root,
                &Reference { object: *id, path: None, transform: DMat4::IDENTITY },
                DMat4::IDENTITY,
                0,
            )?;
        }
    }
    for item in items {
        builder.add(&root, item, DMat4::IDENTITY, 0)?;
    }
    Ok(builder.finish())
}

struct Archive<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
    /// Number of bytes that may still be unpacked.
    budget: usize,
}

impl<'a> Archive<'a> {
    fn new(bytes: &'a [u8]) -> Result<Archive<'a>> {
        let zip = ZipArchive::new(Cursor::new(bytes)).map_err(|error| {
            let cause = format!("it is not a ZIP archive, as a 3MF file must be: {error}").replace(['\n', '\r'], " ");
            malformed(Place::Whole, cause, "check that this is a complete 3MF file")
        })?;
        Ok(Archive { zip, budget: most_unpacked(bytes.len()) })
    }

    /// Returns the text of a file in the archive.
    fn text(&mut self, name: &str) -> Result<String> {
        let wrong = |cause: String| malformed(part(name), cause.replace(['\n', '\r'], " "), EXPORT_AGAIN);
        let file = self.zip.by_name(name).map_err(|e| wrong(format!("it cannot be read: {e}")))?;
        let mut bytes = Vec::new();
        let read = file.take(self.budget as u64 + 1).read_to_end(&mut bytes);
        read.map_err(|e| wrong(format!("it cannot be unpacked: {e}")))?;
        let left = self.budget.checked_sub(bytes.len());
        self.budget = left.ok_or_else(|| unpacks_to_too_much("save it again with a slicer"))?;
        String::from_utf8(bytes).map_err(|_| wrong("it is not UTF-8 text".into()))
    }

    fn model_name(&mut self) -> Result<String> {
        if self.zip.index_for_name(RELATIONS).is_none() {
            return Ok(MODEL.into());
        }
        let relations = self.text(RELATIONS)?;
        Ok(model::target(&relations, RELATION).map_err(|e| in_part(e, RELATIONS))?.unwrap_or_else(|| MODEL.into()))
    }

    /// Reads the model of this name, and all models that its objects refer to.
    fn models(&mut self, root: &str) -> Result<BTreeMap<String, Model>> {
        let mut models = BTreeMap::new();
        let mut open = vec![root.to_string()];
        while let Some(name) = open.pop() {
            if models.contains_key(&name) {
                continue;
            }
            let model = Model::read(&self.text(&name)?).map_err(|e| in_part(e, &name))?;
            open.extend(model.references().filter_map(|r| r.path.clone()));
            models.insert(name, model);
        }
        Ok(models)
    }
}

fn part(name: &str) -> Place {
    Place::Part(name.escape_debug().to_string())
}

/// Adds the name of a file in the archive to an error.
fn in_part(error: Error, name: &str) -> Error {
    match error {
        Error::Format { file, place, cause, remedy } => {
            let place = Place::Part(format!("{}{place}", name.escape_debug()));
            Error::Format { file, place, cause, remedy }
        }
        other => other,
    }
}

/// The mesh built so far.
struct Builder<'a> {
    models: &'a BTreeMap<String, Model>,
    /// Number of vertices, triangles and objects so far.
    built: usize,
    mesh: Mesh,
    /// Colours of the vertices, up to the last object with colours.
    colors: Vec<[u8; 4]>,
    /// Whether some vertices have no colour.
    bare: bool,
}

/// Colour of vertices without one.
const WHITE: [u8; 4] = [255; 4];

impl Builder<'_> {
    /// Adds an object, which may be composed of others.
    fn add(&mut self, model: &str, what: &Reference, outer: DMat4, depth: usize) -> Result<()> {
        let model = what.path.as_deref().unwrap_or(model);
        let wrong = |cause: &str| malformed(part(&format!("{model}, object {}", what.object)), cause, EXPORT_AGAIN);
        let object = self.models.get(model).and_then(|m| m.objects.get(&what.object));
        let object = object.ok_or_else(|| wrong("does not exist"))?;
        let transform = outer * what.transform;
        self.built = self.built.saturating_add(1 + object.positions.len() + object.triangles.len());
        if self.built > REPEATED {
            return Err(malformed(Place::Whole, "it repeats its objects too often", "build fewer copies"));
        }
        if depth == DEPTH {
            return Err(wrong("it contains itself, or too many levels of nested objects"));
        }
        self.add_mesh(object, transform).ok_or_else(|| wrong("a position is not finite after its transform"))?;
        object.components.iter().try_for_each(|component| self.add(model, component, transform, depth + 1))
    }

    fn add_mesh(&mut self, object: &Object, transform: DMat4) -> Option<()> {
        let base = self.mesh.positions.len() as u32;
        self.mesh.positions.extend(object.positions.iter().map(|&p| transform.transform_point3(p)));
        // A mirroring transform reverses the orientation of triangles.
        let is_mirrored = transform.determinant() < 0.0;
        let place = |&[a, b, c]: &[u32; 3]| if is_mirrored { [a, c, b] } else { [a, b, c] }.map(|v| base + v);
        self.mesh.triangles.extend(object.triangles.iter().map(place));
        self.bare |= object.colors.is_empty() && !object.positions.is_empty();
        if !object.colors.is_empty() {
            self.colors.resize(base as usize, WHITE);
            self.colors.extend(&object.colors);
        }
        self.mesh.positions[base as usize..].iter().all(|p| p.is_finite()).then_some(())
    }

    fn finish(mut self) -> Read {
        let mut attributes = Attributes::default();
        if !self.colors.is_empty() {
            self.colors.resize(self.mesh.positions.len(), WHITE);
            let components = if self.colors.iter().all(|c| c[3] == 255) { 3 } else { 4 };
            let values = self.colors.iter().flat_map(|c| &c[..components]).map(|&x| f64::from(x)).collect();
            attributes.vertex.push(Attribute { name: COLOR.into(), components, values, scalar: Scalar::U8 });
        }
        let has_both = self.bare && !self.colors.is_empty();
        let notes = has_both.then(|| "objects without colours are white".to_string());
        Read { mesh: self.mesh, attributes, notes: notes.into_iter().collect() }
    }
}

#[cfg(test)]
mod tests;
