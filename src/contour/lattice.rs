//! Triangulates the zero set of a function, by marching tetrahedra on a lattice near it.
//!
//! The tetrahedra are the Delaunay tetrahedra of the body-centred cubic lattice: all congruent, and as close to regular as
//! space-filling tetrahedra can be. With the basis b₁ = (-1, 1, 1) / 2, b₂ = (1, -1, 1) / 2, b₃ = (1, 1, -1) / 2 they are
//! the Kuhn split of the unit cell into six: each has the corners v, v + bᵢ, v + bᵢ + bⱼ, v + b₁ + b₂ + b₃ for an order i,
//! j, k of the axes. So an edge leads from v to v plus a nonempty set of axes, represented by a three-bit mask, and the
//! vertices of a tetrahedron form a chain of such sets.
//!
//! A tetrahedron with both signs at its corners has one or two triangles between the zero crossings of its edges. Neighbours
//! share these crossings, so the result is an oriented manifold by construction, with a boundary where values are missing.
//! Zero counts as positive, and crossings keep away from corners, so no triangle is degenerate.
//!
//! Only vertices near the surface get a value. Starting from seeds on the surface, the vertices of the tetrahedra around
//! each edge that crosses zero are added wave by wave. They are kept sorted by their keys.
//!
//! Based on: A. Doi, A. Koide, An efficient method of triangulating equi-valued surfaces by using tetrahedral cells, IEICE
//! Transactions E74 (1), 1991; the lattice for it: S. L. Chan, E. O. Purisima, A new tetrahedral tesselation scheme for
//! isosurface generation, Computers & Graphics 22 (1), 1998, DOI 10.1016/S0097-8493(97)00085-X; the split: H. W. Kuhn, Some
//! combinatorial lemmas in topology, 1960, DOI 10.1147/rd.45.0518.
//!
//! Cost: one value for each lattice vertex of a tetrahedron that the surface crosses, about four per square of an edge
//! length, with some thirty searches each; [`BYTES_PER_VERTEX`] each.
//!
//! Limits: features smaller than a tetrahedron may be missed, and triangles have all shapes.

use crate::base::error::{Error, Result, Setting};
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::geom::aabb::Aabb;
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;
use rayon::slice::ParallelSliceMut;

/// Maximum memory per lattice vertex, including its share of the triangles and of working space, as measured.
pub const BYTES_PER_VERTEX: usize = 500;

/// Number of places along each axis of the lattice: three coordinates fit into a 64-bit key.
const PLACES: f64 = (1u64 << 21) as f64;

/// Number of vertices beside the seeds for which there must be room.
const MARGIN: f64 = 4.0;

/// Minimum distance of a crossing from the ends of its edge, as a share of the edge.
const NEAREST_CROSSING: f64 = 1e-3;

/// All axes: the main diagonal of a cell.
const ALL: u32 = 7;

/// The axes in each order, as the chains of sets that are the corners of a tetrahedron, and whether its orientation is
/// positive.
const CHAINS: [([u32; 4], bool); 6] = [
    ([0, 1, 3, 7], true),
    ([0, 2, 6, 7], true),
    ([0, 4, 5, 7], true),
    ([0, 2, 3, 7], false),
    ([0, 4, 6, 7], false),
    ([0, 1, 5, 7], false),
];

/// A body-centred cubic lattice that covers the surroundings of some points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    origin: DVec3,
    edge: f64,
}

impl Lattice {
    /// Creates the lattice of cubes of side `edge` that extends `reach` beyond `points`; `None` if it has more places than
    /// can be numbered.
    pub fn around(points: &[DVec3], reach: f64, edge: f64) -> Option<Lattice> {
        let bounds = Aabb::of(points.iter().copied()).unwrap_or_default();
        let margin = reach + MARGIN * edge;
        let longest = bounds.size().max_element() + 2.0 * margin;
        // Each lattice coordinate is the sum of two spatial ones.
        (2.0 * longest / edge < PLACES).then_some(Lattice { origin: bounds.lo - margin, edge })
    }

    /// Side length of its cubes.
    pub fn edge(&self) -> f64 {
        self.edge
    }

