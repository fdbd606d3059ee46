//! Coarsens a mesh that comes in parts and may not be a manifold: each part is repaired by itself, as far as its edges are
//! collapsed.
//!
//! Where sheets cross or meet, the repair of the part decides which faces belong together; the result must be repaired as a
//! whole, like any input. Vertices at the bounds of a part stay, and so do those between its pieces, so a second turn with
//! other bounds should follow.
//!
//! Memory: the parts that are processed at the same time, and the remains of all parts.

use crate::base::parallel;
use crate::geom::aabb::Aabb;
use crate::mesh::half_edge::next;
use crate::mesh::sides::{edges, pairs_of_sides, sorted_sides};
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::mesh::weld::place_key;
use crate::prepare::coarsen::block::{BLOCK, Block, Coarseness, MARGIN, numbered_apart, order_of_triangles};
use crate::prepare::repair::{Repaired, repair_welded};
use crate::prepare::welded::Welded;
use glam::DVec3;
use rustc_hash::FxHashMap;

/// Maximum number of remaining vertices, relative to the intended one: of a part, whose bounds stay, and of the whole.
const MOST_OF_PART: f64 = 2.0;
const MOST_OF_WHOLE: f64 = 1.3;

/// Some triangles of a mesh.
#[derive(Debug, Clone, Default)]
pub struct Part {
    /// The triangles, over vertices of their own.
    pub mesh: Mesh,
    /// For each vertex, its number in the whole mesh.
    pub numbers: Vec<u32>,
    /// For each vertex, how far the vertices merged into it may be from the surface.
    strayed: Vec<f64>,
}

impl Part {
    /// Makes a part of these triangles of a mesh; `place` gives the position of a vertex.
    pub fn new(triangles: &[[u32; 3]], place: impl Fn(u32) -> DVec3) -> Part {
        let (triangles, numbers) = numbered_apart(triangles.iter().copied());
        let positions: Vec<DVec3> = numbers.iter().map(|&v| place(v)).collect();
        let strayed = vec![0.0; positions.len()];
        Part { mesh: Mesh { positions, triangles }, numbers, strayed }
    }

    /// Returns the part with longer edges. Where noise keeps it from becoming coarser, so that it has far more vertices per
    /// area than `densest`, the tolerance is raised.
    #[must_use]
    pub fn coarsened(&self, coarseness: Coarseness, densest: f64) -> Part {
        let most = MOST_OF_PART * densest * self.mesh.area();
        self.mesh.bounds().map_or_else(Part::default, |bounds| self.coarsened_to(bounds, coarseness, most))
    }

    /// Joins the [`coarsened`](Part::coarsened) parts of a mesh, and lengthens the edges where they meet, too.
    #[must_use]
    pub fn joined(parts: &[Part], coarseness: Coarseness, densest: f64) -> Part {
        let whole = Part::sum(parts);
        let Some(mut bounds) = whole.mesh.bounds() else { return whole };
        bounds.lo -= MARGIN * bounds.size();
        whole.coarsened_to(bounds, coarseness, MOST_OF_WHOLE * densest * whole.mesh.area())
    }

    fn coarsened_to(&self, bounds: Aabb, mut coarseness: Coarseness, most: f64) -> Part {
        let mut coarse = self.coarsened_in(bounds, coarseness);
        while coarse.numbers.len() as f64 > most && coarseness.tolerance < coarseness.shortest {
            coarseness.tolerance *= 2.0;
            coarse = coarse.coarsened_in(bounds, coarseness);
        }
        coarse
    }

    /// Returns the part with its vertices in the order of their numbers.
    #[must_use]
    pub fn in_order(self) -> Part {
        let mut order: Vec<u32> = (0..self.numbers.len() as u32).collect();
        order.sort_unstable_by_key(|&v| self.numbers[v as usize]);
        let mut place = vec![0; order.len()];
        (0u32..).zip(&order).for_each(|(at, &v)| place[v as usize] = at);
        Part {
            mesh: Mesh {
                positions: order.iter().map(|&v| self.mesh.positions[v as usize]).collect(),
                triangles: self.mesh.triangles.iter().map(|t| t.map(|v| place[v as usize])).collect(),
            },
            numbers: order.iter().map(|&v| self.numbers[v as usize]).collect(),
            strayed: order.iter().map(|&v| self.strayed[v as usize]).collect(),
        }
    }

