//! Volume cells and their outer surface: the sides that only one cell has.
//!
//! Cost: a sort of the sides.

use glam::DVec3;

/// Type of a cell. VTK, Gmsh and Medit share this order of corners: first those of the base, then those above it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Tetrahedron,
    Pyramid,
    Prism,
    Hexahedron,
}

impl Kind {
    /// Number of corners.
    pub fn corners(self) -> usize {
        match self {
            Kind::Tetrahedron => 4,
            Kind::Pyramid => 5,
            Kind::Prism => 6,
            Kind::Hexahedron => 8,
        }
    }

    /// Corners of each side, counter-clockwise seen from outside if the base is counter-clockwise seen from above.
    fn sides(self) -> &'static [&'static [usize]] {
        match self {
            Kind::Tetrahedron => &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]],
            Kind::Pyramid => &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
            Kind::Prism => &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
            Kind::Hexahedron => {
                &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]]
            }
        }
    }
}

/// Cells over the vertices of a file.
#[derive(Debug, Default)]
pub(super) struct Cells {
    /// Kind of each cell, and the index of its first corner.
    list: Vec<(Kind, usize)>,
    corners: Vec<u32>,
}

/// The outer sides of cells.
pub(super) struct Outside {
    /// Sides that only one cell has, in increasing order of cell index: the cell, and the indices of the side's corners in
    /// the list of all corners, counter-clockwise seen from outside.
    pub sides: Vec<(usize, Vec<usize>)>,
    /// Number of sides that two cells share.
    pub shared: usize,
}

impl Cells {
    /// Adds a cell with these corners, as many as its kind has.
    pub fn push(&mut self, kind: Kind, corners: impl IntoIterator<Item = u32>) {
        self.list.push((kind, self.corners.len()));
        self.corners.extend(corners);
    }

    /// Number of cells so far.
    pub fn count(&self) -> usize {
        self.list.len()
    }

    /// Vertex of each corner.
    pub fn corner_list(&self) -> &[u32] {
        &self.corners
    }

    /// Returns the outer sides of all cells. The corners must be indices of `positions`.
    pub fn outside(&self, positions: &[DVec3]) -> Outside {
        let sides = self.list.iter().enumerate().flat_map(|(cell, &(kind, first))| {
            kind.sides().iter().enumerate().map(move |(side, places)| (self.vertices_of(first, places), cell, side))
        });
        // A side with only two distinct corners is degenerate.
        let mut sides: Vec<([u32; 4], usize, usize)> = sides.filter(|side| side.0[2] != u32::MAX).collect();
        sides.sort_unstable();
        let groups = || sides.chunk_by(|a, b| a.0 == b.0);
        let shared = groups().filter(|group| group.len() == 2).count();
        let mut alone: Vec<(usize, usize)> =
            groups().filter(|group| group.len() == 1).map(|group| (group[0].1, group[0].2)).collect();
        alone.sort_unstable();
        let sides = alone.into_iter().map(|(cell, side)| (cell, self.seen_from_outside(cell, side, positions)));
        Outside { sides: sides.collect(), shared }
    }

    /// Returns the distinct vertices at these corners of the cell whose corners begin at `first`, in increasing order. They
    /// may be fewer than the corners: a prism may be written as a hexahedron with repeated corners.
    fn vertices_of(&self, first: usize, places: &[usize]) -> [u32; 4] {
        let mut vertices = [u32::MAX; 4];
        vertices.iter_mut().zip(places).for_each(|(v, &k)| *v = self.corners[first + k]);
        vertices.sort_unstable();
        for i in (1..4).rev() {
            if vertices[i] == vertices[i - 1] {
                vertices[i] = u32::MAX;
            }
        }
        vertices.sort_unstable();
        vertices
    }

