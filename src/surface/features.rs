//! Sharp edges of a mesh.
//!
//! An edge is sharp where the surface turns across it by a threshold or more. Asked for none, the threshold comes from
//! the mesh: the smallest at which the turns fall apart into two groups. On a part from a CAD system nearly all edges
//! are either almost flat or clearly sharp. On a scan there are ever fewer edges of ever larger turns and no gap
//! between; there, none is sharp but on bodies that are mostly bounded by planes ([`planes`](crate::surface::planes)). Where
//! hardly any edge is flat, and they are far shorter than the samples are apart, the surface is rough, and none is sharp
//! either. Or edges are given one by one; those that were split are sharp in all their parts.
//!
//! Edges between the facets of what is meant round do not count, nor do the steps of points on a lattice
//! ([`facets`](crate::surface::facets)).
//!
//! Short scraps, shorter than a few spacings of the samples in all, are left out: at that spacing they are noise, or rims that a
//! mesh can do without, unless it turned out that it cannot.
//!
//! Cost: linear in the triangles.

use crate::base::error::{Error, Result, Setting};
use crate::base::math;
use crate::base::union_find::UnionFind;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::surface::facets::{NOTICED, STRAIGHT, between_facets, on_steps};
use crate::surface::planes::{Planes, planar_bodies};
use crate::surface::turns::{direction, length, turns};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::slice::SliceIndex;

/// Which edges of the input are kept sharp.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Features {
    /// Decided from the turns of the input's edges.
    #[default]
    Automatic,
    /// Those across which the surface turns by at least so many degrees.
    Degrees(f64),
    /// These, by their ends.
    Edges(Vec<[u32; 2]>),
    /// None.
    Smooth,
}

impl Features {
    /// Refuses ends that are none of so many vertices.
    ///
    /// # Errors
    /// [`Error::Option`] with the first of them.
    pub fn check(&self, vertices: usize) -> Result<()> {
        let Features::Edges(edges) = self else { return Ok(()) };
        let wrong = edges.iter().find(|ends| ends.iter().any(|&v| v as usize >= vertices));
        wrong.map_or(Ok(()), |[a, b]| {
            let cause = format!("no edge joins vertices {a} and {b}: triangles have {vertices}");
            Err(Error::Option { option: Setting::Features, cause, remedy: "give edges of this mesh".into() })
        })
    }
}

/// Thresholds that are tried, in degrees, the smallest first.
const THRESHOLDS: RangeInclusive<usize> = 15..=60;

/// The smallest turn that any of them asks about.
const SMALLEST: usize = *THRESHOLDS.start() / 2;

/// The threshold has to part the edges such that those from half of it up to it have at most this share of the length of
/// those above it. Fifteen scans and sculpts have between 1.5 and 40 at every threshold, CAD parts 0.1 and less.
const GAP: f64 = 0.2;

/// Steeper thresholds, for surfaces that none of those parts: what is round hardly ever turns by so much at one edge, and a larger
/// share tells. Of 216 models, parts from CAD that were decimated mostly have .65 and less, scans, sculpts and game assets more
/// than 1, and a chair of wire .78.
const STEEP: RangeInclusive<usize> = 61..=85;
const STEEP_GAP: f64 = 0.7;

/// A surface is rough if its flat edges have less than this share of the length of those that turn by the smallest threshold or more,
/// and these are shorter, in spacings, in the mean over their length. Noise of a half and of a whole edge has .14 to .31 and .16
/// at six edges a spacing; of 300 scans, sculpts, game assets, and parts from CAD those with as few flat edges have .8 and more.
const FLAT: f64 = 0.35;
const SHORT: f64 = 0.5;

/// The most triangles whose edges tell whether a surface is rough.
const LOOKED_AT: usize = 4000;

/// From this turn on, in degrees, an edge between two planes is sharp whatever the other edges are.
const BETWEEN_PLANES: f64 = 30.0;

/// Least length of a connected net of sharp edges, in spacings.
const SHORTEST: f64 = 3.0;

