//! Turns arbitrary triangles into an oriented 2-manifold.
//!
//! Steps, in order:
//!
//! 1. Vertices at exactly the same place are merged. Triangles that lose a corner by this, faces between the cells of a
//!    volume, and copies of a triangle are dropped; all copies are dropped where the surface is closed without them.
//!    Triangles without area but with three distinct corners stay: they carry connectivity.
//! 2. Faces are glued in pairs along edges. Where an edge has more than two faces, the pairs that bound a solid wedge are
//!    glued if as many faces run along the edge as against it; otherwise the flattest pairs are glued, those of closed
//!    patches first. A face left over gets a boundary there.
//! 3. Orientation spreads across the glued pairs; each component keeps the orientation that most of its area had. A surface
//!    that cannot be oriented (a Möbius strip) is cut open.
//! 4. Every fan of glued faces around a vertex gets a vertex of its own, which separates bow ties.
//! 5. Components without area are dropped.
//!
//! Based on: A. Guéziec, G. Taubin, F. Lazarus, W. Horn, Cutting and stitching: converting sets of polygons to manifold
//! surfaces, 2001, DOI 10.1109/2945.928166. Departure: gluing by wedge and flatness instead of by snapping boundaries.
//!
//! Cost: sorting the vertices and the edges; linear otherwise.

use crate::base::math;
use crate::base::parallel;
use crate::base::union_find::UnionFind;
use crate::mesh::half_edge::{next, prev};
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::provenance::Provenance;
use crate::mesh::sides::{Side, edges, pairs_of_sides, sorted_sides};
use crate::mesh::topology::{NONE, components, twins};
use crate::mesh::triangle_mesh::Mesh;
use crate::prepare::cells::{coincident, faces_between_cells, on_closed_surface};
use crate::prepare::repairs::Repairs;
use crate::prepare::welded::Welded;
use glam::DVec3;

/// Returns the oriented 2-manifold made of `mesh`, and what was done.
pub fn repair(mesh: &Mesh) -> (OrientedManifold, Repairs) {
    let Repaired { mesh, repairs, .. } = repair_welded(mesh.positions.clone(), Welded::at_places(mesh));
    (mesh, repairs)
}

/// A mesh that was made an oriented 2-manifold.
pub struct Repaired {
    /// The manifold.
    pub mesh: OrientedManifold,
    /// What was done.
    pub repairs: Repairs,
    /// The [`twins`] of its triangles.
    pub twins: Vec<u32>,
}

/// Like [`repair`], for vertices at `positions` that are welded already.
pub fn repair_welded(positions: Vec<DVec3>, mut welded: Welded) -> Repaired {
    let mut repairs = welded.repairs;
    drop_faces_between_cells(&mut welded, &mut repairs);
    drop_duplicates(&mut welded, &mut repairs);
    let Welded { representatives, mut triangles, sources, sides, .. } = welded;
    let mut partner = glue(&positions, &triangles, &sides, &mut repairs);
    drop(sides);
    orient(&positions, &mut triangles, &mut partner, &mut repairs);
    let (mut result, vertices) = separate_fans(positions, triangles, &partner, &mut repairs);
    let mut provenance = Provenance::new(representatives, vertices, sources);
    if repairs.cut_edges + repairs.unorientable_edges > 0 {
        split_repeated_edges(&mut result, &mut provenance, &partner);
    }
    let mesh = drop_flat_components(result, provenance, &mut repairs);
    let is_same = repairs.cut_edges + repairs.unorientable_edges == 0 && partner.len() == 3 * mesh.triangles.len();
    let twins = if is_same { partner } else { twins(&mesh.triangles) };
    Repaired { mesh, repairs, twins }
}

/// Keeps only the outside of a volume that is listed cell by cell.
fn drop_faces_between_cells(welded: &mut Welded, repairs: &mut Repairs) {
    if let Some(between) = faces_between_cells(&welded.triangles, &welded.sides) {
        repairs.faces_between_cells = welded.drop_marked(&between);
    }
}

