//! The textual parts of a page: the verdict, the four main figures, the notes and the tables.

use crate::pipeline::topology_faults;
use crate::quality::shape::Shape;
use crate::report::page::histogram::class;
use crate::report::page::html::escape;
use crate::report::page::places::Place;
use crate::report::page::shown::Shown;
use crate::report::remeshing::Report;
use crate::report::rows::{
    CROSSINGS, Figures, crossings, degrees, distance_rows, facts, hundredths, percent, run_facts, shape_rows,
    topology_rows,
};
use std::fmt::Write;

/// Returns the title: input and output of a run, or the meshes that were measured.
pub(super) fn title(shown: &[Shown]) -> String {
    match shown {
        [input, output] if output.role == "output" => format!("{} → {}", input.name, output.name),
        _ => {
            let subjects = shown.iter().filter(|s| s.report.is_some());
            let against = shown.iter().find(|s| s.report.is_none()).map(|s| format!(" against {}", s.name));
            subjects.map(|s| s.name.as_str()).collect::<Vec<_>>().join(", ") + &against.unwrap_or_default()
        }
    }
}

/// Returns the result of a remeshing in one line.
pub(super) fn lede(shown: &[Shown]) -> String {
    let [input, output] = shown else { return String::new() };
    let Some(report) = output.report else { return String::new() };
    let [before, after] = [input, output].map(|s| s.measured.topology.vertices);
    let wanted = report.sampling.map_or(String::new(), |s| format!(", {} wanted", s.wanted));
    let far = report
        .distance
        .map_or(String::new(), |d| format!(" · Hausdorff distance {} % of the diagonal", hundredths(d.hausdorff)));
    format!("<p class=\"lede\">{before} → {after} vertices{wanted}{far}</p>\n")
}

/// Returns whether the results are verified, and if not, why; for meshes that were only measured, whether they are sound.
pub(super) fn verdicts(shown: &[Shown], places: &[Place], are_links: bool) -> String {
    let places = if are_links { places } else { &[] };
    (0..).zip(shown).filter_map(|(mesh, s)| Some(verdict(mesh, &s.name, s.report?, places))).collect()
}

fn verdict(mesh: usize, name: &str, report: &Report, places: &[Place]) -> String {
    let wrong = if report.verified.is_some() { report.shortcomings() } else { faults(report) };
    let is_good = report.verified.unwrap_or(wrong.is_empty());
    let (head, good) = match (report.verified, is_good) {
        (Some(true), _) => ("Verified".into(), VERIFIED),
        (Some(false), _) => ("Not verified".into(), ""),
        (None, true) => (format!("{}: Sound", escape(name)), SOUND),
        (None, false) => (format!("{}: Not sound", escape(name)), ""),
    };
    let lines = if is_good { vec![good.into()] } else { wrong };
    let items: String = lines.iter().map(|line| format!("<li>{}</li>", escape(line))).collect();
    let faults = places.iter().enumerate().filter(|(_, p)| !is_good && p.mesh == mesh && p.is_fault());
    let links: String = faults.map(|(number, p)| format!(" <a {}>{}</a>", p.link(number), p.name)).collect();
    let links = if links.is_empty() { links } else { format!("<p class=\"at\">Look at{links}</p>") };
    let class = if is_good { "good" } else { "bad" };
    format!("<div class=\"verdict {class}\" role=\"status\"><h2>{head}</h2><ul>{items}</ul>{links}</div>\n")
}

const VERIFIED: &str =
    "An oriented manifold of the input’s topology, without self-intersections, slivers or bridges of its own.";
const SOUND: &str = "An oriented manifold without self-intersections.";

/// Returns the faults of a mesh that was only measured.
fn faults(report: &Report) -> Vec<String> {
    topology_faults(&report.output.topology, report.crossings.faces.len())
}

