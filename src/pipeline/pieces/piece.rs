//! Piece of the mesh of a cloud: nodes in a part of it, triangulated, and optimised over the points around them.
//!
//! The triangles between nodes depend only on the surrounding nodes, so separately made pieces fit together. Then each piece
//! is optimised within its rim, which stays fixed; the strips along rims are optimised as separate pieces.
//!
//! Departures from remeshing a whole cloud: a base mesh ([`base_mesh`](crate::pipeline::base_mesh)) determines the
//! arrangement of the vertices, which then move onto sharp edges ([`conform`](crate::pipeline::pieces::conform)), and the
//! boundary is that of the nodes.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::base::parallel;
use crate::manifold::Manifold;
use crate::manifold::vertex_set::VertexSet;
use crate::mesh::half_edge::OnCurve;
use crate::mesh::normals::vertex_normals;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::sides::lower_first;
use crate::mesh::submesh::Submesh;
use crate::mesh::topology::{NONE, twins};
use crate::mesh::triangle_mesh::Mesh;
use crate::mesh::weld::place_key;
use crate::optimize::angles::{Goal, improve_angles};
use crate::optimize::exchange::balance_count;
use crate::optimize::self_intersections::resolve_self_intersections;
use crate::optimize::untangle::{Aim, untangle};
use crate::pipeline::attempts::mend::MODEST;
use crate::pipeline::attempts::optimization::optimize_ordered;
use crate::pipeline::cloud::sharp::cut_edges;
use crate::pipeline::pieces::conform::Conformed;
use crate::pipeline::pieces::outline::Outline;
use crate::pipeline::pieces::tile::{LocalCloud, TileOptions, TilePoint};
use crate::pipeline::scale::Scale;
use crate::prepare::repair::repair;
use crate::prepare::sharpen::Sharpened;
use crate::spatial::bvh::Bvh;
use crate::spatial::kdtree::Neighbors;
use crate::spatial::knn_graph::{DEGREE, NeighborGraph};
use crate::surface::domain::{Domain, Sample};
use crate::surface::features::{BETWEEN_PLANES, Features};
use crate::triangulate::points::triangulate_part;
use crate::triangulate::surroundings::Surroundings;
use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

/// Maximum number of rounds that split edges between rim vertices: improving the angles afterwards may create new ones.
const MOST_ROUNDS: usize = 3;

/// Part of a mesh that is to be improved.
pub struct PartOfMesh<'a> {
    /// The whole mesh.
    pub whole: &'a Mesh,
    /// For each triangle of the mesh, whether it belongs to the part.
    pub selected: &'a [bool],
    /// For each vertex of the mesh, whether the vertices around it are poorly arranged.
    pub disordered: Vec<bool>,
    /// Number of vertices to remove, or to add if negative.
    pub spare: i64,
}

/// Replacement for a part of a mesh, with the same rim.
#[derive(Debug, Clone, Default)]
pub struct MadeAnew {
    /// The new triangles.
    pub mesh: Mesh,
    /// For each vertex on the rim, its number in the whole mesh; [`NONE`] for others.
    pub source: Vec<u32>,
}

/// Triangulates `nodes`, counter-clockwise as seen from where normals point. Triangles more than a few spacings from the
/// border do not depend on what lies beyond it.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn triangulate_nodes(nodes: &[TilePoint], monitor: &dyn Monitor) -> Result<Vec<[u32; 3]>> {
    let positions: Vec<DVec3> = nodes.iter().map(|node| node.position).collect();
    let normals: Vec<DVec3> = nodes.iter().map(|node| node.normal).collect();
    triangles_between(&positions, &normals, monitor)
}

