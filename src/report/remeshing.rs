//! The report on a remeshing, or on an existing mesh.
//!
//! The schema is [`SCHEMA`]. Every member is always present: values that a report cannot know (the distance to an input that
//! was not given) are `null`.
//!
//! Cost: the shapes of both meshes, and their distance, measured from [`REPORT_SAMPLES`] points in each direction.

use crate::base::count::{counted, counts};
use crate::geom::triangle::smallest_angle;
use crate::manifold::small_angles::SLIVER;
use crate::mesh::attributes::Lost;
use crate::mesh::topology::{Topology, topology};
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::{CloudSummary, Coverage, Deviation, Remeshed, shortcomings, topology_faults};
use crate::prepare::cells::without_faces_between_cells;
use crate::prepare::repairs::Repairs;
use crate::quality::distance::{Distance, REPORT_SAMPLES, distance};
use crate::quality::shape::{Shape, shape};
use crate::report::run::{RunSummary, to_json};
use crate::spatial::self_intersections::self_intersections;
use crate::transfer::vertex::Carried;
use serde::{Deserialize, Serialize};
use std::borrow::{Borrow, Cow};

/// Name and version of the JSON schema.
pub const SCHEMA: &str = "spectral-remesh/report/2";

/// A report. Its members are those of the JSON text.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// [`SCHEMA`].
    pub schema: String,
    /// Version of the tool that made the report.
    pub version: String,
    /// Whether the output is an oriented manifold with the Euler characteristic, components and boundary loops of the
    /// repaired input, without self-intersections where the input has none, without slivers and bridges, and within the
    /// requested error; `None` for a mesh that was only measured.
    pub verified: Option<bool>,
    /// The input as it was read; for a mesh that was only measured, the mesh that it was measured against.
    pub input: Option<Measured>,
    /// How the mesh of a point cloud was made; `None` for an input with triangles.
    pub cloud: Option<CloudSummary>,
    /// The distances of the points of such an input to the output; `None` for an input with triangles.
    #[serde(default)]
    pub coverage: Option<Coverage>,
    /// The changes to the input before it was sampled.
    pub repairs: Option<Repairs>,
    /// The topology after those repairs, with which that of the output is compared.
    pub repaired: Option<Topology>,
    /// The output, or the mesh that was measured.
    pub output: Measured,
    /// Self-intersecting faces.
    pub crossings: Crossings,
    /// Faces of the output with an angle below 1 degree that the input does not force, in increasing order, numbered from 0;
    /// empty for a mesh that was only measured.
    #[serde(default)]
    pub slivers: Vec<u32>,
    /// Faces of the output where the input has no surface, in increasing order, numbered from 0; empty for a mesh that was
    /// only measured.
    #[serde(default)]
    pub bridges: Vec<u32>,
    /// The smallest angle of the output in degrees, excluding those that the input forces, where sharp edges and boundaries
    /// meet or a spike ends; `None` for a mesh that was only measured, or if all angles are forced.
    #[serde(default)]
    pub unforced_theta_min: Option<f64>,
    /// Distances between output and input, in percent of the diagonal of the input's bounding box.
    pub distance: Option<Distance>,
    /// The deviation of the output from the repaired input, and its bound; `None` if no bound was requested.
    pub deviation: Option<Deviation>,
    /// How the output was sampled.
    pub sampling: Option<Sampling>,
    /// The attributes that were carried over or lost; `None` if they were not requested.
    pub attributes: Option<AttributesKept>,
    /// Notes, times, memory and threads.
    #[serde(flatten)]
    pub run: RunSummary,
}

/// A mesh and its figures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// The name of its file; empty for a mesh without a file.
    pub file: String,
    /// Counts, restricted to the vertices that triangles use.
    pub topology: Topology,
    /// `None` without triangles.
    pub shape: Option<Shape>,
}

