//! The program as users run it: arguments, exit statuses, what is printed where, and which files remain on disk.

mod levels;

use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// A finished run.
struct Ran {
    status: i32,
    out: String,
    err: String,
}

impl Ran {
    /// Checks that it failed with `status`, printed nothing to standard output, and printed one line that contains `words`
    /// to standard error.
    #[track_caller]
    fn failed(&self, status: i32, words: &[&str]) {
        assert_eq!(self.status, status, "{}", self.err);
        assert_eq!(self.out, "");
        assert!(self.err.starts_with("remesh: ") && self.err.lines().count() == 1, "{:?}", self.err);
        words.iter().for_each(|word| assert!(self.err.contains(word), "no {word:?} in {:?}", self.err));
    }

    /// Checks that it ended with status 0 and printed nothing to standard error.
    #[track_caller]
    fn went_well(&self) -> &str {
        assert_eq!((self.status, self.err.as_str()), (0, ""));
        &self.out
    }
}

fn command(folder: &Path, words: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_remesh"));
    command.current_dir(folder).args(words.split_whitespace()).stdin(Stdio::null());
    command
}

/// Runs the program in `folder`, with the space-separated `words` as its arguments.
fn run(folder: &Path, words: &str) -> Ran {
    let Output { status, stdout, stderr } = command(folder, words).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Ran { status: status.code().unwrap_or(-1), out: text(stdout), err: text(stderr) }
}

/// Returns a folder with `octahedron.off`, `moved.off` (the same, 0.1 higher), `sphere.off` (1,938 vertices) and more.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("octahedron.off", &sphere(1, 0.0));
    write("moved.off", &sphere(1, 0.1));
    write("sphere.off", &sphere(22, 0.0));
    write("empty.off", "");
    write("points.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n");
    write("nan.off", "OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n");
    folder
}

/// Returns an octahedron whose faces are divided into `n` by `n` triangles and projected onto a unit sphere, as OFF. Each of
/// the eight faces has its own grid; vertices on common edges are matched by their place on the octahedron.
fn sphere(n: i32, lift: f64) -> String {
    let mut places: Vec<[i32; 3]> = Vec::new();
    let mut index = |place: [i32; 3]| {
        places.iter().position(|&p| p == place).unwrap_or_else(|| {
            places.push(place);
            places.len() - 1
        })
    };
    let mut faces = Vec::new();
    for signs in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|k| if signs >> k & 1 == 0 { 1 } else { -1 });
        let mut face = |corners: [(i32, i32); 3]| {
            let [a, b, c] = corners.map(|(i, j)| index([x * i, y * j, z * (n - i - j)]));
            faces.push(if x * y * z > 0 { [a, b, c] } else { [a, c, b] });
        };
        for (i, j) in (0..n).flat_map(|i| (0..n - i).map(move |j| (i, j))) {
            face([(i, j), (i + 1, j), (i, j + 1)]);
            if i + j + 2 <= n {
                face([(i + 1, j), (i + 1, j + 1), (i, j + 1)]);
            }
        }
    }
    let mut text = format!("OFF\n{} {} 0\n", places.len(), faces.len());
    for place in &places {
        let [x, y, z] = place.map(f64::from);
        let length = (x * x + y * y + z * z).sqrt();
        writeln!(text, "{} {} {}", x / length, y / length, z / length + lift).unwrap();
    }
    faces.iter().for_each(|[a, b, c]| writeln!(text, "3 {a} {b} {c}").unwrap());
    text
}