/// Keeps the first of several triangles with the same three corners, and none if the surface is closed without them.
fn drop_duplicates(welded: &mut Welded, repairs: &mut Repairs) {
    let groups: Vec<Vec<u32>> = coincident(&welded.triangles, &welded.sides).collect();
    let mut copy = on_closed_surface(&welded.triangles, &welded.sides, &groups);
    groups.iter().for_each(|group| group[1..].iter().for_each(|&t| copy[t as usize] = true));
    repairs.duplicate_triangles = welded.drop_marked(&copy);
}

/// Returns, for each side, the side that it is glued to, or [`NONE`].
fn glue(positions: &[DVec3], triangles: &[[u32; 3]], sides: &[Side], repairs: &mut Repairs) -> Vec<u32> {
    let mut partner = pairs_of_sides(sides, 3 * triangles.len(), |_, _| true);
    let crowded = || edges(sides).filter(|e| e.len() > 2);
    repairs.cut_edges = crowded().count();
    if repairs.cut_edges > 0 {
        let loose = reaches_boundary(&partner, edges(sides));
        for sheets in crowded() {
            for (a, b) in pair_sheets(positions, triangles, sheets, &loose) {
                let [a, b] = [a, b].map(|i| sheets[i].side);
                (partner[a as usize], partner[b as usize]) = (b, a);
            }
        }
    }
    partner
}

/// Iterates over the pairs of glued sides, each pair once.
fn glued(partner: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    (0u32..).zip(partner).filter(|(side, other)| **other != NONE && side < other).map(|(side, &other)| [side, other])
}

/// Returns, for each triangle, whether its patch, which is bounded by edges with more than two faces, also has an open
/// boundary.
fn reaches_boundary<'a>(partner: &[u32], edges: impl Iterator<Item = &'a [Side]>) -> Vec<bool> {
    let count = partner.len() / 3;
    let mut patches = UnionFind::new(count);
    for [a, b] in glued(partner) {
        patches.join(a / 3, b / 3);
    }
    let mut open = vec![false; count];
    for edge in edges.filter(|e| e.len() == 1) {
        open[patches.find(edge[0].side / 3) as usize] = true;
    }
    (0..count as u32).map(|t| open[patches.find(t) as usize]).collect()
}

/// Decides which of the three or more faces at an edge belong together. Returns pairs of indices into `sheets`. A solid must
/// not be opened for the sake of a fin, so faces of patches that are open elsewhere (`loose`) come last.
fn pair_sheets(positions: &[DVec3], triangles: &[[u32; 3]], sheets: &[Side], loose: &[bool]) -> Vec<(usize, usize)> {
    let [lo, hi] = sheets[0].ends().map(|v| positions[v as usize]);
    let axis = (hi - lo).normalize_or_zero();
    let (x, y) = axis.any_orthonormal_pair();
    let angle = |s: &Side| {
        let apex = triangles[s.side as usize / 3][(s.side as usize + 2) % 3];
        let out = positions[apex as usize] - lo;
        math::atan2(out.dot(y), out.dot(x))
    };
    let angles: Vec<f64> = sheets.iter().map(angle).collect();
    let mut order: Vec<usize> = (0..sheets.len()).collect();
    order.sort_by(|&a, &b| angles[a].total_cmp(&angles[b]).then(a.cmp(&b)));
    let forward = sheets.iter().filter(|s| s.forward()).count();
    let alternate = (1..order.len()).all(|i| sheets[order[i]].forward() != sheets[order[i - 1]].forward());
    let is_loose = |s: &Side| loose[s.side as usize / 3];
    let alike = sheets.iter().all(|s| is_loose(s) == is_loose(&sheets[0]));
    if 2 * forward == sheets.len() && (alternate || alike) {
        return nested_pairs(&order, sheets);
    }
    flattest_pairs(&angles, sheets, loose)
}

