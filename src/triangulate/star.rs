//! The star of a sample: its one-ring in the Delaunay triangulation of its neighbours, unrolled into its tangent plane.
//!
//! A Delaunay triangle has a circumcircle without samples. All triangles of the star are correct if the neighbourhood
//! reaches twice as far as the largest of their circumradii, so it grows until it does.
//!
//! Where all samples concerned face about the same way, the neighbourhood is a ball; elsewhere, it is found by walking over
//! the surface. The star is read from the sample's Voronoi cell or, near a boundary, whose edges are constraints, from a
//! constrained Delaunay triangulation.
//!
//! Cost: a query for some fifteen points and their bisectors; a walk in strongly curved or thin places; a triangulation
//! instead of the cell near boundaries.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::spatial::kdtree::Neighbor;
use crate::surface::domain::{Domain, Sample};
use crate::triangulate::neighborhood::Neighborhood;
use crate::triangulate::neighbors_of_patch::NeighborsOfPatch;
use crate::triangulate::unfold::{SamplesByTriangle, Unfolding, along_gentle_bend};
use glam::DVec2;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

/// Initial radius of a neighbourhood, in mean spacings. Circumradii of samples that the scan keeps are mostly below
/// one.
const FIRST_RADIUS: f64 = 2.0;

/// Growth factor of a neighbourhood that was too small, and maximum number of attempts.
const GROWTH: f64 = 1.5;
const MOST_ATTEMPTS: usize = 3;

/// Maximum number of samples in a neighbourhood, where some fifteen are expected. Beyond it there is no star: samples on
/// curves are so much denser than the spacing there that only a tessellation of the patch has room for all of them.
const MOST_NEIGHBOURS: usize = 150;

/// Blocks of samples for each thread, and minimum number of samples in a block: enough to outweigh the memory of its walks,
/// which is proportional to the domain.
const BLOCKS: usize = 8;
const SMALLEST_BLOCK: usize = 512;

/// Marks a sample that is not on a boundary.
pub const INTERIOR: u32 = u32::MAX;

/// A sample as a point of the plane.
#[derive(Clone, Copy)]
struct Site {
    place: Point2<f64>,
    sample: u32,
}

impl HasPosition for Site {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.place
    }
}

/// The samples from which stars are made.
#[derive(Clone, Copy)]
struct Cloud<'a> {
    domain: &'a Domain,
    samples: &'a [Sample],
    successor: &'a [u32],
    spacing: f64,
    by_triangle: &'a SamplesByTriangle,
    near: &'a NeighborsOfPatch<'a>,
}

/// Returns the stars of all samples, as triangles that begin with the centre of the star. `successor` has the next sample on
/// the boundary for each sample, or [`INTERIOR`]; `spacing` is the mean distance of neighbouring samples where their size is
/// 1.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn stars(
    domain: &Domain,
    samples: &[Sample],
    successor: &[u32],
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<Vec<[u32; 3]>> {
    check(monitor)?;
    let by_triangle = SamplesByTriangle::new(domain.mesh.triangles.len(), samples);
    let near = NeighborsOfPatch::new(domain, samples);
    let cloud = Cloud { domain, samples, successor, spacing, by_triangle: &by_triangle, near: &near };
    let size = samples.len().div_ceil(BLOCKS * rayon::current_num_threads()).max(SMALLEST_BLOCK);
    let of_blocks: Vec<Vec<[u32; 3]>> = parallel::blocks(0..samples.len() as u32, size, |block| {
        let mut maker = StarMaker::new(cloud);
        let mut triangles = Vec::with_capacity(6 * block.len());
        block.for_each(|centre| maker.star(centre, &mut triangles));
        triangles
    });
    Ok(of_blocks.concat())
}

/// Makes stars, and reuses its memory for the next one.
struct StarMaker<'a> {
    cloud: Cloud<'a>,
    unfolding: Unfolding<'a>,
    around: Neighborhood,
}

impl<'a> StarMaker<'a> {
    fn new(cloud: Cloud<'a>) -> Self {
        let unfolding = Unfolding::new(cloud.domain, cloud.samples, cloud.by_triangle);
        StarMaker { cloud, unfolding, around: Neighborhood::default() }
    }

    /// Appends the triangles of the star of sample `centre` to `triangles`, counter-clockwise, the centre first.
    fn star(&mut self, centre: u32, triangles: &mut Vec<[u32; 3]>) {
        let mut radius = FIRST_RADIUS * self.spacing_at(centre);
        let begin = triangles.len();
        for _ in 0..MOST_ATTEMPTS {
            triangles.truncate(begin);
            let doubtful = self.find_in_ball(centre, radius);
            if self.around.found.len() > MOST_NEIGHBOURS {
                return;
            }
            let mut reach = self.star_of_found(centre, radius, triangles);
            if doubtful <= 2.0 * reach {
                triangles.truncate(begin);
                self.unfolding.neighbours(centre, radius, &mut self.around.found);
                reach = self.star_of_found(centre, radius, triangles);
            }
            if 2.0 * reach <= radius {
                break;
            }
            radius *= GROWTH;
        }
    }

    /// Target distance between sample `s` and its neighbours.
    fn spacing_at(&self, s: u32) -> f64 {
        self.cloud.spacing * self.cloud.samples[s as usize].size
    }