/// Returns the names of all files in a folder.
fn files(folder: &Path) -> Vec<String> {
    let names = std::fs::read_dir(folder).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn help_and_version_are_no_errors() {
    let folder = folder();
    let help = run(folder.path(), "--help");
    for part in ["Usage: remesh <IN> <OUT>", "--points <N|auto>", "Examples:", "Exit status:"] {
        assert!(help.went_well().contains(part), "{part}");
    }
    assert!(run(folder.path(), "sample --help").went_well().contains("blue noise"));
    assert!(run(folder.path(), "quality --help").went_well().contains("--against <INPUT>"));
    assert_eq!(run(folder.path(), "--version").went_well(), concat!("remesh ", env!("CARGO_PKG_VERSION"), "\n"));
}

#[test]
fn wrong_usage_is_two_and_one_line() {
    let folder = folder();
    let before = files(folder.path());
    run(folder.path(), "").failed(2, &["<IN> <OUT>"]);
    run(folder.path(), "sphere.off out.obj").failed(2, &["--points", "--edge-length", "--sigma-p"]);
    run(folder.path(), "sphere.off out.obj --points 0").failed(2, &["--points"]);
    run(folder.path(), "sphere.off out.obj --points -5").failed(2, &["--points", "-5"]);
    run(folder.path(), "sphere.off out.obj --points 9 --sigma-p 1").failed(2, &["--points", "--sigma-p"]);
    run(folder.path(), "sphere.off out.obj --edge-length 0").failed(2, &["--edge-length", "positive"]);
    run(folder.path(), "sphere.off out.obj --pionts 9").failed(2, &["--pionts", "--points"]);
    run(folder.path(), "quality").failed(2, &["<MESH>"]);
    assert_eq!(files(folder.path()), before);
}

#[test]
fn completions_are_printed_for_each_shell() {
    let folder = folder();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let ran = run(folder.path(), &format!("completions {shell}"));
        assert!(ran.went_well().contains("edge-length"), "{shell}");
    }
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = folder();
    let page = run(folder.path(), "man");
    let page = page.went_well();
    for part in [".TH remesh 1", ".SH SYNOPSIS", "edge\\-length", "scan.ply dense.ply", "Exit status:\n"] {
        assert!(page.contains(part), "no {part} in\n{page}");
    }
    for command in ["sample", "reconstruct", "quality", "completions", "man", "tiles"] {
        assert!(page.contains(&format!("remesh\\-{command}(1)")), "{command}");
        let ran = run(folder.path(), &format!("man {command}"));
        let own = ran.went_well();
        assert!(own.contains(&format!(".TH remesh-{command} 1")), "{command}");
        assert!(own.is_ascii(), "{command} has letters that not every reader of manual pages knows");
    }
    assert!(page.contains("\\[u03C3]p") && page.is_ascii());
}

#[test]
fn quality_prints_a_table() {
    let ran = run(folder().path(), "quality octahedron.off");
    let text = ran.went_well();
    for line in ["octahedron.off", "vertices                              6", "θ min                            60.00°"]
    {
        assert!(text.lines().any(|l| l == line), "no {line:?} in\n{text}");
    }
    assert!(!text.contains("RMS"));
}

#[test]
fn quality_against_another_mesh_has_distances() {
    let ran = run(folder().path(), "quality moved.off --against octahedron.off --json");
    let report = json(ran.went_well());
    assert_eq!(report["schema"], "spectral-remesh/report/2");
    assert_eq!((&report["output"]["file"], &report["input"]["file"]), (&"moved.off".into(), &"octahedron.off".into()));
    assert_eq!(report["verified"], serde_json::Value::Null);
    let hausdorff = report["distance"]["hausdorff"].as_f64().unwrap();
    assert!((hausdorff - 100.0 * 0.1 / 12f64.sqrt()).abs() < 1e-6, "{hausdorff}");
    assert_eq!(report["stages"][0]["name"], "read");
}

#[test]
fn an_stl_file_is_a_surface_and_not_a_heap_of_triangles() {
    let folder = folder();
    let facet = |corners: [&str; 3]| {
        let [a, b, c] = corners;
        format!("facet normal 0 0 0\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\n")
    };
    let [o, x, y, z] = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"];
    let facets = [[o, y, x], [o, x, z], [x, y, z], [y, o, z]].map(facet).concat();
    std::fs::write(folder.path().join("t.stl"), format!("solid t\n{facets}endsolid t\n")).unwrap();
    let report = json(run(folder.path(), "quality t.stl --json").went_well());
    let topology = &report["output"]["topology"];
    assert_eq!(
        (&topology["vertices"], &topology["euler"], &topology["boundary_loops"]),
        (&4.into(), &2.into(), &0.into())
    );
}

