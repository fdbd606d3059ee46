//! Ends wedges: parts of a smooth patch between two sharp edges, or a sharp edge and the boundary, that meet at a small
//! angle. Every mesh has that angle there, however many vertices it has.
//!
//! Near its corner, a wedge is as narrow as the strips that are left out
//! ([`narrow_patches`](crate::surface::narrow_patches)). This tip is joined to the adjacent patch across the edge with the
//! smaller dihedral angle. The other edge then continues to the corner, and the first one ends at a new edge across the
//! wedge. A boundary always continues. A crease that fades within the tip is dropped.
//!
//! Cost: linear in the sharp edges and in the triangles of the tips, and in all triangles if there is a tip.

use crate::base::math;
use crate::mesh::half_edge::prev;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::refine::split_edges;
use crate::mesh::sides::lower_first;
use crate::mesh::topology::{NONE, twins};
use crate::mesh::triangle_mesh::Mesh;
use crate::surface::dihedral_angles::{dihedral_angles, direction, length};
use crate::surface::narrow_patches::LeftOut;
use glam::DVec3;
use std::collections::{BTreeSet, HashMap, HashSet};

/// Largest angle of a wedge, in degrees: a little more than the wanted minimum angle of triangles, which differs from the
/// angle between the edges where these are curved.
const SMALL: f64 = 33.0;

/// Widths at which a wedge with straight sides may end, in spacings; the first possible one is taken.
const WIDTHS: [f64; 3] = [0.24, 0.12, 0.06];

/// Range of widths at which a wedge with curved sides may end, in spacings.
const NARROWEST: f64 = 0.05;
const WIDEST: f64 = 0.45;

/// How much farther from its corner a wedge may end, as a share, to keep the end away from vertices; and the number of
/// places to try.
const FARTHER: f64 = 0.25;
const TRIES: u32 = 6;

/// Maximum number of triangles in a tip.
const MOST_TRIANGLES: usize = 500;

/// Number of rounds. Of wedges that share a triangle, each round ends one.
const ROUNDS: usize = 3;

/// The sharp edges of a mesh after its wedges were ended, and what was left out.
pub struct Ended {
    /// The opposite side of each side, or [`NONE`].
    pub twin: Vec<u32>,
    /// Whether each side is sharp.
    pub sharp: Vec<bool>,
    /// Number of tips, and how far the surface moves without their edges.
    pub left_out: LeftOut,
    /// Ends of the edges that were left out.
    pub edges: Vec<[DVec3; 2]>,
}

/// Ends the wedges between the `sharp` sides of `mesh`, and between those and the boundary, for samples with this `spacing`.
/// An `interface` keeps its edges: it bounds no wedge. Wedges stay where a triangle of the tip `is_needed`. `twin` is the
/// result of [`twins`].
pub fn end_wedges(
    mesh: &mut OrientedManifold,
    twin: Vec<u32>,
    sharp: Vec<bool>,
    interface: bool,
    spacing: f64,
    is_needed: impl Fn(&Mesh, u32) -> bool,
) -> Ended {
    let mut ended = Ended { twin, sharp, left_out: LeftOut::default(), edges: Vec::new() };
    for _ in 0..ROUNDS {
        let tips = Creases { mesh, twin: &ended.twin, sharp: &ended.sharp, interface, spacing }.tips(&is_needed);
        if tips.is_empty() {
            break;
        }
        ended.leave_out(mesh, &tips);
    }
    ended
}

impl Ended {
    /// Cuts `mesh` where the tips end, and leaves out their edges.
    fn leave_out(&mut self, mesh: &mut OrientedManifold, tips: &[Tip]) {
        let sides = (0..self.sharp.len() as u32).filter(|&s| self.sharp[s as usize]);
        // These are only looked up, never iterated.
        let mut sharp: HashSet<[u32; 2]> = sides.map(|s| edge(mesh, s)).collect();
        let places: HashMap<[u32; 2], f64> = tips.iter().flat_map(|tip| &tip.cuts).copied().collect();
        let first = mesh.positions.len() as u32;
        let inserted: HashMap<[u32; 2], u32> =
            split_edges(mesh, &places).into_iter().map(lower_first).zip(first..).collect();
        for tip in tips {
            for (cut, _) in &tip.cuts {
                if sharp.remove(cut) {
                    sharp.extend(cut.map(|v| lower_first([v, inserted[cut]])));
                }
            }
            let shortened = tip.shortened.map(|[inside, outside]| [inside, inserted[&lower_first([inside, outside])]]);
            for ends in tip.whole.iter().copied().chain(shortened) {
                sharp.remove(&lower_first(ends));
                self.edges.push(ends.map(|v| mesh.positions[v as usize]));
            }
            sharp.extend(tip.across.iter().map(|cuts| lower_first(cuts.map(|cut| inserted[&cut]))));
            let deviation = self.left_out.deviation.max(tip.deviation);
            self.left_out = LeftOut { patches: self.left_out.patches + 1, deviation };
        }
        self.sharp = (0..3 * mesh.triangles.len() as u32).map(|s| sharp.contains(&edge(mesh, s))).collect();
        self.twin = twins(&mesh.triangles);
    }
}

