//! Classes of vertices that can move at the same time: no two of a class are adjacent.

use crate::base::parallel;
use crate::manifold::Manifold;
use crate::manifold::vertex_set::VertexSet;

/// The colour of a vertex that has none yet.
const UNCOLOURED: u8 = u8::MAX;

impl Manifold {
    /// Returns the vertices that can move and are not in `locked`, in classes without adjacent vertices, each in increasing
    /// order. Vertices keep the colours of earlier calls, except where two adjacent ones share a colour.
    pub fn colour_classes(&mut self, locked: &VertexSet) -> Vec<Vec<u32>> {
        self.update_colours();
        let mut classes: Vec<Vec<u32>> = Vec::new();
        for (v, &colour) in (0..).zip(&self.colours) {
            if !self.connectivity.has_vertex(v) || !self.can_move(v, locked) {
                continue;
            }
            if classes.len() <= colour as usize {
                classes.resize_with(colour as usize + 1, Vec::new);
            }
            classes[colour as usize].push(v);
        }
        classes
    }

    /// Gives the first free colour to new vertices and to one of any two adjacent vertices of the same colour.
    fn update_colours(&mut self) {
        let c = &self.connectivity;
        let new = self.colours.len() as u32..c.vertex_bound();
        self.colours.resize(new.end as usize, UNCOLOURED);
        let colours = &self.colours;
        let clash = |h: u32| {
            let (v, w) = (c.origin(h), c.target(h));
            (colours[v as usize] == colours[w as usize]).then_some(v.max(w))
        };
        let mut wrong: Vec<u32> =
            parallel::collect(0..c.half_edge_bound(), |sides| sides.filter(|&h| c.has_half_edge(h)).filter_map(clash));
        wrong.extend(new.filter(|&v| c.has_vertex(v)));
        wrong.sort_unstable();
        wrong.dedup();
        for v in wrong {
            let taken =
                c.ring(v).map(|w| self.colours[w as usize]).filter(|&k| k < 64).fold(0u64, |taken, k| taken | 1 << k);
            self.colours[v as usize] = taken.trailing_ones().min(63) as u8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manifold::tests::strip;

    #[test]
    fn neighbours_never_share_a_class_even_after_flips() {
        let mut mesh = strip(50, 0.8);
        for _ in 0..2 {
            let classes = mesh.colour_classes(&VertexSet::EMPTY);
            assert_eq!(classes.iter().map(Vec::len).sum::<usize>(), 100);
            for class in classes {
                assert!(class.iter().all(|&v| class.iter().all(|&w| !mesh.connectivity.are_adjacent(v, w))));
            }
            mesh.make_delaunay();
        }
    }
}
