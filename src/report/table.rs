//! The report as a table for a terminal: one row per figure, the input next to the output.

use crate::report::remeshing::{Measured, Report};
use crate::report::rows::{CROSSINGS, Figures, crossings, distance_rows, facts, run_facts, shape_rows, topology_rows};
use std::fmt::Write;

/// Width of the row names, and of each column of figures.
const NAME: usize = 24;
const COLUMN: usize = 14;

/// Maximum number of characters in a line before its list continues on the next one.
const LINE: usize = 80;

impl Report {
    /// Returns the report as a table, with lines of at most 80 characters unless a name or note is longer.
    pub fn to_text(&self) -> String {
        self.text(true)
    }

    /// [`Self::to_text`] with or without time and memory, which several reports of the same run share.
    pub(super) fn text(&self, with_resources: bool) -> String {
        let mut out = String::new();
        let columns: Vec<&Measured> = self.input.iter().chain([&self.output]).collect();
        heading(&mut out, &columns);
        rows(&mut out, topology_rows(&columns));
        row(&mut out, CROSSINGS, crossings(self));
        rows(&mut out, shape_rows(&columns));
        if let Some(distance) = &self.distance {
            row(&mut out, "distance, % of diagonal", ["from output", "from input", "both"].map(String::from));
            rows(&mut out, distance_rows(distance));
        }
        remarks(&mut out, self, with_resources);
        out
    }
}

/// Writes a name and its figures, right-aligned.
fn row(out: &mut String, name: &str, figures: impl IntoIterator<Item = String>) {
    let mut line = format!("{name:NAME$}");
    for figure in figures {
        let _ = write!(line, " {figure:>COLUMN$}");
    }
    let _ = writeln!(out, "{}", line.trim_end());
}

fn rows(out: &mut String, rows: impl IntoIterator<Item = Figures>) {
    rows.into_iter().for_each(|(name, figures)| row(out, name, figures));
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

/// Writes everything that is not a figure of a mesh: facts, notes, times, and finally the verdict.
fn remarks(out: &mut String, report: &Report, with_resources: bool) {
    facts(report).into_iter().for_each(|(name, phrases)| list(out, name, &phrases));
    report.run.notes.iter().for_each(|note| list(out, "note", std::slice::from_ref(note)));
    if with_resources {
        for (name, phrases) in run_facts(&report.run) {
            list(out, name, &phrases);
        }
    }
    match report.verified {
        Some(true) => list(out, "verified", &["an oriented manifold of the input's topology".into()]),
        Some(false) => list(out, "NOT VERIFIED", &report.shortcomings()),
        None => {}
    }
}

/// Writes a name and phrases separated by commas, with line breaks between phrases where a line gets full; nothing without
/// phrases.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::remeshing::all_to_text;
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
        has(&text, "repairs                  2 vertices welded, 1 triangle turned over");
        has(&text, "attributes               color, normal");
        has(&text, "attributes, lost         h: PLY has lost it");
        has(&text, "note                     One face is missing.");
        has(&text, "seconds                  0.250 with 2 threads, read 0.250");
        has(&text, "peak memory              150 MB");
        assert!(text.contains("NOT VERIFIED             2 edges between faces of opposite orientation,\n"));
        assert!(text.lines().all(|line| line.chars().count() <= LINE), "{text}");
    }

    #[test]
    fn reports_of_one_run_tell_its_time_once_and_those_of_others_theirs() {
        let of_run = |milliseconds| failed_run("measure", milliseconds, Some(1_000_000));
        let text = all_to_text(&[of_run(250), of_run(250), of_run(500)]);
        let lines = |name: &str| text.lines().filter(|line| line.starts_with(name)).count();
        assert_eq!((lines("vertices"), lines("seconds"), lines("peak memory")), (3, 2, 2));
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
    fn self_intersecting_faces_are_named() {
        let text = Report::of_mesh(&crossing(), None).to_text();
        has(&text, "self-intersections       2, 4, 5, 7");
    }
}
