//! Separates coincident vertices, where bodies touch at a corner or an edge: a program that welds the result would join the
//! bodies there.
//!
//! Of the vertices at one position, all but one step a tiny distance along their longest edge, which keeps them on the
//! surface.
//!
//! Cost: a sort of the vertices.

use crate::manifold::Manifold;
use crate::mesh::weld::representatives;
use glam::DVec3;
use std::collections::BTreeMap;

/// Step of a vertex, in lengths of its longest edge. Each further vertex at the same position steps farther by this amount.
const STEP: f64 = 1e-3;

/// Longest step: if very many bodies touch at one position, not all are separated.
const LONGEST: f64 = 0.05;

/// Separates vertices whose positions coincide once `rounded`, except those on an interface.
pub fn part_contacts(mesh: &mut Manifold, rounded: impl Fn(DVec3) -> DVec3) {
    let (_, vertices) = mesh.connectivity.compact();
    let places: Vec<DVec3> = vertices.iter().map(|&v| rounded(mesh.position(v))).collect();
    let mut steps: BTreeMap<u32, f64> = BTreeMap::new();
    for ((place, first), &v) in (0u32..).zip(representatives(&places)).zip(&vertices) {
        if place == first || mesh.connectivity.is_on_interface(v) {
            continue;
        }
        let step = steps.entry(first).or_default();
        *step = (*step + STEP).min(LONGEST);
        let here = mesh.position(v);
        let way = |w: u32| mesh.position(w) - here;
        let ways = mesh.connectivity.ring(v).map(way);
        let longest = ways.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or_default();
        mesh.place_at(v, here + *step * longest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::domain::Sample;
    use glam::dvec3;

    #[test]
    fn bodies_that_touch_at_an_edge_have_vertices_of_their_own_places() {
        let corners = [[0., 0., 0.], [0., 0., 1.], [1., 0., 0.], [0., 0., 0.], [0., 0., 1.], [-2., 0., 0.]];
        let sample = |p: [f64; 3]| Sample { position: p.into(), normal: DVec3::Y, triangle: 0, size: 1.0 };
        let mut mesh = Manifold::new(corners.map(sample).to_vec(), &[[0, 1, 2], [3, 5, 4]]);
        part_contacts(&mut mesh, |p| p.as_vec3().as_dvec3());
        let places: Vec<DVec3> = (0..6).map(|v| mesh.position(v)).collect();
        assert_eq!(places[..3], corners.map(DVec3::from)[..3]);
        assert_eq!(places[3], dvec3(-0.002, 0.0, 0.0));
        assert!(places[4].distance(places[1]) > 1e-3 && places[4].distance(places[1]) < 0.003);
        assert_eq!(places[5], DVec3::from(corners[5]));
        assert_eq!(representatives(&places), [0, 1, 2, 3, 4, 5]);
    }
}