    /// Position of a vertex.
    fn place(&self, key: u64) -> DVec3 {
        let [i, j, k] = [42, 21, 0].map(|shift| (key >> shift & ((1 << 21) - 1)) as f64);
        self.origin + 0.5 * self.edge * DVec3::new(j + k - i, k + i - j, i + j - k)
    }

    /// Evaluates the vertices block by block.
    fn values(&self, keys: &[u64], field: &impl Field) -> Band {
        let mut order: Vec<u64> = keys.to_vec();
        order.par_sort_unstable_by_key(|&key| (key & BLOCKS, key));
        let blocks = order.chunk_by(|a, b| a & BLOCKS == b & BLOCKS);
        let of_block = |block: &[u64]| {
            let corner = block[0] & BLOCKS;
            let middle = 0.5 * (self.place(corner) + self.place(corner | !BLOCKS));
            let mut local = field.local(middle, BLOCK_RADIUS * self.edge);
            let value = |&key: &u64| (key, field.value(&mut local, self.place(key)).unwrap_or(f64::NAN));
            block.iter().map(value).collect::<Vec<(u64, f64)>>()
        };
        let mut found = parallel::each(blocks, of_block).concat();
        found.par_sort_unstable_by_key(|f| f.0);
        let (keys, values) = found.into_iter().unzip();
        Band { keys, values }
    }

    /// Returns the first corner of the cell that contains `x`.
    fn cell(&self, x: DVec3) -> u64 {
        let p = (x - self.origin) / self.edge;
        let key = |coordinate: f64| coordinate.floor() as u64;
        key(p.y + p.z) << 42 | key(p.z + p.x) << 21 | key(p.x + p.y)
    }
}

/// Difference between the key of a vertex and that of the vertex beyond a set of axes.
const fn way(axes: u32) -> u64 {
    (axes as u64 & 1) << 42 | (axes as u64 >> 1 & 1) << 21 | axes as u64 >> 2
}

/// A function of space.
pub trait Field: Sync {
    /// Data shared by the values in a ball.
    type Local;

    /// Collects the data shared by the values within `radius` of `centre`.
    fn local(&self, centre: DVec3, radius: f64) -> Self::Local;

    /// Returns the value at `x`, within the ball of `local`; `None` if there is none.
    fn value(&self, local: &mut Self::Local, x: DVec3) -> Option<f64>;
}

/// Number of low bits of a coordinate within a block of vertices, which are evaluated together; the mask of the other bits
/// in a key; and the largest distance of its vertices from its centre in edge lengths: 3/2 (b₁ + b₂ - b₃).
const BLOCK_BITS: u64 = 2;
const BLOCKS: u64 = !(((1 << BLOCK_BITS) - 1) * way(ALL));
const BLOCK_RADIUS: f64 = 2.5;

/// Lattice vertices with their values.
#[derive(Default)]
struct Band {
    /// In ascending order.
    keys: Vec<u64>,
    /// NaN where there is none.
    values: Vec<f64>,
}

/// Returns the triangles where `field` is zero, counter-clockwise seen from where it is positive. They cover all of the
/// surface that is connected to the cells of `seeds` through places with values.
///
/// # Errors
/// [`Error::Option`] if that takes more than `most` lattice vertices; [`Error::Cancelled`] if the monitor asks for it.
pub fn contour(
    lattice: &Lattice,
    seeds: &[DVec3],
    field: &impl Field,
    most: usize,
    monitor: &dyn Monitor,
) -> Result<Mesh> {
    let mut band = Band::default();
    let mut new = parallel::map(seeds, |&x| lattice.cell(x));
    sort_and_dedup(&mut new);
    new = new.into_iter().flat_map(|cell| (0..=ALL).map(move |axes| cell + way(axes))).collect();
    sort_and_dedup(&mut new);
    while !new.is_empty() {
        if band.keys.len() + new.len() > most {
            return Err(too_many(most));
        }
        check(monitor)?;
        band.merge(lattice.values(&new, field));
        new = band.next_wave(&new);
    }
    check(monitor)?;
    Ok(band.triangulate(lattice))
}

fn too_many(most: usize) -> Error {
    Error::Option {
        option: Setting::Resolution,
        cause: format!("the cells near the surface have more than {most} corners"),
        remedy: "give a larger length".into(),
    }
}