    /// Returns the approximate maximum distance of the removed vertices from the remaining surface.
    pub fn farthest_strayed(&self) -> f64 {
        self.strayed.iter().copied().fold(0.0, f64::max)
    }

    /// Coarsens the part in spatially compact pieces, cut from these bounds.
    fn coarsened_in(&self, bounds: Aabb, coarseness: Coarseness) -> Part {
        let order = order_of_triangles(&self.mesh, bounds);
        let piece = |triangles: &[u32]| {
            let (triangles, vertices) = numbered_apart(triangles.iter().map(|&t| self.mesh.triangles[t as usize]));
            let positions = vertices.iter().map(|&v| self.mesh.positions[v as usize]).collect();
            let part = Part {
                mesh: Mesh { positions, triangles },
                numbers: vertices.iter().map(|&v| self.numbers[v as usize]).collect(),
                strayed: vertices.iter().map(|&v| self.strayed[v as usize]).collect(),
            };
            part.coarsened_at_once(coarseness)
        };
        Part::sum(&parallel::blocks(&order[..], BLOCK, piece))
    }

    fn coarsened_at_once(&self, coarseness: Coarseness) -> Part {
        let (mesh, twin, sources) = self.manifold();
        let strayed = sources.iter().map(|&v| self.strayed[v as usize]).collect();
        let mut block = Block::new(mesh, twin, strayed);
        block.coarsen(coarseness);
        let left: Vec<[u32; 3]> = block.triangles().map(|t| block.corners(t)).collect();
        let (triangles, vertices) = numbered_apart(left.into_iter());
        Part {
            mesh: Mesh { positions: vertices.iter().map(|&v| block.position(v)).collect(), triangles },
            numbers: vertices.iter().map(|&v| self.numbers[sources[v as usize] as usize]).collect(),
            strayed: vertices.iter().map(|&v| block.strayed(v)).collect(),
        }
    }

    /// Returns the part as an oriented manifold, whose boundary vertices may have several fans, its twins, and for each of
    /// its vertices the one of the part that it comes from.
    fn manifold(&self) -> (Mesh, Vec<u32>, Vec<u32>) {
        if let Some(twin) = self.twins_if_sound() {
            return (self.mesh.clone(), twin, (0..self.numbers.len() as u32).collect());
        }
        let Repaired { mesh, twins, .. } = repair_welded(self.mesh.positions.clone(), Welded::at_places(&self.mesh));
        let provenance = mesh.provenance();
        let source = |v: usize| provenance.vertex(v as u32).expect("a repair inserts no vertices");
        let sources = (0..mesh.positions.len()).map(source).collect();
        (mesh.into_mesh(), twins, sources)
    }

    /// Returns the twins of the triangles if there is nothing to repair, which is much faster to find out than to repair.
    fn twins_if_sound(&self) -> Option<Vec<u32>> {
        let Mesh { positions, triangles } = &self.mesh;
        let sides = sorted_sides(triangles);
        let mut open = Vec::new();
        for edge in edges(&sides) {
            match edge {
                [one] => open.extend(one.ends()),
                [one, other] if one.forward() != other.forward() => {}
                _ => return None,
            }
        }
        open.sort_unstable();
        open.dedup();
        // Where the surface is open, it may just be unwelded.
        let mut places: Vec<[u64; 3]> = open.iter().map(|&v| place_key(positions[v as usize])).collect();
        places.sort_unstable();
        let is_welded = places.windows(2).all(|two| two[0] != two[1]);
        let twin = pairs_of_sides(&sides, 3 * triangles.len(), |_, _| true);
        let is_sound = sides.len() == 3 * triangles.len()
            && is_welded
            && has_single_fans(positions.len(), triangles, &twin, &open);
        is_sound.then_some(twin)
    }