/// Self-intersecting faces: those that cross or touch another face to which they are not joined.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Crossings {
    /// The faces of the output, in increasing order, numbered from 0.
    pub faces: Vec<u32>,
    /// Those of `faces` that have no self-intersection of the repaired input within their length: the output's own.
    #[serde(default)]
    pub new: Vec<u32>,
    /// Their number in the repaired input; `None` if the output has none, and for a mesh that was only measured.
    pub repaired: Option<usize>,
}

/// How a result was sampled.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sampling {
    /// Target number of vertices.
    pub wanted: usize,
    /// Kernel width σp, in the units of the input.
    pub sigma_p: f64,
    /// The spacing of this number of points on the input's area at hexagonal packing, in the units of the input.
    pub spacing: f64,
    /// The smallest and the largest target spacing; both equal `spacing` if there is no grading.
    pub spacing_range: [f64; 2],
    /// Number of curves of sharp edges, from corner to corner, that were kept.
    pub sharp_curves: usize,
    /// Number of smooth patches that were too narrow and were joined with a neighbour, without the sharp edges between them.
    #[serde(default)]
    pub left_out_patches: usize,
    /// Approximate upper bound of the movement of the surface caused by that, in the units of the input.
    #[serde(default)]
    pub left_out_deviation: f64,
    /// Number of curves of sharp edges, from corner to corner, that were smoothed over because the patches beside them did
    /// not fit together.
    #[serde(default)]
    pub smoothed_curves: usize,
    /// Number of holes that were too small for the edges and were closed.
    #[serde(default)]
    pub closed_holes: usize,
    /// Whether no sharp edges were kept because there were too many.
    #[serde(default)]
    pub blunted: bool,
    /// Number of smooth patches that were tessellated from the input because their stars were inconsistent.
    pub tessellated_patches: usize,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// The attributes, such as colours, that were carried over or lost.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct AttributesKept {
    /// Names of the attributes that the output has.
    pub carried: Vec<String>,
    /// Attributes of the input that the output lacks, and why.
    pub lost: Vec<Lost>,
}

impl From<&Carried> for AttributesKept {
    fn from(carried: &Carried) -> AttributesKept {
        AttributesKept { carried: carried.attributes.names(), lost: carried.lost.clone() }
    }
}

impl Measured {
    /// Measures a mesh.
    pub fn of(mesh: &Mesh) -> Measured {
        let topology = topology(mesh.positions.len(), &mesh.triangles);
        Measured { file: String::new(), topology, shape: shape(mesh) }
    }
}

impl Crossings {
    /// The self-intersections of a result and of its input.
    pub fn of(remeshed: &Remeshed) -> Crossings {
        Crossings {
            faces: remeshed.self_intersections.clone(),
            new: remeshed.new_self_intersections.clone(),
            repaired: remeshed.self_intersections_of_input,
        }
    }
}

impl Report {
    /// Returns the same report without time, memory and threads, so that the same run gives the same report.
    #[must_use]
    pub fn without_run(&self) -> Report {
        Report { run: RunSummary::of_notes(self.run.notes.clone()), ..self.clone() }
    }