    /// Returns the indices of a side's corners in the list of all corners, counter-clockwise seen from outside, whichever
    /// orientation the cell has.
    fn seen_from_outside(&self, cell: usize, side: usize, positions: &[DVec3]) -> Vec<usize> {
        let (kind, first) = self.list[cell];
        let place = |k: usize| positions[self.corners[first + k] as usize];
        // Six times the signed volume between a side and the cell's first corner.
        let of_side = |places: &[usize]| -> f64 {
            let [a, rest @ ..] = places else { return 0.0 };
            let from_first = |k: usize| place(k) - place(0);
            rest.windows(2).map(|w| from_first(*a).dot(from_first(w[0]).cross(from_first(w[1])))).sum()
        };
        let volume: f64 = kind.sides().iter().map(|places| of_side(places)).sum();
        let mut places: Vec<usize> = kind.sides()[side].iter().map(|k| first + k).collect();
        if volume < 0.0 {
            places.reverse();
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;
    use glam::dvec3;

    const CUBE: [[u32; 3]; 8] =
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

    fn positions() -> Vec<DVec3> {
        let cube = CUBE.map(|p| p.map(f64::from));
        cube.into_iter()
            .map(DVec3::from)
            .chain([dvec3(0.5, 0.5, 2.0), dvec3(2.0, 0.5, 0.0), dvec3(2.0, 0.5, 1.0)])
            .collect()
    }

    /// A cube with a pyramid on top, a prism at one side, and a tetrahedron in the gap between those two.
    const ALL: [(Kind, &[u32]); 4] = [
        (Kind::Hexahedron, &[0, 1, 2, 3, 4, 5, 6, 7]),
        (Kind::Pyramid, &[4, 5, 6, 7, 8]),
        (Kind::Prism, &[1, 9, 2, 5, 10, 6]),
        (Kind::Tetrahedron, &[5, 10, 6, 8]),
    ];

    fn outside_of(cells: &[(Kind, &[u32])]) -> (Vec<[u32; 3]>, usize, f64) {
        let mut all = Cells::default();
        cells.iter().for_each(|(kind, corners)| all.push(*kind, corners.iter().copied()));
        let positions = positions();
        let Outside { sides, shared } = all.outside(&positions);
        let polygons =
            sides.iter().map(|(_, places)| places.iter().map(|&i| all.corner_list()[i]).collect::<Vec<u32>>());
        let triangles: Vec<[u32; 3]> =
            polygons.flat_map(|p| (2..p.len()).map(move |i| [p[0], p[i - 1], p[i]]).collect::<Vec<_>>()).collect();
        let volume = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| positions[v as usize]);
            a.dot(b.cross(c)) / 6.0
        };
        let volume = triangles.iter().map(volume).sum();
        (triangles, shared, volume)
    }

    #[test]
    fn the_outside_of_cells_of_all_kinds_is_closed_and_faces_outwards() {
        let (triangles, shared, volume) = outside_of(&ALL);
        // The cube has six sides, of which two are shared, and so on.
        assert_eq!((triangles.len(), shared), (4 * 2 + 3 + 5 + 2, 4));
        let found = topology(11, &triangles);
        assert!(found.is_manifold() && found.is_oriented() && (found.euler, found.boundary_loops) == (2, 0));
        assert!((volume - (1.0 + 1.0 / 3.0 + 0.5 + 1.0 / 6.0)).abs() < 1e-12, "{volume}");
    }

    #[test]
    fn cells_with_corners_that_are_one_share_their_sides() {
        let mut cells = ALL;
        // The same prism and the tetrahedron beside it.
        cells[2] = (Kind::Hexahedron, &[1, 9, 9, 2, 5, 10, 10, 6]);
        cells[3] = (Kind::Prism, &[5, 10, 6, 8, 8, 8]);
        let (triangles, _, volume) = outside_of(&cells);
        let (whole, expected): (Vec<[u32; 3]>, _) =
            (triangles.into_iter().filter(|[a, b, c]| a != b && b != c && c != a).collect(), outside_of(&ALL));
        let found = topology(11, &whole);
        assert!(found.is_manifold() && found.is_oriented() && found.boundary_loops == 0, "{whole:?}");
        assert!((volume - expected.2).abs() < 1e-12 && whole.len() == expected.0.len());
    }

    #[test]
    fn cells_that_are_turned_inside_out_have_the_same_outside() {
        for turned in 0..ALL.len() {
            let (kind, corners) = ALL[turned];
            let (base, above) = corners.split_at(match kind {
                Kind::Tetrahedron | Kind::Prism => 3,
                Kind::Pyramid | Kind::Hexahedron => 4,
            });
            let other: Vec<u32> = base.iter().rev().chain(above.iter().rev()).copied().collect();
            let mut cells = ALL;
            cells[turned] = (kind, &other);
            let (triangles, _, volume) = outside_of(&cells);
            assert!((volume - 2.0).abs() < 1e-12, "{kind:?} {volume}");
            assert!(topology(11, &triangles).is_oriented());
        }
    }
}
