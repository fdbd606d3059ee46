//! Pipeline from a point cloud to a mesh through its points, which is then remeshed like any other.

pub(in crate::pipeline) mod coverage;
pub(in crate::pipeline) mod options;
pub(in crate::pipeline) mod reconstruct;
pub(in crate::pipeline) mod sharp;
pub(in crate::pipeline) mod summary;
pub(in crate::pipeline) mod terrain;

use crate::base::error::{Error, Fault, Result};
use crate::base::monitor::{Monitor, check};
use crate::geom::eigen::{eigen, scatter};
use crate::mesh::points::Points;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::cloud::options::{
    CloudOptions, FEW_NEIGHBORS, INTERPOLATING_SUPPORT, NormalFit, NormalNeighborhood, SMOOTHING_SUPPORT,
};
use crate::pipeline::cloud::summary::CloudSummary;
use crate::prepare::clean::{are_neighbors, merged};
use crate::prepare::cloud_normals::{MANY_NEIGHBORS, Neighborhood, plane_normals, sphere_normals};
use crate::prepare::flatten::{Flatness, flatness, flattened};
use crate::prepare::orient::{disagreement, orient, side_with};
use crate::prepare::outside::{face_outwards, turn_outwards};
use crate::spatial::kdtree::Neighbors;
use crate::spatial::knn_graph::{DEGREE, NeighborGraph};
use crate::surface::implicit::Rimls;
use crate::triangulate::boundary_loops::Filled;
use crate::triangulate::points::triangulate_points;
use crate::triangulate::surroundings::Surroundings;
use glam::DVec3;

/// Mesh through the points of a cloud.
#[derive(Debug, Clone)]
pub struct MeshOfPoints {
    /// Oriented manifold, closed where the cloud is.
    pub mesh: Mesh,
    /// For each vertex, the input point that it is, or is beside if it lies on a restored sharp edge.
    pub source: Vec<u32>,
    /// Points that the mesh should pass through: at distinct places, without outliers.
    pub surface_points: Vec<u32>,
    /// Mean distance of neighbouring points.
    pub spacing: f64,
    /// Summary of how the points were used.
    pub summary: CloudSummary,
}

/// Number of times that spheres are fitted, each time using the previous normals.
const SPHERES: usize = 2;

/// Area per point, in squares of its spacing, which is the distance to the sixth neighbour.
const AREA_OF_SPACING: f64 = 0.6;

/// Share of neighbouring pairs with opposite normals above which given normals are not trusted.
const MOST_DISAGREEMENT: f64 = 0.01;

/// Minimum number of points of a cloud.
const FEWEST_POINTS: usize = 8;

/// Usable points of a cloud, with normals and neighbour information.
pub(in crate::pipeline) struct Prepared {
    /// Points at distinct places, with unit normals on a common side.
    pub points: Points,
    /// For each point, its number in the input.
    pub source: Vec<u32>,
    pub near: Neighbors,
    pub graph: NeighborGraph,
    /// Local spacing at each point.
    pub spacings: Vec<f64>,
    /// Mean spacing of the input points.
    pub spacing: f64,
    /// Support radius if noise is to be smoothed away.
    pub smooth: Option<f64>,
    pub summary: CloudSummary,
}

impl Prepared {
    /// Returns the support radius of the implicit surface of the points.
    pub fn support(&self) -> f64 {
        self.smooth.unwrap_or(INTERPOLATING_SUPPORT)
    }

    /// Approximate area of the surface, in squared units of the input.
    pub fn area(&self) -> f64 {
        self.spacings.iter().map(|s| AREA_OF_SPACING * s * s).sum()
    }

    /// Returns whether the input's normals fail to tell which side is outside.
    pub fn has_no_outside(&self) -> bool {
        self.summary.tells_no_outside(self.source.len())
    }
}

/// Points of a cloud at distinct places, without outliers.
pub(in crate::pipeline) struct Cleaned {
    pub points: Points,
    /// For each point, its number in the input.
    pub source: Vec<u32>,
    near: Neighbors,
    graph: NeighborGraph,
}