/// The tip of a wedge.
struct Tip {
    /// Its triangles, and those across its rims.
    triangles: BTreeSet<u32>,
    /// Edges that its end crosses, the lower vertex first, and the crossing as a share of the way from there.
    cuts: Vec<([u32; 2], f64)>,
    /// The two edges that its end crosses, for each triangle there.
    across: Vec<[[u32; 2]; 2]>,
    /// Sharp edges that are left out entirely.
    whole: Vec<[u32; 2]>,
    /// The edge that is left out from its first vertex up to the end of the tip.
    shortened: Option<[u32; 2]>,
    /// Maximum distance that the surface moves as a result.
    deviation: f64,
}

/// A corner of a patch, from the rim that begins there to the previous one, and the unit vector midway between them.
struct Corner {
    first: u32,
    radians: f64,
    midway: DVec3,
}

/// A plane across a wedge.
struct Plane<'a> {
    mesh: &'a Mesh,
    corner: DVec3,
    normal: DVec3,
    distance: f64,
}

impl Plane<'_> {
    /// Distance of vertex `v` from the corner, measured along the wedge.
    fn height(&self, v: u32) -> f64 {
        (self.mesh.positions[v as usize] - self.corner).dot(self.normal)
    }

    fn is_below(&self, v: u32) -> bool {
        self.height(v) < self.distance
    }

    fn crosses(&self, [a, b]: [u32; 2]) -> bool {
        self.is_below(a) != self.is_below(b)
    }

    /// Returns where it crosses the edge from `a` to `b`, as a share of the way.
    fn along(&self, [a, b]: [u32; 2]) -> f64 {
        (self.distance - self.height(a)) / (self.height(b) - self.height(a))
    }

    fn point(&self, ends: [u32; 2]) -> DVec3 {
        let [p, q] = ends.map(|v| self.mesh.positions[v as usize]);
        p.lerp(q, self.along(ends))
    }
}

/// The sharp sides of a mesh, and its boundary.
struct Creases<'a> {
    mesh: &'a Mesh,
    twin: &'a [u32],
    sharp: &'a [bool],
    /// Whether the boundary is an interface.
    interface: bool,
    spacing: f64,
}