    /// Merges all parts into one, in which vertices with the same number are one.
    fn sum(parts: &[Part]) -> Part {
        let mut sum = Part::default();
        let mut places: FxHashMap<u32, u32> = FxHashMap::default();
        for part in parts {
            let local = part.numbers.iter().zip(&part.mesh.positions).zip(&part.strayed);
            let joined: Vec<u32> = local
                .map(|((&number, &position), &strayed)| {
                    let v = *places.entry(number).or_insert_with(|| {
                        sum.numbers.push(number);
                        sum.mesh.positions.push(position);
                        sum.strayed.push(0.0);
                        sum.numbers.len() as u32 - 1
                    });
                    let farthest = &mut sum.strayed[v as usize];
                    *farthest = strayed.max(*farthest);
                    v
                })
                .collect();
            sum.mesh.triangles.extend(part.mesh.triangles.iter().map(|t| t.map(|v| joined[v as usize])));
        }
        sum
    }
}

/// Returns whether each of the vertices, except the `open` ones, has a single closed fan of triangles.
fn has_single_fans(vertices: usize, triangles: &[[u32; 3]], twin: &[u32], open: &[u32]) -> bool {
    let mut first = vec![NONE; vertices];
    let mut corners = vec![0u32; vertices];
    for (corner, &v) in (0u32..).zip(triangles.as_flattened()) {
        first[v as usize] = corner;
        corners[v as usize] += 1;
    }
    open.iter().for_each(|&v| corners[v as usize] = 0);
    let around = |first: u32| {
        let mut at = next(twin[first as usize]);
        let mut count = 1;
        while at != first {
            at = next(twin[at as usize]);
            count += 1;
        }
        count
    };
    first.into_iter().zip(corners).all(|(first, count)| count == 0 || around(first) == count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;
    use crate::testing::{cube, sphere};

    fn part(mesh: &Mesh) -> Part {
        Part::new(&mesh.triangles, |v| mesh.positions[v as usize])
    }

    #[test]
    fn only_what_is_sound_is_not_repaired() {
        let sphere = sphere();
        assert!(part(&sphere).twins_if_sound().is_some());
        let with = |change: &dyn Fn(&mut Mesh)| {
            let mut mesh = sphere.clone();
            change(&mut mesh);
            part(&mesh)
        };
        // A hole; a triangle turned over; a duplicate triangle; one that has a corner twice; a seam that is not welded.
        assert!(with(&|mesh| mesh.triangles.truncate(4000)).twins_if_sound().is_some());
        assert!(with(&|mesh| mesh.triangles[7].swap(0, 1)).twins_if_sound().is_none());
        assert!(with(&|mesh| mesh.triangles.push(mesh.triangles[7])).twins_if_sound().is_none());
        assert!(with(&|mesh| mesh.triangles.push([1, 1, 2])).twins_if_sound().is_none());
        let seam = |mesh: &mut Mesh| {
            mesh.positions.push(mesh.positions[mesh.triangles[7][0] as usize]);
            mesh.triangles[7][0] = mesh.positions.len() as u32 - 1;
        };
        assert!(with(&seam).twins_if_sound().is_none());
        // Two cubes that share a vertex.
        let mut cubes = cube();
        let second = cubes.triangles.iter().map(|t| t.map(|v| if v == 0 { 0 } else { v + 7 })).collect::<Vec<_>>();
        let others: Vec<DVec3> = cubes.positions[1..].iter().map(|p| -*p).collect();
        cubes.positions.extend(others);
        cubes.triangles.extend(second.iter().map(|&[a, b, c]| [a, c, b]));
        assert!(part(&cubes).twins_if_sound().is_none());
        let kind = |mesh: &Mesh| {
            let t = topology(mesh.positions.len(), &mesh.triangles);
            (t.euler, t.components, t.is_manifold())
        };
        assert_eq!(kind(&part(&cubes).manifold().0), (4, 2, true));
    }
}
