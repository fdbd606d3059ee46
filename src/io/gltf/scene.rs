//! From the nodes of a scene to triangles.

use super::materials::{self, Lists};
use super::store::{Store, wrong};
use super::vertices::{Columns, accessors};
use crate::base::error::{Place, Result};
use crate::io::bytes::{NO_LINES, malformed};
use crate::io::content::Read;
use crate::mesh::parts::{Part, Parts, part_name};
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use ::gltf::json::mesh::{Mode, Primitive, Semantic};
use ::gltf::json::validation::Checked;
use ::gltf::json::{Node, Root};
use glam::{DMat3, DMat4, DQuat, DVec3};
use std::collections::BTreeMap;

/// Number of vertices and indices that a scene may have even if its data is smaller: meshes may be used many times.
const REPEATED: usize = 1 << 26;

/// Reads a scene: all its triangles, their looks, and the points of its clouds.
pub(super) fn collect(root: &Root, store: &Store, looks: &Lists) -> Result<Read> {
    let (mesh, columns, left_out) = (Mesh::default(), Columns::default(), LeftOut::default());
    let (materials, materials_of, parts_of) = (looks.count(), Vec::new(), Vec::new());
    let mut scene = Collector { root, store, materials, mesh, columns, materials_of, parts_of, read: 0, left_out };
    let scenes = root.scenes.len();
    let instances = match root.scene.map(|s| s.value()).or((scenes > 0).then_some(0)) {
        Some(index) => scene_instances(root, index)?,
        None => {
            let instance = |mesh| Instance { mesh, transform: DMat4::IDENTITY, skinned: false, name: None };
            (0..root.meshes.len()).map(instance).collect()
        }
    };
    scene.instances(&instances)?;
    if scene.mesh.positions.is_empty() && scene.left_out.lines > 0 {
        return Err(malformed(Place::Whole, "it has lines but no faces", NO_LINES));
    }
    let mut notes = scene.left_out.notes();
    if scenes > 1 {
        notes.push(format!("only one of {scenes} scenes is read"));
    }
    let (mut attributes, left_out) = scene.columns.finish(scene.mesh.positions.len(), &scene.mesh.triangles);
    notes.extend(left_out);
    let (materials, left_out) = materials::read(looks, store, &scene.materials_of)?;
    notes.extend(left_out);
    attributes.materials = materials;
    attributes.parts = parts(root, &instances, scene.parts_of);
    Ok(Read { mesh: scene.mesh, attributes, notes })
}

struct Collector<'a, 's> {
    root: &'a Root,
    store: &'a Store<'s>,
    /// Number of materials in the file.
    materials: usize,
    mesh: Mesh,
    columns: Columns,
    /// For each triangle, the index of its material in the file, and of its instance in the scene.
    materials_of: Vec<u32>,
    parts_of: Vec<u32>,
    /// Number of vertices and indices read or budgeted so far.
    read: usize,
    left_out: LeftOut,
}

/// Counts of what is left out or incomplete.
#[derive(Default)]
struct LeftOut {
    lines: usize,
    without_positions: usize,
    morphed: usize,
    skinned: usize,
    incomplete: usize,
}

impl LeftOut {
    fn notes(&self) -> Vec<String> {
        let texts = [
            (self.lines, "line primitives are left out"),
            (self.without_positions, "primitives without positions are left out"),
            (self.morphed, "primitives are read without their morph targets"),
            (self.skinned, "nodes are read without their skins"),
            (self.incomplete, "primitives end with an incomplete triangle, which is left out"),
        ];
        texts.into_iter().filter(|(count, _)| *count > 0).map(|(count, text)| format!("{count} {text}")).collect()
    }
}

impl Collector<'_, '_> {
    /// Adds all instances. The budget for all uses of a mesh is claimed at its first use.
    fn instances(&mut self, instances: &[Instance]) -> Result<()> {
        let mut uses = vec![0usize; self.root.meshes.len()];
        for instance in instances {
            *uses.get_mut(instance.mesh).ok_or_else(|| wrong("mesh", instance.mesh, "does not exist"))? += 1;
        }
        for (number, instance) in (0..).zip(instances) {
            let before = self.read;
            self.mesh(instance.mesh, instance.transform)?;
            self.parts_of.resize(self.mesh.triangles.len(), number);
            self.left_out.skinned += usize::from(instance.skinned);
            match std::mem::take(&mut uses[instance.mesh]).checked_sub(1) {
                Some(others) => self.budget((self.read - before).saturating_mul(others))?,
                None => self.read = before,
            }
        }
        Ok(())
    }

