//! Pipeline from a point cloud to a mesh through its points, which is then remeshed like any other.

use crate::base::error::{Error, Fault, Result, Setting};
use crate::base::monitor::{Monitor, check};
use crate::geom::eigen::{eigen, scatter};
use crate::mesh::points::Points;
use crate::mesh::triangle_mesh::Mesh;
use crate::prepare::clean::{merged, wanted_by_others};
use crate::prepare::cloud_normals::{MANY_NEIGHBORS, Neighborhood, plane_normals, sphere_normals};
use crate::prepare::flatten::{Flatness, flatness, flattened};
use crate::prepare::orient::{disagreement, orient, side_with};
use crate::prepare::outside::{face_outwards, turn_outwards};
use crate::prepare::thin::Thinned;
use crate::spatial::kdtree::Neighbors;
use crate::spatial::knn_graph::{DEGREE, NeighborGraph};
use crate::surface::implicit::Rimls;
use crate::triangulate::boundary_loops::Filled;
use crate::triangulate::points::triangulate_points;
use crate::triangulate::surroundings::Surroundings;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Options for turning a cloud into a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct CloudOptions {
    /// Shape fitted to estimate missing normals. Default: planes, or spheres if noise is smoothed.
    pub fit: Option<NormalFit>,
    /// Neighbours to which it is fitted. Default: the nearest eight, or the nearest sixteen if noise is smoothed.
    pub neighborhood: Option<Reach>,
    /// Support radius of the implicit surface onto which points are projected, in mean distances of neighbouring points: the
    /// larger, the smoother. With zero, points stay where they are. Default: `None`, which is [`SMOOTHING_SUPPORT`] if there
    /// is noise and zero otherwise.
    pub smooth: Option<f64>,
    /// Largest bounding-box diagonal of holes that are closed, in the units of the input. Default: 0, which keeps all holes
    /// larger than the gaps between points.
    pub fill_holes: f64,
    /// Whether the points are of terrain: those visible from above become a sheet with one height at each place; z is up.
    /// Default: `None`, which means yes if they look like terrain and many would otherwise be left out.
    pub terrain: Option<bool>,
}

impl Default for CloudOptions {
    fn default() -> Self {
        CloudOptions { fit: None, neighborhood: None, smooth: None, fill_holes: 0.0, terrain: None }
    }
}

impl CloudOptions {
    /// Refuses options that suit no cloud.
    ///
    /// # Errors
    /// [`Error::Option`] for fewer than three neighbours, or a length that is not positive and finite.
    pub fn validate(&self) -> Result<()> {
        check_smooth(self.smooth)?;
        let refuse = |option, cause: String, remedy: &str| Err(Error::Option { option, cause, remedy: remedy.into() });
        match self.neighborhood {
            Some(Reach::Count(n)) if n < 3 => {
                refuse(Setting::NormalNeighbors, format!("{n} neighbours have no normal"), "give at least 3")
            }
            Some(Reach::Radius(r)) if !(r > 0.0 && r.is_finite()) => {
                refuse(Setting::NormalRadius, format!("{r} is not a length"), "give a length above zero")
            }
            _ if !(self.fill_holes >= 0.0 && self.fill_holes.is_finite()) => {
                let cause = format!("{} is not the size of a hole", self.fill_holes);
                refuse(Setting::FillHoles, cause, "give a length of zero or more")
            }
            _ => Ok(()),
        }
    }
}

impl CloudOptions {
    /// Returns the same options for points whose coordinates were divided by `size`.
    pub(super) fn within_unit(&self, size: f64) -> CloudOptions {
        let neighborhood = self.neighborhood.map(|reach| match reach {
            Reach::Radius(radius) => Reach::Radius(radius / size),
            count => count,
        });
        CloudOptions { neighborhood, fill_holes: self.fill_holes / size, ..*self }
    }
}

/// Refuses a support radius that is out of range.
pub(super) fn check_smooth(reach: Option<f64>) -> Result<()> {
    let refuse = |reach: f64| {
        let cause = format!("{reach} spacings are out of range");
        Err(Error::Option {
            option: Setting::Smoothing,
            cause,
            remedy: "give a number from 1.5 to 20, or 0 for none".into(),
        })
    };
    smoothing(reach).filter(|r| !(1.5..=20.0).contains(r)).map_or(Ok(()), refuse)
}