    /// Returns the report on a remeshing of `input` with `seed`. The caller adds file names by [`Report::add_files`], and
    /// stages, memory and threads by [`RunSummary::measure`].
    pub fn of_remesh(remeshed: &Remeshed, input: &Mesh, seed: u64) -> Report {
        let &Remeshed { sigma_p, spacing, spacing_range, wanted, sharp_curves, tessellated_patches, .. } = remeshed;
        Report {
            verified: Some(remeshed.verified()),
            input: Some(Measured { file: String::new(), topology: remeshed.input, shape: shape(input) }),
            repairs: Some(remeshed.repairs),
            repaired: Some(remeshed.repaired),
            crossings: Crossings::of(remeshed),
            slivers: remeshed.slivers.clone(),
            bridges: remeshed.bridges.clone(),
            unforced_theta_min: remeshed.unforced_theta_min,
            distance: distance(&remeshed.mesh, &outside(input, &remeshed.repairs), REPORT_SAMPLES, seed),
            deviation: remeshed.deviation,
            sampling: Some(Sampling {
                wanted,
                sigma_p,
                spacing,
                spacing_range,
                sharp_curves,
                left_out_patches: remeshed.left_out.patches,
                left_out_deviation: remeshed.left_out.deviation,
                smoothed_curves: remeshed.smoothed_curves,
                closed_holes: remeshed.pinholes.count,
                blunted: remeshed.blunted,
                tessellated_patches,
                seed,
            }),
            run: RunSummary::of_notes(remeshed.notes.clone()),
            ..Report::of_output(Measured {
                file: String::new(),
                topology: remeshed.output,
                shape: shape(&remeshed.mesh),
            })
        }
    }

    /// Returns the report on an existing mesh and on its distance to another one.
    pub fn of_mesh(mesh: &Mesh, against: Option<&Mesh>) -> Report {
        Report {
            input: against.map(Measured::of),
            crossings: Crossings { faces: self_intersections(mesh), ..Crossings::default() },
            distance: against.and_then(|input| distance(mesh, input, REPORT_SAMPLES, 0)),
            ..Report::of_output(Measured::of(mesh))
        }
    }

    /// Returns the report on a mesh that was made piece by piece with a target number of vertices, and on its attributes.
    pub fn of_pieces(mesh: &Mesh, carried: &Carried, wanted: Option<usize>) -> Report {
        let mut report = Report { attributes: Some(carried.into()), ..Report::of_mesh(mesh, None) };
        let is_sliver = |t: &u32| smallest_angle(mesh.corners(*t as usize)) < SLIVER;
        report.slivers = (0..mesh.triangles.len() as u32).filter(is_sliver).collect();
        let made = mesh.positions.len();
        let missed = wanted.filter(|&wanted| wanted != made);
        report.run.notes.extend(missed.map(|wanted| format!("{made} vertices instead of {wanted}")));
        let open = counted(report.output.topology.boundary_loops, "boundary loop", "boundary loops");
        let is_open = report.output.topology.boundary_loops > 0;
        report.run.notes.extend(is_open.then(|| format!("{open}: boundaries follow the samples as they were drawn")));
        report.run.notes.push("made piece by piece".into());
        report
    }

    /// Returns the reasons why a mesh that was only measured is not a sound oriented manifold, one phrase each.
    pub fn faults(&self) -> Vec<String> {
        let slivers = [(self.slivers.len(), "face with an angle below 1 degree", "faces with an angle below 1 degree")];
        let empty = (self.output.topology.faces == 0).then(|| "no triangles".to_string());
        let faults = topology_faults(&self.output.topology, self.crossings.faces.len());
        empty.into_iter().chain(faults).chain(counts(&slivers)).collect()
    }

    /// Adapts the report to points from which its input mesh was reconstructed: their distance to the output replaces that
    /// of `input`.
    #[must_use]
    pub fn of_points(self, coverage: Coverage, input: &Mesh) -> Report {
        let unit = 100.0 / input.diagonal();
        let distance = self.distance.map(|d| d.with_way_back(unit * coverage.rms, unit * coverage.largest));
        let report = Report { coverage: Some(coverage), distance, ..self };
        Report { verified: report.verified.map(|_| report.shortcomings().is_empty()), ..report }
    }

    fn of_output(output: Measured) -> Report {
        Report {
            schema: SCHEMA.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            verified: None,
            input: None,
            cloud: None,
            coverage: None,
            repairs: None,
            repaired: None,
            output,
            crossings: Crossings::default(),
            slivers: Vec::new(),
            bridges: Vec::new(),
            unforced_theta_min: None,
            distance: None,
            deviation: None,
            sampling: None,
            attributes: None,
            run: RunSummary::of_notes(Vec::new()),
        }
    }

