//! Volumes that are listed cell by cell: each inner face occurs twice, once for the cell on either side.
//!
//! A face and one with the same corners in the opposite direction are a pair. If pairs are at least half of all faces, and
//! the other faces are closed, the pairs are the faces between the cells of a volume, and the rest is its outside. A sheet
//! that was modelled from both sides leaves nothing, and in a body that contains a few such sheets most faces are not in
//! pairs.
//!
//! Cost: linear in the sides, once these are sorted.
//!
//! Limits: if a cell lacks a face or has one turned over, the outside is open, and nothing is dropped. The same holds for
//! volumes of so few cells that most faces are outside.
//!
//! Single copies also occur on surfaces: hulls have such faces where four corners are nearly coplanar. Where the other faces
//! are closed without them, none of the copies belongs to the surface.

use crate::mesh::sides::{Side, edges};
use crate::mesh::triangle_mesh::Mesh;
use crate::prepare::welded::Welded;

/// Returns, for each triangle, whether it lies between two cells of a volume; `None` if the triangles are not such a volume.
/// `sides` are the [`sorted_sides`](crate::mesh::sides::sorted_sides) of all triangles, none of which may have a corner twice.
pub(super) fn faces_between_cells(triangles: &[[u32; 3]], sides: &[Side]) -> Option<Vec<bool>> {
    let mut between = vec![false; triangles.len()];
    for group in coincident(triangles, sides) {
        let is_even = |t: &u32| is_even(triangles[*t as usize]);
        let (one, other): (Vec<u32>, Vec<u32>) = group.into_iter().partition(is_even);
        one.into_iter().zip(other).for_each(|(a, b)| [a, b].into_iter().for_each(|t| between[t as usize] = true));
    }
    let count = between.iter().filter(|&&is| is).count();
    let is_volume = count > 0 && 2 * count >= triangles.len() && count < triangles.len();
    (is_volume && is_closed(sides.iter().filter(|s| !between[s.side as usize / 3]).copied())).then_some(between)
}

/// Returns `mesh` without the triangles between the cells of a volume, if it is one, and without those that have no area
/// then; its vertices stay.
pub fn without_faces_between_cells(mesh: &Mesh) -> Mesh {
    let Welded { triangles, sources, sides, .. } = Welded::at_places(mesh);
    let Some(between) = faces_between_cells(&triangles, &sides) else { return mesh.clone() };
    let outside = sources.into_iter().zip(between).filter(|(_, is_between)| !is_between);
    Mesh { positions: mesh.positions.clone(), triangles: outside.map(|(t, _)| mesh.triangles[t as usize]).collect() }
}

/// Returns, for each triangle of these `groups`, which are [`coincident`], whether it lies on a surface that is closed
/// without all of them: along at least two of its edges, and open along none.
pub(super) fn on_closed_surface(triangles: &[[u32; 3]], sides: &[Side], groups: &[Vec<u32>]) -> Vec<bool> {
    let mut is_copied = vec![false; triangles.len()];
    groups.iter().flatten().for_each(|&t| is_copied[t as usize] = true);
    if groups.is_empty() {
        return is_copied;
    }
    let mut closed_edges = vec![0; triangles.len()];
    let mut is_open = vec![false; triangles.len()];
    for edge in edges(sides) {
        let triangles = || edge.iter().map(|s| s.side as usize / 3);
        let others = triangles().filter(|&t| !is_copied[t]).count();
        for t in triangles().filter(|&t| is_copied[t]) {
            closed_edges[t] += u32::from(others > 0);
            is_open[t] |= others % 2 == 1;
        }
    }
    (0..triangles.len()).map(|t| is_copied[t] && closed_edges[t] >= 2 && !is_open[t]).collect()
}

/// Iterates over the groups of triangles that have all three corners in common, each group in increasing order.
pub(super) fn coincident<'a>(triangles: &'a [[u32; 3]], sides: &'a [Side]) -> impl Iterator<Item = Vec<u32>> + 'a {
    let apex = |s: &Side| triangles[s.side as usize / 3][(s.side as usize + 2) % 3];
    let is_alone = move |edge: &[Side]| match edge {
        [one, other] => apex(one) != apex(other),
        _ => edge.len() < 2,
    };
    edges(sides).filter(move |edge| !is_alone(edge)).flat_map(move |edge| {
        // Each triangle is visited once: at the edge opposite its highest corner.
        let across = edge.iter().filter(|s| apex(s) > s.ends()[1]);
        let mut faces: Vec<(u32, u32)> = across.map(|s| (apex(s), s.side / 3)).collect();
        faces.sort_unstable();
        let groups = faces.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1);
        groups.map(|group| group.iter().map(|face| face.1).collect()).collect::<Vec<Vec<u32>>>()
    })
}

/// Returns whether the corners increase cyclically: of two triangles with the same corners in opposite directions, exactly
/// one does.
fn is_even([a, b, c]: [u32; 3]) -> bool {
    usize::from(a < b) + usize::from(b < c) + usize::from(c < a) == 2
}

/// Returns whether each edge has as many sides in one direction as in the other.
fn is_closed(sides: impl Iterator<Item = Side>) -> bool {
    let sides: Vec<Side> = sides.collect();
    let balance = |edge: &[Side]| 2 * edge.iter().filter(|s| s.forward()).count() == edge.len();
    edges(&sides).all(balance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{cube, joined, moved, sheet};
    use glam::dvec3;

    /// A block of `n` cubes along each axis, each listed with all its faces and with vertices of its own.
    fn volume(n: u32) -> Mesh {
        let cells = (0..n * n * n).map(|i| dvec3((i % n).into(), (i / n % n).into(), (i / n / n).into()));
        joined(cells.map(|at| moved(cube(), at)))
    }

    fn dropped(mesh: &Mesh) -> usize {
        mesh.triangles.len() - without_faces_between_cells(mesh).triangles.len()
    }

    #[test]
    fn the_outside_of_a_volume_is_left() {
        for n in [2, 3] {
            let outside = without_faces_between_cells(&volume(n));
            assert_eq!(outside.triangles.len() as u32, 12 * n * n);
            assert_eq!(outside.area(), 6.0 * f64::from(n * n));
            assert_eq!(without_faces_between_cells(&outside), outside);
        }
    }

    #[test]
    fn what_is_no_volume_loses_nothing() {
        let turned = |mesh: &Mesh| Mesh {
            positions: mesh.positions.clone(),
            triangles: mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
        };
        let sheet = sheet(4, |_, _| 2.0);
        assert_eq!(dropped(&joined([sheet.clone(), turned(&sheet)])), 0);
        let fin = Mesh { triangles: sheet.triangles[..2].to_vec(), ..sheet };
        assert_eq!(dropped(&joined([cube(), fin.clone(), turned(&fin)])), 0);
        let mut open = volume(3);
        open.triangles.remove(0);
        assert_eq!(dropped(&open), 0);
        assert_eq!(dropped(&cube()), 0);
        assert_eq!(dropped(&Mesh::default()), 0);
    }
}
