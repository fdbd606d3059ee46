//! Remeshing as one call.

use crate::base::error::{Error, Result};
use crate::base::monitor::{Monitor, Overall, Part, check};
use crate::job::input::Input;
use crate::job::outcome::{Origin, Outcome};
use crate::job::thinning::wanted_for_remeshing;
use crate::mesh::attributes::{Attributes, Lost};
use crate::mesh::provenance::Origins;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::{
    CloudOptions, CloudSummary, Coverage, Density, LostComponents, Options, Remeshed, Remesher, Selection,
    check_levels, mesh_of_cloud,
};
use crate::prepare::thin::Thinned;
use crate::report::{Report, left_out, noise, terrain};
use crate::transfer::vertex::{Carried, carry};
use glam::DVec3;
use std::borrow::Cow;
use std::sync::Arc;

/// Options of remeshing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RemeshOptions {
    /// How to remesh it.
    pub surface: Options,
    /// How points without triangles are first turned into a surface.
    pub cloud: CloudOptions,
    /// Which attributes the result gets.
    pub carry: Carry,
    /// Whether to leave out the report: measuring takes time. Default: false.
    pub without_report: bool,
}

impl From<Options> for RemeshOptions {
    fn from(surface: Options) -> RemeshOptions {
        RemeshOptions { surface, ..RemeshOptions::default() }
    }
}

/// Which attributes of the input the result gets.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Carry {
    /// All of them.
    #[default]
    All,
    /// All but these, which the report lists as lost.
    AllBut(Vec<Lost>),
    /// None.
    Nothing,
}

/// Stages and their approximate shares of the time.
const OF_POINTS: [(&str, f64); 4] = [("clean", 0.1), ("normals", 0.1), ("smooth", 0.1), ("connect", 0.4)];
const OF_MESH: [(&str, f64); 15] = [
    ("repair", 0.06),
    ("smooth", 0.02),
    ("sample", 0.1),
    ("triangulate", 0.08),
    ("ascend", 0.3),
    ("relax", 0.15),
    ("improve angles", 0.06),
    ("fit", 0.12),
    ("resolve self-intersections", 0.03),
    ("untangle", 0.01),
    ("mend", 0.02),
    ("slide", 0.01),
    ("bound", 0.02),
    ("carry attributes", 0.02),
    ("measure", 0.1),
];

/// Remeshes a mesh or points. The result has as many vertices as wanted, evenly spread or graded, triangles close to
/// equilateral, the same shape and topology, the attributes of the input, and the origin of each vertex.
///
/// # Errors
/// [`Error::Mesh`] for an input without area, with bad numbers, or with points through which no surface passes, and for an
/// attribute that options name but the input lacks; [`Error::Option`] for options out of range; [`Error::Cancelled`] if the
/// monitor asks for it.
pub fn remesh(input: &Input, options: &RemeshOptions, monitor: &dyn Monitor) -> Result<Outcome> {
    let mut made = None;
    let keep = &mut |outcome| {
        made = Some(outcome);
        Ok(())
    };
    remesh_each(input, options, &[options.surface.density], keep, monitor)?;
    Ok(made.expect("each density has its outcome"))
}

/// Makes levels of detail: remeshes the same input for each of these numbers of vertices, from fine to coarse. Each result
/// is what [`remesh()`] makes for that number, compared with the input and not with the level before; `each` gets it once it
/// is done. The input is repaired only once, and points become a mesh only once. The density of the options is ignored.
///
/// # Errors
/// Those of [`remesh()`] and of `each`; [`Error::Option`] if there are no numbers, or they do not decrease.
pub fn remesh_levels(
    input: &Input,
    options: &RemeshOptions,
    counts: &[usize],
    each: &mut dyn FnMut(Outcome) -> Result<()>,
    monitor: &dyn Monitor,
) -> Result<()> {
    check_levels(counts)?;
    let densities: Vec<Density> = counts.iter().map(|&n| Density::Points(n)).collect();
    let surface = Options { density: densities[0], ..options.surface.clone() };
    remesh_each(input, &RemeshOptions { surface, ..options.clone() }, &densities, each, monitor)
}

