//! A mesh that comes in parts, and may be no manifold: each part is repaired by itself, as far as its edges collapse.
//!
//! Where sheets cross or meet, a repair of the part decides which faces belong together; what is left is to be repaired as a
//! whole like any input. Vertices at the bounds of a part stay, also those between its pieces, so there is to be a second turn
//! with other bounds.
//!
//! Memory: the parts that are treated at once, and what is left of all.

use crate::geom::aabb::Aabb;
use crate::mesh::triangle_mesh::Mesh;
use crate::prepare::coarsen::block::{BLOCK, Block, Coarseness, MARGIN, numbered_apart, order_of_triangles};
use crate::prepare::repair::repair;
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

/// Some triangles of a mesh.
#[derive(Debug, Clone, Default)]
pub struct Part {
    /// The triangles, over vertices of their own.
    pub mesh: Mesh,
    /// For each vertex its number in the whole.
    pub numbers: Vec<u32>,
    /// For each vertex how far those that went into it may be from the surface.
    strayed: Vec<f64>,
}

impl Part {
    /// These triangles of a mesh, whose vertices are at `place`.
    pub fn new(triangles: &[[u32; 3]], place: impl Fn(u32) -> DVec3) -> Part {
        let (triangles, numbers) = numbered_apart(triangles.iter().copied());
        let positions: Vec<DVec3> = numbers.iter().map(|&v| place(v)).collect();
        let strayed = vec![0.0; positions.len()];
        Part { mesh: Mesh { positions, triangles }, numbers, strayed }
    }

    /// The part with longer edges.
    #[must_use]
    pub fn coarsened(&self, coarseness: Coarseness) -> Part {
        self.mesh.bounds().map_or_else(Part::default, |bounds| self.coarsened_in(bounds, coarseness))
    }

    /// What is left of a mesh whose parts are [`coarsened`](Part::coarsened), once the edges where these meet are longer, too.
    #[must_use]
    pub fn joined(parts: &[Part], coarseness: Coarseness) -> Part {
        let whole = Part::sum(parts);
        let Some(mut bounds) = whole.mesh.bounds() else { return whole };
        bounds.lo -= MARGIN * bounds.size();
        whole.coarsened_in(bounds, coarseness)
    }

    /// The same with vertices in the order of their numbers.
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

    /// How far what went is from what is left, about and at most.
    pub fn farthest_strayed(&self) -> f64 {
        self.strayed.iter().copied().fold(0.0, f64::max)
    }

    /// Treats pieces that are near in space, as cuts of these bounds say.
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
        Part::sum(&order.par_chunks(BLOCK).map(piece).collect::<Vec<_>>())
    }

    fn coarsened_at_once(&self, coarseness: Coarseness) -> Part {
        let (manifold, _) = repair(&self.mesh);
        let provenance = manifold.provenance();
        let source = |v: usize| provenance.vertex(v as u32).expect("a repair inserts no vertices") as usize;
        let sources: Vec<usize> = (0..manifold.positions.len()).map(source).collect();
        let strayed = sources.iter().map(|&v| self.strayed[v]).collect();
        let mut block = Block::new(manifold.into_mesh(), strayed);
        block.coarsen(coarseness);
        let left: Vec<[u32; 3]> = block.triangles().map(|t| block.corners(t)).collect();
        let (triangles, vertices) = numbered_apart(left.into_iter());
        Part {
            mesh: Mesh { positions: vertices.iter().map(|&v| block.position(v)).collect(), triangles },
            numbers: vertices.iter().map(|&v| self.numbers[sources[v as usize]]).collect(),
            strayed: vertices.iter().map(|&v| block.strayed(v)).collect(),
        }
    }

    /// All parts as one, in which vertices of the same number are one.
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