/// For each side `3 t + k` of the triangles whether it is on a sharp edge. `twin` is as
/// [`twins`](crate::mesh::topology::twins) says, `spacing` that of the samples, in the units of the mesh; steps no wider than
/// `finest` are none of the surface. Scraps beside a triangle that `is_needed` stay.
pub fn sharp_sides(
    mesh: &OrientedManifold,
    twin: &[u32],
    features: &Features,
    spacing: f64,
    finest: f64,
    is_needed: impl Fn(u32) -> bool,
) -> Vec<bool> {
    let mut sharp = match features {
        Features::Smooth => return vec![false; twin.len()],
        Features::Edges(edges) => along(mesh, twin, edges),
        Features::Degrees(degrees) => turned(&turns(mesh, twin, spacing, *degrees), *degrees),
        Features::Automatic => {
            let turns = without_facets(mesh, twin, spacing, finest);
            let histogram = Histogram::new(mesh, (0..).zip(turns.iter().copied()));
            match histogram.gap() {
                _ if histogram.is_rough(spacing) => vec![false; turns.len()],
                Some(threshold) => turned(&turns, threshold),
                None => {
                    let mut sharp = turned_on_planar_bodies(mesh, twin, &turns, spacing);
                    if let Some(steep) = histogram.threshold(STEEP, STEEP_GAP) {
                        sharp.iter_mut().zip(&turns).for_each(|(sharp, turn)| *sharp |= turn.abs() >= steep);
                        go_on(mesh, twin, &turns, &mut sharp, 0.5 * steep);
                    }
                    sharp
                }
            }
        }
    };
    drop_scraps(mesh, &mut sharp, SHORTEST * spacing, is_needed);
    sharp
}

/// The turn across each side, none across edges between the facets of what is meant round, and on steps that are too fine.
fn without_facets(mesh: &Mesh, twin: &[u32], spacing: f64, finest: f64) -> Vec<f64> {
    let mut turns = turns(mesh, twin, spacing, NOTICED);
    let steps = if finest > 0.0 { on_steps(mesh, twin, &turns, finest) } else { vec![false; turns.len()] };
    let facets = between_facets(mesh, twin, &turns, spacing);
    let none = facets.into_iter().zip(steps).map(|(is_between, is_step)| is_between || is_step);
    turns.iter_mut().zip(none).filter(|(_, none)| *none).for_each(|(turn, _)| *turn = 0.0);
    turns
}

fn turned(turns: &[f64], threshold: f64) -> Vec<bool> {
    turns.iter().map(|&turn| turn.abs() >= threshold).collect()
}

/// Lets curves that end go straight on, as long as the surface turns the same way there and by `least` degrees or more: a rim
/// that is steeper here than there stays whole.
fn go_on(mesh: &Mesh, twin: &[u32], turns: &[f64], sharp: &mut [bool], least: f64) {
    let mut sides_from: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for side in (0..twin.len()).filter(|&s| twin[s] != NONE && (sharp[s] || turns[s].abs() >= least)) {
        sides_from.entry(mesh.origin(side as u32)).or_default().push(side);
    }
    let mut reached: Vec<u32> = sides_from.keys().copied().collect();
    while let Some(v) = reached.pop() {
        let sides = &sides_from[&v];
        let mut of_curves = sides.iter().filter(|&&s| sharp[s]);
        let (Some(&last), None) = (of_curves.next(), of_curves.next()) else { continue };
        let is_next = |s: &usize| *s != last && turns[*s] * turns[last] > 0.0;
        let cosine = |s: usize| direction(mesh, s as u32).dot(direction(mesh, last as u32));
        let straightest = sides.iter().copied().filter(is_next).map(|s| (cosine(s), s));
        let Some((cosine, next)) = straightest.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        if cosine < STRAIGHT {
            (sharp[next], sharp[twin[next] as usize]) = (true, true);
            reached.push(mesh.ends(next as u32)[1]);
        }
    }
}

