//! The graph of sharp edges: closes gaps of one edge, and removes spurs.

use crate::base::csr::Csr;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;

/// Sharp edges, and those at each vertex.
struct SharpEdgeGraph<'a> {
    mesh: &'a Mesh,
    edges: Vec<[u32; 2]>,
    at: Csr<u32>,
}

impl<'a> SharpEdgeGraph<'a> {
    fn new(edges: Vec<[u32; 2]>, mesh: &'a Mesh) -> SharpEdgeGraph<'a> {
        let ends = || (0..).zip(&edges).flat_map(|(edge, &[a, b])| [(a, edge), (b, edge)]);
        let at = Csr::new(mesh.positions.len(), ends);
        SharpEdgeGraph { mesh, edges, at }
    }

    /// Returns, for each vertex, whether an edge ends there without another one or the boundary. `twin` is the result of
    /// [`twins`](crate::mesh::topology::twins).
    fn free_ends(&self, twin: &[u32]) -> Vec<bool> {
        let mut is_free: Vec<bool> = (0..self.at.rows() as u32).map(|v| self.at.row(v).len() == 1).collect();
        let boundary = (0..twin.len() as u32).filter(|&side| twin[side as usize] == NONE);
        boundary.flat_map(|side| self.mesh.ends(side)).for_each(|v| is_free[v as usize] = false);
        is_free
    }

    /// Returns the edges from a free end to the next branch, if there is one within the length `longest`.
    fn spur(&self, end: u32, longest: f64) -> Option<Vec<u32>> {
        let (mut v, mut length, mut spur) = (end, 0.0, Vec::new());
        loop {
            let last = spur.last().copied();
            let mut next = self.at.row(v).iter().copied().filter(|&edge| Some(edge) != last);
            match (next.next(), next.next()) {
                (Some(edge), None) => {
                    let [a, b] = self.edges[edge as usize];
                    length += self.mesh.positions[a as usize].distance(self.mesh.positions[b as usize]);
                    v = if a == v { b } else { a };
                    spur.push(edge);
                }
                (Some(_), Some(_)) => return Some(spur),
                (None, _) => return None,
            }
            if length >= longest {
                return None;
            }
        }
    }
}

/// Returns the sharp `edges` without gaps of one edge between free ends, and without spurs shorter than `shortest`.
/// `twin` is the result of [`twins`](crate::mesh::topology::twins).
pub(super) fn tidied(mut edges: Vec<[u32; 2]>, mesh: &Mesh, twin: &[u32], shortest: f64) -> Vec<[u32; 2]> {
    let graph = SharpEdgeGraph::new(edges.clone(), mesh);
    let mut is_free = graph.free_ends(twin);
    for [a, b] in (0..twin.len() as u32).map(|side| mesh.ends(side)) {
        let are_joined = || graph.at.row(a).iter().any(|edge| graph.at.row(b).contains(edge));
        if is_free[a as usize] && is_free[b as usize] && !are_joined() {
            edges.push([a, b]);
            [a, b].iter().for_each(|&v| is_free[v as usize] = false);
        }
    }
    let graph = SharpEdgeGraph::new(edges, mesh);
    let is_free = graph.free_ends(twin);
    let mut is_spur = vec![false; graph.edges.len()];
    for end in (0..is_free.len()).filter(|&v| is_free[v]) {
        graph.spur(end as u32, shortest).into_iter().flatten().for_each(|edge| is_spur[edge as usize] = true);
    }
    graph.edges.iter().zip(is_spur).filter(|(_, is_spur)| !is_spur).map(|(&edge, _)| edge).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::twins;
    use crate::testing::sheet;

    #[test]
    fn gaps_are_closed_and_spurs_removed() {
        let mesh = sheet(10, |_, _| 0.0);
        let row = |i: u32, from: u32, to: u32| (from..to).map(move |j| [11 * i + j, 11 * i + j + 1]);
        // A line with a gap of one edge, and a spur of two edges beside another one of five.
        let line: Vec<[u32; 2]> = row(5, 0, 3).chain(row(5, 4, 10)).collect();
        let across = |j: u32, from: u32, to: u32| (from..to).map(move |i| [11 * i + j, 11 * i + j + 11]);
        let edges = line.iter().copied().chain(across(2, 5, 7)).chain(across(7, 5, 10)).collect();
        let mut tidy: Vec<[u32; 2]> = tidied(edges, &mesh, &twins(&mesh.triangles), 0.35)
            .into_iter()
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        tidy.sort_unstable();
        let mut expected: Vec<[u32; 2]> = row(5, 0, 10).chain(across(7, 5, 10)).collect();
        expected.sort_unstable();
        assert_eq!(tidy, expected);
    }
}
