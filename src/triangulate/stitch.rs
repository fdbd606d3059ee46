//! Glues the smooth patches of a surface together along its curves: the samples at one point become one vertex.

use crate::base::union_find::UnionFind;
use crate::manifold::Manifold;
use crate::mesh::half_edge::OnCurve;
use crate::mesh::sides::{edges, lower_first, sorted_sides};
use crate::mesh::topology::NONE;
use crate::surface::domain::Sample;
use crate::triangulate::triangulation::Triangulated;
use glam::DVec3;
use std::collections::BTreeSet;

/// How the samples on curves correspond.
#[derive(Debug, Clone, Copy)]
pub struct Gluing<'a> {
    /// The point of each sample on curves, which come first among all samples.
    pub point: &'a [u32],
    /// Pairs of adjacent points along a curve, and the curve.
    pub edges: &'a [([u32; 2], OnCurve)],
    /// Points that are corners.
    pub corners: &'a [u32],
    /// Number of samples, after those on curves, at ends of spikes. Each of them is a corner.
    pub spikes: usize,
}

/// Where patches do not fit together, since there are too few points on the curves.
#[derive(Debug, Default)]
pub struct Torn {
    /// Points whose triangles are no single fan, or where an edge is missing.
    pub places: Vec<DVec3>,
    /// Indices of the curves with an edge between two of these points.
    pub curves: BTreeSet<u32>,
}

impl Torn {
    fn new(torn: &BTreeSet<u32>, samples: &[Sample], seams: Gluing<'_>) -> Torn {
        let at_both_ends = seams.edges.iter().filter(|(ends, _)| ends.iter().all(|v| torn.contains(v)));
        let number = |(_, curve): &([u32; 2], OnCurve)| if let OnCurve::Curve(c) = *curve { Some(c) } else { None };
        Torn {
            places: torn.iter().map(|&v| samples[v as usize].position).collect(),
            curves: at_both_ends.filter_map(number).collect(),
        }
    }
}

/// Glues `patches` into a manifold, with the curves marked on it.
///
/// # Errors
/// [`Torn`] if patches do not fit together.
pub fn glue(patches: &Triangulated, seams: Gluing<'_>) -> Result<Manifold, Torn> {
    let points = seams.point.iter().max().map_or(0, |&p| p + 1);
    let on_curves = patches.source.partition_point(|&s| (s as usize) < seams.point.len());
    let inner = &patches.mesh.samples()[on_curves..];
    let none = Sample { position: DVec3::ZERO, normal: DVec3::ZERO, triangle: NONE, size: 1.0 };
    let mut samples = vec![none; points as usize];
    for (sample, &source) in patches.mesh.samples().iter().zip(&patches.source[..on_curves]) {
        let point = &mut samples[seams.point[source as usize] as usize];
        // A point on more than one patch is on a sharp edge, which has no normal.
        let sharp = point.triangle != NONE;
        *point = Sample { normal: if sharp { DVec3::ZERO } else { sample.normal }, ..*sample };
    }
    samples.extend(inner);
    let number = |v: u32| match patches.source[v as usize] {
        s if (s as usize) < seams.point.len() => seams.point[s as usize],
        _ => v - on_curves as u32 + points,
    };
    let (triangles, _) = patches.mesh.connectivity.compact();
    let triangles: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(number)).collect();
    let torn = torn(samples.len(), &triangles, seams.edges);
    if !torn.is_empty() {
        return Err(Torn::new(&torn, &samples, seams));
    }
    let mut mesh = Manifold::new(samples, &triangles);
    let is_spike = |source: u32| (source as usize) < seams.point.len() + seams.spikes;
    let spikes = patches.source[on_curves..].iter().take_while(|&&source| is_spike(source)).count() as u32;
    mesh.mark_curves(seams.edges, seams.corners.iter().copied().chain(points..points + spikes));
    Ok(mesh)
}

/// Returns the vertices, in order, whose `triangles` are no single fan, or where an edge of the `curves` is missing. Only
/// such edges may be on a boundary.
fn torn(vertices: usize, triangles: &[[u32; 3]], curves: &[([u32; 2], OnCurve)]) -> BTreeSet<u32> {
    let curves: BTreeSet<[u32; 2]> = curves.iter().map(|&(ends, _)| lower_first(ends)).collect();
    let sides = sorted_sides(triangles);
    let mut absent = curves.clone();
    let mut torn = BTreeSet::new();
    let mut fans = UnionFind::new(3 * triangles.len());
    for group in edges(&sides) {
        let ends = group[0].ends();
        let is_whole = match group {
            [_] => curves.contains(&ends),
            [a, b] => a.forward() != b.forward(),
            _ => false,
        };
        if !is_whole {
            torn.extend(ends);
        }
        for pair in group.windows(2) {
            for v in ends {
                fans.join(pair[0].corner_at(v), pair[1].corner_at(v));
            }
        }
        absent.remove(&ends);
    }
    torn.extend(absent.into_iter().flatten());
    let mut fans_at = vec![0; vertices];
    for (corner, &v) in (0u32..).zip(triangles.iter().flatten()) {
        fans_at[v as usize] += usize::from(fans.find(corner) == corner);
    }
    torn.extend((0u32..).zip(fans_at).filter(|&(_, fans)| fans != 1).map(|(v, _)| v));
    torn
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two adjacent triangles, each with its own samples of the two points they share.
    fn two_patches() -> Triangulated {
        let at = |x: f64, y: f64, triangle: u32| Sample {
            position: DVec3::new(x, y, 0.0),
            normal: DVec3::Z,
            triangle,
            size: 1.0,
        };
        let samples = vec![at(0., 0., 0), at(1., 0., 0), at(0., 1., 0), at(1., 0., 1), at(1., 1., 1), at(0., 1., 1)];
        let mesh = Manifold::new(samples, &[[0, 1, 2], [3, 4, 5]]);
        Triangulated { mesh, source: (0..6).collect(), tessellated_patches: 0 }
    }

    #[test]
    fn two_triangles_share_an_edge_afterwards() {
        let ends = [[0, 1], [1, 2], [2, 0], [1, 3], [3, 2]];
        let edges: Vec<([u32; 2], OnCurve)> = ends.into_iter().zip((0..).map(OnCurve::Curve)).collect();
        let seams = Gluing { point: &[0, 1, 2, 1, 3, 2], edges: &edges, corners: &[1, 2], spikes: 0 };
        let whole = glue(&two_patches(), seams).unwrap();
        assert_eq!(whole.connectivity.vertex_count(), 4);
        assert_eq!(whole.connectivity.curve_at(1), OnCurve::Corner);
        assert_eq!(whole.connectivity.curve_at(3), OnCurve::Curve(4));
        let shared = whole.edges().find(|&h| whole.connectivity.has_twin(h)).unwrap();
        assert_eq!(whole.connectivity.curve(shared), OnCurve::Curve(1));
        assert!(!whole.connectivity.can_flip(shared));
        assert_eq!(whole.samples()[1].normal, DVec3::ZERO);
    }

    #[test]
    fn an_edge_that_is_not_there_is_a_failure() {
        let seams =
            Gluing { point: &[0, 1, 2, 1, 3, 2], edges: &[([0, 3], OnCurve::Curve(0))], corners: &[], spikes: 0 };
        let torn = glue(&two_patches(), seams).unwrap_err();
        assert!(torn.places.contains(&DVec3::ZERO) && torn.places.contains(&DVec3::new(1.0, 1.0, 0.0)), "{torn:?}");
        assert_eq!(torn.curves, BTreeSet::from([0]));
    }
}
