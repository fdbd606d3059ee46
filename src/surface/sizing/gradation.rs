//! Gradation: limits the difference between lengths of neighbouring edges. h(v) ≤ h(u) + g |uv| for all edges, by one pass
//! of Dijkstra's algorithm.
//!
//! Based on: P.-O. Persson, Mesh size functions for implicit geometries and PDE-based gradient limiting, 2006,
//! DOI 10.1007/s00366-006-0014-1. Departure: the limit holds along edges, which are longer than the shortest path.
//!
//! Cost: n log n in the vertices.

use crate::base::heap::Ranked;
use crate::surface::domain::Domain;
use crate::surface::sizing::graph::Graph;
use std::collections::BinaryHeap;

/// Reduces `lengths` so that none exceeds that of a neighbour by more than `slope` times their distance. `graph` is that of
/// the whole domain: copies of a vertex get the same length.
pub(super) fn limited(domain: &Domain, graph: &Graph, mut lengths: Vec<f64>, slope: f64) -> Vec<f64> {
    for (v, &first) in domain.original.iter().enumerate() {
        lengths[first as usize] = lengths[first as usize].min(lengths[v]);
    }
    let position = |v: u32| domain.mesh.positions[v as usize];
    let vertices = (0..lengths.len() as u32).filter(|&v| domain.original[v as usize] == v);
    let mut heap: BinaryHeap<Ranked> = vertices.map(|v| Ranked::new(-lengths[v as usize], v)).collect();
    while let Some(Ranked { rank, index: vertex, .. }) = heap.pop() {
        let length = -rank;
        if length > lengths[vertex as usize] {
            continue;
        }
        for &w in graph.of(vertex) {
            let most = length + slope * position(vertex).distance(position(w));
            if most < lengths[w as usize] {
                lengths[w as usize] = most;
                heap.push(Ranked::new(-most, w));
            }
        }
    }
    domain.original.iter().map(|&first| lengths[first as usize]).collect()
}
