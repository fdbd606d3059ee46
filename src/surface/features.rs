//! Sharp edges of a mesh.
//!
//! An edge is sharp if its dihedral angle reaches a threshold. If none is given, it is derived from the mesh: the smallest
//! threshold that separates the dihedral angles into two groups. On a CAD part, nearly all edges are either almost flat or
//! clearly sharp. On a scan, the number of edges decreases steadily with their angle, without a gap; there, edges are sharp
//! only on bodies that are mostly bounded by planes ([`planes`](crate::surface::planes)), or if they are far steeper than
//! most. Where hardly any edge is flat, and edges are far shorter than the spacing, the surface is rough, and no edge is
//! sharp. Sharp edges can also be given one by one; if such an edge was split, all its parts are sharp.
//!
//! Edges between the facets of a surface meant to be round do not count, nor do the steps of points on a lattice
//! ([`facets`](crate::surface::facets)).
//!
//! Nets of sharp edges with a total length of less than a few spacings are dropped: at that spacing they are noise, or rims
//! that a mesh can do without. They are kept where they turned out to be needed.
//!
//! Cost: linear in the triangles.

use crate::base::error::{Error, Result, Setting};
use crate::base::math;
use crate::base::union_find::UnionFind;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::surface::dihedral_angles::{dihedral_angles, direction, length};
use crate::surface::facets::{NOTICED, STRAIGHT, between_facets, on_steps};
use crate::surface::planes::{Planes, planar_bodies};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::slice::SliceIndex;

/// Edges of the input to keep sharp.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Features {
    /// Derived from the dihedral angles of the input.
    #[default]
    Automatic,
    /// Edges with at least this dihedral angle, in degrees.
    Degrees(f64),
    /// These edges, by their end vertices.
    Edges(Vec<[u32; 2]>),
    /// None.
    Smooth,
}

impl Features {
    /// Checks that all ends are less than the number of `vertices`.
    ///
    /// # Errors
    /// [`Error::Option`] with the first edge for which this fails.
    pub fn check(&self, vertices: usize) -> Result<()> {
        let Features::Edges(edges) = self else { return Ok(()) };
        let wrong = edges.iter().find(|ends| ends.iter().any(|&v| v as usize >= vertices));
        wrong.map_or(Ok(()), |[a, b]| {
            let cause =
                format!("vertices {a} and {b} cannot be the ends of an edge: the mesh has only {vertices} vertices");
            Err(Error::Option { option: Setting::Features, cause, remedy: "give edges of this mesh".into() })
        })
    }
}

/// Thresholds to try, in degrees, in ascending order.
const THRESHOLDS: RangeInclusive<usize> = 15..=60;

/// Smallest dihedral angle that any of them depends on.
const SMALLEST: usize = *THRESHOLDS.start() / 2;

/// Largest total length of the edges between half the threshold and the threshold, relative to that of the edges above it.
/// Fifteen scans and sculpts have between 1.5 and 40 at every threshold, CAD parts 0.1 and less.
const GAP: f64 = 0.2;

/// Steeper thresholds and their ratio, for surfaces without a gap at the others. Round surfaces hardly ever have such large
/// dihedral angles, so a larger ratio is conclusive. Of 216 models, decimated CAD parts mostly have .65 and less; scans,
/// sculpts and game assets more than 1; and a wire chair .78.
const STEEP: RangeInclusive<usize> = 61..=85;
const STEEP_GAP: f64 = 0.7;

/// A surface is rough if the total length of its flat edges is less than `FLAT` times that of the edges from the smallest
/// threshold up, and the length-weighted mean length of the latter is less than `SHORT` spacings. Noise of a half and of a
/// whole edge length gives a ratio of .14 to .31 and, at six edges a spacing, a mean length of .16; of 300 scans, sculpts,
/// game assets and CAD parts, those with as few flat edges have mean lengths of .8 and more.
const FLAT: f64 = 0.35;
const SHORT: f64 = 0.5;

/// Maximum number of triangles examined to tell whether a surface is rough.
const LOOKED_AT: usize = 4000;

