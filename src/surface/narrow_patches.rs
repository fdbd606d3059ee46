//! Leaves out sharp edges beside smooth patches that are too narrow for the samples: chamfers, engraved text, threads.
//!
//! The width of a patch is estimated as twice its area over the length of its rim, which is exact for a long strip. Leaving
//! out a curve with dihedral angle θ that bounds a strip of width w moves the surface by about w sin(θ/2) / 2, and by w sin
//! θ where a triangle goes straight from the strip's other rim to a vertex far beyond the curve. The patch with the least
//! deviation is joined to one of the neighbours along its long sides, the one with the smallest dihedral angle, along all
//! edges between both, as long as the deviation is less than a share of the spacing. So the two curves of a chamfer become
//! one, and the remaining curves stay whole. Strips that stay and meet at their ends lose the edges between them, if their
//! long sides have no corners there, and keep their long sides: the facets of a rim. If the vertices do not suffice for the
//! remaining curves, or for the short edges between them, that share grows. The rims of plates still stay then, since plates
//! would become blades and a box would lose part of its volume. Only if the vertices do not suffice for the curves alone do
//! plates become blades, the thinnest first: without any curve, the two sides of a plate would be smoothed into each other.
//!
//! Cost: n log n in the patches, linear in the sides; repeated a few times where the share grows.
//!
//! Limits: if a neighbour takes up only part of a long side, the strip stays narrow beside the others.

use crate::base::heap::Ranked;
use crate::base::math;
use crate::base::union_find::UnionFind;
use crate::mesh::sides::lower_first;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::surface::dihedral_angles::dihedral_angles;
use crate::surface::feature_curves::CORNER_TURN;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

/// Deviations, in spacings, below which patches are joined to a neighbour. The least is that of a chamfer with a width of a
/// tenth, or of a wall with a width of an eighteenth. The first one that leaves edges for which the vertices suffice is
/// taken, or the last. Plates become blades below the same deviations.
const LEAST: [f64; 5] = [0.02, 0.05, 0.08, 0.12, 0.18];

/// Largest dihedral angle, in degrees, at the edge that remains of a strip's two. Beyond it, the edge would be a blade, and
/// a body would lose volume.
pub const SHARPEST: f64 = 135.0;

/// Minimum length of the border with the neighbour that a patch is joined to, relative to its longest border: joined across
/// its end, a strip would stay as narrow between two curves.
const LONG_SIDE: f64 = 0.5;

/// Width of a wall, relative to its deviation.
const WIDTH_OF_WALL: f64 = 2.0 * std::f64::consts::SQRT_2;

/// What the vertices suffice for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Room {
    /// The edges on curves and those between curves.
    Enough,
    /// The edges on curves, but not the short ones between them.
    OnCurves,
    /// Not even the edges on curves.
    TooLittle,
}

/// What was left out.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LeftOut {
    /// Number of patches joined to a neighbour, and of ends of strips.
    pub patches: usize,
    /// Maximum distance that the surface moves as a result, in the units of the mesh.
    pub deviation: f64,
}

impl LeftOut {
    /// Scales to a mesh that is `size` times as large.
    pub fn times(self, size: f64) -> LeftOut {
        LeftOut { deviation: size * self.deviation, ..self }
    }

    /// Combines both.
    pub fn and(self, other: LeftOut) -> LeftOut {
        LeftOut { patches: self.patches + other.patches, deviation: self.deviation.max(other.deviation) }
    }
}