    /// Adds the file names of input and output.
    pub fn add_files(&mut self, input: &str, output: &str) {
        self.input.iter_mut().for_each(|mesh| mesh.file = input.into());
        self.output.file = output.into();
    }

    /// Returns the reasons why the output is not what was asked for, one phrase each; empty for a verified result and for a
    /// mesh that was only measured.
    pub fn shortcomings(&self) -> Vec<String> {
        let Report { output, repaired, crossings, slivers, bridges, deviation, coverage, .. } = self;
        let against = |wanted| {
            let [crossing, slivers, bridges] = [&crossings.new, slivers, bridges].map(Vec::len);
            shortcomings(&output.topology, wanted, crossing, slivers, bridges, deviation.as_ref(), coverage.as_ref())
        };
        repaired.as_ref().map_or_else(Vec::new, against)
    }

    /// Returns the report as indented JSON that ends with a line break.
    pub fn to_json(&self) -> String {
        to_json(self)
    }
}

/// Returns one report as JSON, or several as a list.
pub fn all_to_json(reports: &[impl Borrow<Report> + Serialize]) -> String {
    match reports {
        [report] => report.borrow().to_json(),
        all => to_json(&all),
    }
}

/// Returns the table of each report, separated by empty lines. Consecutive reports of the same run state its time and memory
/// once.
pub fn all_to_text(reports: &[Report]) -> String {
    let run = |i: usize| reports.get(i).map(|report| &report.run.stages);
    let tables = reports.iter().enumerate().map(|(i, report)| report.text(run(i) != run(i + 1)));
    tables.collect::<Vec<_>>().join("\n")
}

/// Returns the surface that a result should be close to: the input without the faces between cells that repairs removed.
pub(super) fn outside<'a>(input: &'a Mesh, repairs: &Repairs) -> Cow<'a, Mesh> {
    match repairs.faces_between_cells {
        0 => Cow::Borrowed(input),
        _ => Cow::Owned(without_faces_between_cells(input)),
    }
}

/// Describes how a cloud's noise was handled automatically, and the alternatives; `None` without noise.
pub fn noise(cloud: &CloudSummary) -> Option<String> {
    let done = match cloud.flattened_neighbors {
        0 if cloud.smoothed_by_itself > 0.0 => {
            format!("smoothed with a support radius of {} spacings", cloud.smoothed_by_itself)
        }
        0 => return None,
        n => format!("moved onto planes through the {n} nearest points"),
    };
    Some(format!(
        "the points are noisy and were {done}; a radius of 1.5 smooths less, 4 smooths more, 0 does not smooth"
    ))
}

/// Explains that points without triangles were recognised as terrain, and the alternatives; `None` if they were not.
pub fn terrain(cloud: &CloudSummary) -> Option<String> {
    (cloud.plan_cell > 0.0).then(|| {
        format!(
            "the points look like terrain, and a surface in space would leave many of them out: only the view from above is \
             used, the highest point of each cell {:.4e} wide; with terrain off, they are joined in space",
            cloud.plan_cell
        )
    })
}

