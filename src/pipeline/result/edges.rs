//! Information on the edges of a result that the mesh alone does not contain: which of them are sharp edges of the input,
//! which sharp edges were left out, and the target lengths. Reports show it.

use crate::manifold::Manifold;
use crate::mesh::half_edge::OnCurve;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::sized::SizedSurface;
use crate::pipeline::unit::Unit;
use glam::DVec3;

/// Sharp edges and target lengths.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Edges {
    /// Ends of each edge of the result that lies on a sharp edge of the input.
    pub sharp: Vec<[u32; 2]>,
    /// Ends of each sharp edge of the repaired input that was left out, in the coordinates of the input.
    pub left_out: Vec<[DVec3; 2]>,
    /// Target edge length at the last vertices of the result, in the units of the input: at all vertices or, if only a part
    /// was remeshed, at those inside it.
    pub wanted: Vec<f64>,
}

impl Edges {
    /// Collects the edges of `result`, whose last triangles are those of `made`, a mesh on `surface`, and whose first
    /// `first` vertices were kept.
    pub(in crate::pipeline) fn of(
        result: &Mesh,
        made: &Manifold,
        surface: &SizedSurface,
        unit: &Unit,
        first: usize,
    ) -> Edges {
        let (triangles, old) = made.connectivity.compact();
        let mut number = vec![NONE; made.connectivity.vertex_bound() as usize];
        let of_part = &result.triangles[result.triangles.len() - triangles.len()..];
        for (corners, of_result) in triangles.iter().zip(of_part) {
            (0..3).for_each(|k| number[old[corners[k] as usize] as usize] = of_result[k]);
        }
        let mut wanted: Vec<(u32, f64)> = old
            .iter()
            .map(|&v| (number[v as usize], unit.size * surface.scale.spacing * made.sample(v).size))
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
