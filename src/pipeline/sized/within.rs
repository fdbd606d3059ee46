//! Local resampling: a part of the input is remeshed, and everything else stays as it is, to the last bit.
//!
//! The part is cut out, remeshed as a surface with a boundary whose vertices and edges along the interface are fixed, and
//! sewn in again. Edge lengths change gradually from those of the interface to the target ones.
//!
//! Based on: the future work in C. Öztireli, M. Alexa, M. Gross, Spectral sampling of manifolds, 2010,
//! DOI 10.1145/1882261.1866190.
//!
//! Limits: triangles at the interface are as good as its edges allow; where an interface zigzags, this is not very good.

use crate::base::error::{Error, Result, Setting};
use crate::manifold::Manifold;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::provenance::PointOnTriangle;
use crate::mesh::submesh::{Kept, Submesh, sew};
use crate::mesh::topology::{NONE, components};
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::density::Density;
use crate::pipeline::prepared::PreparedInput;
use crate::pipeline::scale::Scale;
use crate::prepare::repairs::Repairs;
use crate::surface::domain::Domain;
use crate::surface::sizing::{lengths_from_interface, mean_density, vertices};

/// Repaired input and the part of it that is remeshed.
pub(in crate::pipeline) struct Within {
    /// Input after repairs, in its own coordinates.
    pub whole: OrientedManifold,
    /// Part to be remeshed, in the coordinates of the input.
    pub part: Submesh,
    /// For each triangle of the whole, whether it is in the part.
    selected: Vec<bool>,
    /// Number of components of the selection that are too small.
    left: usize,
    /// Whether repair changed the input.
    was_repaired: bool,
}

/// Returns the surface to be sampled, in the pipeline's unit, and the rest of the repaired input if it is only a part.
///
/// # Errors
/// [`Error::Option`] if no triangle is in the requested part, or if there is no room in it.
pub(in crate::pipeline) fn sampled_part(
    prepared: &PreparedInput,
    mut repaired: OrientedManifold,
    density: Density,
) -> Result<(OrientedManifold, Option<Within>)> {
    let Some(selection) = &prepared.options.part else { return Ok((repaired, None)) };
    let selected = selection.triangles(&repaired);
    if !selected.contains(&false) {
        prepared.unit.move_inwards(repaired.positions_mut());
        return Ok((repaired, None));
    }
    if !selected.contains(&true) {
        return selection.refuse_nothing(&repaired);
    }
    let within = Within::new(prepared, repaired, selected, density)?;
    Ok((within.part(prepared), Some(within)))
}

impl Within {
    fn new(prepared: &PreparedInput, whole: OrientedManifold, selected: Vec<bool>, density: Density) -> Result<Within> {
        let was_repaired = prepared.repairs != Repairs::default();
        let mut within = Within { part: Submesh::cut_out(&whole, &selected), whole, selected, left: 0, was_repaired };
        let scale = Scale::new(density, prepared.field.as_ref(), &within.part(prepared), &prepared.unit)?;
        let spacing = prepared.unit.size * scale.spacing;
        within.leave_small_components(spacing);
        if within.part.mesh.triangles.is_empty() {
            let cause = format!("the part is smaller than a triangle with edges {spacing:.4e} long");
            let remedy = "give more points, or a larger part".into();
            return Err(Error::Option { option: Setting::Points, cause, remedy });
        }
        Ok(within)
    }

    /// Returns the part, in the pipeline's unit.
    fn part(&self, prepared: &PreparedInput) -> OrientedManifold {
        let triangles: Vec<u32> =
            (0..).zip(&self.selected).filter(|(_, selected)| **selected).map(|(t, _)| t).collect();
        let provenance = self.whole.provenance().clone().select(&self.part.source, &triangles);
        OrientedManifold::trusted(prepared.unit.inwards(&self.part.mesh), provenance)
    }

    /// Leaves components unchanged that have no room for a point.
    fn leave_small_components(&mut self, spacing: f64) {
        let mesh = &self.part.mesh;
        let component = components(mesh.positions.len(), &mesh.triangles);
        let area = mesh.component_areas(&component);
        let mut is_small = vec![false; area.len()];
        for ends in &self.part.interface {
            let component = component[ends[0] as usize] as usize;
            is_small[component] = area[component] < 0.75f64.sqrt() * spacing * spacing;
        }
        self.left = is_small.iter().filter(|small| **small).count();
        if self.left == 0 {
            return;
        }
        let stays = mesh.triangles.iter().map(|corners| is_small[component[corners[0] as usize] as usize]);
        let of_part = self.selected.iter_mut().filter(|selected| **selected);
        of_part.zip(stays).filter(|(_, stays)| *stays).for_each(|(selected, _)| *selected = false);
        self.part = Submesh::cut_out(&self.whole, &self.selected);
    }