/// The same on each body that is mostly bounded by planes, by a threshold of its own, or where it has none only between two
/// planes: bodies of an assembly may be round, and small ones fill the gap.
fn turned_on_planar_bodies(mesh: &OrientedManifold, twin: &[u32], turns: &[f64], spacing: f64) -> Vec<bool> {
    let planes = Planes::new(mesh, twin, spacing, |t| mesh.provenance().triangle(t));
    let is_between = |side: u32| {
        let across = twin[side as usize];
        across != NONE && [side, across].iter().all(|s| planes.contain(s / 3))
    };
    let mut sharp = vec![false; turns.len()];
    for body in planar_bodies(mesh, &planes) {
        let gap = Histogram::new(mesh, body.iter().map(|&side| (side, turns[side as usize]))).gap();
        for side in body {
            let turn = turns[side as usize].abs();
            sharp[side as usize] = gap.map_or(turn >= BETWEEN_PLANES && is_between(side), |gap| turn >= gap);
        }
    }
    sharp
}

/// The sides along these edges of what the mesh came from, seen from either triangle. A boundary is a curve without that.
fn along(mesh: &OrientedManifold, twin: &[u32], edges: &[[u32; 2]]) -> Vec<bool> {
    let sides = mesh.provenance().sides_along(&mesh.triangles, edges);
    let is_along = |(&side, &across): (&bool, &u32)| across != NONE && (side || sides[across as usize]);
    sides.iter().zip(twin).map(is_along).collect()
}

/// The length of edges by their turn in whole degrees, and the sum of the squares of the lengths of those that may be sharp.
struct Histogram {
    lengths: [f64; 181],
    squares: f64,
}

impl Histogram {
    /// That of these sides of `mesh`, each with its turn.
    fn new(mesh: &Mesh, sides: impl Iterator<Item = (u32, f64)>) -> Histogram {
        let mut histogram = Histogram { lengths: [0.0; 181], squares: 0.0 };
        for (side, turn) in sides {
            let (degrees, length) = (turn.abs() as usize, length(mesh, side));
            histogram.lengths[degrees] += length;
            if degrees >= *THRESHOLDS.start() {
                histogram.squares += length * length;
            }
        }
        histogram
    }

    fn length(&self, degrees: impl SliceIndex<[f64], Output = [f64]>) -> f64 {
        self.lengths[degrees].iter().sum()
    }

    /// The smallest threshold that parts the turns in two groups, if there is one.
    fn gap(&self) -> Option<f64> {
        self.threshold(THRESHOLDS, GAP)
    }

    /// The first of these thresholds with edges below it, from half of it up, that are at most this share of those above it.
    fn threshold(&self, mut thresholds: RangeInclusive<usize>, share: f64) -> Option<f64> {
        let parts = |&threshold: &usize| {
            let above = self.length(threshold..);
            above > 0.0 && self.length(threshold / 2..threshold) <= share * above
        };
        thresholds.find(parts).map(|degrees| degrees as f64)
    }

    /// Whether hardly any edge is flat, and those that are not are far shorter than the `spacing` of the samples.
    fn is_rough(&self, spacing: f64) -> bool {
        let steep = self.length(*THRESHOLDS.start()..);
        self.length(..SMALLEST) < FLAT * steep && self.squares < SHORT * spacing * steep
    }
}

/// Whether a surface is rough, as a scan with noise is, for samples that are `spacing` apart, by the edges of some of its triangles.
/// `twin` is as [`twins`](crate::mesh::topology::twins) says.
pub fn is_rough(mesh: &Mesh, twin: &[u32], spacing: f64) -> bool {
    let step = mesh.triangles.len().div_ceil(LOOKED_AT).max(1);
    let sides = (0..mesh.triangles.len() as u32).step_by(step).flat_map(|t| 3 * t..3 * t + 3);
    let inner = sides.filter(|&side| twin[side as usize] != NONE);
    let turn = |side: u32| {
        let [n, m] = [side, twin[side as usize]].map(|s| mesh.area_vector(s as usize / 3));
        math::atan2(n.cross(m).length(), n.dot(m)).to_degrees()
    };
    Histogram::new(mesh, inner.map(|side| (side, turn(side)))).is_rough(spacing)
}

