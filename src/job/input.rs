//! The input of a job.

use crate::base::count::counted;
use crate::base::error::{Error, Fault, Result};
use crate::io::Loaded;
use crate::mesh::attributes::{Attribute, Attributes, MATERIALS, PARTS, TEXTURE};
use crate::mesh::points::Points;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::{refuse_bad_numbers, refuse_bad_positions};
use crate::prepare::thin::Thinned;
use glam::DVec3;
use std::borrow::Cow;

/// A mesh or a cloud of points, with attributes.
#[derive(Debug, Clone, Default)]
pub struct Input<'a> {
    mesh: Cow<'a, Mesh>,
    attributes: Cow<'a, Attributes>,
    thinned: Option<Cow<'a, Thinned>>,
}

impl<'a> Input<'a> {
    /// Makes a mesh: x, y and z of each vertex, and for each triangle the numbers of its corners from 0, counter-clockwise
    /// seen from outside. They are copied once; `Input::from` borrows a [`Mesh`] instead.
    pub fn mesh(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Input<'a> {
        let positions: &[DVec3] = bytemuck::cast_slice(positions);
        let mesh = Mesh { positions: positions.to_vec(), triangles: triangles.to_vec() };
        Input { mesh: Cow::Owned(mesh), ..Input::default() }
    }

    /// Makes a cloud of points: x, y and z of each. Known normals are the attribute `normal`.
    pub fn points(positions: &[[f64; 3]]) -> Input<'a> {
        Input::mesh(positions, &[])
    }

    /// Returns the input with attributes of its vertices, corners and triangles.
    #[must_use]
    pub fn with_attributes(self, attributes: &'a Attributes) -> Input<'a> {
        Input { attributes: Cow::Borrowed(attributes), ..self }
    }

    /// Makes the input of a thinned cloud.
    pub(super) fn thinned(mesh: Mesh, attributes: Attributes, thinned: Thinned) -> Input<'a> {
        Input { mesh: Cow::Owned(mesh), attributes: Cow::Owned(attributes), thinned: Some(Cow::Owned(thinned)) }
    }

    /// Returns what was kept of a cloud of more points, if the input was thinned.
    pub(super) fn thinning(&self) -> Option<&Thinned> {
        self.thinned.as_deref()
    }

    /// Returns the numbers that these points have in the cloud as it was read.
    pub(super) fn numbers(&self, points: Vec<u32>) -> Vec<u32> {
        match self.thinning() {
            Some(thinned) => points.into_iter().map(|p| thinned.numbers[p as usize]).collect(),
            None => points,
        }
    }

    /// Returns whether it has points and no triangles.
    pub fn is_cloud(&self) -> bool {
        self.mesh.triangles.is_empty()
    }

    /// Refuses points without triangles.
    ///
    /// # Errors
    /// [`Error::Mesh`] for points without triangles.
    pub fn refuse_points(&self) -> Result<()> {
        if !self.is_cloud() {
            return Ok(());
        }
        let cause = format!("{} points and no triangles", self.mesh.positions.len());
        Err(Error::Mesh { fault: Fault::Empty, cause, remedy: "make a mesh of them first, by remeshing them".into() })
    }

    /// Refuses coordinates that are not finite, corners that do not exist, and attributes that do not fit the mesh. Input
    /// that was read from a file has none of these.
    ///
    /// # Errors
    /// [`Error::Mesh`] for the first of them.
    pub(super) fn check(&self) -> Result<()> {
        if self.is_cloud() {
            refuse_bad_positions(&self.mesh.positions)?;
        } else {
            refuse_bad_numbers(&self.mesh)?;
        }
        self.check_attributes()
    }

    fn check_attributes(&self) -> Result<()> {
        let (vertices, triangles) = (self.mesh.positions.len(), self.mesh.triangles.len());
        let Attributes { vertex, texture, materials, parts } = &*self.attributes;
        for Attribute { name, components, values, .. } in vertex {
            if *components == 0 || values.len() != components * vertices {
                let values = counted(values.len(), "value", "values");
                return refuse_lengths(format!(
                    "{name} has {values}, {components} per vertex, but the input has {}",
                    counted(vertices, "vertex", "vertices")
                ));
            }
        }
        let of_triangles = [
            (TEXTURE, (!texture.is_empty()).then_some(texture.len())),
            (MATERIALS, materials.as_ref().map(|m| m.of_triangle.len())),
            (PARTS, parts.as_ref().map(|p| p.of_triangle.len())),
        ];
        for (name, count) in of_triangles {
            if let Some(count) = count.filter(|&count| count != triangles) {
                let count = counted(count, "triangle", "triangles");
                return refuse_lengths(format!("{name} are given for {count}, but the input has {triangles}"));
            }
        }
        Ok(())
    }

    pub(super) fn as_mesh(&self) -> &Mesh {
        &self.mesh
    }

    pub(super) fn attributes(&self) -> &Attributes {
        &self.attributes
    }

    /// Returns the vertices, with their normals if they have any.
    pub(super) fn as_points(&self) -> Result<Points> {
        Points::new(self.mesh.positions.clone(), self.attributes.normals())
    }
}

impl<'a> From<&'a Loaded> for Input<'a> {
    fn from(loaded: &'a Loaded) -> Input<'a> {
        let thinned = loaded.thinned.as_ref().map(Cow::Borrowed);
        Input { thinned, ..Input::from(&loaded.mesh).with_attributes(&loaded.attributes) }
    }
}

impl<'a> From<&'a Mesh> for Input<'a> {
    fn from(mesh: &'a Mesh) -> Input<'a> {
        Input { mesh: Cow::Borrowed(mesh), ..Input::default() }
    }
}

fn refuse_lengths(cause: String) -> Result<()> {
    Err(Error::Mesh { fault: Fault::Lengths, cause, remedy: "give attributes of this mesh, or leave them out".into() })
}
