//! From points of terrain to a mesh: a sheet with one height at each place, as seen from above. An airborne scan has points
//! on ground and roofs, few on walls and many within trees, so that no surface in space contains all of them.
//!
//! Where points are closer together in plan view than the vertices of the result will be, only the highest belongs to the
//! sheet: whatever is below it, like the ground under a tree, is not visible. z is up.

use crate::base::error::{Error, Fault, Result};
use crate::base::monitor::{Monitor, check};
use crate::geom::aabb::Aabb;
use crate::mesh::points::Points;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::cloud::coverage::MOST_MISSED;
use crate::pipeline::cloud::options::CloudOptions;
use crate::pipeline::cloud::summary::CloudSummary;
use crate::pipeline::cloud::{Cleaned, MeshOfPoints, mesh_of_points, no_surface};
use crate::pipeline::density::Density;
use crate::pipeline::scale::spacing_on;
use crate::triangulate::plan::triangulate_plan;
use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

/// Width of the grid cells in plan view that contribute their highest point to the sheet, in spacings of the vertices: finer
/// cells leave spikes between vertices, such as trees.
const CELL: f64 = 0.8;

/// Points are of terrain if most cells of [`IN_CELL`] points are flat: half of them have less relief than this share of
/// their width. It is .02 to .13 for four airborne scans, and .46 or more for other clouds.
const MOST_RELIEF: f64 = 0.25;

/// Mean number of points in a cell whose relief is measured.
const IN_CELL: f64 = 4.0;

/// If the area of a sheet is more than this many times that of the cells, it spans gaps that the cells do not cover, as
/// between scan lines.
const MOST_GAPS: f64 = 1.5;

/// Number of rounds in which the width of cells with [`IN_CELL`] points is found.
const ROUNDS: usize = 6;

/// Builds the mesh of a cloud that is then remeshed: through all of its points in space or, if that is requested or if the
/// points are of terrain and many would be left out, through those visible from above.
///
/// # Errors
/// Those of [`mesh_of_points`].
pub fn mesh_of_cloud(
    points: &Points,
    options: &CloudOptions,
    density: Density,
    monitor: &dyn Monitor,
) -> Result<MeshOfPoints> {
    if options.terrain == Some(true) {
        options.validate()?;
        monitor.stage("clean");
        return mesh_of_terrain(points, density, monitor);
    }
    let in_space = mesh_of_points(points, options, monitor);
    let leaves_many_out = match &in_space {
        Ok(MeshOfPoints { summary, surface_points, .. }) => {
            (summary.unused + summary.in_shreds) as f64 > MOST_MISSED * surface_points.len() as f64
        }
        Err(error) => matches!(error, Error::Mesh { fault: Fault::NoSurface, .. }),
    };
    let is_terrain = || plan(points.positions()).is_some_and(|plan| plan.relief < MOST_RELIEF);
    if options.terrain.is_none() && leaves_many_out && is_terrain() {
        return mesh_of_terrain(points, density, monitor);
    }
    in_space
}

/// Builds the sheet through the points visible from above.
fn mesh_of_terrain(points: &Points, density: Density, monitor: &dyn Monitor) -> Result<MeshOfPoints> {
    let mut summary = CloudSummary { points: points.positions().len(), ..CloudSummary::default() };
    let Cleaned { points, source, .. } = Cleaned::of(points, &mut summary, monitor)?;
    monitor.stage("connect");
    let none = || no_surface(points.positions().len());
    let mut area = plan(points.positions()).ok_or_else(none)?.area;
    loop {
        let sheet = Sheet::over(points.positions(), area, density).ok_or_else(none)?;
        check(monitor)?;
        if sheet.area > MOST_GAPS * area {
            area = sheet.area;
            continue;
        }
        let source: Vec<u32> = sheet.seen.iter().map(|&p| source[p as usize]).collect();
        summary.plan_cell = sheet.cell;
        summary.below = points.positions().len() - source.len();
        let (mesh, surface_points) = (sheet.mesh, source.clone());
        return Ok(MeshOfPoints { mesh, surface_points, source, spacing: sheet.cell, summary });
    }
}

/// Sheet through the highest points of the grid cells in plan view.
struct Sheet {
    mesh: Mesh,
    /// For each vertex, the point that it is.
    seen: Vec<u32>,
    /// Width of the cells.
    cell: f64,
    /// Area as seen from above.
    area: f64,
}