#[test]
fn figures_do_not_depend_on_threads() {
    let folder = folder();
    let figures = |threads: i32| {
        let words = format!("quality sphere.off --against moved.off --json --threads {threads}");
        let report = json(run(folder.path(), &words).went_well());
        assert_eq!(report["threads"], threads);
        (report["output"].clone(), report["distance"].clone())
    };
    assert_eq!(figures(1), figures(3));
}

#[test]
fn files_that_are_no_mesh_are_one_and_one_line() {
    let folder = folder();
    let before = files(folder.path());
    for name in ["absent.off", "empty.off", "points.off", "nan.off", "."] {
        run(folder.path(), &format!("quality {name}")).failed(1, &[name]);
        run(folder.path(), &format!("quality octahedron.off --against {name}")).failed(1, &[name]);
        run(folder.path(), &format!("{name} out.obj --points 100")).failed(1, &[name]);
    }
    assert_eq!(files(folder.path()), before);
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = folder();
    let mut child =
        command(folder.path(), "completions zsh").stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), &[][..]));
}

// The tests from here on run the whole pipeline.

#[test]
fn a_sphere_is_remeshed_and_reported() {
    let folder = folder();
    let ran = run(folder.path(), "sphere.off out.obj --points 500 --report report.json --seed 3");
    let text = ran.went_well();
    assert!(text.starts_with("sphere.off -> out.obj\n") && text.contains("\nverified "), "{text}");
    let report = json(&std::fs::read_to_string(folder.path().join("report.json")).unwrap());
    assert_eq!((&report["verified"], &report["sampling"]["seed"]), (&true.into(), &3.into()));
    assert_eq!((&report["sampling"]["wanted"], &report["output"]["topology"]["euler"]), (&500.into(), &2.into()));
    let vertices = report["output"]["topology"]["vertices"].as_u64().unwrap();
    assert!((495..=505).contains(&vertices), "{vertices}");
    let written = json(run(folder.path(), "quality out.obj --json").went_well());
    assert_eq!(written["output"]["topology"], report["output"]["topology"]);
}

#[test]
fn an_error_that_is_exceeded_is_status_three_and_auto_keeps_it() {
    let folder = folder();
    let ran = run(folder.path(), "sphere.off out.off --points 300 --max-error 0.01% --report r.json -q");
    assert_eq!(ran.status, 3, "{}", ran.err);
    assert!(ran.err.contains("the distance to the input is up to"), "{}", ran.err);
    let report = json(&std::fs::read_to_string(folder.path().join("r.json")).unwrap());
    let length = |name: &str| report["deviation"][name].as_f64().unwrap();
    assert!(length("reached") > length("allowed"), "{report}");
    run(folder.path(), "sphere.off out.off --points auto --max-error 0.02 -q").went_well();
    run(folder.path(), "sphere.off out.off --points auto").failed(2, &["--points: ", "give an error bound"]);
}

#[test]
fn quiet_says_nothing_and_verbose_names_the_stages() {
    let folder = folder();
    assert_eq!(run(folder.path(), "sphere.off quiet.ply --points 200 -q").went_well(), "");
    assert!(folder.path().join("quiet.ply").exists());
    // Even then, a note says which part of the input is lost.
    let shred: String =
        (0..25).map(|i| format!("{} {} 9\n", 0.05 * f64::from(i % 5), 0.05 * f64::from(i / 5))).collect();
    let cloud: String =
        (0..40 * 40).map(|i| format!("{} {} 0\n", 0.1 * f64::from(i % 40), 0.1 * f64::from(i / 40))).collect();
    std::fs::write(folder.path().join("cloud.xyz"), cloud + &shred).unwrap();
    let told = run(folder.path(), "cloud.xyz cloud.ply --points 200 -q");
    assert_eq!((told.status, told.err.lines().count()), (0, 1), "{}", told.err);
    assert!(told.err.contains("of 1625 points, 25 are on 1 shred too small"), "{}", told.err);
    let verbose = run(folder.path(), "sphere.off verbose.ply --points 200 -v");
    assert_eq!(verbose.status, 0);
    assert!(verbose.err.lines().all(|line| line.starts_with("remesh: ")), "{}", verbose.err);
    assert!(verbose.err.contains(" s read\n") && verbose.err.contains(" s write\n"), "{}", verbose.err);
}

