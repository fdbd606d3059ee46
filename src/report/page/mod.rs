//! A report as a page: a single HTML file that opens without a network, with the meshes in a viewer, histograms, the tables,
//! and the report as JSON.
//!
//! All figures, including those of single triangles and vertices, are computed by the library: the page's script only draws.
//! No content depends on time, threads or machine, so that the same run gives the same page.
//!
//! Cost: a search for the closest point of the other mesh from each vertex, and about 34 bytes per vertex.

mod camera;
mod colours;
mod histogram;
mod html;
mod places;
mod scene;
mod sections;
mod shown;
mod snapshot;

pub use shown::Subject;

use crate::mesh::triangle_mesh::Mesh;
use crate::report::failure::Failure;
use crate::report::page::camera::FirstView;
use crate::report::page::colours::{Colouring, KEPT, LEFT_OUT, MARKED};
use crate::report::page::html::{escape, fill, json_in_script};
use crate::report::page::places::places;
use crate::report::page::scene::Scene;
use crate::report::page::shown::{Shown, all};
use crate::report::page::snapshot::Snapshot;
use crate::report::remeshing::{Report, all_to_json};
use crate::report::rows::significant;

const DOCUMENT: &str = include_str!("page.html");
const MAIN: &str = include_str!("main.html");
const STYLE: [&str; 2] = [include_str!("../../../viewer/viewer.css"), include_str!("page.css")];
const SCRIPT: [&str; 8] = [
    include_str!("../../../viewer/vectors.js"),
    include_str!("../../../viewer/camera.js"),
    include_str!("../../../viewer/gestures.js"),
    include_str!("../../../viewer/meshes.js"),
    include_str!("../../../viewer/shaders.js"),
    include_str!("../../../viewer/viewer.js"),
    include_str!("../../../viewer/report.js"),
    include_str!("page.js"),
];

/// Fraction of the vertices that may be farther away than the end of the distance ramp: otherwise, a few far vertices would
/// leave no colours for all others.
const BEYOND: f64 = 0.005;

/// Total number of triangles above which a page has pictures instead of a viewer.
pub const MOST_IN_VIEWER: usize = 200_000;

/// The content of a page, for documents that already include the styles and scripts of `viewer/`.
pub struct Content {
    /// The title, as HTML.
    pub title: String,
    /// The content of the `main` element.
    pub main: String,
    /// The scene that the viewer draws, as JSON; `null` if the page has pictures instead of a viewer.
    pub scene: String,
}

/// Returns the page about one remeshing, or about one or several measured meshes. `reference` is the input of a remeshing,
/// or the mesh that all others were measured against. The page states time, memory and threads if the reports do
/// ([`Report::without_run`]).
pub fn page(reference: Option<&Mesh>, subjects: &[Subject]) -> String {
    let Content { title, main, scene } = content(reference, subjects);
    let reports: Vec<&Report> = subjects.iter().map(|subject| subject.report).collect();
    document(&title, &main, &all_to_json(&reports), &scene, &SCRIPT.concat())
}

/// Returns the page about a run that failed.
pub fn page_of_failure(failure: &Failure) -> String {
    let why = escape(&failure.error);
    let main = format!(
        "<header><h1>No result</h1></header>\n<div class=\"verdict bad\" role=\"status\"><h2>Failed</h2><p>{why}</p></div>\n"
    );
    document("No result", &main, &failure.to_json(), "null", "")
}

/// Returns the content of the [`page`].
pub fn content(reference: Option<&Mesh>, subjects: &[Subject]) -> Content {
    let shown = all(reference, subjects);
    let places = places(&shown);
    let farthest = farthest(&shown);
    let triangles: usize = shown.iter().map(|s| s.mesh.triangles.len()).sum();
    let has_viewer = triangles <= MOST_IN_VIEWER;
    let view = FirstView::of(shown.iter().map(|s| s.mesh));
    let scene = has_viewer.then(|| Scene::new(&shown, &places, &view, farthest.unwrap_or(1.0)));
    let key = sections::key(&shown);
    let title = escape(&sections::title(&shown));
    let main = fill(
        MAIN,
        &[
            ("title", &title),
            ("lede", &sections::lede(&shown)),
            ("verdicts", &sections::verdicts(&shown, &places, has_viewer)),
            ("figures", &sections::figures(&shown)),
            ("key", &key),
            ("keys", &if shown.len() > 2 { format!("<p class=\"keys\">{key}</p>\n") } else { String::new() }),
            ("notes", &sections::notes(&shown)),
            ("tools", &tools(&shown, farthest, has_viewer)),
            ("panels", &if has_viewer { canvases(&shown) } else { pictures(&shown, &view, farthest) }),
            ("hint", if has_viewer { HINT } else { HINT_ON_PICTURES }),
            ("places", &places::list(&places, &shown, has_viewer)),
            ("histograms", &histogram::histograms(&shown)),
            ("tables", &sections::tables(&shown)),
            ("details", &sections::details(&shown)),
        ],
    );
    Content { title, main, scene: serde_json::to_string(&scene).expect("a scene is plain data") }
}

