//! Imports go down one table of layers only. This test reads every `crate::` path of `src/` and holds it to the table,
//! which `ARCHITECTURE.md` shows, too.

use std::fs;
use std::path::{Path, PathBuf};

/// Each top-level module and its layer. A module may import from its own folder and from lower layers, never from a
/// higher one and never from another module of its own layer: stages do not know each other.
const LAYERS: [(&str, u32); 18] = [
    ("base", 0),
    ("geom", 1),
    ("mesh", 2),
    ("spatial", 3),
    ("surface", 4),
    ("manifold", 5),
    ("prepare", 5),
    ("io", 6),
    ("spectral", 6),
    ("triangulate", 6),
    ("optimize", 6),
    ("contour", 6),
    ("transfer", 6),
    ("quality", 6),
    ("pipeline", 7),
    ("report", 8),
    ("job", 9),
    ("cli", 10),
];

#[test]
fn imports_go_down_the_layers_only() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    collect(&root, &mut files);
    files.sort();
    assert!(files.len() > 3, "no sources found in {}", root.display());
    let faults: Vec<String> = files.iter().flat_map(|file| faults_of_file(&root, file)).collect();
    assert!(faults.is_empty(), "{} imports against the layers:\n{}", faults.len(), faults.join("\n"));
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder that can be read") {
        let path = entry.expect("an entry that can be read").path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

/// The faults of one file, a line each. The roots of the library and of the binary may import everything.
fn faults_of_file(root: &Path, file: &Path) -> Vec<String> {
    let inside = file.strip_prefix(root).expect("a file of src").with_extension("");
    let module = inside.iter().next().expect("a file has a name").to_str().expect("names are plain");
    if ["lib", "main"].contains(&module) {
        return Vec::new();
    }
    let text = fs::read_to_string(file).expect("a source that can be read");
    faults(module, &text)
        .into_iter()
        .map(|(line, rule)| format!("src/{}.rs:{line}: {rule}", inside.display()))
        .collect()
}

/// What is wrong with the `crate::` paths in a source of `module`: lines and the rule that each breaks.
fn faults(module: &str, text: &str) -> Vec<(usize, String)> {
    let Some(own) = layer(module) else {
        return vec![(1, format!("`{module}` has no layer; add it to tests/layers.rs and ARCHITECTURE.md"))];
    };
    let fault = |(line, name): (usize, String)| {
        let rule = match layer(&name) {
            _ if name == module => return None,
            Some(other) if other < own => return None,
            Some(other) if other > own => {
                format!("`{module}` (layer {own}) imports `{name}` (layer {other}), which is above it")
            }
            Some(_) => format!("`{module}` imports `{name}`, but modules of layer {own} do not know each other"),
            None => format!("`crate::{name}` is no module of the table; name the module that defines it"),
        };
        Some((line, rule))
    };
    crate_paths(text).into_iter().filter_map(fault).collect()
}

fn layer(module: &str) -> Option<u32> {
    LAYERS.iter().find(|(name, _)| *name == module).map(|l| l.1)
}

/// The first name after each `crate::`, those in braces one by one, with their lines. Comments do not count.
fn crate_paths(text: &str) -> Vec<(usize, String)> {
    let code: String = text.lines().map(|line| line.split("//").next().unwrap_or("").to_owned() + "\n").collect();
    let mut found = Vec::new();
    for (at, _) in code.match_indices("crate::") {
        if code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_') {
            continue;
        }
        let after = at + "crate::".len();
        let starts = if code[after..].starts_with('{') { item_starts(&code, after + 1) } else { vec![after] };
        for start in starts {
            let name: String = code[start..].chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            found.push((1 + code[..start].matches('\n').count(), name));
        }
    }
    found
}

/// Where each item begins in a list of imports, up to its closing brace.
fn item_starts(code: &str, open: usize) -> Vec<usize> {
    let mut starts = Vec::new();
    let (mut depth, mut fresh) = (1, true);
    for (offset, c) in code[open..].char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 1 => fresh = true,
            c if fresh && !c.is_whitespace() => {
                starts.push(open + offset);
                fresh = false;
            }
            _ => {}
        }
        if depth == 0 {
            break;
        }
    }
    starts
}

#[test]
fn paths_are_read_from_lists_and_not_from_comments() {
    let text = "use crate::base::error::Error;\nuse crate::{\n    geom::{grid::Grid, aabb},\n    surface,\n};\n\
                // crate::cli\nfn f() { crate::io::write() } my_crate::x;\n";
    let expected = [(1, "base"), (3, "geom"), (4, "surface"), (7, "io")];
    assert_eq!(crate_paths(text), expected.map(|(line, name)| (line, name.to_owned())));
}

#[test]
fn every_way_against_the_layers_is_noticed() {
    let broken = |module, import: &str| !faults(module, &format!("use crate::{import};")).is_empty();
    assert!(broken("geom", "mesh::triangle_mesh::Mesh"), "up");
    assert!(broken("io", "quality::shape"), "aside");
    assert!(broken("io", "Mesh"), "a name of the root");
    assert!(broken("nowhere", "base::error::Error"), "a module without a layer");
    assert!(!broken("io", "io::stream::Lines") && !broken("io", "mesh::triangle_mesh::Mesh"));
}