#[test]
fn threads_do_not_change_a_byte_and_the_seed_does() {
    let folder = folder();
    let bytes = |flags: &str| {
        run(folder.path(), &format!("sphere.off out.ply --points 300 -q {flags}")).went_well();
        std::fs::read(folder.path().join("out.ply")).unwrap()
    };
    let one = bytes("--threads 1");
    assert!(one == bytes("--threads 3") && one != bytes("--seed 1"));
}

#[test]
fn what_cannot_be_written_leaves_nothing_and_an_old_file_stays() {
    let folder = folder();
    std::fs::write(folder.path().join("old.obj"), "old").unwrap();
    let before = files(folder.path());
    run(folder.path(), "sphere.off absent/out.obj --points 100").failed(1, &["absent"]);
    run(folder.path(), "sphere.off . --points 100").failed(1, &["."]);
    run(folder.path(), "sphere.off out.doc --points 100").failed(1, &["out.doc"]);
    run(folder.path(), "absent.off old.obj --points 100").failed(1, &["absent.off"]);
    run(folder.path(), "sphere.off old.obj --points 1").failed(2, &["points"]);
    assert_eq!(files(folder.path()), before);
    assert_eq!(std::fs::read_to_string(folder.path().join("old.obj")).unwrap(), "old");
}

#[test]
#[cfg(unix)]
fn an_interrupt_or_a_termination_ends_the_run_and_leaves_nothing() {
    use std::io::{BufRead, BufReader, Read};
    for signal in ["-INT", "-TERM"] {
        let folder = folder();
        let before = files(folder.path());
        let mut command = command(folder.path(), "sphere.off out.obj --points 300000 -v");
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap());
        let mut first = String::new();
        lines.read_line(&mut first).unwrap();
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
        let mut rest = String::new();
        lines.read_to_string(&mut rest).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}");
        assert!(rest.contains("remesh: interrupted"), "{rest}");
        assert_eq!(files(folder.path()), before);
    }
}

#[test]
#[cfg(unix)]
fn the_stack_that_a_shell_allows_does_not_matter() {
    let folder = folder();
    let script = format!("ulimit -s 128; exec '{}' sphere.off out.obj --points 400 -q", env!("CARGO_BIN_EXE_remesh"));
    let ran = Command::new("sh").args(["-c", &script]).current_dir(folder.path()).output().unwrap();
    assert_eq!((ran.status.code(), String::from_utf8_lossy(&ran.stderr).as_ref()), (Some(0), ""));
}

/// Writes `graded.ply`: the mesh of `octahedron.off` with a property `h`, one of whose values is given.
fn with_property(folder: &Path, h: &str) {
    let text = sphere(1, 0.0);
    let mut lines = text.lines().skip(2);
    let vertices: Vec<String> = lines.by_ref().take(6).map(|line| format!("{line} 0.4")).collect();
    let faces = lines.collect::<Vec<_>>().join("\n");
    let vertices = vertices.join("\n").replacen("0.4", h, 1);
    let header = "ply\nformat ascii 1.0\nelement vertex 6\nproperty double x\nproperty double y\nproperty double z\n\
                  property float h\nelement face 8\nproperty list uchar int vertex_indices\nend_header";
    std::fs::write(folder.join("graded.ply"), format!("{header}\n{vertices}\n{faces}\n")).unwrap();
}

