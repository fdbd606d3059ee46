//! Compares a result with the input: what is wrong with it, and where.

use crate::manifold::Manifold;
use crate::manifold::small_angles::slivers;
use crate::mesh::topology::{Topology, topology};
use crate::mesh::triangle_mesh::Mesh;
use crate::optimize::bridges::bridges;
use crate::optimize::contacts::part_contacts;
use crate::pipeline::attempts::Score;
use crate::pipeline::prepared::PreparedInput;
use crate::pipeline::result::has_kind;
use crate::pipeline::sized::SizedSurface;
use crate::pipeline::sized::within::Sewn;
use crate::spatial::self_intersections::{Inherited, self_intersections};
use glam::DVec3;

/// Optimised mesh of an attempt, in the coordinates of the input and joined to the part of the input that stays.
pub(in crate::pipeline) struct Finished {
    pub manifold: Manifold,
    /// The new mesh in the pipeline's unit, before joining.
    pub of_part: Mesh,
    pub sewn: Option<Sewn>,
    pub mesh: Mesh,
    pub topology: Topology,
    pub self_intersections: Vec<u32>,
    /// Self-intersecting triangles of the mesh where the input does not intersect itself.
    pub new_self_intersections: Vec<u32>,
    /// Triangles of `of_part` that are slivers.
    pub slivers: Vec<u32>,
    /// Triangles of `of_part` that are bridges.
    pub bridges: Vec<u32>,
    pub tessellated_patches: usize,
    pub score: Score,
    /// Number of the run that made it, from 1.
    pub run: u64,
    /// Whether vertices and edges were changed again at faulty places.
    pub is_mended: bool,
}

impl Finished {
    /// Compares `manifold`, which the given run made over `surface`, with the input.
    pub(in crate::pipeline) fn new(
        prepared: &PreparedInput,
        surface: &SizedSurface,
        mut manifold: Manifold,
        tessellated_patches: usize,
        run: u64,
    ) -> Finished {
        // Files store positions in single precision.
        part_contacts(&mut manifold, |p| prepared.unit.outwards_point(p).as_vec3().as_dvec3());
        let of_part = manifold.to_mesh();
        let outwards = prepared.unit.outwards(of_part.clone());
        let sewn = surface.within.as_ref().map(|within| within.sew(&outwards, &manifold, &surface.domain));
        let mesh = sewn.as_ref().map_or(outwards, |sewn| sewn.mesh.clone());
        let topology = topology(mesh.positions.len(), &mesh.triangles);
        let self_intersections = self_intersections(&mesh);
        let other_topology = !has_kind(&topology, &surface.of_whole);
        let new_self_intersections = new_among(&self_intersections, &mesh, prepared, surface);
        let slivers = slivers(&manifold);
        let bridges = bridges(&surface.domain, &manifold, surface.scale.spacing);
        let score = Score {
            other_topology,
            self_intersections: new_self_intersections.len(),
            slivers: slivers.len(),
            bridges: bridges.len(),
        };
        Finished {
            manifold,
            of_part,
            sewn,
            mesh,
            topology,
            self_intersections,
            new_self_intersections,
            slivers,
            bridges,
            tessellated_patches,
            score,
            run,
            is_mended: false,
        }
    }

    /// The same result with other vertices and edges.
    pub(in crate::pipeline) fn with(
        &self,
        prepared: &PreparedInput,
        surface: &SizedSurface,
        manifold: Manifold,
    ) -> Finished {
        let next = Finished::new(prepared, surface, manifold, self.tessellated_patches, self.run);
        Finished { is_mended: self.is_mended, ..next }
    }

    /// Number of triangles that were kept from the input; they come first.
    pub(in crate::pipeline) fn kept_triangles(&self) -> u32 {
        (self.mesh.triangles.len() - self.of_part.triangles.len()) as u32
    }

    /// Returns the corners of the triangles that make the result unsound, in the pipeline's unit.
    pub(in crate::pipeline) fn unsound_places(&self) -> Vec<DVec3> {
        self.unsound().flat_map(|t| self.of_part.corners(t as usize)).collect()
    }

    /// Returns the triangles of the manifold that make the result unsound.
    pub(in crate::pipeline) fn unsound_triangles(&self) -> Vec<u32> {
        let numbers: Vec<u32> = self.manifold.triangles().collect();
        self.unsound().map(|place| numbers[place as usize]).collect()
    }

    /// Returns the triangles of the manifold that intersect others, without those that also do in `other`, which has the
    /// same connectivity.
    pub(in crate::pipeline) fn crossing_unlike(&self, other: &Finished) -> Vec<u32> {
        let numbers: Vec<u32> = self.manifold.triangles().collect();
        let do_not_there = |t: &&u32| other.self_intersections.binary_search(t).is_err();
        let crossing: Vec<u32> = self.self_intersections.iter().filter(do_not_there).copied().collect();
        self.made_of(&crossing).map(|place| numbers[place as usize]).collect()
    }

    /// Returns the triangles of the part that make the result unsound.
    fn unsound(&self) -> impl Iterator<Item = u32> {
        self.made_of(&self.new_self_intersections).chain(self.slivers.iter().chain(&self.bridges).copied())
    }

    /// Returns those `triangles` of the mesh that are new, by their numbers in the part.
    fn made_of(&self, triangles: &[u32]) -> impl Iterator<Item = u32> {
        triangles.iter().filter_map(|t| t.checked_sub(self.kept_triangles()))
    }
}

/// Returns those self-intersecting `faces` of `mesh` that are not where the repaired input intersects itself.
fn new_among(faces: &[u32], mesh: &Mesh, prepared: &PreparedInput, surface: &SizedSurface) -> Vec<u32> {
    if faces.is_empty() {
        return Vec::new();
    }
    let SizedSurface { domain, within, .. } = surface;
    let of_whole = within.iter().flat_map(|within| {
        let whole = &within.whole;
        self_intersections(whole).into_iter().map(|t| whole.corners(t as usize))
    });
    let of_whole = Inherited::new(of_whole);
    let is_new = |&t: &u32| {
        let corners = mesh.corners(t as usize);
        !of_whole.is_near(corners) && !domain.intersects_itself_near(corners.map(|p| prepared.unit.inwards_point(p)))
    };
    faces.iter().copied().filter(is_new).collect()
}
