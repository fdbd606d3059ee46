//! Edge lengths that fit a whole number of rows of triangles between feature curves.
//!
//! A strip of width w between two curves fits equilateral triangles of side h if w = n √3/2 h for a whole number n of rows.
//! For other lengths, its triangles are squashed or stretched, the more so the fewer rows there are. So where few rows fit,
//! the length on both curves becomes w / (n √3/2), with the n that changes it least. It returns to its former value with the
//! gradient of lengths between curves. If one curve bounds two strips, the narrower one decides. A strip of varying width
//! has no number of rows.
//!
//! Cost: a search among the sides of curves for each vertex on them, and two passes of Dijkstra's algorithm.

use crate::base::parallel;
use crate::surface::domain::Domain;
use crate::surface::sizing::feature_size::Sides;
use crate::surface::sizing::gradation::limited;
use crate::surface::sizing::graph::Graph;
use crate::surface::sizing::room::GRADIENT;

/// Height of an equilateral triangle, relative to its side.
const HEIGHT: f64 = 0.866_025_403_784_438_6;

/// Maximum number of rows that is made whole: with more rows, a fraction of one makes little difference.
const MOST_ROWS: f64 = 4.0;

/// Largest factor by which a length changes: less than that between one row and two, so strips halfway between stay as they
/// are.
const MOST_CHANGE: f64 = 1.25;

/// Largest relative difference of a strip's width from one vertex to the next.
const UNEVEN: f64 = 0.02;

/// Returns `sizes`, relative to `spacing`, changed so that whole rows fit between curves.
pub fn sizes_with_whole_rows(domain: &Domain, sizes: &[f64], spacing: f64) -> Vec<f64> {
    let graph = Graph::whole(domain);
    let widths = even_widths(domain, &graph, (MOST_ROWS + 1.0) * HEIGHT * spacing);
    let in_lengths = widths.iter().zip(sizes).map(|(width, size)| width / spacing / size);
    let wanted: Vec<f64> = in_lengths.zip(sizes).map(|(width, size)| size * change(width)).collect();
    let slope = GRADIENT / spacing;
    let raised = sizes.iter().zip(&wanted).map(|(size, wanted)| -size.max(*wanted)).collect();
    let raised = limited(domain, &graph, raised, slope);
    let lowered = raised.iter().zip(sizes.iter().zip(&wanted));
    let lowered = lowered.map(|(raised, (size, wanted))| if wanted < size { *wanted } else { -raised }).collect();
    limited(domain, &graph, lowered, slope)
}

/// Width of the strip beside each vertex on a curve of the domain, where it is equally wide beside the adjacent vertices.
/// Infinite elsewhere, and if no other curve is within `reach`.
fn even_widths(domain: &Domain, graph: &Graph, reach: f64) -> Vec<f64> {
    let sides = Sides::new(domain);
    let at = parallel::map(0..sides.count(), |i| sides.distance_at(domain, i, reach, false));
    let mut widths = vec![f64::INFINITY; domain.mesh.positions.len()];
    for (i, width) in at.into_iter().enumerate() {
        // Copies of a vertex share one length.
        let v = domain.original[sides.vertex(i) as usize] as usize;
        widths[v] = widths[v].min(width);
    }
    let is_even = |&v: &u32| {
        let width = widths[v as usize];
        let beside = graph.of(v).iter().map(|&w| widths[w as usize]).filter(|w| w.is_finite());
        beside.clone().count() >= 2 && beside.into_iter().all(|w| (w - width).abs() <= UNEVEN * width)
    };
    domain.original.iter().map(|v| if is_even(v) { widths[*v as usize] } else { f64::INFINITY }).collect()
}

/// Factor by which the length changes in a strip that is `width` lengths wide.
fn change(width: f64) -> f64 {
    let rows = width / HEIGHT;
    if rows > MOST_ROWS + 0.5 {
        return 1.0;
    }
    let fewer = rows.floor().max(1.0);
    // √(n (n + 1)) rows are as far from n as from n + 1, as ratios.
    let whole = if rows > (fewer * (fewer + 1.0)).sqrt() { fewer + 1.0 } else { fewer };
    let factor = rows / whole;
    if (1.0 / MOST_CHANGE..=MOST_CHANGE).contains(&factor) { factor } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::grid;
    use approx::assert_relative_eq;
    use glam::dvec3;

    #[test]
    fn lengths_fit_the_next_whole_row() {
        // Number of rows at the current length, and the resulting whole number.
        for (rows, whole) in [(0.9, 1.0), (1.2, 1.0), (1.9, 2.0), (2.1, 2.0), (3.8, 4.0)] {
            assert_relative_eq!(change(rows * HEIGHT), rows / whole, epsilon = 1e-12);
        }
        // As far from one row as from two, less than one, and too many to matter.
        for rows in [1.4, 0.7, 5.3, f64::INFINITY] {
            assert_eq!(change(rows * HEIGHT), 1.0, "{rows}");
        }
    }

    #[test]
    fn a_band_gets_whole_rows_and_one_that_widens_stays() {
        let band = |slope: f64| {
            let width = |u: f64| 1.0 + slope * u;
            Domain::new(grid(20, 4, |u, v| dvec3(20.0 * u, width(u) * v, 0.0)).try_into().unwrap())
        };
        let rows = |domain: &Domain, spacing: f64| {
            let sizes = sizes_with_whole_rows(domain, &domain.sizes(), spacing);
            let at = |v: usize| domain.mesh.positions[v];
            let middle =
                (0..sizes.len()).filter(|&v| (at(v).x - 10.0).abs() < 2.5 && (at(v).y == 0.0 || at(v).y == 1.0));
            middle.map(|v| 1.0 / (HEIGHT * spacing * sizes[v])).collect::<Vec<_>>()
        };
        let even = band(0.0);
        for (spacing, whole) in [(0.52, 2.0), (0.62, 2.0), (0.36, 3.0)] {
            assert!(rows(&even, spacing).iter().all(|n| (n - whole).abs() < 0.05), "{:?}", rows(&even, spacing));
        }
        let widening = band(1.0);
        assert!(sizes_with_whole_rows(&widening, &widening.sizes(), 0.62).iter().all(|&size| size == 1.0));
    }
}
