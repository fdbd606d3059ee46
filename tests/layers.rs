//! Checks that imports only go down the table of layers, which `ARCHITECTURE.md` also shows, and that files do not import
//! each other in circles. These tests read every path in `src/` that begins with `crate`, `self`, `super` or a child module,
//! including those in unit tests.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Each top-level module and its layer. A module may import from its own folder and from lower layers, never from a
/// higher one and never from another module of its own layer: stages do not know each other.
const LAYERS: [(&str, u32); 21] = [
    ("base", 0),
    ("geom", 1),
    ("mesh", 2),
    ("spatial", 3),
    ("testing", 3),
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
    ("picture", 6),
    ("pipeline", 7),
    ("report", 8),
    ("tiles", 8),
    ("job", 9),
    ("cli", 10),
];

/// The module that all unit tests may import: it builds shapes.
const TESTING: &str = "testing";

/// The only folder that may hold more than a sixth of the lines of `src/`: it has a reader and a writer for each format.
const LARGE: &str = "io";

/// The path of a module or an item from the root of the crate.
type Names = Vec<String>;

/// A file of `src/`.
struct Source {
    module: Names,
    text: String,
}

/// A path in a file that leads to the crate's own modules.
#[derive(Debug, PartialEq)]
struct Import {
    line: usize,
    path: Names,
    /// Whether it only re-exports an item of a child module.
    is_reexport: bool,
}

/// All files, and which of them import which others.
struct Graph {
    sources: Vec<Source>,
    /// The file index of each module.
    files: HashMap<Names, usize>,
    imports: Vec<Vec<Import>>,
    /// The original path of each re-export.
    reexports: HashMap<Names, Names>,
}

#[test]
fn imports_go_down_the_layers_only() {
    let graph = Graph::new(sources());
    let faults: Vec<String> = (0..graph.sources.len()).flat_map(|file| graph.faults(file)).collect();
    assert!(faults.is_empty(), "{} imports against the layers:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn files_do_not_import_each_other_in_circles() {
    let circles = Graph::new(sources()).circles();
    let circles: Vec<String> = circles.iter().map(|circle| circle.join(", ")).collect();
    assert!(circles.is_empty(), "{} circles:\n{}", circles.len(), circles.join("\n"));
}

#[test]
fn no_folder_is_a_house() {
    let mut lines: HashMap<String, usize> = HashMap::new();
    for source in sources() {
        *lines.entry(source.module[0].clone()).or_default() += source.text.lines().count();
    }
    let total: usize = lines.values().sum();
    lines.retain(|folder, &mut lines| folder != LARGE && 6 * lines > total);
    assert!(lines.is_empty(), "more than a sixth of {total} lines: {lines:?}");
}

/// Users of the library, of Python and of the page set options that have no flags.
#[test]
fn only_the_command_line_names_its_flags() {
    let names_flag = |line: &&str| {
        let code = line.split("//").next().unwrap_or("");
        code.split('"').skip(1).step_by(2).any(|text| text.split([' ', '(']).any(is_flag))
    };
    let mut found = Vec::new();
    for Source { module, text } in sources().into_iter().filter(|source| source.module[0] != "cli") {
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or("");
        found.extend(code.lines().filter(names_flag).map(|line| format!("{}: {}", module.join("::"), line.trim())));
    }
    assert!(found.is_empty(), "flags in the library:\n{}", found.join("\n"));
}

fn is_flag(word: &str) -> bool {
    word.strip_prefix("--").is_some_and(|name| name.starts_with(|c: char| c.is_ascii_lowercase()))
}

/// Returns all files except the roots of the library and of the binary, which may import everything.
fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    collect(&root, &mut files);
    files.sort();
    let source = |file: &PathBuf| {
        let inside = file.strip_prefix(&root).expect("a file of src").with_extension("");
        let text = fs::read_to_string(file).expect("a source that can be read");
        Source::new(inside.to_str().expect("names are plain"), &text)
    };
    let mut sources: Vec<Source> = files.iter().map(source).collect();
    sources.retain(|source| !["lib", "main"].contains(&source.module[0].as_str()));
    assert!(sources.len() > 3, "no sources found in {}", root.display());
    sources
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

impl Source {
    /// Returns the source at `path` in `src/`, given without its extension.
    fn new(path: &str, text: &str) -> Source {
        let path = path.strip_suffix("/mod").unwrap_or(path);
        Source { module: path.split('/').map(String::from).collect(), text: text.into() }
    }

    /// Returns the imports of the file and of the modules within it. `is_module` tells which paths are files.
    fn imports(&self, is_module: impl Fn(&[String]) -> bool) -> Vec<Import> {
        let mut found = Vec::new();
        let mut module = self.module.clone();
        let (mut first, mut code) = (1, String::new());
        for (number, line) in (1..).zip(self.text.lines().chain(["}"])) {
            code.push_str(line.split("//").next().unwrap_or(""));
            code.push('\n');
            // Modules within a file begin and end at the start of a line.
            let opened = inner_module(line);
            if opened.is_some() || line == "}" {
                found.extend(imports(&code, first, &module, &is_module));
                (first, code) = (number + 1, String::new());
                module.truncate(self.module.len());
                module.extend(opened);
            }
        }
        found
    }
}

/// Returns the name of the module that begins on this line.
fn inner_module(line: &str) -> Option<String> {
    let begins = !line.starts_with(' ') && line.ends_with('{');
    let mut words = line.split_whitespace().skip_while(|word| *word != "mod");
    words.nth(1).filter(|_| begins).map(String::from)
}

/// Returns the imports in the code of `module`, which begins on line `first` of its file.
fn imports(code: &str, first: usize, module: &[String], is_module: impl Fn(&[String]) -> bool) -> Vec<Import> {
    let mut found = Vec::new();
    let (mut rest, mut is_public, mut is_reexport) = (code, false, false);
    while let Some(start) = rest.find(is_of_name) {
        let (before, at) = rest.split_at(start);
        let (name, after) = split_name(at);
        is_reexport &= !before.contains(';');
        let is_root = ["crate", "self", "super"].contains(&name) || is_module(&[module, &[name.into()]].concat());
        if is_root && after.starts_with("::") && !before.ends_with("::") {
            let line = first + code[..code.len() - at.len()].matches('\n').count();
            let mut paths = Vec::new();
            rest = read_paths(at, &[], &mut paths);
            let paths = paths.iter().map(|names| absolute(module, names));
            found.extend(paths.map(|path| Import { line, is_reexport: is_reexport && path.starts_with(module), path }));
        } else {
            is_reexport |= name == "use" && (is_public || before.ends_with(") "));
            is_public = name == "pub";
            rest = after;
        }
    }
    found
}

/// Reads the path, or the tree of paths, at the start of `code`, and returns the rest.
fn read_paths<'a>(code: &'a str, prefix: &[&'a str], found: &mut Vec<Vec<&'a str>>) -> &'a str {
    let code = code.trim_start();
    if let Some(mut list) = code.strip_prefix('{') {
        while !list.trim_start().starts_with('}') {
            list = read_paths(list, prefix, found);
            list = &list[list.find([',', '}']).expect("a list ends")..];
            list = list.strip_prefix(',').unwrap_or(list);
        }
        return &list.trim_start()[1..];
    }
    let (name, rest) = split_name(code);
    let path = [prefix, &[name]].concat();
    match rest.strip_prefix("::") {
        Some(rest) => read_paths(rest, &path, found),
        None => {
            found.push(path);
            rest
        }
    }
}