/// Dihedral angle, in degrees, from which an edge between two planes is sharp, whatever the other edges are.
pub const BETWEEN_PLANES: f64 = 30.0;

/// Minimum total length of a connected net of sharp edges, in spacings.
pub const SHORTEST: f64 = 3.0;

/// Returns whether each side `3 t + k` of the triangles is on a sharp edge. `twin` is the result of
/// [`twins`](crate::mesh::topology::twins), `spacing` that of the samples, in the units of the mesh. Edges of steps no wider
/// than `finest` do not count. Short nets beside a triangle that `is_needed` are kept.
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
        Features::Degrees(degrees) => turned(&dihedral_angles(mesh, twin, spacing, *degrees), *degrees),
        Features::Automatic => {
            let dihedral_angles = without_facets(mesh, twin, spacing, finest);
            let histogram = Histogram::new(mesh, (0..).zip(dihedral_angles.iter().copied()));
            match histogram.gap() {
                _ if histogram.is_rough(spacing) => vec![false; dihedral_angles.len()],
                Some(threshold) => turned(&dihedral_angles, threshold),
                None => {
                    let mut sharp = turned_on_planar_bodies(mesh, twin, &dihedral_angles, spacing);
                    if let Some(steep) = histogram.threshold(STEEP, STEEP_GAP) {
                        sharp.iter_mut().zip(&dihedral_angles).for_each(|(sharp, turn)| *sharp |= turn.abs() >= steep);
                        go_on(mesh, twin, &dihedral_angles, &mut sharp, 0.5 * steep);
                    }
                    sharp
                }
            }
        }
    };
    drop_scraps(mesh, &mut sharp, SHORTEST * spacing, is_needed);
    sharp
}

/// Returns the dihedral angle across each side; zero on edges between facets of a round surface and on steps that are too
/// fine.
fn without_facets(mesh: &Mesh, twin: &[u32], spacing: f64, finest: f64) -> Vec<f64> {
    let mut dihedral_angles = dihedral_angles(mesh, twin, spacing, NOTICED);
    let steps =
        if finest > 0.0 { on_steps(mesh, twin, &dihedral_angles, finest) } else { vec![false; dihedral_angles.len()] };
    let facets = between_facets(mesh, twin, &dihedral_angles, spacing);
    let none = facets.into_iter().zip(steps).map(|(is_between, is_step)| is_between || is_step);
    dihedral_angles.iter_mut().zip(none).filter(|(_, none)| *none).for_each(|(turn, _)| *turn = 0.0);
    dihedral_angles
}

fn turned(dihedral_angles: &[f64], threshold: f64) -> Vec<bool> {
    dihedral_angles.iter().map(|&turn| turn.abs() >= threshold).collect()
}

/// Extends curves straight beyond their ends, where the surface turns in the same direction by `least` degrees or more, so
/// that a rim whose steepness varies stays whole.
fn go_on(mesh: &Mesh, twin: &[u32], dihedral_angles: &[f64], sharp: &mut [bool], least: f64) {
    let mut sides_from: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for side in (0..twin.len()).filter(|&s| twin[s] != NONE && (sharp[s] || dihedral_angles[s].abs() >= least)) {
        sides_from.entry(mesh.origin(side as u32)).or_default().push(side);
    }
    let mut reached: Vec<u32> = sides_from.keys().copied().collect();
    while let Some(v) = reached.pop() {
        let sides = &sides_from[&v];
        let mut of_curves = sides.iter().filter(|&&s| sharp[s]);
        let (Some(&last), None) = (of_curves.next(), of_curves.next()) else { continue };
        let is_next = |s: &usize| *s != last && dihedral_angles[*s] * dihedral_angles[last] > 0.0;
        let cosine = |s: usize| direction(mesh, s as u32).dot(direction(mesh, last as u32));
        let straightest = sides.iter().copied().filter(is_next).map(|s| (cosine(s), s));
        let Some((cosine, next)) = straightest.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        if cosine < STRAIGHT {
            (sharp[next], sharp[twin[next] as usize]) = (true, true);
            reached.push(mesh.ends(next as u32)[1]);
        }
    }
}