/// Remeshes the input for each of the densities.
fn remesh_each(
    input: &Input,
    options: &RemeshOptions,
    densities: &[Density],
    each: &mut dyn FnMut(Outcome) -> Result<()>,
    monitor: &dyn Monitor,
) -> Result<()> {
    options.surface.validate()?;
    input.check()?;
    let input = &*input.thinned_to(wanted_for_remeshing(&options.surface))?;
    let of_triangles = if input.is_cloud() { 0 } else { input.as_mesh().positions.len() };
    options.surface.features.check(of_triangles)?;
    let plan = if input.is_cloud() { [&OF_POINTS[..], &OF_MESH].concat() } else { OF_MESH.to_vec() };
    let shares = shares(densities);
    let first = &Part::new(monitor, 0.0, shares[0]);
    let first = &Overall::new(first, &plan);
    let surface = Surface::new(input, options, first)?;
    let mut remesher = Remesher::new(surface.mesh(), &surface.options, first)?;
    for (i, &density) in densities.iter().enumerate() {
        let part = &Part::new(monitor, if i == 0 { 0.0 } else { shares[i - 1] }, shares[i]);
        let later = &Overall::new(part, &OF_MESH);
        let monitor = if i == 0 { first } else { later };
        let remeshed = remesher.remesh(density, i + 1 == densities.len(), monitor)?;
        each(finished(&surface, remeshed, options, monitor)?)?;
    }
    Ok(())
}

/// Returns the share of the time after which each of the densities is done.
fn shares(densities: &[Density]) -> Vec<f64> {
    let size = |density: &Density| density.points().map_or(1.0, |n| n as f64);
    let whole: f64 = densities.iter().map(size).sum();
    (1..=densities.len()).map(|i| densities[..i].iter().map(size).sum::<f64>() / whole).collect()
}

/// Completes a result with attributes, origins and report.
fn finished(
    surface: &Surface,
    mut remeshed: Remeshed,
    options: &RemeshOptions,
    monitor: &dyn Monitor,
) -> Result<Outcome> {
    let mut carried = carried(surface, &mut remeshed, &options.carry, monitor)?;
    remeshed.notes.append(&mut carried.notes);
    remeshed.notes.extend(surface.cloud.iter().flat_map(|cloud| cloud.thinned.clone()));
    let coverage = surface.cloud.as_ref().map(|cloud| cloud.coverage(&remeshed));
    coverage.iter().for_each(|coverage| remeshed.hold_against_points(coverage));
    let of_points = surface.cloud.as_ref().zip(coverage).map(|(Cloud { summary, .. }, coverage)| {
        let terrain = options.cloud.terrain.is_none().then(|| terrain(summary)).flatten();
        [terrain, left_out(summary, &coverage), noise(summary)].into_iter().flatten().collect::<Vec<String>>()
    });
    let of_points = of_points.unwrap_or_default();
    remeshed.notes.extend(of_points.clone());
    let warnings = remeshed.lost.as_ref().map(LostComponents::note).into_iter().chain(of_points).collect();
    let report = (!options.without_report).then(|| {
        monitor.stage("measure");
        let report = Report::of_remesh(&remeshed, surface.mesh(), options.surface.seed);
        let attributes = (options.carry != Carry::Nothing).then(|| (&carried).into());
        let cloud = surface.cloud.as_ref().map(|cloud| cloud.summary.clone());
        let report = Report { cloud, attributes, ..report };
        match coverage {
            Some(coverage) => report.of_points(coverage, surface.mesh()),
            None => report,
        }
    });
    check(monitor)?;
    monitor.progress(1.0);
    let (origins, triangle_origins) = surface.origins(&remeshed.origins);
    Ok(Outcome {
        shortcomings: remeshed.shortcomings(coverage.as_ref()),
        origins,
        triangle_origins,
        of_points: surface.cloud.as_ref().map(|cloud| cloud.mesh.clone()),
        attributes: carried.attributes,
        notes: remeshed.notes,
        mesh: remeshed.mesh,
        edges: remeshed.edges,
        warnings,
        report,
    })
}

/// Measures a mesh, and its distance to another one.
///
/// # Errors
/// [`Error::Mesh`] for points without triangles, and for bad numbers.
pub fn quality(mesh: &Input, against: Option<&Input>) -> Result<Report> {
    for input in [Some(mesh), against].into_iter().flatten() {
        input.refuse_points()?;
        input.check()?;
    }
    Ok(Report::of_mesh(mesh.as_mesh(), against.map(Input::as_mesh)))
}

/// The surface that is remeshed: the input, or the mesh through its points.
struct Surface<'a> {
    input: &'a Mesh,
    attributes: Cow<'a, Attributes>,
    /// The options, with values of attributes given at the vertices of the mesh.
    options: Options,
    /// The points of the input, if it has no triangles.
    cloud: Option<Cloud>,
}

/// An input of points.
struct Cloud {
    /// The mesh through the points.
    mesh: Arc<Mesh>,
    /// For each vertex of the mesh, the point of the input that it is.
    points: Vec<u32>,
    summary: CloudSummary,
    /// Positions of the points that the surface should pass through.
    positions: Vec<DVec3>,
    /// Their mean spacing.
    spacing: f64,
    /// Notes on points that are not used.
    thinned: Vec<String>,
}