/// Returns the pairs that bound wedges, nested like brackets, so that no two sheets cross at the edge. A face that runs
/// along the axis has its inside at smaller angles, so it closes the wedge of a preceding face. `order` is by angle.
fn nested_pairs(order: &[usize], sheets: &[Side]) -> Vec<(usize, usize)> {
    let (mut open, mut closed, mut pairs) = (Vec::new(), vec![false; sheets.len()], Vec::new());
    for &i in order.iter().chain(order) {
        if !sheets[i].forward() && !closed[i] && !open.contains(&i) {
            open.push(i);
        } else if sheets[i].forward()
            && !closed[i]
            && let Some(first) = open.pop()
        {
            (closed[i], closed[first]) = (true, true);
            pairs.push((i, first));
        }
    }
    pairs
}

fn flattest_pairs(angles: &[f64], sheets: &[Side], loose: &[bool]) -> Vec<(usize, usize)> {
    let bend = |a: usize, b: usize| ((angles[a] - angles[b]).abs() - std::f64::consts::PI).abs();
    let mut all: Vec<(usize, usize)> =
        (0..angles.len()).flat_map(|a| (a + 1..angles.len()).map(move |b| (a, b))).collect();
    let is_loose = |a: usize| loose[sheets[a].side as usize / 3];
    let clash = |a: usize, b: usize| (is_loose(a) || is_loose(b), sheets[a].forward() == sheets[b].forward());
    all.sort_by(|&(a, b), &(c, d)| {
        clash(a, b).cmp(&clash(c, d)).then(bend(a, b).total_cmp(&bend(c, d))).then((a, b).cmp(&(c, d)))
    });
    let mut free = vec![true; angles.len()];
    all.retain(|&(a, b)| {
        free[a] && free[b] && {
            (free[a], free[b]) = (false, false);
            true
        }
    });
    all
}

/// Turns triangles over so that all glued pairs agree, and unglues the pairs that cannot agree.
fn orient(positions: &[DVec3], triangles: &mut [[u32; 3]], partner: &mut Vec<u32>, repairs: &mut Repairs) {
    let agree = |triangles: &[[u32; 3]], side: u32, other: u32| {
        triangles[side as usize / 3][side as usize % 3] != triangles[other as usize / 3][other as usize % 3]
    };
    let fits = |side: usize| partner[side] == NONE || agree(triangles, side as u32, partner[side]);
    if parallel::all(partner.len(), fits) {
        return;
    }
    let flipped = spread_orientation(positions, triangles, partner, |side, other| agree(triangles, side, other));
    // A turned triangle [a, b, c] becomes [a, c, b]: side 0 (ab) becomes side 2, side 1 (bc) stays, side 2 becomes side 0.
    let turned = |s: u32| if flipped[s as usize / 3] { s / 3 * 3 + 2 - s % 3 } else { s };
    let mut after = vec![NONE; partner.len()];
    for [a, b] in glued(partner) {
        let fits = agree(triangles, a, b) == (flipped[a as usize / 3] == flipped[b as usize / 3]);
        repairs.unorientable_edges += usize::from(!fits);
        if fits {
            let [a, b] = [a, b].map(turned);
            (after[a as usize], after[b as usize]) = (b, a);
        }
    }
    *partner = after;
    for (t, _) in triangles.iter_mut().zip(&flipped).filter(|(_, f)| **f) {
        t.swap(1, 2);
        repairs.flipped_triangles += 1;
    }
}