#[test]
fn a_part_is_remeshed_and_the_rest_comes_through() {
    let folder = folder();
    let path = folder.path();
    let read = |name: &str| std::fs::read_to_string(path.join(name)).unwrap();
    let said = run(path, "sphere.off cap.off --within -1,-1,0.4,1,1,1 --points 700");
    assert!(said.went_well().contains("700 vertices are inside the part that was remeshed"), "{}", said.out);
    let (before, after) = (read("sphere.off"), read("cap.off"));
    let vertices = before.lines().filter(|line| line.split(' ').count() == 3).skip(1);
    let below = vertices.filter(|line| line.rsplit(' ').next().unwrap().parse::<f64>().unwrap() < 0.4);
    let mut lines = after.lines();
    below.for_each(|line| assert!(lines.any(|l| l == line), "{line} is not there, or not in its place"));

    with_property(path, "0.1");
    run(path, "graded.ply a.off --select h=0.4 --points 60").went_well();
    // All vertices except vertex 0 have 0.4; the five are corners of the interface or beside it.
    assert!(read("a.off").lines().nth(1).unwrap().starts_with("65 "), "{}", read("a.off"));
    let nothing = "within: no triangle is inside 2,2,2,3,3,3: those of the input are within -1,-1,-1,1,1,1";
    run(path, "graded.ply c.off --within 2,2,2,3,3,3 --points 60").failed(2, &[nothing]);
    run(path, "graded.ply c.off --select h=7 --points 60").failed(2, &["select: ", "0 of 6 vertices"]);
    run(path, "graded.ply c.off --select red --points 60").failed(1, &["graded.ply: ", "no property 'red'"]);
    run(path, "graded.ply c.off --select h --points 60 --smooth").failed(2, &["smooth: "]);
    run(path, "points.off c.off --select h --points 60").failed(1, &["points.off: ", "no property 'h'"]);
    run(path, "points.off c.off --within 9,9,9,10,10,10 --points 60").failed(2, &["within: none of the "]);
    run(path, "sample points.off c.off --within 9,9,9,10,10,10 --points 60").failed(2, &["within: none of the "]);
    assert!(!path.join("c.off").exists());
}

#[test]
fn lengths_come_from_a_property_or_a_list() {
    let folder = folder();
    let path = folder.path();
    let lengths = |text: &str| std::fs::write(path.join("h.json"), text).unwrap();
    with_property(path, "0.1");
    lengths("[0.1, 0.4, 0.4, 0.4, 0.4, 0.4]");
    run(path, "graded.ply a.off --sizing h --report a.json").went_well();
    run(path, "octahedron.off b.off --sizing h.json").went_well();
    let read = |name: &str| std::fs::read_to_string(path.join(name)).unwrap();
    assert_eq!(json(&read("a.json"))["sampling"]["wanted"], json(&read("a.json"))["output"]["topology"]["vertices"]);
    assert_eq!(read("a.off").lines().nth(1), read("b.off").lines().nth(1));
    run(path, "octahedron.off b.off --sizing h.json --points 123").went_well();
    assert!(read("b.off").lines().nth(1).unwrap().starts_with("123 "));

    run(path, "graded.ply c.off --sizing size").failed(1, &["graded.ply: ", "no property 'size'", "use one of h"]);
    run(path, "octahedron.off c.off --sizing h").failed(1, &["octahedron.off: ", "no property 'h'", "there are none"]);
    run(path, "octahedron.off c.off --sizing none.json").failed(1, &["none.json", "no such file"]);
    run(path, "octahedron.off c.off --sizing h.json --adapt 1").failed(2, &["--adapt"]);
    run(path, "octahedron.off c.off --points 99 --adapt 1.5").failed(2, &["adapt: 1.5", "from 0 to 1"]);
    with_property(path, "-1");
    run(path, "graded.ply c.off --sizing h").failed(2, &["sizing: vertex 0 has the value -1"]);
    for (text, words) in [
        ("[0.1, 0.4]", "2 values are given for the 6 vertices"),
        ("[1, 1, 1, 0, 1, 1]", "vertex 3 has the value 0, which is not a length"),
    ] {
        lengths(text);
        run(path, "octahedron.off c.off --sizing h.json").failed(2, &["sizing: ", words]);
    }
    lengths("[1,\n\"a\"]");
    run(path, "octahedron.off c.off --sizing h.json").failed(1, &["h.json:2: not a JSON list of numbers"]);
    assert!(!path.join("c.off").exists());
}