    /// Adds a mesh, which must exist. Primitives with the same positions share their vertices.
    fn mesh(&mut self, index: usize, transform: DMat4) -> Result<()> {
        let mesh = &self.root.meshes[index];
        let mut bases = BTreeMap::new();
        for primitive in &mesh.primitives {
            let Checked::Valid(mode) = primitive.mode else {
                return Err(wrong("mesh", index, "a primitive has an unknown mode"));
            };
            if matches!(mode, Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
                self.left_out.lines += 1;
                continue;
            }
            let material = self.material(index, primitive)?;
            self.left_out.morphed += usize::from(primitive.targets.as_ref().is_some_and(|t| !t.is_empty()));
            match primitive.attributes.get(&Checked::Valid(Semantic::Positions)) {
                Some(positions) => self.primitive(primitive, mode, positions.value(), transform, &mut bases)?,
                None => self.left_out.without_positions += 1,
            }
            self.materials_of.resize(self.mesh.triangles.len(), material);
        }
        Ok(())
    }

    /// Returns the index of a primitive's material, [`NONE`] if it has none.
    fn material(&self, mesh: usize, primitive: &Primitive) -> Result<u32> {
        match primitive.material.map(|m| m.value()) {
            None => Ok(NONE),
            Some(number) if number < self.materials => Ok(number as u32),
            Some(number) => {
                let cause = format!("a primitive uses material {number}, but there are only {}", self.materials);
                Err(wrong("mesh", mesh, cause))
            }
        }
    }

    /// Adds a primitive. `bases` has the first vertex and the number of vertices of each set of accessors added before.
    fn primitive(
        &mut self,
        primitive: &Primitive,
        mode: Mode,
        accessor: usize,
        transform: DMat4,
        bases: &mut BTreeMap<(usize, Vec<usize>), (u32, u32)>,
    ) -> Result<()> {
        let key = (accessor, accessors(primitive));
        let (base, count) = match bases.get(&key) {
            Some(&known) => known,
            None => {
                let (base, count) = self.vertices(accessor, transform)?;
                let turn = DMat3::from_mat4(transform).inverse().transpose();
                self.budget((count as usize).saturating_mul(key.1.len()))?;
                self.columns.add(self.store, primitive, base as usize, count as usize, turn);
                *bases.entry(key).or_insert((base, count))
            }
        };
        if mode == Mode::Points {
            return Ok(());
        }
        let corners = match primitive.indices {
            Some(indices) => self.store.indices(indices.value(), count as usize)?,
            None => (0..count).collect(),
        };
        self.budget(corners.len())?;
        self.left_out.incomplete += usize::from(mode == Mode::Triangles && !corners.len().is_multiple_of(3));
        // A mirroring transform reverses the orientation of triangles.
        let mirrored = transform.determinant() < 0.0;
        let place = |[a, b, c]: [u32; 3]| {
            if mirrored { [base + a, base + c, base + b] } else { [base + a, base + b, base + c] }
        };
        self.mesh.triangles.extend(triangles(mode, &corners).map(place));
        Ok(())
    }

    /// Adds the transformed positions of an accessor. Returns the first vertex and their number.
    fn vertices(&mut self, accessor: usize, transform: DMat4) -> Result<(u32, u32)> {
        let positions = self.store.positions(accessor)?;
        self.budget(positions.len())?;
        let base = self.mesh.positions.len();
        self.mesh.positions.extend(positions.iter().map(|&p| transform.transform_point3(p)));
        if !self.mesh.positions[base..].iter().all(|p| p.is_finite()) {
            return Err(wrong("accessor", accessor, "a position is not finite after its node's transform"));
        }
        let range = u32::try_from(base).ok().zip(u32::try_from(positions.len()).ok());
        range.filter(|(base, count)| base.checked_add(*count).is_some()).ok_or_else(too_large)
    }