/// Assembles an HTML file; `title` and `main` are HTML, `report` and `scene` JSON.
fn document(title: &str, main: &str, report: &str, scene: &str, script: &str) -> String {
    fill(
        DOCUMENT,
        &[
            ("style", &STYLE.concat()),
            ("title", title),
            ("main", main),
            ("version", env!("CARGO_PKG_VERSION")),
            ("report", &json_in_script(report)),
            ("scene", &json_in_script(scene)),
            ("script", script),
        ],
    )
}

/// Returns the distance at the end of the ramp, in percent; `None` if no distances are known.
fn farthest(shown: &[Shown]) -> Option<f64> {
    let mut all: Vec<f64> = shown.iter().filter_map(|s| s.distances.as_ref()).flatten().copied().collect();
    all.sort_unstable_by(f64::total_cmp);
    let at = ((1.0 - BEYOND) * all.len() as f64) as usize;
    Some(all.get(at.min(all.len().checked_sub(1)?)).copied()?.max(f64::MIN_POSITIVE))
}

/// Instructions for the viewer.
const HINT: &str = "\
<noscript><p class=\"hint\">The meshes are drawn by a script in this page, but scripts are switched off.</p></noscript>
<p class=\"hint\">Drag to rotate, Shift-drag to move; scroll or pinch to zoom once a mesh is selected. Arrow keys, + and −
work as well; double-click to reset the view. All meshes move together.</p>
";

/// The reason why there is no viewer.
const HINT_ON_PICTURES: &str =
    "<p class=\"hint\">Shown as pictures, since there are too many triangles for a page to rotate smoothly.</p>\n";

fn known_colourings(farthest: Option<f64>) -> impl Iterator<Item = Colouring> + Clone {
    Colouring::ALL.into_iter().filter(move |c| *c != Colouring::Distance || farthest.is_some())
}

/// Returns the controls: the choice of figures by which the meshes are coloured, with their legends, and switches for what
/// else is drawn.
fn tools(shown: &[Shown], farthest: Option<f64>, has_viewer: bool) -> String {
    let known = known_colourings(farthest);
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
    let drawn = [
        (shown.iter().any(|s| !s.sharp.is_empty()), "line", KEPT, "sharp edges that were kept"),
        (shown.iter().any(|s| !s.left_out.is_empty()), "line", LEFT_OUT, "sharp edges that were left out"),
        (
            shown.iter().any(|s| !s.marked.is_empty()),
            "mark",
            MARKED,
            "faces that intersect others, slivers and bridges",
        ),
    ];
    let swatch = |&(_, class, colour, what): &(bool, &str, &str, &str)| {
        let style = format!("color:{colour}{}", if class == "mark" { ";background:currentcolor" } else { "" });
        format!("<span class=\"swatch\"><i class=\"{class}\" style=\"{style}\"></i>{what}</span>")
    };
    let swatches: String = drawn.iter().filter(|d| d.0).map(swatch).collect();
    let lines = if swatches.is_empty() { swatches } else { format!("<p class=\"legend\">{swatches}</p>") };
    let switches = [
        (has_viewer, "<label><input type=\"checkbox\" id=\"wire\" checked> Wireframe</label>\n"),
        (
            has_viewer && (drawn[0].0 || drawn[1].0),
            "<label><input type=\"checkbox\" id=\"edges\" checked> Sharp edges</label>\n",
        ),
        (has_viewer, "<button type=\"button\" id=\"reset\">Reset the view</button>\n"),
    ];
    let switches: String = switches.iter().filter(|s| s.0).map(|s| s.1).collect();
    format!(
        "<div class=\"tools\"><fieldset><legend>Colour by</legend>{choices}</fieldset>\n{switches}</div>\n\
         <div class=\"legends\">{legends}{lines}</div>\n"
    )
}

/// Returns a canvas for each mesh.
fn canvases(shown: &[Shown]) -> String {
    let panel = |s: &Shown| {
        let title = escape(&s.title());
        format!(
            "<figure class=\"panel\"><canvas tabindex=\"0\" role=\"img\" aria-label=\"{title}, rotate with the arrow keys\">\
             </canvas>{}</figure>\n",
            caption(s)
        )
    };
    shown.iter().map(panel).collect()
}

/// Returns pictures of each mesh, one per colouring.
fn pictures(shown: &[Shown], view: &FirstView, farthest: Option<f64>) -> String {
    let panel = |s: &Shown| {
        let snapshot = Snapshot::new(s, view);
        let picture = |c: Colouring| {
            let address = snapshot.address(c, farthest.unwrap_or(1.0));
            let (key, title, hidden) = (c.key(), c.title(), if c == Colouring::Angle { "" } else { " hidden" });
            format!(
                "<img data-colouring=\"{key}\" alt=\"{}, {title}\" src=\"{address}\"{hidden}>\n",
                escape(&s.title())
            )
        };
        let pictures: String = known_colourings(farthest).map(picture).collect();
        format!("<figure class=\"panel\">{pictures}{}</figure>\n", caption(s))
    };
    shown.iter().map(panel).collect()
}

fn caption(s: &Shown) -> String {
    let t = &s.measured.topology;
    format!("<figcaption><b>{}</b> {} vertices, {} triangles</figcaption>", escape(&s.title()), t.vertices, t.faces)
}