impl Creases<'_> {
    /// Returns the tips of wedges, no two of which share a triangle.
    fn tips(&self, is_needed: impl Fn(&Mesh, u32) -> bool) -> Vec<Tip> {
        let corners: Vec<Corner> = self.rims().filter_map(|side| self.small_corner(side)).collect();
        if corners.is_empty() {
            return Vec::new();
        }
        let degrees = self.degrees();
        let dihedral_angles = dihedral_angles(self.mesh, self.twin, self.spacing, 0.0);
        let mut taken: BTreeSet<u32> = BTreeSet::new();
        let mut tips = Vec::new();
        for corner in corners {
            let tip =
                WIDTHS.iter().find_map(|width| self.tip(&corner, width * self.spacing, &degrees, &dihedral_angles));
            let is_free = |t: &u32| !taken.contains(t) && !is_needed(self.mesh, *t);
            if let Some(tip) = tip.filter(|tip| tip.triangles.iter().all(is_free)) {
                taken.extend(&tip.triangles);
                tips.push(tip);
            }
        }
        tips
    }

    /// Returns the sides that bound patches.
    fn rims(&self) -> impl Iterator<Item = u32> {
        (0..self.sharp.len() as u32).filter(|&side| self.is_rim(side))
    }

    fn is_rim(&self, side: u32) -> bool {
        self.sharp[side as usize] || self.is_boundary(side) && !self.interface
    }

    fn is_boundary(&self, side: u32) -> bool {
        self.twin[side as usize] == NONE
    }

    /// Number of rims at each vertex, counting the two sides of an edge once.
    fn degrees(&self) -> Vec<u32> {
        let mut degrees = vec![0; self.mesh.positions.len()];
        let one_of_each = self.rims().filter(|&side| side < self.twin[side as usize]);
        one_of_each.flat_map(|side| self.mesh.ends(side)).for_each(|v| degrees[v as usize] += 1);
        degrees
    }

    /// Returns the corner of a patch at which the rim `first` begins, if its angle is small.
    fn small_corner(&self, first: u32) -> Option<Corner> {
        let (mut radians, mut side) = (0.0, first);
        loop {
            let [along, back] = [direction(self.mesh, side), -direction(self.mesh, prev(side))];
            radians += math::atan2(along.cross(back).length(), along.dot(back));
            if radians >= SMALL.to_radians() {
                return None;
            }
            if self.is_rim(prev(side)) {
                let midway = (direction(self.mesh, first) + back).normalize_or_zero();
                return (radians > 0.0).then_some(Corner { first, radians, midway });
            }
            side = self.twin[prev(side) as usize];
            if side == NONE {
                return None;
            }
        }
    }

    /// Returns the tip of the wedge at a corner, if it can end at about this width. `degrees` has a value for each vertex,
    /// `dihedral_angles` for each side.
    fn tip(&self, corner: &Corner, width: f64, degrees: &[u32], dihedral_angles: &[f64]) -> Option<Tip> {
        let plane = self.plane(corner, width)?;
        let triangles = self.below(corner, &plane)?;
        let sides = || triangles.iter().flat_map(|&t| 3 * t..3 * t + 3);
        let rims: Vec<u32> =
            sides().filter(|&s| self.is_rim(s) && self.mesh.ends(s).into_iter().any(|v| plane.is_below(v))).collect();
        let is_inside = |s: &u32| triangles.contains(&(self.twin[*s as usize] / 3));
        if rims.iter().any(is_inside) {
            let fading = rims.into_iter().filter(is_inside).collect();
            return self.tip_without_crease(fading, width, &plane, dihedral_angles, triangles);
        }
        let [out, back] = self.chains(corner, rims, &plane, degrees)?;
        let [angle_out, angle_back] = [&out, &back].map(|chain| self.mean_angle(chain, dihedral_angles));
        let (left_out, angle) = if angle_out < angle_back { (&out, angle_out) } else { (&back, angle_back) };
        if angle == f64::INFINITY {
            return None;
        }
        let crossed = |chain: &[u32]| chain.iter().map(|&s| self.mesh.ends(s)).find(|ends| plane.crosses(*ends));
        let width = plane.point(crossed(&out)?).distance(plane.point(crossed(&back)?));
        if !(NARROWEST * self.spacing..WIDEST * self.spacing).contains(&width) {
            return None;
        }
        let cut_at = |t: u32| (3 * t..3 * t + 3).map(|s| edge(self.mesh, s)).filter(|ends| plane.crosses(*ends));
        let cuts: BTreeSet<[u32; 2]> = triangles.iter().flat_map(|&t| cut_at(t)).collect();
        let beside =
            [&out, &back].into_iter().flatten().filter(|&&s| !self.is_boundary(s)).map(|&s| self.twin[s as usize] / 3);
        let inside_first = |[a, b]: [u32; 2]| if plane.is_below(a) { [a, b] } else { [b, a] };
        Some(Tip {
            cuts: cuts.into_iter().map(|cut| (cut, plane.along(cut))).collect(),
            across: triangles.iter().filter_map(|&t| cut_at(t).collect::<Vec<_>>().try_into().ok()).collect(),
            whole: left_out.iter().map(|&s| self.mesh.ends(s)).filter(|ends| !plane.crosses(*ends)).collect(),
            shortened: crossed(left_out).map(inside_first),
            deviation: deviation(width, angle),
            triangles: triangles.iter().copied().chain(beside).collect(),
        })
    }

    /// Returns a tip whose only sharp edges are the `fading` sides of a crease that ends in it; `None` if the crease leaves
    /// the tip again.
    fn tip_without_crease(
        &self,
        fading: Vec<u32>,
        width: f64,
        plane: &Plane,
        dihedral_angles: &[f64],
        triangles: BTreeSet<u32>,
    ) -> Option<Tip> {
        if fading.iter().any(|&s| plane.crosses(self.mesh.ends(s))) {
            return None;
        }
        let one_of_each = fading.iter().filter(|&&s| s < self.twin[s as usize]);
        Some(Tip {
            cuts: Vec::new(),
            across: Vec::new(),
            whole: one_of_each.map(|&s| self.mesh.ends(s)).collect(),
            shortened: None,
            deviation: deviation(width, self.mean_angle(&fading, dihedral_angles)),
            triangles,
        })
    }

    /// Returns the rims of a tip, from its corner to the plane and from there back, each as a chain of sides. `None` where
    /// other edges meet them, where they return to the corner, or where they cross the plane more than once.
    fn chains(&self, corner: &Corner, rims: Vec<u32>, plane: &Plane, degrees: &[u32]) -> Option<[Vec<u32>; 2]> {
        let crossing = |below: usize| {
            let leaves = |s: &&u32| plane.crosses(self.mesh.ends(**s)) && plane.is_below(self.mesh.ends(**s)[below]);
            let mut found = rims.iter().filter(leaves);
            found.next().filter(|_| found.next().is_none()).copied()
        };
        let (last_out, _) = (crossing(0)?, crossing(1)?);
        let apex = self.mesh.origin(corner.first);
        let mut inner = rims.iter().flat_map(|&s| self.mesh.ends(s)).filter(|&v| v != apex && plane.is_below(v));
        if inner.any(|v| degrees[v as usize] != 2) {
            return None;
        }
        // The side that leaves each vertex except the apex, where a rim may return around a hole or a patch with a corner
        // there.
        let mut beyond: HashMap<u32, u32> =
            rims.iter().map(|&s| (self.mesh.origin(s), s)).filter(|&(v, _)| v != apex).collect();
        let mut out = vec![corner.first];
        while let Some(&last) = out.last().filter(|&&last| last != last_out) {
            out.push(beyond.remove(&self.mesh.ends(last)[1])?);
        }
        let back = rims.iter().copied().filter(|s| !out.contains(s)).collect();
        Some([out, back])
    }

    /// Mean dihedral angle across sides, in degrees; infinite at the boundary.
    fn mean_angle(&self, sides: &[u32], dihedral_angles: &[f64]) -> f64 {
        if sides.iter().any(|&s| self.is_boundary(s)) {
            return f64::INFINITY;
        }
        let weighted = |s: &u32| length(self.mesh, *s) * dihedral_angles[*s as usize];
        (sides.iter().map(weighted).sum::<f64>() / sides.iter().map(|&s| length(self.mesh, s)).sum::<f64>()).abs()
    }

    /// Returns the plane across a wedge where it has this width or slightly more; of those tried, the one farthest from all
    /// vertices.
    fn plane(&self, corner: &Corner, width: f64) -> Option<Plane<'_>> {
        let (sin, cos) = math::sin_cos(0.5 * corner.radians);
        let at = |farther: f64| Plane {
            mesh: self.mesh,
            corner: self.mesh.positions[self.mesh.origin(corner.first) as usize],
            normal: corner.midway,
            distance: 0.5 * width * cos / sin * (1.0 + farther),
        };
        let farthest = at(FARTHER);
        let corners = self.below(corner, &farthest)?.into_iter().flat_map(|t| self.mesh.triangles[t as usize]);
        let heights: Vec<f64> = corners.map(|v| farthest.height(v)).collect();
        let clearance = |p: &Plane| heights.iter().map(|h| (h - p.distance).abs()).fold(f64::INFINITY, f64::min);
        let tried = (0..TRIES).map(|k| at(FARTHER * f64::from(k) / f64::from(TRIES)));
        tried.max_by(|p, q| clearance(p).total_cmp(&clearance(q)))
    }

    /// Returns the triangles of a patch around its corner that have a vertex below a plane; `None` if there are too many, or
    /// at an interface.
    fn below(&self, corner: &Corner, plane: &Plane) -> Option<BTreeSet<u32>> {
        let mut found = BTreeSet::from([corner.first / 3]);
        let mut open = vec![corner.first / 3];
        while let Some(t) = open.pop() {
            for side in (3 * t..3 * t + 3).filter(|&s| self.mesh.ends(s).into_iter().any(|v| plane.is_below(v))) {
                if self.is_rim(side) {
                    continue;
                }
                let across = self.twin[side as usize];
                if across == NONE || found.len() > MOST_TRIANGLES {
                    return None;
                }
                if found.insert(across / 3) {
                    open.push(across / 3);
                }
            }
        }
        Some(found)
    }
}

