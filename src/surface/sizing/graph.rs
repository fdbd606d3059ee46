//! Neighbours of the vertices of a domain, and random walks between them.

use crate::base::csr::Csr;
use crate::base::parallel;
use crate::mesh::topology::NONE;
use crate::surface::domain::Domain;
use rayon::slice::ParallelSliceMut;

/// Neighbours of each vertex.
pub(super) struct Graph(Csr<u32>);

impl Graph {
    /// Connects the vertices of a domain within its smooth patches.
    pub fn of_patches(domain: &Domain) -> Graph {
        Graph::new(domain, |v| v, |side| domain.twin[side] == NONE)
    }

    /// Connects the vertices of a domain as they were before the cut along sharp edges; their further copies have no
    /// neighbours.
    pub fn whole(domain: &Domain) -> Graph {
        let on_boundary = |side: usize| domain.twin[side] == NONE && domain.across.get(side as u32) == NONE;
        Graph::new(domain, |v| domain.original[v as usize], on_boundary)
    }

    /// Each side makes its end a neighbour of its start and, if it has no opposite side, also the reverse.
    fn new(domain: &Domain, name: impl Fn(u32) -> u32, on_boundary: impl Fn(usize) -> bool) -> Graph {
        let ends = |side: u32| domain.mesh.ends(side).map(&name);
        let sides = 0..domain.twin.len() as u32;
        let mut pairs: Vec<(u32, u32)> = sides.clone().map(|s| ends(s).into()).collect();
        pairs.extend(sides.filter(|&s| on_boundary(s as usize)).map(ends).map(|[from, to]| (to, from)));
        pairs.par_sort_unstable();
        Graph(Csr::new(domain.mesh.positions.len(), || pairs.iter().copied()))
    }

    pub fn of(&self, v: u32) -> &[u32] {
        self.0.row(v)
    }

    /// Returns the distribution after `steps` steps of random walks, which move to a neighbour or stay.
    pub fn spread<const K: usize>(&self, mut amounts: Vec<[f64; K]>, steps: usize) -> Vec<[f64; K]> {
        let share = |v: u32| 1.0 / (1 + self.of(v).len()) as f64;
        for _ in 0..steps {
            let arriving = |v: u32| {
                let mut sum = [0.0; K];
                for &w in self.of(v).iter().chain([&v]) {
                    (0..K).for_each(|k| sum[k] += share(w) * amounts[w as usize][k]);
                }
                sum
            };
            amounts = parallel::map(0..amounts.len() as u32, arriving);
        }
        amounts
    }
}