/// Drops from the `sharp` sides of `mesh` those beside patches that are too narrow; returns the remaining ones and what was
/// left out. It leaves out as little as gives `room` for the rest; `room` is called with the remaining sides and the minimum
/// width of a wall, in spacings. Patches with a triangle that `is_needed` stay, unless there is no room even on curves.
/// `twin` is the result of [`twins`](crate::mesh::topology::twins).
pub fn leave_out_narrow(
    mesh: &Mesh,
    twin: &[u32],
    sharp: &[bool],
    spacing: f64,
    is_needed: impl Fn(u32) -> bool,
    mut room: impl FnMut(&[bool], f64) -> Room,
) -> (Vec<bool>, LeftOut) {
    if !sharp.contains(&true) {
        return (sharp.to_vec(), LeftOut::default());
    }
    let mut before = Patches::new(mesh, twin, sharp, spacing);
    before.need((0..mesh.triangles.len() as u32).filter(|&t| is_needed(t)));
    // A crease that fades within a patch separates nothing, and stays.
    let parts: Vec<bool> = (0..sharp.len()).map(|s| sharp[s] && before.differ(s as u32, twin)).collect();
    let mut left = (sharp.to_vec(), LeftOut::default());
    let mut leave_out = |before: &Patches, share: f64, of_plates: f64| {
        let mut patches = before.clone();
        let joined = patches.join_below(share * spacing, of_plates * spacing);
        let (ends, left_out) = patches.ends_below(share * spacing);
        let mut is_left_out = |s: usize| {
            let pair = patches.pair(s as u32, twin);
            pair[0] == pair[1] || ends.contains(&pair)
        };
        let stays = |s: usize| sharp[s] && !(parts[s] && is_left_out(s));
        left = ((0..sharp.len()).map(stays).collect(), joined.and(left_out));
        room(&left.0, WIDTH_OF_WALL * share)
    };
    let [least, .., most] = LEAST;
    let mut has = Room::TooLittle;
    for share in LEAST {
        has = leave_out(&before, share, least);
        if has == Room::Enough {
            break;
        }
    }
    before.list.values_mut().for_each(|patch| patch.needed = false);
    for of_plates in LEAST {
        if has != Room::TooLittle {
            break;
        }
        has = leave_out(&before, most, of_plates);
    }
    left
}

/// Approximate number of samples on the `sharp` edges of `mesh` at this `spacing`: one for each corner and each spacing.
pub fn samples_on(mesh: &Mesh, twin: &[u32], sharp: &[bool], spacing: f64) -> f64 {
    let mut edges_at = vec![0u32; mesh.positions.len()];
    let mut length = 0.0;
    for side in (0..sharp.len() as u32).filter(|&s| sharp[s as usize] && s < twin[s as usize]) {
        let [a, b] = mesh.ends(side);
        edges_at[a as usize] += 1;
        edges_at[b as usize] += 1;
        length += mesh.positions[a as usize].distance(mesh.positions[b as usize]);
    }
    let corners = edges_at.into_iter().filter(|&n| n != 0 && n != 2).count();
    corners as f64 + length / spacing
}

/// The edges between two patches: their total length, and the sums of length times dihedral angle, unsigned and signed.
#[derive(Debug, Clone, Copy, Default)]
struct Border {
    length: f64,
    turned: f64,
    signed: f64,
}

impl Border {
    fn add(&mut self, other: Border) {
        self.length += other.length;
        self.turned += other.turned;
        self.signed += other.signed;
    }

    /// Mean over the edges for such a sum.
    fn mean(&self, sum: f64) -> f64 {
        sum / self.length.max(f64::MIN_POSITIVE)
    }
}

/// The effect of joining a patch to a neighbour: which one, and how far the surface moves, about and at most.
#[derive(Clone, Copy, PartialEq)]
struct Joint {
    neighbour: u32,
    moved: f64,
    moved_at_most: f64,
}

/// A smooth patch, or several that were joined.
#[derive(Debug, Clone, Default)]
struct Patch {
    area: f64,
    rim: f64,
    beside: BTreeMap<u32, Border>,
    /// Whether it must not be joined to a neighbour on account of its own narrowness.
    needed: bool,
}

impl Patch {
    /// Returns the joint with the neighbour of smallest dihedral angle; `own` is the patch itself. `None` for a needed
    /// patch, and for the rim of a plate if the surface would move by `of_plates` or more.
    fn gentlest(&self, own: u32, of_plates: f64) -> Option<Joint> {
        let others = self.beside.iter().filter(|(q, _)| **q != own && !self.needed);
        let longest = self.longest(own);
        let others = others.filter(|(_, border)| border.length >= LONG_SIDE * longest);
        let dihedral_angles = others.map(|(&q, border)| (q, border.mean(border.turned)));
        let (neighbour, angle) = dihedral_angles.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))?;
        let (moved, moved_at_most) = self.moved_without(angle);
        let joint = Joint { neighbour, moved, moved_at_most };
        (moved < of_plates || self.angle_without(own, neighbour) <= SHARPEST).then_some(joint)
    }

    /// Length of the longest border with a neighbour; `own` is the patch itself.
    fn longest(&self, own: u32) -> f64 {
        self.beside.iter().filter(|(q, _)| **q != own).map(|(_, border)| border.length).fold(0.0, f64::max)
    }

    /// Returns how far the surface moves, about and at most, without the patch's edges of dihedral angle `angle`, in degrees.
    fn moved_without(&self, angle: f64) -> (f64, f64) {
        let width = 2.0 * self.area / self.rim;
        let sine = |degrees: f64| math::sin_cos(degrees.to_radians()).0;
        (0.5 * width * sine(0.5 * angle), width * sine(angle.min(90.0)))
    }

    /// Dihedral angle at the remaining edges of the patch, which is `own` itself, without those to `neighbour`.
    fn angle_without(&self, own: u32, neighbour: u32) -> f64 {
        let mut others = Border::default();
        self.beside.iter().filter(|(q, _)| ![own, neighbour].contains(q)).for_each(|(_, border)| others.add(*border));
        let border = self.beside[&neighbour];
        (others.mean(others.signed) + border.mean(border.signed)).abs()
    }
}