/// Returns, for each triangle, whether it has to be turned over, by a breadth-first search over the glued pairs.
fn spread_orientation(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    partner: &[u32],
    agree: impl Fn(u32, u32) -> bool,
) -> Vec<bool> {
    let area = |t: usize| {
        let [a, b, c] = triangles[t].map(|v| positions[v as usize]);
        (b - a).cross(c - a).length()
    };
    let mut flipped = vec![false; triangles.len()];
    let mut seen = vec![false; triangles.len()];
    for start in 0..triangles.len() {
        if seen[start] {
            continue;
        }
        seen[start] = true;
        let mut component = vec![start];
        let mut next = 0;
        while next < component.len() {
            let t = component[next];
            next += 1;
            for side in (3 * t..3 * t + 3).filter(|&s| partner[s] != NONE) {
                let other = partner[side];
                let u = other as usize / 3;
                if !seen[u] {
                    seen[u] = true;
                    flipped[u] = flipped[t] == agree(side as u32, other);
                    component.push(u);
                }
            }
        }
        let (turned, kept) = component.iter().fold((0.0, 0.0), |(turned, kept), &t| {
            if flipped[t] { (turned + area(t), kept) } else { (turned, kept + area(t)) }
        });
        if turned > kept {
            component.iter().for_each(|&t| flipped[t] = !flipped[t]);
        }
    }
    flipped
}

/// Makes one vertex for each fan of glued faces, ordered by original vertex, then by corner. Returns the mesh and the
/// original of each vertex; unused vertices are dropped.
fn separate_fans(
    mut positions: Vec<DVec3>,
    mut triangles: Vec<[u32; 3]>,
    partner: &[u32],
    repairs: &mut Repairs,
) -> (Mesh, Vec<u32>) {
    let Some(used) = used_with_one_fan(positions.len(), &triangles, partner) else {
        return split_fans(&positions, &triangles, partner, repairs);
    };
    if used.len() < positions.len() {
        let mut number = vec![NONE; positions.len()];
        (0..).zip(&used).for_each(|(n, &v)| number[v as usize] = n);
        parallel::for_each_mut(&mut triangles, |_, t| *t = t.map(|v| number[v as usize]));
        positions = used.iter().map(|&v| positions[v as usize]).collect();
    }
    (Mesh { positions, triangles }, used)
}

/// Returns the vertices that triangles use, or `None` if one of them has several fans.
fn used_with_one_fan(vertices: usize, triangles: &[[u32; 3]], partner: &[u32]) -> Option<Vec<u32>> {
    let mut corner = vec![NONE; vertices];
    let mut corners = vec![0u32; vertices];
    for (c, &v) in (0..).zip(triangles.iter().flatten()) {
        corner[v as usize] = c;
        corners[v as usize] += 1;
    }
    let one_fan = |v: usize| corner[v] == NONE || corners_of_fan(partner, corner[v]) == corners[v];
    parallel::all(vertices, one_fan).then(|| (0..vertices as u32).filter(|&v| corner[v as usize] != NONE).collect())
}

/// Returns the number of corners in the fan of corner `first`.
fn corners_of_fan(partner: &[u32], first: u32) -> u32 {
    let onwards = |c: u32| Some(partner[c as usize]).filter(|&side| side != NONE).map(next);
    let back = |c: u32| Some(partner[prev(c) as usize]).filter(|&side| side != NONE);
    let (mut count, mut at) = (1, first);
    while let Some(c) = onwards(at) {
        if c == first {
            return count;
        }
        (count, at) = (count + 1, c);
    }
    at = first;
    while let Some(c) = back(at) {
        (count, at) = (count + 1, c);
    }
    count
}

/// [`separate_fans`] for vertices with several fans.
fn split_fans(positions: &[DVec3], triangles: &[[u32; 3]], partner: &[u32], repairs: &mut Repairs) -> (Mesh, Vec<u32>) {
    let mut fans = UnionFind::new(3 * triangles.len());
    for [a, b] in glued(partner) {
        fans.join(a, next(b));
        fans.join(next(a), b);
    }
    let corner_vertex = |c: u32| triangles[c as usize / 3][c as usize % 3];
    let mut roots: Vec<u32> = (0..3 * triangles.len() as u32).filter(|&c| fans.find(c) == c).collect();
    roots.sort_by_key(|&c| (corner_vertex(c), c));
    repairs.split_vertices = roots.windows(2).filter(|w| corner_vertex(w[0]) == corner_vertex(w[1])).count();
    let mut number = vec![0u32; 3 * triangles.len()];
    for (&c, n) in roots.iter().zip(0u32..) {
        number[c as usize] = n;
    }
    let mut vertex = |c: usize| number[fans.find(c as u32) as usize];
    let triangles = (0..triangles.len()).map(|t| [vertex(3 * t), vertex(3 * t + 1), vertex(3 * t + 2)]).collect();
    let vertices: Vec<u32> = roots.into_iter().map(corner_vertex).collect();
    (Mesh { positions: vertices.iter().map(|&v| positions[v as usize]).collect(), triangles }, vertices)
}