impl Cleaned {
    /// Removes duplicates and outliers from `points` and counts them in `summary`.
    ///
    /// # Errors
    /// [`Error::Mesh`] for points with bad numbers or without an area; [`Error::Cancelled`] if the monitor asks for it.
    pub fn of(points: &Points, summary: &mut CloudSummary, monitor: &dyn Monitor) -> Result<Cleaned> {
        let (points, source) = merged(points);
        summary.duplicates = summary.points - points.positions().len();
        refuse_without_surface(points.positions())?;
        let all = Cleaned::with_neighbors(points, source);
        check(monitor)?;
        let stays = are_neighbors(&all.graph, all.source.len());
        summary.outliers = stays.iter().filter(|stays| !**stays).count();
        if summary.outliers == 0 {
            return Ok(all);
        }
        let kept: Vec<u32> = (0..stays.len() as u32).filter(|&p| stays[p as usize]).collect();
        let source = kept.iter().map(|&p| all.source[p as usize]).collect();
        let cleaned = Cleaned::with_neighbors(all.points.pick(&kept), source);
        check(monitor)?;
        Ok(cleaned)
    }

    fn with_neighbors(points: Points, source: Vec<u32>) -> Cleaned {
        let near = Neighbors::new(points.positions());
        let graph = NeighborGraph::new(points.positions(), &near, DEGREE);
        Cleaned { points, source, near, graph }
    }
}

/// Cleans `points` and gives them normals.
///
/// # Errors
/// As [`mesh_of_points`].
pub(in crate::pipeline) fn prepared(
    points: &Points,
    options: &CloudOptions,
    monitor: &dyn Monitor,
) -> Result<Prepared> {
    options.validate()?;
    monitor.stage("clean");
    let mut summary = CloudSummary { points: points.positions().len(), ..CloudSummary::default() };
    let Cleaned { mut points, source, mut near, mut graph } = Cleaned::of(points, &mut summary, monitor)?;
    let spacing = mean(&graph.spacings(points.positions()));
    let flatness = flatness(points.positions(), &near);
    summary.noisy = matches!(flatness, Flatness::NotQuite | Flatness::At(_));
    let mut smooth = options.smoothing();
    match flatness {
        Flatness::Never => return Err(volume(points.positions().len())),
        Flatness::NotQuite if options.smooth.is_none() => {
            smooth = Some(SMOOTHING_SUPPORT);
            summary.smoothed_by_itself = SMOOTHING_SUPPORT;
        }
        Flatness::At(count) if options.smooth.is_none() => {
            summary.flattened_neighbors = count;
            let flat = flattened(points.positions(), count);
            near = Neighbors::new(&flat);
            graph = NeighborGraph::new(&flat, &near, DEGREE);
            points = points.at(flat);
        }
        _ => {}
    }
    check(monitor)?;

    monitor.stage("normals");
    let options = CloudOptions { smooth, ..options.clone() };
    let normals = normals(&points, &near, &graph, &options, &mut summary);
    let points = points.with_normals(normals);
    let spacings = graph.spacings(points.positions());
    check(monitor)?;
    Ok(Prepared { points, source, near, graph, spacings, spacing, smooth, summary })
}

/// Builds a mesh through the points of a cloud.
///
/// # Errors
/// [`Error::Mesh`] for points that no surface goes through: too few, all in one place or on a line;
/// [`Error::Option`] for options out of range; [`Error::Cancelled`] if the monitor asks for it.
pub fn mesh_of_points(points: &Points, options: &CloudOptions, monitor: &dyn Monitor) -> Result<MeshOfPoints> {
    let prepared = prepared(points, options, monitor)?;
    let has_no_outside = prepared.has_no_outside();
    let Prepared { points, mut source, mut near, graph, spacings, spacing, smooth, mut summary } = prepared;
    let (mut positions, mut normals) = points.into_parts();
    if let Some(support) = smooth {
        monitor.stage("smooth");
        (positions, normals) = Rimls::new(&positions, &normals, &near, &spacings, support).smoothed();
        near = Neighbors::new(&positions);
    }

    monitor.stage("connect");
    let surroundings =
        Surroundings { positions: &positions, normals: &normals, near: &near, graph: &graph, spacings: &spacings };
    let Filled { triangles, shreds, in_shreds, .. } = triangulate_points(surroundings, options.fill_holes, monitor)?;
    let mut mesh = Mesh { positions, triangles };
    let all = mesh.positions.len();
    let surface_points = source.clone();
    let used = mesh.used_vertices();
    source = (0..all).filter(|&p| used[p]).map(|p| source[p]).collect();
    mesh.drop_unused();
    summary.unused = all - mesh.positions.len() - in_shreds;
    (summary.shreds, summary.in_shreds) = (shreds, in_shreds);
    if has_no_outside {
        face_outwards(&mut mesh);
    }
    if mesh.triangles.is_empty() {
        return Err(no_surface(all));
    }
    Ok(MeshOfPoints { mesh, source, surface_points, spacing, summary })
}