/// Returns the four most important figures in large type.
pub(super) fn figures(shown: &[Shown]) -> String {
    type Figure = (&'static str, fn(&Shape) -> String);
    let figures: [Figure; 4] = [
        ("smallest angle θ<sub>min</sub>", |s| degrees(s.theta_min)),
        ("lowest quality Q<sub>min</sub>", |s| format!("{:.3}", s.q_min)),
        ("mean quality Q<sub>ave</sub>", |s| format!("{:.3}", s.q_mean)),
        ("triangles with an angle &lt; 30°", |s| percent(s.percent_below_30)),
    ];
    let card = |(name, figure): Figure| {
        let told = |s: &Shown| s.measured.shape.as_ref().map_or("–".into(), figure);
        let inside: String = match shown {
            [input, output] if input.report.is_none() => {
                format!("<b>{}</b><small>{} {}</small>", told(output), input.role, told(input))
            }
            [one] => format!("<b>{}</b>", told(one)),
            all => all
                .iter()
                .enumerate()
                .map(|(n, s)| format!("<span class=\"one\"><i class=\"key {}\"></i>{}</span>", class(all, n), told(s)))
                .collect(),
        };
        format!("<div class=\"figure\"><h3>{name}</h3>{inside}</div>\n")
    };
    figures.map(card).concat()
}

/// Returns the names of the meshes with their colours in the charts.
pub(super) fn key(shown: &[Shown]) -> String {
    let item = |(n, s): (usize, &Shown)| {
        format!("<span><i class=\"key {}\"></i>{}</span> ", class(shown, n), escape(&s.title()))
    };
    shown.iter().enumerate().map(item).collect()
}

/// Returns the notes for the user, without duplicates.
pub(super) fn notes(shown: &[Shown]) -> String {
    let mut notes: Vec<&String> = Vec::new();
    for note in shown.iter().filter_map(|s| s.report).flat_map(|report| &report.run.notes) {
        if !notes.contains(&note) {
            notes.push(note);
        }
    }
    if notes.is_empty() {
        return String::new();
    }
    let items: String = notes.iter().map(|note| format!("<li>{}</li>", escape(note))).collect();
    format!("<section class=\"notes\"><h2>Notes</h2><ul>{items}</ul></section>\n")
}

/// Returns all figures, in tables with one column per mesh.
pub(super) fn tables(shown: &[Shown]) -> String {
    let all: Vec<&Shown> = shown.iter().collect();
    // Distances are measured to the mesh without a report.
    let subjects: Vec<&Shown> = shown.iter().filter(|s| s.report.is_some()).collect();
    let columns: Vec<_> = shown.iter().map(|s| s.measured).collect();
    let crossings = (CROSSINGS, crossing_figures(shown));
    let topology = topology_rows(&columns).into_iter().chain([crossings]).collect();
    let mut triangles = shape_rows(&columns);
    let mut edges = triangles.split_off(triangles.iter().position(|row| row.0.starts_with("edge")).unwrap_or(0));
    let valences = edges.split_off(edges.iter().position(|row| row.0.starts_with("valence")).unwrap_or(0));
    let tables = [
        ("Triangles", &all, triangles),
        ("Topology", &all, topology),
        ("Edges", &all, edges),
        ("Interior vertices", &all, valences),
        ("Distance, % of the diagonal", &subjects, distances(&subjects)),
    ];
    tables
        .iter()
        .filter(|(_, _, rows)| !rows.is_empty())
        .map(|(caption, columns, rows)| table(caption, columns, rows))
        .collect()
}

fn table(caption: &str, columns: &[&Shown], rows: &[Figures]) -> String {
    let head =
        |s: &&Shown| format!("<th scope=\"col\">{}</th>", escape(if s.role.is_empty() { &s.name } else { s.role }));
    let heads: String = columns.iter().map(head).collect();
    let mut out = format!(
        "<div class=\"wide\"><table><caption>{caption}</caption><thead><tr><td></td>{heads}</tr></thead>\n<tbody>"
    );
    for (name, figures) in rows {
        let cells: String = figures.iter().map(|figure| format!("<td>{figure}</td>")).collect();
        let _ = writeln!(out, "<tr><th scope=\"row\">{}</th>{cells}</tr>", escape(name));
    }
    out.push_str("</tbody></table></div>\n");
    out
}

/// Returns the numbers of self-intersecting faces of each mesh according to the reports.
fn crossing_figures(shown: &[Shown]) -> Vec<String> {
    let of_input = |s: &Shown| s.report.and_then(|report| crossings(report).into_iter().next());
    let figure = |s: &Shown| match s.report {
        Some(report) => crossings(report).pop().unwrap_or_default(),
        None if shown.len() == 2 => shown.iter().find_map(of_input).unwrap_or_default(),
        None => "-".into(),
    };
    shown.iter().map(figure).collect()
}

/// Returns the distances in both directions between each of these meshes and the input.
fn distances(subjects: &[&Shown]) -> Vec<Figures> {
    let of = |s: &&Shown| s.report.and_then(|report| report.distance.as_ref()).map(distance_rows);
    let of_each: Vec<Option<[Figures; 2]>> = subjects.iter().map(of).collect();
    if of_each.iter().all(Option::is_none) {
        return Vec::new();
    }
    let names = [
        ["RMS, to the input", "RMS, from the input", "RMS, both ways"],
        ["Hausdorff, to the input", "Hausdorff, from the input", "Hausdorff, both ways"],
    ];
    let cell =
        |rows: &Option<[Figures; 2]>, i: usize, k: usize| rows.as_ref().map_or("-".into(), |r| r[i].1[k].clone());
    let row = |(i, k): (usize, usize)| (names[i][k], of_each.iter().map(|rows| cell(rows, i, k)).collect());
    [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)].map(row).into()
}

/// Returns everything that is not a figure of a mesh: sampling, repairs and so on, for each report that has them.
pub(super) fn details(shown: &[Shown]) -> String {
    let mut out = String::new();
    for (name, report) in shown.iter().filter_map(|s| Some((&s.name, s.report?))) {
        let facts: Vec<_> = facts(report).into_iter().chain(run_facts(&report.run)).collect();
        if facts.is_empty() {
            continue;
        }
        out.push_str("<dl>");
        if report.verified.is_none() {
            let _ = write!(out, "<dt class=\"file\">{}</dt><dd></dd>", escape(name));
        }
        for (name, phrases) in facts {
            let _ = write!(out, "<dt>{name}</dt><dd>{}</dd>", escape(&phrases.join(", ")));
        }
        out.push_str("</dl>\n");
    }
    out
}
