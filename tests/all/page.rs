//! Reports as HTML pages: the content of the file. `viewer/test/` tests how a browser shows it.

use crate::common::*;
use glam::DVec3;
use serde_json::Value;
use spectral_remesh::io::{Format, write};
use spectral_remesh::report::page::{Subject, page};
use spectral_remesh::report::{FAILURE_SCHEMA, Report};
use spectral_remesh::{Mesh, quality};
use std::path::Path;
use std::process::Command;

/// Runs the program in `folder` and returns its exit status.
fn run(folder: &Path, words: &[&str]) -> i32 {
    let ran = Command::new(env!("CARGO_BIN_EXE_remesh")).current_dir(folder).args(words).output().unwrap();
    ran.status.code().unwrap_or(-1)
}

/// Returns a folder with `cube.off`, `ball.off` and `points.xyz`.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    save(folder.path(), "cube.off", &cuboid(DVec3::splat(2.0)));
    let ball = sphere(4, DVec3::ZERO, 1.0);
    save(folder.path(), "ball.off", &ball);
    let lines: String = ball.positions.iter().map(|p| format!("{} {} {}\n", p.x, p.y, p.z)).collect();
    std::fs::write(folder.path().join("points.xyz"), lines).unwrap();
    folder
}

fn save(folder: &Path, name: &str, mesh: &Mesh) {
    let mut bytes = Vec::new();
    write(mesh, Format::Off, &mut bytes).unwrap();
    std::fs::write(folder.join(name), bytes).unwrap();
}

/// Returns the page that a run writes to `r.html`, after checking what must hold for all pages: the page loads nothing from
/// elsewhere, and its JSON can be parsed.
fn page_of(folder: &Path, words: &str, status: i32) -> String {
    let words: Vec<&str> = words.split(' ').chain(["--report", "r.html"]).collect();
    assert_eq!(run(folder, &words), status);
    let page = std::fs::read_to_string(folder.join("r.html")).unwrap();
    audit_page(&page);
    page
}

fn audit_page(page: &str) {
    for outside in ["http:", "https:", "src=\"/", "@import", "url(", "<link", "<iframe"] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(page.contains("content=\"default-src 'none';") && page.ends_with("</html>\n"));
    // In base64, any sequence of letters may occur.
    let is_base64 = |c: char| c.is_ascii_alphanumeric() || "+/=".contains(c);
    let mut words = page.split(|c| !is_base64(c)).filter(|word| word.len() < 1000);
    assert!(!page.contains("{{") && !words.any(|word| word.contains("NaN")));
    for (open, close) in [("<section", "</section>"), ("<figure", "</figure>"), ("<div", "</div>"), ("<tr", "</tr>")] {
        assert_eq!(page.matches(open).count(), page.matches(close).count(), "{open}");
    }
    embedded(page, "report");
    embedded(page, "scene");
}

/// Returns the JSON of a script element.
fn embedded(page: &str, id: &str) -> Value {
    let (_, rest) = page.split_once(&format!("<script type=\"application/json\" id=\"{id}\">")).unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

/// Returns the number of bytes of a member of the scene.
fn size(text: &Value) -> usize {
    let text = text.as_str().unwrap();
    text.len() / 4 * 3 - text.bytes().rev().take_while(|&b| b == b'=').count()
}

#[test]
fn a_remeshed_mesh_is_shown_beside_its_input() {
    let folder = folder();
    let page = page_of(folder.path(), "cube.off out.obj --points 400 --seed 3", 0);
    assert!(page.contains("<h1>cube.off → out.obj</h1>") && page.contains(">Verified<"));
    let report = embedded(&page, "report");
    assert_eq!((&report["verified"], &report["sampling"]["seed"]), (&true.into(), &3.into()));
    assert_eq!((&report["stages"], &report["peak_memory_bytes"]), (&Value::Array(vec![]), &Value::Null));
    let scene = embedded(&page, "scene");
    let [input, output] = &scene["meshes"].as_array().unwrap()[..] else { panic!("two meshes") };
    assert_eq!((&input["vertices"], &input["triangles"], &output["vertices"]), (&8.into(), &12.into(), &400.into()));
    let faces = output["triangles"].as_u64().unwrap() as usize;
    let sizes = ["positions", "corners", "angle", "quality", "valence", "distance"].map(|name| size(&output[name]));
    assert_eq!(sizes, [6 * 400, 6 * faces, faces, faces, 400, 400]);
    assert!(size(&output["sharp"]) > 12 * 12 && size(&input["sharp"]) == 0);
    assert_eq!((page.matches("<canvas").count(), page.matches("<svg").count()), (2, 4));
}

#[test]
fn the_json_in_a_page_is_the_report_without_its_times() {
    let folder = folder();
    let page = page_of(folder.path(), "cube.off out.obj --points 300", 0);
    assert_eq!(run(folder.path(), &["cube.off", "out.obj", "--points", "300", "--report", "r.json"]), 0);
    let mut report: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("r.json")).unwrap()).unwrap();
    assert!(!report["stages"].as_array().unwrap().is_empty());
    (report["stages"], report["peak_memory_bytes"], report["threads"]) = (Value::Array(vec![]), Value::Null, 1.into());
    assert_eq!(embedded(&page, "report"), report);
}

