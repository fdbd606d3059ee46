//! Glues the smooth patches of a surface along its curves: the samples of one point become one vertex.

use crate::surface::domain::Sample;
use crate::surface::manifold::Manifold;
use crate::surface::topology::{NONE, topology};
use glam::DVec3;

/// How the samples on curves belong together.
#[derive(Debug, Clone, Copy)]
pub struct Seams<'a> {
    /// For each of the first samples the point that it is.
    pub point: &'a [u32],
    /// The points next to each other along a curve, and the curve.
    pub edges: &'a [([u32; 2], u32)],
    /// Points that are corners.
    pub corners: &'a [u32],
}

/// The manifold of `patches`, whose first vertices are the samples on curves in their order, with the curves laid on it.
///
/// `None` if that is no oriented 2-manifold, or an edge of a curve is not there: the points on the curves are too few.
pub fn glue(patches: &Manifold, seams: Seams<'_>) -> Option<Manifold> {
    let (triangles, old) = patches.connectivity.compact();
    let points = seams.point.iter().max().map_or(0, |&p| p + 1);
    let on_curves = seams.point.len() as u32;
    let number = |v: u32| if v < on_curves { seams.point[v as usize] } else { v - on_curves + points };
    let triangles: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(number)).collect();
    let mut first = vec![NONE; points as usize];
    let mut samples = vec![Sample { position: DVec3::ZERO, normal: DVec3::ZERO, triangle: 0 }; points as usize];
    for (v, &p) in seams.point.iter().enumerate() {
        if first[p as usize] == NONE {
            first[p as usize] = v as u32;
            samples[p as usize] = patches.samples[old[v] as usize];
        } else {
            // More than one patch: a sharp edge, which has no normal.
            samples[p as usize].normal = DVec3::ZERO;
        }
    }
    samples.extend(old[on_curves as usize..].iter().map(|&v| patches.samples[v as usize]));
    let made = topology(samples.len(), &triangles);
    if !made.is_manifold() || !made.is_oriented() || made.vertices < samples.len() {
        return None;
    }
    let mut mesh = Manifold::new(samples, &triangles);
    mesh.lay_curves(seams.edges, seams.corners.iter().copied()).then_some(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::connectivity::CORNER;

    /// Two triangles beside each other, each with its own samples of the two points they share.
    fn two_patches() -> Manifold {
        let at = |x: f64, y: f64, triangle: u32| Sample { position: DVec3::new(x, y, 0.0), normal: DVec3::Z, triangle };
        let samples = vec![at(0., 0., 0), at(1., 0., 0), at(0., 1., 0), at(1., 0., 1), at(1., 1., 1), at(0., 1., 1)];
        Manifold::new(samples, &[[0, 1, 2], [3, 4, 5]])
    }

    #[test]
    fn two_triangles_share_an_edge_afterwards() {
        let edges = [([0, 1], 0), ([1, 2], 1), ([2, 0], 2), ([1, 3], 3), ([3, 2], 4)];
        let seams = Seams { point: &[0, 1, 2, 1, 3, 2], edges: &edges, corners: &[1, 2] };
        let whole = glue(&two_patches(), seams).unwrap();
        assert_eq!(whole.connectivity.vertex_count(), 4);
        assert_eq!(whole.connectivity.curve_at(1), CORNER);
        assert_eq!(whole.connectivity.curve_at(3), 4);
        let shared = whole.edges().find(|&h| whole.connectivity.twin(h) != NONE).unwrap();
        assert_eq!(whole.connectivity.curve(shared), 1);
        assert!(!whole.connectivity.can_flip(shared));
        assert_eq!(whole.samples[1].normal, DVec3::ZERO);
    }

    #[test]
    fn an_edge_that_is_not_there_is_a_failure() {
        let seams = Seams { point: &[0, 1, 2, 1, 3, 2], edges: &[([0, 3], 0)], corners: &[] };
        assert!(glue(&two_patches(), seams).is_none());
    }
}