/// Describes which points of a cloud are not on the result, and why; `None` if all are.
pub fn left_out(cloud: &CloudSummary, coverage: &Coverage) -> Option<String> {
    let shreds = counted(cloud.shreds, "shred", "shreds");
    let shreds = format!("on {shreds} too small for a surface and not connected to the rest");
    let below = format!("below others in cells of {:.4e}", cloud.plan_cell);
    let far = format!("farther than {:.4e} from the result", coverage.within);
    let parts = [
        (cloud.outliers, "not among the neighbours of any other point (outliers)"),
        (cloud.in_shreds, &shreds),
        (cloud.below, &below),
        (cloud.unused, "not used by the first mesh, since neighbours do not agree on a surface there"),
        (coverage.missed, &far),
    ];
    let parts = parts.iter().filter(|p| p.0 > 0).map(|&(n, what)| format!("{} {what}", counted(n, "is", "are")));
    let parts: Vec<String> = parts.collect();
    (!parts.is_empty()).then(|| format!("of {} points, {}", cloud.points, parts.join("; ")))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::mesh::provenance::Origins;
    use crate::pipeline::{Edges, Pinholes};
    use crate::surface::narrow_patches::LeftOut;
    use crate::testing::tetrahedron;
    use glam::DVec3;
    use std::time::Duration;

    /// A report on a remeshing whose result lacks a face and has a flipped one.
    pub(in crate::report) fn failed() -> Report {
        let input = tetrahedron();
        let mut mesh = input.clone();
        mesh.triangles.pop();
        mesh.triangles[0].swap(0, 1);
        let whole = topology(4, &input.triangles);
        let remeshed = Remeshed {
            output: topology(4, &mesh.triangles),
            mesh,
            origins: Origins::default(),
            input: whole,
            repaired: whole,
            repairs: Repairs { welded_vertices: 2, flipped_triangles: 1, ..Repairs::default() },
            sigma_p: 0.123_456,
            spacing: 0.5,
            spacing_range: [0.5; 2],
            wanted: 4,
            deviation: Some(Deviation { allowed: 1.0, reached: 0.5, place: [0.0; 3] }),
            sharp_curves: 0,
            tessellated_patches: 0,
            self_intersections: vec![],
            new_self_intersections: vec![],
            self_intersections_of_input: None,
            slivers: vec![],
            bridges: vec![],
            unforced_theta_min: None,
            left_out: LeftOut::default(),
            smoothed_curves: 0,
            pinholes: Pinholes::default(),
            blunted: false,
            is_rough: false,
            lost: None,
            edges: Edges::default(),
            kept: None,
            notes: vec!["One face is missing.".into()],
        };
        let lost = vec![Lost { name: "h".into(), cause: "PLY has lost it".into() }];
        let attributes = Some(AttributesKept { carried: vec!["color".into(), "normal".into()], lost });
        let mut report = Report { attributes, ..Report::of_remesh(&remeshed, &input, 7) };
        report.add_files("in.obj", "out.ply");
        report
    }

    /// The same report with the resources of a run that had one stage.
    pub(in crate::report) fn failed_run(stage: &'static str, milliseconds: u64, bytes: Option<u64>) -> Report {
        let mut report = failed();
        report.run.measure(&[(stage, Duration::from_millis(milliseconds))], bytes, 2);
        report
    }

    #[test]
    fn json_can_be_read_back() {
        let report = failed_run("read", 125, Some(1 << 20));
        let back: Report = serde_json::from_str(&report.to_json()).unwrap();
        assert_eq!((&back.output.topology, &back.repairs), (&report.output.topology, &report.repairs));
        assert_eq!((back.run.stages.len(), back.run), (1, report.run));
    }

    #[test]
    fn every_member_is_there_and_what_is_not_known_is_null() {
        let mesh = tetrahedron();
        let json = Report::of_mesh(&mesh, None).to_json();
        let value: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(value["schema"], SCHEMA);
        assert_eq!(value["output"]["topology"]["euler"], 2);
        assert_eq!(value["output"]["shape"]["valence"]["3"], 4);
        for absent in ["verified", "input", "repairs", "repaired", "distance", "sampling", "attributes"] {
            assert!(value.as_object().unwrap().contains_key(absent) && value[absent].is_null(), "{absent}");
        }
    }

    #[test]
    fn the_documentation_names_every_member() {
        let documentation = include_str!("../../docs/report.md");
        let value: serde_json::Value = serde_json::from_str(&failed_run("x", 0, None).to_json()).unwrap();
        let mut todo = vec![&value];
        while let Some(value) = todo.pop() {
            for (name, member) in value.as_object().into_iter().flatten() {
                let counted = name.parse::<u32>().is_ok();
                assert!(counted || documentation.contains(&format!("`{name}`")), "{name} is not in docs/report.md");
                todo.push(member);
            }
            todo.extend(value.as_array().into_iter().flatten());
        }
    }

    #[test]
    fn shortcomings_say_what_is_wrong() {
        let report = failed();
        assert_eq!(report.verified, Some(false));
        let said = report.shortcomings();
        assert_eq!(
            said,
            [
                "2 edges between faces of opposite orientation",
                "the Euler characteristic is 1 instead of 2",
                "the number of boundary loops is 1 instead of 0"
            ]
        );
    }

    /// Two tetrahedra, one a little higher than the other.
    pub(in crate::report) fn crossing() -> Mesh {
        let mut mesh = tetrahedron();
        mesh.positions.extend(tetrahedron().positions.iter().map(|&p| p + DVec3::new(0.1, 0.1, 0.2)));
        mesh.triangles.extend(tetrahedron().triangles.iter().map(|t| t.map(|v| v + 4)));
        mesh
    }

    #[test]
    fn self_intersections_are_listed() {
        let mesh = crossing();
        let report = Report::of_mesh(&mesh, None);
        assert_eq!(report.crossings, Crossings { faces: vec![2, 4, 5, 7], ..Crossings::default() });
        assert_eq!(report.shortcomings(), [""; 0]);
    }

    #[test]
    fn a_cloud_that_is_missed_is_not_verified() {
        let coverage = |missed| Coverage { points: 100, missed, within: 0.5, rms: 1.0, largest: 2.0, place: [0.0; 3] };
        let mesh = tetrahedron();
        let report = Report::of_mesh(&mesh, Some(&mesh));
        let report = Report { verified: Some(true), repaired: Some(report.output.topology), ..report };
        let good = report.clone().of_points(coverage(5), &mesh);
        assert_eq!((good.verified, good.shortcomings().len()), (Some(true), 0));
        assert!((good.distance.unwrap().hausdorff - 200.0 / 3f64.sqrt()).abs() < 1e-9);
        let bad = report.of_points(coverage(6), &mesh);
        assert_eq!(bad.verified, Some(false));
        assert_eq!(bad.shortcomings(), ["6 of 100 points are farther than 5.0000e-1 from the result"]);
    }

    #[test]
    fn what_is_left_out_of_a_cloud_is_told_with_the_reason() {
        let cloud =
            CloudSummary { points: 100, outliers: 2, in_shreds: 7, shreds: 2, unused: 3, ..CloudSummary::default() };
        let coverage = Coverage { points: 98, missed: 0, within: 0.5, rms: 0.1, largest: 0.2, place: [0.0; 3] };
        let told = left_out(&cloud, &coverage).unwrap();
        assert!(
            told.starts_with("of 100 points, 2 are not among the neighbours")
                && told.contains("; 3 are not used by the first mesh"),
            "{told}"
        );
        assert!(told.contains("; 7 are on 2 shreds"), "{told}");
        assert_eq!(left_out(&CloudSummary::default(), &coverage), None);
        let noisy = CloudSummary { noisy: true, flattened_neighbors: 64, ..cloud };
        assert!(noise(&noisy).unwrap().contains("through the 64 nearest points; a radius of 1.5"));
        let smoothed = CloudSummary { flattened_neighbors: 0, smoothed_by_itself: 2.7, ..noisy };
        assert!(noise(&smoothed).unwrap().contains("smoothed with a support radius of 2.7 spacings"));
        assert_eq!(noise(&CloudSummary::default()), None);
    }

    #[test]
    fn a_mesh_against_itself_is_at_no_distance() {
        let mesh = tetrahedron();
        let report = Report::of_mesh(&mesh, Some(&mesh));
        assert!(report.distance.unwrap().hausdorff < 1e-9);
        assert_eq!(report.input, Some(report.output));
    }
}
