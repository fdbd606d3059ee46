//! Outline of a large cloud: a few of its points that provide what its parts cannot know by themselves: which side of the
//! surface is outside, and the kernel width for a number of samples.

use crate::base::error::{Error, Result};
use crate::base::monitor::Monitor;
use crate::mesh::points::Points;
use crate::pipeline::cloud::options::CloudOptions;
use crate::pipeline::cloud::{mesh_of_points, prepared};
use crate::pipeline::density::{Density, SampleDensity};
use crate::pipeline::scale::Scale;
use crate::prepare::orient::sided;
use crate::spatial::kdtree::Neighbors;
use crate::spectral::scan::{Given, Kernel, scan_lifted};
use crate::surface::features::Features;
use crate::surface::lift::{Lift, bare_samples};
use glam::DVec3;

/// Number of outline points that decide the side of a normal.
const ASKED: usize = 8;

/// Points per sample when the outline itself is sampled.
const CHOICES: usize = 5;

/// Points of a cloud with unit normals on a common side.
pub struct Outline {
    points: Points,
    near: Neighbors,
}

/// Global properties of a cloud, derived from some of its points.
pub struct Survey {
    /// These points, with unit normals on a common side.
    pub outline: Points,
    /// Whether the given normals are already on a common side.
    pub is_sided: bool,
    /// Whether the noise is larger than the distance of neighbours, so that small neighbourhoods are not flat.
    pub is_thick: bool,
    /// Approximate width of the kernel for the wanted density.
    pub sigma: f64,
}

/// Examines some points of a cloud, spread all over it.
///
/// # Errors
/// Those of [`mesh_of_points`](crate::pipeline::mesh_of_points).
pub fn survey(
    points: &Points,
    density: SampleDensity,
    options: &CloudOptions,
    seed: u64,
    monitor: &dyn Monitor,
) -> Result<Survey> {
    let cloud = prepared(points, options, monitor)?;
    let is_sided = cloud.summary.estimated_normals == 0 && cloud.summary.turned_normals == 0;
    let is_thick = cloud.summary.flattened_neighbors > 0;
    let sigma = match density {
        SampleDensity::SigmaP(sigma) => sigma,
        SampleDensity::EdgeLength(length) => Scale::sigma_of_spacing(length),
        SampleDensity::Points(wanted) => {
            let few = (cloud.points.positions().len() / CHOICES).max(1);
            let sigma = Scale::of_points(few, cloud.area()).sigma();
            let choices = bare_samples(&cloud.points);
            let given = Given { samples: &choices, domain: None };
            let kept = scan_lifted::<3>(&given, &[], Kernel { sigma, lift: Lift::NONE }, seed, monitor)?;
            // On a surface, the number of samples is inversely proportional to the square of the width.
            sigma * (kept.len() as f64 / wanted as f64).sqrt()
        }
    };
    Ok(Survey { outline: cloud.points, is_sided, is_thick, sigma })
}

/// Returns whether the surface through an outline has sharp edges.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn has_sharp_edges(outline: &Points, monitor: &dyn Monitor) -> Result<bool> {
    match mesh_of_points(outline, &CloudOptions::default(), monitor) {
        Ok(through) => Ok(through.cut_edges(&Features::Automatic, Density::Auto).is_some()),
        Err(Error::Mesh { .. }) => Ok(false),
        Err(error) => Err(error),
    }
}

impl Outline {
    /// Makes the outline that a [`Survey`] found.
    pub fn new(points: Points) -> Outline {
        let near = Neighbors::new(points.positions());
        Outline { points, near }
    }

    /// Positions of its points.
    pub fn positions(&self) -> &[DVec3] {
        self.points.positions()
    }

    /// Its points, with normals.
    pub(in crate::pipeline) fn points(&self) -> &Points {
        &self.points
    }

    /// Returns the normal of a point of the cloud or its opposite, whichever is on the common side.
    pub fn sided(&self, position: DVec3, normal: DVec3) -> DVec3 {
        let mut found = Vec::new();
        self.near.collect_nearest_within(position, ASKED, f64::INFINITY, &mut found);
        let at = |p: u32| (self.points.positions()[p as usize], self.points.normals()[p as usize]);
        sided(position, normal, found.iter().map(|n| at(n.point)))
    }
}
