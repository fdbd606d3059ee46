//! Positions of the vertices of a large mesh.

use crate::geom::aabb::Aabb;
use glam::{DVec3, Vec3};

/// Positions in single precision while that is exact: twelve bytes each instead of 24.
pub(super) enum Places {
    Single(Vec<Vec3>),
    Double(Vec<DVec3>),
}

impl Places {
    pub fn with_capacity(count: usize) -> Places {
        Places::Single(Vec::with_capacity(count))
    }

    pub fn push(&mut self, p: DVec3) {
        match self {
            Places::Single(places) if p.as_vec3().as_dvec3() == p => places.push(p.as_vec3()),
            Places::Single(places) => {
                let mut all = Vec::with_capacity(places.capacity());
                all.extend(places.iter().map(|p| p.as_dvec3()));
                all.push(p);
                *self = Places::Double(all);
            }
            Places::Double(places) => places.push(p),
        }
    }

    #[inline]
    pub fn at(&self, v: u32) -> DVec3 {
        match self {
            Places::Single(places) => places[v as usize].as_dvec3(),
            Places::Double(places) => places[v as usize],
        }
    }

    pub fn len(&self) -> usize {
        match self {
            Places::Single(places) => places.len(),
            Places::Double(places) => places.len(),
        }
    }

    pub fn bounds(&self) -> Option<Aabb> {
        Aabb::of((0..self.len() as u32).map(|v| self.at(v)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    #[test]
    fn places_are_as_exact_as_they_came() {
        let mut places = Places::with_capacity(2);
        let [coarse, fine] = [dvec3(1.0, 0.5, 0.0), dvec3(0.1, 0.2, 0.3)];
        places.push(coarse);
        assert!(matches!(places, Places::Single(_)));
        places.push(fine);
        places.push(coarse);
        assert_eq!([0, 1, 2].map(|v| places.at(v)), [coarse, fine, coarse]);
        assert_eq!((places.len(), places.bounds().unwrap().lo), (3, dvec3(0.1, 0.2, 0.0)));
    }
}