impl Sheet {
    /// Builds the sheet of points that cover about this area as seen from above; `None` if they are on a line.
    fn over(points: &[DVec3], area: f64, density: Density) -> Option<Sheet> {
        let of_points = (area / points.len() as f64).sqrt();
        let cell = CELL * spacing_on(area, density).unwrap_or(of_points).max(of_points);
        let seen = highest_of_cells(points, cell);
        let positions: Vec<DVec3> = seen.iter().map(|&p| points[p as usize]).collect();
        let plan: Vec<DVec2> = positions.iter().map(|p| p.truncate()).collect();
        let triangles = triangulate_plan(&plan);
        let of_triangle = |&[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|v| plan[v as usize]);
            (b - a).perp_dot(c - a) / 2.0
        };
        let area = triangles.iter().map(of_triangle).sum();
        (!triangles.is_empty()).then_some(Sheet { mesh: Mesh { positions, triangles }, seen, cell, area })
    }
}

/// Points as seen from above.
struct Plan {
    /// Area that they cover.
    area: f64,
    /// Median of the height differences within cells of several points, as a share of the cell width.
    relief: f64,
}

/// Measures points in plan view; `None` if they have no area as seen from above.
fn plan(positions: &[DVec3]) -> Option<Plan> {
    let extent = Aabb::of(positions.iter().copied())?.size();
    let count = positions.len() as f64;
    let mut width = (IN_CELL * extent.x * extent.y / count).sqrt();
    for _ in 0..ROUNDS {
        if !(width > 0.0 && width.is_finite()) {
            return None;
        }
        width *= (IN_CELL * heights_in_cells(positions, width).len() as f64 / count).sqrt();
    }
    let heights = heights_in_cells(positions, width);
    // A single point has no relief.
    let several = heights.values().filter(|heights| heights.points > 1);
    let mut reliefs: Vec<f64> = several.map(|heights| (heights.highest - heights.lowest) / width).collect();
    if reliefs.is_empty() {
        return None;
    }
    let middle = reliefs.len() / 2;
    let relief = *reliefs.select_nth_unstable_by(middle, f64::total_cmp).1;
    Some(Plan { area: heights.len() as f64 * width * width, relief })
}

/// Heights of the points in a cell.
struct Heights {
    lowest: f64,
    highest: f64,
    points: usize,
}

/// Returns the heights in each cell, of a grid of this width, that has points.
fn heights_in_cells(positions: &[DVec3], width: f64) -> FxHashMap<[i64; 2], Heights> {
    let mut cells = FxHashMap::default();
    for p in positions {
        let cell = cells.entry(cell_of(*p, width)).or_insert(Heights { lowest: p.z, highest: p.z, points: 0 });
        (cell.lowest, cell.highest, cell.points) = (cell.lowest.min(p.z), cell.highest.max(p.z), cell.points + 1);
    }
    cells
}

/// Returns the highest point in each cell of a grid of this width, the first of equally high ones, in the order of the
/// points.
fn highest_of_cells(positions: &[DVec3], width: f64) -> Vec<u32> {
    let mut highest: FxHashMap<[i64; 2], u32> = FxHashMap::default();
    for (i, p) in positions.iter().enumerate() {
        let seen = highest.entry(cell_of(*p, width)).or_insert(i as u32);
        if positions[*seen as usize].z < p.z {
            *seen = i as u32;
        }
    }
    let mut seen: Vec<u32> = highest.into_values().collect();
    seen.sort_unstable();
    seen
}

fn cell_of(p: DVec3, width: f64) -> [i64; 2] {
    [p.x, p.y].map(|x| (x / width).floor() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns points a unit apart in plan view, with `above` more points above each of the first `columns` of them.
    fn with_columns(columns: u32, above: u32) -> Vec<DVec3> {
        let ground = (0..900).map(|i| DVec3::new(f64::from(i % 30), f64::from(i / 30), 0.01 * f64::from(i % 7)));
        let columns = ground.clone().take(columns as usize);
        let points_above = columns.flat_map(|p| (1..=above).map(move |k| p + 3.0 * f64::from(k) * DVec3::Z));
        ground.chain(points_above).collect()
    }

    #[test]
    fn ground_is_flat_from_above_and_walls_are_not_beside_as_many_single_points() {
        let relief = |columns, above| plan(&with_columns(columns, above)).unwrap().relief;
        assert!(relief(0, 0) < 0.1 && relief(60, 3) < MOST_RELIEF, "{} {}", relief(0, 0), relief(60, 3));
        assert!(relief(300, 12) > 1.0, "{}", relief(300, 12));
        assert!(plan(&[DVec3::ZERO, DVec3::X, DVec3::Z]).is_none());
    }
}