fn mean(numbers: &[f64]) -> f64 {
    numbers.iter().sum::<f64>() / numbers.len().max(1) as f64
}

/// Error for points that are as thick as they are wide everywhere.
pub fn volume(points: usize) -> Error {
    let cause = format!("no surface goes through these {points} points: they fill a volume");
    let remedy = "give points of a surface, or less noisy ones".into();
    Error::Mesh { fault: Fault::NoSurface, cause, remedy }
}

/// Error for points whose surface has no triangles.
pub(in crate::pipeline) fn no_surface(points: usize) -> Error {
    let cause = format!("no surface goes through these {points} points: neighbouring points do not agree on one");
    Error::Mesh {
        fault: Fault::NoSurface,
        cause,
        remedy: "give more points, or less noisy ones, or try smoothing".into(),
    }
}

/// Refuses points without an area.
fn refuse_without_surface(positions: &[DVec3]) -> Result<()> {
    let refuse =
        |fault, cause: String| Err(Error::Mesh { fault, cause, remedy: "give points spread over a surface".into() });
    if let Some(p) = positions.iter().position(|p| !p.is_finite()) {
        return refuse(Fault::Coordinates, format!("point {p} is at {}, which is not finite", positions[p]));
    }
    let n = positions.len();
    if n == 1 {
        return refuse(Fault::NoArea, "all points are at the same position".into());
    }
    let ([_, middle, largest], _) = eigen(scatter(positions.iter().copied()).1);
    if n > 1 && middle.max(0.0).sqrt() <= 1e-7 * largest.sqrt() {
        return refuse(Fault::NoArea, format!("all {n} points lie on a line"));
    }
    if n < FEWEST_POINTS {
        return refuse(Fault::Empty, format!("{n} distinct points are too few for a surface"));
    }
    Ok(())
}

/// Returns unit normals on a common side: the given ones where they are usable, and estimates elsewhere.
fn normals(
    points: &Points,
    near: &Neighbors,
    graph: &NeighborGraph,
    options: &CloudOptions,
    summary: &mut CloudSummary,
) -> Vec<DVec3> {
    let positions = points.positions();
    let mut given: Vec<DVec3> = points.normals().iter().map(|n| n.normalize_or_zero()).collect();
    given.resize(positions.len(), DVec3::ZERO);
    let missing = given.iter().filter(|n| **n == DVec3::ZERO).count();
    summary.estimated_normals = missing;
    if missing == 0 && disagreement(positions, &given, graph) <= MOST_DISAGREEMENT {
        return given;
    }
    let (few, fit) =
        if options.smooth.is_some() { (MANY_NEIGHBORS, NormalFit::Sphere) } else { (FEW_NEIGHBORS, NormalFit::Plane) };
    let fewer;
    let neighborhood = match options.neighborhood.unwrap_or(NormalNeighborhood::Count(few)) {
        NormalNeighborhood::Count(count) => {
            fewer = (count > graph.degree()).then(|| NeighborGraph::new(positions, near, count));
            Neighborhood::Nearest(fewer.as_ref().unwrap_or(graph), count)
        }
        NormalNeighborhood::Radius(radius) => Neighborhood::Within(near, radius),
    };
    let mut normals = given.clone();
    if missing > 0 {
        let planes = plane_normals(positions, near, &neighborhood);
        normals.iter_mut().zip(planes).filter(|(n, _)| **n == DVec3::ZERO).for_each(|(n, plane)| *n = plane);
    }
    let part = orient(positions, &mut normals, graph);
    summary.turned_normals = side_with(&given, &mut normals, &part);
    if summary.tells_no_outside(positions.len()) {
        turn_outwards(positions, &mut normals, &part, &graph.spacings(positions));
    }
    if missing > 0 && options.fit.unwrap_or(fit) == NormalFit::Sphere {
        for _ in 0..SPHERES {
            let spheres = sphere_normals(positions, &normals, &neighborhood);
            let missing = normals.iter_mut().zip(spheres).zip(&given).filter(|(_, given)| **given == DVec3::ZERO);
            missing.for_each(|((n, sphere), _)| *n = sphere);
        }
    }
    normals
}