impl<'a> Surface<'a> {
    fn new(input: &'a Input, options: &RemeshOptions, monitor: &dyn Monitor) -> Result<Surface<'a>> {
        let resolved = resolved(&options.surface, input)?;
        if !input.is_cloud() {
            let (input, attributes) = (input.as_mesh(), Cow::Borrowed(input.attributes()));
            return Ok(Surface { input, attributes, options: resolved, cloud: None });
        }
        // The points inside a box are the input by now.
        if let Some(part) = options.surface.part.as_ref().filter(|part| !matches!(part, Selection::Box(..))) {
            let cause =
                "the input has only points and no triangles, so there is no surface to keep outside the part".into();
            let remedy = "make a mesh of it first, by remeshing all of it".into();
            return Err(Error::Option { option: part.setting(), cause, remedy });
        }
        resolved.grading.check(input.as_mesh().positions.len())?;
        let smooth = options.cloud.smooth.or(options.surface.smooth);
        let cloud = CloudOptions { smooth, ..options.cloud.clone() };
        let mut made = mesh_of_cloud(&input.as_points()?, &cloud, resolved.density, monitor)?;
        let features = made.sharpen(resolved.features.clone(), resolved.density);
        let grading = resolved.grading.with_values(|_, values| Ok(values.of(&made.source)))?;
        if let Some(thinned) = input.thinning() {
            made.summary.thin(thinned);
        }
        // A sheet is smoothed like any mesh.
        let smooth = if made.summary.plan_cell > 0.0 { smooth } else { None };
        let positions = made.surface_points.iter().map(|&p| input.as_mesh().positions[p as usize]).collect();
        Ok(Surface {
            attributes: Cow::Owned(input.attributes().of_vertices(&made.source)),
            input: input.as_mesh(),
            options: Options { grading, smooth, of_points: true, part: None, features, ..resolved },
            cloud: Some(Cloud {
                mesh: Arc::new(made.mesh),
                points: input.numbers(made.source),
                summary: made.summary,
                positions,
                spacing: made.spacing,
                thinned: input.thinning().map(Thinned::notes).unwrap_or_default(),
            }),
        })
    }

    fn mesh(&self) -> &Mesh {
        self.cloud.as_ref().map_or(self.input, |cloud| &cloud.mesh)
    }

    /// Returns where on the input the vertices of a result lie, and the triangle of the input below each of its triangles.
    fn origins(&self, of_result: &Origins) -> (Vec<Origin>, Vec<u32>) {
        let on_mesh = |point| Origin::on_mesh(point, &self.mesh().triangles);
        let on_input = |origin: Origin| match &self.cloud {
            Some(cloud) => origin.between_points(&cloud.points),
            None => origin,
        };
        let triangles = of_result.triangles.iter().map(|point| point.triangle);
        let triangles = if self.cloud.is_none() { triangles.collect() } else { Vec::new() };
        (of_result.vertices.iter().map(on_mesh).map(on_input).collect(), triangles)
    }
}

impl Cloud {
    /// Measures how close the result is to the points.
    fn coverage(&self, remeshed: &Remeshed) -> Coverage {
        Coverage::of(&self.positions, &remeshed.mesh, self.spacing.max(remeshed.spacing))
    }
}

/// Returns the options for `input`, with all attributes that they name looked up.
fn resolved(options: &Options, input: &Input) -> Result<Options> {
    let grading = options.grading.with_values(|option, values| input.values(option, values))?;
    let part = options.part.as_ref().map(|part| part.resolved(input.attributes())).transpose()?;
    let resolved = Options { grading, part, ..options.clone() };
    resolved.validate()?;
    Ok(resolved)
}

/// Carries the attributes of the surface over to the result, as far as they are wanted.
fn carried(surface: &Surface, remeshed: &mut Remeshed, wanted: &Carry, monitor: &dyn Monitor) -> Result<Carried> {
    if *wanted == Carry::Nothing || surface.attributes.is_empty() {
        return Ok(Carried::default());
    }
    monitor.stage("carry attributes");
    let mut attributes = Cow::Borrowed(&*surface.attributes);
    let mut lost = Vec::new();
    if let Carry::AllBut(others) = wanted {
        others.iter().for_each(|other| attributes.to_mut().remove(&other.name));
        lost.clone_from(others);
    }
    let mut carried = carry(surface.mesh(), &attributes, &remeshed.mesh, &remeshed.origins);
    if let Some(kept) = &remeshed.kept {
        carried.keep(surface.mesh(), &attributes, &remeshed.mesh, kept);
    }
    carried.lost.splice(0..0, lost);
    check(monitor)?;
    Ok(carried)
}