fn sort_and_dedup(keys: &mut Vec<u64>) {
    keys.par_sort_unstable();
    keys.dedup();
}

/// Returns the other corners of the tetrahedra around the edge from `start` along `axes`.
fn around_edge(start: u64, axes: u32) -> impl Iterator<Item = u64> {
    let end = start + way(axes);
    let between = (1..ALL).filter(move |&s| s & axes == s && s != axes).map(move |s| start + way(s));
    let beyond = (1..=ALL).filter(move |&s| s & axes == axes && s != axes);
    between.chain(beyond.flat_map(move |s| [start + way(s), end - way(s)]))
}

impl Band {
    fn find(&self, key: u64) -> Option<usize> {
        self.keys.binary_search(&key).ok()
    }

    fn value(&self, key: u64) -> f64 {
        self.find(key).map_or(f64::NAN, |i| self.values[i])
    }

    /// Adds the vertices of `other`, none of which is present yet.
    fn merge(&mut self, other: Band) {
        let count = self.keys.len() + other.keys.len();
        let (mut keys, mut values) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut others = other.keys.into_iter().zip(other.values).peekable();
        for (&key, &value) in self.keys.iter().zip(&self.values) {
            while let Some((k, v)) = others.next_if(|o| o.0 < key) {
                keys.push(k);
                values.push(v);
            }
            keys.push(key);
            values.push(value);
        }
        for (k, v) in others {
            keys.push(k);
            values.push(v);
        }
        *self = Band { keys, values };
    }

    /// Returns the vertices without a value around edges that cross zero and have an end among the `new` ones.
    fn next_wave(&self, new: &[u64]) -> Vec<u64> {
        let of_vertex = |&key: &u64| {
            let here = self.value(key);
            let crossing = |start: u64, axes: u32, end: u64| crosses(here, self.value(end)).then_some((start, axes));
            let edges = (1..=ALL).flat_map(move |axes| {
                let (up, down) = (key + way(axes), key - way(axes));
                [crossing(key, axes, up), crossing(down, axes, down)]
            });
            let around = edges.flatten().flat_map(|(start, axes)| around_edge(start, axes));
            around.filter(|&k| self.find(k).is_none()).collect::<Vec<u64>>()
        };
        let mut next = parallel::collect(new, |block| block.iter().flat_map(of_vertex));
        sort_and_dedup(&mut next);
        next
    }

    /// Returns the upward edges from vertex `i` that cross zero, as one bit each, indexed by their axes.
    fn crossings(&self, i: usize) -> u8 {
        let (key, here) = (self.keys[i], self.values[i]);
        let bit = |axes: u32| u8::from(crosses(here, self.value(key + way(axes)))) << axes;
        if here.is_nan() { 0 } else { (1..=ALL).map(bit).sum() }
    }

    fn triangulate(&self, lattice: &Lattice) -> Mesh {
        let all = || 0..self.keys.len();
        let crossings = parallel::map(all(), |i| self.crossings(i));
        let mut first = Vec::with_capacity(crossings.len());
        let mut count = 0;
        for bits in &crossings {
            first.push(count);
            count += bits.count_ones();
        }
        let edges = Edges { band: self, crossings, first };
        Mesh {
            positions: parallel::collect(all(), |block| block.flat_map(|i| edges.places(lattice, i))),
            triangles: parallel::collect(all(), |block| block.flat_map(|i| edges.triangles(i))),
        }
    }
}

/// Returns whether both values exist and have different signs.
fn crosses(one: f64, other: f64) -> bool {
    one < 0.0 && other >= 0.0 || one >= 0.0 && other < 0.0
}

/// The edges that cross zero; their indices are those of the vertices of the result.
struct Edges<'a> {
    band: &'a Band,
    crossings: Vec<u8>,
    /// Index of the first edge from each vertex.
    first: Vec<u32>,
}