/// The smooth patches of a mesh, each identified by one of its triangles.
#[derive(Clone)]
struct Patches {
    of_triangle: UnionFind,
    list: BTreeMap<u32, Patch>,
}

impl Patches {
    fn new(mesh: &Mesh, twin: &[u32], sharp: &[bool], spacing: f64) -> Patches {
        let mut of_triangle = UnionFind::new(mesh.triangles.len());
        for side in (0..twin.len() as u32).filter(|&s| !sharp[s as usize] && twin[s as usize] != NONE) {
            of_triangle.join(side / 3, twin[side as usize] / 3);
        }
        let dihedral_angles = dihedral_angles(mesh, twin, spacing, 0.0);
        let mut list: BTreeMap<u32, Patch> = BTreeMap::new();
        for t in 0..mesh.triangles.len() as u32 {
            let patch = list.entry(of_triangle.find(t)).or_default();
            patch.area += mesh.triangle_area(t as usize);
            for side in (3 * t..3 * t + 3).filter(|&s| sharp[s as usize] || twin[s as usize] == NONE) {
                let [a, b] = mesh.segment(side);
                let length = a.distance(b);
                patch.rim += length;
                if twin[side as usize] != NONE {
                    let other = of_triangle.find(twin[side as usize] / 3);
                    let angle = dihedral_angles[side as usize];
                    let border = Border { length, turned: length * angle.abs(), signed: length * angle };
                    patch.beside.entry(other).or_default().add(border);
                }
            }
        }
        Patches { of_triangle, list }
    }

    /// Marks the patches of `triangles` as needed.
    fn need(&mut self, triangles: impl Iterator<Item = u32>) {
        for t in triangles {
            let patch = self.of_triangle.find(t);
            self.list.get_mut(&patch).expect("a triangle is of a patch").needed = true;
        }
    }

    /// Returns the patches on both sides of an edge, the lower one first.
    fn pair(&mut self, side: u32, twin: &[u32]) -> [u32; 2] {
        lower_first([side, twin[side as usize]].map(|side| self.of_triangle.find(side / 3)))
    }

    /// Returns whether the triangles on both sides of an edge belong to different patches.
    fn differ(&mut self, side: u32, twin: &[u32]) -> bool {
        self.of_triangle.find(side / 3) != self.of_triangle.find(twin[side as usize] / 3)
    }

    /// Joins patches to a neighbour where the surface moves by less than `most`, or by less than `of_plates` if a plate
    /// becomes a blade; the least movement first.
    fn join_below(&mut self, most: f64, of_plates: f64) -> LeftOut {
        let mut left_out = LeftOut::default();
        let ranked = |p: u32, patch: &Patch| Some(Ranked::new(-patch.gentlest(p, of_plates)?.moved, p));
        let mut heap: BinaryHeap<Ranked> = self.list.iter().filter_map(|(&p, patch)| ranked(p, patch)).collect();
        while let Some(Ranked { rank, index: p, .. }) = heap.pop().filter(|top| -top.rank < most) {
            let gentlest = self.list.get(&p).and_then(|patch| patch.gentlest(p, of_plates));
            let Some(joint) = gentlest else { continue };
            if joint.moved != -rank {
                // Since then, a neighbour or the patch itself was joined to another one.
                heap.push(Ranked::new(-joint.moved, p));
                continue;
            }
            left_out.patches += 1;
            left_out.deviation = left_out.deviation.max(joint.moved_at_most);
            let joined = self.join(p, joint.neighbour);
            heap.extend(ranked(joined, &self.list[&joined]));
        }
        left_out
    }

