//! The shape of a hierarchy, and the order and the boxes that a build gives it.

use crate::base::parallel;
use crate::geom::aabb::Aabb;
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;
use std::ops::Range;

/// Maximum number of triangles in a leaf. Fewer mean more box tests, more mean more triangle tests.
const LEAF: usize = 4;

/// Subtrees with fewer triangles are sorted by one thread: distributing them would cost as much as sorting them.
const PARALLEL_ABOVE: usize = 4096;

/// A triangle during the build.
#[derive(Clone, Copy)]
pub(super) struct Item {
    /// Three times the centroid.
    pub place: DVec3,
    pub triangle: u32,
}

/// The shape of a hierarchy, which depends only on the number of triangles.
#[derive(Clone, Copy)]
pub(super) struct Tree {
    pub count: usize,
    /// Level of the leaves.
    pub depth: u32,
}

impl Tree {
    /// The shape for `count` triangles.
    pub fn new(count: usize) -> Tree {
        Tree { count, depth: count.div_ceil(LEAF).next_power_of_two().trailing_zeros() }
    }

    /// The range of the order that the node at `place` of `level` holds.
    #[inline]
    pub fn range(self, level: u32, place: usize) -> Range<usize> {
        let start = |place: usize| ((place as u64 * self.count as u64) >> level) as usize;
        start(place)..start(place + 1)
    }

    /// Arranges the items of a node in leaf order.
    pub fn arrange(self, items: &mut [Item], level: u32, place: usize) {
        if level == self.depth {
            return;
        }
        let left = self.range(level + 1, 2 * place).len();
        let axis = widest_axis(items);
        items.select_nth_unstable_by(left, |a, b| {
            a.place[axis].total_cmp(&b.place[axis]).then(a.triangle.cmp(&b.triangle))
        });
        let (lower, upper) = items.split_at_mut(left);
        if self.count >> level > PARALLEL_ABOVE {
            rayon::join(|| self.arrange(lower, level + 1, 2 * place), || self.arrange(upper, level + 1, 2 * place + 1));
        } else {
            self.arrange(lower, level + 1, 2 * place);
            self.arrange(upper, level + 1, 2 * place + 1);
        }
    }

    /// Computes the boxes of all nodes: those of the leaves from the triangles, those of each level above from the level
    /// below.
    pub fn boxes(self, mesh: &Mesh, order: &[u32]) -> Vec<Aabb> {
        let mut boxes = vec![Aabb::EMPTY; (2 << self.depth) - 1];
        let leaves = &mut boxes[(1 << self.depth) - 1..];
        parallel::for_each_mut(leaves, |place, leaf| {
            let triangles = &order[self.range(self.depth, place)];
            *leaf = triangles.iter().fold(Aabb::EMPTY, |all, &t| all.join(&box_of(mesh, t)));
        });
        for level in (0..self.depth).rev() {
            let (above, below) = boxes.split_at_mut((2 << level) - 1);
            let parents = &mut above[(1 << level) - 1..];
            for (parent, pair) in parents.iter_mut().zip(below.chunks_exact(2)) {
                *parent = pair[0].join(&pair[1]);
            }
        }
        boxes
    }
}

/// Returns the axis along which the items have the largest spread.
fn widest_axis(items: &[Item]) -> usize {
    let spread = items.iter().fold(Aabb::EMPTY, |all, item| all.join(&Aabb::at(item.place)));
    let size = spread.size();
    if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    }
}

pub(super) fn box_of(mesh: &Mesh, t: u32) -> Aabb {
    Aabb::of_triangle(mesh.corners(t as usize))
}