/// Returns the support radius if anything is smoothed; zero means no smoothing.
pub(super) fn smoothing(reach: Option<f64>) -> Option<f64> {
    reach.filter(|&reach| reach != 0.0)
}

/// Shape that is fitted to estimate normals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NormalFit {
    /// Planes: the sharpest choice where there is little noise.
    Plane,
    /// Algebraic spheres, after planes: smoother, and exact where the surface bends evenly.
    Sphere,
}

impl NormalFit {
    /// All variants.
    pub const ALL: [NormalFit; 2] = [NormalFit::Plane, NormalFit::Sphere];

    /// Name of the variant as an option.
    pub fn name(self) -> &'static str {
        match self {
            NormalFit::Plane => "plane",
            NormalFit::Sphere => "sphere",
        }
    }
}

/// Neighbours of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reach {
    /// This number of nearest points.
    Count(usize),
    /// All points within this distance, in the units of the input.
    Radius(f64),
}

/// Summary of how the points of a cloud were used for a mesh.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CloudSummary {
    /// Number of points of the input, or of those kept after thinning.
    pub points: usize,
    /// Number of points of the input if they were thinned because there were more than are of use; otherwise 0.
    #[serde(default)]
    pub thinned_from: usize,
    /// Width of the cells of the thinning, each of which kept one point.
    #[serde(default)]
    pub cell: f64,
    /// Points that coincide with another one.
    pub duplicates: usize,
    /// Points that are no other point's neighbour.
    pub outliers: usize,
    /// Other points that are not vertices of the mesh.
    pub unused: usize,
    /// Points of small shreds that are not connected to any surface.
    #[serde(default)]
    pub in_shreds: usize,
    /// Number of these shreds.
    #[serde(default)]
    pub shreds: usize,
    /// Width of the grid cells in plan view, each of which contributed its highest point, if the points are of terrain;
    /// otherwise 0.
    #[serde(default)]
    pub plan_cell: f64,
    /// Points lower than another one in such a cell.
    #[serde(default)]
    pub below: usize,
    /// Whether there is noise that smoothing would remove.
    #[serde(default)]
    pub noisy: bool,
    /// Support radius of the implicit surface that points were projected onto because of noise, without being asked; 0 if
    /// they were not moved.
    #[serde(default)]
    pub smoothed_by_itself: f64,
    /// Number of neighbours whose fitted planes the points were projected onto, because noise hides the surface in fewer; 0
    /// if that was not necessary.
    #[serde(default)]
    pub flattened_neighbors: usize,
    /// Normals that were estimated.
    pub estimated_normals: usize,
    /// Given normals that were reversed.
    pub turned_normals: usize,
}

impl CloudSummary {
    /// Records that the points were thinned.
    pub fn thin(&mut self, thinned: &Thinned) {
        (self.thinned_from, self.cell) = (thinned.points, thinned.cell);
    }

    /// Returns whether the normals of `points` points fail to tell which side is outside.
    fn tells_no_outside(&self, points: usize) -> bool {
        SIDED * (self.estimated_normals + self.turned_normals) > points
    }
}

/// Mesh through the points of a cloud.
#[derive(Debug, Clone)]
pub struct MeshOfPoints {
    /// Oriented manifold, closed where the cloud is.
    pub mesh: Mesh,
    /// For each vertex, the input point that it is.
    pub source: Vec<u32>,
    /// Points that the mesh should pass through: at distinct places, without outliers.
    pub surface_points: Vec<u32>,
    /// Mean distance of neighbouring points.
    pub spacing: f64,
    /// Summary of how the points were used.
    pub summary: CloudSummary,
}

/// Number of neighbours to which planes are fitted where there is no noise: as few as possible, to preserve sharp features.
pub const FEW_NEIGHBORS: usize = 8;

/// Number of times that spheres are fitted, each time using the previous normals.
const SPHERES: usize = 2;

