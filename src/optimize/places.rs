//! Places of a mesh: disjoint triangles with their surroundings, which are changed at the same time and put back.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::base::parallel;
use crate::manifold::Manifold;
use crate::manifold::neighborhood::Neighborhood;
use crate::mesh::half_edge::{next, prev};
use crate::optimize::angles::{Goal, improve_angles_for};
use crate::optimize::coarse_to_fine::tips;
use crate::optimize::relax::{Flips, relax};
use crate::surface::domain::Domain;

/// Number of rings of triangles around a triangle that change with it.
const RINGS: usize = 2;

/// Rounds of relaxation, and passes of the search for better angles, at a place.
const ROUNDS: usize = 2;
const SEARCHES: usize = 3;

/// A side of a triangle, and the surroundings of the triangle.
pub(super) struct Place {
    side: u32,
    pub around: Neighborhood,
}

impl Place {
    /// Returns the number of the triangle in the whole mesh.
    pub fn triangle(&self) -> u32 {
        self.side / 3
    }

    /// Returns the number of the side in `around`.
    pub fn own_side(&self) -> u32 {
        self.around.own_half_edge(self.side).expect("a place has its own side")
    }

    /// Returns the sides of the triangle, and the other sides of the triangles adjacent to it.
    pub fn sides_near(&self) -> Vec<u32> {
        let c = &self.around.mesh.connectivity;
        let h = self.own_side();
        let own = [h, next(h), prev(h)];
        let beside = own.into_iter().filter(|&h| c.has_twin(h)).flat_map(|h| [next(c.twin(h)), prev(c.twin(h))]);
        own.into_iter().chain(beside).collect()
    }
}

/// Returns the places of `sides` that share no triangle with an earlier one, at most `most`.
pub(super) fn disjoint(mesh: &Manifold, sides: &[u32], most: usize) -> Vec<Place> {
    let mut taken = vec![false; triangle_bound(mesh)];
    let free = sides.iter().filter_map(|&side| {
        if taken[side as usize / 3] {
            return None;
        }
        let around = Neighborhood::across_curves(mesh, side / 3, RINGS, |t| taken[t as usize])?;
        around.triangles().iter().for_each(|&t| taken[t as usize] = true);
        Some(Place { side, around })
    });
    free.take(most).collect()
}

/// Puts those of `changed` that can be back into `mesh`, at most `most`; returns how many were.
pub(super) fn put_back<'a>(
    mesh: &mut Manifold,
    changed: impl IntoIterator<Item = &'a Neighborhood>,
    most: usize,
) -> usize {
    let mut touched = vec![false; triangle_bound(mesh)];
    changed.into_iter().filter(|changed| changed.put_back(mesh, &mut touched)).take(most).count()
}

/// The triangles at whose places nothing helped.
#[derive(Default)]
pub(super) struct GivenUp(Vec<bool>);

impl GivenUp {
    /// Returns whether nothing helped at triangle `t`.
    pub fn has(&self, t: u32) -> bool {
        self.0.get(t as usize).is_some_and(|given_up| *given_up)
    }

    /// Gives up triangle `t`.
    pub fn add(&mut self, t: u32) {
        self.0.resize(self.0.len().max(t as usize + 1), false);
        self.0[t as usize] = true;
    }

    /// Replaces each of `places` by what `better` returns for it. Places for which it returns nothing are given up until
    /// something changes near them. Returns which triangles changed.
    pub fn change(
        &mut self,
        mesh: &mut Manifold,
        places: &[Place],
        better: impl Fn(&Place) -> Result<Option<Neighborhood>> + Sync,
    ) -> Result<Vec<bool>> {
        let changed = parallel::each(places, better);
        let changed: Vec<Option<Neighborhood>> = changed.into_iter().collect::<Result<_>>()?;
        let mut touched = vec![false; triangle_bound(mesh)];
        self.0.resize(touched.len(), false);
        for (place, changed) in places.iter().zip(changed) {
            let is_better = changed.is_some_and(|changed| changed.put_back(mesh, &mut touched));
            self.0[place.triangle() as usize] |= !is_better;
        }
        // Triangles that changed may be improved in another way now.
        self.0.iter_mut().zip(&touched).for_each(|(given_up, touched)| *given_up &= !touched);
        Ok(touched)
    }
}

/// Returns `around` with the edge of `h` split, if it can be.
pub(super) fn split(domain: &Domain, around: &Neighborhood, h: u32) -> Option<Neighborhood> {
    let c = &around.mesh.connectivity;
    // Edges on the border to the rest, whose vertices are corners, must stay.
    let is_inside = c.has_twin(h) || !c.is_corner(c.origin(h)) || !c.is_corner(c.target(h));
    if !is_inside || !c.can_split(h) {
        return None;
    }
    let mut changed = around.clone();
    let v = changed.mesh.split_at_middle(domain, h)?;
    changed.mesh.make_delaunay_around(v);
    Some(changed)
}

/// Relaxes `around` and brings its triangles to the `goal` as far as possible. `spacing` is the mean edge length.
pub(super) fn relaxed(
    domain: &Domain,
    mut around: Neighborhood,
    goal: Goal,
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<Neighborhood> {
    let mesh = &mut around.mesh;
    let locked = tips(mesh);
    relax(domain, mesh, &locked, spacing, Flips::Delaunay, ROUNDS, monitor)?;
    improve_angles_for(domain, mesh, &locked, goal, spacing, SEARCHES, monitor)?;
    Ok(around)
}

fn triangle_bound(mesh: &Manifold) -> usize {
    mesh.connectivity.half_edge_bound() as usize / 3
}
