//! The meshes that a page shows, with the figures of their triangles and vertices.

use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::Edges;
use crate::quality::distance::vertex_distances;
use crate::quality::fields::{lengths_over, qualities, smallest_angles};
use crate::quality::shape::valences;
use crate::report::remeshing::{Measured, Report, outside};
use glam::DVec3;
use std::borrow::Cow;

/// A mesh that a page is about, with the report on it.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// The report, with its file names.
    pub report: &'a Report,
    /// The output of the report, or the mesh that was measured.
    pub mesh: &'a Mesh,
    /// The edges of a result; `None` for a mesh that was only measured.
    pub edges: Option<&'a Edges>,
}

/// A mesh with all that a page shows of it.
pub(super) struct Shown<'a> {
    /// Its role in the run: input or output; empty for a mesh that was only measured.
    pub role: &'static str,
    /// Its file name, with the folders that distinguish it from other meshes.
    pub name: String,
    pub measured: &'a Measured,
    /// The report whose output this mesh is.
    pub report: Option<&'a Report>,
    pub mesh: &'a Mesh,
    /// The smallest angle of each triangle, in degrees.
    pub angles: Vec<f64>,
    /// Q of each triangle.
    pub qualities: Vec<f64>,
    /// The valence of each interior vertex; `None` on the boundary.
    pub valences: Vec<Option<u32>>,
    /// The distance of each vertex to the other mesh, in percent of the diagonal of the input.
    pub distances: Option<Vec<f64>>,
    /// The ratio of the length of each side to the target length there, or to the mean length.
    pub lengths: Vec<f64>,
    /// Sharp edges of the input that the mesh has.
    pub sharp: Vec<[DVec3; 2]>,
    /// Sharp edges of this mesh that the output lacks.
    pub left_out: Vec<[DVec3; 2]>,
    /// Faces that keep the mesh from being verified, or that intersect others.
    pub marked: Vec<u32>,
}

impl Shown<'_> {
    /// Its role and its file name.
    pub(super) fn title(&self) -> String {
        match self.role {
            "" => self.name.clone(),
            role => format!("{role}: {}", self.name),
        }
    }
}

/// Returns the reference, if there is one, and all subjects. The distances of the reference are measured to the subject, if
/// there is exactly one.
pub(super) fn all<'a>(reference: Option<&'a Mesh>, subjects: &[Subject<'a>]) -> Vec<Shown<'a>> {
    let before = reference.zip(subjects.first().and_then(|s| s.report.input.as_ref()));
    let input = before.map(|(mesh, measured)| {
        let other = if let [subject] = subjects { Some(subject.mesh) } else { None };
        let is_run = subjects.iter().any(|s| s.report.verified.is_some());
        let left_out = subjects.iter().filter_map(|s| s.edges).flat_map(|edges| edges.left_out.clone()).collect();
        Shown {
            role: if is_run { "input" } else { "against" },
            distances: other.and_then(|other| distances(mesh, other, mesh)),
            left_out,
            ..plain(mesh, measured)
        }
    });
    let subjects = subjects.iter().map(|subject| of_subject(subject, reference));
    let mut shown: Vec<Shown> = input.into_iter().chain(subjects).collect();
    // Input and output of a run are already distinguished by their roles.
    let is_run = shown.iter().any(|s| s.role == "output");
    let files: Vec<&str> = shown.iter().map(|s| s.measured.file.as_str()).collect();
    for shown in &mut shown {
        let file = shown.measured.file.as_str();
        shown.name = short_name(file, if is_run { &[] } else { &files }).into();
    }
    shown
}

/// Returns the shortest end of a path that distinguishes it from the other `files`; at least its file name.
fn short_name<'a>(file: &'a str, files: &[&str]) -> &'a str {
    let mut ends = file.rmatch_indices(['/', '\\']).map(|(at, _)| &file[at + 1..]);
    let is_single = |end: &&str| files.iter().all(|&other| other == file || !is_end(other, end));
    ends.find(is_single).unwrap_or(file)
}

fn is_end(file: &str, end: &str) -> bool {
    file.strip_suffix(end).is_some_and(|before| before.is_empty() || before.ends_with(['/', '\\']))
}

fn of_subject<'a>(subject: &Subject<'a>, reference: Option<&Mesh>) -> Shown<'a> {
    let &Subject { report, mesh, edges } = subject;
    let surface = reference.map(|input| match &report.repairs {
        Some(repairs) => outside(input, repairs),
        None => Cow::Borrowed(input),
    });
    let at = |v: u32| mesh.positions[v as usize];
    let shown = plain(mesh, &report.output);
    let wanted = edges.map(|edges| &edges.wanted[..]).filter(|wanted| !wanted.is_empty());
    Shown {
        role: if report.verified.is_some() { "output" } else { "" },
        report: Some(report),
        distances: surface.zip(reference).and_then(|(surface, input)| distances(mesh, &surface, input)),
        lengths: wanted.map_or(shown.lengths, |wanted| lengths_over_wanted(mesh, wanted)),
        sharp: edges.iter().flat_map(|edges| &edges.sharp).map(|ends| ends.map(at)).collect(),
        marked: marked(report),
        ..shown
    }
}

/// A mesh by itself.
fn plain<'a>(mesh: &'a Mesh, measured: &'a Measured) -> Shown<'a> {
    let mean = measured.shape.as_ref().map(|shape| shape.edge_mean).filter(|mean| *mean > 0.0);
    Shown {
        role: "",
        name: String::new(),
        measured,
        report: None,
        mesh,
        angles: smallest_angles(mesh),
        qualities: qualities(mesh),
        valences: valences(mesh),
        distances: None,
        lengths: lengths_over(mesh, |_| mean),
        sharp: Vec::new(),
        left_out: Vec::new(),
        marked: Vec::new(),
    }
}

/// Returns side lengths relative to `wanted`, which has the target lengths at the last vertices.
fn lengths_over_wanted(mesh: &Mesh, wanted: &[f64]) -> Vec<f64> {
    let first = mesh.positions.len() - wanted.len();
    lengths_over(mesh, |v| (v as usize).checked_sub(first).map(|v| wanted[v]))
}

/// Returns the distances of the vertices of `mesh` to `other`, in percent of the diagonal of `input`.
fn distances(mesh: &Mesh, other: &Mesh, input: &Mesh) -> Option<Vec<f64>> {
    let unit = 100.0 / input.diagonal();
    let found = vertex_distances(mesh, other).filter(|_| unit.is_finite())?;
    Some(found.into_iter().map(|d| unit * d).collect())
}

fn marked(report: &Report) -> Vec<u32> {
    let mut faces = [&report.crossings.faces[..], &report.slivers, &report.bridges].concat();
    faces.sort_unstable();
    faces.dedup();
    faces
}

#[cfg(test)]
mod tests {
    use super::short_name;

    #[test]
    fn names_have_the_folders_that_tell_them_apart() {
        let files = ["/a/ours/horse.ply", "/a/theirs/horse.ply", "bunny.obj", "C:\\old\\cow.stl", "cow.stl"];
        let named: Vec<&str> = files.iter().map(|file| short_name(file, &files)).collect();
        assert_eq!(named, ["ours/horse.ply", "theirs/horse.ply", "bunny.obj", "old\\cow.stl", "cow.stl"]);
        assert_eq!(short_name("/a/b/horse.ply", &[]), "horse.ply");
        assert_eq!(short_name("horse.ply", &["horse.ply", "horse.ply"]), "horse.ply");
    }
}
