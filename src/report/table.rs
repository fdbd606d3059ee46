//! The report as a table for a terminal: a row for each figure, the input beside the output.

use crate::base::math;
use crate::mesh::topology::Topology;
use crate::pipeline::{CloudSummary, Coverage};
use crate::prepare::repair::Repairs;
use crate::quality::shape::Shape;
use crate::report::remeshing::{Measured, Report};
use crate::report::run::RunSummary;
use std::fmt::Write;

/// Width of the names of the rows, and of each column of figures.
const NAME: usize = 24;
const COLUMN: usize = 14;

/// Characters of a line before its list goes on in the next one.
const LINE: usize = 80;

/// Faces that cross and that the table names; the others are in the JSON report.
const FACES_NAMED: usize = 20;

/// The name of a row and how its figure is told.
type Row<T> = (&'static str, fn(&T) -> String);

impl Report {
    /// The report as a table for people, lines of at most 80 characters unless a name or note is longer.
    pub fn to_text(&self) -> String {
        let mut out = String::new();
        let columns: Vec<&Measured> = self.input.iter().chain([&self.output]).collect();
        heading(&mut out, &columns);
        topology_rows(&mut out, &columns.iter().map(|m| m.topology).collect::<Vec<_>>());
        crossing_row(&mut out, self);
        shape_rows(&mut out, &columns.iter().map(|m| m.shape.as_ref()).collect::<Vec<_>>());
        distance_rows(&mut out, self);
        remarks(&mut out, self);
        out
    }
}

/// A name and its figures, right-aligned.
fn row(out: &mut String, name: &str, figures: impl IntoIterator<Item = String>) {
    let mut line = format!("{name:NAME$}");
    for figure in figures {
        let _ = write!(line, " {figure:>COLUMN$}");
    }
    let _ = writeln!(out, "{}", line.trim_end());
}

fn heading(out: &mut String, columns: &[&Measured]) {
    match columns {
        [input, output] => {
            let _ = writeln!(out, "{} -> {}", input.file, output.file);
            row(out, "", ["input".into(), "output".into()]);
        }
        _ => columns.iter().for_each(|m| out.push_str(&format!("{}\n", m.file))),
    }
}

fn topology_rows(out: &mut String, columns: &[Topology]) {
    let rows: [Row<Topology>; 7] = [
        ("vertices", |t| t.vertices.to_string()),
        ("faces", |t| t.faces.to_string()),
        ("Euler characteristic", |t| t.euler.to_string()),
        ("components", |t| t.components.to_string()),
        ("boundary loops", |t| t.boundary_loops.to_string()),
        ("manifold", |t| yes_or_no(t.is_manifold())),
        ("oriented", |t| yes_or_no(t.is_oriented())),
    ];
    for (name, figure) in rows {
        row(out, name, columns.iter().map(figure));
    }
}

/// How many faces cross; those of the input are counted after its repairs, and only where the output has some.
fn crossing_row(out: &mut String, report: &Report) {
    let output = report.crossings.faces.len().to_string();
    let input = report.input.iter().map(|_| report.crossings.repaired.map_or("-".into(), |n| n.to_string()));
    row(out, "self-intersecting faces", input.chain([output]));
}

fn shape_rows(out: &mut String, columns: &[Option<&Shape>]) {
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
    for (name, figure) in rows {
        row(out, name, columns.iter().map(|shape| shape.map_or("-".into(), figure)));
    }
}

fn distance_rows(out: &mut String, report: &Report) {
    let Some(d) = &report.distance else { return };
    row(out, "distance, % of diagonal", ["from output".into(), "from input".into(), "both".into()]);
    row(out, "RMS", [d.rms_out_to_in, d.rms_in_to_out, d.rms].map(hundredths));
    row(out, "Hausdorff", [d.hausdorff_out_to_in, d.hausdorff_in_to_out, d.hausdorff].map(hundredths));
}

/// What is no figure of a mesh: the sampling, the repairs, notes, times, and the verdict last.
fn remarks(out: &mut String, report: &Report) {
    if let Some(d) = &report.deviation {
        let phrases = [format!("{} at most", significant(d.reached)), format!("{} asked for", significant(d.allowed))];
        list(out, "distance, any point", &phrases);
    }
    if let Some(s) = &report.sampling {
        let (sigma, spacing) = (significant(s.sigma_p), significant(s.spacing));
        let [smallest, largest] = s.spacing_range;
        let is_even = smallest == largest;
        let range =
            if is_even { String::new() } else { format!(" ({} to {})", significant(smallest), significant(largest)) };
        list(
            out,
            "sampling",
            &[
                format!("{} vertices wanted", s.wanted),
                format!("σp {sigma}"),
                format!("spacing {spacing}{range}"),
                format!("seed {}", s.seed),
            ],
        );
    }
    list(out, "points", &report.cloud.as_ref().map(points_used).unwrap_or_default());
    if let Some(Coverage { points, missed, within, .. }) = &report.coverage {
        let within = significant(*within);
        list(out, "on the output", &[format!("{} of {points} points within {within}", points - missed)]);
    }
    list(out, "repairs", &report.repairs.as_ref().map(repairs_made).unwrap_or_default());
    list(out, "self-intersections", &self_intersections(&report.crossings.faces));
    if let Some(kept) = &report.attributes {
        list(out, "attributes", &kept.carried);
        let lost: Vec<String> = kept.lost.iter().map(|l| format!("{}: {}", l.name, l.cause)).collect();
        list(out, "attributes, lost", &lost);
    }
    report.run.notes.iter().for_each(|note| list(out, "note", std::slice::from_ref(note)));
    list(out, "seconds", &seconds(&report.run));
    if let Some(bytes) = report.run.peak_memory_bytes {
        list(out, "memory, at most", &[format!("{:.0} MB", bytes as f64 / 1e6)]);
    }
    match report.verified {
        Some(true) => list(out, "verified", &["an oriented manifold of the input's topology".into()]),
        Some(false) => list(out, "NOT VERIFIED", &report.shortcomings()),
        None => {}
    }
}

/// What became of the points of a cloud.
fn points_used(cloud: &CloudSummary) -> Vec<String> {
    let &CloudSummary { points, duplicates, outliers, unused, estimated_normals, turned_normals, .. } = cloud;
    let others = [
        (duplicates, "at the place of another one"),
        (outliers, "outliers"),
        (unused, "others that no triangle uses"),
        (estimated_normals, "normals estimated"),
        (turned_normals, "normals turned over"),
    ];
    let others = others.into_iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}"));
    [format!("{points} points")].into_iter().chain(others).collect()
}

