//! Sampling and reconstruction, each as one call.

use crate::base::error::{Result, Setting};
use crate::base::monitor::{Monitor, Overall};
use crate::base::parallel;
use crate::job::input::Input;
use crate::job::thinning::wanted_for_sampling;
use crate::mesh::attributes::Attribute;
use crate::pipeline::{self, ReconstructOptions, Reconstructed, SampleOptions, Sampled, Signal, points_of_mesh};
use crate::report::noise;
use crate::spatial::kdtree::Neighbors;
use crate::transfer::vertex::{Carried, carry_to_points};
use glam::DVec3;

/// Stages and their approximate shares of the time.
const SAMPLING: [(&str, f64); 6] =
    [("clean", 0.1), ("normals", 0.1), ("repair", 0.1), ("sample", 0.4), ("ascend", 0.4), ("order", 0.2)];
const RECONSTRUCTION: [(&str, f64); 3] = [("clean", 0.1), ("normals", 0.1), ("extract", 0.8)];

/// Samples the surface of a mesh or of points. The result is points with normals and without triangles, as the gradient
/// ascent of the paper leaves them, or a subset of the input's points.
///
/// # Errors
/// Those of [`remesh`](crate::remesh()).
pub fn sample(input: &Input, options: &SampleOptions, monitor: &dyn Monitor) -> Result<Sampled> {
    options.validate()?;
    input.check()?;
    if !input.is_cloud() {
        options.refuse_box()?;
    }
    let input = &*input.thinned_to(wanted_for_sampling(options))?;
    let monitor = &Overall::new(monitor, &SAMPLING);
    let resolved = |signal: &Signal| signal.with_values(|values| input.values(Setting::Signals, values));
    let signals: Result<Vec<Signal>> = options.signals.iter().map(resolved).collect();
    let options = SampleOptions { signals: signals?, ..options.clone() };
    if !input.is_cloud() {
        return Ok(with_attributes(pipeline::sample(input.as_mesh(), &options, monitor)?, input));
    }
    let mut sampled = with_attributes(pipeline::sample_points(&input.as_points()?, &options, monitor)?, input);
    // Samples that are points of the input do not move.
    let moved = sampled.cloud.as_ref().filter(|_| !options.scan_only);
    sampled.notes.extend(moved.and_then(noise));
    if let Some(thinned) = input.thinning() {
        sampled.cloud.iter_mut().for_each(|cloud| cloud.thin(thinned));
        sampled.indices = sampled.indices.map(|points| input.numbers(points));
        sampled.notes.splice(0..0, thinned.notes());
    }
    Ok(sampled)
}

/// Adds the attributes that `input` has at the samples: their own if they are points of it, otherwise those at their place
/// on a mesh, or of the nearest point of a cloud.
fn with_attributes(sampled: Sampled, input: &Input) -> Sampled {
    let attributes = input.attributes();
    // Samples have normals of their own.
    if attributes.vertex.iter().all(Attribute::is_normal) {
        return sampled;
    }
    if let Some(indices) = &sampled.indices {
        let own = attributes.of_vertices(indices);
        return sampled.carrying(own);
    }
    if input.is_cloud() {
        let nearest = attributes.of_vertices(&nearest(&input.as_mesh().positions, sampled.points.positions()));
        return sampled.carrying(nearest);
    }
    let Carried { attributes, lost, .. } = carry_to_points(input.as_mesh(), attributes, &sampled.origins);
    sampled.without(lost).carrying(attributes)
}

/// Returns the number of the point nearest to each of `places`.
fn nearest(points: &[DVec3], places: &[DVec3]) -> Vec<u32> {
    let points = Neighbors::new(points);
    parallel::map(places, |&place| points.nearest(place).expect("samples are of points").point)
}

/// Returns the robust implicit surface of points, or of the vertices of a mesh, as dense triangles.
///
/// # Errors
/// Those of [`remesh`](crate::remesh()), and [`Error::Option`](crate::Error::Option) for a resolution that takes more memory
/// than can be intended.
pub fn reconstruct(input: &Input, options: &ReconstructOptions, monitor: &dyn Monitor) -> Result<Reconstructed> {
    input.check()?;
    let monitor = &Overall::new(monitor, &RECONSTRUCTION);
    let points = if input.is_cloud() { input.as_points()? } else { points_of_mesh(input.as_mesh()) };
    pipeline::reconstruct(&points, options, monitor)
}