    /// Returns the pairs of strips that meet at their ends, where the surface moves by less than `most` without the edges
    /// between them, and the effect of leaving these out.
    fn ends_below(&self, most: f64) -> (BTreeSet<[u32; 2]>, LeftOut) {
        let mut left_out = LeftOut::default();
        let mut ends = BTreeSet::new();
        let longest: BTreeMap<u32, f64> = self.list.iter().map(|(&p, patch)| (p, patch.longest(p))).collect();
        for (&p, patch) in &self.list {
            for (&q, border) in patch.beside.range(p + 1..) {
                let angle = border.mean(border.turned);
                let has_corners = math::sin_cos(angle.to_radians()).1 < CORNER_TURN;
                let both = [(p, patch), (q, &self.list[&q])];
                let are_ends =
                    both.iter().all(|(own, patch)| !patch.needed && border.length < LONG_SIDE * longest[own]);
                let moved = both.map(|(_, patch)| patch.moved_without(angle));
                if !has_corners && are_ends && moved.iter().all(|moved| moved.0 < most) {
                    ends.insert([p, q]);
                    left_out.deviation = moved.iter().fold(left_out.deviation, |most, moved| most.max(moved.1));
                }
            }
        }
        left_out.patches = ends.len();
        (ends, left_out)
    }