#[test]
fn attributes_are_carried_and_what_is_lost_is_said() {
    let folder = folder();
    let path = folder.path();
    with_property(path, "0.4");
    let report = |words: &str| {
        run(path, &format!("{words} --points 300 --report a.json -q")).went_well();
        json(&std::fs::read_to_string(path.join("a.json")).unwrap())["attributes"].clone()
    };
    assert_eq!(report("graded.ply a.ply"), serde_json::json!({ "carried": ["h"], "lost": [] }));
    assert!(std::fs::read(path.join("a.ply")).unwrap().starts_with(b"ply\n"));
    // The transferred property can be used as a field again.
    run(path, "a.ply b.ply --sizing h -q").went_well();
    let lost = report("graded.ply a.stl");
    assert_eq!(lost["lost"][0], serde_json::json!({ "name": "h", "cause": "STL cannot store it" }));
    assert_eq!(report("graded.ply a.ply --no-attributes"), serde_json::Value::Null);
    assert_eq!(report("octahedron.off a.ply"), serde_json::json!({ "carried": [], "lost": [] }));
    let table = run(path, "graded.ply a.obj --points 300");
    assert!(table.went_well().contains("\nattributes, lost         h: OBJ cannot store it\n"), "{}", table.out);
}

#[test]
fn a_textured_file_stays_textured() {
    let folder = folder();
    let path = folder.path();
    let square = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl red\n\
                  f 1/1 2/2 3/3 4/4\n";
    std::fs::write(path.join("square.obj"), square).unwrap();
    run(path, "square.obj out.obj --points 60 -q").went_well();
    let written = std::fs::read_to_string(path.join("out.obj")).unwrap();
    assert!(written.starts_with("mtllib m.mtl\nv ") && written.contains("\nusemtl red\nf "));
    assert_eq!(written.lines().filter(|line| line.starts_with("vt ")).count(), 60);
    // Texture coordinates belong to the same corners after passing through each format that has them.
    run(path, "square.obj a.glb --points 60 -q").went_well();
    run(path, "a.glb b.ply --points 50 -q").went_well();
    run(path, "b.ply c.obj --points 40 -q").went_well();
    let written = std::fs::read_to_string(path.join("c.obj")).unwrap();
    let numbers = |keyword: &str| -> Vec<Vec<f64>> {
        let lines = written.lines().filter_map(|line| line.strip_prefix(keyword));
        lines.map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect()).collect()
    };
    let (places, texture) = (numbers("v "), numbers("vt "));
    for face in written.lines().filter_map(|line| line.strip_prefix("f ")) {
        for corner in face.split(' ') {
            let (v, vt) = corner.split_once('/').unwrap();
            let [v, vt] = [v, vt].map(|word| word.parse::<usize>().unwrap() - 1);
            assert!((0..2).all(|k| (places[v][k] - texture[vt][k]).abs() < 1e-5), "{corner}");
        }
    }
}

#[test]
fn three_points_are_no_surface_and_columns_are_no_output() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("cloud.xyz"), "0 0 0\n1 0 0\n0 1 0\n").unwrap();
    std::fs::write(path.join("bad.pts"), "0 0 0\n1 0 0 5\n").unwrap();
    run(path, "cloud.xyz out.obj --points 100").failed(1, &["cloud.xyz", "3 distinct points are too few"]);
    run(path, "bad.pts out.obj --points 100")
        .failed(1, &["bad.pts:2: the line has 4 columns, but the lines before it have 3"]);
    run(path, "sphere.off out.xyz --points 100").failed(1, &["out.xyz: XYZ cannot hold triangles", ".obj"]);
}