#[test]
fn a_verbose_run_has_its_times_in_the_page() {
    let folder = folder();
    let page = page_of(folder.path(), "cube.off out.obj --points 300 -v", 0);
    assert!(!embedded(&page, "report")["stages"].as_array().unwrap().is_empty());
    assert!(page.contains("<dt>seconds</dt>"));
    assert!(!page_of(folder.path(), "cube.off out.obj --points 300", 0).contains("<dt>seconds</dt>"));
}

#[test]
fn a_run_that_fails_has_a_report_that_says_why() {
    let folder = folder();
    std::fs::write(folder.path().join("<b>.off"), "no mesh\n").unwrap();
    for words in ["<b>.off out.obj --points 300", "quality <b>.off"] {
        let page = page_of(folder.path(), words, 1);
        let error = embedded(&page, "report")["error"].as_str().unwrap().to_string();
        assert!(error.starts_with("<b>.off"), "{error}");
        assert!(page.contains("<h2>Failed</h2><p>&lt;b&gt;.off") && !page.contains("<b>.off"));
    }
    for words in ["<b>.off out.obj --points 300", "sample <b>.off out.xyz --points 9", "reconstruct <b>.off out.obj"] {
        let words: Vec<&str> = words.split(' ').chain(["--report", "r.json"]).collect();
        assert_eq!(run(folder.path(), &words), 1);
        let report: Value =
            serde_json::from_str(&std::fs::read_to_string(folder.path().join("r.json")).unwrap()).unwrap();
        assert_eq!(report["schema"], FAILURE_SCHEMA);
        assert!(report["error"].as_str().unwrap().starts_with("<b>.off"));
    }
}

#[test]
fn of_a_cloud_the_mesh_through_its_points_is_shown() {
    let folder = folder();
    let page = page_of(folder.path(), "points.xyz out.ply --points 300", 0);
    let (scene, report) = (embedded(&page, "scene"), embedded(&page, "report"));
    assert_eq!(scene["meshes"][0]["vertices"], report["input"]["topology"]["vertices"]);
    assert!(scene["meshes"][0]["triangles"].as_u64().unwrap() > 1000);
    assert!(page.contains("1026 points"));
}

#[test]
fn what_is_not_verified_says_so_and_leads_to_the_place() {
    let folder = folder();
    let page = page_of(folder.path(), "ball.off out.off --points 200 --max-error 0.001%", 3);
    assert!(page.contains(">Not verified<") && page.contains("the distance to the input is up to"));
    assert!(page.contains("Look at <a href=\"#view\" data-place=\"0\">"));
    let [x, y, z] = [0, 1, 2].map(|k| embedded(&page, "scene")["places"][0]["point"][k].as_f64().unwrap());
    // In units of half the diagonal of the bounding box of a unit sphere.
    assert!((DVec3::new(x, y, z).length() - 3f64.sqrt().recip()).abs() < 0.05);
}