/// Splits repeated edges: where a surface touches itself along an edge and each end is in one fan, the edge still occurs
/// twice. All of its copies but one, each a glued pair of sides or a boundary, get a vertex in the middle.
fn split_repeated_edges(mesh: &mut Mesh, provenance: &mut Provenance, partner: &[u32]) {
    let sides = sorted_sides(&mesh.triangles);
    let mut middles: Vec<(u32, u32)> = Vec::new();
    for edge in edges(&sides) {
        // Sides of an edge are in increasing order, so the first of a pair represents both.
        let copies = edge.iter().map(|s| s.side).filter(|&s| partner[s as usize] > s);
        for side in copies.skip(1) {
            let middle = mesh.positions.len() as u32;
            let [lo, hi] = edge[0].ends().map(|v| mesh.positions[v as usize]);
            mesh.positions.push((lo + hi) / 2.0);
            provenance.insert_on_edge(edge[0].ends(), 0.5);
            middles.extend([side, partner[side as usize]].into_iter().filter(|&s| s != NONE).map(|s| (s, middle)));
        }
    }
    middles.sort_unstable();
    for of_triangle in middles.chunk_by(|a, b| a.0 / 3 == b.0 / 3) {
        let t = of_triangle[0].0 as usize / 3;
        let corners = mesh.triangles[t];
        let mut ring = Vec::with_capacity(6);
        for (k, &corner) in corners.iter().enumerate() {
            ring.push(corner);
            ring.extend(of_triangle.iter().filter(|m| m.0 as usize % 3 == k).map(|m| m.1));
        }
        // A fan around an edge midpoint has no flat triangle.
        ring.rotate_left(of_triangle[0].0 as usize % 3 + 1);
        mesh.triangles[t] = [ring[0], ring[1], ring[2]];
        for i in 2..ring.len() - 1 {
            mesh.triangles.push([ring[0], ring[i], ring[i + 1]]);
            provenance.insert_part(t as u32);
        }
    }
}