fn split_name(code: &str) -> (&str, &str) {
    code.split_at(code.find(|c| !is_of_name(c)).unwrap_or(code.len()))
}

fn is_of_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Returns the path from the root of the crate that `names` refer to within `module`.
fn absolute(module: &[String], names: &[&str]) -> Names {
    let mut path = if names[0] == "crate" { Names::new() } else { module.to_vec() };
    for &name in names {
        match name {
            "crate" | "self" => {}
            "super" => drop(path.pop()),
            _ => path.push(name.into()),
        }
    }
    path
}

impl Graph {
    fn new(sources: Vec<Source>) -> Graph {
        let files: HashMap<Names, usize> = (0..).zip(&sources).map(|(i, source)| (source.module.clone(), i)).collect();
        let imports: Vec<Vec<Import>> =
            sources.iter().map(|source| source.imports(|path| files.contains_key(path))).collect();
        let mut reexports = HashMap::new();
        for (source, imports) in sources.iter().zip(&imports) {
            for Import { path, .. } in imports.iter().filter(|import| import.is_reexport) {
                reexports.insert([&source.module[..], &path[path.len() - 1..]].concat(), path.clone());
            }
        }
        Graph { sources, files, imports, reexports }
    }

    /// Returns the file that a path leads to, following re-exports.
    fn target(&self, path: &[String]) -> Option<usize> {
        let length = (1..=path.len()).rev().find(|&n| self.files.contains_key(&path[..n]))?;
        match path.get(..=length).and_then(|item| self.reexports.get(item)) {
            Some(item) => self.target(item),
            None => Some(self.files[&path[..length]]),
        }
    }