    /// Merges two patches into one, and returns its identifier.
    fn join(&mut self, p: u32, q: u32) -> u32 {
        self.of_triangle.join(p, q);
        let name = self.of_triangle.find(p);
        let [Some(mut a), Some(mut b)] = [p, q].map(|p| self.list.remove(&p)) else { unreachable!("both are patches") };
        if a.beside.len() < b.beside.len() {
            std::mem::swap(&mut a, &mut b);
        }
        for (&other, &border) in &b.beside {
            a.beside.entry(other).or_default().add(border);
        }
        let between: f64 = [p, q].iter().filter_map(|p| a.beside.remove(p)).map(|border| border.length).sum();
        for other in a.beside.keys() {
            let beside = &mut self.list.get_mut(other).expect("a neighbour is a patch").beside;
            let [mut border, to_q] = [p, q].map(|p| beside.remove(&p).unwrap_or_default());
            border.add(to_q);
            beside.insert(name, border);
        }
        let rim = (a.rim + b.rim - between).max(f64::MIN_POSITIVE);
        self.list.insert(name, Patch { area: a.area + b.area, rim, beside: a.beside, needed: a.needed || b.needed });
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::twins;
    use crate::testing::cube;
    use glam::{DVec3, dvec3};

    /// A roof of long strips with these widths, each turned by 45 degrees against the one before.
    fn strips(widths: &[f64]) -> Mesh {
        let mut at = DVec3::ZERO;
        let mut profile = vec![at];
        for (i, &width) in widths.iter().enumerate() {
            let (sin, cos) = (45.0 * i as f64).to_radians().sin_cos();
            at += width * dvec3(cos, 0.0, -sin);
            profile.push(at);
        }
        let positions = profile.iter().flat_map(|&p| [p, p + 10.0 * DVec3::Y]).collect();
        let quads = (0..widths.len() as u32).map(|i| 2 * i);
        Mesh { positions, triangles: quads.flat_map(|v| [[v, v + 2, v + 1], [v + 1, v + 2, v + 3]]).collect() }
    }

    /// Number of edges kept of those strips if at most `most` samples may lie on them, and what is left out.
    fn kept(widths: &[f64], most: f64) -> (usize, LeftOut) {
        let mesh = strips(widths);
        let twin = twins(&mesh.triangles);
        let room = |sharp: &[bool], _: f64| {
            if samples_on(&mesh, &twin, sharp, 1.0) <= most { Room::Enough } else { Room::OnCurves }
        };
        let (sharp, left_out) = leave_out_narrow(&mesh, &twin, &found(&mesh, &twin), 1.0, |_| false, room);
        (sharp.iter().filter(|s| **s).count() / 2, left_out)
    }

    fn found(mesh: &Mesh, twin: &[u32]) -> Vec<bool> {
        dihedral_angles(mesh, twin, 1.0, 30.0).into_iter().map(|angle| angle.abs() > 30.0).collect()
    }

    #[test]
    fn of_a_narrow_chamfer_one_edge_stays() {
        let (edges, left_out) = kept(&[5.0, 0.05, 5.0], 1000.0);
        assert_eq!((edges, left_out.patches), (1, 1));
        assert!((0.005..0.05).contains(&left_out.deviation));
        assert_eq!(kept(&[5.0, 2.0, 5.0], 1000.0), (2, LeftOut::default()));
    }

    /// A box with these half lengths, with its edges cut off at this distance, and its corners with them.
    fn bevelled_box(half: DVec3, cut: f64) -> Mesh {
        let corner = |c: usize| DVec3::from_array([0, 1, 2].map(|axis| if c >> axis & 1 == 0 { -1.0 } else { 1.0 }));
        let at = |c: usize, axis: usize| corner(c) * (half - cut * (DVec3::ONE - DVec3::AXES[axis]));
        let positions: Vec<DVec3> = (0..24).map(|v| at(v / 3, v % 3)).collect();
        let vertex = |c: usize, axis: usize| (3 * c + axis) as u32;
        let mut triangles: Vec<[u32; 3]> = (0..8).map(|c| [0, 1, 2].map(|axis| vertex(c, axis))).collect();
        for axis in 0..3 {
            let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
            for c in (0..8).filter(|c| c & (u | v) == 0) {
                let [c, d, e, f] = [c, c + u, c + u + v, c + v].map(|c| vertex(c, axis));
                triangles.extend([[c, d, e], [c, e, f]]);
            }
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            for from in (0..8).filter(|from| from >> axis & 1 == 0) {
                let to = from + (1 << axis);
                let [p, q, r, s] = [vertex(from, b), vertex(to, b), vertex(to, c), vertex(from, c)];
                triangles.extend([[p, q, r], [p, r, s]]);
            }
        }
        for t in &mut triangles {
            let [p, q, r] = t.map(|v| positions[v as usize]);
            if (q - p).cross(r - p).dot(p + q + r) < 0.0 {
                t.swap(1, 2);
            }
        }
        Mesh { positions, triangles }
    }

    #[test]
    fn of_narrow_bevels_around_a_box_one_edge_each_stays() {
        let mesh = bevelled_box(dvec3(40.0, 10.0, 2.0), 0.1);
        let twin = twins(&mesh.triangles);
        let (sharp, _) = leave_out_narrow(&mesh, &twin, &found(&mesh, &twin), 1.0, |_| false, |_, _| Room::OnCurves);
        let kept = (0..twin.len() as u32).filter(|&s| sharp[s as usize] && s < twin[s as usize]);
        let is_long = |s: &u32| {
            let [a, b] = mesh.segment(*s);
            a.distance(b) > 1.0
        };
        assert_eq!(kept.filter(is_long).count(), 12);
    }

    /// A prism with this number of sides, radius and height.
    fn prism(sides: usize, radius: f64, height: f64) -> Mesh {
        let at = |i: usize, z: f64| {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / sides as f64).sin_cos();
            dvec3(radius * cos, radius * sin, z)
        };
        let positions = (0..sides).flat_map(|i| [at(i, 0.0), at(i, height)]).collect();
        let corner = |i: usize, upper: usize| (2 * (i % sides) + upper) as u32;
        let around = (0..sides).flat_map(|i| {
            let [a, b, c, d] = [corner(i, 0), corner(i + 1, 0), corner(i + 1, 1), corner(i, 1)];
            [[a, b, c], [a, c, d]]
        });
        let lids = (1..sides - 1).flat_map(|i| {
            [[corner(0, 0), corner(i + 1, 0), corner(i, 0)], [corner(0, 1), corner(i, 1), corner(i + 1, 1)]]
        });
        Mesh { positions, triangles: around.chain(lids).collect() }
    }

    #[test]
    fn the_facets_of_the_rim_of_a_plate_lose_the_edges_between_them_alone() {
        let kept = |sides: usize| {
            let mesh = prism(sides, 5.0, 0.1);
            let twin = twins(&mesh.triangles);
            let (sharp, left_out) =
                leave_out_narrow(&mesh, &twin, &found(&mesh, &twin), 1.0, |_| false, |_, _| Room::Enough);
            let kept = (0..twin.len() as u32).filter(|&s| sharp[s as usize] && s < twin[s as usize]);
            let is_of_lid = |s: u32| mesh.segment(s)[0].z == mesh.segment(s)[1].z;
            let (of_lids, others): (Vec<u32>, Vec<u32>) = kept.partition(|&s| is_of_lid(s));
            (of_lids.len(), others.len(), left_out)
        };
        let (of_lids, others, left_out) = kept(10);
        assert_eq!((of_lids, others, left_out.patches), (20, 0, 10));
        assert!((0.02..0.1).contains(&left_out.deviation), "{left_out:?}");
        assert_eq!(kept(6), (12, 6, LeftOut::default()), "the lids have corners");
    }