/// A name and phrases with commas between, broken between phrases where a line gets full; nothing without phrases.
fn list(out: &mut String, name: &str, phrases: &[String]) {
    let mut line = format!("{name:NAME$}");
    for (k, phrase) in phrases.iter().enumerate() {
        let comma = if k + 1 < phrases.len() { "," } else { "" };
        let length = line.chars().count();
        if length + phrase.chars().count() + 2 > LINE && length > NAME {
            let _ = writeln!(out, "{line}");
            line = " ".repeat(NAME);
        }
        let _ = write!(line, " {phrase}{comma}");
    }
    if !phrases.is_empty() {
        let _ = writeln!(out, "{line}");
    }
}

fn repairs_made(repairs: &Repairs) -> Vec<String> {
    let &Repairs {
        welded_vertices,
        seam_vertices,
        unused_vertices,
        degenerate_triangles,
        faces_between_cells,
        duplicate_triangles,
        flipped_triangles,
        cut_edges,
        unorientable_edges,
        split_vertices,
    } = repairs;
    let made = [
        (welded_vertices, "vertices welded"),
        (seam_vertices, "of them across seams"),
        (unused_vertices, "unused vertices dropped"),
        (degenerate_triangles, "degenerate triangles dropped"),
        (faces_between_cells, "faces between cells dropped"),
        (duplicate_triangles, "duplicate triangles dropped"),
        (flipped_triangles, "triangles turned over"),
        (cut_edges, "edges of more than two faces taken apart"),
        (unorientable_edges, "edges cut where no orientation is possible"),
        (split_vertices, "vertices split"),
    ];
    made.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect()
}

