//! Lays a mesh on a surface with sharp edges: vertices near a sharp edge move onto it, so that no edge crosses it and edges
//! of the mesh run along it.
//!
//! Edges between two patches cross a sharp edge. Of the ends of each, the one nearer to it moves, unless the other one is
//! already there. So a triangle that was crossed has two vertices on the sharp edge, or one through which it leaves.

use crate::mesh::half_edge::OnCurve;
use crate::mesh::sides::lower_first;
use crate::mesh::topology::NONE;
use crate::spatial::kdtree::Neighbors;
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;
use rustc_hash::FxHashMap;

/// Maximum distance that a vertex moves onto a sharp edge, in spacings.
const NEAR: f64 = 0.6;

/// Vertices on the sharp edges of a domain.
pub(super) struct Conformed {
    pub samples: Vec<Sample>,
    /// Edges along sharp edges, each with its curve.
    pub edges: Vec<([u32; 2], OnCurve)>,
    /// Vertices on sharp edges that have to stay.
    pub corners: Vec<u32>,
    /// For each vertex, the sharp edge that it moved onto.
    pub moved_onto: Vec<OnCurve>,
}

impl Conformed {
    /// Moves the `samples` of a mesh of `triangles`, except those that `stay`, onto the sharp edges of a domain with this
    /// `spacing` of the samples.
    pub fn new(
        domain: &Domain,
        samples: Vec<Sample>,
        triangles: &[[u32; 3]],
        stay: impl Fn(u32) -> bool,
        spacing: f64,
    ) -> Conformed {
        let moved_onto = vec![OnCurve::No; samples.len()];
        let mut conformed = Conformed { samples, edges: Vec::new(), corners: Vec::new(), moved_onto };
        if domain.is_sharp() {
            conformed.move_to_corners(domain, &stay, NEAR * spacing);
            conformed.move_ends(domain, triangles, &stay, NEAR * spacing);
            conformed.find_edges(domain, triangles);
        }
        conformed
    }

    fn has_moved(&self, v: u32) -> bool {
        self.moved_onto[v as usize] != OnCurve::No
    }

    fn move_onto(&mut self, v: u32, curve: OnCurve, sample: Sample) {
        (self.samples[v as usize], self.moved_onto[v as usize]) = (sample, curve);
    }

    /// Moves the nearest vertex to each corner of the sharp edges.
    fn move_to_corners(&mut self, domain: &Domain, stay: impl Fn(u32) -> bool, near: f64) {
        let positions: Vec<DVec3> = self.samples.iter().map(|sample| sample.position).collect();
        let tree = Neighbors::new(&positions);
        let mut found = Vec::new();
        let is_sharp = |side: u32| domain.across.get(side) != NONE;
        for side in (0..domain.twin.len() as u32).filter(|&side| is_sharp(side)) {
            if !domain.curves.is_corner(domain.mesh.origin(side)) {
                continue;
            }
            let corner = domain.sample_on_side(side, 0.0);
            tree.collect_nearest_within(corner.position, 1, near, &mut found);
            // Each side that leaves the corner finds the same vertex.
            if let Some(v) = found.first().map(|n| n.point).filter(|&v| !self.has_moved(v) && !stay(v)) {
                self.move_onto(v, OnCurve::Corner, Sample { normal: DVec3::ZERO, ..corner });
            }
        }
    }

    /// Moves an end of each edge that crosses a sharp edge.
    fn move_ends(&mut self, domain: &Domain, triangles: &[[u32; 3]], stay: impl Fn(u32) -> bool, near: f64) {
        let patch: Vec<u32> = self.samples.iter().map(|sample| domain.patch_of(sample.triangle)).collect();
        let mut crossed: Vec<[u32; 2]> = triangles
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .filter(|&[a, b]| patch[a as usize] != patch[b as usize])
            .map(lower_first)
            .collect();
        crossed.sort_unstable();
        crossed.dedup();
        // Where each end would go, and how far that is.
        let mut place: FxHashMap<u32, (OnCurve, Sample, f64)> = FxHashMap::default();
        for &v in crossed.as_flattened() {
            let p = self.samples[v as usize].position;
            place.entry(v).or_insert_with(|| match domain.nearest_sharp_curve(p) {
                Some(curve) if !stay(v) => {
                    let on_curve = domain.project_on_curve(p, curve);
                    (OnCurve::Curve(curve), on_curve, on_curve.position.distance(p))
                }
                _ => (OnCurve::No, self.samples[v as usize], f64::INFINITY),
            });
        }
        let distance = |v: u32| place[&v].2;
        // The nearest ends go first, so that others can stay.
        let nearer = |[a, b]: [u32; 2]| if distance(a) <= distance(b) { a } else { b };
        crossed.sort_by(|&e, &f| distance(nearer(e)).total_cmp(&distance(nearer(f))));
        for ends in crossed {
            let v = nearer(ends);
            if ends.iter().all(|&v| !self.has_moved(v)) && distance(v) <= near {
                let (curve, sample, _) = place[&v];
                self.move_onto(v, curve, sample);
            }
        }
    }