/// Optimises a part of a mesh over the surface of `points`, which are those around it. `options` are those of the sampling.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn optimize_piece(
    part: &PartOfMesh,
    points: Vec<TilePoint>,
    options: &TileOptions,
    outline: &Outline,
    monitor: &dyn Monitor,
) -> Result<MadeAnew> {
    let PartOfMesh { whole, selected, disordered, spare } = part;
    let (whole, _) = repair(whole);
    let selected: Vec<bool> =
        (0..whole.triangles.len() as u32).map(|t| selected[whole.provenance().triangle(t) as usize]).collect();
    let part = Submesh::cut_out(&whole, &selected);
    let of_whole = |v: u32| whole.provenance().vertex(part.source[v as usize]).unwrap_or(NONE);
    let joined: FxHashMap<[u64; 3], u32> = part
        .interface
        .as_flattened()
        .iter()
        .map(|&v| (place_key(part.mesh.positions[v as usize]), of_whole(v)))
        .collect();
    let piece = |mesh: Mesh| {
        let source = mesh.positions.iter().map(|&p| joined.get(&place_key(p)).copied().unwrap_or(NONE)).collect();
        MadeAnew { mesh, source }
    };
    let (surface, features) = surface_of(points, options, outline, monitor)?;
    if surface.triangles.is_empty() || part.mesh.triangles.is_empty() {
        return Ok(piece(part.mesh.clone()));
    }
    let wanted = part.mesh.positions.len().saturating_add_signed(-*spare as isize);
    let scale = Scale { wanted, spacing: Scale::spacing_of_sigma(options.sigma) };
    let domain = Domain::with_features(surface, features, scale.spacing);
    let rim = Rim::of(&part.mesh);
    let (mut mesh, moved) = rim.laid_on(&domain, &part.mesh, scale.spacing);
    let disordered = VertexSet::new(&mesh, |v| {
        let source = of_whole(v);
        moved[v as usize] || source != NONE && disordered[source as usize]
    });
    let watched = nearest_to(&domain, &whole, &selected);
    optimize_ordered(&domain, &mut mesh, &scale, disordered, watched, monitor)?;
    resolve_self_intersections(&domain, &mut mesh, monitor)?;
    if untangle(&domain, &mut mesh, Aim { most_crossing: 0, ..MODEST }, scale.spacing, monitor)? {
        balance_count(&domain, &mut mesh, scale.wanted, scale.spacing, monitor)?;
    }
    rim.part_chords(&domain, &mut mesh, &scale, monitor)?;
    Ok(piece(mesh.to_mesh()))
}

/// Builds the surface through `points`, with its sharp edges.
fn surface_of(
    points: Vec<TilePoint>,
    options: &TileOptions,
    outline: &Outline,
    monitor: &dyn Monitor,
) -> Result<(OrientedManifold, Features)> {
    let cloud = LocalCloud::new(points, options, outline);
    // The nodes lie on the implicit surface, and so do smoothed points. Where there are sharp edges, smoothing would round
    // them off over a few points, so these stay unless they are noisy.
    let is_smoothed = !options.is_sharp || options.smooth.is_some();
    let smoothed = is_smoothed.then(|| cloud.surface().smoothed());
    let (positions, normals) = smoothed.unwrap_or((cloud.positions, cloud.normals));
    let triangles = triangles_between(&positions, &normals, monitor)?;
    let mut mesh = Mesh { positions, triangles };
    mesh.drop_unused();
    let (surface, _) = repair(&mesh);
    let spacing = Scale::spacing_of_sigma(options.sigma);
    // Whether there are sharp edges has been decided for the whole cloud.
    let cut = if options.is_sharp { cut_edges(&surface, BETWEEN_PLANES, spacing) } else { None };
    let Some(cut) = cut else { return Ok((surface, Features::Smooth)) };
    let Sharpened { mesh, edges, .. } = cut.restored();
    Ok((repair(&mesh).0, Features::Edges(edges)))
}

fn triangles_between(positions: &[DVec3], normals: &[DVec3], monitor: &dyn Monitor) -> Result<Vec<[u32; 3]>> {
    let near = Neighbors::new(positions);
    let graph = NeighborGraph::new(positions, &near, DEGREE);
    let spacings = graph.spacings(positions);
    let surroundings = Surroundings { positions, normals, near: &near, graph: &graph, spacings: &spacings };
    triangulate_part(surroundings, monitor)
}

/// Boundary of a part, which stays fixed.
struct Rim {
    /// Boundary edges, by their ends.
    edges: Vec<[u32; 2]>,
    /// One vertex at each position on the boundary: the part may touch itself.
    vertices: FxHashMap<[u64; 3], u32>,
    /// Edges of the part between these vertices, the lower vertex first.
    chords: FxHashSet<[u32; 2]>,
}

impl Rim {
    fn of(part: &Mesh) -> Rim {
        let twin = twins(&part.triangles);
        let sides = (0..twin.len() as u32).filter(|&side| twin[side as usize] == NONE);
        let edges: Vec<[u32; 2]> = sides.map(|side| part.ends(side)).collect();
        let at = |v: u32| (place_key(part.positions[v as usize]), v);
        let vertices: FxHashMap<[u64; 3], u32> = edges.as_flattened().iter().map(|&v| at(v)).collect();
        let mut rim = Rim { edges, vertices, chords: FxHashSet::default() };
        rim.chords = (0..twin.len() as u32).filter_map(|side| rim.chord(part.segment(side))).collect();
        rim
    }