/// Returns the manifold without its components that have no area.
fn drop_flat_components(mut mesh: Mesh, provenance: Provenance, repairs: &mut Repairs) -> OrientedManifold {
    if parallel::all(mesh.triangles.len(), |t| mesh.area_vector(t) != DVec3::ZERO) {
        return OrientedManifold::trusted(mesh, provenance);
    }
    let component = components(mesh.positions.len(), &mesh.triangles);
    let mut has_area = vec![false; mesh.positions.len()];
    for t in 0..mesh.triangles.len() {
        has_area[component[mesh.triangles[t][0] as usize] as usize] |= mesh.area_vector(t) != DVec3::ZERO;
    }
    let stays = |v: u32| has_area[component[v as usize] as usize];
    let triangles: Vec<u32> = (0..).zip(&mesh.triangles).filter(|(_, t)| stays(t[0])).map(|(t, _)| t).collect();
    if triangles.len() == mesh.triangles.len() {
        return OrientedManifold::trusted(mesh, provenance);
    }
    repairs.degenerate_triangles += mesh.triangles.len() - triangles.len();
    let vertices: Vec<u32> = (0..mesh.positions.len() as u32).filter(|&v| stays(v)).collect();
    mesh.triangles = triangles.iter().map(|&t| mesh.triangles[t as usize]).collect();
    mesh.drop_unused();
    OrientedManifold::trusted(mesh, provenance.select(&vertices, &triangles))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream};
    use crate::mesh::topology::topology;
    use crate::testing::{cube, joined, moved};
    use glam::dvec3;
    use rand_chacha::rand_core::Rng;

    fn soup(meshes: impl IntoIterator<Item = Mesh>) -> Mesh {
        let all = joined(meshes);
        Mesh::soup((0..all.triangles.len()).map(|t| all.corners(t)))
    }

    fn audit(mesh: &Mesh) -> crate::mesh::topology::Topology {
        let t = topology(mesh.positions.len(), &mesh.triangles);
        assert!(t.is_manifold() && t.is_oriented(), "{t:?}");
        assert_eq!(t.vertices, mesh.positions.len());
        t
    }

    #[test]
    fn a_clean_mesh_stays_as_it_is() {
        let cube = cube();
        let (same, repairs) = repair(&cube);
        assert_eq!(repairs, Repairs::default());
        assert_eq!(same.into_mesh(), cube);
    }

    #[test]
    fn a_soup_is_welded() {
        let (mesh, repairs) = repair(&soup([cube()]));
        assert_eq!(repairs, Repairs { welded_vertices: 28, ..Repairs::default() });
        assert_eq!(audit(&mesh).euler, 2);
    }

    #[test]
    fn cubes_that_share_an_edge_or_a_corner_come_apart_closed() {
        for shift in [dvec3(1.0, 1.0, 0.0), dvec3(1.0, 1.0, 1.0)] {
            let (mesh, repairs) = repair(&soup([cube(), moved(cube(), shift)]));
            let t = audit(&mesh);
            assert_eq!((t.components, t.euler, t.boundary_loops), (2, 4, 0), "{shift}");
            assert!(repairs.split_vertices > 0);
        }
    }

    #[test]
    fn turned_faces_are_turned_back() {
        let mut mesh = cube();
        mesh.triangles[3].swap(0, 1);
        mesh.triangles[8].swap(1, 2);
        let (mended, repairs) = repair(&mesh);
        assert_eq!(repairs.flipped_triangles, 2);
        assert_eq!(audit(&mended).euler, 2);
        let volume: f64 = (0..12).map(|t| mended.corners(t)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
        assert!((volume - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_moebius_strip_is_cut_open() {
        let n = 12u32;
        let point = |i: u32, side: f64| {
            let a = std::f64::consts::TAU * f64::from(i) / f64::from(n);
            let (r, z) = (3.0 + side * (a / 2.0).cos(), side * (a / 2.0).sin());
            dvec3(r * a.cos(), r * a.sin(), z)
        };
        let positions = (0..n).flat_map(|i| [point(i, 1.0), point(i, -1.0)]).collect();
        let next = |i: u32, side: u32| if i + 1 < n { 2 * (i + 1) + side } else { 1 - side };
        let triangles =
            (0..n).flat_map(|i| [[2 * i, 2 * i + 1, next(i, 0)], [2 * i + 1, next(i, 1), next(i, 0)]]).collect();
        let (mesh, repairs) = repair(&Mesh { positions, triangles });
        assert_eq!(repairs.unorientable_edges, 1);
        assert_eq!(audit(&mesh).components, 1);
    }

    #[test]
    fn sheets_at_an_edge_do_not_cross_there() {
        // A plus sign: two of its arms run along the edge, two against it.
        let arms = [DVec3::Y, DVec3::Z, -DVec3::Y, -DVec3::Z];
        let positions = [DVec3::ZERO, DVec3::X].into_iter().chain(arms).collect();
        let (mesh, repairs) = repair(&Mesh { positions, triangles: vec![[0, 1, 2], [1, 0, 3], [1, 0, 4], [0, 1, 5]] });
        assert_eq!((repairs.cut_edges, audit(&mesh).components), (1, 2));
        for sheet in mesh.triangles.chunks(2) {
            let [a, b] = [0, 1].map(|t| mesh.positions[*sheet[t].iter().max().unwrap() as usize]);
            assert_eq!(a.dot(b), 0.0, "neighbouring arms, {:?}", mesh.triangles);
        }
    }

    #[test]
    fn a_third_face_becomes_a_sheet_of_its_own() {
        let mut mesh = cube();
        mesh.positions.push(dvec3(0.5, -1.0, -1.0));
        mesh.triangles.push([0, 1, 8]);
        let (mended, repairs) = repair(&mesh);
        assert_eq!(repairs.cut_edges, 1);
        assert_eq!((audit(&mended).components, audit(&mended).boundary_loops), (2, 1));
    }

    #[test]
    fn copies_and_flat_triangles_go() {
        let mut mesh = cube();
        mesh.triangles.push([3, 0, 2]);
        mesh.triangles.push([4, 4, 2]);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([DVec3::ZERO, DVec3::X, DVec3::X * 2.0].map(|p| p + DVec3::Z * 9.0));
        mesh.triangles.push([first, first + 1, first + 2]);
        let (mended, repairs) = repair(&mesh);
        assert_eq!((repairs.duplicate_triangles, repairs.degenerate_triangles), (1, 2));
        assert_eq!((audit(&mended).euler, mended.triangles.len()), (2, 12));
    }

    #[test]
    fn copies_on_a_closed_surface_go_and_a_sheet_of_them_that_sticks_out_stays() {
        let mut mesh = cube();
        let [a, b, _] = mesh.triangles[0];
        // The fourth corner of the square face; the triangle of a, b and this corner is neither of its halves.
        let [at_a, at_b, at_c] = mesh.corners(0);
        let fourth = mesh.positions.iter().position(|p| p.distance(at_a + at_c - at_b) < 1e-9);
        let d = fourth.expect("a face has four corners") as u32;
        let whole = mesh.clone();
        for copies in [[[a, b, d], [b, a, d]], [[a, b, d], [b, d, a]]] {
            mesh = whole.clone();
            mesh.triangles.extend(copies);
            let (mended, repairs) = repair(&mesh);
            assert_eq!((repairs.duplicate_triangles, repairs.cut_edges, mended.triangles.len()), (2, 0, 12));
        }
        let tip = mesh.positions.len() as u32;
        mesh.positions.push(dvec3(0.5, -2.0, -2.0));
        mesh.triangles.extend([[a, b, tip], [b, a, tip]]);
        assert_eq!(repair(&mesh).0.triangles.len(), 13);
    }

    #[test]
    fn of_a_volume_the_outside_is_left() {
        let places = (0..27).map(|i| dvec3((i % 3).into(), (i / 3 % 3).into(), (i / 9).into()));
        let cells = soup(places.map(|at| moved(cube(), at)));
        let (mesh, repairs) = repair(&cells);
        assert_eq!((repairs.faces_between_cells, repairs.duplicate_triangles, repairs.cut_edges), (216, 0, 0));
        assert_eq!((audit(&mesh).euler, mesh.triangles.len()), (2, 108));
        for t in 0..108 {
            let source = mesh.provenance().triangle(t as u32) as usize;
            assert_eq!(mesh.area_vector(t), cells.area_vector(source));
        }
    }

    /// Copies of an edge whose ends are in the same two fans are told apart by their glued sides.
    #[test]
    fn heaps_of_triangles_between_few_places_become_manifolds() {
        for seed in 0..3000 {
            let mut rng = stream(seed, Stage::Scan);
            let mut below = |n: u32| rng.next_u32() % n;
            let vertices = 4 + below(8);
            let mut place = || dvec3(below(3).into(), below(3).into(), below(2).into());
            let positions = (0..vertices).map(|_| place()).collect();
            let triangles = (0..2 + below(30)).map(|_| [0; 3].map(|_| below(vertices))).collect();
            audit(&repair(&Mesh { positions, triangles }).0);
        }
    }
}
