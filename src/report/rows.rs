//! The content of a report as names and texts: the same words for the table in the terminal and for the page.

use crate::base::count::{counted, counts};
use crate::base::math;
use crate::mesh::topology::Topology;
use crate::pipeline::{CloudSummary, Coverage};
use crate::prepare::repairs::Repairs;
use crate::quality::distance::Distance;
use crate::quality::shape::Shape;
use crate::report::remeshing::{Measured, Report};
use crate::report::run::RunSummary;

/// The name of a row and the function that formats its figure.
type Row<T> = (&'static str, fn(&T) -> String);

/// The name of a row and its figure for each mesh.
pub(super) type Figures = (&'static str, Vec<String>);

/// The name of a subject, and phrases about it.
pub(super) type Fact = (&'static str, Vec<String>);

/// Placeholder for a missing figure.
const NOTHING: &str = "-";

/// The counts of each mesh.
pub(super) fn topology_rows(columns: &[&Measured]) -> Vec<Figures> {
    let rows: [Row<Topology>; 7] = [
        ("vertices", |t| t.vertices.to_string()),
        ("faces", |t| t.faces.to_string()),
        ("Euler characteristic", |t| t.euler.to_string()),
        ("components", |t| t.components.to_string()),
        ("boundary loops", |t| t.boundary_loops.to_string()),
        ("manifold", |t| yes_or_no(t.is_manifold())),
        ("oriented", |t| yes_or_no(t.is_oriented())),
    ];
    rows.map(|(name, figure)| (name, columns.iter().map(|m| figure(&m.topology)).collect())).into()
}

/// The numbers of self-intersecting faces; those of the input are counted after its repairs, and only if the output has
/// some.
pub(super) fn crossings(report: &Report) -> Vec<String> {
    let output = report.crossings.faces.len().to_string();
    let repaired = |_| report.crossings.repaired.map_or(NOTHING.into(), |n| n.to_string());
    report.input.iter().map(repaired).chain([output]).collect()
}

/// The name of the row of [`crossings`].
pub(super) const CROSSINGS: &str = "self-intersecting faces";

/// The figures of each mesh's triangles.
pub(super) fn shape_rows(columns: &[&Measured]) -> Vec<Figures> {
    let rows: [Row<Shape>; 16] = [
        ("θ min", |s| degrees(s.theta_min)),
        ("θ min, mean", |s| degrees(s.theta_min_mean)),
        ("θ max", |s| degrees(s.theta_max)),
        ("Q min", |s| format!("{:.4}", s.q_min)),
        ("Q mean", |s| format!("{:.4}", s.q_mean)),
        ("with an angle < 30°", |s| percent(s.percent_below_30)),
        ("with an angle > 90°", |s| percent(s.percent_above_90)),
        ("edge length, mean", |s| significant(s.edge_mean)),
        ("edge length, min", |s| significant(s.edge_min)),
        ("edge length, max", |s| significant(s.edge_max)),
        ("edge length, variation", |s| percent(100.0 * s.edge_cv)),
        ("valence 4 or less", |s| valence_share(s, 0..=4)),
        ("valence 5", |s| valence_share(s, 5..=5)),
        ("valence 6", |s| valence_share(s, 6..=6)),
        ("valence 7", |s| valence_share(s, 7..=7)),
        ("valence 8 or more", |s| valence_share(s, 8..=u32::MAX)),
    ];
    let told = |m: &&Measured, figure: fn(&Shape) -> String| m.shape.as_ref().map_or(NOTHING.into(), figure);
    rows.map(|(name, figure)| (name, columns.iter().map(|m| told(m, figure)).collect())).into()
}

/// The distances from the output, from the input, and in both directions.
pub(super) fn distance_rows(d: &Distance) -> [Figures; 2] {
    [
        ("RMS", [d.rms_out_to_in, d.rms_in_to_out, d.rms].map(hundredths).into()),
        ("Hausdorff", [d.hausdorff_out_to_in, d.hausdorff_in_to_out, d.hausdorff].map(hundredths).into()),
    ]
}

/// Everything that is not a figure of a mesh: sampling, points, repairs, attributes. Facts without phrases are omitted.
pub(super) fn facts(report: &Report) -> Vec<Fact> {
    let attributes = report.attributes.as_ref();
    let lost = attributes.map(|kept| kept.lost.iter().map(|l| format!("{}: {}", l.name, l.cause)).collect());
    let facts = [
        ("distance, any point", bounded_error(report)),
        ("θ min, unforced", unforced_angle(report)),
        ("sampling", sampling(report)),
        ("sharp edges", sharp_edges(report)),
        ("points", report.cloud.as_ref().map(points_used).unwrap_or_default()),
        ("on the output", report.coverage.as_ref().map(covered).unwrap_or_default()),
        ("repairs", report.repairs.as_ref().map(repairs_made).unwrap_or_default()),
        ("self-intersections", self_intersections(&report.crossings.faces)),
        ("attributes", attributes.map(|kept| kept.carried.clone()).unwrap_or_default()),
        ("attributes, lost", lost.unwrap_or_default()),
    ];
    facts.into_iter().filter(|(_, phrases)| !phrases.is_empty()).collect()
}

/// The time and memory that a run took.
pub(super) fn run_facts(run: &RunSummary) -> Vec<Fact> {
    let memory = run.peak_memory_bytes.map(|bytes| format!("{:.0} MB", bytes as f64 / 1e6));
    let facts = [("seconds", seconds(run)), ("peak memory", memory.into_iter().collect())];
    facts.into_iter().filter(|(_, phrases)| !phrases.is_empty()).collect()
}

/// The total time and that of each stage.
fn seconds(run: &RunSummary) -> Vec<String> {
    if run.stages.is_empty() {
        return Vec::new();
    }
    let total: f64 = run.stages.iter().map(|lap| lap.seconds).sum();
    let threads = if run.threads == 1 { "1 thread".into() } else { format!("{} threads", run.threads) };
    let stages = run.stages.iter().map(|lap| format!("{} {:.3}", lap.name, lap.seconds));
    [format!("{total:.3} with {threads}")].into_iter().chain(stages).collect()
}

fn bounded_error(report: &Report) -> Vec<String> {
    let Some(d) = &report.deviation else { return Vec::new() };
    vec![format!("{} at most", significant(d.reached)), format!("{} allowed", significant(d.allowed))]
}

fn sampling(report: &Report) -> Vec<String> {
    let Some(s) = &report.sampling else { return Vec::new() };
    let (sigma, spacing) = (significant(s.sigma_p), significant(s.spacing));
    let [smallest, largest] = s.spacing_range;
    let is_even = smallest == largest;
    let range =
        if is_even { String::new() } else { format!(" ({} to {})", significant(smallest), significant(largest)) };
    vec![
        counted(s.wanted, "vertex wanted", "vertices wanted"),
        format!("σp {sigma}"),
        format!("spacing {spacing}{range}"),
        format!("seed {}", s.seed),
    ]
}

/// The smallest angle away from corners that the input forces, if it differs from the smallest of all.
fn unforced_angle(report: &Report) -> Vec<String> {
    let all = report.output.shape.as_ref().map(|shape| degrees(shape.theta_min));
    report.unforced_theta_min.map(degrees).filter(|angle| Some(angle) != all.as_ref()).into_iter().collect()
}

/// The numbers of sharp edges that were kept and left out, if there are any.
fn sharp_edges(report: &Report) -> Vec<String> {
    let Some(s) = &report.sampling else { return Vec::new() };
    let curves = counted(s.sharp_curves, "curve kept", "curves kept");
    let left_out = counted(s.left_out_patches, "narrow patch joined with another", "narrow patches joined with others");
    let parts = [
        (s.sharp_curves > 0, curves),
        (s.left_out_patches > 0, left_out),
        (s.smoothed_curves > 0, counted(s.smoothed_curves, "curve smoothed over", "curves smoothed over")),
        (s.blunted, "none kept: too close together".into()),
    ];
    parts.into_iter().filter(|(is_so, _)| *is_so).map(|(_, phrase)| phrase).collect()
}

/// The numbers of a cloud's points by what was done with them.
fn points_used(cloud: &CloudSummary) -> Vec<String> {
    let &CloudSummary {
        points,
        duplicates,
        outliers,
        in_shreds,
        unused,
        estimated_normals,
        turned_normals,
        below,
        on_sharp_edges,
        ..
    } = cloud;
    let others = [
        (duplicates, "duplicate", "duplicates"),
        (outliers, "outlier", "outliers"),
        (in_shreds, "on shreds too small for a surface", "on shreds too small for a surface"),
        (below, "below another terrain point", "below other terrain points"),
        (unused, "other not used by any triangle", "others not used by any triangle"),
        (estimated_normals, "normal estimated", "normals estimated"),
        (turned_normals, "normal turned over", "normals turned over"),
        (on_sharp_edges, "vertex added on sharp edges", "vertices added on sharp edges"),
    ];
    [counted(points, "point", "points")].into_iter().chain(counts(&others)).collect()
}

/// The number of a cloud's points that are close to the output.
fn covered(Coverage { points, missed, within, .. }: &Coverage) -> Vec<String> {
    vec![format!("{} of {points} points within {}", points - missed, significant(*within))]
}

fn repairs_made(repairs: &Repairs) -> Vec<String> {
    let &Repairs {
        welded_vertices,
        seam_vertices,
        unused_vertices,
        degenerate_triangles,
        faces_between_cells,
        needles,
        duplicate_triangles,
        flipped_triangles,
        cut_edges,
        unorientable_edges,
        split_vertices,
    } = repairs;
    let made = [
        (welded_vertices, "vertex welded", "vertices welded"),
        (seam_vertices, "of them across seams", "of them across seams"),
        (unused_vertices, "unused vertex dropped", "unused vertices dropped"),
        (degenerate_triangles, "degenerate triangle dropped", "degenerate triangles dropped"),
        (faces_between_cells, "face between cells dropped", "faces between cells dropped"),
        (needles, "needle or cap removed", "needles and caps removed"),
        (duplicate_triangles, "duplicate triangle dropped", "duplicate triangles dropped"),
        (flipped_triangles, "triangle turned over", "triangles turned over"),
        (cut_edges, "edge with more than two faces taken apart", "edges with more than two faces taken apart"),
        (unorientable_edges, "edge cut where no orientation is possible", "edges cut where no orientation is possible"),
        (split_vertices, "vertex split", "vertices split"),
    ];
    counts(&made)
}

/// Maximum number of self-intersecting faces that are listed; the JSON report lists all.
const FACES_NAMED: usize = 20;

/// The numbers of the first faces, and how many more there are.
fn self_intersections(faces: &[u32]) -> Vec<String> {
    let more = faces.len().saturating_sub(FACES_NAMED);
    let named = faces.iter().take(FACES_NAMED).map(u32::to_string);
    named.chain((more > 0).then(|| format!("and {more} more"))).collect()
}

fn yes_or_no(yes: bool) -> String {
    if yes { "yes" } else { "no" }.into()
}

pub(super) fn degrees(angle: f64) -> String {
    format!("{angle:.2}°")
}

pub(super) fn percent(share: f64) -> String {
    format!("{share:.2} %")
}

/// A percentage with four decimals.
pub(super) fn hundredths(share: f64) -> String {
    format!("{share:.4}")
}

/// Formats a number with four significant digits.
pub(super) fn significant(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return x.to_string();
    }
    let magnitude = math::log10(x.abs()).floor() as i32;
    if (-5..6).contains(&magnitude) { format!("{x:.*}", (3 - magnitude).max(0) as usize) } else { format!("{x:.3e}") }
}

/// The percentage of interior vertices whose valence is in a range.
fn valence_share(shape: &Shape, range: std::ops::RangeInclusive<u32>) -> String {
    let all: usize = shape.valence.values().sum();
    let within: usize = shape.valence.range(range).map(|(_, count)| count).sum();
    if all > 0 { percent(100.0 * within as f64 / all as f64) } else { NOTHING.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_self_intersecting_faces_the_first_are_named() {
        let faces: Vec<u32> = (0..123).collect();
        let named = self_intersections(&faces);
        assert_eq!((named.len(), named[19].as_str(), named[20].as_str()), (21, "19", "and 103 more"));
        assert_eq!(self_intersections(&faces[..20]).len(), 20);
    }

    #[test]
    fn four_digits_at_any_magnitude() {
        let cases = [(0.0, "0"), (1.0, "1.000"), (123.456, "123.5"), (0.001_234_56, "0.001235"), (1.5e-9, "1.500e-9")];
        for (x, expected) in cases {
            assert_eq!(significant(x), expected);
        }
        assert_eq!(significant(54_321.0), "54321");
    }
}