impl Edges<'_> {
    /// Returns the zero crossings of the edges from vertex `i`.
    fn places(&self, lattice: &Lattice, i: usize) -> impl Iterator<Item = DVec3> {
        let (key, here) = (self.band.keys[i], self.band.values[i]);
        let bits = self.crossings[i];
        (1..=ALL).filter(move |axes| bits >> axes & 1 == 1).map(move |axes| {
            let end = key + way(axes);
            let share = here / (here - self.band.value(end));
            let share = share.clamp(NEAREST_CROSSING, 1.0 - NEAREST_CROSSING);
            lattice.place(key).lerp(lattice.place(end), share)
        })
    }

    /// Returns the triangles in the tetrahedra whose lowest corner is vertex `i`.
    fn triangles(&self, i: usize) -> Vec<[u32; 3]> {
        let mut found = Vec::new();
        let corners: [Option<usize>; 8] =
            std::array::from_fn(
                |axes| {
                    if axes == 0 { Some(i) } else { self.band.find(self.band.keys[i] + way(axes as u32)) }
                },
            );
        for (chain, positive) in CHAINS {
            let [Some(a), Some(b), Some(c), Some(d)] = chain.map(|axes| corners[axes as usize]) else { continue };
            let values = [a, b, c, d].map(|v| self.band.values[v]);
            if values.iter().any(|v| v.is_nan()) {
                continue;
            }
            let vertex = |k: usize, l: usize| {
                let (k, l) = (k.min(l), k.max(l));
                let start = corners[chain[k] as usize].expect("it was found before");
                self.number(start, chain[l] - chain[k])
            };
            for [p, q, r] in cut(values) {
                let triangle = [p, q, r].map(|(k, l)| vertex(k, l));
                found.push(if positive { triangle } else { [triangle[0], triangle[2], triangle[1]] });
            }
        }
        found
    }

    /// Returns the index of the edge from a vertex along a set of axes.
    fn number(&self, start: usize, axes: u32) -> u32 {
        self.first[start] + (self.crossings[start] & ((1 << axes) - 1)).count_ones()
    }
}

/// An edge of a tetrahedron, by its ends.
type Ends = (usize, usize);