    /// Claims `more` vertices or indices of the budget. A scene may be larger than its data, but only within a limit.
    fn budget(&mut self, more: usize) -> Result<()> {
        self.read = self.read.saturating_add(more);
        if self.read > REPEATED.max(self.store.loaded()) { Err(too_large()) } else { Ok(()) }
    }
}

fn too_large() -> crate::base::error::Error {
    let cause = "the scene repeats its meshes too often: it has too many vertices";
    malformed(Place::Whole, cause, "export fewer copies of the repeated meshes")
}

/// A use of a mesh by a node.
struct Instance<'a> {
    mesh: usize,
    transform: DMat4,
    skinned: bool,
    /// Name of the node.
    name: Option<&'a str>,
}

/// Returns the parts of these instances' triangles, if one has a name: that of the node, else that of the mesh.
fn parts(root: &Root, instances: &[Instance], of_triangle: Vec<u32>) -> Option<Parts> {
    let name = |i: &Instance| part_name(i.name.or(root.meshes[i.mesh].name.as_deref()).unwrap_or_default());
    let list: Vec<Part> = instances.iter().map(|i| Part { object: name(i), group: String::new() }).collect();
    let is_named = list.iter().any(|part| !part.object.is_empty());
    (is_named && !of_triangle.is_empty()).then_some(Parts { list, of_triangle })
}

/// Returns the meshes of the nodes of scene `index`, parents before their children. The specification requires trees, so a
/// node that is met twice is an error, which also rules out cycles.
fn scene_instances(root: &Root, index: usize) -> Result<Vec<Instance<'_>>> {
    let scene = root.scenes.get(index).ok_or_else(|| wrong("scene", index, "does not exist"))?;
    let mut met = vec![false; root.nodes.len()];
    let mut open: Vec<(usize, DMat4)> = scene.nodes.iter().rev().map(|n| (n.value(), DMat4::IDENTITY)).collect();
    let mut instances = Vec::new();
    while let Some((index, outer)) = open.pop() {
        let node = root.nodes.get(index).ok_or_else(|| wrong("node", index, "does not exist"))?;
        if std::mem::replace(&mut met[index], true) {
            return Err(wrong("node", index, "has more than one parent"));
        }
        let transform = outer * local_transform(node);
        if !transform.is_finite() {
            return Err(wrong("node", index, "the transform is not finite"));
        }
        let mesh = node.mesh.map(|m| m.value());
        instances.extend(mesh.map(|mesh| Instance {
            mesh,
            transform,
            skinned: node.skin.is_some(),
            name: node.name.as_deref(),
        }));
        open.extend(node.children.iter().flatten().rev().map(|child| (child.value(), transform)));
    }
    Ok(instances)
}

/// Returns the transform of a node relative to its parent.
fn local_transform(node: &Node) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix.map(f64::from));
    }
    let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let rotation = DQuat::from_array(node.rotation.unwrap_or_default().0.map(f64::from));
    // The specification requires unit quaternions. Normalizing removes the rounding to single precision.
    DMat4::from_scale_rotation_translation(
        vector(node.scale.unwrap_or([1.0; 3])),
        DQuat::from_vec4(glam::DVec4::from(rotation).normalize()),
        vector(node.translation.unwrap_or_default()),
    )
}

/// Returns the triangles of a sequence of vertices. Triangles of strips and fans with a repeated vertex are left out, as
/// they only join pieces.
fn triangles(mode: Mode, corners: &[u32]) -> Box<dyn Iterator<Item = [u32; 3]> + '_> {
    let proper = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    match mode {
        Mode::TriangleStrip => {
            let turn = |(i, w): (usize, &[u32])| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
            Box::new(corners.windows(3).enumerate().map(turn).filter(proper))
        }
        Mode::TriangleFan => {
            let rim = corners.get(1..).unwrap_or_default();
            Box::new(rim.windows(2).map(|w| [w[0], w[1], corners[0]]).filter(proper))
        }
        _ => Box::new(corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]])),
    }
}