    /// Returns the vertex of the part that is on the rim at `p`.
    fn vertex_at(&self, p: DVec3) -> Option<u32> {
        self.vertices.get(&place_key(p)).copied()
    }

    /// Returns the rim vertices at these positions, the lower one first, if both are on the rim.
    fn chord(&self, ends: [DVec3; 2]) -> Option<[u32; 2]> {
        let [a, b] = ends.map(|p| self.vertex_at(p));
        Some(lower_first([a?, b?]))
    }

    /// Lays the part on the domain as a manifold. Also returns, for each vertex, whether it moved onto a sharp edge.
    fn laid_on(&self, domain: &Domain, part: &Mesh, spacing: f64) -> (Manifold, Vec<bool>) {
        let facing = part.positions.iter().zip(vertex_normals(part));
        let mut samples: Vec<Sample> = facing.map(|(&p, normal)| domain.project_facing(p, normal)).collect();
        let on_rim = self.edges.as_flattened();
        on_rim.iter().for_each(|&v| samples[v as usize].position = part.positions[v as usize]);
        let is_on_rim = |v: u32| self.vertex_at(part.positions[v as usize]).is_some();
        let Conformed { samples, edges: sharp, corners, moved_onto } =
            Conformed::new(domain, samples, &part.triangles, is_on_rim, spacing);
        let mut mesh = Manifold::new(samples, &part.triangles);
        mesh.mark_curves(&sharp, corners);
        let edges: Vec<_> = self.edges.iter().map(|&ends| (ends, OnCurve::Interface)).collect();
        mesh.mark_curves(&edges, on_rim.iter().copied());
        (mesh, moved_onto.into_iter().map(|curve| curve != OnCurve::No).collect())
    }

    /// Splits edges between rim vertices that the part did not have: the mesh beyond the rim may also have them.
    fn part_chords(&self, domain: &Domain, mesh: &mut Manifold, scale: &Scale, monitor: &dyn Monitor) -> Result<()> {
        for _ in 0..MOST_ROUNDS {
            let new = self.new_chords(mesh);
            if new.is_empty() {
                break;
            }
            for h in new {
                mesh.split_anyhow(domain, h);
            }
            balance_count(domain, mesh, scale.wanted, scale.spacing, monitor)?;
            improve_angles(domain, mesh, Goal::GOOD, scale.spacing, monitor)?;
        }
        Ok(())
    }

    /// Returns a half-edge of each edge between rim vertices that the part did not have.
    fn new_chords(&self, mesh: &Manifold) -> Vec<u32> {
        let c = &mesh.connectivity;
        let chord = |h: u32| self.chord([c.origin(h), c.target(h)].map(|v| mesh.position(v)));
        mesh.edges().filter(|&h| chord(h).is_some_and(|chord| !self.chords.contains(&chord))).collect()
    }
}

/// Returns the vertices of the domain whose closest triangle of `whole` is `selected`.
fn nearest_to(domain: &Domain, whole: &Mesh, selected: &[bool]) -> Vec<u32> {
    let bvh = Bvh::new(whole);
    let is_near = |p: DVec3| bvh.closest(whole, p).is_some_and(|hit| selected[hit.triangle as usize]);
    parallel::collect(0..domain.mesh.positions.len() as u32, |vertices| {
        vertices.filter(|&v| is_near(domain.mesh.positions[v as usize]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_across_a_corner_of_the_rim_is_split() {
        // A quadrilateral with an inner vertex connected to all of its corners; then two of the corners are connected to
        // each other.
        let corners = [[0.0, 0.0], [1.0, -0.6], [2.0, 0.0], [1.0, 2.0], [1.0, 0.6]];
        let positions = corners.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        let part = Mesh { positions, triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]] };
        let domain = Domain::new(part.clone().try_into().unwrap());
        let rim = Rim::of(&part);
        let (mut mesh, _) = rim.laid_on(&domain, &part, 1.0);
        assert!(rim.new_chords(&mesh).is_empty());
        let h = mesh.connectivity.outgoing(1).find(|&h| mesh.connectivity.target(h) == 4).unwrap();
        mesh.connectivity.flip(h);
        assert_eq!(rim.new_chords(&mesh).len(), 1);
        rim.part_chords(&domain, &mut mesh, &Scale { wanted: 6, spacing: 1.0 }, &()).unwrap();
        assert!(rim.new_chords(&mesh).is_empty());
        let made = mesh.to_mesh();
        assert_eq!((made.positions.len(), made.triangles.len()), (6, 6));
        let on_rim = made.positions.iter().filter_map(|&p| rim.vertex_at(p)).count();
        assert_eq!((on_rim, Rim::of(&made).edges.len()), (4, 4));
    }
}