/// Returns the triangles between the edges of a positively oriented tetrahedron with these values at its corners.
fn cut(values: [f64; 4]) -> Vec<[Ends; 3]> {
    let inside: Vec<usize> = (0..4).filter(|&k| values[k] < 0.0).collect();
    // The other corners, in an order that keeps the tetrahedron positive.
    let others = |k: usize| [[1, 2, 3], [0, 3, 2], [3, 0, 1], [2, 1, 0]][k];
    match inside[..] {
        [a] => vec![others(a).map(|k| (a, k))],
        [a, b] => {
            let [c, d] = match (a, b) {
                (0, 1) => [2, 3],
                (0, 2) => [3, 1],
                (0, 3) => [1, 2],
                (1, 2) => [0, 3],
                (1, 3) => [2, 0],
                _ => [0, 1],
            };
            vec![[(a, c), (a, d), (b, d)], [(a, c), (b, d), (b, c)]]
        }
        [_, _, _] => {
            let outside = (0..4).find(|k| !inside.contains(k)).expect("one of four");
            let [b, c, d] = others(outside);
            vec![[(outside, b), (outside, d), (outside, c)]]
        }
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;
    use glam::dvec3;

    struct Function<F>(F);

    impl<F: Fn(DVec3) -> Option<f64> + Sync> Field for Function<F> {
        /// The ball.
        type Local = (DVec3, f64);

        fn local(&self, centre: DVec3, radius: f64) -> (DVec3, f64) {
            (centre, radius)
        }

        fn value(&self, (centre, radius): &mut (DVec3, f64), x: DVec3) -> Option<f64> {
            assert!(x.distance(*centre) < 1.001 * *radius);
            (self.0)(x)
        }
    }

    fn contour_of(f: impl Fn(DVec3) -> Option<f64> + Sync, seeds: &[DVec3], edge: f64) -> Mesh {
        let corners = [DVec3::splat(-2.0), DVec3::splat(2.0)];
        let lattice = Lattice::around(&corners, 0.0, edge).unwrap();
        contour(&lattice, seeds, &Function(f), 1 << 20, &()).unwrap()
    }

    /// A point of the unit sphere away from its extremes.
    const SEED: DVec3 = DVec3::new(0.6, 0.64, 0.48);

    fn volume(mesh: &Mesh) -> f64 {
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    #[test]
    fn a_vertex_is_where_its_cell_begins() {
        let lattice = Lattice::around(&[DVec3::ZERO, DVec3::ONE], 0.0, 0.125).unwrap();
        let key = lattice.cell(dvec3(0.3, 0.5, 0.7));
        // The centre of the cell, halfway along the diagonal over all its axes.
        let middle = 0.5 * (lattice.place(key) + lattice.place(key + way(ALL)));
        assert_eq!(lattice.cell(middle), key);
        assert!(lattice.place(key + way(ALL)).distance(lattice.place(key) + 0.0625) < 1e-15);
        assert!((lattice.place(key + way(3)) - lattice.place(key)).distance(0.125 * DVec3::Z) < 1e-15);
    }

    #[test]
    fn too_many_places_are_no_lattice() {
        let points = [DVec3::ZERO, DVec3::X];
        assert!(Lattice::around(&points, 0.0, 1e-5).is_some());
        assert_eq!(Lattice::around(&points, 0.0, 1e-7), None);
    }

    #[test]
    fn edges_have_four_or_six_tetrahedra_around() {
        let start = way(ALL) * 100;
        for axes in 1..=ALL {
            let mut around: Vec<u64> = around_edge(start, axes).collect();
            sort_and_dedup(&mut around);
            assert_eq!(around.len(), if axes.count_ones() == 2 { 4 } else { 6 });
            // Each is a neighbour of both ends.
            let is_way = |a: u64, b: u64| (1..=ALL).any(|s| a + way(s) == b || b + way(s) == a);
            assert!(around.iter().all(|&v| is_way(start, v) && is_way(start + way(axes), v)));
        }
    }

    #[test]
    fn a_ball_is_closed_round_and_faces_outwards() {
        let f = |x: DVec3| Some(x.length() - 1.0);
        let errors = [0.2, 0.1].map(|edge| {
            let mesh = contour_of(f, &[SEED], edge);
            let t = topology(mesh.positions.len(), &mesh.triangles);
            assert!(t.is_manifold() && t.is_oriented());
            assert_eq!((t.vertices, t.euler, t.boundary_loops), (mesh.positions.len(), 2, 0));
            assert!(mesh.positions.iter().all(|p| (p.length() - 1.0).abs() < 0.2 * edge * edge));
            4.0 * std::f64::consts::PI / 3.0 - volume(&mesh)
        });
        assert!(errors[1] > 0.0 && errors[1] < 0.3 * errors[0], "{errors:?}");
    }

    /// Random values produce all possible combinations of signs at the corners of a tetrahedron, including zeros.
    #[test]
    fn any_values_make_an_oriented_manifold_whose_boundary_is_where_values_end() {
        let noise = |x: DVec3| {
            let h = (x.x * 12.9898 + x.y * 78.233 + x.z * 37.719).sin() * 43758.5453;
            ((h - h.floor()) * 8.0).floor() - 3.0
        };
        let seeds: Vec<DVec3> =
            (0..64).map(|i| dvec3(f64::from(i % 4), f64::from(i / 4 % 4), f64::from(i / 16)) / 4.0).collect();
        let inside = |x: DVec3| x.abs().max_element() < 0.9;
        let mesh = contour_of(|x| Some(if inside(x) { noise(x) } else { 1.0 }), &seeds, 0.2);
        let t = topology(mesh.positions.len(), &mesh.triangles);
        assert!(t.is_manifold() && t.is_oriented() && t.faces > 1000, "{t:?}");
        assert_eq!(t.boundary_loops, 0);
        let shortest = (0..mesh.triangles.len()).map(|t| mesh.area_vector(t).length()).fold(1.0, f64::min);
        assert!(shortest > 0.0);
        let half = contour_of(|x| (x.z < 0.0).then_some(x.length() - 1.0), &[SEED.with_z(-SEED.z)], 0.1);
        let t = topology(half.positions.len(), &half.triangles);
        assert_eq!((t.euler, t.boundary_loops, t.components), (1, 1, 1));
    }

    #[test]
    fn what_takes_too_much_is_refused() {
        let lattice = Lattice::around(&[DVec3::splat(-2.0), DVec3::splat(2.0)], 0.0, 0.1).unwrap();
        let all = Function(|x: DVec3| Some(x.length() - 1.0));
        let said = contour(&lattice, &[SEED], &all, 100, &()).unwrap_err().to_string();
        assert!(said.contains("more than 100 corners"), "{said}");
    }
}