    /// Finds the edges that run along sharp edges, and the vertices through which other than two of one curve run.
    fn find_edges(&mut self, domain: &Domain, triangles: &[[u32; 3]]) {
        let patch = |corners: [u32; 3]| {
            let own = corners.into_iter().find(|&v| !self.has_moved(v));
            let middle = || corners.map(|v| self.samples[v as usize].position).iter().sum::<DVec3>() / 3.0;
            domain.patch_of(
                own.map_or_else(|| domain.project_anywhere(middle()).triangle, |v| self.samples[v as usize].triangle),
            )
        };
        let mut sides: Vec<([u32; 2], u32)> = Vec::new();
        for &corners in triangles {
            let [a, b, c] = corners;
            let on_curves = [[a, b], [b, c], [c, a]].into_iter().filter(|e| e.iter().all(|&v| self.has_moved(v)));
            sides.extend(on_curves.map(|ends| (lower_first(ends), patch(corners))));
        }
        sides.sort_unstable();
        let mut of_vertex: FxHashMap<u32, Vec<OnCurve>> = FxHashMap::default();
        for pair in sides.windows(2).filter(|pair| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1) {
            let ends = pair[0].0;
            let own = ends.into_iter().map(|v| self.moved_onto[v as usize]).find(|&own| own != OnCurve::Corner);
            let middle = || 0.5 * ends.iter().map(|&v| self.samples[v as usize].position).sum::<DVec3>();
            let Some(own) = own.or_else(|| domain.nearest_sharp_curve(middle()).map(OnCurve::Curve)) else { continue };
            self.edges.push((ends, own));
            ends.iter().for_each(|&v| of_vertex.entry(v).or_default().push(own));
        }
        let goes_on = |v: u32| {
            let own = self.moved_onto[v as usize];
            of_vertex[&v].len() == 2 && of_vertex[&v].iter().all(|&curve| curve == own)
        };
        self.corners = of_vertex.keys().copied().filter(|&v| !goes_on(v)).collect();
        self.corners.sort_unstable();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::features::Features;
    use crate::testing::{cube, sheet};

    #[test]
    fn edges_run_along_a_ridge_and_vertices_that_stay_do_not_move() {
        let ridge = |x: f64, _: f64| -(x - 0.52).abs();
        let mut surface = sheet(50, ridge);
        surface.positions.iter_mut().for_each(|p| p.y = 1.4 * p.y - 0.2);
        let domain = Domain::with_features(surface.try_into().unwrap(), Features::Automatic, 0.1);
        let part = sheet(10, ridge);
        let on_surface = || part.positions.iter().map(|&p| domain.project_anywhere(p)).collect::<Vec<_>>();
        let stays = |v: u32| part.positions[v as usize].y == 0.0;
        let Conformed { samples, edges, moved_onto, .. } =
            Conformed::new(&domain, on_surface(), &part.triangles, stays, 0.1);
        let has_moved: Vec<bool> = moved_onto.into_iter().map(|curve| curve != OnCurve::No).collect();
        let moved: Vec<usize> = (0..samples.len()).filter(|&v| has_moved[v]).collect();
        assert!(moved.iter().all(|&v| (samples[v].position.x - 0.52).abs() < 1e-9 && part.positions[v].y > 0.0));
        // One row of vertices, but for the one that stays.
        assert_eq!((moved.len(), edges.len()), (10, 9));
        assert!(on_surface().iter().zip(&samples).zip(&has_moved).all(|((old, new), moved)| *moved || old == new));
    }

    #[test]
    fn a_vertex_moves_to_each_corner() {
        let domain = Domain::with_features(cube().try_into().unwrap(), Features::Automatic, 0.1);
        // Corners are cut off by a tenth.
        let positions = cube().positions.into_iter().map(|p| p.lerp(DVec3::splat(0.5), 0.1));
        let samples: Vec<Sample> = positions.map(|p| domain.project_anywhere(p)).collect();
        let all = Conformed::new(&domain, samples, &cube().triangles, |_| false, 1.0);
        assert!(
            all.samples.iter().zip(cube().positions).all(|(sample, corner)| sample.position.distance(corner) < 1e-9)
        );
        assert_eq!(all.corners.len(), 8);
    }
}