/// Takes connected nets of sharp edges that are not as long as `shortest` out, but for those beside a triangle that `is_needed`.
fn drop_scraps(mesh: &Mesh, sharp: &mut [bool], shortest: f64, is_needed: impl Fn(u32) -> bool) {
    let mut nets = UnionFind::new(mesh.positions.len());
    let sides = || (0u32..).zip(sharp.iter()).filter(|s| *s.1).map(|s| s.0);
    for side in sides() {
        let [a, b] = mesh.ends(side);
        nets.join(a, b);
    }
    let mut total = vec![0.0; mesh.positions.len()];
    for side in sides() {
        // Both sides of an edge are sharp.
        total[nets.find(mesh.origin(side)) as usize] += length(mesh, side) / 2.0;
    }
    let scraps: Vec<(u32, usize)> =
        sides().map(|side| (side, nets.find(mesh.origin(side)) as usize)).filter(|s| total[s.1] < shortest).collect();
    let mut needed = vec![false; total.len()];
    for &(side, net) in &scraps {
        needed[net] = needed[net] || is_needed(side / 3);
    }
    scraps.into_iter().for_each(|(side, net)| sharp[side as usize] = needed[net]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, units_at};
    use crate::mesh::topology::twins;
    use crate::testing::grid;
    use glam::DVec3;

    /// A prism over a regular polygon of `n` corners, radius 1, with its caps fanned from their middles.
    fn prism(n: u32, height: f64) -> Mesh {
        let rim = |z: f64| {
            (0..n).map(move |i| {
                let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
                DVec3::new(angle.cos(), angle.sin(), z)
            })
        };
        let mut positions: Vec<DVec3> = rim(0.0).chain(rim(height)).collect();
        positions.extend([DVec3::ZERO, DVec3::Z * height]);
        let triangles = (0..n).flat_map(|i| {
            let j = (i + 1) % n;
            [[i, j, n + j], [i, n + j, n + i], [2 * n, j, i], [2 * n + 1, n + i, n + j]]
        });
        Mesh { positions, triangles: triangles.collect() }
    }

    fn sharp_edges(mesh: &Mesh, features: Features, spacing: f64) -> usize {
        let manifold = mesh.clone().try_into().unwrap();
        let sharp = sharp_sides(&manifold, &twins(&mesh.triangles), &features, spacing, 0.0, |_| false);
        sharp.iter().filter(|s| **s).count() / 2
    }

    #[test]
    fn the_rims_of_a_cylinder_are_found_and_its_facets_are_not() {
        let cylinder = prism(32, 2.0);
        assert_eq!(sharp_edges(&cylinder, Features::Automatic, 0.1), 64);
        assert_eq!(sharp_edges(&cylinder, Features::Smooth, 0.1), 0);
        assert_eq!(sharp_edges(&cylinder, Features::Degrees(10.0), 0.1), 96);
    }

    #[test]
    fn rims_shorter_than_a_few_spacings_stay_where_they_are_needed() {
        let small = prism(32, 2.0);
        let manifold = small.clone().try_into().unwrap();
        let kept = |is_needed: &dyn Fn(u32) -> bool| {
            let sharp = sharp_sides(&manifold, &twins(&small.triangles), &Features::Automatic, 3.0, 0.0, is_needed);
            sharp.iter().filter(|s| **s).count() / 2
        };
        assert_eq!(kept(&|_| false), 0);
        let is_at_top = |t: u32| small.corners(t as usize).iter().all(|p| p.z > 1.0);
        assert_eq!(kept(&is_at_top), 32);
    }

    #[test]
    fn of_a_pillar_of_twenty_sides_the_rims_are_found() {
        assert_eq!(sharp_edges(&prism(20, 2.0), Features::Automatic, 0.15), 40);
        assert_eq!(sharp_edges(&prism(20, 2.0), Features::Automatic, 0.03), 60, "facets of many samples are flat");
    }

    #[test]
    fn all_edges_of_a_prism_are_found_but_not_the_diagonals() {
        assert_eq!(sharp_edges(&prism(6, 1.0), Features::Automatic, 0.1), 18);
    }

    #[test]
    fn given_edges_are_sharp_and_no_others() {
        let rim = (0..8).map(|i| [(i + 1) % 8, i]);
        // From the middle of a cap to its rim, and two vertices that no edge joins.
        let others = [[16, 0], [0, 4]];
        assert_eq!(sharp_edges(&prism(8, 1.0), Features::Edges(rim.chain(others).collect()), 0.1), 9);
        assert!(Features::Edges(others.to_vec()).check(17).is_ok());
        assert!(Features::Edges(others.to_vec()).check(16).is_err());
    }

    #[test]
    fn an_edge_of_twenty_degrees_is_found_where_the_rest_is_flat() {
        let rise = 20f64.to_radians().tan();
        let positions = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0]]
            .map(|[x, y]: [f64; 2]| DVec3::new(x, y, rise * (x - 1.0).max(0.0)));
        let triangles = vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
        let roof = Mesh { positions: positions.to_vec(), triangles };
        assert_eq!(sharp_edges(&roof, Features::Automatic, 0.1), 1);
        assert_eq!(sharp_edges(&roof, Features::Automatic, 0.4), 0, "too short for the spacing");
    }

    /// A needle in a flat sheet whose tip rounding has lifted by a tenth of its width stands at 45 degrees to it.
    #[test]
    fn a_needle_makes_no_edge_sharp() {
        let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let positions = vec![p(0., 0., 0.), p(2., 0., 0.), p(1., 1e-4, 1e-4), p(1., -1., 0.), p(1., 1., 0.)];
        let sheet = Mesh { positions, triangles: vec![[0, 1, 2], [1, 0, 3], [2, 1, 4], [0, 2, 4]] };
        assert_eq!(sharp_edges(&sheet, Features::Degrees(10.0), 0.1), 0);
    }

    /// A sheet with bumps of all kinds.
    fn bumpy_sheet() -> Mesh {
        let n = 20u32;
        let height = |i: u32, j: u32| 0.35 * f64::from((i * 7 + j * 13 + i * j * 3) % 11) / 11.0;
        let positions: Vec<DVec3> =
            (0..n * n).map(|v| DVec3::new(f64::from(v % n), f64::from(v / n), height(v % n, v / n))).collect();
        let squares = (0..n - 1).flat_map(|i| (0..n - 1).map(move |j| j * n + i));
        let triangles = squares.flat_map(|v| [[v, v + 1, v + n + 1], [v, v + n + 1, v + n]]).collect();
        Mesh { positions, triangles }
    }

    #[test]
    fn a_bumpy_sheet_has_none() {
        assert_eq!(sharp_edges(&bumpy_sheet(), Features::Automatic, 0.1), 0);
    }

    #[test]
    fn a_curve_goes_straight_on_where_the_surface_turns_by_less() {
        // A ridge whose sides become less steep, with a step across it at its end.
        let rows = [[0.0, 1.0], [1.0, 1.0], [2.0, 0.5], [3.0, 0.3], [3.0, 0.3]];
        let below = |row: usize| if row == 4 { 1.0 } else { 0.0 };
        let positions = (0..rows.len()).flat_map(|i| {
            let [y, drop] = rows[i];
            [-1.0, 0.0, 1.0].map(|x: f64| DVec3::new(x, y, -drop * x.abs() - below(i)))
        });
        let squares = (0..4).flat_map(|row| [3 * row, 3 * row + 1]);
        let triangles = squares.flat_map(|v: u32| [[v, v + 1, v + 4], [v, v + 4, v + 3]]).collect();
        let mesh = Mesh { positions: positions.collect(), triangles };
        let twin = twins(&mesh.triangles);
        let turns = turns(&mesh, &twin, 0.1, 0.0);
        let mut sharp: Vec<bool> = (0..twin.len()).map(|s| [[1, 4], [4, 1]].contains(&mesh.ends(s as u32))).collect();
        go_on(&mesh, &twin, &turns, &mut sharp, 30.0);
        let kept: Vec<[u32; 2]> = (0..twin.len()).filter(|&s| sharp[s]).map(|s| mesh.ends(s as u32)).collect();
        let mut ridge: Vec<[u32; 2]> = kept.into_iter().filter(|[a, b]| a < b).collect();
        ridge.sort_unstable();
        assert_eq!(ridge, [[1, 4], [4, 7], [7, 10]]);
    }

    #[test]
    fn the_rims_of_a_bumpy_block_are_found() {
        // A bumpy sheet, walls down from its rim, and a flat bottom.
        let Mesh { mut positions, mut triangles } = bumpy_sheet();
        let (n, below) = (20, positions.len() as u32);
        positions.iter_mut().for_each(|p| p.z *= 1.3);
        positions.extend_from_within(..);
        positions[below as usize..].iter_mut().for_each(|p| p.z = -3.0);
        let bottom: Vec<[u32; 3]> = triangles.iter().map(|t| [t[0], t[2], t[1]].map(|v| v + below)).collect();
        let rim = (0..n - 1).flat_map(|i| {
            let (front, back, left, right) = (i, (n - 1) * n + i, n * i, n * i + n - 1);
            [[front + 1, front], [back, back + 1], [left, left + n], [right + n, right]]
        });
        triangles.extend(bottom);
        triangles.extend(rim.flat_map(|[a, b]| [[a, b, b + below], [a, b + below, a + below]]));
        assert_eq!(sharp_edges(&Mesh { positions, triangles }, Features::Automatic, 0.1), 2 * 4 * 19 + 4);
    }

    #[test]
    fn where_all_edges_turn_none_is_sharp_but_those_of_large_faces() {
        let height = |u: f64, v: f64| {
            0.05 * units_at(1, Stage::Jitter, ((40.0 * u).round() as u32, (40.0 * v).round() as u64))[0]
        };
        let rough = grid(40, 40, |u, v| DVec3::new(u, v, height(u, v)));
        assert_eq!(sharp_edges(&rough, Features::Automatic, 0.2), 0);
        assert!(sharp_edges(&rough, Features::Automatic, 0.02) > 1000);
    }

    #[test]
    fn beside_a_bumpy_sheet_those_of_a_prism_are_found() {
        let Mesh { mut positions, mut triangles } = bumpy_sheet();
        let prism = prism(6, 0.5);
        let first = positions.len() as u32;
        positions.extend(prism.positions);
        triangles.extend(prism.triangles.iter().map(|t| t.map(|v| first + v)));
        assert_eq!(sharp_edges(&Mesh { positions, triangles }, Features::Automatic, 0.1), 18);
    }

    #[test]
    fn between_the_planes_of_a_body_all_of_whose_turns_occur_edges_are_found() {
        let planes = (0..6).map(|i| (1.0, if i == 3 { 45.0 } else { 0.0 }));
        let waves = [7.0, -9.0, 12.0, -15.0, 20.0, -26.0, 34.0, -44.0, 58.0].map(|turn| (0.3, turn));
        let (mut at, mut angle, mut profile) = (DVec3::ZERO, 0f64, vec![DVec3::ZERO]);
        for (width, turn) in planes.chain(waves) {
            angle += turn;
            let (sin, cos) = angle.to_radians().sin_cos();
            at += width * DVec3::new(cos, 0.0, -sin);
            profile.push(at);
        }
        let n = profile.len() as u32 - 1;
        let roof = grid(n, 1, |u, v| profile[(f64::from(n) * u).round() as usize] + 5.0 * v * DVec3::Y);
        assert_eq!(sharp_edges(&roof, Features::Automatic, 0.1), 1);
    }
}