    /// Gives `domain`, that of the part, lengths that change gradually from those of the interface, and returns their scale.
    /// Vertices on the interface count by half: the other half of the surface around them is not in the part.
    pub(in crate::pipeline) fn grade(&self, domain: &mut Domain, density: Density, scale: &Scale) -> Scale {
        let on_interface = self.part.interface_vertices();
        let wanted: Vec<f64> =
            (0..domain.mesh.positions.len() as u32).map(|v| scale.spacing * domain.size_at(v)).collect();
        let count = density.fixes_count().then_some(scale.wanted);
        let lengths = lengths_from_interface(domain, &wanted, count.map(|n| n as f64 + 0.5 * on_interface as f64));
        let inside = count.unwrap_or_else(|| (vertices(domain, &lengths) - 0.5 * on_interface as f64).round() as usize);
        let spacing = mean_density(&domain.mesh, &lengths).sqrt().recip();
        domain.grade(lengths.into_iter().map(|length| length / spacing).collect());
        Scale { wanted: inside + on_interface, spacing }
    }

    /// Returns the wanted number of vertices of the whole, given the number `wanted` of the part including its interface.
    pub(in crate::pipeline) fn wanted(&self, wanted: usize) -> usize {
        let mut stays = vec![false; self.whole.positions.len()];
        let corners = self.whole.triangles.iter().zip(&self.selected).filter(|t| !*t.1).flat_map(|t| t.0);
        corners.for_each(|&v| stays[v as usize] = true);
        stays.iter().filter(|stays| **stays).count() + wanted - self.part.interface_vertices()
    }

    /// Sews `mesh`, which is the mesh of `made` and whose vertices lie on `domain`, into the whole in place of the part.
    pub(in crate::pipeline) fn sew(&self, mesh: &Mesh, made: &Manifold, domain: &Domain) -> Sewn {
        let (_, old) = made.connectivity.compact();
        let joined: Vec<u32> = old
            .iter()
            .map(|&v| corner_of_interface(made, domain, v).map_or(NONE, |v| self.part.source[v as usize]))
            .collect();
        let (mesh, Kept { vertices, triangles }) = sew(&self.whole, &self.selected, mesh, &joined);
        let new = (0..).zip(&joined).filter(|v| *v.1 == NONE).map(|(v, _)| v).collect();
        Sewn { mesh, kept_vertices: vertices, kept_triangles: triangles, new }
    }

    /// Returns the numbers in the input of the kept vertices and triangles.
    pub(in crate::pipeline) fn kept(&self, sewn: &Sewn) -> Kept {
        let provenance = self.whole.provenance();
        let vertex = |&v: &u32| provenance.vertex(v).unwrap_or(NONE);
        let is_whole = |t: u32| self.whole.triangles[t as usize].iter().all(|&v| provenance.vertex(v).is_some());
        let triangle = |&t: &u32| if is_whole(t) { provenance.triangle(t) } else { NONE };
        Kept {
            vertices: sewn.kept_vertices.iter().map(vertex).collect(),
            triangles: sewn.kept_triangles.iter().map(triangle).collect(),
        }
    }

    /// Returns the point of the input at barycentric coordinates `weights` of triangle `t` of the whole.
    pub(in crate::pipeline) fn origin(&self, t: u32, weights: [f64; 3], input: &Mesh) -> PointOnTriangle {
        self.whole.provenance().origin(t, self.whole.triangles[t as usize], weights, &input.triangles)
    }

    /// Returns the notes on the part.
    pub(in crate::pipeline) fn notes(&self, mesh: &Mesh, kept: &Kept) -> Vec<String> {
        let new = mesh.positions.len() - kept.vertices.len();
        let of_input = if self.was_repaired { "the repaired input" } else { "the input" };
        let mut notes = vec![format!(
            "{new} vertices are inside the part that was remeshed; {} vertices and {} triangles of {of_input} are \
             unchanged",
            kept.vertices.len(),
            kept.triangles.len()
        )];
        if self.left > 0 {
            notes.push(format!(
                "{} components of the part are left unchanged: they are too small for a point inside",
                self.left
            ));
        }
        notes
    }
}

/// The whole with a new part.
pub(in crate::pipeline) struct Sewn {
    /// Kept vertices and triangles come first.
    pub mesh: Mesh,
    /// For each kept vertex, and each kept triangle, its number in the whole.
    kept_vertices: Vec<u32>,
    pub kept_triangles: Vec<u32>,
    /// For each vertex after the kept ones, its number in the part.
    pub new: Vec<u32>,
}

/// Returns the vertex of the part, before it was cut along sharp edges, that vertex `v` of the new mesh corresponds to, if
/// `v` is on the interface. Such a vertex is a corner of the triangle of the domain on which it lies.
fn corner_of_interface(made: &Manifold, domain: &Domain, v: u32) -> Option<u32> {
    if !made.connectivity.is_on_interface(v) {
        return None;
    }
    let sample = made.sample(v);
    let corners = domain.mesh.triangles[sample.triangle as usize];
    let corner = corners.into_iter().find(|&w| domain.mesh.positions[w as usize] == sample.position);
    corner.map(|w| domain.original[w as usize])
}