/// Returns the sharp sides of bodies that are mostly bounded by planes, each by its own threshold or, if it has none, only
/// those between two planes. In an assembly, other bodies may be round, and small ones may fill the gap.
fn turned_on_planar_bodies(mesh: &OrientedManifold, twin: &[u32], dihedral_angles: &[f64], spacing: f64) -> Vec<bool> {
    let planes = Planes::new(mesh, twin, spacing, |t| mesh.provenance().triangle(t));
    let is_between = |side: u32| {
        let across = twin[side as usize];
        across != NONE && [side, across].iter().all(|s| planes.contain(s / 3))
    };
    let mut sharp = vec![false; dihedral_angles.len()];
    for body in planar_bodies(mesh, &planes) {
        let gap = Histogram::new(mesh, body.iter().map(|&side| (side, dihedral_angles[side as usize]))).gap();
        for side in body {
            let turn = dihedral_angles[side as usize].abs();
            sharp[side as usize] = gap.map_or(turn >= BETWEEN_PLANES && is_between(side), |gap| turn >= gap);
        }
    }
    sharp
}

/// Returns whether each side lies along one of these edges of the source mesh, on either face. Boundary edges are curves
/// anyway.
fn along(mesh: &OrientedManifold, twin: &[u32], edges: &[[u32; 2]]) -> Vec<bool> {
    let sides = mesh.provenance().sides_along(&mesh.triangles, edges);
    let is_along = |(&side, &across): (&bool, &u32)| across != NONE && (side || sides[across as usize]);
    sides.iter().zip(twin).map(is_along).collect()
}

/// Total length of the edges by their dihedral angle in whole degrees, and the sum of the squared lengths of those that may
/// be sharp.
struct Histogram {
    lengths: [f64; 181],
    squares: f64,
}

impl Histogram {
    /// Builds the histogram of the given sides of `mesh`, each with its dihedral angle.
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

    /// Returns the smallest threshold that separates the dihedral angles into two groups, if any does.
    fn gap(&self) -> Option<f64> {
        self.threshold(THRESHOLDS, GAP)
    }

    /// Returns the first threshold for which the edges between its half and itself have at most this share of the length of
    /// those above.
    fn threshold(&self, mut thresholds: RangeInclusive<usize>, share: f64) -> Option<f64> {
        let parts = |&threshold: &usize| {
            let above = self.length(threshold..);
            above > 0.0 && self.length(threshold / 2..threshold) <= share * above
        };
        thresholds.find(parts).map(|degrees| degrees as f64)
    }

    /// Returns whether hardly any edge is flat, and the other edges are far shorter than the `spacing` of the samples.
    fn is_rough(&self, spacing: f64) -> bool {
        let steep = self.length(*THRESHOLDS.start()..);
        self.length(..SMALLEST) < FLAT * steep && self.squares < SHORT * spacing * steep
    }
}

/// Returns whether a surface is rough, as a noisy scan is, at this `spacing` of the samples, judging by the edges of some of
/// its triangles. `twin` is the result of [`twins`](crate::mesh::topology::twins).
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

/// Drops connected nets of sharp edges shorter than `shortest`, except those beside a triangle that `is_needed`.
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

    /// A prism over a regular polygon with `n` corners and radius 1, its caps fanned from their centres.
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
        // An edge from the centre of a cap to its rim, and two vertices that no edge joins.
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

    /// A needle in a flat sheet: rounding has lifted its tip by a tenth of its width, and so tilts it by 45 degrees.
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
        // A ridge with sides that become less steep, and a step across it at its end.
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
        let dihedral_angles = dihedral_angles(&mesh, &twin, 0.1, 0.0);
        let mut sharp: Vec<bool> = (0..twin.len()).map(|s| [[1, 4], [4, 1]].contains(&mesh.ends(s as u32))).collect();
        go_on(&mesh, &twin, &dihedral_angles, &mut sharp, 30.0);
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
