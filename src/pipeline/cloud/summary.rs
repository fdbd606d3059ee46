//! Summary of how the points of a cloud were used for a mesh.

use crate::prepare::thin::Thinned;
use serde::{Deserialize, Serialize};

/// If more than one in this many normals has no reliable side, the sides of the others are not trusted either.
const SIDED: usize = 4;

/// Summary of how the points of a cloud were used for a mesh.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CloudSummary {
    /// Number of points of the input, or of those kept after thinning.
    pub points: usize,
    /// Number of points of the input if they were thinned because there were more than are of use; otherwise 0. Points outside
    /// of a box are not among them.
    #[serde(default)]
    pub thinned_from: usize,
    /// Width of the cells of the thinning, each of which kept one point.
    #[serde(default)]
    pub cell: f64,
    /// Points that were read and are outside of the box of the points that are wanted.
    #[serde(default)]
    pub outside: usize,
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
    /// Vertices that were added on sharp edges, where the planes of both sides meet between points.
    #[serde(default)]
    pub on_sharp_edges: usize,
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
        self.outside = thinned.outside();
        if thinned.cell > 0.0 {
            (self.thinned_from, self.cell) = (thinned.inside, thinned.cell);
        }
    }

    /// Returns whether the normals of `points` points fail to tell which side is outside.
    pub(in crate::pipeline) fn tells_no_outside(&self, points: usize) -> bool {
        SIDED * (self.estimated_normals + self.turned_normals) > points
    }
}