/// The numbers of the first faces, and how many more there are.
fn self_intersections(faces: &[u32]) -> Vec<String> {
    let more = faces.len().saturating_sub(FACES_NAMED);
    let named = faces.iter().take(FACES_NAMED).map(u32::to_string);
    named.chain((more > 0).then(|| format!("and {more} more"))).collect()
}

/// The total and each stage.
fn seconds(run: &RunSummary) -> Vec<String> {
    if run.stages.is_empty() {
        return Vec::new();
    }
    let total: f64 = run.stages.iter().map(|lap| lap.seconds).sum();
    let threads = if run.threads == 1 { "1 thread".into() } else { format!("{} threads", run.threads) };
    let stages = run.stages.iter().map(|lap| format!("{} {:.3}", lap.name, lap.seconds));
    [format!("{total:.3} with {threads}")].into_iter().chain(stages).collect()
}

fn yes_or_no(yes: bool) -> String {
    if yes { "yes" } else { "no" }.into()
}

fn degrees(angle: f64) -> String {
    format!("{angle:.2}°")
}

fn percent(share: f64) -> String {
    format!("{share:.2} %")
}

/// A share in percent, whose hundredths matter.
fn hundredths(share: f64) -> String {
    format!("{share:.4}")
}

/// Four significant digits.
pub(super) fn significant(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return x.to_string();
    }
    let magnitude = math::log10(x.abs()).floor() as i32;
    if (-5..6).contains(&magnitude) { format!("{x:.*}", (3 - magnitude).max(0) as usize) } else { format!("{x:.3e}") }
}

/// The share of interior vertices whose valence is in a range.
fn valence_share(shape: &Shape, range: std::ops::RangeInclusive<u32>) -> String {
    let all: usize = shape.valence.values().sum();
    let within: usize = shape.valence.range(range).map(|(_, count)| count).sum();
    if all > 0 { percent(100.0 * within as f64 / all as f64) } else { "-".into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::remeshing::tests::{crossing, failed_run};
    use crate::testing::tetrahedron;

    fn has(text: &str, line: &str) {
        assert!(text.lines().any(|l| l == line), "no line\n{line}\nin\n{text}");
    }

    #[test]
    fn input_and_output_stand_side_by_side() {
        let text = failed_run("read", 250, Some(150_000_000)).to_text();
        has(&text, "in.obj -> out.ply");
        has(&text, "                                  input         output");
        has(&text, "vertices                              4              4");
        has(&text, "faces                                 4              3");
        has(&text, "boundary loops                        0              1");
        has(&text, "self-intersecting faces               -              0");
        has(&text, "oriented                            yes             no");
        has(&text, "θ max                            90.00°         90.00°");
        has(&text, "valence 4 or less              100.00 %       100.00 %");
        has(&text, "sampling                 4 vertices wanted, σp 0.1235, spacing 0.5000, seed 7");
        has(&text, "repairs                  2 vertices welded, 1 triangles turned over");
        has(&text, "attributes               color, normal");
        has(&text, "attributes, lost         h: PLY has lost it");
        has(&text, "note                     One face is missing.");
        has(&text, "seconds                  0.250 with 2 threads, read 0.250");
        has(&text, "memory, at most          150 MB");
        assert!(text.contains("NOT VERIFIED             2 edges between faces of opposite orientation,\n"));
        assert!(text.lines().all(|line| line.chars().count() <= LINE), "{text}");
    }

    #[test]
    fn a_mesh_alone_has_one_column_and_no_verdict() {
        let mesh = tetrahedron();
        let text = Report::of_mesh(&mesh, None).to_text();
        has(&text, "Euler characteristic                  2");
        assert!(!text.contains("verified") && !text.contains("RMS") && !text.contains("seconds"));
        let mesh = Default::default();
        has(&Report::of_mesh(&mesh, None).to_text(), "Q mean                                -");
    }

    #[test]
    fn of_many_self_intersecting_faces_the_first_are_named() {
        let text = Report::of_mesh(&crossing(), None).to_text();
        has(&text, "self-intersections       2, 4, 5, 7");
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