    #[test]
    fn a_patch_that_is_needed_stays() {
        let mesh = strips(&[5.0, 0.05, 5.0]);
        let twin = twins(&mesh.triangles);
        let found = found(&mesh, &twin);
        let made = leave_out_narrow(&mesh, &twin, &found, 1.0, |t| t == 2, |_, _| Room::Enough);
        assert_eq!(made, (found, LeftOut::default()));
    }

    #[test]
    fn each_edge_and_each_corner_takes_samples_once() {
        let mesh = cube();
        let twin = twins(&mesh.triangles);
        let sharp: Vec<bool> =
            dihedral_angles(&mesh, &twin, 0.1, 30.0).into_iter().map(|angle| angle.abs() > 30.0).collect();
        assert!((samples_on(&mesh, &twin, &sharp, 0.1) - (8.0 + 12.0 / 0.1)).abs() < 1e-9);
    }

    #[test]
    fn a_crease_that_parts_nothing_stays() {
        let positions = [[0.0, 0.0], [0.1, 0.0], [0.0, 0.1], [-0.1, 0.0], [0.0, -0.1]];
        let positions = positions.map(|[x, y]| dvec3(x, y, 0.0)).to_vec();
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]] };
        let twin = twins(&mesh.triangles);
        let mut sharp = vec![false; twin.len()];
        (sharp[0], sharp[twin[0] as usize]) = (true, true);
        let made = leave_out_narrow(&mesh, &twin, &sharp, 1.0, |_| false, |_, _| Room::Enough);
        assert_eq!(made, (sharp, LeftOut::default()));
    }

    #[test]
    fn more_is_left_out_where_there_are_fewer_vertices() {
        let widths = [3.0, 0.5, 3.0, 0.5, 3.0];
        assert_eq!(kept(&widths, 600.0).0, 4);
        assert_eq!(kept(&widths, 30.0).0, 2);
    }

    #[test]
    fn the_rim_of_a_plate_stays_unless_it_is_far_thinner_than_the_spacing_or_there_is_no_room_on_curves() {
        let edges = |thickness: f64, room: Room| {
            let mut mesh = cube();
            mesh.positions.iter_mut().for_each(|p| *p *= dvec3(20.0, 20.0, thickness));
            let twin = twins(&mesh.triangles);
            let found = found(&mesh, &twin);
            let (sharp, _) = leave_out_narrow(&mesh, &twin, &found, 1.0, |_| false, |_, _| room);
            sharp.iter().filter(|s| **s).count() / 2
        };
        assert_eq!(edges(0.3, Room::OnCurves), 12);
        assert!(edges(0.03, Room::OnCurves) < 12);
        assert!(edges(0.3, Room::TooLittle) < 12);
        assert_eq!(edges(0.6, Room::TooLittle), 12);
    }

    #[test]
    fn what_is_needed_goes_where_there_is_no_room_even_on_curves() {
        let mesh = strips(&[5.0, 0.05, 5.0]);
        let twin = twins(&mesh.triangles);
        let made = leave_out_narrow(&mesh, &twin, &found(&mesh, &twin), 1.0, |t| t == 2, |_, _| Room::TooLittle);
        assert_eq!(made.1.patches, 1);
    }

    #[test]
    fn what_is_left_is_no_narrower_than_is_asked_for() {
        let mesh = strips(&[3.0, 0.5, 3.0, 1.0, 3.0]);
        let twin = twins(&mesh.triangles);
        let mut asked = Vec::new();
        leave_out_narrow(
            &mesh,
            &twin,
            &found(&mesh, &twin),
            1.0,
            |_| false,
            |sharp, narrowest| {
                asked.push((narrowest, sharp.iter().filter(|s| **s).count() / 2));
                Room::OnCurves
            },
        );
        let last = asked.last().unwrap();
        assert!(asked[0].0 < 0.1 && asked[0].1 == 4 && last.0 < 1.0 && last.1 < 4, "{asked:?}");
    }
}