    /// Finds the samples of the patch of `centre` within `radius` of it, as if the surface were a single layer. Returns the
    /// distance of the nearest sample that may belong to another layer because it faces another way. (The two sides of a
    /// thin wall face different ways, and between two layers that face the same way there is one that does not.)
    fn find_in_ball(&mut self, centre: u32, radius: f64) -> f64 {
        let Cloud { domain, samples, near, .. } = self.cloud;
        let here = &samples[centre as usize];
        let mut doubtful = f64::INFINITY;
        let patch = domain.patch_of(here.triangle);
        let collect = |found: &mut Vec<Neighbor>| near.collect_within(patch, here.position, radius, found);
        self.around.find(centre, collect, |neighbor| {
            let place = along_gentle_bend(here, &samples[neighbor.point as usize]);
            if place.is_none() {
                doubtful = doubtful.min(neighbor.distance_squared.sqrt());
            }
            place
        });
        doubtful
    }

    /// Makes the star among the samples found; returns the largest circumradius, infinite if the star is open away from a
    /// boundary.
    fn star_of_found(&mut self, centre: u32, radius: f64, triangles: &mut Vec<[u32; 3]>) -> f64 {
        self.around.sort();
        let at_boundary = |s: u32| self.cloud.successor[s as usize] != INTERIOR;
        if at_boundary(centre) || self.around.found.iter().any(|n| at_boundary(n.sample)) {
            self.constrained_star(centre, triangles)
        } else {
            self.star_of_cell(centre, radius, triangles)
        }
    }

    /// Makes the star of a sample without boundaries around it; returns the largest circumradius, infinite if the star is
    /// open.
    fn star_of_cell(&mut self, centre: u32, radius: f64, triangles: &mut Vec<[u32; 3]>) -> f64 {
        let reach = self.around.cut(radius);
        if reach.is_finite() {
            let ring = self.around.cell.ring();
            let next = ring.clone().cycle().skip(1);
            triangles.extend(ring.zip(next).map(|(a, b)| [centre, a, b]));
        }
        reach
    }

    /// Makes the star among boundaries; returns the largest circumradius, infinite if the star is open away from a boundary.
    fn constrained_star(&self, centre: u32, triangles: &mut Vec<[u32; 3]>) -> f64 {
        let Some(plane) = self.triangulation(centre) else { return f64::INFINITY };
        let Some(hub) = plane.fixed_vertices().next().map(|v| plane.vertex(v)) else { return f64::INFINITY };
        let mut ring: Vec<Site> = hub.out_edges().map(|e| *e.to().data()).collect();
        let inner: Vec<bool> = hub.out_edges().map(|e| !e.face().is_outer()).collect();
        let next = self.cloud.successor[centre as usize];
        let mut wedges = ring.len();
        if next != INTERIOR {
            // From the next sample on the boundary counter-clockwise to the previous one.
            let Some(first) = ring.iter().position(|s| s.sample == next) else { return f64::INFINITY };
            ring.rotate_left(first);
            let last = ring.iter().position(|s| self.cloud.successor[s.sample as usize] == centre);
            let Some(last) = last else { return f64::INFINITY };
            wedges = last;
        } else if inner.contains(&false) {
            return f64::INFINITY;
        }
        let mut reach: f64 = 0.0;
        for i in 0..wedges {
            let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
            triangles.push([centre, a.sample, b.sample]);
            reach = reach.max(circumradius(a.place, b.place));
        }
        reach * self.spacing_at(centre)
    }

    /// Triangulates the neighbours in units of the spacing; the centre is the first vertex.
    fn triangulation(&self, centre: u32) -> Option<ConstrainedDelaunayTriangulation<Site>> {
        let mut plane = ConstrainedDelaunayTriangulation::<Site>::new();
        let hub = plane.insert(Site { place: Point2::new(0.0, 0.0), sample: centre }).ok()?;
        let spacing = self.spacing_at(centre);
        let mut on_boundary = vec![];
        if self.cloud.successor[centre as usize] != INTERIOR {
            on_boundary.push((centre, hub));
        }
        for n in &self.around.found {
            let DVec2 { x, y } = n.place / spacing;
            let before = plane.num_vertices();
            // Of places too close to tell apart, the sample that came first keeps its own.
            let clean = |c: f64| if c.abs() < 1e-9 { 0.0 } else { c };
            let place = Point2::new(clean(x), clean(y));
            if plane.locate_vertex(place).is_some() {
                continue;
            }
            let vertex = plane.insert(Site { place, sample: n.sample }).ok()?;
            if plane.num_vertices() > before && self.cloud.successor[n.sample as usize] != INTERIOR {
                on_boundary.push((n.sample, vertex));
            }
        }
        let mut by_sample = on_boundary.clone();
        by_sample.sort_unstable_by_key(|b| b.0);
        for &(sample, from) in &on_boundary {
            if let Ok(next) = by_sample.binary_search_by_key(&self.cloud.successor[sample as usize], |b| b.0) {
                plane.try_add_constraint(from, by_sample[next].1);
            }
        }
        Some(plane)
    }
}

/// Circumradius of the triangle with corners `a`, `b` and the origin.
fn circumradius(a: Point2<f64>, b: Point2<f64>) -> f64 {
    let (a, b) = (DVec2::new(a.x, a.y), DVec2::new(b.x, b.y));
    a.length() * b.length() * (a - b).length() / (2.0 * a.perp_dot(b).abs()).max(f64::MIN_POSITIVE)
}
