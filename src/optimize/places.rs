//! Places of a mesh that change one by one: triangles and what is around them, disjoint, changed at the same time and put back.

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

/// Rings of triangles around a triangle that change with it.
const RINGS: usize = 2;

/// Rounds of relaxation, and passes of the search for angles, in which a place settles.
const ROUNDS: usize = 2;
const SEARCHES: usize = 3;

/// A side of a triangle and what is around the triangle.
pub(super) struct Place {
    side: u32,
    pub around: Neighborhood,
}

impl Place {
    /// The triangle, by its number in the whole.
    pub fn triangle(&self) -> u32 {
        self.side / 3
    }

    /// The number of the side in what is around it.
    pub fn own_side(&self) -> u32 {
        self.around.own_half_edge(self.side).expect("a place has its own side")
    }

    /// The sides of the triangle, and those beside it of the triangles across them.
    pub fn sides_near(&self) -> Vec<u32> {
        let c = &self.around.mesh.connectivity;
        let h = self.own_side();
        let own = [h, next(h), prev(h)];
        let beside = own.into_iter().filter(|&h| c.has_twin(h)).flat_map(|h| [next(c.twin(h)), prev(c.twin(h))]);
        own.into_iter().chain(beside).collect()
    }
}

/// The places of `sides` that share no triangle with one before, at most so many.
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

/// Puts those of `changed` that can be back in `mesh`, at most so many; how many were.
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
    /// Whether nothing helped at triangle `t`.
    pub fn has(&self, t: u32) -> bool {
        self.0.get(t as usize).is_some_and(|given_up| *given_up)
    }

    /// Gives up triangle `t`.
    pub fn add(&mut self, t: u32) {
        self.0.resize(self.0.len().max(t as usize + 1), false);
        self.0[t as usize] = true;
    }

    /// Changes `places` to what `better` makes of them, and gives up those of which it makes nothing until something changes near
    /// them; the triangles that have changed.
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
        // What has changed may have another way now.
        self.0.iter_mut().zip(&touched).for_each(|(given_up, touched)| *given_up &= !touched);
        Ok(touched)
    }
}

/// `around` with the edge of `h` split, if it can be.
pub(super) fn split(domain: &Domain, around: &Neighborhood, h: u32) -> Option<Neighborhood> {
    let c = &around.mesh.connectivity;
    // Not on the border to the rest, whose vertices are corners.
    let is_inside = c.has_twin(h) || !c.is_corner(c.origin(h)) || !c.is_corner(c.target(h));
    if !is_inside || !c.can_split(h) {
        return None;
    }
    let mut changed = around.clone();
    let v = changed.mesh.split_at_middle(domain, h)?;
    changed.mesh.make_delaunay_around(v);
    Some(changed)
}

/// `around` after its vertices have settled, with triangles as good as the `goal` if they can be. `spacing` is the mean edge length.
pub(super) fn settled(
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