#[test]
fn samples_without_triangles() {
    let folder = folder();
    let written = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    let said = run(folder.path(), "sample sphere.off s.xyz --points 300 --report s.json");
    let words: Vec<&str> = said.went_well().split_whitespace().collect();
    let at = words.iter().position(|&word| word == "samples").unwrap();
    let candidates: usize = words[at + 2].parse().unwrap();
    assert!(words[at - 1] == "300" && (5900..6100).contains(&candidates), "{}", said.out);
    let lines = String::from_utf8(written("s.xyz")).unwrap();
    let rows: Vec<&str> = lines.lines().filter(|line| !line.starts_with('#')).collect();
    assert!(rows.len() == 300 && rows.iter().all(|row| row.split(' ').count() == 6), "{}", rows[0]);
    let report = json(&String::from_utf8(written("s.json")).unwrap());
    assert_eq!((report["samples"].as_u64(), report["scan_only"].as_bool()), (Some(300), Some(false)));
    assert!(report["sigma_p"].as_f64().unwrap() > 0.0 && report["sigma_n"].is_null());

    run(folder.path(), "sample sphere.off s.ply --points 100 --scan-only --sigma-n 0.5 -q").went_well();
    assert!(String::from_utf8_lossy(&written("s.ply")).contains("property uint index"));
    run(folder.path(), "sample s.ply t.ply --points 40 --scan-only -q").went_well();
    run(folder.path(), "sample s.ply t.obj --points 40 --scan-only --sigma nx=0.1 -q").went_well();
    assert_eq!(String::from_utf8(written("t.obj")).unwrap().matches("v ").count(), 40);
    let cloud = run(folder.path(), "sample s.ply t.ply --points 40 --smooth 3 --normal-neighbors 6 --report c.json");
    assert!(cloud.went_well().contains("40 samples"), "{}", cloud.out);
    let report = json(&String::from_utf8(written("c.json")).unwrap());
    assert_eq!(report["cloud"]["points"].as_u64(), Some(100));
    let few = run(folder.path(), "sample sphere.off t.ply --sigma-p 9 --scan-only");
    assert!(few.went_well().contains("note: only"), "{}", few.out);
}

#[test]
fn what_cannot_be_sampled_is_one_line() {
    let folder = folder();
    let failed = |words: &str, status, said: &str| run(folder.path(), words).failed(status, &[said]);
    failed("sample points.off s.ply --points 3", 1, "too few for a surface");
    failed("sample sphere.off s.stl --points 3", 1, "s.stl: STL cannot hold points");
    failed("sample sphere.off s.ply --points auto", 2, "a whole number");
    failed("sample sphere.off s.ply", 2, "no density is given");
    failed("sample sphere.off s.ply --points 9 --sigma-n 0", 2, "sigma-n");
    failed("sample sphere.off s.ply --points 9 --sigma x", 2, "NAME=VALUE");
    failed("sample sphere.off s.ply --points 9 --sigma x=0", 2, "positive");
    failed("sample sphere.off s.ply --points 9 --sigma heat=1", 1, "heat");
    failed("sample gone.off s.ply --points 9", 1, "gone.off");
    failed("sphere.off s.ply --points 9 --sigma-n 1 --adapt 1", 2, "sigma-n");
    assert!(!files(folder.path()).contains(&"s.ply".into()));
}

#[test]
fn points_become_a_dense_surface() {
    let folder = folder();
    run(folder.path(), "sample sphere.off s.xyz --points 400 -q").went_well();
    let said = run(folder.path(), "reconstruct s.xyz s.obj --resolution 0.1 --smooth 2.5 --report s.json");
    let said = said.went_well();
    assert!(
        said.contains("400 points") && said.contains("cell size 0.1") && said.contains("characteristic 2"),
        "{said}"
    );
    let report = json(&std::fs::read_to_string(folder.path().join("s.json")).unwrap());
    assert_eq!(report["schema"], "spectral-remesh/surface/1");
    assert_eq!((report["surface"]["euler"].as_i64(), report["reach"].as_f64()), (Some(2), Some(2.5)));
    // The vertices of a mesh are points, too.
    assert!(run(folder.path(), "reconstruct s.obj t.off --resolution 0.2").went_well().contains("0 boundary loops"));
    let failed = |words: &str, status, said: &str| run(folder.path(), words).failed(status, &[said]);
    failed("reconstruct points.off t.ply", 1, "points.off: 3 distinct points are too few");
    failed("reconstruct s.xyz t.ply --resolution 0", 2, "positive");
    failed("reconstruct s.xyz t.ply --resolution 1e-6", 2, "corners near the surface");
    failed("reconstruct s.xyz t.ply --smooth 0.1", 2, "smooth");
    failed("reconstruct s.xyz t.xyz", 1, "t.xyz");
    failed("reconstruct gone.xyz t.ply", 1, "gone.xyz");
    assert!(!files(folder.path()).contains(&"t.ply".into()));
}

#[test]
fn vertices_follow_a_kernel() {
    let folder = folder();
    let said = run(folder.path(), "sphere.off s.off --points 300 --sigma-n 0.3");
    assert!(said.went_well().contains("verified"), "{}", said.out);
}