/// Maximum movement of the surface without an edge of dihedral angle `angle`, in degrees, beside a strip of this width.
fn deviation(width: f64, angle: f64) -> f64 {
    width * math::sin_cos(angle.min(90.0).to_radians()).0
}

/// Returns the ends of a side, the lower one first.
fn edge(mesh: &Mesh, side: u32) -> [u32; 2] {
    lower_first(mesh.ends(side))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;
    use crate::testing::cube;
    use glam::dvec3;

    /// A prism over a triangle with two sides of length 4 that enclose this angle, in degrees.
    fn prism(degrees: f64) -> OrientedManifold {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let base = [[0.0, 0.0], [4.0, 0.0], [4.0 * cos, 4.0 * sin]];
        let positions = [0.0, 1.0].iter().flat_map(|&z| base.map(|[x, y]| dvec3(x, y, z))).collect();
        let wall = |a: u32, b: u32| [[a, b, b + 3], [a, b + 3, a + 3]];
        let triangles =
            [[0, 2, 1], [3, 4, 5]].into_iter().chain([[0, 1], [1, 2], [2, 0]].iter().flat_map(|&[a, b]| wall(a, b)));
        Mesh { positions, triangles: triangles.collect() }.try_into().unwrap()
    }

    fn sharp(mesh: &Mesh) -> (Vec<u32>, Vec<bool>) {
        let twin = twins(&mesh.triangles);
        let sharp = dihedral_angles(mesh, &twin, 1.0, 30.0).into_iter().map(|angle| angle.abs() > 30.0).collect();
        (twin, sharp)
    }

    /// The smallest angle of a corner between sharp edges, if it is small.
    fn smallest(mesh: &Mesh, ended: &Ended) -> Option<f64> {
        let creases = Creases { mesh, twin: &ended.twin, sharp: &ended.sharp, interface: false, spacing: 1.0 };
        creases.rims().filter_map(|side| creases.small_corner(side)).map(|c| c.radians).reduce(f64::min)
    }

    #[test]
    fn a_wedge_ends_at_an_edge_across_it() {
        let mut mesh = prism(20.0);
        let (before, twin_sharp) = (mesh.clone(), sharp(&mesh));
        let ended = end_wedges(&mut mesh, twin_sharp.0, twin_sharp.1, false, 1.0, |_, _| false);
        assert_eq!(smallest(&mesh, &ended), None);
        assert_eq!(ended.left_out.patches, 2, "above and below");
        assert!((0.2..0.5).contains(&ended.left_out.deviation), "{}", ended.left_out.deviation);
        // An edge of each triangle is left out up to a width of .3 to .4.
        assert!(ended.edges.iter().all(|[p, q]| (0.8..1.2).contains(&p.distance(*q))) && ended.edges.len() == 2);
        let edges = ended.sharp.iter().filter(|s| **s).count() / 2;
        assert_eq!(edges, 9 + 2 * 2, "one across each wedge, and the other in two parts");
        let t = topology(mesh.positions.len(), &mesh.triangles);
        assert!(t.is_manifold() && t.is_oriented() && t.euler == 2);
        assert!((mesh.area() - before.area()).abs() < 1e-12);
    }

    #[test]
    fn wide_corners_stay_and_so_do_wedges_that_are_needed() {
        for (mesh, needed) in [(cube().try_into().unwrap(), false), (prism(35.0), false), (prism(20.0), true)] {
            let (mut after, (twin, sharp)) = (mesh.clone(), sharp(&mesh));
            let ended = end_wedges(&mut after, twin, sharp.clone(), false, 1.0, |_, _| needed);
            assert!(after == mesh && ended.sharp == sharp && ended.left_out == LeftOut::default());
        }
    }

    #[test]
    fn a_wedge_between_a_crease_and_the_boundary_ends_the_crease_unless_that_is_an_interface() {
        let (sin, cos) = 20f64.to_radians().sin_cos();
        let positions = vec![DVec3::ZERO, dvec3(4.0, 0.0, 0.0), dvec3(4.0 * cos, 4.0 * sin, 0.0), dvec3(0.0, 4.0, 2.0)];
        let folded: OrientedManifold = Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]] }.try_into().unwrap();
        for interface in [false, true] {
            let (mut after, twin) = (folded.clone(), twins(&folded.triangles));
            let sharp = (0..6).map(|s| edge(&folded, s) == [0, 2]).collect();
            let ended = end_wedges(&mut after, twin, sharp, interface, 1.0, |_, _| false);
            assert_eq!(after == folded, interface);
            if interface {
                continue;
            }
            assert_eq!((smallest(&after, &ended), ended.left_out.patches), (None, 1));
            let [[p, q]] = ended.edges[..] else { panic!("{:?}", ended.edges) };
            let [near, far] = if p == DVec3::ZERO { [p, q] } else { [q, p] };
            assert!(near == DVec3::ZERO && (0.6..0.9).contains(&far.length()) && far.y > 0.0, "{far}");
            assert_eq!(topology(after.positions.len(), &after.triangles).boundary_loops, 1);
            assert!((after.area() - folded.area()).abs() < 1e-12);
        }
    }

    #[test]
    fn a_wedge_of_the_outline_stays() {
        let mut open = prism(20.0).into_mesh();
        open.triangles.retain(|t| t.iter().all(|&v| v < 3));
        open.drop_unused();
        let mut open: OrientedManifold = open.try_into().unwrap();
        let (before, (twin, sharp)) = (open.clone(), sharp(&open));
        let ended = end_wedges(&mut open, twin, sharp, false, 1.0, |_, _| false);
        assert!(open == before && ended.left_out == LeftOut::default());
    }

    /// The point of the plane with this polar angle, in degrees, and distance from the origin.
    fn at(degrees: f64, r: f64) -> DVec3 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        dvec3(r * cos, r * sin, 0.0)
    }

    #[test]
    fn a_wedge_beside_a_small_patch_at_its_corner_stays() {
        // A patch with an angle of 50 degrees, whose corner is also a corner of a small triangle with sharp edges.
        let positions = vec![DVec3::ZERO, at(-25.0, 4.0), at(0.0, 4.0), at(25.0, 4.0), at(-5.0, 0.1), at(5.0, 0.1)];
        let triangles = vec![[0, 1, 4], [1, 2, 4], [4, 2, 5], [2, 3, 5], [5, 3, 0], [0, 4, 5]];
        let mut mesh: OrientedManifold = Mesh { positions, triangles }.try_into().unwrap();
        let (before, twin) = (mesh.clone(), twins(&mesh.triangles));
        let is_sharp = |s: u32| [[0, 4], [0, 5], [4, 5]].contains(&edge(&mesh, s));
        let sharp: Vec<bool> = (0..twin.len() as u32).map(is_sharp).collect();
        let ended = end_wedges(&mut mesh, twin, sharp.clone(), false, 1.0, |_, _| false);
        assert!(mesh == before && ended.sharp == sharp);
    }

    #[test]
    fn a_crease_that_fades_within_a_wedge_goes() {
        // A fan around a corner, with sharp edges at 0 and 60 degrees, and a short one between them.
        let around = (1..12).map(|k| at(30.0 * f64::from(k), 4.0));
        let positions: Vec<DVec3> = [DVec3::ZERO, at(0.0, 4.0), at(15.0, 0.2)].into_iter().chain(around).collect();
        let last = positions.len() as u32 - 1;
        let mut triangles = vec![[0, 1, 2], [2, 1, 3], [0, 2, 3]];
        triangles.extend((3..last).map(|v| [0, v, v + 1]));
        triangles.push([0, last, 1]);
        let mut mesh: OrientedManifold = Mesh { positions, triangles }.try_into().unwrap();
        let twin = twins(&mesh.triangles);
        let is_sharp = |s: u32| [[0, 1], [0, 2], [0, 4]].contains(&edge(&mesh, s));
        let sharp: Vec<bool> = (0..twin.len() as u32).map(is_sharp).collect();
        let ended = end_wedges(&mut mesh, twin, sharp, false, 1.0, |_, _| false);
        let [[mut p, mut q]] = ended.edges[..] else { panic!("{:?}", ended.edges) };
        if q == DVec3::ZERO {
            std::mem::swap(&mut p, &mut q);
        }
        assert_eq!([p, q], [DVec3::ZERO, at(15.0, 0.2)]);
        assert_eq!(ended.sharp.iter().filter(|s| **s).count(), 2 * 2);
    }
}
