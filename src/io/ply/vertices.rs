//! The table of vertices: positions, and all properties that are numbers.

use super::elements::{checked_count, skip};
use super::header::{Element, Kind, Property};
use super::source::Source;
use crate::base::error::{Error, Place, Result};
use crate::io::bytes::{EXPORT_AGAIN, malformed};
use crate::mesh::attributes::{Attribute, COLOR, NORMAL, Scalar};
use glam::{DVec2, DVec3};

/// Properties that are components of one attribute, if the first three exist.
pub(super) const GROUPS: [(&str, [&str; 4]); 3] = [
    (NORMAL, ["nx", "ny", "nz", ""]),
    (COLOR, ["red", "green", "blue", "alpha"]),
    (COLOR, ["diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"]),
];

/// Properties that are texture coordinates if there are faces.
const TEXTURE: [[&str; 2]; 4] = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];

/// Whether a property is a texture coordinate if there are faces.
#[cfg(feature = "fs")]
pub(super) fn is_texture(property: &Property) -> bool {
    TEXTURE.as_flattened().contains(&property.name.as_str())
}

/// The vertices of a file.
#[derive(Default)]
pub(super) struct Vertices {
    pub positions: Vec<DVec3>,
    pub attributes: Vec<Attribute>,
    /// Texture coordinates of each vertex, or empty.
    pub texture: Vec<DVec2>,
}

/// Role of a property.
#[derive(Clone, Copy)]
enum Role {
    LeftOut,
    Position(usize),
    /// Index of an attribute, and component of it.
    Attribute(usize, usize),
    Texture(usize),
}

impl Vertices {
    /// Reads the table. A note lists the properties that are left out.
    pub fn read<S: Source>(
        source: &mut S,
        element: &Element,
        with_faces: bool,
        notes: &mut Vec<String>,
    ) -> Result<Vertices> {
        let (roles, attributes) = roles(element, with_faces)?;
        let lists = element.properties.iter().zip(&roles).filter(|(_, role)| matches!(role, Role::LeftOut));
        notes.extend(lists.map(|(list, _)| format!("the list property '{}' of vertices is left out", list.name)));
        let plan: Vec<(Kind, Role)> = element.properties.iter().zip(roles).map(|(p, role)| (p.kind, role)).collect();
        let count = checked_count(source, element)?;
        let with_texture = plan.iter().any(|(_, role)| matches!(role, Role::Texture(_)));
        let mut vertices = Vertices {
            positions: Vec::with_capacity(count),
            attributes,
            texture: Vec::with_capacity(if with_texture { count } else { 0 }),
        };
        vertices.attributes.iter_mut().for_each(|a| a.values = vec![0.0; a.components * count]);
        for _ in 0..count {
            vertices.read_row(source, &plan)?;
        }
        Ok(vertices)
    }

    #[inline]
    fn read_row<S: Source>(&mut self, source: &mut S, plan: &[(Kind, Role)]) -> Result<()> {
        let v = self.positions.len();
        let (mut position, mut texture) = ([0.0; 3], None);
        for &(kind, role) in plan {
            let Kind::Scalar(scalar) = kind else {
                skip(source, kind)?;
                continue;
            };
            match role {
                Role::LeftOut => source.skip(scalar, 1)?,
                Role::Position(k) => position[k] = coordinate(source, scalar)?,
                Role::Attribute(i, k) => {
                    let attribute = &mut self.attributes[i];
                    attribute.values[v * attribute.components + k] = source.value(scalar)?;
                }
                Role::Texture(k) => texture.get_or_insert([0.0; 2])[k] = source.value(scalar)?,
            }
        }
        self.positions.push(position.into());
        self.texture.extend(texture.map(DVec2::from));
        Ok(())
    }
}

/// Returns the role of each property, and the attributes that they form, without values.
fn roles(element: &Element, with_faces: bool) -> Result<(Vec<Role>, Vec<Attribute>)> {
    let mut roles = vec![Role::LeftOut; element.properties.len()];
    let mut taken = vec![false; roles.len()];
    let find = |name: &str| element.properties.iter().position(|p| p.name == name && scalar(p).is_some());
    let mut take = |i: usize, role: Role| (roles[i], taken[i]) = (role, true);
    for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
        let i =
            find(name).ok_or_else(|| element.error(format!("the vertices have no property '{name}'"), EXPORT_AGAIN))?;
        take(i, Role::Position(k));
    }
    if let Some([s, t]) = TEXTURE.iter().find_map(|[s, t]| Some([find(s)?, find(t)?])).filter(|_| with_faces) {
        take(s, Role::Texture(0));
        take(t, Role::Texture(1));
    }
    let mut attributes: Vec<Attribute> = Vec::new();
    for (name, [a, b, c, d]) in GROUPS {
        let (Some(a), Some(b), Some(c)) = (find(a), find(b), find(c)) else { continue };
        if attributes.iter().any(|known| known.name == name) {
            continue;
        }
        let members: Vec<usize> = [a, b, c].into_iter().chain(find(d)).collect();
        members.iter().enumerate().for_each(|(k, &i)| take(i, Role::Attribute(attributes.len(), k)));
        attributes.extend(attribute(name, members.len(), &element.properties[a]));
    }
    for (i, property) in element.properties.iter().enumerate().filter(|&(i, _)| !taken[i]) {
        if let Some(single) = attribute(&property.name, 1, property) {
            roles[i] = Role::Attribute(attributes.len(), 0);
            attributes.push(single);
        }
    }
    Ok((roles, attributes))
}

/// Creates an attribute with the type of a property; `None` for a list.
fn attribute(name: &str, components: usize, property: &Property) -> Option<Attribute> {
    scalar(property).map(|scalar| Attribute { name: name.into(), components, values: Vec::new(), scalar })
}

pub(super) fn scalar(property: &Property) -> Option<Scalar> {
    match property.kind {
        Kind::Scalar(scalar) => Some(scalar),
        Kind::List { .. } => None,
    }
}

#[inline]
fn coordinate<S: Source>(source: &mut S, kind: Scalar) -> Result<f64> {
    let value = source.value(kind)?;
    if value.is_finite() {
        return Ok(value);
    }
    Err(not_finite(value, source.place()))
}

#[cold]
pub(super) fn not_finite(value: f64, place: Place) -> Error {
    malformed(place, format!("the coordinate {value} is not finite"), "replace or remove this vertex")
}
