//! The neighbours of a sample within its own smooth patch: from a k-d tree for a patch with many samples, and from all
//! samples of one with few. On a surface in very many small pieces, most samples around a place are on other patches.
//!
//! Cost: n log n to build; a query is linear in its results, or in `FEW`.

use crate::base::csr::Csr;
use crate::spatial::kdtree::{Neighbor, Neighbors};
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;

/// Number of samples in a patch up to which looking at all of them is as good as a tree.
const FEW: usize = 32;

/// Samples grouped by patch.
pub(super) struct NeighborsOfPatch<'a> {
    samples: &'a [Sample],
    /// The samples of each patch.
    of_patch: Csr<u32>,
    /// Trees of the patches with more than a few samples.
    trees: Vec<Option<Neighbors>>,
}

impl<'a> NeighborsOfPatch<'a> {
    pub(super) fn new(domain: &Domain, samples: &'a [Sample]) -> Self {
        let patches = domain.patch_count();
        let of_patch = Csr::new(patches, || samples.iter().map(|s| domain.patch_of(s.triangle)).zip(0u32..));
        let tree = |patch: u32| {
            let own = of_patch.row(patch);
            let positions = || own.iter().map(|&s| samples[s as usize].position).collect::<Vec<DVec3>>();
            (own.len() > FEW).then(|| Neighbors::new(&positions()))
        };
        let trees = (0..patches as u32).map(tree).collect();
        NeighborsOfPatch { samples, of_patch, trees }
    }

    /// Collects the samples of `patch` within `radius` of `p` into `found`, in arbitrary order.
    pub(super) fn collect_within(&self, patch: u32, p: DVec3, radius: f64, found: &mut Vec<Neighbor>) {
        let own = self.of_patch.row(patch);
        if let Some(tree) = &self.trees[patch as usize] {
            tree.collect_within(p, radius, found);
            found.iter_mut().for_each(|n| n.point = own[n.point as usize]);
            return;
        }
        let all = own.iter().map(|&s| {
            let distance_squared = self.samples[s as usize].position.distance_squared(p);
            Neighbor { point: s, distance_squared }
        });
        found.clear();
        found.extend(all.filter(|n| n.distance_squared <= radius * radius));
    }
}