#[test]
fn meshes_are_measured_alone_and_side_by_side() {
    let folder = folder();
    let page = page_of(folder.path(), "quality ball.off", 0);
    assert_eq!(page.matches("<canvas").count(), 1);
    assert!(page.contains("ball.off: Sound") && !page.contains("value=\"distance\""));
    assert_eq!(embedded(&page, "report")["output"]["file"], "ball.off");
    save(folder.path(), "inverted.off", &inside_out(sphere(3, DVec3::ZERO, 0.9)));
    let page = page_of(folder.path(), "quality ball.off cube.off inverted.off --against ball.off", 0);
    assert_eq!((page.matches("<canvas").count(), page.matches("value=\"distance\"").count()), (4, 1));
    let reports = embedded(&page, "report");
    let files: Vec<&Value> = reports.as_array().unwrap().iter().map(|report| &report["output"]["file"]).collect();
    assert_eq!(files, ["ball.off", "cube.off", "inverted.off"]);
    assert!(reports[1]["distance"]["hausdorff"].as_f64().unwrap() > 10.0);
}

#[test]
fn several_meshes_as_json_are_a_list() {
    let folder = folder();
    assert_eq!(run(folder.path(), &["quality", "ball.off", "cube.off", "--report", "r.json"]), 0);
    let text = std::fs::read_to_string(folder.path().join("r.json")).unwrap();
    let reports: Vec<Report> = serde_json::from_str(&text).unwrap();
    assert_eq!(reports.iter().map(|r| r.output.topology.vertices).collect::<Vec<_>>(), [1026, 8]);
}

#[cfg(unix)]
#[test]
fn names_of_files_are_no_markup() {
    let folder = folder();
    let name = "<b>&\"'</script><script>alert(1)/x.off";
    let path = folder.path().join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::copy(folder.path().join("ball.off"), &path).unwrap();
    assert_eq!(run(folder.path(), &["quality", name, "--against", "ball.off", "--report", "r.html"]), 0);
    assert_eq!(run(folder.path(), &["quality", name, "--report", "s.html", "--against", name]), 0);
    for file in ["r.html", "s.html"] {
        let page = std::fs::read_to_string(folder.path().join(file)).unwrap();
        audit_page(&page);
        assert!(!page.contains("<script>alert") && !page.contains("<b>&\""));
        assert_eq!(embedded(&page, "report")["output"]["file"], name);
    }
}

#[test]
fn large_meshes_are_pictures() {
    let mesh = grid(330, 320, Ends::Joined, Ends::Joined, |u, v| {
        let (a, b) = (std::f64::consts::TAU * u, std::f64::consts::TAU * v);
        DVec3::new((3.0 + b.cos()) * a.cos(), (3.0 + b.cos()) * a.sin(), b.sin())
    });
    let report = quality(&(&mesh).into(), None).unwrap();
    let page = page(None, &[Subject { report: &report, mesh: &mesh, edges: None }]);
    audit_page(&page);
    assert_eq!((embedded(&page, "scene"), page.matches("<canvas").count()), (Value::Null, 0));
    assert!(page.contains("smallest angle") && !page.contains("data-place=\""));
    let pictures: Vec<&str> = page.split("src=\"data:image/png;base64,").skip(1).collect();
    assert_eq!(pictures.len(), 3);
    let base64 = pictures[0].split('"').next().unwrap();
    // The torus covers about half of the picture.
    let pixels = decoded(base64);
    let drawn = pixels.chunks_exact(4).filter(|pixel| pixel[3] == 255).count() as f64;
    assert!((0.2..0.7).contains(&(4.0 * drawn / pixels.len() as f64)));
    assert!(page.len() < 4_000_000, "{}", page.len());
}

/// Returns the pixels of a picture given as base64.
fn decoded(base64: &str) -> Vec<u8> {
    let digit = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let digits: Vec<u32> = base64.bytes().filter(|&c| c != b'=').map(|c| digit(c).into()).collect();
    let bits = |four: &[u32]| four.iter().enumerate().fold(0, |bits, (k, digit)| bits | digit << (18 - 6 * k));
    let file: Vec<u8> = digits.chunks(4).flat_map(|four| bits(four).to_be_bytes()[1..four.len()].to_vec()).collect();
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    pixels
}