    /// Returns the imports of a file that violate the table of layers, one line each.
    fn faults(&self, file: usize) -> Vec<String> {
        let name = self.sources[file].module.join("/");
        let module = &self.sources[file].module[0];
        let Some(own) = layer(module) else {
            return vec![format!("`{module}` has no layer; add it to tests/layers.rs and ARCHITECTURE.md")];
        };
        let fault = |import: &Import| {
            let other = &import.path[0];
            let rule = match layer(other) {
                _ if other == module || other == TESTING => return None,
                Some(layer) if layer < own => return None,
                Some(layer) if layer > own => {
                    format!("`{module}` (layer {own}) imports `{other}` (layer {layer}), which is above it")
                }
                Some(_) => format!("`{module}` imports `{other}`, but modules of layer {own} do not know each other"),
                None => format!("`crate::{other}` is no module of the table; name the module that defines it"),
            };
            Some(format!("src/{name}.rs:{}: {rule}", import.line))
        };
        self.imports[file].iter().filter_map(fault).collect()
    }

    /// Returns the names of the files in each circle of imports.
    fn circles(&self) -> Vec<Vec<String>> {
        let reached: Vec<Vec<bool>> = (0..self.sources.len()).map(|file| self.reached_from(file)).collect();
        let circle = |file: usize| -> Vec<usize> {
            let both = |&other: &usize| reached[file][other] && reached[other][file];
            (0..self.sources.len()).filter(both).collect()
        };
        let name = |file: usize| self.sources[file].module.join("/");
        let circles = (0..self.sources.len()).map(|file| (file, circle(file)));
        let first_named = circles.filter(|(file, circle)| circle.first() == Some(file));
        first_named.map(|(_, circle)| circle.into_iter().map(name).collect()).collect()
    }

    /// Returns, for each file, whether a chain of one or more imports leads to it from `file`.
    fn reached_from(&self, file: usize) -> Vec<bool> {
        let mut reached = vec![false; self.sources.len()];
        let mut todo = vec![file];
        while let Some(from) = todo.pop() {
            let imports = self.imports[from].iter().filter(|import| !import.is_reexport);
            for to in imports.filter_map(|import| self.target(&import.path)).filter(|&to| to != from) {
                if !std::mem::replace(&mut reached[to], true) {
                    todo.push(to);
                }
            }
        }
        reached
    }
}

fn layer(module: &str) -> Option<u32> {
    LAYERS.iter().find(|(name, _)| *name == module).map(|l| l.1)
}

#[test]
fn paths_are_read_from_lists_and_not_from_comments() {
    let text = "use crate::base::error::Error;\nuse crate::{\n    geom::{grid::Grid, aabb as boxes},\n    surface,\n};\n\
                // crate::cli\npub use below::Item;\nfn f() { crate::io::write() } my_crate::x; other::below::y;\n\
                mod tests {\n    use super::*;\n    use super::super::next;\n}\nfn g() { below::h() }\n";
    let source = Source::new("a/b/mod", text);
    let found = source.imports(|path| path.ends_with(&["b".into(), "below".into()]));
    let paths: Vec<(usize, String)> = found.iter().map(|i| (i.line, i.path.join("::"))).collect();
    let expected = [
        (1, "base::error::Error"),
        (2, "geom::grid::Grid"),
        (2, "geom::aabb"),
        (2, "surface"),
        (7, "a::b::below::Item"),
        (8, "io::write"),
        (10, "a::b::"),
        (11, "a::next"),
        (13, "a::b::below::h"),
    ];
    assert_eq!(paths, expected.map(|(line, path)| (line, path.to_owned())));
    assert_eq!(found.iter().filter(|import| import.is_reexport).map(|import| import.line).collect::<Vec<_>>(), [7]);
}

#[test]
fn every_way_against_the_layers_is_noticed() {
    let broken = |module: &str, import: &str| {
        !Graph::new(vec![Source::new(module, &format!("use crate::{import};"))]).faults(0).is_empty()
    };
    assert!(broken("geom/aabb", "mesh::triangle_mesh::Mesh"), "up");
    assert!(broken("io/mod", "quality::shape"), "aside");
    assert!(broken("io/mod", "Mesh"), "a name of the root");
    assert!(broken("nowhere", "base::error::Error"), "a module without a layer");
    assert!(!broken("io/mod", "io::stream::Lines") && !broken("io/mod", "mesh::triangle_mesh::Mesh"));
}

#[test]
fn circles_are_noticed_and_re_exports_are_none() {
    let circles = |files: &[(&str, &str)]| {
        Graph::new(files.iter().map(|(module, text)| Source::new(module, text)).collect()).circles()
    };
    let parent = ("io/mod", "mod read;\npub use read::Read;");
    assert_eq!(circles(&[parent, ("io/read", "use super::*;"), ("io/ply", "use crate::io::Read;")]), [[""; 0]; 0]);
    assert_eq!(
        circles(&[parent, ("io/read", "use super::ply;"), ("io/ply", "use super::Read;")]),
        [["io/read", "io/ply"]]
    );
    assert_eq!(circles(&[("io/mod", "use ply::x;"), ("io/ply", "fn f() { super::g() }")]), [["io", "io/ply"]]);
}
