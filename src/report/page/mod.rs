//! A report as a page: one HTML file that opens without a network, with the meshes in a viewer, histograms, the table, and
//! the report as JSON.
//!
//! All figures are those of the library, for each triangle and vertex, too: the page's script only draws. Nothing in it
//! depends on time, threads or machine, so that the same run has the same page.
//!
//! Cost: a search for the closest point of the other mesh from each vertex, and about 34 bytes a vertex.

mod camera;
mod colours;
mod histogram;
mod html;
mod places;
mod scene;
mod sections;
mod shown;

pub use shown::Subject;

use crate::mesh::triangle_mesh::Mesh;
use crate::report::page::colours::Colouring;
use crate::report::page::html::{escape, fill, json_in_script};
use crate::report::page::places::places;
use crate::report::page::scene::Scene;
use crate::report::page::shown::{Shown, all};
use crate::report::remeshing::{Report, all_to_json};
use crate::report::rows::significant;
use crate::report::run::RunSummary;

const TEMPLATE: &str = include_str!("page.html");
const STYLE: [&str; 2] = [include_str!("../../../viewer/viewer.css"), include_str!("page.css")];
const SCRIPT: [&str; 2] = [include_str!("../../../viewer/viewer.js"), include_str!("page.js")];

/// Share of the vertices that may be farther than the end of the ramp for distances: a few far ones would leave no colours for
/// all others.
const BEYOND: f64 = 0.005;

/// The page about one remeshing, one mesh or several ones that were measured. `reference` is the input of a remeshing, or what
/// all meshes were measured against.
pub fn page(reference: Option<&Mesh>, subjects: &[Subject]) -> String {
    let shown = all(reference, subjects);
    let places = places(&shown);
    let farthest = farthest(&shown);
    let scene = Scene::new(&shown, &places, farthest.unwrap_or(1.0));
    let scene = serde_json::to_string(&scene).expect("a scene is plain data");
    fill(
        TEMPLATE,
        &[
            ("style", &STYLE.concat()),
            ("title", &escape(&sections::title(&shown))),
            ("verdicts", &sections::verdicts(&shown, &places)),
            ("figures", &sections::figures(&shown)),
            ("key", &sections::key(&shown)),
            ("notes", &sections::notes(&shown)),
            ("tools", &tools(&shown, farthest)),
            ("panels", &panels(&shown)),
            ("places", &places::list(&places, &shown, true)),
            ("histograms", &histogram::histograms(&shown)),
            ("table", &sections::table(&shown)),
            ("details", &sections::details(&shown)),
            ("version", env!("CARGO_PKG_VERSION")),
            ("report", &json_in_script(&json(subjects))),
            ("scene", &json_in_script(&scene)),
            ("script", &SCRIPT.concat()),
        ],
    )
}

/// The distance at the end of the ramp, in percent; `None` if no distances are known.
fn farthest(shown: &[Shown]) -> Option<f64> {
    let mut all: Vec<f64> = shown.iter().filter_map(|s| s.distances.as_ref()).flatten().copied().collect();
    all.sort_unstable_by(f64::total_cmp);
    let at = ((1.0 - BEYOND) * all.len() as f64) as usize;
    Some(all.get(at.min(all.len().checked_sub(1)?)).copied()?.max(f64::MIN_POSITIVE))
}

/// What can be chosen: the figure that the meshes are coloured by, each with its legend, and what is drawn besides.
fn tools(shown: &[Shown], farthest: Option<f64>) -> String {
    let known = Colouring::ALL.into_iter().filter(|c| *c != Colouring::Distance || farthest.is_some());
    let last = format!("≥ {}", significant(farthest.unwrap_or_default()));
    let choice = |c: Colouring| {
        let (key, title, checked) = (c.key(), c.title(), if c == Colouring::Angle { " checked" } else { "" });
        format!("<label><input type=\"radio\" name=\"colouring\" value=\"{key}\"{checked}><span>{title}</span></label>")
    };
    let legend = |c: Colouring| {
        let hidden = if c == Colouring::Angle { "" } else { " hidden" };
        format!("<p class=\"legend\" data-colouring=\"{}\"{hidden}>{}</p>\n", c.key(), c.legend(&last))
    };
    let choices: String = known.clone().map(choice).collect();
    let legends: String = known.map(legend).collect();
    let lines = [
        (shown.iter().any(|s| !s.sharp.is_empty()), "<i class=\"line kept\"></i>sharp edges that were kept"),
        (shown.iter().any(|s| !s.left_out.is_empty()), "<i class=\"line left-out\"></i>sharp edges that were left out"),
        (shown.iter().any(|s| !s.marked.is_empty()), "<i class=\"mark\"></i>faces at fault"),
    ];
    let known: Vec<&str> = lines.iter().filter(|line| line.0).map(|line| line.1).collect();
    let has_edges = lines[0].0 || lines[1].0;
    let edges = "<label><input type=\"checkbox\" id=\"edges\" checked> Sharp edges</label>";
    let drawn: String = known.iter().map(|line| format!("<span class=\"swatch\">{line}</span>")).collect();
    format!(
        "<div class=\"tools\"><fieldset><legend>Colour by</legend>{choices}</fieldset>\n\
         <label><input type=\"checkbox\" id=\"wire\" checked> Wire frame</label>{}\
         <button type=\"button\" id=\"reset\">Reset the view</button></div>\n\
         <div class=\"legends\">{legends}{}</div>\n",
        if has_edges { edges } else { "" },
        if drawn.is_empty() { drawn } else { format!("<p class=\"legend\">{drawn}</p>") }
    )
}

/// A canvas for each mesh.
fn panels(shown: &[Shown]) -> String {
    let panel = |s: &Shown| {
        let (title, t) = (escape(&s.title()), &s.measured.topology);
        format!(
            "<figure class=\"panel\"><canvas tabindex=\"0\" role=\"img\" aria-label=\"{title}, turned by the arrow keys\">\
             </canvas><figcaption><b>{title}</b> {} vertices, {} triangles</figcaption></figure>\n",
            t.vertices, t.faces
        )
    };
    shown.iter().map(panel).collect()
}

/// The reports without what is of one run only; a list if there are several.
fn json(subjects: &[Subject]) -> String {
    let lasting = |s: &Subject| Report { run: RunSummary::of_notes(s.report.run.notes.clone()), ..s.report.clone() };
    all_to_json(&subjects.iter().map(lasting).collect::<Vec<_>>())
}
