//! What a mesh alone does not tell of the edges of a result: which of them are sharp edges of the input, which of those were
//! left out, and how long edges were to be. Reports draw it.

use crate::manifold::Manifold;
use crate::mesh::half_edge::{OnCurve, next};
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::sized::SizedSurface;
use crate::pipeline::unit::Unit;
use crate::surface::domain::Domain;
use glam::DVec3;

/// Sharp edges and wanted lengths.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Edges {
    /// The ends of each edge of the result that lies on a sharp edge of the input.
    pub sharp: Vec<[u32; 2]>,
    /// The ends of each sharp edge of the repaired input that was left out, in the coordinates of the input.
    pub left_out: Vec<[DVec3; 2]>,
    /// The edge length wanted at each of the last vertices of the result, in the units of the input: at all of them, or,
    /// if only a part was remeshed, at those within it.
    pub wanted: Vec<f64>,
}

impl Edges {
    /// Those of `result`, whose last triangles are those of `made`, a mesh on `surface`, and of which so many `first` vertices
    /// were kept.
    pub(super) fn of(result: &Mesh, made: &Manifold, surface: &SizedSurface, unit: &Unit, first: usize) -> Edges {
        let (triangles, old) = made.connectivity.compact();
        let mut number = vec![NONE; made.connectivity.vertex_bound() as usize];
        let of_part = &result.triangles[result.triangles.len() - triangles.len()..];
        for (corners, of_result) in triangles.iter().zip(of_part) {
            (0..3).for_each(|k| number[old[corners[k] as usize] as usize] = of_result[k]);
        }
        let mut wanted: Vec<(u32, f64)> = old
            .iter()
            .map(|&v| (number[v as usize], unit.size * surface.scale.spacing * made.samples[v as usize].size))
            .filter(|w| w.0 as usize >= first)
            .collect();
        wanted.sort_unstable_by_key(|w| w.0);
        let c = &made.connectivity;
        let is_sharp = |h: &u32| c.has_twin(*h) && matches!(c.curve(*h), OnCurve::Curve(_));
        Edges {
            sharp: made
                .edges()
                .filter(is_sharp)
                .map(|h| [c.origin(h), c.target(h)].map(|v| number[v as usize]))
                .collect(),
            left_out: surface.left_out_edges.iter().map(|ends| ends.map(|p| unit.outwards_point(p))).collect(),
            wanted: wanted.into_iter().map(|w| w.1).collect(),
        }
    }
}

/// The ends of the edges of `mesh` whose sides were sharp `before` and are no longer `now`.
pub(super) fn left_out(mesh: &Mesh, twin: &[u32], before: &[bool], now: &[bool]) -> Vec<[DVec3; 2]> {
    let is_left_out = |&s: &u32| before[s as usize] && !now[s as usize] && s < twin[s as usize];
    (0..twin.len() as u32).filter(is_left_out).map(|s| ends(mesh, s)).collect()
}

/// The ends of the sides along the sharp edges of `domain`, one of each edge.
pub(super) fn sharp_edges(domain: &Domain) -> impl Iterator<Item = [DVec3; 2]> {
    let sides = domain.curves.list.iter().flat_map(|curve| &curve.sides).copied();
    sides.filter(|&s| domain.across[s as usize] != NONE).map(|s| ends(&domain.mesh, s))
}

fn ends(mesh: &Mesh, side: u32) -> [DVec3; 2] {
    let corner = |s: u32| mesh.positions[mesh.triangles[s as usize / 3][s as usize % 3] as usize];
    [corner(side), corner(next(side))]
}