/// Support radius of the implicit surface of points without noise, in their spacings: just large enough to leave no holes
/// between them.
pub const INTERPOLATING_SUPPORT: f64 = 2.3;

/// Support radius that smooths away the noise of a typical scan, in spacings of its points.
pub const SMOOTHING_SUPPORT: f64 = 2.7;

/// Area per point, in squares of its spacing, which is the distance to the sixth neighbour.
const AREA_OF_SPACING: f64 = 0.6;

/// Share of neighbouring pairs with opposite normals above which given normals are not trusted.
const MOST_DISAGREEMENT: f64 = 0.01;

/// If more than one in this many normals has no reliable side, the sides of the others are not trusted either.
const SIDED: usize = 4;

/// Minimum number of points of a cloud.
const FEWEST_POINTS: usize = 8;

/// Usable points of a cloud, with normals and neighbour information.
pub(super) struct Prepared {
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
pub(super) struct Cleaned {
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
    /// [`Error::Mesh`] for points without an area; [`Error::Cancelled`] if the monitor asks for it.
    pub fn of(points: &Points, summary: &mut CloudSummary, monitor: &dyn Monitor) -> Result<Cleaned> {
        let (points, source) = merged(points);
        summary.duplicates = summary.points - points.positions().len();
        refuse_without_surface(points.positions())?;
        let all = Cleaned::with_neighbors(points, source);
        check(monitor)?;
        let wanted = wanted_by_others(&all.graph, all.source.len());
        summary.outliers = wanted.iter().filter(|w| !**w).count();
        if summary.outliers == 0 {
            return Ok(all);
        }
        let kept: Vec<u32> = (0..wanted.len() as u32).filter(|&p| wanted[p as usize]).collect();
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
pub(super) fn prepared(points: &Points, options: &CloudOptions, monitor: &dyn Monitor) -> Result<Prepared> {
    options.validate()?;
    monitor.stage("clean");
    let mut summary = CloudSummary { points: points.positions().len(), ..CloudSummary::default() };
    let Cleaned { mut points, source, mut near, mut graph } = Cleaned::of(points, &mut summary, monitor)?;
    let spacing = mean(&graph.spacings(points.positions()));
    let flatness = flatness(points.positions(), &near);
    summary.noisy = matches!(flatness, Flatness::NotQuite | Flatness::At(_));
    let mut smooth = smoothing(options.smooth);
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
    if let Some(reach) = smooth {
        monitor.stage("smooth");
        (positions, normals) = Rimls::new(&positions, &normals, &near, &spacings, reach).smoothed();
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
pub(super) fn no_surface(points: usize) -> Error {
    let cause = format!("no surface goes through these {points} points: neighbours do not agree on one");
    Error::Mesh {
        fault: Fault::NoSurface,
        cause,
        remedy: "give more points, or less noisy ones, or try smoothing".into(),
    }
}

/// Refuses points without an area.
fn refuse_without_surface(positions: &[DVec3]) -> Result<()> {
    let refuse =
        |fault, cause: String| Err(Error::Mesh { fault, cause, remedy: "give points all over a surface".into() });
    if let Some(p) = positions.iter().position(|p| !p.is_finite()) {
        return refuse(Fault::Coordinates, format!("point {p} is at {}", positions[p]));
    }
    let n = positions.len();
    if n == 1 {
        return refuse(Fault::NoArea, "all points are at one place".into());
    }
    let ([_, middle, largest], _) = eigen(scatter(positions.iter().copied()).1);
    if n > 1 && middle.max(0.0).sqrt() <= 1e-7 * largest.sqrt() {
        return refuse(Fault::NoArea, format!("all {n} points lie on a line"));
    }
    if n < FEWEST_POINTS {
        return refuse(Fault::Empty, format!("{n} points at different places are too few for a surface"));
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
    let neighborhood = match options.neighborhood.unwrap_or(Reach::Count(few)) {
        Reach::Count(count) => {
            fewer = (count > graph.degree()).then(|| NeighborGraph::new(positions, near, count));
            Neighborhood::Nearest(fewer.as_ref().unwrap_or(graph), count)
        }
        Reach::Radius(radius) => Neighborhood::Within(near, radius),
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
